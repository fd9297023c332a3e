//! Positions of balls that touch: which of them are possible, which overlap, and where friction holds balls that touch.
//!
//! In a position that is possible, no two balls are nearer than the angle at which they touch. Balls that touch are held if
//! any forces between them satisfy all conditions of friction ([`crate::model::held`]). Without contact, two balls can rest
//! nearer to each other than their diameters allow: they overlap.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::rest_form::{RestForm, direction};
use crate::model::{Gap, HeldContact, Machine, TOUCHING, held, wrap_to_pi, wrap_to_two_pi};

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
