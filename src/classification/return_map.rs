//! The return map: from one passage through the section to one some turns later,
//! through all stick and slip, with its derivative and the properties of the period.
//!
//! The derivative is the linearised flow, corrected at each switch by the saltation matrix, and
//! projected on the section.

use std::cell::Cell;

use nalgebra::DMatrix;

use super::period::{FollowedStep, Period};
use super::section::Section;
use super::system_view::SystemView;
use crate::model::Components;
use crate::motion::lockstep::LANES;
use crate::motion::{Motion, PerContact, Settings};

/// Part of the longest time of a return within which a passage through the section is that of the start.
const AT_ONCE: f64 = 1e-9;

/// The map from one passage of the section to a later one.
#[derive(Clone, Copy)]
pub(super) struct ReturnMap<'a> {
    pub(super) view: &'a SystemView,
    pub(super) settings: Settings,
    pub(super) section: &'a Section,
    pub(super) turns: usize,
    /// Time after which the computation of the map ends without a result.
    pub(super) longest: f64,
    /// Whether a search for a closed orbit ends where neighbours of the run separate from one return to the next: their
    /// orbit attracts no run.
    pub(super) only_stable: bool,
    /// Remaining number of steps, shared by all uses of this map.
    pub(super) steps_left: &'a Cell<u64>,
}

/// Returns what a step with perturbed motions costs, in steps without: the motions of a group of lanes are perturbed
/// together.
pub(super) fn cost_of_a_step(perturbed: usize) -> u64 {
    1 + 2 * perturbed.div_ceil(LANES) as u64
}

/// The result of the return map.
pub(super) struct Return {
    /// The final state, with angles that include the turns made.
    pub(super) state: Components,
    /// The time since the start of the motion.
    pub(super) time: f64,
    /// The number of steps since then.
    pub(super) steps: u64,
}

impl ReturnMap<'_> {
    /// Returns one return; `None` if a contact that should rest moves, or the marking contact stops
    /// or does not return.
    pub(super) fn follow(&self, start: &[f64]) -> Option<Return> {
        self.follow_steps(start, &[], |_| {})
    }

    /// Returns one return with the derivative of the map.
    pub(super) fn follow_with_slope(&self, start: &[f64]) -> Option<(Return, DMatrix<f64>)> {
        if self.section.directions().is_empty() {
            return Some((self.follow(start)?, DMatrix::zeros(0, 0)));
        }
        let mut columns = Vec::new();
        let mut grazed = false;
        let end = self.follow_steps(start, &self.section.directions(), |step| match step.end {
            None => grazed = step.motion.grazed(),
            Some((time, state)) => {
                let rate = self.view.evaluator.rates(step.motion.phases_during_step(), state);
                let there = step.motion.perturbations_within(time);
                columns =
                    there.iter().map(|offset| self.section.on_section(offset, &rate)).collect();
            }
        })?;
        let slope = DMatrix::from_columns(&columns);
        let sound = !grazed && slope.iter().all(|value| value.is_finite());
        sound.then_some((end, slope))
    }

    /// Returns one return with the properties of the period.
    pub(super) fn follow_closely(&self, start: &[f64]) -> Option<(Return, Period)> {
        let mut period = Period::new(self.view, self.section, start);
        let end = self.follow_steps(start, &[], |step| period.take_in(self.view, step))?;
        Some((end, period))
    }

    /// Follows a motion from return to return until `judge`, which receives each state on the section, has a verdict. Returns
    /// the verdict; `None` if a return fails.
    pub(super) fn follow_until<V>(
        &self,
        start: &[f64],
        mut judge: impl FnMut(&[f64]) -> Option<V>,
    ) -> Option<V> {
        self.with_motion(start, &[], |motion, start| {
            let begun = motion.unwrapped();
            let mut since = 0.0;
            loop {
                let end = self.follow_to_return(motion, (start, &begun), since, |_| {})?;
                since = end.time;
                if let Some(verdict) = judge(&end.state) {
                    return Some(verdict);
                }
            }
        })
    }

    /// Follows the motion with perturbed motions. `watch` receives each step.
    fn follow_steps(
        &self,
        start: &[f64],
        directions: &[Components],
        watch: impl FnMut(&mut FollowedStep),
    ) -> Option<Return> {
        self.with_motion(start, directions, |motion, start| {
            let begun = motion.unwrapped();
            self.follow_to_return(motion, (start, &begun), 0.0, watch)
        })
    }

    /// Calls `with` with a motion from a state on the section and this state.
    fn with_motion<R>(
        &self,
        start: &[f64],
        directions: &[Components],
        with: impl FnOnce(&mut Motion, &[f64]) -> Option<R>,
    ) -> Option<R> {
        let mut start = Components::from_slice(start);
        self.section.put_on(&mut start);
        let left = self.steps_left.get();
        let cost = cost_of_a_step(directions.len());
        let effort_limit = self.settings.effort_limit.min(left / cost);
        let settings = Settings { effort_limit, ..self.settings };
        let evaluator = &self.view.evaluator;
        let at = (&start[..], &self.section.phases[..]);
        let mut motion = Motion::of_recorded(evaluator, settings, at, directions).ok()?;
        let end = with(&mut motion, &start);
        let taken = motion.effort().total().saturating_mul(cost);
        self.steps_left.set(left.saturating_sub(taken));
        end
    }

    /// Follows a motion from the time `since` of its start or latest return until it comes back to the section. The positions
    /// of the contacts at its start are those of `start`, and with whole turns those of `begun`.
    fn follow_to_return(
        &self,
        motion: &mut Motion,
        (start, begun): (&[f64], &[f64]),
        since: f64,
        mut watch: impl FnMut(&mut FollowedStep),
    ) -> Option<Return> {
        let contacts = &self.view.contacts;
        // Angles are relative to those of the start, including the whole turns that the motion
        // subtracts.
        let taken_off = |index: usize| start[contacts[index].position] - begun[index];
        let mut passed = 0;
        let until = since + self.longest;
        while motion.time() < until {
            if !self.section.allows(motion.phases()) {
                return None;
            }
            let whole_turns = self.whole_turns(motion);
            motion.advance(until).ok()?;
            // A motion that starts on the section to rounding may pass through it at once.
            let later = since + AT_ONCE * self.longest;
            let passage = self.section.passage(self.view, motion).filter(|(time, _)| *time > later);
            passed += usize::from(passage.is_some());
            let Some((time, mut state)) = passage.filter(|_| passed == self.turns) else {
                watch(&mut FollowedStep { motion, whole_turns, end: None });
                continue;
            };
            if motion.phases_during_step() != self.section.phases.as_slice() {
                return None;
            }
            let end = Some((time, state.as_slice()));
            let mut step = FollowedStep { motion, whole_turns, end };
            watch(&mut step);
            let turns = step.whole_turns;
            let turned: PerContact =
                turns.iter().enumerate().map(|(index, turns)| turns + taken_off(index)).collect();
            self.view.turn(&mut state, &turned);
            return Some(Return { state, time, steps: motion.effort().total() });
        }
        None
    }

    /// Returns the difference between the contacts' positions with whole turns and those of the
    /// state.
    fn whole_turns(&self, motion: &Motion) -> PerContact {
        let positions = self.view.positions(&motion.state());
        motion.unwrapped().iter().zip(&positions).map(|(all, within)| all - within).collect()
    }
}
