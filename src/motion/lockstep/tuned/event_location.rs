//! The condition that fails first in a step of one lane, located on the series.

use super::equations::contact;
use super::event_functions::LanesToExamine;
use super::gap_forces::{GapForceEquation, GapForceEquations};
use super::series::BalancerSeries;
use super::terms::DYING;
use crate::model::Balancer;
use crate::motion::Phase;
use crate::motion::condition::Condition;
use crate::motion::lockstep::kernel::StepEnd;
use crate::motion::lockstep::lane::Lane;
use crate::motion::lockstep::root_isolation::Polynomial;
use crate::motion::lockstep::vector::{Vector, vectorized};
use crate::motion::lockstep::{Lanes, ORDER};

/// Returns the end of a step of one lane.
#[inline(never)]
pub(super) fn first_event<S: Vector, const N: usize>(
    series: &BalancerSeries<S, N>,
    (run, balancer, gaps): (&Lane, &Balancer<N>, &GapForceEquations<S, N>),
    (lane, length): (usize, f64),
    lanes_to_examine: &LanesToExamine<S, N>,
    ignored: &[Condition],
) -> StepEnd {
    let simd = series.terms[0].table[0].simd;
    // The fused multiply-add is an instruction in this closure.
    vectorized!(simd, {
        let mut first = StepEnd::Nothing;
        let band = run.margins.band;
        let aim = 0.5 * run.width;
        let slack = run.margins.slack + aim;
        let bit = 1 << lane;
        for (gap, of_all) in gaps.gaps.iter().enumerate() {
            let failed = Condition::Pressed(gap);
            if lanes_to_examine.of_gaps[gap] & bit != 0 && !ignored.contains(&failed) {
                let (weight, offset) = (of_all.pressure.weight[lane], of_all.pressure.offset[lane]);
                let pressed = Polynomial::of(length, offset, ORDER - 1, |k| {
                    weight * series.forces[k][gap][lane]
                });
                first.or(simd, &pressed, None, failed);
            }
        }
        let is_doubtful = |ball: &usize| lanes_to_examine.of_balls[*ball] & bit != 0;
        let if_stuck = |ball: usize| forces_if_stuck(series, balancer, lane, ball);
        first.or_released(simd, run, (is_doubtful, if_stuck), (length, slack), ignored);
        for (ball, phase) in run.phases[..N].iter().enumerate() {
            let loose = lanes_to_examine.loose & 1 << lane != 0;
            if !loose && lanes_to_examine.of_balls[ball] & 1 << lane == 0 {
                continue;
            }
            let speed = |k: usize| series.terms[k].balls[ball].speed[lane];
            // One place examines all conditions, because the search is large.
            for which in 0..3 {
                let failed = Condition::Contact { contact: ball, which };
                let (condition, bounds) = match (*phase, which) {
                    (_, 2) if loose => {
                        let normal = normal_force(series, (balancer, gaps, *phase), lane, ball);
                        (Polynomial::of(length, aim, ORDER, |k| normal[k]), None)
                    }
                    (Phase::Slip(direction), 0) => {
                        let bounds = lanes_to_examine.slips[ball].outline(lane);
                        (
                            Polynomial::of(length, aim - band, ORDER, |k| direction * speed(k)),
                            Some(bounds),
                        )
                    }
                    (Phase::Transition(direction), 0) => (
                        Polynomial::of(length, aim + band, ORDER, |k| -(direction * speed(k))),
                        None,
                    ),
                    (Phase::Transition(direction), 1) => {
                        let accelerating = |k| direction * ((k + 1) as f64 * speed(k + 1));
                        (Polynomial::of(length, slack, ORDER - 1, accelerating), None)
                    }
                    (Phase::Stick, 0 | 1) if !run.is_held(ball) => {
                        let bounds = lanes_to_examine.held[ball][which].outline(lane);
                        if bounds.holds() {
                            continue;
                        }
                        let left = held(series, balancer, lane, ball, [1.0, -1.0][which]);
                        (Polynomial::of(length, slack, ORDER, left), Some(bounds))
                    }
                    _ => continue,
                };
                if !ignored.contains(&failed) {
                    first.or_in_vectors(&condition, bounds.as_ref(), failed);
                }
            }
        }
        first
    })
}

/// Returns the series of the remaining friction of a sticking ball against a force in this
/// direction: μ times the normal force minus the force required to stick.
#[inline(always)]
fn held<S: Vector, const N: usize>(
    series: &BalancerSeries<S, N>,
    balancer: &Balancer<N>,
    lane: usize,
    ball: usize,
    sign: f64,
) -> impl Fn(usize) -> f64 {
    let limit = balancer.balls[ball].friction.limit;
    let [normal, friction] = forces_if_stuck(series, balancer, lane, ball);
    move |k| limit * normal[k] - sign * friction[k]
}

/// Returns the series of the normal force on a sticking ball and of the friction force required to stick, without forces in
/// gaps.
#[inline(always)]
fn forces_if_stuck<S: Vector, const N: usize>(
    series: &BalancerSeries<S, N>,
    balancer: &Balancer<N>,
    lane: usize,
    ball: usize,
) -> [[f64; ORDER + 1]; 2] {
    let [c, s] = &series.solver.trigonometry[ball];
    let (c, s) = (c[lane], s[lane]);
    let left = series.solver.residual[ball][lane] != 0.0;
    let [mut normal, mut friction] = [[0.0; ORDER + 1]; 2];
    let powers = normal.iter_mut().zip(&mut friction).enumerate();
    for (k, (normal, friction)) in powers.take(ORDER) {
        let [x, y] = &series.terms[k].pull;
        let (x, y) = (x[lane], y[lane]);
        let pressed = if k == 0 || left { pressed(series, balancer, lane, ball, k) } else { 0.0 };
        *normal = pressed - (c * x + s * y);
        *friction = s * x - c * y;
    }
    [normal, friction]
}

/// Returns the normal force on a ball without the table's acceleration.
#[inline(always)]
fn pressed<S: Vector, const N: usize>(
    series: &BalancerSeries<S, N>,
    balancer: &Balancer<N>,
    lane: usize,
    ball: usize,
    k: usize,
) -> f64 {
    let parameters = &balancer.balls[ball];
    let speed = balancer.speed;
    let of_ball = &series.terms[k].balls[ball];
    let constant = if k == 0 { speed * speed } else { 0.0 };
    // One of the two is zero.
    let left = series.solver.residual[ball][lane];
    let linear = of_ball.speed[lane] + DYING[k][0] * left;
    let quadratic = of_ball.squared[lane] + DYING[k][1] * (left * left);
    constant
        + ((2.0 * speed - parameters.rolling_linear) * linear
            + (1.0 - parameters.rolling_quadratic) * quadratic)
}

/// Returns the series of the normal force on a ball of a lane.
#[inline(never)]
fn normal_force<S: Vector, const N: usize>(
    series: &BalancerSeries<S, N>,
    (balancer, gaps, phase): (&Balancer<N>, &GapForceEquations<S, N>, Phase),
    lane: usize,
    ball: usize,
) -> [f64; ORDER + 1] {
    let contact = contact(phase, &balancer.balls[ball].friction, 1.0);
    let friction = contact.signed_friction;
    let share = 1.0 / balancer.balls[ball].mass;
    let along = |k: usize, j: usize| {
        let [real, imaginary] = series.terms[j].balls[ball].direction.map(|of_all| of_all[lane]);
        let [x, y] = series.terms[k - j].pull.map(|of_all| of_all[lane]);
        (real + friction * imaginary) * x + (imaginary - friction * real) * y
    };
    std::array::from_fn(|k| {
        if k == ORDER {
            return 0.0;
        }
        let pulled: f64 = (0..=k).map(|j| along(k, j)).sum();
        let pushed: f64 = if series.response.active {
            let by_gap = |(gap, force): (&GapForceEquation<S, N>, &Lanes<S>)| {
                gap.outward[ball][lane] * force[lane]
            };
            gaps.gaps.iter().zip(&series.forces[k]).map(by_gap).sum()
        } else {
            0.0
        };
        pressed(series, balancer, lane, ball, k) - share * pulled + pushed
    })
}
