//! Smooth phases: order of the method and of its dense output, and a conserved quantity.

use stickslip::model::{Balancer, Machine, Method, State};
use stickslip::motion::{Motion, Settings, Step, Tolerance};

fn settings(relative: f64) -> Settings {
    let tolerance = Tolerance { relative, absolute: 1e-2 * relative };
    Settings { method: Method::Switch, band: 1e-4, tolerance, effort_limit: 10_000_000 }
}

/// Without friction and damping the Jacobi integral of the system with prescribed rotation, `h =
/// T_2 - T_0 + V`, is constant. It is computed from positions and velocities in inertial space, not
/// from the equations of motion.
fn jacobi_integral(machine: &Machine, balancer: &Balancer<2>, state: &State<2>) -> f64 {
    let omega = balancer.speed;
    let [x, y] = state.position;
    let [x_dot, y_dot] = state.velocity;
    let e = machine.imbalance_radius_m / machine.ring_radius_m;
    let m_i = machine.imbalance_mass_kg / machine.total_mass_kg();
    let m_t = machine.table_mass_kg / machine.total_mass_kg();
    let at_rest = |px: f64, py: f64| 0.5 * omega * omega * (px * px + py * py);
    let mut h = 0.5 * (x_dot * x_dot + y_dot * y_dot) + 0.5 * (x * x + y * y)
        - m_t * at_rest(x, y)
        - m_i * at_rest(x + e, y);
    for (ball, (beta, beta_dot)) in
        balancer.balls.iter().zip(state.beta.into_iter().zip(state.beta_dot))
    {
        let (s, c) = beta.sin_cos();
        // Rolling: the spin relative to the frame is -2 β̇ / d, its energy 2 J m β̇².
        h += ball.mass
            * (beta_dot * (c * y_dot - s * x_dot)
                + 0.5 * (1.0 + 4.0 * ball.inertia) * beta_dot * beta_dot
                - at_rest(x + c, y + s));
    }
    h
}

#[test]
fn jacobi_integral_is_constant_without_friction() {
    let mut machine = Machine { damping_n_s_m: 0.0, ..Machine::default() };
    for ball in &mut machine.balls {
        ball.friction_coefficient = 0.0;
        ball.mass_kg *= 30.0; // so that the effect of the balls is large
    }
    let balancer = Balancer::<2>::new(&machine).expect("two balls");
    let start = State {
        position: [0.03, -0.02],
        velocity: [0.01, 0.04],
        beta: [1.0, 4.0],
        beta_dot: [0.5, -0.7],
    };
    let before = jacobi_integral(&machine, &balancer, &start);
    let mut motion = Motion::new(&balancer, settings(1e-11), start).expect("starts");
    while motion.time() < 300.0 {
        motion.advance(300.0).expect("continues");
    }
    let after = jacobi_integral(&machine, &balancer, motion.state());
    let moved = motion.unwrapped_angle(0) - 1.0;
    assert!(moved.abs() > 1.0, "a motion worth the name: {moved}");
    assert!((after - before).abs() < 1e-9 * before.abs(), "{before} {after}");
}

/// Returns the error of the state after one unit of time in `count` equal steps, against very many
/// steps, and of the dense output in the middle of the first step.
fn errors(count: u32) -> (f64, f64) {
    let balancer = Balancer::<2>::new(&Machine::default()).expect("two balls");
    let start = State {
        position: [0.03, -0.02],
        velocity: [0.01, 0.04],
        beta: [1.0, 4.0],
        beta_dot: [0.9, 0.8],
    };
    let phases = [stickslip::motion::Phase::Slip(1.0); 2];
    let contacts = stickslip::motion::contacts(&balancer, &phases, &start);
    let f = |state: &State<2>| {
        balancer.derivative(state, &contacts, &balancer.forces(state, &contacts))
    };
    let integrate = |time: f64, count: u32| {
        let mut state = start;
        for _ in 0..count {
            state = Step::attempt(f, &state, &f(&state), time / f64::from(count)).end;
        }
        state
    };
    let distance = |a: &State<2>, b: &State<2>| {
        let flat = |s: &State<2>| [s.position, s.velocity, s.beta, s.beta_dot].concat();
        flat(a).iter().zip(flat(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let time = 8.0;
    let length = time / f64::from(count);
    let exact = integrate(time, 400);
    let first = Step::attempt(f, &start, &f(&start), length);
    let middle = first.interpolant(f, &f(&first.end)).at(0.5);
    let exact_middle = integrate(0.5 * length, 100);
    (distance(&integrate(time, count), &exact), distance(&middle, &exact_middle))
}

#[test]
fn order_eight_and_dense_output_of_order_seven() {
    let (coarse, coarse_middle) = errors(8);
    let (fine, fine_middle) = errors(16);
    let order = (coarse / fine).log2();
    let middle_order = (coarse_middle / fine_middle).log2();
    assert!((7.3..9.5).contains(&order), "order {order}, errors {coarse:e} {fine:e}");
    // The local error of an interpolant of order 7 decreases as the eighth power of the step.
    assert!((7.0..9.5).contains(&middle_order), "order {middle_order}");
    assert!(fine < 1e-7, "{fine:e}");
}
