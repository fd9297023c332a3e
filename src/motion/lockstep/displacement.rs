//! Small displacements from the motions in lockstep: carried along by the linearised flow in vectors,
//! and over switches by the saltation matrix (`motion::variation`) one by one.

use fearless_simd::Simd;

use super::lane::Lane;
use super::{Flow, Group};
use crate::model::State;
use crate::motion::contact::{Phase, SmoothPhase};
use crate::motion::guard::Guard;
use crate::motion::variation::saltation;

/// What is known of a lane's displacement.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Displaced {
    /// Its size.
    pub(crate) size: f64,
    /// Whether it met a switch by grazing, and is not defined since.
    pub(crate) grazed: bool,
}

impl<S: Simd, const N: usize> Group<S, N> {
    /// Displaces the balls of a lane, all alike, by a displacement of size 1.
    pub(crate) fn displace(&mut self, lane: usize) {
        let displaced = State { beta: [1.0 / (N as f64).sqrt(); N], ..State::zero() };
        self.displacement.set_lane(lane, &displaced);
        if let Some(own) = &mut self.lanes[lane] {
            own.grazed = false;
        }
    }

    /// The displacement of a lane.
    pub(crate) fn displaced(&self, lane: usize) -> Displaced {
        let State { position, velocity, beta, beta_dot } = self.displacement.lane(lane);
        let square = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
        let size =
            (square(&position) + square(&velocity) + square(&beta) + square(&beta_dot)).sqrt();
        let grazed = self.lanes[lane].as_ref().is_some_and(|own| own.grazed);
        Displaced { size, grazed }
    }

    /// Brings the displacement of a lane back to the size 1.
    pub(crate) fn normalise(&mut self, lane: usize, size: f64) {
        let mut unit = State::zero();
        unit.add_scaled(1.0 / size, &self.displacement.lane(lane));
        self.displacement.set_lane(lane, &unit);
    }
}

/// Takes a lane's displacement over a switch, at which a condition of a ball has failed; `state` and
/// `rate` are those with which the next phase begins.
pub(super) fn over_switch<S: Simd, const N: usize>(
    displacement: &mut Flow<S, N>,
    index: usize,
    lane: &mut Lane<N>,
    (before, (ball, which)): (&[Phase; N], (usize, usize)),
    (state, rate): (&State<N>, &State<N>),
) {
    let mut directions = [displacement.lane(index)];
    lane.grazed |= saltation(
        (&lane.balancer, lane.margins),
        (&SmoothPhase::new(&lane.balancer, before), Guard::of(ball, before[ball], which)),
        (state, rate),
        &mut directions,
    );
    displacement.set_lane(index, &directions[0]);
}
