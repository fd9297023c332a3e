//! The state and the forces at an instant of the latest step, for recording.

use super::contact::{Phase, SmoothPhase};
use super::driver::Motion;
use crate::model::{Forces, State, System};

/// A motion at an instant.
#[derive(Clone, Debug)]
pub struct Instant<const N: usize, const FREE: usize = 2> {
    /// Non-dimensional time.
    pub time: f64,
    /// The state. Angles lie within a step of [0, 2π).
    pub state: State<N, f64, FREE>,
    /// Angles with the whole turns made since the start, rad; positions of blocks.
    pub unwrapped: [f64; N],
    /// What each contact does.
    pub phases: [Phase; N],
    /// Accelerations and forces.
    pub forces: Forces<N, f64, FREE>,
}

impl<S: System<N, FREE>, const N: usize, const FREE: usize> Motion<'_, S, N, FREE> {
    /// Returns the current instant, after a switch at the end of the latest step.
    pub fn now(&self) -> Instant<N, FREE> {
        Instant {
            time: self.time(),
            state: *self.state(),
            unwrapped: self.unwrapped(self.state()),
            phases: *self.phases(),
            forces: *self.forces(),
        }
    }

    /// Returns the current instant before the switch at the end of the latest step; `None` without
    /// a switch.
    pub fn before_switch(&self) -> Option<Instant<N, FREE>> {
        let phases = self.last_step()?.phases;
        (phases != *self.phases()).then(|| self.instant(self.time(), *self.state(), phases))
    }

    /// Returns the instant at a time from the start of the latest step until before its end; `None`
    /// for any other time.
    pub fn inside_last_step(&mut self, time: f64) -> Option<Instant<N, FREE>> {
        let start = self.last_step()?.start_time;
        if time < start || time >= self.time() {
            return None;
        }
        let phases = self.last_step()?.phases;
        let state = self.within_last_step(time)?;
        Some(self.instant(time, state, phases))
    }

    /// Returns the angles, including the whole turns since the start, at a time within the latest
    /// step; `None` for any other time.
    pub fn unwrapped_in_last_step(&mut self, time: f64) -> Option<[f64; N]> {
        let state = self.within_last_step(time)?;
        Some(self.unwrapped(&state))
    }

    /// Returns the start time of the latest step; `None` before the first.
    pub fn last_step_began(&self) -> Option<f64> {
        self.last_step().map(|last| last.start_time)
    }

    fn instant(
        &self,
        time: f64,
        state: State<N, f64, FREE>,
        phases: [Phase; N],
    ) -> Instant<N, FREE> {
        let forces = SmoothPhase::new(self.system(), &phases).forces(&state);
        Instant { time, unwrapped: self.unwrapped(&state), state, phases, forces }
    }

    fn unwrapped(&self, state: &State<N, f64, FREE>) -> [f64; N] {
        let turns = self.turns();
        std::array::from_fn(|ball| state.beta[ball] + turns[ball] as f64 * std::f64::consts::TAU)
    }
}
