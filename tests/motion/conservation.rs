//! Energy balance in inertial space: the energy change equals the work of dampers, friction and
//! motor.
//!
//! `E` is the kinetic energy of table, imbalance and balls (with their spin) and the energy of the
//! springs. The motor maintains the disc's speed by a moment `τ`, the rate of angular momentum
//! about the ring's centre of all rotating bodies: imbalance and balls. Rolling resistance is a
//! moment `m f_w d/2` between ball and ring, whose relative angular speed is `2 β̇ / d`. In
//! non-dimensional form,
//!
//! ```text
//! dE/dt = -2ζ |v|² - Σ m f_w β̇ + ω τ
//! τ = m_I e (a_y + e α) + Σ m [ c a_y - s a_x + β̈ + α + J d (d α - 2 β̈) ]
//! ```
//!
//! with the acceleration `α` of the disc.
//! A ring with the runout `ε` has the acceleration `a - ω² ε` in the balls' terms, and `τ` gains the moment `Σ m ε × b` of
//! their accelerations `b`.

use std::sync::Arc;

use stickslip::model::{Balancer, Forces, FrictionLaw, Machine, Method, State, System};
use stickslip::motion::{Failure, Motion, Phase};

use super::samples::{GAUSS, Sampler, settings};
use crate::support::{for_each_kernel, reference, state_of};

pub(super) fn energy<const N: usize>(
    machine: &Machine,
    balancer: &Balancer<N>,
    state: &State<N>,
) -> f64 {
    let omega = balancer.speed;
    let ([x, y], [x_dot, y_dot]) = (state.position, state.velocity);
    let total = machine.total_mass_kg();
    let radius = machine.imbalance_radius_m / machine.ring_radius_m;
    let kinetic = |mass: f64, [p_x, p_y]: [f64; 2]| 0.5 * mass * (p_x * p_x + p_y * p_y);
    let centre = [x_dot - omega * y, y_dot + omega * x];
    let mut sum = 0.5 * (x * x + y * y) + kinetic(machine.table_mass_kg / total, centre);
    let imbalance = [centre[0], centre[1] + omega * radius];
    sum += kinetic(machine.imbalance_mass_kg / total, imbalance);
    let [e_x, e_y] = balancer.runout.unwrap_or_default();
    for (ball, (beta, beta_dot)) in
        balancer.balls.iter().zip(state.beta.into_iter().zip(state.beta_dot))
    {
        let (s, c) = beta.sin_cos();
        let round = omega + beta_dot;
        let ring = [centre[0] - omega * e_y, centre[1] + omega * e_x];
        sum += kinetic(ball.mass, [ring[0] - round * s, ring[1] + round * c]);
        let spin = ball.diameter * omega - 2.0 * beta_dot;
        sum += 0.5 * ball.inertia * ball.mass * spin * spin;
    }
    sum
}

/// Returns the power of dampers, friction and motor, also while the speed of the disc changes.
pub(super) fn powers<const N: usize>(
    machine: &Machine,
    balancer: &Balancer<N>,
    state: &State<N>,
    forces: &Forces<N>,
) -> [f64; 3] {
    let (omega, alpha) = (balancer.speed, balancer.acceleration.unwrap_or(0.0));
    let ([x, y], [x_dot, y_dot]) = (state.position, state.velocity);
    let [a_x, a_y] = forces.table_acceleration;
    let [e_x, e_y] = balancer.runout.unwrap_or_default();
    let (v_x, v_y) = (x_dot - omega * y, y_dot + omega * x);
    let (mut friction, mut moment) = (0.0, 0.0);
    for (i, ball) in balancer.balls.iter().enumerate() {
        let (s, c) = state.beta[i].sin_cos();
        let (d, rolls) = (ball.diameter, forces.beta_ddot[i]);
        friction -= ball.mass * forces.friction[i] * state.beta_dot[i];
        let spin = ball.inertia * d * (d * alpha - 2.0 * rolls);
        moment += ball.mass * (c * a_y - s * a_x + rolls + alpha + spin);
        // The rest of the moment about the disc's centre, of the ball's acceleration.
        let (round, along) = (omega + state.beta_dot[i], rolls + alpha);
        let b_x = a_x - along * s - round * round * c;
        let b_y = a_y + along * c - round * round * s;
        moment += ball.mass * (e_x * b_y - e_y * b_x);
    }
    let arm = machine.imbalance_radius_m / machine.ring_radius_m;
    // The forces contain the acceleration of the ring's centre.
    let table_a_y = a_y + omega * omega * e_y - alpha * e_x;
    moment += balancer.imbalance * (table_a_y + arm * alpha);
    [-2.0 * balancer.damping_ratio * (v_x * v_x + v_y * v_y), friction, omega * moment]
}

/// Returns the change of energy, and the work of dampers, friction and motor along a motion.
fn balance<const N: usize>(
    machine: &Machine,
    (balancer, system): (&Balancer<N>, &Arc<dyn System>),
    method: Method,
    start: State<N>,
) -> Result<(f64, [f64; 3]), Failure> {
    let settings = settings(method, 1e-11);
    let slowest = if method == Method::Switch { settings.band } else { 0.0 };
    let mut motion = Motion::new(system, settings, &start.components())?;
    let mut work = [0.0; 3];
    while motion.time() < 20.0 {
        let (time, state) = (motion.time(), state_of(&motion));
        let phases = motion.phases().to_vec();
        motion.advance(20_f64.min(time + 0.2))?;
        let length = motion.time() - time;
        let f = |state: &State<N>| reference::derivative(balancer, &phases, state);
        for (node, weight) in GAUSS {
            let inside = reference::step(f, &state, node * length);
            let forces = reference::forces(balancer, &phases, &inside);
            let powers = powers(machine, balancer, &inside, &forces);
            for (work, power) in work.iter_mut().zip(powers) {
                *work += weight * length * power;
            }
            // Friction never does positive work, and none in stick, ball by ball.
            for (ball, &phase) in phases.iter().enumerate() {
                let power = -forces.friction[ball] * inside.beta_dot[ball];
                let limit = balancer.balls[ball].friction.limit * forces.normal[ball];
                match phase {
                    // At the instant of setting off the speed is zero up to rounding; a stop is located where the
                    // speed is beyond zero by 5e-13.
                    Phase::Slip(_) => {
                        assert!(power <= 1e-18 + 5.01e-13 * limit, "{power:e} {phase:?}");
                    }
                    Phase::Stick => assert!(power.abs() <= 1.001 * slowest * limit, "{power:e}"),
                    // Friction opposes the acceleration while the speed changes its sign inside the
                    // band.
                    _ => assert!(power <= 1.001 * slowest * limit, "{power:e} {phase:?}"),
                }
            }
        }
    }
    let before = energy(machine, balancer, &start);
    Ok((energy(machine, balancer, &state_of(&motion)) - before, work))
}

#[test]
fn energy_changes_by_the_work() {
    let (mut balanced, mut rubbed) = (0, 0);
    for seed in 0..300 {
        let mut sampler = Sampler::new(seed);
        let mut machine = sampler.machine(3);
        if seed % 5 == 0 {
            machine.friction = FrictionLaw::coulomb_viscous(5e-4);
        }
        let balancer = Balancer::<3>::new(&machine).expect("three balls");
        let start = sampler.state(&balancer);
        let scale = energy(&machine, &balancer, &start).max(1e-6);
        let ways = [(Method::Event, 1e-9), (Method::Switch, 1e-7)];
        let kernels = for_each_kernel(balancer);
        let ways = ways.iter().flat_map(|way| kernels.iter().map(move |kernel| (*way, kernel)));
        for ((method, allowed), system) in ways {
            match balance(&machine, (&balancer, system), method, start) {
                Ok((change, [damping, friction, motor])) => {
                    let open = change - (damping + friction + motor);
                    assert!(open.abs() < allowed * scale, "{seed}: {method:?} {open:e} {scale:e}");
                    assert!(damping <= 0.0 && friction <= 1e-8 * scale);
                    balanced += 1;
                    // The balance would not close without any one of the three.
                    let each = [damping, friction, motor].map(|work| work.abs() > 1e3 * open.abs());
                    rubbed += i32::from(each == [true; 3]);
                }
                Err(Failure::ContactLost { .. }) => {}
                Err(failure) => panic!("{seed}: {failure}"),
            }
        }
    }
    assert!(balanced > 600 && rubbed > 200, "{balanced} {rubbed}");
}
