//! The parameters of the equations of motion of a balancer for all lanes at once.
//!
//! The equations are those of `model::equations`, solved by power series (`series`). Friction is
//! `p f_n + q β̇`: Coulomb friction and viscous drag.

use fearless_simd::{Simd, prelude::*};

use super::Lanes;
use crate::model::{Balancer, Contact};
use crate::motion::contact::Phase;

/// What a ball's equation needs, for what it does.
#[derive(Clone, Copy)]
pub(crate) struct Ball<S: Simd> {
    /// m
    pub(super) mass: Lanes<S>,
    /// 1 where it may move, 0 where it sticks.
    pub(super) free: Lanes<S>,
    /// The other way round.
    pub(super) stuck: Lanes<S>,
    /// 1 / (1 + 4 J) where it may accelerate, else 0.
    pub(super) mobility: Lanes<S>,
    /// p = ±μ; 0 where it sticks.
    pub(super) friction: Lanes<S>,
    /// m / (1 + p²), and that times p.
    pub(super) turned_mass: Lanes<S>,
    pub(super) turned_friction: Lanes<S>,
    /// What presses it on the ring at its speed β̇ but for the table's acceleration: `ω² + these times β̇
    /// and β̇²`, the rolling term among them.
    pub(super) pressed: [Lanes<S>; 2],
    /// What holds it back but for that: these times 1, β̇ and β̇², `p pressed + q β̇`.
    pub(super) held: [Lanes<S>; 3],
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

impl<S: Simd, const N: usize> Equations<S, N> {
    /// Zero in all lanes: what no run is computed with.
    pub(super) fn blank(simd: S) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let ball = Ball {
            mass: zero,
            free: zero,
            stuck: zero,
            mobility: zero,
            friction: zero,
            turned_mass: zero,
            turned_friction: zero,
            pressed: [zero; 2],
            held: [zero; 3],
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

    /// Sets the machine of a lane, but for what depends on what its balls do.
    pub(super) fn set_machine(&mut self, lane: usize, balancer: &Balancer<N>) {
        let speed = balancer.speed;
        let damping = 2.0 * balancer.damping_ratio;
        self.speed[lane] = speed;
        self.double_speed[lane] = 2.0 * speed;
        self.speed_squared[lane] = speed * speed;
        self.drag[lane] = damping;
        self.drag_speed[lane] = damping * speed;
        self.imbalance[lane] = balancer.imbalance * speed * speed;
        for (of_ball, ball) in self.balls.iter_mut().zip(&balancer.balls) {
            of_ball.mass[lane] = ball.mass;
            of_ball.pressed[0][lane] = 2.0 * speed - ball.rolling_linear;
            of_ball.pressed[1][lane] = 1.0 - ball.rolling_quadratic;
        }
    }

    /// Sets what depends on what the balls of a lane do.
    pub(super) fn set_phases(&mut self, lane: usize, balancer: &Balancer<N>, phases: &[Phase; N]) {
        let speed = balancer.speed;
        for ((of_ball, ball), phase) in self.balls.iter_mut().zip(&balancer.balls).zip(phases) {
            let free = if *phase == Phase::Stick { 0.0 } else { 1.0 };
            let Contact { signed_friction: friction, drag, .. } =
                phase.contact(&ball.friction, 1.0);
            let turned = ball.mass / (1.0 + friction * friction);
            of_ball.free[lane] = free;
            of_ball.stuck[lane] = 1.0 - free;
            of_ball.mobility[lane] = ball.mobility * free;
            of_ball.friction[lane] = friction;
            of_ball.turned_mass[lane] = turned;
            of_ball.turned_friction[lane] = turned * friction;
            of_ball.held[0][lane] = friction * (speed * speed);
            of_ball.held[1][lane] = friction * (2.0 * speed - ball.rolling_linear) + drag;
            of_ball.held[2][lane] = friction * (1.0 - ball.rolling_quadratic);
        }
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
