//! `stickslip optimize`: searches with known optima, reproducibility, and errors.

use std::fs;

use arrow::array::{AsArray, RecordBatch};
use serde_json::Value;

use super::support::{Scratch, assert_has, column, numbers, table, words};

/// A block on a spring that starts at rest at 45 mm: after `n` half swings of `π √(m / k)` it stops
/// within `1 N / k`. The time jumps up with every further half swing; from 30 to 200 N/m its
/// minimum is 0.3847 s, just below 66.67 N/m, where one half swing suffices.
pub const BLOCK: &str = "
schema: 1
name: block
seed: 1
model: {kind: block_on_spring}
initial_conditions:
  box: {position_m: [0.045, 0.045]}
  design: {monte_carlo: {samples: 1}}
simulation: {method: event}
design: {stiffness_n_m: {from: 30, to: 200}}
responses:
  stop: median_time_to_rest
  soon: {at_rest_by_s: 5}
";

/// Two objectives of a balancer of one or two balls, with variables of all kinds.
const BALLS: &str = "
schema: 1
name: balls
seed: 2003
model: {kind: ball_balancer, parameters: {balls: 2}}
sweep: [{grid: {speed_rad_s: [-216, -247]}}]
uncertain:
  stiffness_n_m: {times: {uniform: {min: 0.9, max: 1.1}}}
initial_conditions: {design: {monte_carlo: {samples: 8}}}
simulation: {end_time_s: 0.5}
design:
  stiffness_n_m: {from: 9e3, to: 12e3}
  balls: {from: 1, to: 2}
  material:
    choices:
      steel: {ball_mass_kg: 1.4e-4, friction_coefficient: 2.75e-3}
      ceramic: {ball_mass_kg: 5.8e-5, friction_coefficient: 1.5e-3}
responses:
  mean: {amplitude_mean: {}}
  most: {amplitude_quantile: {fraction: 0.75, relative: true}}
  rest: {at_rest_by_s: 0.5}
";

fn scratch() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("block.yaml", format!("{BLOCK}optimize: {{minimize: stop, designs: 24}}\n"));
    let balls = "optimize:\n  minimize: mean\n  subject_to: {rest: {at_most: 0.9}}\n  designs: 9\n  \
        start_designs: 6\n  finalists: 2\n  final_samples: 2\n";
    scratch.write("balls.yaml", format!("{BALLS}{balls}"));
    scratch
}

fn optimum(scratch: &Scratch, directory: &str) -> Value {
    serde_json::from_str(&scratch.text(&format!("{directory}/optimum.json"))).expect("JSON")
}

fn texts(table: &RecordBatch, name: &str) -> Vec<String> {
    words(table, name).into_iter().map(Option::unwrap).collect()
}

/// The search finds the minimum of a function with jumps, and with a constraint that excludes it,
/// the next one.
#[test]
fn the_search_finds_the_closed_form_optimum() {
    let scratch = scratch();
    let said = scratch.well("optimize block.yaml --out free --quiet");
    assert!(said.starts_with("best design"), "{said}");
    assert!(!said.contains("note:"), "{said}");
    let best = &optimum(&scratch, "free")["best"];
    let stop = best["responses"]["stop"]["value"].as_f64().unwrap();
    let stiffness = best["values"]["stiffness_n_m"].as_f64().unwrap();
    let closed = std::f64::consts::PI / stiffness.sqrt();
    assert!((stop - closed).abs() < 1e-6, "{stop} {closed}");
    assert!((0.3847..0.40).contains(&stop), "{stop}");
    let text = BLOCK.replace("{from: 30", "{from: 70");
    let limits = "{stop: {at_least: 0.3, at_most: 0.7}}";
    let block = format!("optimize: {{maximize: stop, subject_to: {limits}, designs: 24}}\n");
    scratch.write("limited.yaml", format!("{text}{block}"));
    scratch.well("optimize limited.yaml --out limited --quiet");
    let best = &optimum(&scratch, "limited")["best"];
    let stop = best["responses"]["stop"]["value"].as_f64().unwrap();
    assert!((0.66..=0.7).contains(&stop) && best["limits_met"] == true, "{best}");
    // A response with two limits counts once.
    assert_eq!(scratch.table("limited", "sensitivities").num_rows(), 1);
}

/// A block that stops after one half swing stops the sooner the stiffer its spring is: the optimum lies on the upper
/// bound, and the result says so, in words and as JSON. The default directory is among the results of other commands.
#[test]
fn an_optimum_on_a_bound() {
    let scratch = Scratch::new();
    let text = BLOCK.replace("{from: 30, to: 200}", "{from: 45, to: 60}");
    scratch.write("stiff.yaml", format!("{text}optimize: {{minimize: stop, designs: 16}}\n"));
    let said = scratch.well("optimize stiff.yaml --quiet");
    assert!(
        said.contains("note: `stiffness_n_m` lies on the upper bound of its range (45 to 60)"),
        "{said}"
    );
    let summary = optimum(&scratch, "results/block-optimum");
    let bound = serde_json::json!([{"variable": "stiffness_n_m", "bound": "upper"}]);
    assert_eq!(summary["best"]["on_bounds"], bound);
    assert_eq!(summary["notes"].as_array().unwrap().len(), 1);
    // A block has no balls.
    assert_eq!(summary["best"]["relative_amplitudes"][0]["value"], Value::Null);
    assert_eq!(scratch.json("optimize stiff.yaml --quiet --json"), summary);
}

/// The bytes do not depend on the number of threads, on interruptions, or on an extension to more
/// designs.
#[test]
fn a_search_is_reproducible() {
    let scratch = scratch();
    scratch.well("optimize balls.yaml --out one --threads 1 --quiet");
    scratch.well("optimize balls.yaml --out three --threads 3 --quiet");
    for name in fs::read_dir(scratch.path("one")).unwrap() {
        let name = name.unwrap().file_name();
        let read = |directory: &str| fs::read(scratch.path(directory).join(&name)).unwrap();
        assert!(read("one") == read("three"), "{name:?} differs");
    }
    // The first search ends in the middle of a batch.
    let text = scratch.text("balls.yaml");
    scratch.write("short.yaml", text.replace("designs: 9", "designs: 7"));
    scratch.well("optimize short.yaml --out again --quiet");
    let bytes = |directory: &str| scratch.bytes(&format!("{directory}/evaluations.parquet"));
    assert_ne!(bytes("again"), bytes("one"));
    scratch.well("optimize balls.yaml --out again --quiet");
    let all = |directory: &str| {
        let table = table(&scratch.path(directory).join("evaluations.parquet"));
        (numbers(&table, "stiffness_n_m"), numbers(&table, "mean"), texts(&table, "origin"))
    };
    assert_eq!(all("again"), all("one"));
    let origins = all("one").2;
    assert_eq!(origins.iter().filter(|origin| *origin == "spread").count(), 12);
    assert_eq!(optimum(&scratch, "again")["best"], optimum(&scratch, "one")["best"]);
    // The best design is reported from separate runs.
    let finals = scratch.table("one", "finalists");
    assert_eq!(
        texts(&finals, "role"),
        ["finalist", "finalist", "finalist", "finalist", "best", "best"]
    );
    let mean = numbers(&finals, "mean");
    assert!(!mean[..4].contains(&mean[4]), "{mean:?}");
    let best = &optimum(&scratch, "one")["best"];
    let relative = best["relative_amplitudes"].as_array().unwrap();
    assert!(
        relative.len() == 2 && relative.iter().all(|amplitude| amplitude["value"].is_f64()),
        "{best}"
    );
}

/// No design of the Pareto front dominates another one, and sensitivities come from runs.
#[test]
fn no_design_of_the_front_dominates_another() {
    let scratch = scratch();
    let block = "optimize:\n  minimize: [mean, most]\n  designs: 8\n  start_designs: 6\n  \
        finalists: 4\n  final_samples: 1\n  sensitivity: {from: runs, samples: 8}\n  \
        compare_with: {stiffness_n_m: 10700, balls: 2, material: steel}\n";
    scratch.write("two.yaml", format!("{BALLS}{block}"));
    let said = scratch.well("optimize two.yaml --out two --quiet");
    assert!(said.contains("on the Pareto front") && said.contains("compared with"), "{said}");
    assert!(said.contains(" µm (") && !said.contains(" m ("), "{said}");
    let pareto = scratch.table("two", "pareto");
    let (mean, most) = (numbers(&pareto, "mean"), numbers(&pareto, "most"));
    assert!(!mean.is_empty() && mean.len() <= 4);
    let is_on_front = column(&pareto, "on_front").as_boolean();
    let on_front: Vec<usize> = (0..mean.len()).filter(|row| is_on_front.value(*row)).collect();
    for &design in &on_front {
        for &other in &on_front {
            let better = mean[other] < mean[design] && most[other] < most[design];
            assert!(!better, "{design} {other}");
        }
    }
    let sensitivities = scratch.table("two", "sensitivities");
    assert_eq!(sensitivities.num_rows(), 6);
    assert!(texts(&sensitivities, "source").iter().all(|from| from == "runs"));
    let origins = texts(&scratch.table("two", "evaluations"), "origin");
    assert_eq!(origins[..2], ["compare_with", "compare_with"]);
}

/// A search without feasible designs says so, also by its exit code.
#[test]
fn limits_that_no_design_meets() {
    let scratch = scratch();
    let block = "optimize: {minimize: stop, subject_to: {stop: {at_most: 0.1}}, designs: 10}\n";
    scratch.write("never.yaml", format!("{BLOCK}{block}"));
    let ended = scratch.ended("optimize never.yaml --out never --quiet", 4);
    let stop = optimum(&scratch, "never")["best"]["responses"]["stop"]["value"].as_f64().unwrap();
    let unmet = format!("stop is {stop:.4} s (");
    assert_has(&ended.err, &["no design meets all limits; the nearest one: ", &unmet]);
    assert_has(&ended.out, &["  a limit is not met: ", &unmet, ", allowed: at most 0.1 s\n"]);
    let listed = &optimum(&scratch, "never")["best"]["unmet_limits"];
    assert!(listed[0].as_str().unwrap().starts_with(&unmet), "{listed}");
    scratch.well("report never");
    let page = scratch.text("never-report.html");
    assert_has(&page, &["does not meet all limits in its final runs: ", "at most 0.1 s."]);
}

/// Errors are reported before anything is computed, or as soon as they are detected.
#[test]
fn refusals() {
    let scratch = scratch();
    for (block, parts) in [
        ("{minimize: stops}", &["`optimize.minimize`", "stop (did you mean this?)"][..]),
        ("{designs: 20}", &["no objective, or too many", "0 objectives"]),
        ("{minimize: [stop, soon, stop]}", &["an objective twice"]),
        ("{minimize: stop, subject_to: {soon: {}}}", &["a limit without a number"]),
        ("{minimize: stop, subject_to: {soon: {at_least: 1, at_most: 0}}}", &["nothing meets"]),
        ("{minimize: stop, subject_to: {soon: {at_least: 2}}}", &["nothing meets it", "0 to 1"]),
        ("{minimize: stop, subject_to: {sooner: {at_least: 1}}}", &["not a response"]),
        ("{minimize: stop, designs: 5, start_designs: 6}", &["6 of 5 designs"]),
        ("{minimize: stop, designs: 1e6}", &["`optimize.designs`", "from 2 to 300"]),
        ("{minimize: stop, compare_with: {}}", &["compare_with.stiffness_n_m", "missing key"]),
        ("{minimize: stop, compare_with: {stiffness_n_m: 1e9}}", &["out of range", "30 to 200"]),
        ("{minimize: stop, compare_with: {stiffnes: 1}}", &["not a variable", "stiffness_n_m"]),
        ("{minimize: stop, sensitivity: {samples: 1}}", &["`optimize.sensitivity.samples`"]),
    ] {
        scratch.write("bad.yaml", format!("{BLOCK}optimize: {block}\n"));
        scratch.refused("optimize bad.yaml --out bad", parts);
    }
    scratch.write("none.yaml", BLOCK);
    scratch.refused("optimize none.yaml", &["`optimize` is missing", "optimize: {minimize"]);
    // All designs are at rest by 5 s.
    scratch.write("constant.yaml", format!("{BLOCK}optimize: {{maximize: soon, designs: 12}}\n"));
    let said = ["`soon` is 1 for all of the 10 designs so far"];
    scratch.tells("optimize constant.yaml --out constant --quiet", 2, &said);
    assert!(scratch.path("constant/evaluations.parquet").exists());
    // Results of another search are not overwritten.
    scratch.well("optimize block.yaml --out there --quiet");
    let text = scratch.text("block.yaml");
    scratch.write("other.yaml", text.replace("from: 30", "from: 40"));
    scratch.refused(
        "optimize other.yaml --out there",
        &["another search", "design.stiffness_n_m.from: 30.0 -> 40.0"],
    );
    scratch.write("other.yaml", text.replace("seed: 1", "seed: 2"));
    scratch.refused("optimize other.yaml --out there", &["    seed: 1 -> 2\n"]);
    let changed =
        text.replace("minimize: stop", "maximize: stop, subject_to: {stop: {at_most: 2}}");
    scratch.write("other.yaml", changed.replace("designs: 24", "designs: 30"));
    let ended = scratch.stickslip("optimize other.yaml --out there");
    let changed =
        ["optimize.minimize: \"stop\" -> not given", "optimize.subject_to: not given -> "];
    assert_has(&ended.err, &changed);
    assert!(!ended.err.contains("optimize.designs"), "{}", ended.err);
    scratch.write("there/evaluations.parquet", "PAR1");
    scratch.refused("optimize block.yaml --out there", &["evaluations.parquet"]);
    fs::create_dir(scratch.path("full")).unwrap();
    scratch.write("full/a", "a");
    scratch.refused(
        "optimize block.yaml --out full",
        &["this directory is not empty and holds no search"],
    );
}

/// An interrupted or missing first table does not prevent a search; results of an earlier end are
/// removed with the first new design; and a second process learns of the first one.
#[test]
fn a_search_continues_in_its_directory() {
    let scratch = scratch();
    let left = "here/evaluations.parquet.abc123.stickslip-partial";
    fs::create_dir_all(scratch.path(left).join("table")).unwrap();
    scratch.well("optimize block.yaml --out here --quiet");
    assert!(!scratch.path(left).exists());
    fs::remove_file(scratch.path("here/evaluations.parquet")).unwrap();
    scratch.well("optimize block.yaml --out here --quiet");
    let text = scratch.text("block.yaml");
    scratch.write("longer.yaml", text.replace("designs: 24", "designs: 26"));
    let lock = fs::File::open(scratch.path("here/lock")).unwrap();
    lock.lock().unwrap();
    scratch.tells("optimize longer.yaml --out here --quiet", 1, &["another process"]);
    lock.unlock().unwrap();
    scratch.well("optimize longer.yaml --out here --quiet");
    assert_eq!(optimum(&scratch, "here")["search"]["designs"], 26);
}

/// The CD-ROM drive of docs/optimize.md, by the study's own runs: the best design's 95 % quantile
/// is at most a sixth of that of the thesis's machine, it comes to rest more often, and its effect
/// without imbalance is small, whereas that machine does harm.
#[test]
fn the_cd_rom_drive() {
    let scratch = Scratch::new();
    let study = concat!(env!("CARGO_MANIFEST_DIR"), "/studies/cd-rom.yaml");
    let record: Value =
        serde_json::from_str(include_str!("../../docs/records/cd-rom.json")).unwrap();
    let names = ["balls", "ball", "ring", "ring_radius_m", "stiffness_n_m", "damping_n_s_m"];
    let row = |role: &str| {
        let values = &record["values"]["optimum"][role]["values"];
        let text = |name| values[name].to_string().replace('"', "");
        names.map(text).join(",")
    };
    let designs = [names.join(","), row("best"), row("compare_with")].join("\n");
    scratch.write("designs.csv", designs);
    scratch.well(&format!("evaluate {study} --designs designs.csv --out answers.parquet --quiet"));
    let answers = table(&scratch.path("answers.parquet"));
    // Three speeds of each.
    let both = |name: &str| {
        let all: Vec<f64> = numbers(&answers, name).into_iter().map(Option::unwrap).collect();
        (all[..3].to_vec(), all[3..].to_vec())
    };
    let largest = |values: &[f64]| values.iter().copied().fold(f64::MIN, f64::max);
    let least = |values: &[f64]| values.iter().copied().fold(f64::MAX, f64::min);
    let (best, thesis) = (both("vibration_95_high").0, both("vibration_95_low").1);
    assert!(6.0 * largest(&best) < largest(&thesis), "{best:?} {thesis:?}");
    let (best, thesis) = (both("quiet_low").0, both("quiet_high").1);
    assert!(least(&best) > least(&thesis), "{best:?} {thesis:?}");
    let (best, thesis) = both("relative");
    assert!(best.iter().all(|part| (0.9..1.1).contains(part)), "{best:?}");
    assert!(thesis.iter().all(|part| *part > 1.3), "{thesis:?}");
}

/// A few discrete values are tried once each, and then the search ends.
#[test]
fn an_exhausted_search_space_ends_the_search() {
    let scratch = Scratch::new();
    let choices = "design:\n  spring:\n    choices: {soft: {stiffness_n_m: 50}, firm: {stiffness_n_m: \
        100}, hard: {stiffness_n_m: 150}}\n";
    let text = BLOCK.replace("design: {stiffness_n_m: {from: 30, to: 200}}\n", choices);
    let block = "optimize: {minimize: stop, start_designs: 2, designs: 10}\n";
    scratch.write("few.yaml", format!("{text}{block}"));
    scratch.well("optimize few.yaml --out few --quiet");
    let evaluations = scratch.table("few", "evaluations");
    let mut springs = texts(&evaluations, "spring");
    springs.sort();
    assert_eq!(springs, ["firm", "hard", "soft"]);
    assert_eq!(optimum(&scratch, "few")["best"]["values"]["spring"], "soft");
    assert_eq!(
        optimum(&scratch, "few")["search"]["ended"],
        "all possible designs have been evaluated"
    );
}
