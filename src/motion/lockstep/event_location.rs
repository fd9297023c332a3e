//! The condition that fails first in a step of one lane, located on the series.

use fearless_simd::Simd;

use super::event_functions::Doubts;
use super::lane::Lane;
use super::recurrence::DYING;
use super::root_isolation::{Bounds, ConditionFate, Polynomial};
use super::series::Series;
use super::terms::ORDER;
use crate::motion::Phase;

/// The end of a step of a lane.
pub(super) enum Ends {
    /// Nothing.
    Nothing,
    /// A ball's condition with this number fails, at this part of the step.
    At(f64, (usize, usize)),
    /// A condition fails from the start.
    AtOnce,
}

/// Returns the end of a step of one lane.
#[inline(never)]
pub(super) fn first_event<S: Simd, const N: usize>(
    series: &Series<S, N>,
    own: &Lane<N>,
    lane: usize,
    length: f64,
    doubts: &Doubts<S, N>,
) -> Ends {
    // The fused multiply-add is an instruction in this closure.
    series.terms[0].table[0].simd.vectorize(
        #[inline(always)]
        || first_of_all(series, own, lane, length, doubts),
    )
}

#[inline(always)]
fn first_of_all<S: Simd, const N: usize>(
    series: &Series<S, N>,
    own: &Lane<N>,
    lane: usize,
    length: f64,
    doubts: &Doubts<S, N>,
) -> Ends {
    let mut first = Ends::Nothing;
    let band = own.margins.band;
    let aim = 0.5 * own.width;
    let slack = own.margins.slack + aim;
    for (ball, phase) in own.phases.iter().enumerate() {
        let loose = doubts.loose & 1 << lane != 0;
        if !loose && doubts.of_balls[ball] & 1 << lane == 0 {
            continue;
        }
        let speed = |k: usize| series.terms[k].balls[ball].speed[lane];
        match *phase {
            Phase::Slip(direction) => {
                let out = polynomial(length, aim - band, |k| direction * speed(k));
                first.or(&out, &doubts.slips[ball].outline(lane), (ball, 0));
            }
            Phase::Transition(direction) => {
                let inside = polynomial(length, aim + band, |k| -direction * speed(k));
                first.or(&inside, &inside.outline(), (ball, 0));
                let accelerating = polynomial(length, slack, |k| match k {
                    ORDER => 0.0,
                    _ => direction * ((k + 1) as f64 * speed(k + 1)),
                });
                first.or(&accelerating, &accelerating.outline(), (ball, 1));
            }
            Phase::Stick => {
                for (which, sign) in [1.0, -1.0].into_iter().enumerate() {
                    let outline = doubts.held[ball][which].outline(lane);
                    if !outline.holds() {
                        let left = held(series, own, lane, ball, sign);
                        first.or(&polynomial(length, slack, left), &outline, (ball, which));
                    }
                }
            }
            Phase::Free => {}
        }
        if loose {
            let normal = normal_force(series, own, lane, ball);
            let normal = polynomial(length, aim, |k| normal[k]);
            first.or(&normal, &normal.outline(), (ball, 2));
        }
    }
    first
}

impl Ends {
    /// Returns the earlier one of this end and the failure of another condition.
    #[inline(always)]
    fn or(&mut self, condition: &Polynomial, outline: &Bounds, which: (usize, usize)) {
        match (condition.first_fall(outline), &self) {
            (ConditionFate::Holds, _) | (_, Ends::AtOnce) => {}
            (ConditionFate::FailsAtOnce, _) => *self = Ends::AtOnce,
            (ConditionFate::Fails(at), Ends::At(earlier, _)) if *earlier <= at => {}
            (ConditionFate::Fails(at), _) => *self = Ends::At(at, which),
        }
    }
}

#[inline(always)]
fn polynomial(length: f64, offset: f64, of: impl Fn(usize) -> f64) -> Polynomial {
    let mut coefficients = [0.0; ORDER + 1];
    for (k, coefficient) in coefficients.iter_mut().enumerate() {
        *coefficient = of(k);
    }
    coefficients[0] += offset;
    Polynomial { coefficients, length }
}

/// Returns the series of the remaining friction of a sticking ball against a force in this
/// direction: μ times the normal force minus the force required to stick.
#[inline(always)]
fn held<S: Simd, const N: usize>(
    series: &Series<S, N>,
    own: &Lane<N>,
    lane: usize,
    ball: usize,
    sign: f64,
) -> impl Fn(usize) -> f64 {
    let [c, s] = &series.solver.trigonometry[ball];
    let (c, s) = (c[lane], s[lane]);
    let limit = own.balancer.balls[ball].friction.limit;
    let left = series.solver.residual[ball][lane] != 0.0;
    move |k| {
        if k == ORDER {
            return 0.0;
        }
        let [x, y] = &series.terms[k].pull;
        let (x, y) = (x[lane], y[lane]);
        let pressed = if k == 0 || left { pressed(series, own, lane, ball, k) } else { 0.0 };
        let normal = pressed - (c * x + s * y);
        limit * normal - sign * (s * x - c * y)
    }
}

/// Returns the normal force on a ball without the table's acceleration.
#[inline(always)]
fn pressed<S: Simd, const N: usize>(
    series: &Series<S, N>,
    own: &Lane<N>,
    lane: usize,
    ball: usize,
    k: usize,
) -> f64 {
    let parameters = &own.balancer.balls[ball];
    let speed = own.balancer.speed;
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
fn normal_force<S: Simd, const N: usize>(
    series: &Series<S, N>,
    own: &Lane<N>,
    lane: usize,
    ball: usize,
) -> [f64; ORDER + 1] {
    let contact = own.phases[ball].contact(&own.balancer.balls[ball].friction, 1.0);
    let friction = contact.signed_friction;
    let share = 1.0 / own.balancer.balls[ball].mass;
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
        pressed(series, own, lane, ball, k) - share * pulled
    })
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::event_functions::look_over;
    use super::super::{Group, LANES, Lanes, Room, Saved, SimdLevel};
    use super::{Ends, first_event};
    use crate::model::{Balancer, FrictionLaw, Machine, Method, NormalForce, State};
    use crate::motion::contact::SmoothPhase;
    use crate::motion::{Settings, Tolerance};
    use fearless_simd::{Simd, SimdBase};

    const PLACES: u32 = 400;

    /// Balls that turn about as fast as the disc, but backwards, have a normal force near zero: a
    /// ball that leaves the ring within a step, according to the forces of one run at many
    /// instants, is detected, and not too late.
    #[test]
    fn balls_that_leave_the_ring_are_seen() {
        let Some(simd) = SimdLevel::best().avx2() else { return };
        let machine = Machine {
            speed_rad_s: -216.3772,
            normal_force: NormalForce::Newton,
            ..Machine::default()
        };
        // The large drag slows a ball that runs backwards faster than the disc to the disc's speed
        // within a step, even for a small motion of the table.
        let of_critical_drag = machine.balls[0].mass_kg * machine.natural_frequency_rad_s();
        let dragged =
            Machine { friction: FrictionLaw::viscous(of_critical_drag), ..machine.clone() };
        seen_in(simd, &machine, 0.3);
        seen_in(simd, &dragged, 3e-3);
    }

    fn seen_in(simd: impl Simd, machine: &Machine, moved: f64) {
        let balancer = Balancer::<2>::new(machine).unwrap();
        let settings = Settings {
            method: Method::Event,
            band: 0.0,
            tolerance: Tolerance { relative: 1e-8, absolute: 1e-10 },
            effort_limit: 1000,
        };
        let (mut left, mut stayed, mut unseen) = (0, 0, 0);
        for round in 0..100 {
            let mut group = Group::<_, 2>::new(simd);
            let mut room = Room::<_, 2>::new(simd);
            let value = |lane: usize, k: usize| {
                libm::sin((1 + 97 * round + 13 * lane) as f64 * (1.0 + 0.37 * k as f64))
            };
            for lane in 0..LANES {
                let start = State {
                    position: [moved * value(lane, 0), moved * value(lane, 1)],
                    velocity: [moved * value(lane, 2), moved * value(lane, 3)],
                    beta: [3.0 + 3.0 * value(lane, 4), 3.0 + 3.0 * value(lane, 5)],
                    beta_dot: [
                        -balancer.speed * (1.0 + 0.6 * value(lane, 6)),
                        -balancer.speed * (1.0 + 0.6 * value(lane, 7)),
                    ],
                };
                // Some have no positive normal force at the start.
                if let Ok(saved) = Saved::start(&balancer, settings, start) {
                    group.put(lane, &saved, 10.0);
                }
            }
            room.series.expand(&group.equations, &group.state);
            let length = 0.8;
            let lengths = Lanes::splat(simd, length);
            let Room { series, doubts, .. } = &mut room;
            look_over(series, &group.equations, &group.watched, lengths, doubts);
            for lane in 0..LANES {
                let Some(own) = &group.lanes[lane] else { continue };
                let powers = series.powers(lane, &group.state(lane), length);
                let phase = SmoothPhase::new(&balancer, &own.phases);
                let fails =
                    (1..=PLACES).map(|place| f64::from(place) / f64::from(PLACES)).find(|part| {
                        let mut state = State::zero();
                        for power in powers.iter().rev() {
                            let higher = state;
                            state = *power;
                            state.add_scaled(*part, &higher);
                        }
                        phase.forces(&state).normal.iter().any(|normal| *normal < -1e-6)
                    });
                let Some(fails) = fails else {
                    stayed += 1;
                    unseen += usize::from(doubts.any() & 1 << lane == 0);
                    continue;
                };
                left += 1;
                assert!(doubts.any() & 1 << lane != 0, "{round} {lane}: at {fails}");
                match first_event(series, own, lane, length, doubts) {
                    Ends::At(part, _) => assert!(part <= fails, "{part} {fails}"),
                    Ends::AtOnce | Ends::Nothing => panic!("{round} {lane}: at {fails}"),
                }
            }
        }
        assert!(left > 50 && stayed > 50 && unseen > 5, "{left} {stayed} {unseen}");
    }
}
