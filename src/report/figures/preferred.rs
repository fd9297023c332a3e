//! Figure: the preferred equilibria, where balls come to rest, over the equilibrium set; with three or more balls the imbalance
//! that remains there, as a vector in the frame of the disc.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use super::equilibrium_set::{SetLayers, angle_axis, set_layers};
use super::layers::{label_words, places, run_dots, run_tooltips};
use super::overlap;
use crate::analysis::residual_imbalance_vector;
use crate::classification::Label;
use crate::model::Machine;
use crate::report::chart::{Axis, Colour, Figure, Layer, Mark, Panel, Symbol, Tooltips, axis};
use crate::report::data::{PointFacts, ReportData};

/// Plots a panel for each point: angles of one or two balls, and the residual imbalance with three or more balls.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    let numbers: BTreeSet<usize> = data.details().map(|point| data.balls_of(point)).collect();
    let panels: Vec<Panel> = data
        .details()
        .flat_map(|point| match data.balls_of(point) {
            0 if data.study.model().contacts() > 1 => Vec::new(),
            0 | 1 => vec![one_contact(data, point)],
            2 => vec![pair(data, point)],
            _ => {
                let panel = residual_imbalance(data, point).into_iter();
                panel.map(|panel| Panel { title: counted(data, point), ..panel }).collect()
            }
        })
        .collect();
    let none_at_rest = data.points.iter().all(|point| point.equilibrium.runs == 0);
    if panels.is_empty() || (none_at_rest && !numbers.contains(&2)) {
        return None;
    }
    let counts = data.details().map(|point| {
        let fraction = point.set_fraction.map_or_else(String::new, |fraction| {
            format!(", and {:.0} % of all positions are equilibria", 100.0 * fraction)
        });
        let touching = data
            .touching_rests(point)
            .map_or_else(String::new, |rests| format!(", {rests} of them with balls that touch"));
        let (runs, rests) = (point.runs, point.equilibrium.runs);
        format!("{}: {rests} of {runs} runs came to rest{touching}{fraction}", point.title)
    });
    let alternative = counts.collect::<Vec<_>>().join("; ");
    let overlap = overlap::sentences(data);
    let set = match (numbers.contains(&2), overlap.is_empty()) {
        (true, true) => data.without_draws("Set, colours, stars and circles are those"),
        (true, false) => data.without_draws("Set, colours, stars, circles and band are those"),
        (false, _) if numbers.last().is_some_and(|balls| *balls > 2) => {
            data.without_draws("The masses and radii of the imbalance are those")
        }
        (false, _) => String::new(),
    };
    let left_out = format!("{overlap}{set}{}{}", data.left_out(), data.runs.left_out());
    let title = match numbers.contains(&0) {
        true => "Where the block comes to rest",
        false => "Preferred equilibria",
    };
    Figure::new("preferred-equilibria", title, caption(&numbers) + &left_out, alternative, panels)
}

/// Returns what the panels of these numbers of balls show.
fn caption(numbers: &BTreeSet<usize>) -> String {
    const SET: &str = "olour: amplitude of the table if the balls rest there; open: no equilibrium, friction does \
                       not hold the balls. Stars and circles: stable and unstable equilibria without friction.";
    let (has_one, has_two) = (numbers.contains(&1), numbers.contains(&2));
    match (numbers.first(), numbers.last()) {
        (Some(0), _) | (_, None) => "Position and time of rest of each run.".to_owned(),
        (_, Some(1)) => "Angle at rest and amplitude of each run.".to_owned(),
        (Some(2), Some(2)) => {
            format!("Each dot is a run at the angles where its balls came to rest. C{SET}")
        }
        _ => {
            let of_one =
                if has_one { " One ball: its angle and the amplitude of the table." } else { "" };
            let of_two =
                if has_two { format!(" Two balls: their angles; c{SET}") } else { String::new() };
            format!(
                "Each dot is a run at rest. For three and more balls, the axes are the components of the residual imbalance in \
                 the frame of the disc. The star marks a balanced machine. On the dashed circle, the residual imbalance is \
                 as large as the imbalance without balls.{of_one}{of_two}"
            )
        }
    }
}

fn counted(data: &ReportData<'_>, point: &PointFacts) -> String {
    let touching =
        data.touching_rests(point).map_or_else(String::new, |runs| format!(", {runs} touching"));
    format!("{}: {} of {} at rest{touching}", point.title, point.equilibrium.runs, point.runs)
}

/// Returns dots of the runs at rest with two columns of the sample.
fn dots(data: &ReportData<'_>, point: &PointFacts, x: &[f64], y: &[f64]) -> Layer {
    let runs = places(&data.runs, point.point_id, Some(Label::Equilibrium));
    let tooltips = run_tooltips(data, &runs);
    run_dots((&label_words(Label::Equilibrium), Colour::Ink, Symbol::Dot), (x, y), &runs, tooltips)
}

fn pair(data: &ReportData<'_>, point: &PointFacts) -> Panel {
    let column = |ball: usize| data.runs.position.get(ball - 1).map_or(&[][..], Vec::as_slice);
    let dots = dots(data, point, column(1), column(2));
    // The set is computed from the study alone.
    let of_study = data.study.point(point.point_id);
    let machine = of_study.model().ball_balancer();
    let (panels, cells) = (data.detailed.len(), data.budget.cells);
    let set =
        machine.and_then(|machine| set_layers(machine, &data.amplitude_unit(), panels, cells));
    let overlap = machine.map_or_else(Vec::new, overlap::layers);
    let (scale, layers) = match set {
        Some(SetLayers { scale, set, frictionless }) => {
            let above = overlap.into_iter().chain([dots]).chain(frictionless);
            (Some(scale), [set].into_iter().chain(above).collect())
        }
        None => (None, overlap.into_iter().chain([dots]).collect()),
    };
    let (x, y) = (angle_axis(1), angle_axis(2));
    Panel { title: counted(data, point), scale, ..Panel::new(x, y, layers) }
}

fn one_contact(data: &ReportData<'_>, point: &PointFacts) -> Panel {
    let runs = &data.runs;
    let place = runs.position.first().map_or(&[][..], Vec::as_slice);
    let amplitude_unit = data.amplitude_unit();
    let amplitude: Vec<f64> =
        runs.amplitude_m.iter().map(|metres| amplitude_unit.of(*metres)).collect();
    let unit = data.study.model().position_column(0).1;
    let (x, y, over): (Axis, Axis, &[f64]) = match data.study.model().ball_balancer() {
        None => (axis("position at rest", unit), axis("time to rest", "s"), &runs.time_to_rest_s),
        Some(_) => (angle_axis(1), axis("amplitude", &amplitude_unit.symbol), &amplitude),
    };
    let mut layer = dots(data, point, place, over);
    layer.colour = Colour::Label(Label::Equilibrium);
    Panel { title: counted(data, point), ..Panel::new(x, y, vec![layer]) }
}

/// Points of the circle of the imbalance without balls.
const CIRCLE: usize = 72;

/// Returns the panel of a point with three or more balls; `None` for a model that is no ball balancer.
fn residual_imbalance(data: &ReportData<'_>, point: &PointFacts) -> Option<Panel> {
    let of_study = data.study.point(point.point_id);
    let machine = of_study.model().ball_balancer()?;
    let unit = data.study.units().imbalance();
    let vectors: Vec<[f64; 2]> =
        vectors(data, machine).into_iter().map(|at| at.map(|part| unit.of(part))).collect();
    let [x, y] = [0, 1].map(|axis| vectors.iter().map(|vector| vector[axis]).collect::<Vec<f64>>());
    let imbalance = unit.of(machine.imbalance_mass_kg * machine.imbalance_radius_m);
    let of_circle = |step: usize| {
        let (sin, cos) = (TAU * step as f64 / CIRCLE as f64).sin_cos();
        [imbalance * cos, imbalance * sin]
    };
    let circle = Mark::Line { points: (0..=CIRCLE).map(of_circle).collect(), dashed: true };
    let balanced = Mark::dots(Symbol::Star, &[[0.0; 2]], Tooltips::default());
    let rests = dots(data, point, &x, &y);
    let runs = places(&data.runs, point.point_id, Some(Label::Equilibrium));
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
