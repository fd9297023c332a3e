//! A ball that runs down in a ring at rest, as in the thesis's friction test (section 3.6), against its closed form.
//!
//! The disc does not turn and the table does not move. In the equations of motion remain
//!
//! ```text
//! (1 + 4J) β̈ = -μ f_n sign(β̇)        f_n = (1 + 4J) β̇² (lagrange),  f_n = β̇² (newton)
//! ```
//!
//! With `κ = μ` for `lagrange` and `κ = μ / (1 + 4J)` for `newton`, `1/|β̇| = 1/|β̇₀| + κ t`, and the ball has run through
//! the angle `ln(1 + κ |β̇₀| t) / κ`.

use stickslip::model::{Balancer, Ball, Machine, Method, NormalForce, SPHERE_INERTIA, State};
use stickslip::motion::Motion;

use super::samples::{settings, unwrapped};
use crate::support::{for_each_kernel, go_on, started};

const FRICTION: f64 = 2.75e-3;
/// The ball's speed decreases from 225 to 100 rad/s in the thesis's test.
const SPEEDS_RAD_S: [f64; 2] = [225.0, 100.0];

/// The thesis's machine with one ball on a disc at rest. A clamp holds the thesis's table; this one is so heavy, with the same
/// natural frequency, that the ball hardly moves it.
fn machine(normal_force: NormalForce) -> Machine {
    let default = Machine::default();
    Machine {
        table_mass_kg: 1e12 * default.table_mass_kg,
        stiffness_n_m: 1e12 * default.stiffness_n_m,
        damping_n_s_m: 1e12 * default.damping_n_s_m,
        speed_rad_s: 0.0,
        balls: vec![Ball { friction_coefficient: FRICTION, ..Ball::default() }],
        normal_force,
        ..default
    }
}

/// The run-down in closed form, without dimensions.
struct RunDown {
    friction: f64,
    start: f64,
}

impl RunDown {
    fn of(normal_force: NormalForce, start: f64) -> Self {
        let friction = match normal_force {
            NormalForce::Lagrange => FRICTION,
            NormalForce::Newton => FRICTION / 1.4,
        };
        RunDown { friction, start }
    }

    fn speed(&self, time: f64) -> f64 {
        self.start / (1.0 + self.friction * self.start.abs() * time)
    }

    fn angle(&self, time: f64) -> f64 {
        let angle = (self.friction * self.start.abs() * time).ln_1p() / self.friction;
        angle.copysign(self.start)
    }

    fn time_of_speed(&self, speed: f64) -> f64 {
        (1.0 / speed.abs() - 1.0 / self.start.abs()) / self.friction
    }
}

fn state_now(motion: &Motion) -> State<1> {
    State::of_components(&unwrapped(motion)).expect("components of one ball")
}

/// Both methods and both kernels follow the closed form over some fifty turns, in both directions.
#[test]
fn a_ball_runs_down_in_a_ring_at_rest() {
    assert_eq!(1.0 + 4.0 * SPHERE_INERTIA, 1.4);
    let mut largest = [0.0_f64; 2];
    for normal_force in [NormalForce::Lagrange, NormalForce::Newton] {
        let machine = machine(normal_force);
        machine.validate().expect("a machine");
        let balancer = Balancer::<1>::new(&machine).expect("one ball");
        let [from, to] = SPEEDS_RAD_S.map(|speed| speed / machine.natural_frequency_rad_s());
        for (direction, system) in [-1.0, 1.0]
            .into_iter()
            .flat_map(|sign| for_each_kernel(balancer).map(|system| (sign, system)))
        {
            let exact = RunDown::of(normal_force, direction * from);
            let end = exact.time_of_speed(to);
            let start = State {
                position: [0.0; 2],
                velocity: [0.0; 2],
                beta: [1.0],
                beta_dot: [exact.start],
            };
            for method in [Method::Event, Method::Switch] {
                let mut motion = started(&system, settings(method, 1e-12), &start);
                for part in 1..=8 {
                    let time = end * f64::from(part) / 8.0;
                    go_on(&mut motion, time);
                    let State { position: [x, y], beta: [beta], beta_dot: [speed], .. } =
                        state_now(&motion);
                    let turned = beta - 1.0;
                    let case = format!("{normal_force:?} {method:?} {direction} {time}");
                    let errors = [speed / exact.speed(time) - 1.0, turned - exact.angle(time)];
                    largest = [0, 1].map(|which| largest[which].max(errors[which].abs()));
                    assert!(
                        errors[0].abs() < 1e-11 && errors[1].abs() < 1e-9,
                        "{case}: {errors:?}"
                    );
                    assert!(x.hypot(y) < 1e-12, "{case}: the table stands still");
                }
                let State { beta_dot: [speed], .. } = state_now(&motion);
                assert!((speed.abs() / to - 1.0).abs() < 1e-10, "{speed} {to}");
            }
        }
    }
    println!("largest errors of speed and angle: {largest:?}");
}
