//! The largest amplitude at rest of balls with contact, near positions of rest that are known.
//!
//! With the forces between balls that touch, the edge of the equilibrium set has no closed form. A pattern search (R. Hooke
//! and T. A. Jeeves, J. ACM 8 (1961) 212, doi:10.1145/321062.321069) moves each ball alone, until it touches the next one, and
//! each group of balls that touch as a whole. It halves its step where no move leads to a rest with a larger amplitude.

use super::rest_form::RestForm;
use crate::model::wrap_to_two_pi;

/// The first and the last step, rad.
const STEPS: [f64; 2] = [0.1, 1e-8];
/// The largest number of positions that are examined.
const MOST_POSITIONS: usize = 4096;

impl RestForm {
    /// Returns the largest amplitude, m, that the search reaches from a position of rest.
    pub(super) fn climbed_m(&self, start: &[f64]) -> f64 {
        let (mut beta, mut amplitude_m) = (start.to_vec(), self.amplitude_m(start));
        let (mut step, mut positions) = (STEPS[0], 0);
        while step > STEPS[1] && positions < MOST_POSITIONS {
            let moved = self.moved(&beta, step);
            positions += moved.len();
            let is_better = |beta: &Vec<f64>| {
                self.amplitude_m(beta) > amplitude_m && self.holds_with_forces(beta)
            };
            match moved.into_iter().find(is_better) {
                Some(found) => (amplitude_m, beta) = (self.amplitude_m(&found), found),
                None => step *= 0.5,
            }
        }
        amplitude_m
    }

    /// Returns the positions after a step of each ball, and of each group of balls that touch, in both directions.
    fn moved(&self, beta: &[f64], step: f64) -> Vec<Vec<f64>> {
        let leader = self.leaders(beta);
        let moved = |ball: usize, together: bool, sign: f64| {
            let moves = |other: usize| other == ball || (together && leader[other] == leader[ball]);
            let room = |from: usize, to: usize| {
                let ahead = wrap_to_two_pi(sign * (beta[to] - beta[from]));
                (ahead - self.touching_angle(from, to)).max(0.0)
            };
            let pairs = (0..beta.len()).flat_map(|from| (0..beta.len()).map(move |to| (from, to)));
            let between = pairs.filter(|(from, to)| moves(*from) && !moves(*to));
            let reach = between.map(|(from, to)| room(from, to)).fold(step, f64::min);
            let turned = |(other, beta): (usize, &f64)| {
                wrap_to_two_pi(if moves(other) { beta + sign * reach } else { *beta })
            };
            beta.iter().enumerate().map(turned).collect()
        };
        let each = (0..beta.len()).flat_map(|ball| [(ball, false), (ball, true)]);
        each.flat_map(|(ball, together)| [-1.0, 1.0].map(|sign| moved(ball, together, sign)))
            .collect()
    }
}
