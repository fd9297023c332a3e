//! The page of a search: its figures and notes against the tables.

use std::fs;

use serde_json::json;
use stickslip::report::chart::{AxisKind, Layer, Mark};
use stickslip::report::{OptimumData, notes, of_search};

use super::figure_of;
use crate::cli::optimize::BLOCK;
use crate::cli::support::{Scratch, assert_has, numbers};

/// Two balls that hardly have an influence: the amplitude relative to that without balls is the objective.
const BALLS: &str = "
schema: 1
name: balls
seed: 3
model: {kind: ball_balancer, parameters: {balls: 2}}
initial_conditions: {design: {monte_carlo: {samples: 6}}}
simulation: {end_time_s: 0.2}
design:
  ball_mass_kg: {from: 1.0e-4, to: 2.0e-4}
  stiffness_n_m: {from: 9.0e3, to: 12.0e3}
responses: {relative: {amplitude_mean: {relative: true}}, mean: {amplitude_mean: {}}}
optimize: {minimize: [relative, mean], designs: 6, start_designs: 6, finalists: 2}
";

fn searched(text: &str) -> Scratch {
    let scratch = Scratch::with(text);
    scratch.well("optimize a.yaml --out out --quiet");
    scratch
}

#[test]
fn convergence_is_the_least_value_so_far() {
    // The search for the stiffness of a block, with space-filling designs only.
    let scratch = searched(&format!(
        "{BLOCK}optimize: {{minimize: stop, designs: 8, start_designs: 8, finalists: 2, \
         compare_with: {{stiffness_n_m: 30}}}}\n"
    ));
    let before = scratch.files();
    assert_eq!(scratch.well("report out"), "out-report.html\n");
    assert_has(&scratch.text("out-report.html"), &["reference design", "best / reference"]);
    let after = scratch.files();
    assert!(before.iter().all(|(name, content)| after.get(name) == Some(content)));

    let data = OptimumData::read(&scratch.path("out")).unwrap();
    let figures = of_search(&data);
    let panel = &figure_of(&figures, "convergence").panels[0];
    let table = scratch.table("out", "evaluations");
    let times: Vec<f64> = numbers(&table, "stop").into_iter().map(Option::unwrap).collect();
    let dots = panel.layers.iter().find_map(|layer| match &layer.mark {
        Mark::Dots { x, y, .. } => Some((x.clone(), y.clone())),
        _ => None,
    });
    let designs: Vec<f64> = (0..8).map(f64::from).collect();
    assert_eq!(dots, Some((designs, times.clone())));
    let is_best = |layer: &&Layer| layer.name == "best so far";
    let Mark::Steps { points } = &panel.layers.iter().find(is_best).unwrap().mark else { panic!() };
    for [design, value] in points {
        let so_far = times[..=*design as usize].iter().copied().fold(f64::INFINITY, f64::min);
        assert_eq!(*value, so_far, "design {design}");
    }
    assert_eq!(points.last().unwrap()[0], 7.0);
    let panel = &figure_of(&figures, "variables").panels[0];
    let Mark::Dots { x, y, .. } = &panel.layers[0].mark else { panic!("dots") };
    let stiffness: Vec<f64> =
        numbers(&table, "stiffness_n_m").into_iter().map(Option::unwrap).collect();
    assert_eq!((x, y), (&stiffness, &times));
    // Everything depends on the only variable.
    let indices = figure_of(&figures, "sobol-indices");
    assert!(indices.panels.iter().any(|panel| panel.part == "stop"));

    // A search that has not ended has a page, too.
    let path = scratch.path("out/files.json");
    let mut list: serde_json::Value =
        serde_json::from_slice(&fs::read(&path).expect("a list")).expect("JSON");
    for name in ["finalists.parquet", "sensitivities.parquet", "optimum.json", "surrogates.json"] {
        fs::remove_file(scratch.path("out").join(name)).expect("a file of the search");
        list["files"].as_object_mut().expect("files").remove(name);
    }
    fs::write(&path, list.to_string()).expect("written");
    scratch.well("report out");
    let said = [
        "8 designs at 1 point each; not finished",
        "The search is not finished: all 8 designs are evaluated, and the final runs are missing.",
    ];
    assert_has(&scratch.text("out-report.html"), &said);
}

#[test]
fn two_objectives_have_a_front() {
    let scratch = searched(BALLS);
    scratch.well("report out");
    let data = OptimumData::read(&scratch.path("out")).unwrap();
    let figures = of_search(&data);
    let panel = &figure_of(&figures, "pareto").panels[0];
    let front = panel.layers.iter().find_map(|layer| match &layer.mark {
        Mark::Dots { x, y, .. } if layer.name == "Pareto front, final runs" => Some((x, y)),
        _ => None,
    });
    let (x, y) = front.unwrap();
    let pareto = scratch.table("out", "pareto");
    let of = |name: &str, factor: f64| -> Vec<f64> {
        numbers(&pareto, name).into_iter().map(|value| factor * value.unwrap()).collect()
    };
    assert_eq!((x, y), (&of("relative", 1.0), &of("mean", 1e6)));
    assert_eq!(figure_of(&figures, "convergence").panels.len(), 2);

    // A line for each design over the axes of all variables and objectives, from the least to the largest value.
    let panel = &figure_of(&figures, "parallel-coordinates").panels[0];
    let evaluations = scratch.table("out", "evaluations");
    let columns = ["ball_mass_kg", "stiffness_n_m", "relative", "mean"].map(|name| {
        let values = numbers(&evaluations, name).into_iter().map(Option::unwrap);
        let values: Vec<f64> = values.collect();
        let [low, high] = [f64::min, f64::max]
            .map(|pick| values.iter().copied().reduce(pick).expect("six designs"));
        values.into_iter().map(|value| (value - low) / (high - low)).collect::<Vec<f64>>()
    });
    let lines: Vec<f64> = panel.layers[1..]
        .iter()
        .filter_map(|layer| match &layer.mark {
            Mark::Line { points, .. } => Some(points.iter().map(|[_, y]| *y)),
            _ => None,
        })
        .flatten()
        .collect();
    assert_eq!(lines.len(), 6 * 5);
    for (design, line) in lines.chunks(5).enumerate() {
        let expected = columns.each_ref().map(|column| column[design]);
        assert!(line.iter().zip(expected).all(|(y, value)| (y - value).abs() < 1e-9), "{line:?}");
    }
    assert!(matches!(&panel.x.kind, AxisKind::Names(names) if names[1].starts_with("stiffness: ")));
}

/// The notes on the best design are those of `optimum.json`.
#[test]
fn notes_are_those_of_the_search() {
    let text = "
schema: 1
name: relative
seed: 3
model: {kind: ball_balancer, parameters: {balls: 1}}
initial_conditions: {design: {monte_carlo: {samples: 4}}}
simulation: {end_time_s: 1.0e-5}
design: {stiffness_n_m: {from: 9.0e3, to: 12.0e3}}
responses: {mean: {amplitude_mean: {}}, relative: {amplitude_mean: {relative: true}}}
optimize: {minimize: mean, designs: 4, start_designs: 4, finalists: 1}
";
    let scratch = searched(text);
    let mut data = OptimumData::read(&scratch.path("out")).unwrap();
    assert!(!data.best.is_empty());
    let mut with = |found: &[&str]| {
        data.optimum.as_mut().expect("the search is complete")["notes"] = json!(found);
        notes(&data)
    };
    assert_eq!(with(&[]), [""; 0]);
    let both = ["The balls have no use.", "`stiffness_n_m` lies on a bound."];
    assert_eq!(with(&both), both);
}
