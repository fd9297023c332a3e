//! The panel of a point with three or more balls: the imbalance that remains where the balls come to rest, as a vector in the
//! frame of the disc.

use std::f64::consts::TAU;

use super::layers::{label_words, places, run_dots, run_tooltips};
use crate::analysis::residual_imbalance_vector;
use crate::classification::Label;
use crate::model::Machine;
use crate::report::chart::{Axis, Colour, Layer, Mark, Panel, Symbol, Tooltips, axis};
use crate::report::data::{PointFacts, ReportData};

/// Points of the circle of the imbalance without balls.
const CIRCLE: usize = 72;

/// Returns the panel; `None` if the study lacks the point.
pub fn panel(data: &ReportData<'_>, point: &PointFacts) -> Option<Panel> {
    let known =
        (point.point_id < data.study.point_count()).then(|| data.study.point(point.point_id))?;
    let machine = known.model().ball_balancer()?;
    let unit = data.study.units().imbalance();
    let runs = places(&data.runs, point.point_id, Some(Label::Equilibrium));
    let vectors: Vec<[f64; 2]> =
        vectors(data, machine).into_iter().map(|at| at.map(|part| unit.of(part))).collect();
    let [x, y] = [0, 1].map(|axis| vectors.iter().map(|vector| vector[axis]).collect::<Vec<f64>>());
    let tooltips = run_tooltips(data, &runs);
    let rests = run_dots(
        (&label_words(Label::Equilibrium), Colour::Ink, Symbol::Dot),
        (&x, &y),
        &runs,
        tooltips,
    );
    let imbalance = unit.of(machine.imbalance_mass_kg * machine.imbalance_radius_m);
    let of_circle = |step: usize| {
        let (sin, cos) = (TAU * step as f64 / CIRCLE as f64).sin_cos();
        [imbalance * cos, imbalance * sin]
    };
    let circle = Mark::Line { points: (0..=CIRCLE).map(of_circle).collect(), dashed: true };
    let balanced = Mark::Dots {
        symbol: Symbol::Star,
        x: vec![0.0],
        y: vec![0.0],
        tooltips: Tooltips::default(),
    };
    let reached = runs.iter().filter_map(|&place| vectors.get(place)).flatten();
    let most = reached.fold(imbalance, |most, part| most.max(part.abs()));
    let range = (most > 0.0).then_some([-1.1 * most, 1.1 * most]);
    let plane = |name: &str| Axis { range, ..axis(name, &unit.symbol) };
    let layers = vec![
        Layer::new("as large as without balls", Colour::Faint, circle),
        rests,
        Layer::new("balanced", Colour::Series(0), balanced),
    ];
    let (x, y) = (plane("parallel to the imbalance"), plane("perpendicular to it"));
    Some(Panel::new(x, y, layers))
}

/// Returns the residual imbalance of each run of the sample, kg m; not a number for a run without positions.
fn vectors(data: &ReportData<'_>, machine: &Machine) -> Vec<[f64; 2]> {
    let positions = &data.runs.position;
    let vector = |place: usize| {
        let beta: Vec<f64> = (0..machine.balls.len())
            .map(|ball| {
                positions.get(ball).and_then(|all| all.get(place)).copied().unwrap_or(f64::NAN)
            })
            .collect();
        let residual = residual_imbalance_vector(machine, &beta);
        [residual.re, residual.im]
    };
    (0..data.runs.run_id.len()).map(vector).collect()
}
