//! Where in its latest step a ball of a lane has gone once round, from the step's series.

use fearless_simd::Simd;

use super::recurrence::RECIPROCALS;
use super::root_isolation::{PolynomialPoint, guess};
use super::series::Series;
use super::terms::TERMS;
use super::{Group, Room};
use crate::model::State;
use crate::motion::root::fall_of_smooth;

impl<S: Simd, const N: usize> Group<S, N> {
    /// Returns time and state at which a ball completed a turn, through the angle 0, in the latest
    /// step of a lane; `None` if it did not. Corresponds to `Motion::passage`.
    #[inline(never)]
    pub(crate) fn passage(
        &self,
        room: &Room<S, N>,
        lane: usize,
        ball: usize,
    ) -> Option<(f64, State<N>)> {
        let start = self.before.lane(lane);
        let (angle, end) = (start.beta[ball], room.end.angle[ball][lane]);
        let (mark, sign) = if angle < std::f64::consts::TAU && end >= std::f64::consts::TAU {
            (std::f64::consts::TAU, 1.0)
        } else if angle > 0.0 && end <= 0.0 {
            (0.0, -1.0)
        } else {
            return None;
        };
        let before = |angle: f64| sign * (mark - angle);
        let length = room.length[lane];
        let slope = |speed: f64| -sign * (speed * length);
        let last = room.end.speed[ball][lane];
        let series = &room.series;
        // The fused multiply-add is an instruction in this closure.
        let (part, state) = self.time.simd.vectorize(
            #[inline(always)]
            || {
                let mut speeds = [0.0; TERMS - 1];
                for (speed, term) in speeds.iter_mut().zip(&series.terms) {
                    *speed = term.balls[ball].speed[lane];
                }
                let part = fall_of_smooth(
                    #[inline(always)]
                    |part| {
                        let time = part * length;
                        let (turned, speed) = turned(&speeds, time);
                        (before(angle + turned), slope(speed))
                    },
                    (0.0, 1.0),
                    guess(
                        PolynomialPoint {
                            at: 0.0,
                            value: before(angle),
                            slope: slope(start.beta_dot[ball]),
                        },
                        PolynomialPoint { at: 1.0, value: before(end), slope: slope(last) },
                    ),
                    1e-13,
                );
                (part, state_at(series, lane, &start, part * length))
            },
        );
        Some((self.time_before[lane] + part * length, state))
    }
}

/// Returns the angle that a ball turns in a time, and its speed then.
#[inline(always)]
fn turned(speeds: &[f64; TERMS - 1], time: f64) -> (f64, f64) {
    let (mut speed, mut turned) = (0.0_f64, 0.0_f64);
    for (k, coefficient) in speeds.iter().enumerate().rev() {
        speed = speed.mul_add(time, *coefficient);
        turned = turned.mul_add(time, RECIPROCALS[k + 1] * coefficient);
    }
    (turned * time, speed)
}

/// Returns the state in one lane at a time after the start of its step.
#[inline(always)]
pub(super) fn state_at<S: Simd, const N: usize>(
    series: &Series<S, N>,
    lane: usize,
    start: &State<N>,
    time: f64,
) -> State<N> {
    let mut state = *start;
    for axis in 0..2 {
        let (mut position, mut velocity) = (0.0_f64, 0.0_f64);
        for term in series.terms.iter().rev() {
            velocity = velocity.mul_add(time, position);
            position = position.mul_add(time, term.table[axis][lane]);
        }
        (state.position[axis], state.velocity[axis]) = (position, velocity);
    }
    for ball in 0..N {
        let mut speeds = [0.0; TERMS - 1];
        for (speed, term) in speeds.iter_mut().zip(&series.terms) {
            *speed = term.balls[ball].speed[lane];
        }
        let (turned, speed) = turned(&speeds, time);
        let left = series.solver.residual[ball][lane];
        state.beta[ball] += turned;
        state.beta_dot[ball] = speed + left * libm::exp(-time);
    }
    state
}
