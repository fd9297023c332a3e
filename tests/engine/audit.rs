//! The second computation of audited runs: its settings, the definition of a flip, and its
//! independence from all other results.

use std::sync::atomic::AtomicBool;

use stickslip::analysis::{Z_95, wilson};
use stickslip::classification::{Evidence, Label, simulate};
use stickslip::engine::compute;
use stickslip::model::{Case, Method};

use super::in_memory::{Kept, run_in_memory};
use crate::cli::support::{
    AT_ONCE, Scratch, assert_has, counts, numbers, parse, row, study_text, words,
};

/// Speeds with irregular and with regular motions.
const SPEEDS: &str = "sweep: [{grid: {speed_rad_s: [-191.6372, -160.8103]}}]\n";
const AUDIT: &str = "audit: {fraction: 0.4}\n";
const DESIGN: &str = "{monte_carlo: {samples: 60}}";

/// The second computation of every audited run agrees, field by field, with the study with the
/// other settings; the other columns are those of the study without an audit.
#[test]
fn audited_runs_are_those_of_the_study_with_the_other_settings() {
    let scratch = Scratch::new();
    // Coarse tolerances, so that irregular motions flip.
    let coarse = "tolerance: {relative: 1.0e-3, absolute: 1.0e-5}";
    // A tenth of those to the last bit, because irregular motions are sensitive to it.
    let fine = "method: event, tolerance: {relative: 1.0e-4, absolute: 1.0000000000000002e-6}";
    let with = |settings: &str| {
        let text = study_text("a", DESIGN, 16.5, SPEEDS);
        text.replace("simulation: {", &format!("simulation: {{{settings}, "))
    };
    let plain = with(coarse);
    scratch.write("plain.yaml", &plain);
    scratch.write("other.yaml", with(fine));
    scratch.write("audit.yaml", format!("{plain}{AUDIT}"));
    for name in ["plain", "other", "audit"] {
        scratch.well(&format!("run {name}.yaml --out {name} --quiet"));
    }
    let [plain, other, audit] = ["plain", "other", "audit"].map(|name| scratch.table(name, "runs"));
    let of_audit = ["audit_label", "audit_evidence"];
    let [label, evidence] = of_audit.map(|name| words(&audit, name));
    let [others_label, others_evidence] = ["label", "evidence"].map(|name| words(&other, name));
    let study = parse(&(with(coarse) + AUDIT));
    for run in 0..120 {
        assert_eq!(row(&plain, run, &of_audit), row(&audit, run, &of_audit));
        let audited = study.planned_run(run as u64).audited;
        assert_eq!(label[run], others_label[run].clone().filter(|_| audited), "run {run}");
        assert_eq!(evidence[run], others_evidence[run].clone().filter(|_| audited), "run {run}");
    }
    for name in of_audit {
        assert!(words(&plain, name).iter().all(Option::is_none));
    }

    // The point table has the same counts.
    let labels = words(&audit, "label");
    let (points, without) = (scratch.table("audit", "points"), scratch.table("plain", "points"));
    let columns = [
        "audited_runs",
        "audit_flips",
        "audit_flip_rate",
        "audit_flip_low",
        "audit_flip_high",
        "audit_rest_flips",
    ];
    for point in 0..2 {
        let runs = 60 * point..60 * (point + 1);
        let audited = runs.clone().filter(|&run| label[run].is_some()).count() as u64;
        let flips =
            runs.filter(|&run| label[run].is_some() && label[run] != labels[run]).count() as u64;
        assert!(audited > 10, "{audited}");
        assert_eq!(counts(&points, "audited_runs")[point], audited);
        assert_eq!(counts(&points, "audit_flips")[point], flips);
        let rests = |label: Option<&str>| label == Some("equilibrium");
        let rest_flips = (60 * point..60 * (point + 1)).filter(|&run| {
            label[run].is_some() && rests(label[run].as_deref()) != rests(labels[run].as_deref())
        });
        assert_eq!(counts(&points, "audit_rest_flips")[point], rest_flips.count() as u64);
        let found = columns[2..5].iter().map(|name| numbers(&points, name)[point].unwrap());
        let (low, high) = wilson(flips, audited, Z_95);
        assert_eq!(found.collect::<Vec<_>>(), [flips as f64 / audited as f64, low, high]);
        assert_eq!(row(&points, point, &columns), row(&without, point, &columns));
        let absent = row(&without, point, &[]);
        let null = |name: &str| absent.contains(&(name.to_owned(), "null".to_owned()));
        assert!(columns.into_iter().all(null), "{absent:?}");
    }
    assert!(counts(&points, "audit_flips")[0] > 0, "the study is too small");
    assert_eq!(counts(&points, "audit_flips")[1], 0);
}

/// Panics and failures in one of the two computations are flips and do not affect other runs.
#[test]
fn failures_on_one_side_are_flips() {
    let text = study_text("a", "{monte_carlo: {samples: 30}}", AT_ONCE, "audit: {fraction: 1}\n");
    let study = parse(&text);
    let fails = |case: &Case| match case.simulation.method {
        Method::Switch => case.start.0[0] > 0.0,
        Method::Event => case.start.0[1] > 0.0,
    };
    let mut kept = Kept::default();
    let totals = run_in_memory(&study, &mut kept, &AtomicBool::new(false), |case| {
        assert!(!fails(case), "injected");
        simulate(case)
    })
    .unwrap();
    assert!(!totals.interrupted());
    let (mut flips, mut both) = (0, 0);
    for record in &kept.runs {
        let start = &record.planned.start.0;
        let (first, second) = (start[0] > 0.0, start[1] > 0.0);
        assert_eq!(record.outcome.evidence.name() == "panic", first);
        assert_eq!(record.audit.as_ref().is_some_and(|again| again.name() == "panic"), second);
        flips += u64::from(first != second);
        both += u64::from(first && second);
    }
    assert!(flips > 5 && both > 2, "{flips} {both}: the study is too small");
    let audit = kept.points[0].summary.audit;
    assert_eq!((audit.runs, audit.flips), (30, flips));
    assert_eq!(totals.counts.of(Label::Failed), kept.points[0].summary.counts.of(Label::Failed));
}

/// A physically invalid sample is audited, too: it fails in both computations.
#[test]
fn parameters_without_sense_do_not_flip() {
    let rest = "audit: {fraction: 1}\n\
                uncertain: {ball_mass_kg: {normal: {mean: 1.4e-4, std_dev: 1.4e-4}}}\n";
    let study = parse(study_text("a", "{monte_carlo: {samples: 60}}", AT_ONCE, rest));
    let records: Vec<_> = (0..60).map(|run| compute(&study, run, simulate)).collect();
    let invalid = records.iter().filter(|record| record.planned.case.is_err());
    assert!(invalid.clone().count() > 3);
    for record in invalid {
        assert_eq!(record.audit.as_ref().map(Evidence::name), Some("invalid_parameters"));
        assert_eq!(record.outcome.evidence.name(), "invalid_parameters");
    }
}

#[test]
fn the_terminal_and_the_json_show_flips_where_there_is_an_audit() {
    let scratch = Scratch::new();
    let text = study_text("a", "{monte_carlo: {samples: 10}}", AT_ONCE, "");
    scratch.write("plain.yaml", &text);
    let expect = "expect: [{audit_flip_rate: [0, 0]}]\n";
    scratch.write("audit.yaml", format!("{text}audit: {{fraction: 1}}\n{expect}"));
    scratch.write("rare.yaml", format!("{text}audit: {{fraction: 1.0e-9}}\n{expect}"));
    assert!(!scratch.well("run plain.yaml --out a").contains("flips"));
    let table = scratch.well("verify audit.yaml");
    assert_has(&table, &["cided    flips\n", "0 of 10\n"]);
    assert_has(&table, &["met      point 0: audit flip rate 0.0000, expected 0 to 0\n"]);
    let report = scratch.json("run audit.yaml --out b --json");
    let point = &report["points"][0];
    assert_eq!((&point["audited_runs"], &point["audit_flips"]), (&10.into(), &0.into()));
    assert_eq!(point["audit_flip_high"].as_f64(), Some(wilson(0, 10, Z_95).1));
    // An audit without runs does not meet an expectation.
    let ended = scratch.ended("verify rare.yaml", 4);
    assert_has(&ended.out, &["NOT MET  point 0: audit flip rate of no run, expected 0 to 0\n"]);
    let check = scratch.well("check audit.yaml");
    assert_has(
        &check,
        &[
            "audit         a fraction 1 of the runs again, with method event and a tenth of the tolerances",
        ],
    );
    let cost = |name: &str| {
        let report = scratch.json(&format!("check {name}.yaml --json"));
        report["core_seconds"].as_f64().expect("a cost")
    };
    let ratio = cost("audit") / cost("plain");
    assert!((ratio - 1.0 - 10_f64.powf(1.0 / 16.0)).abs() < 1e-12, "{ratio}");
}
