//! What ends a smooth phase: conditions that hold all along it, and the instant at which the
//! first of them fails.

use super::contact::{Phase, stick_reserve};
use super::root::fall_through_zero;
use crate::model::{Forces, State, System};

/// One condition of one ball; its value is positive while the phase lasts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guard {
    pub(super) ball: usize,
    kind: Kind,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Slip lasts while the speed stays out of the band.
    OutOfBand(f64),
    /// Transition lasts while the speed stays in the band ...
    InBand(f64),
    /// ... and the ball accelerates in its direction.
    Accelerating(f64),
    /// Stick lasts while friction suffices.
    Held,
    /// Any phase lasts while the ring presses on the ball.
    Pressed,
}

/// A point of a step: its state and the forces there.
pub(super) type Point<'a, const N: usize, const FREE: usize> =
    (&'a State<N, f64, FREE>, &'a Forces<N, f64, FREE>);

/// By how much conditions may fail before they count as failed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margins {
    /// Half width of the band around zero speed; 0 in the exact motion.
    pub(super) band: f64,
    /// Slack of the conditions on forces and accelerations.
    pub(super) slack: f64,
}

impl Guard {
    /// All conditions of a configuration.
    pub(super) fn all<const N: usize>(phases: &[Phase; N]) -> impl Iterator<Item = Guard> {
        phases.iter().enumerate().flat_map(|(ball, phase)| {
            let (first, second) = match *phase {
                Phase::Slip(direction) => (Kind::OutOfBand(direction), None),
                Phase::Stick => (Kind::Held, None),
                Phase::Transition(direction) => {
                    (Kind::InBand(direction), Some(Kind::Accelerating(direction)))
                }
                Phase::Free => (Kind::Pressed, None),
            };
            let pressed = (*phase != Phase::Free).then_some(Kind::Pressed);
            let kinds = [Some(first), second, pressed].into_iter().flatten();
            kinds.map(move |kind| Guard { ball, kind })
        })
    }

    /// The condition's value.
    pub(super) fn value<S: System<N, FREE>, const N: usize, const FREE: usize>(
        self,
        system: &S,
        Margins { band, slack }: Margins,
        (state, forces): Point<N, FREE>,
    ) -> f64 {
        match self.kind {
            Kind::OutOfBand(direction) => direction * state.beta_dot[self.ball] - band,
            Kind::InBand(direction) => band - direction * state.beta_dot[self.ball],
            Kind::Accelerating(direction) => direction * forces.beta_ddot[self.ball] + slack,
            Kind::Held => stick_reserve(system, forces, self.ball) + slack,
            Kind::Pressed => forces.normal[self.ball],
        }
    }

    /// Whether the condition may have failed and recovered inside a step of `length`, so that a
    /// look inside is due.
    pub(super) fn may_dip<S: System<N, FREE>, const N: usize, const FREE: usize>(
        self,
        system: &S,
        length: f64,
        (start, end): (f64, f64),
        (start_forces, end_forces): (&Forces<N, f64, FREE>, &Forces<N, f64, FREE>),
    ) -> bool {
        match self.kind {
            Kind::OutOfBand(direction) => {
                let falls = direction * start_forces.beta_ddot[self.ball] * length;
                let rises = direction * end_forces.beta_ddot[self.ball] * length;
                // The deepest that a parabola with one of the two slopes can go, with room to
                // spare for higher terms.
                falls < 0.0 && rises > 0.0 && start.min(end) < 0.5 * falls.abs().max(rises)
            }
            Kind::InBand(_) => false,
            Kind::Pressed => start.min(end) < 0.25 * (system.force_scale() - 1.0),
            Kind::Accelerating(_) | Kind::Held => {
                let limit = system.friction(self.ball).limit
                    * start_forces.normal[self.ball].max(end_forces.normal[self.ball]);
                start.min(end) < 0.25 * limit
            }
        }
    }

    /// The first instant in the step, as a fraction of it, at which the condition has just
    /// failed. `value` gives the condition's value at a fraction.
    pub(super) fn first_failure(
        self,
        (start, end): (f64, f64),
        mut value: impl FnMut(f64) -> f64,
    ) -> Option<f64> {
        const WIDTH: f64 = 1e-13;
        if start <= 0.0 {
            if end >= 0.0 {
                return None;
            }
            // Exactly on the boundary, or just beyond it by rounding. If the value rises before it
            // falls (a ball that leaves the band and comes back), the failure is the fall.
            let rise = (1..30).map(|halvings| 0.5_f64.powi(halvings)).find_map(|inside| {
                let risen = value(inside);
                (risen > 0.0).then_some((inside, risen))
            });
            return Some(
                rise.map_or(0.0, |risen| fall_through_zero(value, risen, (1.0, end), WIDTH)),
            );
        }
        if end < 0.0 {
            return Some(fall_through_zero(value, (0.0, start), (1.0, end), WIDTH));
        }
        // Does a parabola through start, middle and end dip below zero?
        let middle = value(0.5);
        if middle < 0.0 {
            return Some(fall_through_zero(value, (0.0, start), (0.5, middle), WIDTH));
        }
        let curvature = 2.0 * (start + end - 2.0 * middle);
        let slope = end - start - curvature;
        let lowest = -slope / (2.0 * curvature);
        if curvature > 0.0 && lowest > 0.0 && lowest < 1.0 {
            let bottom = value(lowest);
            if bottom < 0.0 {
                return Some(fall_through_zero(value, (0.0, start), (lowest, bottom), WIDTH));
            }
        }
        None
    }
}
