//! Limits on the computational effort of a run.
//!
//! There are two limits, and both count steps, not time, so that a run fails at the same step on
//! every machine. A motion with far more steps per unit of time than any regular motion fails early
//! ([`most_steps_by`]). A regular but very long motion fails after a number of steps that
//! corresponds to [`LONGEST_S`] of computing, or to one second if it cannot reach its end time within
//! that limit.

use crate::model::{Ball, Model, Simulation, System};
use crate::motion::most_steps_by;

/// Longest computing time of a run that can reach its end time, s.
const LONGEST_S: f64 = 300.0;
/// Longest computing time of a run that cannot reach its end time, s.
const IN_VAIN_S: f64 = 1.0;
/// Maximum number of steps of one search for a closed orbit, counting the steps of the motion and
/// of perturbed motions.
pub(super) const MOST_STEPS_OF_A_LOOK: u64 = 5_000_000;
/// Maximum number of searches for a closed orbit per run, of each kind: with a mark that may stop, and with any other mark.
pub(super) const MOST_LOOKS: u32 = 4;
/// Maximum number of steps of all searches of a run.
const MOST_STEPS_OF_LOOKS: u64 = 2 * MOST_LOOKS as u64 * MOST_STEPS_OF_A_LOOK;

/// Returns an upper bound of the time per step of a run that is computed alone, s on a core of the
/// year 2024. With one of eight lanes in use and an event in every step, a step takes up to 4 µs per
/// contact, and 1 µs if position and speed of one contact are the whole state.
pub fn seconds_per_step(model: &Model) -> f64 {
    match model.contacts() {
        1 if model.coordinate_count() == 2 => 1e-6,
        contacts => 4e-6 * contacts.max(1) as f64,
    }
}

/// Returns the maximum number of steps of any run with the contacts of this model, for any parameters
/// and end time.
pub fn most_steps_of_any_run(model: &Model) -> u64 {
    let going_on = (LONGEST_S / seconds_per_step(model)) as u64;
    most_steps_by(0.0, 0.0) + going_on + MOST_STEPS_OF_LOOKS
}

/// Returns the maximum number of steps (tried or accepted) and switches in the motion of a run
/// until the non-dimensional time `end`.
pub(super) fn effort_limit(model: &Model, system: &dyn System, end: f64) -> u64 {
    let steps_in = |seconds: f64| seconds / seconds_per_step(model);
    let in_vain = end * system.fewest_steps() > steps_in(LONGEST_S);
    let most = steps_in(if in_vain { IN_VAIN_S } else { LONGEST_S });
    let sound = |time: f64| most_steps_by(time, system.fastest_rate());
    sound(end).min(sound(0.0).saturating_add(most as u64))
}

/// Returns the maximum total number of steps of a run of a model, including searches for closed
/// orbits; `None` for an unsupported number of balls.
pub fn most_steps_of_a_run(model: &Model, simulation: &Simulation) -> Option<u64> {
    let [_, latest_end_time_s] = simulation.end_times_s();
    let end = latest_end_time_s * model.natural_frequency_rad_s();
    let motion = effort_limit(model, model.system()?.as_ref(), end);
    Some(motion.saturating_add(MOST_STEPS_OF_LOOKS))
}

/// Returns whether the kernel written for ball balancers computes runs of this model: those whose friction is independent of
/// speed or proportional to it.
pub fn has_tuned_kernel(model: &Model) -> bool {
    let Some(machine) = model.ball_balancer() else { return false };
    let is_linear = |ball: &Ball| machine.friction.is_linear(ball.friction_coefficient);
    machine.balls.iter().all(is_linear)
}
