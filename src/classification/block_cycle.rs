//! One period of the limit cycle of a block on a belt: its motion from one break-away to the next.
//!
//! The state at break-away is the same each time, so that a disturbance vanishes within one period:
//! the only multiplier other than that along the motion is 0, and no direction is neutral.

use super::cycle::{Cycle, CyclePhase};
use crate::model::{Slider, SliderState};
use crate::motion::{Motion, Phase, derivative};

/// The motion of a block since it broke away.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockCycleRecorder {
    /// The sequence of phases; neighbours differ.
    cycle_phases: Vec<CyclePhase>,
    /// Least and greatest speed relative to the belt, non-dimensional; 0 at break-away.
    speeds: [f64; 2],
}

impl BlockCycleRecorder {
    /// Adds the latest step of the motion, in which the block was in this phase.
    pub(super) fn extend(
        &mut self,
        slider: &Slider,
        motion: &mut Motion<Slider, 1, 0>,
        in_step: Phase,
    ) {
        let speed = motion.state().beta_dot[0];
        let cycle_phase = CyclePhase::of(in_step, speed);
        if self.cycle_phases.last() != Some(&cycle_phase) {
            self.cycle_phases.push(cycle_phase);
        }
        if cycle_phase == CyclePhase::Stick {
            return;
        }
        // It is fastest where its acceleration passes through zero, or at the end of the step.
        let fastest = [1.0, -1.0].map(|direction| {
            let acceleration =
                |state: &SliderState| direction * derivative(slider, &[in_step], state).beta_dot[0];
            motion.falls_through_zero(acceleration).map(|(_, state)| state.beta_dot[0])
        });
        let [low, high] = &mut self.speeds;
        for speed in fastest.into_iter().flatten().chain([speed]) {
            *low = low.min(speed);
            *high = high.max(speed);
        }
    }

    /// Returns the completed cycle, given the unit of speed and half of the distance between the
    /// block's extreme positions.
    pub(super) fn cycle(&self, unit_speed_m_s: f64, amplitude_m: f64) -> Cycle {
        Cycle {
            turns: vec![0],
            configurations: self
                .cycle_phases
                .iter()
                .map(|&cycle_phase| vec![cycle_phase])
                .collect(),
            speed_extremes: vec![self.speeds.map(|speed| speed * unit_speed_m_s)],
            angle_extremes: vec![None],
            peak_amplitude_m: amplitude_m,
            multipliers: vec![0.0],
            neutral_directions: 0,
        }
    }
}
