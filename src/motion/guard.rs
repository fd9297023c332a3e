//! The conditions that hold during a smooth phase, and the instant at which the first of them
//! fails.

use super::contact::Phase;
use super::root::fall_through_zero;
use crate::model::{Forces, Number, State, System};

/// One condition of one ball; its value is positive while the phase lasts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guard {
    pub(super) ball: usize,
    kind: Condition,
}

#[derive(Clone, Copy, Debug)]
enum Condition {
    /// Slip lasts while the speed stays out of the band.
    OutOfBand(f64),
    /// Transition lasts while the speed stays in the band ...
    InBand(f64),
    /// ... and the ball accelerates in its direction.
    Accelerating(f64),
    /// Stick lasts while friction suffices, against a force in this direction.
    Held(f64),
    /// Any phase lasts while the ring presses on the ball.
    Pressed,
}

/// A point of a step: its state and the forces there.
pub(super) type Point<'a, const N: usize, const FREE: usize, T = f64> =
    (&'a State<N, T, FREE>, &'a Forces<N, T, FREE>);

/// Tolerances of the conditions.
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
                Phase::Slip(direction) => (Condition::OutOfBand(direction), None),
                Phase::Stick => (Condition::Held(1.0), Some(Condition::Held(-1.0))),
                Phase::Transition(direction) => {
                    (Condition::InBand(direction), Some(Condition::Accelerating(direction)))
                }
                Phase::Free => (Condition::Pressed, None),
            };
            let pressed = (*phase != Phase::Free).then_some(Condition::Pressed);
            let kinds = [Some(first), second, pressed].into_iter().flatten();
            kinds.map(move |kind| Guard { ball, kind })
        })
    }

    /// Returns one condition of a ball in a phase: its first, its second, or that the ring presses
    /// on it.
    pub(super) fn of(ball: usize, phase: Phase, which: usize) -> Guard {
        let kind = match (phase, which) {
            (Phase::Slip(direction), 0) => Condition::OutOfBand(direction),
            (Phase::Stick, 0) => Condition::Held(1.0),
            (Phase::Stick, 1) => Condition::Held(-1.0),
            (Phase::Transition(direction), 0) => Condition::InBand(direction),
            (Phase::Transition(direction), 1) => Condition::Accelerating(direction),
            _ => Condition::Pressed,
        };
        Guard { ball, kind }
    }

    /// The condition's value.
    #[inline]
    pub(super) fn value<S: System<N, FREE>, T: Number, const N: usize, const FREE: usize>(
        self,
        system: &S,
        Margins { band, slack }: Margins,
        (state, forces): Point<N, FREE, T>,
    ) -> T {
        let constant = T::constant;
        let (speed, acceleration) = (state.beta_dot[self.ball], forces.beta_ddot[self.ball]);
        match self.kind {
            Condition::OutOfBand(direction) => constant(direction) * speed - constant(band),
            Condition::InBand(direction) => constant(band) - constant(direction) * speed,
            Condition::Accelerating(direction) => {
                constant(direction) * acceleration + constant(slack)
            }
            Condition::Held(direction) => {
                let limit = constant(system.friction(self.ball).limit) * forces.normal[self.ball];
                limit - constant(direction) * forces.friction[self.ball] + constant(slack)
            }
            Condition::Pressed => forces.normal[self.ball],
        }
    }

    /// Returns the rate of change of the condition's value along a direction if it follows from the
    /// direction alone, as for a condition on a speed.
    pub(super) fn slope_along<const N: usize, const FREE: usize>(
        self,
        direction: &State<N, f64, FREE>,
    ) -> Option<f64> {
        match self.kind {
            Condition::OutOfBand(sign) => Some(sign * direction.beta_dot[self.ball]),
            Condition::InBand(sign) => Some(-sign * direction.beta_dot[self.ball]),
            Condition::Accelerating(_) | Condition::Held(_) | Condition::Pressed => None,
        }
    }

    /// Returns whether the condition may have failed and recovered inside a step of `length`, so
    /// that the interior must be examined. `values`, `forces` and `slopes` (which are expensive)
    /// are those at the step's two ends.
    pub(super) fn may_dip<S: System<N, FREE>, const N: usize, const FREE: usize>(
        self,
        system: &S,
        length: f64,
        values: [f64; 2],
        forces: [&Forces<N, f64, FREE>; 2],
        slopes: impl FnOnce() -> [f64; 2],
    ) -> bool {
        let least = values[0].min(values[1]);
        match self.kind {
            Condition::OutOfBand(direction) => {
                let slopes = forces.map(|forces| direction * forces.beta_ddot[self.ball]);
                reaches_below(least, slopes, length)
            }
            Condition::Accelerating(_) | Condition::Held(_) => {
                reaches_below(least, slopes(), length)
            }
            Condition::InBand(_) => false,
            Condition::Pressed => least < 0.25 * (system.force_scale() - 1.0),
        }
    }

    /// Returns the first instant in the step, as a fraction of it, at which the condition has just
    /// failed. `value` returns the condition's value at a fraction.
    pub(super) fn first_event(
        self,
        (start, end): (f64, f64),
        mut value: impl FnMut(f64) -> f64,
    ) -> Option<f64> {
        const WIDTH: f64 = 1e-13;
        const MOST_PARABOLAS: usize = 10;
        if start <= 0.0 {
            if end >= 0.0 {
                return None;
            }
            // The value is zero, or negative by rounding. If it rises before it falls (a ball that
            // leaves the band and comes back), the failure is the fall.
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
        // Search for a negative minimum: the lowest of several points is refined by parabolas until
        // the remaining depth clearly exceeds the latest improvement.
        let mut at = |theta: f64| (theta, value(theta));
        let looks = [(0.0, start), at(0.25), at(0.5), at(0.75), (1.0, end)];
        let mut newest = looks.into_iter().find(|(_, value)| *value < 0.0);
        let lowest = (0..5).min_by(|&i, &j| looks[i].1.total_cmp(&looks[j].1)).unwrap_or(0);
        let first = lowest.clamp(1, 3) - 1;
        let mut points = [looks[first], looks[first + 1], looks[first + 2]];
        let mut least = looks[lowest].1;
        for _ in 0..MOST_PARABOLAS {
            if let Some(below) = newest.filter(|(_, value)| *value < 0.0) {
                return Some(fall_through_zero(value, (0.0, start), below, WIDTH));
            }
            let bottom = vertex(points).filter(|bottom| *bottom > 0.0 && *bottom < 1.0)?;
            let found = (bottom, value(bottom));
            let gained = least - found.1;
            if found.1 >= 0.0 && gained < 0.5 * found.1 {
                break;
            }
            least = least.min(found.1);
            points = around_lowest(points, found);
            newest = Some(found);
        }
        None
    }
}

/// Returns whether a curve may become negative in a step, from the lower of its end values and its
/// slopes at both ends: the greatest depth of a parabola with one of the two slopes, with a margin
/// for higher terms. Only a curve that rises first and falls last has no dip.
fn reaches_below(least: f64, slopes: [f64; 2], length: f64) -> bool {
    let changes = slopes.map(|slope| slope * length);
    let hump = changes[0] >= 0.0 && changes[1] <= 0.0;
    !hump && least < 0.5 * changes[0].abs().max(changes[1].abs())
}

/// Returns where the parabola through three points is lowest; `None` if it does not open upwards.
fn vertex([(a, f_a), (b, f_b), (c, f_c)]: [(f64, f64); 3]) -> Option<f64> {
    let (left, right) = ((f_b - f_a) / (b - a), (f_c - f_b) / (c - b));
    let curvature = (right - left) / (c - a);
    (curvature > 0.0).then(|| 0.5 * (a + b - left / curvature))
}

/// Returns three of four points: the lowest and its neighbours, or at an end the lowest and the
/// next two.
fn around_lowest(points: [(f64, f64); 3], new: (f64, f64)) -> [(f64, f64); 3] {
    let [a, b, c] = points;
    let mut all = [a, b, c, new];
    all.sort_by(|one, other| one.0.total_cmp(&other.0));
    let lowest = (0..4).min_by(|&i, &j| all[i].1.total_cmp(&all[j].1)).unwrap_or(0);
    let first = lowest.clamp(1, 2) - 1;
    [all[first], all[first + 1], all[first + 2]]
}
