//! `stickslip evaluate`: a table of designs, and individual requests.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Stdio};

use serde_json::{Value, json};

use super::support::{Scratch, json_lines, numbers, table};
use crate::support::{cases, rows};

/// A block on a spring that starts at rest at 45 mm, with closed-form stops.
pub const BLOCK: &str = "
schema: 1
name: block
seed: 1
model: {kind: block_on_spring}
initial_conditions:
  box: {position_m: [0.045, 0.045]}
  design: {monte_carlo: {samples: 4}}
simulation: {method: event, tolerance: {relative: 1e-12, absolute: 1e-12}}
design: {stiffness_n_m: {from: 10, to: 200}}
responses:
  stop: median_time_to_rest
  by: {at_rest_by_s: 0.6}
  amplitude: {amplitude_mean: {}}
";

/// A balancer of one to three balls, for a short time.
pub const BALLS: &str = "
schema: 1
name: balls
seed: 2003
model: {kind: ball_balancer, parameters: {balls: 2}}
uncertain:
  imbalance_mass_kg: {truncated_normal: {mean: 5.6e-5, std_dev: 5e-6, min: 4e-5, max: 7.2e-5}}
initial_conditions: {design: {monte_carlo: {samples: 24}}}
simulation: {end_time_s: 1.5}
design:
  speed_rad_s: {from: -260, to: -140}
  balls: {from: 1, to: 3}
  material:
    choices:
      steel: {ball_mass_kg: 1.4e-4, friction_coefficient: 2.75e-3}
      ceramic: {ball_mass_kg: 5.8e-5, friction_coefficient: 1.5e-3}
responses:
  mean: {amplitude_mean: {}}
  relative: {amplitude_mean: {relative: true}}
  spread: {amplitude_std_dev: {}}
  most: {amplitude_quantile: {fraction: 0.9}}
  worst: {amplitude_worst: {}}
  above: {amplitude_above: {limit: 2e-5}}
  rest: {at_rest_by_s: 1.2}
  half: median_time_to_rest
";

pub const DESIGNS: [&str; 5] =
    ["-160,2,steel", "-216,1,ceramic", "-216,3,steel", "-250,2,steel", "-216,2,ceramic"];

pub fn scratch() -> Scratch {
    let scratch = Scratch::new();
    scratch.write("block.yaml", BLOCK);
    scratch.write("balls.yaml", BALLS);
    scratch.write("d.csv", format!("speed_rad_s,balls,material\n{}\n", DESIGNS.join("\n")));
    scratch
}

pub fn server(scratch: &Scratch, arguments: &str) -> Child {
    scratch.command(arguments).stdin(Stdio::piped()).spawn().unwrap()
}

pub fn ask(scratch: &Scratch, arguments: &str, lines: &[impl ToString]) -> Vec<Value> {
    let lines: String = lines.iter().map(|line| line.to_string() + "\n").collect();
    let ended = scratch.fed(arguments, lines);
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    json_lines(&ended.out)
}

/// The stopping time is that of the closed form: with `x_s = μ N / k`, each half swing of `π / ω`
/// reduces the distance by `2 x_s` until it is within `x_s`; at 100 N/m there are two half swings,
/// at 36 N/m one, and at 20 N/m the block never moves.
#[test]
fn a_block_stops_at_the_closed_form_time() {
    let scratch = scratch();
    let requests = [100.0, 36.0, 20.0].map(|k| json!({"id": k, "stiffness_n_m": k}));
    let answers = ask(&scratch, "evaluate block.yaml --designs -", &requests);
    let pi = std::f64::consts::PI;
    for (answer, (k, time, by)) in
        answers.iter().zip([(100.0, pi / 5.0, 0.0), (36.0, pi / 6.0, 1.0), (20.0, 0.0, 1.0)])
    {
        let value = |name: &str| answer["responses"][name]["value"].as_f64().unwrap();
        assert_eq!(answer["id"], k);
        assert!((value("stop") - time).abs() < 1e-8, "{k}: {} {time}", value("stop"));
        assert_eq!((value("by"), value("amplitude")), (by, 0.0), "{k}");
        assert_eq!((&answer["runs"], &answer["failed"]), (&json!(4), &json!(0)));
    }
}

/// A design has the runs of the study with its values written in: its responses follow from that
/// study's `runs.parquet`.
#[test]
fn a_design_is_the_study_with_its_variables_set() {
    let scratch = scratch();
    let request = r#"{"id": "a", "speed_rad_s": -216, "balls": 3, "material": "ceramic"}"#;
    let answer = &ask(&scratch, "evaluate balls.yaml --designs -", &[request])[0];
    let values = "balls: 3, speed_rad_s: -216, ball_mass_kg: 5.8e-5, friction_coefficient: 1.5e-3";
    let plain = BALLS.split("design:\n").next().unwrap().replace("balls: 2", values);
    scratch.write("plain.yaml", plain);
    scratch.well("run plain.yaml --out plain --quiet");
    let runs = scratch.table("plain", "runs");
    let amplitudes: Vec<f64> = numbers(&runs, "amplitude_m").into_iter().flatten().collect();
    assert_eq!(amplitudes.len(), 24);
    let mean = amplitudes.iter().sum::<f64>() / 24.0;
    let found = |name: &str| answer["responses"][name]["value"].as_f64().unwrap();
    assert!((found("mean") / mean - 1.0).abs() < 1e-12);
    assert_eq!(found("worst"), amplitudes.iter().copied().fold(0.0, f64::max));
    let rests = numbers(&runs, "time_to_rest_s");
    let by = rests.iter().filter(|time| time.is_some_and(|time| time <= 1.2)).count();
    assert_eq!(found("rest"), by as f64 / 24.0);
}

/// The bytes do not depend on the number of threads, a reordered table has the same rows in that
/// order, and requests give the same numbers as the table.
#[test]
fn threads_and_order_change_nothing() {
    let scratch = scratch();
    scratch.well("evaluate balls.yaml --designs d.csv --out one.parquet --threads 1 --quiet");
    scratch.well("evaluate balls.yaml --designs d.csv --out three.parquet --threads 3 --quiet");
    assert_eq!(scratch.bytes("one.parquet"), scratch.bytes("three.parquet"));
    let order = [3, 0, 4, 2, 1];
    let lines = order.map(|at| DESIGNS[at]).join("\n");
    scratch.write("other.csv", format!("speed_rad_s,balls,material\n{lines}\n"));
    scratch.well("evaluate balls.yaml --designs other.csv --out other.parquet --quiet");
    let [first, other] = ["one.parquet", "other.parquet"].map(|name| table(&scratch.path(name)));
    for name in ["mean", "relative_high", "spread_standard_error", "rest_low", "half", "balls"] {
        let [first, other] = [&first, &other].map(|table| numbers(table, name));
        assert_eq!(order.map(|at| first[at]).to_vec(), other, "{name}");
    }
    let requests = DESIGNS.map(|design| {
        let parts: Vec<&str> = design.split(',').collect();
        let [speed, balls] = [0, 1].map(|at| parts[at].parse::<f64>().unwrap());
        json!({"speed_rad_s": speed, "balls": balls, "material": parts[2]})
    });
    let answers = ask(&scratch, "evaluate balls.yaml --designs -", &requests);
    let means: Vec<Option<f64>> =
        answers.iter().map(|answer| answer["responses"]["mean"]["value"].as_f64()).collect();
    assert_eq!(means, numbers(&first, "mean"));
}

/// Each design has a row and an answer at each point of a sweep.
#[test]
fn points_of_a_sweep_are_separate() {
    let scratch = scratch();
    let sweep = "sweep: [{grid: {normal_force_n: [10, 5]}}]\n";
    scratch.write("swept.yaml", format!("{BLOCK}{sweep}"));
    let answers = ask(&scratch, "evaluate swept.yaml --designs -", &[r#"{"stiffness_n_m": 100}"#]);
    let points = answers[0]["points"].as_array().unwrap();
    let forces: Vec<&Value> = points.iter().map(|point| &point["normal_force_n"]).collect();
    assert_eq!(forces, [&json!(10.0), &json!(5.0)]);
    // With half of the friction, 45 mm minus four times 10 mm is within 5 mm, on the edge; minus
    // two times is not.
    let times: Vec<f64> =
        points.iter().map(|point| point["responses"]["stop"]["value"].as_f64().unwrap()).collect();
    assert!(times[1] > times[0] + 0.5, "{times:?}");
    scratch.write("k.csv", "stiffness_n_m\n100\n36\n");
    scratch.well("evaluate swept.yaml --designs k.csv --out k.parquet --quiet");
    let rows = table(&scratch.path("k.parquet"));
    let number = |name| numbers(&rows, name);
    assert_eq!(number("stiffness_n_m"), [100.0, 100.0, 36.0, 36.0].map(Some));
    assert_eq!(number("normal_force_n"), [10.0, 5.0, 10.0, 5.0].map(Some));
}

/// Points have the responses of studies without a sweep, whether or not their runs share a queue:
/// the first two points have 4000 runs together, and the third one has its own queue.
#[test]
fn points_with_a_common_queue_are_separate() {
    let scratch = Scratch::new();
    let many =
        BLOCK.replace("[0.045, 0.045]", "[-0.045, 0.045]").replace("samples: 4", "samples: 2000");
    let sweep = "sweep: [{grid: {normal_force_n: [10, 5, 7]}}]\n";
    scratch.write("swept.yaml", format!("{many}{sweep}"));
    let request = [r#"{"stiffness_n_m": 100}"#];
    let swept = ask(&scratch, "evaluate swept.yaml --designs -", &request);
    let points = swept[0]["points"].as_array().unwrap();
    assert_eq!(points.len(), 3);
    for (point, force) in points.iter().zip([10, 5, 7]) {
        let parameters = format!("block_on_spring, parameters: {{normal_force_n: {force}}}");
        scratch.write("single.yaml", many.replace("block_on_spring", &parameters));
        let single = ask(&scratch, "evaluate single.yaml --designs -", &request);
        assert_eq!(single[0]["responses"], point["responses"], "{force} N");
        assert_eq!(single[0]["runs"], json!(2000));
    }
}

#[test]
fn requests_that_make_no_sense_are_answered() {
    let scratch = scratch();
    let lines: Vec<[String; 3]> = cases(
        r#"{"id": 1, "balls": 2, "material": "steel"} ¦ speed_rad_s ¦ missing
{"id": 1, "speed_rad_s": "x", "balls": 2, "material": "steel"} ¦ speed_rad_s ¦ not a number
{"id": 1, "speed_rad_s": null, "balls": 2, "material": "steel"} ¦ speed_rad_s ¦ neither a number nor text
{"id": 1, "speed_rad_s": -300, "balls": 2, "material": "steel"} ¦ speed_rad_s ¦ out of range
{"id": 1, "speed_rad_s": -200, "balls": 2.5, "material": "steel"} ¦ balls ¦ not a whole number
{"id": 1, "speed_rad_s": -200, "balls": 9, "material": "steel"} ¦ balls ¦ out of range
{"id": 1, "speed_rad_s": -200, "balls": 2, "material": "wood"} ¦ material ¦ not a choice
{"id": 1, "speed_rad_s": -200, "balls": 2, "material": 3} ¦ material ¦ not a choice
{"id": 1, "speed_rad_s": -200, "balls": 2, "material": "steel", "mass": 3} ¦ mass ¦ not a variable
{"id": 1, "balls": 2, "balls": 3} ¦ balls ¦ given twice"#,
    )
    .collect();
    let requests: Vec<&String> = lines.iter().map(|[line, ..]| line).collect();
    let answers = ask(&scratch, "evaluate balls.yaml --designs -", &requests);
    assert_eq!(answers.len(), requests.len());
    for (answer, [line, variable, problem]) in answers.iter().zip(&lines) {
        assert_eq!(answer["id"], 1, "{line}");
        let error = &answer["error"];
        let found = [&error["variable"], &error["problem"]];
        assert_eq!(found, [variable.as_str(), problem], "{line}");
        assert!(error["found"].is_string() && error["allowed"].is_string(), "{answer}");
    }
}

#[test]
fn tables_and_studies_that_make_no_sense_are_refused() {
    let scratch = scratch();
    let to = "--out r.parquet --quiet";
    for row in rows(
        r#"a.csv ¦ speed_rad_s,balls\n-200,2\n ¦ no column material ¦ speed_rad_s, balls, material
b.csv ¦ speed_rad_s,balls,material,x\n-200,2,steel,1\n ¦ column x ¦ unknown column
c.csv ¦ speed_rad_s,balls,material\n-200,2,steel\n-20,2,steel\n ¦ c.csv:3 ¦ row 2, column speed_rad_s ¦ from -260 to -140
e.csv ¦ speed_rad_s,balls,material\n-200,2.5,steel\n ¦ row 1, column balls ¦ not a whole number ¦ 2.5
f.csv ¦ speed_rad_s,balls,material\n-200,2,stel\n ¦ row 1, column material ¦ steel (did you mean this?)
g.csv ¦ speed_rad_s,balls,material\n-200,,steel\n ¦ row 1, column balls ¦ an empty value
h.csv ¦ speed_rad_s,balls,material\n ¦ a table without rows
i.txt ¦ speed_rad_s,balls,material\n ¦ ends in neither .csv nor .parquet
j.csv ¦ speed_rad_s,balls,material\nnan,2,steel\n ¦ row 1, column speed_rad_s ¦ finite
k.csv ¦ speed_rad_s,balls,material\n-inf,2,steel\n ¦ row 1, column speed_rad_s ¦ -inf
l.csv ¦ speed_rad_s,balls,material\n1e999,2,steel\n ¦ column speed_rad_s ¦ 1e999
m.csv ¦ speed_rad_s,balls,material\n-200,two,steel\n ¦ row 1, column balls ¦ "two"
n.csv ¦ speed_rad_s,balls,material\n-200,99999999999999999999,steel\n ¦ column balls ¦ range
o.csv ¦ speed_rad_s,balls,material\n-200,2,steel\n-200,2\n ¦ o.csv:3 ¦ wrong number of values
p.csv ¦ speed_rad_s,balls,balls\n-200,2,2\n ¦ column balls ¦ given twice
q.csv ¦  ¦ q.csv ¦ empty
r.csv ¦ speed_rad_s,balls,material\n-200,2,steel\n-200,2,"st\neel"\n ¦ row 2, column material ¦ not a choice
s.parquet ¦ PAR1PAR1 ¦ s.parquet ¦ found:
t.parquet ¦ speed_rad_s,balls,material\n-200,2,steel\n ¦ t.parquet ¦ found:"#,
    ) {
        scratch.write(&row[0], &row[1]);
        scratch.refused(&format!("evaluate balls.yaml --designs {} {to}", row[0]), &row[2..]);
    }
    scratch.write("u.csv", b"speed_rad_s,balls,\xff\n");
    std::fs::create_dir(scratch.path("v.csv")).expect("the directory does not exist yet");
    for (name, part) in [("none.csv", "none.csv"), ("u.csv", "not UTF-8"), ("v.csv", "a directory")]
    {
        scratch.refused(&format!("evaluate balls.yaml --designs {name} {to}"), &[name, part]);
    }
    let nowhere = "evaluate balls.yaml --designs d.csv --out nowhere/r.parquet";
    scratch.refused(nowhere, &["nowhere/r.parquet", "a directory that can be written to"]);
    scratch.refused("evaluate balls.yaml --designs d.csv --out d.csv", &["exists already"]);
    for name in ["r.tsv", "r.JSON", "r.xlsx"] {
        let arguments = format!("evaluate balls.yaml --designs d.csv --out {name}");
        scratch.refused(&arguments, &[name, "as Parquet or CSV only", "r.parquet"]);
    }
    scratch.refused("evaluate balls.yaml --designs - --out r.parquet", &["standard output"]);
    for row in rows(
        r"from: -260 ¦ from: -100 ¦ design.speed_rad_s ¦ reversed range
balls: {from: 1, to: 3} ¦ balls: {from: 1, to: 9} ¦ design.balls.to ¦ 1 to 8
  speed_rad_s: {from ¦   sped_rad_s: {from ¦ design.sped_rad_s ¦ speed_rad_s (did you mean this?)
ceramic: {ball_mass_kg: 5.8e-5, friction ¦ ceramic: {friction ¦ design.material.choices.ceramic ¦ set different parameters
ball_mass_kg: 5.8e-5 ¦ ball_mass_kg: -1 ¦ ceramic.ball_mass_kg ¦ no physical meaning
fraction: 0.9 ¦ fraction: 1.5 ¦ responses.most.amplitude_quantile.fraction ¦ above 0 and below 1
at_rest_by_s: 1.2 ¦ at_rest_by_s: 99 ¦ responses.rest.at_rest_by_s ¦ at most the end time
  half: median ¦   mean_low: median ¦ responses.mean_low ¦ another column has this name
  half: median ¦   runs: median ¦ responses.runs ¦ another column has this name
speed_rad_s: {from: -260, to: -140} ¦ imbalance_mass_kg: {from: 1e-5, to: 2e-5} ¦ design.imbalance_mass_kg ¦ varied twice
  balls: {from: 1 ¦   ball_mass_2_kg: {from: 1e-4, to: 2e-4}\n  balls: {from: 1 ¦ design.ball_mass_2_kg ¦ a ball that every design has
simulation: ¦ precision: {equilibrium_fraction: 0.1, max_runs: 100}\nsimulation: ¦ precision ¦ have the same runs
responses: ¦ expect: ¦ expect",
    ) {
        assert!(BALLS.contains(&row[0]), "{row:?}");
        scratch.write("wrong.yaml", BALLS.replacen(&row[0], &row[1], 1));
        scratch.refused("evaluate wrong.yaml --designs d.csv --out r.parquet", &row[2..]);
    }
    // A swept parameter's column is an error, too.
    let swept = "sweep: [{grid: {damping_n_s_m: [1, 2]}}]\nresponses:\n  damping_n_s_m: median_time_to_rest\n";
    scratch.write("wrong.yaml", BALLS.replacen("responses:\n", swept, 1));
    let parts = ["responses.damping_n_s_m", "another column has this name"];
    scratch.refused("evaluate wrong.yaml --designs d.csv --out r.parquet", &parts);
    let without = BALLS.split("responses:").next().unwrap();
    scratch.write("wrong.yaml", without);
    scratch.refused("evaluate wrong.yaml --designs -", &["`responses` is missing"]);
}

/// Ctrl-C ends a waiting server with exit code 130.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupt() {
    let scratch = scratch();
    let mut child = server(&scratch, "evaluate block.yaml --designs -");
    let mut input = child.stdin.take().unwrap();
    let mut output = BufReader::new(child.stdout.take().unwrap());
    writeln!(input, "{{\"id\": 1, \"stiffness_n_m\": 100}}").unwrap();
    // The first answer shows that the server is running.
    output.read_line(&mut String::new()).unwrap();
    super::interrupt::send(&child, "INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    drop(input);
}
