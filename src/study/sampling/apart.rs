//! Start angles of balls with contact: no two of them overlap.
//!
//! Angles that are drawn from the whole circle are mapped: ball 1 stays, and the distances of the others ahead of it, in
//! their order, are scaled by `(2π - ΣΔ) / 2π` to leave the room `ΣΔ` that the balls take; the room of the balls in between
//! is added. The draws, and the strata of a design, are those of the angles before the mapping. Angles from a smaller box
//! are drawn again in their cell until no balls overlap.

use std::f64::consts::TAU;

use crate::model::{InvalidParameter, Machine, TOUCHING, wrap_to_two_pi};
use crate::study::sampling::sampling_design::{Design, SampleId};

/// The most draws of the angles of a run.
const MOST_DRAWS: u64 = 10_000;

/// Two balls that overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Overlap {
    /// The ball behind and the ball ahead, from 1.
    pub balls: [usize; 2],
    /// The angle between their centres, rad.
    pub angle: f64,
    /// The angle at which they touch, rad.
    pub touching: f64,
}

/// Returns the start state of a sample for a machine with contact between its balls.
///
/// # Errors
/// Returns an error if the balls do not fit into the ring or into the cell of the sample, or if a given start state has
/// balls that overlap.
pub(crate) fn start_apart(
    design: &Design,
    id: SampleId,
    machine: &Machine,
) -> Result<Vec<f64>, InvalidParameter> {
    let balls = machine.balls.len();
    let angles = 2..2 + balls;
    let mut start = design.coordinates(id);
    let fault = |name: &str, found: String, allowed| InvalidParameter {
        name: name.to_owned(),
        found,
        allowed,
    };
    if balls < 2 {
        return Ok(start);
    }
    let room =
        TAU - (0..balls).map(|ball| touching_angle(machine, ball, (ball + 1) % balls)).sum::<f64>();
    if room <= 0.0 {
        let found = format!("balls that take {} rad of the ring", TAU - room);
        return Err(fault("ball_diameter_m", found, "less than the whole ring, 6.283 rad"));
    }
    if design.covers_circle(angles.clone()) {
        move_apart(machine, &mut start[angles]);
        return Ok(start);
    }
    let mut draw = 0;
    loop {
        let Some(overlap) = first_overlap(machine, &start[angles.clone()]) else {
            return Ok(start);
        };
        draw += 1;
        if !design.is_random() || draw > MOST_DRAWS {
            let Overlap { balls: [behind, ahead], angle, touching } = overlap;
            let found = format!("{angle} rad between balls {behind} and {ahead}");
            let allowed = if design.is_random() {
                "room for the balls in each cell of the box"
            } else {
                "balls that do not overlap"
            };
            return Err(fault("beta", format!("{found}, which touch at {touching} rad"), allowed));
        }
        start = design.coordinates_drawn_again(id, angles.clone(), draw);
    }
}

fn touching_angle(machine: &Machine, behind: usize, ahead: usize) -> f64 {
    machine.contact_angle_rad(&machine.balls[behind], &machine.balls[ahead])
}

/// Moves angles from anywhere on the circle apart, so that no balls overlap.
fn move_apart(machine: &Machine, angles: &mut [f64]) {
    let first = angles[0];
    let ahead = |angle: f64| wrap_to_two_pi(angle - first);
    let mut order: Vec<usize> = (1..angles.len()).collect();
    order.sort_by(|left, right| ahead(angles[*left]).total_cmp(&ahead(angles[*right])));
    let ring: Vec<usize> = std::iter::once(0).chain(order).collect();
    let next = |place: usize| ring[(place + 1) % ring.len()];
    let touching: Vec<f64> =
        (0..ring.len()).map(|place| touching_angle(machine, ring[place], next(place))).collect();
    let scale = (TAU - touching.iter().sum::<f64>()) / TAU;
    let mut taken = 0.0;
    for (place, ball) in ring.iter().enumerate().skip(1) {
        taken += touching[place - 1];
        angles[*ball] = wrap_to_two_pi(first + scale * ahead(angles[*ball]) + taken);
    }
}

/// Returns the first two neighbours that overlap.
pub(crate) fn first_overlap(machine: &Machine, angles: &[f64]) -> Option<Overlap> {
    let mut order: Vec<usize> = (0..angles.len()).collect();
    let place = |ball: usize| wrap_to_two_pi(angles[ball]);
    order.sort_by(|left, right| place(*left).total_cmp(&place(*right)));
    let neighbours = (0..order.len()).map(|i| [order[i], order[(i + 1) % order.len()]]);
    neighbours.filter(|[behind, ahead]| behind != ahead).find_map(|[behind, ahead]| {
        let angle = wrap_to_two_pi(angles[ahead] - angles[behind]);
        let touching = touching_angle(machine, behind, ahead);
        let overlap = Overlap { balls: [behind + 1, ahead + 1], angle, touching };
        (angle < touching - TOUCHING).then_some(overlap)
    })
}

#[cfg(test)]
mod tests {
    use super::{first_overlap, move_apart};
    use crate::model::{Ball, Machine};

    /// The mapping keeps ball 1 and the order, leaves no overlap, and maps the whole circle onto all free places.
    #[test]
    fn mapped_balls_do_not_overlap() {
        let small = Ball { diameter_m: 2e-3, ..Ball::default() };
        let balls = vec![Ball::default(), small, Ball::default()];
        let machine = Machine { balls, ..Machine::default() };
        let mut nearest = f64::INFINITY;
        // The first draw would have all balls in one place, which have no order.
        for k in 1..5000 {
            let draw = |factor: f64| (f64::from(k) * factor).fract() * std::f64::consts::TAU;
            let before = [draw(0.754_877), draw(0.569_84), draw(0.438_29)];
            let mut after = before;
            move_apart(&machine, &mut after);
            assert_eq!(after[0], before[0]);
            assert_eq!(first_overlap(&machine, &after), None);
            let order = |angles: [f64; 3]| {
                let ahead =
                    |ball: usize| (angles[ball] - angles[0]).rem_euclid(std::f64::consts::TAU);
                ahead(1) < ahead(2)
            };
            assert_eq!(order(after), order(before));
            let touching = machine.contact_angle_rad(&machine.balls[0], &machine.balls[1]);
            let apart = (after[1] - after[0]).rem_euclid(std::f64::consts::TAU) - touching;
            nearest = nearest.min(apart);
        }
        assert!(nearest < 1e-2, "{nearest}");
    }
}
