//! Positions of two balls with contact in the plane of their angles: those in which the balls would overlap, and on the
//! edges of these the equilibria of balls that touch.

use std::f64::consts::{PI, TAU};

use crate::analysis::RestForm;
use crate::model::{Machine, wrap_to_two_pi};
use crate::report::chart::{Colour, Layer, Mark};
use crate::report::data::ReportData;

/// Number of positions in which two balls touch that are examined: one per degree of each way round the ring.
const POSITIONS: usize = 720;

/// Returns the angle Δ at which two balls with contact touch, counted from 1; `None` without contact.
pub fn contact_angle_rad(machine: &Machine, balls: [usize; 2]) -> Option<f64> {
    machine.contact?;
    let [one, other] = balls.map(|ball| machine.balls.get(ball - 1));
    Some(machine.contact_angle_rad(one?, other?))
}

/// Returns the band `|β₂ - β₁| < Δ`, modulo a turn, in which two balls of a machine would overlap, and the equilibria on its
/// edges if the machine has no other balls; nothing without contact.
pub fn layers(machine: &Machine, balls: [usize; 2]) -> Vec<Layer> {
    let Some(contact) = contact_angle_rad(machine, balls) else { return Vec::new() };
    let far = TAU - contact;
    // The band along the diagonal, and its continuation in two corners.
    let parts = [
        [
            vec![0.0, contact, far, TAU],
            vec![0.0, 0.0, far - contact, far],
            vec![contact, 2.0 * contact, TAU, TAU],
        ],
        [vec![0.0, contact], vec![far, TAU], vec![TAU; 2]],
        [vec![far, TAU], vec![0.0; 2], vec![0.0, contact]],
    ];
    let band = |[x, low, high]: [Vec<f64>; 3]| Mark::Band { x, low, high, steps: false };
    let band = |part| Layer::new("balls would overlap", Colour::Ink, band(part));
    let touching = touching_positions(machine, contact).map(|positions| {
        let mark = Mark::Line { points: held_parts(&positions), dashed: false };
        Layer::new("equilibria of balls that touch", Colour::Series(3), mark)
    });
    parts.into_iter().map(band).chain(touching).collect()
}

/// Returns the positions in which two balls touch, first those with ball 2 ahead of ball 1 and then those with ball 2 behind,
/// each with whether it is an equilibrium with the force between the balls; `None` for more balls and for a disc that stands
/// still.
fn touching_positions(machine: &Machine, contact: f64) -> Option<Vec<([f64; 2], bool)>> {
    let form = RestForm::new(machine).filter(|form| form.mass.len() == 2 && form.speed != 0.0)?;
    let position = |number: usize| {
        let first = number as f64 / POSITIONS as f64 * 2.0 * TAU;
        let second = if first < TAU { first + contact } else { first - contact };
        let beta = [first, second].map(wrap_to_two_pi);
        (beta, form.holds_with_forces(&beta))
    };
    Some((0..POSITIONS).map(position).collect())
}

/// Returns the ends of each run of positions that are equilibria, with a break after each run. A run ends where an angle
/// passes through 0.
fn held_parts(positions: &[([f64; 2], bool)]) -> Vec<[f64; 2]> {
    let adjacent = |one: &[f64; 2], other: &[f64; 2]| {
        one.iter().zip(other).all(|(one, other)| (one - other).abs() < PI)
    };
    let follow = |one: &([f64; 2], bool), other: &([f64; 2], bool)| {
        one.1 == other.1 && adjacent(&one.0, &other.0)
    };
    let runs = positions.chunk_by(follow).filter(|run| run.iter().all(|(_, rests)| *rests));
    let ends = runs.filter_map(|run| Some([run.first()?.0, run.last()?.0, [f64::NAN; 2]]));
    ends.flatten().collect()
}

/// Returns sentences for the caption; empty without contact.
pub fn sentences(data: &ReportData<'_>) -> String {
    let study = data.study;
    let known = data.details().filter(|point| point.point_id < study.point_count());
    let angles = known.flat_map(|point| {
        let point = study.point(point.point_id);
        let machine = point.model().ball_balancer();
        let balls = machine.map_or(0, |machine| machine.balls.len());
        let pairs =
            (1..balls).flat_map(|first| (first + 1..=balls).map(move |other| [first, other]));
        let angles = pairs.filter_map(|pair| contact_angle_rad(machine?, pair));
        angles.map(f64::to_degrees).collect::<Vec<f64>>()
    });
    let [low, high] = angles
        .fold([f64::INFINITY, 0.0_f64], |[low, high], angle| [low.min(angle), high.max(angle)]);
    if low > high {
        return String::new();
    }
    let [from, to] = [low, high].map(|angle| format!("{angle:.1}°"));
    let angle = if from == to { from } else { format!("{from} to {to}") };
    let of_two = match study.numbers_of_balls().into_inner() {
        (2, 2) => {
            " On its edges they touch, and the force between them adds the equilibria drawn there."
        }
        (fewest, most) if fewest <= 2 && most >= 2 => {
            " On its edges they touch, and the force between two balls without a third adds the equilibria drawn there."
        }
        _ => " On its edges they touch.",
    };
    format!(
        " Shaded band: the balls would overlap, because less than Δ = {angle} lies between their centres.{of_two}"
    )
}
