//! Equilibria without friction in which all balls lie on the line through the table's rest point.
//!
//! Balls without contact lie side by side in one place on the line, or opposite. Balls with contact lie in a row: each
//! touches the next, and the row's centre of mass is on the line. A row of balls with the masses `m` at the angles `δ`
//! from its centre acts like one ball of mass `Σ m cos δ`. The table must push the balls of a row towards its centre, so
//! that the forces between them press. Hence at most one row has more than one ball.

use std::f64::consts::PI;

use nalgebra::Complex;

use super::balance::balances;
use super::frictionless_position::{FrictionlessKind, FrictionlessPosition};
use super::identical_balls::{groups_of_identical, sorted_where_identical};
use super::rest_form::{RestForm, direction};
use crate::model::wrap_to_two_pi;

/// The distribution of the balls over the two sides of the line.
struct Sides {
    /// 1 or -1 for each ball.
    signs: Vec<f64>,
    /// Whether the exchange of sides is an exchange of identical balls.
    self_opposite: bool,
}

/// The balls of one side or both, with their places relative to the line.
struct Arrangement {
    /// For each ball, its angle from its side of the line.
    offsets: Vec<f64>,
    /// The sum of the masses that act along the line, negative on the other side.
    sum: f64,
    /// The balls of each row of two or more that touch, from the ball behind to the ball ahead.
    rows: Vec<Vec<usize>>,
}

/// Returns all positions on a line.
pub(super) fn on_a_line(form: &RestForm) -> Vec<FrictionlessPosition> {
    let mut found = Vec::new();
    if !form.transfer.is_finite() {
        return found;
    }
    for sides in sides(form) {
        for arrangement in arrangements(form, &sides.signs) {
            found.extend(candidates(form, &sides, &arrangement));
        }
    }
    found
}

fn candidates(
    form: &RestForm,
    sides: &Sides,
    arrangement: &Arrangement,
) -> Vec<FrictionlessPosition> {
    let (gamma, imbalance) = (form.transfer.arg(), form.imbalance.norm());
    let Arrangement { offsets, sum, rows } = arrangement;
    let balanced_rotor = imbalance == 0.0;
    // An undamped suspension moves along the force, and every direction is equivalent.
    let every_direction = balanced_rotor && form.transfer.im == 0.0;
    let sine = match balanced_rotor {
        true if every_direction => 0.0,
        true => f64::INFINITY,
        false => sum / imbalance * gamma.sin(),
    };
    if !sine.is_finite() || sine.abs() > 1.0 {
        return Vec::new();
    }
    let together = sides.signs.iter().all(|sign| *sign > 0.0);
    let branches =
        [(sine.asin(), FrictionlessKind::A1Plus), (PI - sine.asin(), FrictionlessKind::A1Minus)];
    // If the exchange of sides is an exchange of identical balls, the two branches coincide.
    let one_branch = sides.self_opposite || every_direction;
    let branches = branches.into_iter().take(if one_branch { 1 } else { 2 });
    let candidate = |(turn, branch): (f64, FrictionlessKind)| {
        let line = form.imbalance.arg() + gamma + turn;
        let side = |sign: f64| line + if sign > 0.0 { 0.0 } else { PI };
        let places = sides.signs.iter().zip(offsets);
        let beta: Vec<f64> =
            places.map(|(sign, offset)| wrap_to_two_pi(side(*sign) + offset)).collect();
        // Balanced positions are counted separately.
        if balances(form, &beta)
            || !rows.iter().all(|row| is_pressed(form, &beta, row))
            || !form.is_possible(&beta)
        {
            return None;
        }
        let kind = match (together, form.mass.len()) {
            (true, _) => branch,
            (false, 2) => FrictionlessKind::A2,
            (false, _) => FrictionlessKind::Other,
        };
        let beta = sorted_where_identical(&beta, &form.balls);
        Some(FrictionlessPosition { kind, beta, family_dimension: usize::from(every_direction) })
    };
    branches.filter_map(candidate).collect()
}

/// Returns whether all forces between the balls of a row press.
fn is_pressed(form: &RestForm, beta: &[f64], row: &[usize]) -> bool {
    let z = form.ring_centre(beta);
    let pushed = |ball: usize| form.mass[ball] * (z * direction(beta[ball]).conj()).im;
    let forces = row.iter().scan(0.0, |sum, ball| {
        *sum += pushed(*ball);
        Some(*sum)
    });
    // Behind the last ball there is no force.
    forces.take(row.len() - 1).all(|force| force > 0.0)
}

/// Returns the arrangements of the balls on their sides that differ by more than an exchange of identical balls.
fn arrangements(form: &RestForm, signs: &[f64]) -> Vec<Arrangement> {
    let of_side = |side: f64| (0..signs.len()).filter(move |ball| signs[*ball] == side);
    if form.touching.is_none() {
        let sum = signs.iter().zip(&form.mass).map(|(sign, mass)| sign * mass).sum();
        return vec![Arrangement { offsets: vec![0.0; signs.len()], sum, rows: Vec::new() }];
    }
    let sides: [Vec<usize>; 2] = [1.0, -1.0].map(|side| of_side(side).collect());
    if sides.iter().all(|balls| balls.len() > 1) {
        return Vec::new();
    }
    let [near, far] = sides.map(|balls| orders(form, &balls));
    let pairs = near.iter().flat_map(|near| far.iter().map(move |far| [near, far]));
    let arrangement = |rows: [&Vec<usize>; 2]| {
        let mut arrangement =
            Arrangement { offsets: vec![0.0; signs.len()], sum: 0.0, rows: Vec::new() };
        for (row, sign) in rows.into_iter().zip([1.0, -1.0]) {
            arrangement.sum += sign * put_in_a_row(form, row, &mut arrangement.offsets);
            if row.len() > 1 {
                arrangement.rows.push(row.clone());
            }
        }
        arrangement
    };
    pairs.map(arrangement).collect()
}

/// Sets the angles of the balls of a row from its centre, and returns the mass that acts there.
fn put_in_a_row(form: &RestForm, row: &[usize], offsets: &mut [f64]) -> f64 {
    let mut place = 0.0;
    let mut pull = Complex::from(0.0);
    for (index, ball) in row.iter().enumerate() {
        if index > 0 {
            place += form.touching_angle(row[index - 1], *ball);
        }
        offsets[*ball] = place;
        pull += direction(place) * form.mass[*ball];
    }
    row.iter().for_each(|ball| offsets[*ball] -= pull.arg());
    pull.norm()
}

/// Returns all orders of some balls that differ by more than an exchange of identical balls.
fn orders(form: &RestForm, balls: &[usize]) -> Vec<Vec<usize>> {
    if balls.is_empty() {
        return vec![Vec::new()];
    }
    // Of identical balls, the first in the list comes first.
    let is_first = |place: &usize| {
        let ball = &form.balls[balls[*place]];
        balls[..*place].iter().all(|other| form.balls[*other] != *ball)
    };
    let starting_with = |place: usize| {
        let others = [&balls[..place], &balls[place + 1..]].concat();
        let rest = orders(form, &others).into_iter();
        rest.map(move |rest| [vec![balls[place]], rest].concat())
    };
    (0..balls.len()).filter(is_first).flat_map(starting_with).collect()
}

/// Returns the distributions of the balls over the two sides of a line, modulo the exchange of identical balls and of the
/// two sides.
fn sides(form: &RestForm) -> Vec<Sides> {
    let groups = groups_of_identical(&form.balls);
    let mut ways = vec![Vec::new()]; // number of each group on the other side
    for group in &groups {
        let more = |way: &Vec<usize>| -> Vec<Vec<usize>> {
            (0..=group.len()).map(|other| [way.as_slice(), &[other]].concat()).collect()
        };
        ways = ways.iter().flat_map(more).collect();
    }
    let exchanged = |way: &[usize]| -> Vec<usize> {
        groups.iter().zip(way).map(|(group, other)| group.len() - other).collect()
    };
    let signs = |way: &[usize]| {
        let mut signs = vec![1.0; form.balls.len()];
        for (group, &other) in groups.iter().zip(way) {
            for &ball in &group[group.len() - other..] {
                signs[ball] = -1.0;
            }
        }
        signs
    };
    let distinct = ways.iter().filter(|way| **way <= exchanged(way));
    distinct.map(|way| Sides { signs: signs(way), self_opposite: *way == exchanged(way) }).collect()
}
