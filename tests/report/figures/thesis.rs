//! Figures of the thesis, by their marks.

use std::f64::consts::TAU;
use std::fmt::Write;

use stickslip::model::Machine;
use stickslip::report::chart::{Figure, Layer, Mark, Panel};
use stickslip::report::contour::area;
use stickslip::report::figures::{branches, motion, sets};
use stickslip::table::Table;

use super::shipped;
use crate::cli::support::Scratch;
use crate::docs::generated::compare_or_write;

/// The thesis's figure 5.1 from the command's table.
fn figure_5_1() -> Figure {
    let scratch = Scratch::new();
    let study = format!("{}/studies/equilibrium-set.yaml", env!("CARGO_MANIFEST_DIR"));
    scratch
        .well(&format!("equilibria {study} --no-set --grid 8 --speeds=-150:-250:401 --out sets"));
    let (table, about) = Table::of_itself(&scratch.path("sets"), "frictionless").unwrap();
    assert_eq!(about["study"], "equilibrium-set");
    branches(&table, &Machine::default()).unwrap().unwrap()
}

fn panel<'a>(figure: &'a Figure, title: &str) -> &'a Panel {
    figure.panels.iter().find(|panel| panel.title == title).unwrap()
}

/// Abscissas of a panel's lines, solid or dashed, in order.
fn speeds(panel: &Panel, wanted: bool) -> Vec<f64> {
    let lines = panel.layers.iter().filter_map(|layer| match &layer.mark {
        Mark::Line { points, dashed } if *dashed == wanted => Some(points),
        _ => None,
    });
    let mut found: Vec<f64> = lines.flatten().map(|point| point[0]).collect();
    found.retain(|speed| speed.is_finite());
    found.sort_by(f64::total_cmp);
    found.dedup();
    found
}

/// Between which speeds A1+ and A1- are not there: `(1 - ω²)² ≤ 4ζ²ω² ((2m / (m_I e))² - 1)`.
fn gap() -> [f64; 2] {
    let machine = Machine::default();
    let natural = machine.natural_frequency_rad_s();
    let damping = machine.damping_n_s_m / (2.0 * machine.total_mass_kg() * natural);
    let balls: f64 = machine.balls.iter().map(|ball| ball.mass_kg).sum();
    let ratio =
        balls * machine.ring_radius_m / (machine.imbalance_mass_kg * machine.imbalance_radius_m);
    // 1 - ω² = ±2 c ω with c² = ζ² (ratio² - 1).
    let c = damping * (ratio * ratio - 1.0).sqrt();
    [-c, c].map(|c| natural * (c + (c * c + 1.0).sqrt()))
}

/// Thesis section 5.1: below the natural frequency only A1+ is stable, above it only B1; A1+ and A1- are
/// not there from 179.3 to 184.0 rad/s. The grid has steps of 0.25 rad/s.
#[test]
fn stability_changes_at_the_natural_frequency() {
    let figure = figure_5_1();
    let titles: Vec<&str> = figure.panels.iter().map(|panel| panel.title.as_str()).collect();
    assert_eq!(titles, ["A1+", "A1−", "A2", "B1"]);
    let natural = Machine::default().natural_frequency_rad_s();
    for name in titles {
        let panel = panel(&figure, name);
        let (stable, unstable) = (speeds(panel, false), speeds(panel, true));
        let all: Vec<f64> = [stable.clone(), unstable.clone()].concat();
        if name.starts_with("A1") {
            let [below, above] = gap();
            assert!((below - 179.3).abs() < 0.05 && (above - 184.0).abs() < 0.05);
            assert!(all.iter().all(|speed| *speed < below || *speed > above), "{name}");
            for end in [below, above] {
                assert!(all.iter().any(|speed| (speed - end).abs() <= 0.25), "{name}: {end}");
            }
            assert_eq!(all.len(), 383);
        } else {
            assert_eq!(all.len(), 401, "{name}");
        }
        match name {
            "A1+" => {
                assert!(stable.iter().all(|speed| *speed < natural) && stable.len() == 118);
                assert!(unstable.iter().all(|speed| *speed > natural));
            }
            "B1" => {
                assert!((stable[0] - natural).abs() < 0.25 && stable[stable.len() - 1] == 250.0);
                assert!(unstable.iter().all(|speed| *speed < natural));
            }
            _ => assert!(stable.is_empty(), "{name}"),
        }
        let rule = panel.layers.iter().find_map(|layer| match &layer.mark {
            Mark::Rule { upright: true, at, .. } => Some(*at),
            _ => None,
        });
        assert_eq!(rule, Some(natural));
    }
}

/// The rings of what is covered in a panel of an equilibrium set.
fn covered(panel: &Panel) -> &[Vec<[f64; 2]>] {
    let Mark::Regions { rings, .. } = &panel.layers[2].mark else { panic!() };
    rings
}

/// How many parts the rings are on the torus: rings that meet across an edge of the square are one.
fn parts_on_the_torus(rings: &[Vec<[f64; 2]>]) -> usize {
    // On which stretch of an edge a ring is.
    let on_edge = |ring: &[[f64; 2]], axis: usize, at: f64| -> Vec<f64> {
        let near = |point: &&[f64; 2]| (point[axis] - at).abs() < 1e-9;
        ring.iter().filter(near).map(|point| point[1 - axis]).collect()
    };
    let span = |values: Vec<f64>| {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        values.into_iter().fold(ends, |[low, high], v| [low.min(v), high.max(v)])
    };
    let meet = |one: &[[f64; 2]], other: &[[f64; 2]]| {
        (0..2).any(|axis| {
            let [a, b] = [on_edge(one, axis, 0.0), on_edge(other, axis, TAU)].map(span);
            a[0].max(b[0]) < a[1].min(b[1])
        })
    };
    let mut parts: Vec<usize> = (0..rings.len()).collect();
    for one in 0..rings.len() {
        for other in 0..rings.len() {
            if meet(&rings[one], &rings[other]) {
                let (keep, gone) = (parts[one], parts[other]);
                parts.iter_mut().filter(|part| **part == gone).for_each(|part| *part = keep);
            }
        }
    }
    parts.sort_unstable();
    parts.dedup();
    parts.len()
}

/// Thesis figures 5.3 and 5.7: at -216.3772 rad/s 77 % of all positions are equilibria; the others are two
/// parts, each other's mirror images.
#[test]
fn the_set_has_77_percent_and_its_rest_two_parts() {
    let figures = sets(&shipped("equilibrium-set"));
    let ids: Vec<&str> = figures.iter().map(|figure| figure.id.as_str()).collect();
    assert_eq!(ids, ["equilibrium-set", "equilibrium-surface"]);
    let rings = covered(&figures[0].panels[0]);
    let share = 1.0 - rings.iter().map(|ring| area(ring)).sum::<f64>() / (TAU * TAU);
    assert!((share - 0.77).abs() < 0.005, "{share}");
    assert_eq!(parts_on_the_torus(rings), 2);
    for panel in figures.iter().flat_map(|figure| &figure.panels) {
        for layer in &panel.layers {
            let Mark::Regions { rings, values } = &layer.mark else { continue };
            assert_eq!(rings.len(), values.len());
            for ring in rings {
                assert!(ring.len() > 2 && ring.iter().flatten().all(|value| value.is_finite()));
                assert!(ring.first() != ring.last(), "the last point is the first again");
            }
        }
    }
}

/// Thesis figure 5.4: parts about the equilibria without friction at 2.75e-4, everything at 3.5e-3.
#[test]
fn friction_makes_the_set_grow() {
    let figures = sets(&shipped("equilibrium-friction"));
    let panels = &figures[0].panels;
    let open: Vec<f64> = panels
        .iter()
        .map(|panel| 1.0 - covered(panel).iter().map(|ring| area(ring)).sum::<f64>() / (TAU * TAU))
        .collect();
    assert!(open[0] < 0.02 && open.windows(2).all(|pair| pair[0] < pair[1]), "{open:?}");
    assert_eq!(open[3], 1.0);
    // A line round each part: six, and those that an edge of the square cuts in two.
    let edge = &panels[0].layers[3];
    let Mark::Line { points, .. } = &edge.mark else { panic!() };
    let pieces = points.split(|point| point[0].is_nan()).count();
    assert!((6..=12).contains(&pieces), "{pieces}");
}

/// Thesis figure 5.2: no balls, 2.17e-5 m; nothing above 5.51e-5 m.
#[test]
fn the_surface_has_the_thesis_amplitudes() {
    let figures = sets(&shipped("equilibrium-set"));
    assert!(figures[1].alternative.contains("up to 55.1 µm"), "{}", figures[1].alternative);
    let names: Vec<&str> =
        figures[1].panels[0].layers.iter().map(|layer| layer.name.as_str()).collect();
    assert!(names.contains(&"amplitude without balls: 21.7 µm"));
}

/// The motion of a run, from the command.
fn replayed(study: &str, run_id: u64, options: &str) -> Figure {
    let scratch = Scratch::new();
    let file = format!("{}/studies/{study}.yaml", env!("CARGO_MANIFEST_DIR"));
    scratch.well(&format!("run {file} --out results --quiet"));
    scratch.well(&format!("replay results {run_id} --out motion {options}"));
    let (table, _) = Table::of_itself(&scratch.path("motion"), "trajectory").unwrap();
    let case = shipped(study).planned_run(run_id).case.unwrap();
    let case = options.is_empty().then_some(&case);
    motion(&table, 2, "title", case).unwrap().unwrap()
}

fn line(layer: &Layer) -> &[[f64; 2]] {
    let Mark::Line { points, .. } = &layer.mark else { panic!() };
    points
}

/// The kind of thesis figure 5.6: at rest after 2.3 s, and drawn on in closed form to 16.5 s.
#[test]
fn a_run_at_rest_goes_on_to_its_end_time() {
    let figure = replayed("one-run", 0, "");
    let [angles, speeds, x, y] = &figure.panels[..] else { panic!() };
    for panel in [angles, speeds, x, y] {
        let (last, range) = (line(&panel.layers[0]).last().unwrap(), panel.x.range.unwrap());
        assert!((last[0] - 16.5).abs() < 1e-9 && (range[1] - 16.5).abs() < 1e-9);
    }
    for layer in &speeds.layers {
        assert!(line(layer).iter().all(|point| point[0] < 2.5 || point[1].abs() < 1e-6));
        assert!(line(layer).iter().any(|point| point[0] < 1.0 && point[1].abs() > 50.0));
    }
    let form = stickslip::analysis::RestForm::new(&Machine::default()).unwrap();
    let beta: Vec<f64> = angles.layers.iter().map(|layer| line(layer).last().unwrap()[1]).collect();
    let rest = form.rest_point(&beta) * form.ring_radius_m * 1e6;
    for (panel, due) in [(x, rest.re), (y, rest.im)] {
        let points = line(&panel.layers[0]);
        assert!((points[points.len() - 1][1] - due).abs() < 1e-6, "{due}");
        // The closed form goes on where the integration has ended: no step is larger than those before.
        let steps = |from: f64, to: f64| {
            let pairs = points.windows(2).filter(|pair| pair[0][0] > from && pair[1][0] < to);
            pairs
                .map(|pair| ((pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0])).abs())
                .fold(0.0, f64::max)
        };
        assert!(steps(2.43, 2.6) < 1.2 * steps(2.2, 2.43));
    }
}

/// Thesis figure 5.15: both balls side by side, and never at rest.
#[test]
fn both_balls_run_side_by_side() {
    for (run_id, mean) in [(0, 72.3), (1, 133.5)] {
        let figure = replayed("side-by-side", run_id, "--times 54:55:2001");
        for panel in &figure.panels[..2] {
            assert_eq!(panel.layers.len(), 1);
            assert_eq!(panel.layers[0].name, "balls 1 and 2, side by side");
        }
        let speeds = line(&figure.panels[1].layers[0]);
        let found = speeds.iter().map(|point| point[1]).sum::<f64>() / speeds.len() as f64;
        assert!((found - mean).abs() < 0.2, "{found}");
    }
}

/// What the figures are made of: kinds of marks and how many there are, in words.
#[test]
fn what_figures_are_made_of() {
    let mut text = String::from(
        "What figures are made of, compared by tests/report/figures; `scripts/docs` writes it.\n",
    );
    let mut figures = vec![figure_5_1()];
    for study in ["equilibrium-set", "equilibrium-friction", "equilibrium-speed"] {
        figures.extend(sets(&shipped(study)).into_iter().filter(|f| f.id == "equilibrium-set"));
    }
    for figure in figures {
        writeln!(text, "\n{}: {}", figure.id, figure.alternative).unwrap();
        for panel in &figure.panels {
            let axes = [&panel.x, &panel.y].map(|axis| format!("{} [{}]", axis.name, axis.unit));
            writeln!(text, "  {} | {} | {:?}", panel.title, axes.join(" | "), panel.scale).unwrap();
            for layer in &panel.layers {
                let kind = match &layer.mark {
                    Mark::Line { dashed: true, .. } => "dashed line".to_owned(),
                    Mark::Line { .. } => "line".to_owned(),
                    Mark::Dots { x, symbol, .. } => format!("{} of {symbol:?}", x.len()),
                    Mark::Regions { values, .. } => format!("{} regions", values.len()),
                    Mark::Rule { label, .. } => format!("rule {label}"),
                    _ => "other".to_owned(),
                };
                writeln!(text, "    {:?} {:?}: {kind}", layer.colour, layer.name).unwrap();
            }
        }
    }
    compare_or_write("tests/data/figures.txt", &text);
}
