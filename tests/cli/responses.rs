//! Responses of any study: in `run` and `summary`, in `points.parquet` and in the report, equal to those of `evaluate`; and
//! the units in which people read them.

use serde_json::json;

use super::support::{Scratch, assert_has, numbers, table, words};

/// A balancer at two speeds, with uncertain imbalance.
const STUDY: &str = "
schema: 1
name: short
seed: 4
model: {kind: ball_balancer, parameters: {ring_radius: 11.5 mm}}
sweep: [{grid: {speed: [-2000 rpm, -1600 rpm]}}]
uncertain: {imbalance_mass_kg: {normal: {mean: 5.6e-5, std_dev: 5.0e-6}}}
initial_conditions: {design: {monte_carlo: {samples: 24}}}
simulation: {end_time: 1.5 s}
responses:
  vibration: {amplitude_mean: {}}
  ratio: {amplitude_quantile: {fraction: 0.9, relative: true}}
  above: {amplitude_above: {limit: 60 µm}}
  rest: {at_rest_by_s: 1.2}
  half: median_time_to_rest
";

const NAMES: [&str; 5] = ["vibration", "ratio", "above", "rest", "half"];

/// Each estimate in `points.parquet` is that of `evaluate` for a design with the values of the study.
#[test]
fn a_point_has_the_responses_of_the_same_design() {
    let scratch = Scratch::ran(STUDY);
    let points = scratch.table("out", "points");
    let design = format!("{STUDY}design: {{stiffness_n_m: {{from: 1.0e4, to: 1.2e4}}}}\n");
    scratch.write("b.yaml", design);
    scratch.write("d.csv", "stiffness [N/mm]\n10.7\n");
    scratch.well("evaluate b.yaml --designs d.csv --out r.parquet --quiet");
    let evaluated = table(&scratch.path("r.parquet"));
    let mut known = 0;
    for name in NAMES {
        for ending in ["", "_standard_error", "_low", "_high"] {
            let found = numbers(&points, &format!("response_{name}{ending}"));
            assert_eq!(found, numbers(&evaluated, &format!("{name}{ending}")), "{name}{ending}");
            known += found.iter().flatten().count();
        }
        let [found, expected] =
            [(&points, format!("response_{name}_reason")), (&evaluated, format!("{name}_reason"))]
                .map(|(table, column)| words(table, &column));
        assert_eq!(found, expected, "{name}");
    }
    assert!(known > 25, "{known}");
    // Without balls, each run has the amplitude of its own machine: that of `relative_amplitude`.
    let runs = scratch.table("out", "runs");
    let of = |name: &str| numbers(&runs, name).into_iter().map(Option::unwrap).collect::<Vec<_>>();
    let (amplitude, relative) = (of("amplitude_m"), of("relative_amplitude"));
    let without: Vec<f64> =
        amplitude.iter().zip(&relative).map(|(metres, part)| metres / part).collect();
    let first = &without[..24];
    let number = |name: &str| {
        numbers(&points, &format!("response_{name}_without_balls"))[0]
            .expect("a residual amplitude")
    };
    assert!((number("vibration") / (first.iter().sum::<f64>() / 24.0) - 1.0).abs() < 1e-12);
    let above = first.iter().filter(|metres| **metres > 60e-6).count();
    assert_eq!(number("above"), above as f64 / 24.0);
    let columns = points.schema();
    assert!(columns.column_with_name("response_ratio_without_balls").is_none());
    assert!(columns.column_with_name("response_rest_without_balls").is_none());
    // The same answers as text: CSV, as the output is no terminal, and the same file.
    let printed = scratch.well("evaluate b.yaml --designs d.csv --quiet");
    scratch.well("evaluate b.yaml --designs d.csv --out r.csv --quiet");
    assert_eq!(printed, scratch.text("r.csv"));
    let mut rows = csv::Reader::from_reader(printed.as_bytes());
    let place = rows.headers().unwrap().iter().position(|name| name == "vibration_high").unwrap();
    let column: Vec<Option<f64>> =
        rows.records().map(|row| row.unwrap()[place].parse().ok()).collect();
    assert_eq!(column, numbers(&evaluated, "vibration_high"));
}

/// `run`, `summary` and the JSON of both show the responses; people read them in the units that the study writes.
#[test]
fn responses_are_printed_in_the_units_of_the_study() {
    let scratch = Scratch::with(STUDY);
    let printed = scratch.well("run a.yaml --out out");
    let points = scratch.table("out", "points");
    let parts = [
        "no balls",
        "speed [rpm]",
        "-2000",
        "-1600",
        "above: probability of a residual amplitude above 60 µm\n",
        "ratio: quantile 0.9 of the residual amplitude over the amplitude without balls\n",
    ];
    assert_has(&printed, &parts);
    assert!(!printed.contains("rad_s"), "{printed}");
    let vibration = numbers(&points, "response_vibration")[0].unwrap();
    let line = printed.lines().rfind(|line| line.trim_start().starts_with("0 ")).unwrap();
    let cells: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(cells[1], "-2000");
    let shown: f64 = cells[2].parse().unwrap();
    assert!((shown - 1e6 * vibration).abs() <= 0.051, "{shown} {vibration}");
    let summary = scratch.well("summary out");
    assert!(summary.ends_with(&printed), "{summary}");
    scratch.prints("summary out --format markdown", &["| point | speed [rpm] | vibration [µm] |"]);
    let again = scratch.stickslip("run a.yaml --out out --json");
    let report = again.json();
    let point = &report["points"][0];
    assert_eq!(point["responses"]["vibration"]["value"], json!(vibration));
    assert!((point["speed_rad_s"].as_f64().unwrap() + 209.4395).abs() < 1e-3);
    // Files stay in SI units.
    let speed = numbers(&points, "speed_rad_s")[0].unwrap();
    assert!((speed + 2000.0 * std::f64::consts::TAU / 60.0).abs() < 1e-9);
    // A chosen unit prevails; other units leave the runs as they are.
    scratch.write("a.yaml", format!("{STUDY}units: {{speed: rev/s, vibration: mm}}\n"));
    let ended =
        scratch.tells("run a.yaml --out out", 0, &["writing them anew from the finished runs"]);
    assert_has(&ended.out, &["speed [rev/s]", "vibration", "[mm]", "-33.3333", "above 0.06 mm"]);
    assert_eq!(numbers(&scratch.table("out", "points"), "response_vibration")[0], Some(vibration));
    scratch.well("report out");
    let page = scratch.text("out-report.html");
    assert_has(&page, &["<h2 id=\"responses\">Responses</h2>", "speed [rev/s]", "vibration [mm]"]);
    // The page begins with the sentences of the terminal.
    let sentence = ended.out.lines().find(|line| line.starts_with("At ")).unwrap();
    let conclusion = page.find("<h2 id=\"conclusion\">").unwrap();
    let (place, points) = (page.find(sentence).unwrap(), page.find("<h2 id=\"points\">").unwrap());
    assert!(conclusion < place && place < points);
    assert_has(&page, &["<p>The median amplitude is between "]);
    scratch.prints("check a.yaml", &["natural [rev/s]", "ring_radius", "11.5 mm"]);
}

/// A response that was added later is computed from the finished runs; the others keep their values.
#[test]
fn a_new_response_needs_no_run() {
    let (study, responses) = STUDY.split_at(STUDY.find("responses:").unwrap());
    let scratch = Scratch::with(study);
    let before = scratch.well("run a.yaml --out out");
    assert!(!before.contains("vibration: "), "{before}");
    let runs = scratch.bytes("out/runs.parquet");
    scratch.write("a.yaml", format!("{study}{responses}"));
    let ended =
        scratch.tells("run a.yaml --out out", 0, &["48 runs: 48 finished earlier, 0 computed"]);
    assert_has(&ended.out, &["vibration: mean residual amplitude\n"]);
    scratch.write("c.yaml", format!("{study}{responses}"));
    scratch.well("run c.yaml --out other --quiet");
    for table in ["runs", "points"] {
        let of = |directory: &str| scratch.bytes(&format!("{directory}/{table}.parquet"));
        assert_eq!(of("out"), of("other"), "{table}");
    }
    // The provenance holds the study, so that the bytes differ.
    assert_ne!(runs, scratch.bytes("out/runs.parquet"));
}
