//! Positions of two balls with contact in the plane of their angles: those in which the balls would overlap, and on the
//! edges of these the equilibria of balls that touch.

use std::f64::consts::{PI, TAU};

use crate::analysis::RestForm;
use crate::model::{Machine, wrap_to_two_pi};
use crate::report::chart::{Colour, Layer, Mark};
use crate::report::data::ReportData;

/// Number of positions in which two balls touch that are examined: one per degree of each way round the ring.
const POSITIONS: usize = 720;

/// Returns the angle Δ at which two balls with contact touch; `None` without contact, and for another number of balls.
pub fn contact_angle_rad(machine: &Machine) -> Option<f64> {
    machine.contact?;
    let [first, second] = &machine.balls[..] else { return None };
    Some(machine.contact_angle_rad(first, second))
}

/// Returns the band `|β₂ - β₁| < Δ`, modulo a turn, in which the two balls of a machine would overlap, and the equilibria on
/// its edges; nothing without contact.
pub fn layers(machine: &Machine) -> Vec<Layer> {
    let Some(contact) = contact_angle_rad(machine) else { return Vec::new() };
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
/// each with whether it is an equilibrium with the force between the balls; `None` for a disc that stands still.
fn touching_positions(machine: &Machine, contact: f64) -> Option<Vec<([f64; 2], bool)>> {
    let form = RestForm::new(machine).filter(|form| form.speed != 0.0)?;
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
    let adjacent = |here: &[f64; 2], next: &[f64; 2]| {
        here.iter().zip(next).all(|(angle, next_angle)| (angle - next_angle).abs() < PI)
    };
    let follow = |here: &([f64; 2], bool), next: &([f64; 2], bool)| {
        here.1 == next.1 && adjacent(&here.0, &next.0)
    };
    let runs = positions.chunk_by(follow).filter(|run| run.iter().all(|(_, rests)| *rests));
    let ends = runs.filter_map(|run| Some([run.first()?.0, run.last()?.0, [f64::NAN; 2]]));
    ends.flatten().collect()
}

/// Returns sentences for the caption; empty without contact.
pub fn sentences(data: &ReportData<'_>) -> String {
    let study = data.study;
    let angles = data.details().filter_map(|point| {
        let point = study.point(point.point_id);
        Some(contact_angle_rad(point.model().ball_balancer()?)?.to_degrees())
    });
    let [low, high] = angles
        .fold([f64::INFINITY, 0.0_f64], |[low, high], angle| [low.min(angle), high.max(angle)]);
    if low > high {
        return String::new();
    }
    let [from, to] = [low, high].map(|angle| format!("{angle:.1}°"));
    let angle = if from == to { from } else { format!("{from} to {to}") };
    format!(
        " Shaded band: two balls would overlap, because less than Δ = {angle} lies between their centres. On its edges they \
         touch, and the force between them adds the equilibria drawn there."
    )
}
