//! How much computing a run may take before it is given up.
//!
//! Two limits, and neither looks at a clock: the same run is given up at the same step everywhere. A motion that
//! takes far more steps per unit of time than any sound one is given up soon, whenever that begins
//! ([`most_steps_by`]). A motion that goes on well, but for very long, is given up after as many steps as take
//! [`LONGEST_S`] of computing; after a second, where it cannot be brought to its end within these.

use crate::model::{Balancer, Machine, Model, Simulation, System};
use crate::motion::most_steps_by;

/// How long a run may be computed that goes on well, s.
const LONGEST_S: f64 = 300.0;
/// How long a run is computed that cannot be brought to its end time, s.
const IN_VAIN_S: f64 = 1.0;
/// The most steps that a run may take to look for closed orbits, each time that it looks: those of single
/// motions, and of neighbours that are carried along.
pub(super) const MOST_STEPS_OF_A_LOOK: u64 = 5_000_000;
/// How often a run looks for a closed orbit at most.
pub(super) const MOST_LOOKS: u32 = 4;

/// A bound of the time that a step takes in a run that is computed alone, s on a core of 2024. One by one, a step
/// with a neighbour takes 2.3 µs per ball; with one of eight lanes in use and an event in every step it takes up
/// to 4 µs per ball. A step of a block takes 0.6 µs.
pub fn seconds_per_step(model: &Model) -> f64 {
    seconds_per_step_with(model.balls())
}

fn seconds_per_step_with(balls: usize) -> f64 {
    if balls == 0 { 1e-6 } else { 4e-6 * balls as f64 }
}

/// The most steps that any run with so many balls can take in all, whatever its parameters and its end time.
pub fn most_steps_of_any_run(balls: usize) -> u64 {
    let going_on = (LONGEST_S / seconds_per_step_with(balls)) as u64;
    most_steps_by(0.0, 0.0) + going_on + u64::from(MOST_LOOKS) * MOST_STEPS_OF_A_LOOK
}

/// The most steps, tried or taken, and switches in the motion of a run to the non-dimensional time `end`.
pub(super) fn effort_limit<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    end: f64,
) -> u64 {
    let balls = if FREE == 0 { 0 } else { N };
    let steps_in = |seconds: f64| seconds / seconds_per_step_with(balls);
    let in_vain = end * system.fewest_steps() > steps_in(LONGEST_S);
    let most = steps_in(if in_vain { IN_VAIN_S } else { LONGEST_S });
    let sound = |time: f64| most_steps_by(time, system.pace());
    sound(end).min(sound(0.0).saturating_add(most as u64))
}

/// The most steps that a run of a model can take in all, also to look for closed orbits; none where the model has
/// a number of balls that there is no computation for.
pub fn most_steps_of_a_run(model: &Model, simulation: &Simulation) -> Option<u64> {
    let [_, latest_end_time_s] = simulation.end_times_s();
    let end = latest_end_time_s * model.natural_frequency_rad_s();
    let motion = match model {
        Model::Block(block) => effort_limit(&block.slider(), end),
        Model::BallBalancer(machine) => match machine.balls.len() {
            1 => of_balls::<1>(machine, end)?,
            2 => of_balls::<2>(machine, end)?,
            3 => of_balls::<3>(machine, end)?,
            4 => of_balls::<4>(machine, end)?,
            5 => of_balls::<5>(machine, end)?,
            6 => of_balls::<6>(machine, end)?,
            7 => of_balls::<7>(machine, end)?,
            8 => of_balls::<8>(machine, end)?,
            _ => return None,
        },
    };
    Some(motion.saturating_add(u64::from(MOST_LOOKS) * MOST_STEPS_OF_A_LOOK))
}

fn of_balls<const N: usize>(machine: &Machine, end: f64) -> Option<u64> {
    Some(effort_limit(&Balancer::<N>::new(machine)?, end))
}
