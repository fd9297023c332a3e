//! The parameters of the equations of motion of a balancer for all lanes.
//!
//! The equations are those of `model::equations`, solved by power series (`series`). Friction is
//! `p f_n + q β̇`: Coulomb friction, viscous drag, or both.

use std::sync::Arc;

use fearless_simd::SimdBase;

use crate::model::{Balancer, Contact, Dual, Friction, System};
use crate::motion::Phase;
use crate::motion::lockstep::Lanes;
use crate::motion::lockstep::vector::Vector;

/// The coefficients of a ball's equation in its current phase.
#[derive(Clone, Copy)]
pub(crate) struct BallEquation<S: Vector> {
    /// m
    pub(super) mass: Lanes<S>,
    /// 1 if it may move, 0 if it sticks.
    pub(super) free: Lanes<S>,
    /// 0 if it may move, 1 if it sticks.
    pub(super) stuck: Lanes<S>,
    /// p = ±μ; 0 if it sticks.
    pub(super) friction: Lanes<S>,
    pub(super) minus_friction: Lanes<S>,
    /// m / (1 + p²)
    pub(super) turned: Lanes<S>,
    /// 1 / (1 + 4 J) if it may accelerate, else 0.
    pub(super) mobility: Lanes<S>,
    /// 1 / (1 + 4 J) over `turned` if it may accelerate, else 0.
    pub(super) drawing: Lanes<S>,
    /// The normal force at the speed β̇ without the table's acceleration is `ω² + pressed[0] β̇ +
    /// pressed[1] β̇²`, including the rolling term.
    pub(super) pressed: [Lanes<S>; 2],
    /// The least of that normal force at any speed.
    pub(super) least_pressed: Lanes<S>,
    /// The resistance without the table's acceleration, `p pressed + q β̇`, over 1 + 4 J:
    /// coefficients of 1, β̇ and β̇².
    pub(super) held: [Lanes<S>; 3],
}

/// The parameters of one smooth phase.
#[derive(Clone, Copy)]
pub(crate) struct Equations<S: Vector, const N: usize> {
    /// ω
    pub(super) speed: Lanes<S>,
    pub(super) double_speed: Lanes<S>,
    pub(super) minus_double_speed: Lanes<S>,
    pub(super) speed_squared: Lanes<S>,
    /// -2ζ
    pub(super) minus_drag: Lanes<S>,
    /// 2ζω
    pub(super) drag_speed: Lanes<S>,
    pub(super) minus_drag_speed: Lanes<S>,
    /// The constant force on the table: m_I e ω², and with runout `-(1 - Σ m) S` (`model::equations`).
    pub(super) constant: [Lanes<S>; 2],
    /// The acceleration of the table without that of the ring's centre, `S`: ω² times the runout.
    pub(super) runout: [Lanes<S>; 2],
    pub(super) balls: [BallEquation<S>; N],
}

impl<S: Vector, const N: usize> Equations<S, N> {
    /// Zero in all lanes; never used for a run.
    pub(super) fn blank(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let ball = BallEquation {
            mass: zero,
            free: zero,
            stuck: zero,
            friction: zero,
            minus_friction: zero,
            turned: zero,
            mobility: zero,
            drawing: zero,
            pressed: [zero; 2],
            least_pressed: zero,
            held: [zero; 3],
        };
        Equations {
            speed: zero,
            double_speed: zero,
            minus_double_speed: zero,
            speed_squared: zero,
            minus_drag: zero,
            drag_speed: zero,
            minus_drag_speed: zero,
            constant: [zero; 2],
            runout: [zero; 2],
            balls: [ball; N],
        }
    }

    /// Sets the machine of a lane, except for the coefficients that depend on the phases of its
    /// balls.
    pub(super) fn set_machine(&mut self, lane: usize, balancer: &Balancer<N>) {
        let speed = balancer.speed;
        let damping = 2.0 * balancer.damping_ratio;
        self.speed[lane] = speed;
        self.double_speed[lane] = 2.0 * speed;
        self.minus_double_speed[lane] = -2.0 * speed;
        self.speed_squared[lane] = speed * speed;
        self.minus_drag[lane] = -damping;
        self.drag_speed[lane] = damping * speed;
        self.minus_drag_speed[lane] = -damping * speed;
        let balls = balancer.balls.iter().fold(0.0, |sum, ball| sum + ball.mass);
        let runout = balancer.runout.unwrap_or_default();
        for (axis, imbalance) in [balancer.imbalance, 0.0].into_iter().enumerate() {
            let acceleration = speed * speed * runout[axis];
            self.runout[axis][lane] = acceleration;
            self.constant[axis][lane] = imbalance * speed * speed - (1.0 - balls) * acceleration;
        }
        for (of_ball, ball) in self.balls.iter_mut().zip(&balancer.balls) {
            of_ball.mass[lane] = ball.mass;
            let linear = 2.0 * speed - ball.rolling_linear;
            let quadratic = 1.0 - ball.rolling_quadratic;
            of_ball.pressed[0][lane] = linear;
            of_ball.pressed[1][lane] = quadratic;
            of_ball.least_pressed[lane] = speed * speed - linear * linear / (4.0 * quadratic);
        }
    }

    /// Sets the coefficients that depend on the phase of a ball of a lane.
    pub(super) fn set_phase(
        &mut self,
        lane: usize,
        balancer: &Balancer<N>,
        (place, phase): (usize, Phase),
    ) {
        let (of_ball, ball) = (&mut self.balls[place], &balancer.balls[place]);
        let speed = balancer.speed;
        let free = if phase == Phase::Stick { 0.0 } else { 1.0 };
        let Contact { signed_friction: friction, drag, .. } = contact(phase, &ball.friction, 1.0);
        let turned = ball.mass / (1.0 + friction * friction);
        let mobility = ball.mobility * free;
        of_ball.free[lane] = free;
        of_ball.stuck[lane] = 1.0 - free;
        of_ball.friction[lane] = friction;
        of_ball.minus_friction[lane] = -friction;
        of_ball.turned[lane] = turned;
        of_ball.mobility[lane] = mobility;
        of_ball.drawing[lane] = mobility / turned;
        let linear = friction * (2.0 * speed - ball.rolling_linear) + drag;
        of_ball.held[0][lane] = mobility * (friction * (speed * speed));
        of_ball.held[1][lane] = mobility * linear;
        of_ball.held[2][lane] = mobility * (friction * (1.0 - ball.rolling_quadratic));
    }
}

/// Returns how friction acts on a contact in a phase.
#[inline]
pub(in crate::motion::lockstep) fn contact(
    phase: Phase,
    friction: &Friction,
    speed: f64,
) -> Contact {
    match phase {
        Phase::Stick | Phase::Apart | Phase::Open | Phase::Closed => Contact::STICK,
        Phase::Slip(direction) => friction.slip(direction.sign(), speed),
        Phase::Transition(direction) => friction.slip(direction.sign(), 0.0),
        Phase::Free => friction.slip(0.0, speed),
    }
}

/// Returns [`contact`] to first order in the speed.
pub(super) fn contact_along(phase: Phase, friction: &Friction, speed: Dual) -> Contact<Dual> {
    match phase {
        Phase::Stick | Phase::Apart | Phase::Open | Phase::Closed => Contact::STICK.lifted(),
        Phase::Slip(direction) => friction.slip_along(direction.sign(), speed),
        Phase::Transition(direction) => {
            friction.slip_along(direction.sign(), Dual { value: 0.0, slope: 0.0 })
        }
        Phase::Free => friction.slip_along(0.0, speed),
    }
}

/// Returns the balancer that a system is while no balls touch.
pub(super) fn while_apart<const N: usize>(system: &Arc<dyn System>) -> Option<&Balancer<N>> {
    system.while_apart().downcast_ref()
}
