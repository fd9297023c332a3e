//! The linearised equations against finite differences of two implementations of the full ones: the
//! model's, and an independent Newton-Euler form with a mass matrix and viscous drag.

use nalgebra::{DMatrix, DVector};
use stickslip::analysis::{
    RestForm, SmallMotions, Stability, frictionless_equilibria, state_matrix,
};
use stickslip::model::{Balancer, Ball, Contact, Machine, State};

fn machine(balls: usize, speed_rad_s: f64) -> Machine {
    let ball = |i: usize| Ball { mass_kg: 1.0e-2 * (1.0 + i as f64), ..Ball::default() };
    // Heavy balls, so that their effect on the table is a large part of the matrix.
    Machine { speed_rad_s, balls: (0..balls).map(ball).collect(), ..Machine::default() }
}

/// Returns accelerations from positions (x, y, β...) and velocities: `M q̈ = ...` from the kinetic
/// energy of points in a turning frame and rolling balls.
fn full(form: &RestForm, imbalance: f64, drag: f64, state: &DVector<f64>) -> DVector<f64> {
    let n = state.len() / 2;
    let (w, zeta) = (form.speed, form.damping_ratio);
    let (position, velocity) = (state.rows(0, n), state.rows(n, n));
    let mut mass = DMatrix::identity(n, n);
    let mut force = DVector::zeros(n);
    // Coriolis and centrifugal terms of the whole mass at B; springs and dashpots fixed in space.
    let coriolis = |axis: usize| {
        let (other, sign) = if axis == 0 { (1, -1.0) } else { (0, 1.0) };
        sign * 2.0 * w * velocity[other] - w * w * position[axis]
    };
    for axis in 0..2 {
        let across = if axis == 0 { -position[1] } else { position[0] };
        let dashpot = 2.0 * zeta * (velocity[axis] + w * across);
        force[axis] = -coriolis(axis) - position[axis] - dashpot;
    }
    force[0] += imbalance * w * w;
    for ball in 0..n - 2 {
        let (m, i) = (form.mass[ball], 2 + ball);
        let (s, c) = position[i].sin_cos();
        let total = w + velocity[i];
        for (axis, tangent, radius, runout) in
            [(0, -s, c, form.runout.re), (1, c, s, form.runout.im)]
        {
            mass[(axis, i)] = m * tangent;
            mass[(i, axis)] = m * tangent;
            force[axis] += m * (radius * total * total + runout * w * w);
            force[i] -= m * tangent * (coriolis(axis) - runout * w * w);
        }
        mass[(i, i)] = m * form.inertia[ball];
        force[i] -= m * drag * velocity[i];
    }
    let acceleration = mass.lu().solve(&force).unwrap();
    let mut derivative = state.clone();
    derivative.rows_mut(0, n).copy_from(&velocity);
    derivative.rows_mut(n, n).copy_from(&acceleration);
    derivative
}

/// The model's derivative in the same order, without forces along the ring.
fn of_the_model<const N: usize>(machine: &Machine, state: &DVector<f64>) -> DVector<f64> {
    let balancer = Balancer::<N>::new(machine).unwrap();
    let n = 2 + N;
    let state = State::<N> {
        position: [state[0], state[1]],
        velocity: [state[n], state[n + 1]],
        beta: std::array::from_fn(|ball| state[2 + ball]),
        beta_dot: std::array::from_fn(|ball| state[n + 2 + ball]),
    };
    let contacts = [Contact { free: 1.0, signed_friction: 0.0, drag: 0.0 }; N];
    let forces = balancer.forces(&state, &contacts);
    let derivative = balancer.derivative(&state, &contacts, &forces);
    let (beta, beta_dot) = (derivative.beta.iter(), derivative.beta_dot.iter());
    let components = derivative.position.iter().chain(beta).chain(&derivative.velocity);
    DVector::from_iterator(2 * n, components.chain(beta_dot).copied())
}

fn slopes(derivative: impl Fn(&DVector<f64>) -> DVector<f64>, at: &DVector<f64>) -> DMatrix<f64> {
    let size = at.len();
    let mut slopes = DMatrix::zeros(size, size);
    for i in 0..size {
        let moved = |by: f64| {
            let mut moved = at.clone();
            moved[i] += by;
            derivative(&moved)
        };
        slopes.set_column(i, &((moved(1e-6) - moved(-1e-6)) / 2e-6));
    }
    slopes
}

fn check<const N: usize>(speed_rad_s: f64, ring_runout_m: f64) {
    let machine = Machine { ring_runout_m, ring_runout_angle_rad: 2.0, ..machine(N, speed_rad_s) };
    let form = RestForm::new(&machine).expect("balls");
    let imbalance = Balancer::<N>::new(&machine).expect("balls").imbalance;
    for equilibrium in frictionless_equilibria(&machine, 1.0).expect("balls") {
        let beta = equilibrium.beta_rad.expect("isolated, or an example of a family");
        let matrix = state_matrix(&form, &beta, 1.0).expect("a rest point");
        let eigenvalues = matrix.complex_eigenvalues();
        let fastest = eigenvalues.iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max);
        let found = equilibrium.eigenvalues_per_s[0].re / form.natural_frequency_rad_s;
        assert!((found - fastest).abs() < 1e-6, "{found} {fastest}");
        if fastest.abs() > 1e-6 {
            assert_eq!(fastest > 0.0, equilibrium.stability == Stability::Unstable, "{fastest}");
        }
        let z = form.ring_centre(&beta) - form.runout;
        let position = equilibrium.position_m.map(|metres| metres / machine.ring_radius_m);
        assert!((position[0] - z.re).hypot(position[1] - z.im) < 1e-12, "{position:?} {z}");
        let mut at = DVector::zeros(2 * (2 + N));
        (at[0], at[1]) = (z.re, z.im);
        at.rows_mut(2, N).copy_from_slice(&beta);
        for drag in [0.0, 0.7, 30.0] {
            assert!(full(&form, imbalance, drag, &at).norm() < 1e-12, "no equilibrium");
            let matrix = state_matrix(&form, &beta, drag).unwrap();
            let off = (&matrix - slopes(|state| full(&form, imbalance, drag, state), &at)).norm();
            assert!(off < 1e-7 * matrix.norm(), "{off} with {N} balls at {speed_rad_s}");
        }
        assert!(of_the_model::<N>(&machine, &at).norm() < 1e-12);
        let matrix = state_matrix(&form, &beta, 0.0).unwrap();
        let off = (&matrix - slopes(|state| of_the_model::<N>(&machine, state), &at)).norm();
        assert!(off < 1e-7 * matrix.norm(), "{off} with {N} balls at {speed_rad_s}");
    }
}

#[test]
fn matrices_are_the_slopes_of_the_full_equations() {
    for speed in [-120.0, -216.3772, 300.0] {
        check::<1>(speed, 0.0);
        check::<2>(speed, 0.0);
        check::<3>(speed, 0.0);
        check::<5>(speed, 0.0);
        check::<2>(speed, 3e-4);
        check::<3>(speed, 3e-4);
    }
}

/// With the balls held by an immense drag the table is the damped oscillator of the closed form,
/// with the eigenvalues -iω - ζ ± i sqrt(1 - ζ²) and their conjugates.
#[test]
fn with_immobile_balls_the_table_is_a_damped_oscillator() {
    let form = RestForm::new(&Machine::default()).unwrap();
    let motions = SmallMotions::about(&form, &[2.0, 4.0], 1e9, 0);
    let frequency = (1.0 - form.damping_ratio * form.damping_ratio).sqrt();
    for (turn, swing) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let imaginary = turn * form.speed + swing * frequency;
        let near = |value: &nalgebra::Complex<f64>| {
            (value.re + form.damping_ratio).abs() < 1e-5 && (value.im - imaginary).abs() < 1e-5
        };
        assert!(motions.eigenvalues.iter().any(near), "{imaginary} {:?}", motions.eigenvalues);
    }
}
