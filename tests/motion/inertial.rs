//! An independent formulation in inertial space: Newton's equations for every body, with contact
//! forces and rolling as unknowns, without the turning frame.

use nalgebra::{DMatrix, DVector};
use stickslip::model::{Balancer, Machine, Method, NormalForce, State};
use stickslip::motion::{Direction, Evaluator, Motion, Phase};

use super::samples::{Sampler, difference, settings, stuck_table};
use crate::support::{for_each_kernel, go_on, reference, shared, started};

/// Position and velocity of the ring's centre, angle and rate of each ball, in inertial space, and
/// the direction of the imbalance.
struct Inertial {
    centre: [f64; 2],
    velocity: [f64; 2],
    angle: Vec<f64>,
    rate: Vec<f64>,
    imbalance: f64,
}

/// Converts a state in the turning frame to space, for a direction of the imbalance.
fn in_space<const N: usize>(balancer: &Balancer<N>, state: &State<N>, imbalance: f64) -> Inertial {
    let (s, c) = imbalance.sin_cos();
    let turned = |[x, y]: [f64; 2]| [c * x - s * y, s * x + c * y];
    let ([x, y], [x_dot, y_dot], omega) = (state.position, state.velocity, balancer.speed);
    Inertial {
        centre: turned([x, y]),
        velocity: turned([x_dot - omega * y, y_dot + omega * x]),
        angle: state.beta.map(|beta| imbalance + beta).to_vec(),
        rate: state.beta_dot.map(|beta_dot| omega + beta_dot).to_vec(),
        imbalance,
    }
}

struct Solved {
    /// Of the ring's centre, in space.
    acceleration: [f64; 2],
    /// Of each ball's angle.
    angular: Vec<f64>,
    normal: Vec<f64>,
    friction: Vec<f64>,
}

/// Unknowns: acceleration of the centre (2); for each ball its acceleration (2), normal and
/// tangential contact force, moment of the rolling resistance, angular acceleration of its spin and
/// of its position on the ring. `direction`: 1 or -1 in slip, `None` in stick.
fn newton<const N: usize>(
    machine: &Machine,
    balancer: &Balancer<N>,
    state: &Inertial,
    direction: &[Option<f64>; N],
) -> Solved {
    let (omega, zeta) = (balancer.speed, balancer.damping_ratio);
    let imbalance_mass = machine.imbalance_mass_kg / machine.total_mass_kg();
    let radius = machine.imbalance_radius_m / machine.ring_radius_m;
    let table = machine.table_mass_kg / machine.total_mass_kg();
    let size = 2 + 7 * N;
    let (mut a, mut b) = (DMatrix::<f64>::zeros(size, size), DVector::<f64>::zeros(size));
    // Table and disc: the imbalance turns about the centre at the disc's speed.
    let towards = [state.imbalance.cos(), state.imbalance.sin()];
    let runout = {
        let angle = state.imbalance + machine.ring_runout_angle_rad;
        [angle.cos(), angle.sin()].map(|part| part * machine.ring_runout_m / machine.ring_radius_m)
    };
    for axis in 0..2 {
        a[(axis, axis)] = table + imbalance_mass;
        b[axis] = imbalance_mass * radius * omega * omega * towards[axis]
            - state.centre[axis]
            - 2.0 * zeta * state.velocity[axis];
    }
    for ball in 0..N {
        let first = 2 + 7 * ball;
        let (normal, tangential, moment) = (first + 2, first + 3, first + 4);
        let (spin, angular) = (first + 5, first + 6);
        let body = &balancer.balls[ball];
        let (s, c) = state.angle[ball].sin_cos();
        let (outward, along) = ([c, s], [-s, c]);
        let rate = state.rate[ball];
        for axis in 0..2 {
            // The ring pushes the ball inwards and pulls it along; the table feels the opposite.
            a[(axis, normal)] = -outward[axis];
            a[(axis, tangential)] = along[axis];
            let row = first + axis;
            a[(row, first + axis)] = body.mass;
            a[(row, normal)] = outward[axis];
            a[(row, tangential)] = -along[axis];
            // The ball stays on the ring.
            let row = first + 2 + axis;
            a[(row, first + axis)] = 1.0;
            a[(row, axis)] = -1.0;
            a[(row, angular)] = -along[axis];
            b[row] = -rate * rate * outward[axis] - omega * omega * runout[axis];
        }
        // Spin: the tangential force at the outer side, and the resistance.
        let row = first + 4;
        a[(row, spin)] = body.inertia * body.mass * body.diameter * body.diameter;
        a[(row, tangential)] = -0.5 * body.diameter;
        a[(row, moment)] = -1.0;
        // Rolling: the spin relative to the disc's is -2 / d times the speed along the ring.
        let row = first + 5;
        a[(row, spin)] = 1.0;
        a[(row, angular)] = 2.0 / body.diameter;
        let row = first + 6;
        match direction[ball] {
            None => a[(row, angular)] = 1.0,
            Some(direction) => {
                let friction = direction * body.friction.coefficient;
                let slip = rate - omega;
                let thesis = match machine.normal_force {
                    NormalForce::Newton => 0.0,
                    NormalForce::Lagrange => {
                        2.0 * body.inertia * slip * (body.diameter * omega - 2.0 * slip)
                    }
                };
                a[(row, moment)] = 2.0 / body.diameter;
                a[(row, normal)] = -friction;
                b[row] = -friction * body.mass * thesis;
            }
        }
    }
    let x = a.lu().solve(&b).expect("a regular system");
    let of = |offset: usize| (0..N).map(|ball| x[2 + 7 * ball + offset]).collect::<Vec<_>>();
    let scaled = |values: Vec<f64>, factor: &dyn Fn(usize) -> f64| {
        values.into_iter().enumerate().map(|(ball, value)| value * factor(ball)).collect()
    };
    Solved {
        acceleration: [x[0], x[1]],
        angular: of(6),
        normal: scaled(of(2), &|ball| 1.0 / balancer.balls[ball].mass),
        friction: scaled(of(4), &|ball| {
            2.0 / (balancer.balls[ball].mass * balancer.balls[ball].diameter)
        }),
    }
}

/// Accelerations and forces agree for any direction of the imbalance.
#[test]
fn forces_agree_in_every_frame() {
    for seed in 0..1000 {
        let mut sampler = Sampler::new(seed);
        let machine = sampler.machine(3);
        let balancer = Balancer::<3>::new(&machine).expect("three balls");
        let state = sampler.state(&balancer);
        let phases = [(); 3].map(|()| {
            sampler.one_of(&[
                Phase::Stick,
                Phase::Slip(Direction::Forward),
                Phase::Slip(Direction::Backward),
            ])
        });
        let direction = phases.map(|phase| match phase {
            Phase::Slip(direction) => Some(direction.sign()),
            _ => None,
        });
        let forces = reference::forces(&balancer, &phases, &state);
        let evaluator = Evaluator::new(shared(balancer));
        let recorded = evaluator.forces(&phases, &state.components());
        let rates = evaluator.rates(&phases, &state.components());
        let imbalance = sampler.between(-10.0, 10.0);
        let solved =
            newton(&machine, &balancer, &in_space(&balancer, &state, imbalance), &direction);
        let (s, c) = imbalance.sin_cos();
        // The forces contain the acceleration of the ring's centre.
        let [e_x, e_y] = balancer.runout.unwrap_or_default();
        let square = balancer.speed * balancer.speed;
        let a_x = forces.table_acceleration[0] + square * e_x;
        let a_y = forces.table_acceleration[1] + square * e_y;
        let scale = 1e-11 * (1.0 + balancer.speed * balancer.speed);
        let close = |found: f64, expected: f64| {
            assert!((found - expected).abs() < scale, "{seed}: {found} {expected} {phases:?}");
        };
        close(solved.acceleration[0], c * a_x - s * a_y);
        close(solved.acceleration[1], s * a_x + c * a_y);
        // The rates are those of the turning frame.
        let (omega, [x, y]) = (balancer.speed, state.position);
        let [x_dot, y_dot] = state.velocity;
        let r_x = rates[2] - 2.0 * omega * y_dot - omega * omega * x;
        let r_y = rates[3] + 2.0 * omega * x_dot - omega * omega * y;
        close(solved.acceleration[0], c * r_x - s * r_y);
        close(solved.acceleration[1], s * r_x + c * r_y);
        for ball in 0..3 {
            // Light balls are ill-scaled beside a table 2000 times as heavy.
            close(solved.angular[ball], forces.beta_ddot[ball]);
            let slip = state.beta_dot[ball];
            // `r = 2 J d ω β̇ - 4 J β̇²` (thesis equation 3.5).
            let body = &balancer.balls[ball];
            let rolling = match machine.normal_force {
                NormalForce::Newton => 0.0,
                NormalForce::Lagrange => {
                    2.0 * body.inertia * (body.diameter * omega - 2.0 * slip) * slip
                }
            };
            close(solved.normal[ball] - rolling, forces.normal[ball]);
            close(solved.friction[ball], forces.friction[ball]);
            let of_ball = recorded[ball];
            close(solved.angular[ball], of_ball.acceleration);
            close(solved.normal[ball] - rolling, of_ball.normal);
            close(solved.friction[ball], of_ball.friction);
            assert_eq!(of_ball.speed, slip);
        }
    }
}

/// With all balls stuck, the table is the damped oscillator about the rest point, over long times.
#[test]
fn stuck_balls_follow_the_closed_form() {
    for seed in 0..40 {
        let mut sampler = Sampler::new(seed);
        let mut machine = sampler.machine(2);
        machine.damping_n_s_m = sampler.one_of(&[0.0, 0.1, 1.28]);
        machine.speed_rad_s = sampler.one_of(&[-160.8103, -216.3772, 309.15]);
        machine.balls.iter_mut().for_each(|ball| ball.friction_coefficient = 5.0);
        let balancer = Balancer::<2>::new(&machine).expect("two balls");
        let mut state = State { beta_dot: [0.0; 2], ..sampler.state(&balancer) };
        let rest = balancer.rest_point(&state.beta);
        // Near the rest point no ball is pulled loose or off the ring.
        for axis in 0..2 {
            state.position[axis] = rest.position[axis] + 0.2 * state.velocity[axis];
        }
        let kernels = for_each_kernel(balancer);
        let methods = [Method::Switch, Method::Event];
        for (method, system) in
            methods.iter().flat_map(|method| kernels.iter().map(move |system| (*method, system)))
        {
            let start = state.components();
            let Ok(mut motion) = Motion::new(system, settings(method, 1e-13), &start) else {
                continue;
            };
            go_on(&mut motion, 1000.0);
            assert_eq!(motion.effort().switches, 0);
            let expected = stuck_table(&balancer, &rest, &state, 1000.0);
            let closed = started(system, settings(method, 1e-13), &expected);
            let apart = difference(&motion, &closed);
            assert!(apart < 1e-9, "{seed}: {apart:e}");
        }
    }
}
