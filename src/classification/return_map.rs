//! The return map of a running ball: from one passage through the section to one some turns later,
//! through all stick and slip, with its derivative and the properties of the period.
//!
//! The derivative is the linearised flow, corrected at each switch by the saltation matrix
//! ([`crate::motion::Variational`]), and projected on the section.

use std::cell::Cell;

use nalgebra::DMatrix;

use super::period::Period;
use super::section::Section;
use crate::model::{Balancer, State};
use crate::motion::{Motion, Phase, Settings, Variational, derivative};

/// The map from one passage of the section to a later one.
#[derive(Clone, Copy)]
pub(super) struct ReturnMap<'a, const N: usize> {
    pub(super) balancer: &'a Balancer<N>,
    pub(super) settings: Settings,
    pub(super) section: Section<N>,
    pub(super) turns: usize,
    /// Time after which the computation of the map ends without a result.
    pub(super) longest: f64,
    /// Remaining number of steps, shared by all uses of this map.
    pub(super) steps_left: &'a Cell<u64>,
}

/// The result of the return map.
pub(super) struct Return<const N: usize> {
    /// The final state, with angles that include the turns made.
    pub(super) state: State<N>,
    /// The duration.
    pub(super) time: f64,
}

impl<const N: usize> ReturnMap<'_, N> {
    /// Returns one return; `None` if a ball that should rest moves, or the marking ball stops or
    /// does not return.
    pub(super) fn follow(&self, start: &State<N>) -> Option<Return<N>> {
        self.go(start, 0, |_, _, _| {})
    }

    /// Returns one return with the derivative of the map.
    pub(super) fn follow_with_slope(&self, start: &State<N>) -> Option<(Return<N>, DMatrix<f64>)> {
        let mut variation = Variational::new(self.section.directions());
        let mut columns = Vec::new();
        let neighbours = self.section.directions().len() as u64;
        let end = self.go(start, neighbours, |motion, phases, end| match end {
            None => variation.follow(motion),
            Some((time, state)) => {
                let rate = derivative(self.balancer, phases, state);
                let there = variation.followed_to(motion, time);
                columns = there.iter().map(|one| self.section.on_section(one, &rate)).collect();
            }
        })?;
        let slope = DMatrix::from_columns(&columns);
        let sound = !variation.grazed && slope.iter().all(|value| value.is_finite());
        sound.then_some((end, slope))
    }

    /// Returns one return with the properties of the period.
    pub(super) fn follow_closely(&self, start: &State<N>) -> Option<(Return<N>, Period<N>)> {
        let mut period = Period::new(self.balancer, &self.section, start);
        let end = self.go(start, 0, |motion, phases, end| {
            period.take_in(self.balancer, motion, phases, end.map(|(time, state)| (time, *state)));
        })?;
        Some((end, period))
    }

    /// Follows the motion with this number of displaced motions. `watch` receives each step with
    /// the phases during it, and for the last step the time and state of the return.
    fn go(
        &self,
        start: &State<N>,
        neighbours: u64,
        watch: impl FnMut(&mut Motion<'_, Balancer<N>, N>, &[Phase; N], Option<(f64, &State<N>)>),
    ) -> Option<Return<N>> {
        let mut start = *start;
        start.beta[self.section.reference] = 0.0;
        let left = self.steps_left.get();
        let cost = 1 + neighbours;
        let effort_limit = self.settings.effort_limit.min(left / cost);
        let settings = Settings { effort_limit, ..self.settings };
        let mut motion = Motion::new(self.balancer, settings, start).ok()?;
        let end = self.come_back(&mut motion, &start, watch);
        let taken = motion.effort().total().saturating_mul(cost);
        self.steps_left.set(left.saturating_sub(taken));
        end
    }

    /// Follows a motion from its start until it comes back to the section.
    fn come_back(
        &self,
        motion: &mut Motion<'_, Balancer<N>, N>,
        start: &State<N>,
        mut watch: impl FnMut(&mut Motion<'_, Balancer<N>, N>, &[Phase; N], Option<(f64, &State<N>)>),
    ) -> Option<Return<N>> {
        let Section { reference, phases, rests } = self.section;
        // Angles are relative to those of the start, including the whole turns that the motion
        // subtracts.
        let taken_off: [f64; N] =
            std::array::from_fn(|ball| start.beta[ball] - motion.unwrapped_angle(ball));
        let mut passed = 0;
        while motion.time() < self.longest {
            let stays = |ball: usize| {
                let phase = motion.phases()[ball];
                (!rests[ball] || phase == Phase::Stick) && (ball != reference || !phase.in_band())
            };
            if !(0..N).all(stays) {
                return None;
            }
            let during = *motion.phases();
            motion.advance(self.longest).ok()?;
            let passage = motion.passage(reference);
            passed += usize::from(passage.is_some());
            let Some((time, mut state)) = passage.filter(|_| passed == self.turns) else {
                watch(motion, &during, None);
                continue;
            };
            if during != phases {
                return None;
            }
            watch(motion, &during, Some((time, &state)));
            for (ball, taken_off) in taken_off.into_iter().enumerate() {
                let turns = motion.unwrapped_angle(ball) - motion.state().beta[ball];
                state.beta[ball] += turns + taken_off;
            }
            return Some(Return { state, time });
        }
        None
    }
}
