//! Positions of balls that touch: which of them are possible, which overlap, where friction holds balls that touch, and how many
//! of these positions are equilibria.
//!
//! In a position that is possible, no two balls are nearer than the angle at which they touch. Balls that touch are held if
//! any forces between them satisfy all conditions of friction ([`crate::model::held`]). Without contact, two balls can rest
//! nearer to each other than their diameters allow: they overlap.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::rest_form::{RestForm, direction};
use super::set_samples::sample;
use crate::model::{Gap, HeldContact, Machine, TOUCHING, held, wrap_to_pi, wrap_to_two_pi};

/// Number of positions in which two balls touch.
const TOUCHING_POSITIONS: usize = 4096;

impl RestForm {
    /// Returns whether balls with contact have these directions without overlap. Balls without contact may overlap.
    pub(super) fn are_apart(&self, directions: &[Complex<f64>]) -> bool {
        let apart = |([first, second], _, cosine): &([usize; 2], f64, f64)| {
            (directions[*first] * directions[*second].conj()).re <= *cosine
        };
        self.touching.as_ref().is_none_or(|touching| touching.pairs.iter().all(apart))
    }

    /// Returns whether balls with contact have these angles without overlap; those that touch do not overlap.
    pub(super) fn is_possible(&self, beta: &[f64]) -> bool {
        let apart = |([first, second], angle, _): &([usize; 2], f64, f64)| {
            let ahead = wrap_to_two_pi(beta[*second] - beta[*first]);
            ahead.min(TAU - ahead) >= angle - TOUCHING
        };
        self.touching.as_ref().is_none_or(|touching| touching.pairs.iter().all(apart))
    }

    /// Returns the angle at which two balls touch, rad; 0 without contact.
    pub(super) fn touching_angle(&self, first: usize, second: usize) -> f64 {
        let pairs = self.touching.iter().flat_map(|touching| &touching.pairs);
        let mut found = pairs.filter(|(pair, ..)| pair.contains(&first) && pair.contains(&second));
        found.next().map_or(0.0, |(_, angle, _)| *angle)
    }

    /// Returns the gaps between balls that touch at these angles, each from the ball behind to the ball ahead.
    pub(super) fn closed_gaps(&self, beta: &[f64]) -> Vec<Gap> {
        let Some(touching) = &self.touching else { return Vec::new() };
        let ordered = touching.pairs.iter().flat_map(|([first, second], angle, _)| {
            [[*first, *second], [*second, *first]].map(|contacts| (contacts, *angle))
        });
        let closed = ordered.filter(|([behind, ahead], angle)| {
            (wrap_to_two_pi(beta[*ahead] - beta[*behind]) - angle).abs() <= TOUCHING
        });
        let gap = |(contacts, angle): ([usize; 2], f64)| {
            let masses = contacts.map(|ball| self.mass[ball]);
            Gap::between_balls(contacts, angle, masses, touching.friction_coefficient)
        };
        closed.map(gap).collect()
    }

    /// Returns for each ball one that it moves with: the same one for all balls of a row in which each touches the next.
    pub(super) fn leaders(&self, beta: &[f64]) -> Vec<usize> {
        let mut leader: Vec<usize> = (0..beta.len()).collect();
        for gap in self.closed_gaps(beta) {
            let [from, to] = gap.contacts.map(|ball| leader[ball]);
            leader.iter_mut().filter(|ball| **ball == from).for_each(|ball| *ball = to);
        }
        leader
    }

    /// Returns whether friction holds all balls at these angles, with the forces between balls that touch.
    pub fn holds_with_forces(&self, beta: &[f64]) -> bool {
        let z = self.ring_centre(beta);
        let contact = |(beta, limit): (&f64, &f64)| {
            let pull = z * direction(*beta).conj();
            HeldContact { normal: 1.0 + pull.re, friction: pull.im, limit: *limit, weight: 1.0 }
        };
        let contacts: Vec<_> = beta.iter().zip(&self.friction_coefficient).map(contact).collect();
        z.is_finite() && held(&contacts, &self.closed_gaps(beta)).reserve >= 0.0
    }

    /// Returns positions in which two balls touch and the others are apart, evenly distributed: both orders of two balls at
    /// 4096 places, or quasi-random samples for more balls. None without contact.
    pub(super) fn touching_positions(&self) -> Vec<Vec<f64>> {
        let balls = self.mass.len();
        if self.touching.is_none() {
            return Vec::new();
        }
        let pairs: Vec<[usize; 2]> = (0..balls)
            .flat_map(|behind| (0..balls).map(move |ahead| [behind, ahead]))
            .filter(|[behind, ahead]| behind != ahead)
            .collect();
        let position = |index: usize| {
            let [behind, ahead] = pairs[index % pairs.len()];
            let touching = self.touching_angle(behind, ahead);
            let number = index / pairs.len();
            let mut beta = match balls {
                2 => {
                    vec![number as f64 / (TOUCHING_POSITIONS / pairs.len()) as f64 * TAU; balls]
                }
                _ => sample(balls, 0, number as u32),
            };
            beta[ahead] = wrap_to_two_pi(beta[behind] + touching);
            beta
        };
        let all = (0..TOUCHING_POSITIONS).map(position);
        all.filter(|beta| self.is_possible(beta)).collect()
    }
}

/// Returns the fraction of the positions in which two balls touch that are equilibria, with the force between the balls: to
/// about 0.0005 for two balls, and to about 0.02 for more. `None` for balls without contact, and if the balls leave no room
/// for such a position.
pub fn touching_set_fraction(machine: &Machine) -> Option<f64> {
    let form = RestForm::new(machine)?;
    let positions = form.touching_positions();
    let rests = positions.iter().filter(|beta| form.holds_with_forces(beta)).count();
    (!positions.is_empty()).then(|| rests as f64 / positions.len() as f64)
}

/// Returns whether two of the balls at the angles `beta` overlap: whether the angle between them is
/// smaller than the one at which they touch.
pub fn overlaps(machine: &Machine, beta: &[f64]) -> bool {
    let overlap = |first: usize, second: usize| {
        let touching = machine.contact_angle_rad(&machine.balls[first], &machine.balls[second]);
        wrap_to_pi(beta[first] - beta[second]).abs() < touching - TOUCHING
    };
    let count = machine.balls.len().min(beta.len());
    (0..count).any(|ball| (0..ball).any(|other| overlap(ball, other)))
}

#[cfg(test)]
mod tests {
    use super::RestForm;
    use crate::model::{Ball, BallContact, BallsInContact, Machine};

    /// The forces that hold balls in contact are those of the simulated system.
    #[test]
    fn positions_are_held_as_in_simulations() {
        let contact = BallContact { restitution: 0.5, friction_coefficient: 0.2 };
        let small = Ball { diameter_m: 2e-3, mass_kg: 4e-5, ..Ball::default() };
        let balls = vec![Ball::default(), small, Ball::default()];
        let machine =
            Machine { speed_rad_s: -173.1803, balls, contact: Some(contact), ..Machine::default() };
        let form = RestForm::new(&machine).expect("three balls");
        let (mut held, mut all) = (0, 0);
        for beta in form.touching_positions() {
            let system = BallsInContact::<3>::new(&machine, &contact, &beta).expect("three balls");
            let beta = [beta[0], beta[1], beta[2]];
            let held_there = system.rest_margin(&beta) >= 0.0;
            assert_eq!(form.closed_gaps(&beta).len(), 1, "{beta:?}");
            assert_eq!(form.holds_with_forces(&beta), held_there, "{beta:?}");
            held += u32::from(held_there);
            all += 1;
        }
        assert!(all > 1000 && held > all / 100 && held < all - all / 100, "{held} of {all}");
    }
}
