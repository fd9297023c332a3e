//! The equations of motion of a balancer for all lanes at once.
//!
//! The same as `model::equations` (for each ball first, then a 2×2 system for the table), written with
//! fused multiply-adds and with what does not change within a smooth phase computed once. Friction is
//! `p f_n + q β̇`: Coulomb friction and viscous drag.

use fearless_simd::{Simd, prelude::*};

use super::trigonometry::sin_cos;
use super::{Flow, Lanes};

/// What a ball's equation needs.
#[derive(Clone, Copy)]
pub(crate) struct Ball<S: Simd> {
    /// m
    pub(super) mass: Lanes<S>,
    /// 1 where it may accelerate, 0 where it sticks.
    pub(super) free: Lanes<S>,
    /// 1 / (1 + 4 J) where it may accelerate, else 0.
    pub(super) mobility: Lanes<S>,
    /// m times that.
    pub(super) mobile_mass: Lanes<S>,
    /// p = ±μ; 0 where it sticks.
    pub(super) friction: Lanes<S>,
    /// q; 0 where it sticks.
    pub(super) drag: Lanes<S>,
    /// -2 J d ω and 4 J (or 0): the rolling term, subtracted.
    pub(super) rolling_linear: Lanes<S>,
    pub(super) rolling_quadratic: Lanes<S>,
}

/// The parameters of one smooth phase.
#[derive(Clone, Copy)]
pub(crate) struct Equations<S: Simd, const N: usize> {
    /// ω
    pub(super) speed: Lanes<S>,
    pub(super) double_speed: Lanes<S>,
    pub(super) speed_squared: Lanes<S>,
    /// 2ζ
    pub(super) drag: Lanes<S>,
    /// 2ζω
    pub(super) drag_speed: Lanes<S>,
    /// m_I e ω²
    pub(super) imbalance: Lanes<S>,
    pub(super) balls: [Ball<S>; N],
}

/// The forces on a ball.
#[derive(Clone, Copy)]
pub(crate) struct Force<S: Simd> {
    pub(super) sine: Lanes<S>,
    pub(super) cosine: Lanes<S>,
    /// Normal force.
    pub(super) normal: Lanes<S>,
    /// What sticking takes: s a_x - c a_y.
    pub(super) tangential: Lanes<S>,
}

/// What the equations for a displacement need of a state.
#[derive(Clone, Copy)]
pub(crate) struct Linearised<S: Simd, const N: usize> {
    /// Sine and cosine of the balls' angles.
    pub(super) trigonometry: [(Lanes<S>, Lanes<S>); N],
    /// Speeds of the balls.
    pub(super) speed: [Lanes<S>; N],
    /// Accelerations of the balls.
    pub(super) acceleration: [Lanes<S>; N],
    /// Absolute acceleration of the table.
    pub(super) table: [Lanes<S>; 2],
    /// The 2×2 system's coefficients and one over its determinant.
    pub(super) system: [Lanes<S>; 4],
    pub(super) inverse: Lanes<S>,
}

impl<S: Simd, const N: usize> Equations<S, N> {
    /// Zero in all lanes: what no run is computed with.
    #[inline(always)]
    pub(super) fn blank(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let ball = Ball {
            mass: zero,
            free: zero,
            mobility: zero,
            mobile_mass: zero,
            friction: zero,
            drag: zero,
            rolling_linear: zero,
            rolling_quadratic: zero,
        };
        Equations {
            speed: zero,
            double_speed: zero,
            speed_squared: zero,
            drag: zero,
            drag_speed: zero,
            imbalance: zero,
            balls: [ball; N],
        }
    }

    /// Rate of change of a state. One function for all stages of a step: they are large, and so would
    /// be the time to compile them.
    #[inline(never)]
    pub(super) fn rate(&self, state: &Flow<S, N>, rate: &mut Flow<S, N>) {
        self.speed.simd.vectorize(
            #[inline(always)]
            || *rate = self.evaluate(state).0,
        );
    }

    /// The same with what a displacement needs.
    #[inline(never)]
    pub(super) fn rate_and_linearised(
        &self,
        state: &Flow<S, N>,
        rate: &mut Flow<S, N>,
        linearised: &mut Linearised<S, N>,
    ) {
        self.speed.simd.vectorize(
            #[inline(always)]
            || (*rate, _, *linearised) = self.evaluate(state),
        );
    }

    /// Rate of change, forces and what a displacement needs.
    #[inline(always)]
    pub(super) fn evaluate(
        &self,
        state: &Flow<S, N>,
    ) -> (Flow<S, N>, [Force<S>; N], Linearised<S, N>) {
        let [x, y, x_dot, y_dot] = state.table;
        let one = Lanes::splat(x.simd, 1.0);
        let zero = Lanes::splat(x.simd, 0.0);
        let mut force_x = self.drag_speed.mul_add_precise(y, self.imbalance - x);
        force_x = (-self.drag).mul_add_precise(x_dot, force_x);
        let mut force_y = (-self.drag_speed).mul_add_precise(x, -y);
        force_y = (-self.drag).mul_add_precise(y_dot, force_y);
        let frame_x = self.double_speed.mul_add_precise(y_dot, self.speed_squared * x);
        let frame_y = (-self.double_speed).mul_add_precise(x_dot, self.speed_squared * y);

        let mut trigonometry = [(zero, zero); N];
        let (mut u, mut v, mut held, mut pressed) = ([zero; N], [zero; N], [zero; N], [zero; N]);
        // Sums over the balls stand apart from the table's own terms and are not fused, so that two
        // balls exchanged give the same to the last bit.
        let (mut m_xx, mut m_xy, mut m_yx, mut m_yy) = (zero, zero, zero, zero);
        let (mut push_x, mut push_y) = (zero, zero);
        for i in 0..N {
            let ball = &self.balls[i];
            let speed = state.speed[i];
            let (s, c) = sin_cos(state.angle[i]);
            trigonometry[i] = (s, c);
            let w = self.speed + speed;
            let w_squared = w * w;
            let rolling = ball.rolling_quadratic.mul_add_precise(speed, ball.rolling_linear);
            pressed[i] = rolling.mul_add_precise(speed, w_squared);
            u[i] = ball.friction.mul_add_precise(c, s);
            v[i] = ball.friction.mul_add_precise(s, -c);
            held[i] = ball.friction.mul_add_precise(pressed[i], ball.drag * speed);
            let along_x = ball.mobile_mass * u[i];
            let along_y = ball.mobile_mass * v[i];
            let outward = ball.mass * w_squared;
            let pulled = ball.mobile_mass * held[i];
            let terms = [
                s * along_x,
                s * along_y,
                c * along_x,
                c * along_y,
                c.mul_add_precise(outward, -(s * pulled)),
                s.mul_add_precise(outward, c * pulled),
            ];
            if i == 0 {
                [m_xx, m_xy, m_yx, m_yy, push_x, push_y] = terms;
            } else {
                m_xx += terms[0];
                m_xy += terms[1];
                m_yx += terms[2];
                m_yy += terms[3];
                push_x += terms[4];
                push_y += terms[5];
            }
        }
        force_x += push_x;
        force_y += push_y;
        // a_x = (d F_x + m_xy F_y) / det, a_y = (a F_y - m_yx F_x) / det, det = a d + m_xy m_yx
        let (a, d) = (one - m_xx, one + m_yy);
        let determinant = a.mul_add_precise(d, m_xy * m_yx);
        let inverse = one / determinant;
        let a_x = d.mul_add_precise(force_x, m_xy * force_y) * inverse;
        let a_y = a.mul_add_precise(force_y, -(m_yx * force_x)) * inverse;

        let mut rate = Flow {
            table: [x_dot, y_dot, a_x + frame_x, a_y + frame_y],
            angle: [zero; N],
            speed: [zero; N],
        };
        let nothing = Force { sine: zero, cosine: zero, normal: zero, tangential: zero };
        let mut forces = [nothing; N];
        let mut acceleration = [zero; N];
        for i in 0..N {
            let ball = &self.balls[i];
            let (s, c) = trigonometry[i];
            let speed = state.speed[i];
            acceleration[i] =
                ball.mobility * u[i].mul_add_precise(a_x, v[i].mul_add_precise(a_y, -held[i]));
            // A ball that sticks keeps its angle, and what is left of its speed dies out.
            rate.angle[i] = ball.free * speed;
            rate.speed[i] = acceleration[i] + (rate.angle[i] - speed);
            forces[i] = Force {
                sine: s,
                cosine: c,
                normal: pressed[i] - c.mul_add_precise(a_x, s * a_y),
                tangential: s.mul_add_precise(a_x, -(c * a_y)),
            };
        }
        let linearised = Linearised {
            trigonometry,
            speed: state.speed,
            acceleration,
            table: [a_x, a_y],
            system: [a, m_xy, m_yx, d],
            inverse,
        };
        (rate, forces, linearised)
    }

    /// Rate of change of a small displacement from a state.
    #[inline(never)]
    pub(super) fn displacement_rate(
        &self,
        at: &Linearised<S, N>,
        displacement: &Flow<S, N>,
        rate: &mut Flow<S, N>,
    ) {
        self.speed.simd.vectorize(
            #[inline(always)]
            || *rate = self.linear(at, displacement),
        );
    }

    #[inline(always)]
    fn linear(&self, at: &Linearised<S, N>, displacement: &Flow<S, N>) -> Flow<S, N> {
        let [x, y, x_dot, y_dot] = displacement.table;
        let [a_x, a_y] = at.table;
        let zero = Lanes::splat(x.simd, 0.0);
        let two = Lanes::splat(x.simd, 2.0);
        let mut force_x = self.drag_speed.mul_add_precise(y, -x);
        force_x = (-self.drag).mul_add_precise(x_dot, force_x);
        let mut force_y = (-self.drag_speed).mul_add_precise(x, -y);
        force_y = (-self.drag).mul_add_precise(y_dot, force_y);
        let frame_x = self.double_speed.mul_add_precise(y_dot, self.speed_squared * x);
        let frame_y = (-self.double_speed).mul_add_precise(x_dot, self.speed_squared * y);
        let (mut u, mut v, mut own) = ([zero; N], [zero; N], [zero; N]);
        let (mut push_x, mut push_y) = (zero, zero);
        for i in 0..N {
            let ball = &self.balls[i];
            let (s, c) = at.trigonometry[i];
            let (turned, speed) = (displacement.angle[i], displacement.speed[i]);
            let w = self.speed + at.speed[i];
            u[i] = ball.friction.mul_add_precise(c, s);
            v[i] = ball.friction.mul_add_precise(s, -c);
            let rolling =
                (ball.rolling_quadratic * two).mul_add_precise(at.speed[i], ball.rolling_linear);
            let pressed = two.mul_add_precise(w, rolling);
            let held = ball.friction.mul_add_precise(pressed, ball.drag);
            own[i] =
                u[i].mul_add_precise(a_y, -(v[i] * a_x)).mul_add_precise(turned, -(held * speed));
            let w_squared = w * w;
            let pulled = ball.mobile_mass * own[i];
            let acceleration = at.acceleration[i];
            let around_x = c.mul_add_precise(acceleration, -(s * w_squared)) * turned;
            let around_y = s.mul_add_precise(acceleration, c * w_squared) * turned;
            let faster = two * w * speed;
            let x = s.mul_add_precise(pulled, ball.mass * c.mul_add_precise(faster, around_x));
            let y = (-c).mul_add_precise(pulled, ball.mass * s.mul_add_precise(faster, around_y));
            if i == 0 {
                (push_x, push_y) = (x, y);
            } else {
                (push_x, push_y) = (push_x + x, push_y + y);
            }
        }
        force_x += push_x;
        force_y += push_y;
        let [a, m_xy, m_yx, d] = at.system;
        let table_x = d.mul_add_precise(force_x, m_xy * force_y) * at.inverse;
        let table_y = a.mul_add_precise(force_y, -(m_yx * force_x)) * at.inverse;
        let mut rate = Flow {
            table: [x_dot, y_dot, table_x + frame_x, table_y + frame_y],
            angle: [zero; N],
            speed: [zero; N],
        };
        for i in 0..N {
            let ball = &self.balls[i];
            let speed = displacement.speed[i];
            let pulled = u[i].mul_add_precise(table_x, v[i].mul_add_precise(table_y, own[i]));
            rate.angle[i] = ball.free * speed;
            rate.speed[i] = ball.mobility.mul_add_precise(pulled, rate.angle[i] - speed);
        }
        rate
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::{Flow, Group, LANES, Saved, VectorLevel};
    use crate::model::{Balancer, Dual, FrictionLaw, Machine, Method, State};
    use crate::motion::contact::{Phase, SmoothPhase};
    use crate::motion::{Settings, Tolerance};

    fn machine(lane: usize, balls: usize) -> Machine {
        let mut machine = Machine::default();
        machine.balls.resize(balls, machine.balls[0]);
        machine.speed_rad_s = -150.0 - 20.0 * lane as f64;
        for (index, ball) in machine.balls.iter_mut().enumerate() {
            ball.mass_kg *= 1.0 + 0.3 * index as f64;
            ball.friction_coefficient *= 1.0 + lane as f64;
        }
        if lane == 5 {
            machine.friction = FrictionLaw::Viscous { viscous_coefficient_n_s_m: 3e-3 };
        }
        machine
    }

    fn state<const N: usize>(lane: usize) -> State<N> {
        let value = |k: usize| libm::sin((7 * lane + 3 * k) as f64);
        State {
            position: [0.02 * value(0), 0.03 * value(1)],
            velocity: [0.04 * value(2), 0.05 * value(3)],
            beta: std::array::from_fn(|ball| 3.0 + 3.0 * value(4 + ball)),
            // Every other ball rests.
            beta_dot: std::array::from_fn(|ball| {
                if (ball + lane).is_multiple_of(3) { 0.0 } else { value(9 + ball) }
            }),
        }
    }

    fn largest<const N: usize>(state: &State<N>) -> f64 {
        let State { position, velocity, beta, beta_dot } = state;
        let all = position.iter().chain(velocity).chain(beta).chain(beta_dot);
        all.fold(0.0, |most: f64, value| most.max(value.abs()))
    }

    /// Rates of change of states and of displacements in lanes against the equations of one run, eight
    /// different machines side by side.
    fn against_one_run<const N: usize>() {
        let Some(simd) = VectorLevel::best().avx2() else { return };
        let settings = Settings {
            method: Method::Event,
            band: 0.0,
            tolerance: Tolerance { relative: 1e-8, absolute: 1e-10 },
            effort_limit: 1000,
        };
        let mut group = Group::<_, N>::new(simd);
        let balancers: Vec<Balancer<N>> =
            (0..LANES).map(|lane| Balancer::new(&machine(lane, N)).unwrap()).collect();
        for (lane, balancer) in balancers.iter().enumerate() {
            let saved = Saved::start(balancer, settings, state(lane)).unwrap();
            group.put(lane, &saved, 1.0);
            group.displacement.set_lane(lane, &state(lane + 100));
        }
        let mut rate = Flow::zero(simd);
        group.equations.rate(&group.state, &mut rate);
        let (_, forces, linearised) = group.equations.evaluate(&group.state);
        let mut displaced = Flow::zero(simd);
        group.equations.displacement_rate(&linearised, &group.displacement, &mut displaced);
        for (lane, balancer) in balancers.iter().enumerate() {
            let saved = group.copy(lane).unwrap();
            let phase = SmoothPhase::new(balancer, &saved.lane.phases);
            let mut difference = phase.derivative(&saved.state);
            difference.add_scaled(-1.0, &rate.lane(lane));
            assert!(largest(&difference) < 1e-14, "{difference:?} in lane {lane}");
            let expected = phase.forces(&saved.state);
            for (ball, force) in forces.iter().enumerate() {
                assert!((force.normal[lane] - expected.normal[ball]).abs() < 1e-14);
                let sticks = saved.lane.phases[ball] == Phase::Stick;
                let tangential = force.tangential[lane];
                assert!(!sticks || (tangential - expected.friction[ball]).abs() < 1e-14);
            }
            let along: State<N, Dual> = saved.state.along(&group.displacement.lane(lane));
            let mut difference = phase.along(&along).1.slope();
            difference.add_scaled(-1.0, &displaced.lane(lane));
            assert!(largest(&difference) < 1e-13, "{difference:?} in lane {lane}");
        }
    }

    #[test]
    fn lanes_have_the_equations_of_one_run() {
        against_one_run::<1>();
        against_one_run::<2>();
        against_one_run::<4>();
    }
}
