//! Energy balance of balls in lasting contact, with friction on the ring and between the balls.
//!
//! In the turning frame the disc does no work, and the energy `H` is that of the relative speeds and of the potential of
//! springs and centrifugal forces. The dampers, friction on the ring and friction between balls take energy from it:
//!
//! ```text
//! H = ½ |ż|² + Σ m [ (c ẏ - s ẋ) β̇ + ½ (1 + 4J) β̇² ] + ½ (1 - ω²) |z|² - ω² [ m_I e x + Σ m (x c + y s) ]
//! dH/dt = -2ζ ż · (ż + ω e_z × z) - Σ m f_w β̇ - Σ_gaps κ |q| |β̇_i + β̇_j|,   |q| = μ_b λ
//! ```

use stickslip::model::{Balancer, Ball, BallContact, Machine, Method, Model, Start};
use stickslip::motion::{Motion, Phase, Settings, Tolerance};

use super::samples::GAUSS;
use crate::support::settings;

/// Parts of a step over which Gauss's rule is applied.
const PARTS: usize = 4;
fn energy<const N: usize>(balancer: &Balancer<N>, state: &[f64]) -> f64 {
    let (x, y, x_dot, y_dot) = (state[0], state[1], state[2], state[3]);
    let square = balancer.speed * balancer.speed;
    let mut sum = 0.5 * (x_dot * x_dot + y_dot * y_dot) + 0.5 * (1.0 - square) * (x * x + y * y)
        - square * balancer.imbalance * x;
    for (i, ball) in balancer.balls.iter().enumerate() {
        let ((s, c), speed) = (state[4 + i].sin_cos(), state[4 + N + i]);
        let kinetic = (c * y_dot - s * x_dot) * speed + 0.5 * speed * speed / ball.mobility;
        sum += ball.mass * (kinetic - square * (x * c + y * s));
    }
    sum
}

/// Returns the power of the dampers, of the friction on the ring, and of the friction between balls.
fn powers<const N: usize>(
    balancer: &Balancer<N>,
    motion: &Motion,
    phases: &[Phase],
    state: &[f64],
) -> [f64; 3] {
    let (x, y, x_dot, y_dot) = (state[0], state[1], state[2], state[3]);
    let omega = balancer.speed;
    let against = x_dot * (x_dot - omega * y) + y_dot * (y_dot + omega * x);
    let (forces, gaps) = motion.evaluator().incremental_forces(state).forces_and_gaps(phases);
    let speed = |ball: usize| state[4 + N + ball];
    let ring = balancer.balls.iter().zip(&forces).enumerate();
    let ring: f64 = ring.map(|(i, (ball, forces))| ball.mass * forces.friction * speed(i)).sum();
    let touching = motion.evaluator().system().touching().expect("gaps");
    let between = touching.gaps().iter().zip(&gaps).map(|(gap, force)| {
        let [behind, ahead] = gap.contacts;
        gap.lever * gap.friction_coefficient * force.force * (speed(behind) + speed(ahead)).abs()
    });
    [-2.0 * balancer.damping_ratio * against, -ring, -between.sum::<f64>()]
}

/// Follows a motion and asserts the balance between impacts. Returns the work of the three powers while balls touch.
fn follow<const N: usize>(machine: &Machine, start: &Start, end: f64) -> [f64; 3] {
    let balancer = Balancer::<N>::new(machine).expect("balls");
    let model = Model::from(machine.clone());
    let system = model.system_for(start).expect("a system");
    let tolerance = Tolerance { relative: 1e-12, absolute: 1e-15 };
    let settings = Settings { tolerance, ..settings(Method::Event, 1e-12) };
    let mut motion = Motion::new(&system, settings, &model.start_state(start).expect("a state"))
        .expect("starts");
    let (mut work, mut in_touch) = (0.0, [0.0; 3]);
    let (mut reference, mut largest) = (energy(&balancer, &motion.state()), 0.0_f64);
    while motion.time() < end {
        let begun = motion.time();
        motion.advance(end).expect("continues");
        let phases = motion.phases_during_step().to_vec();
        let length = (motion.time() - begun) / PARTS as f64;
        for part in 0..PARTS {
            for (node, weight) in GAUSS {
                let time = begun + (part as f64 + node) * length;
                let Some(state) = motion.within_last_step(time) else { continue };
                let powers = powers(&balancer, &motion, &phases, &state);
                work += weight * length * powers.iter().sum::<f64>();
                if phases.contains(&Phase::Closed) {
                    for (sum, power) in in_touch.iter_mut().zip(powers) {
                        *sum += weight * length * power;
                    }
                }
            }
        }
        let before = motion.before_switch().map(|instant| instant.state);
        let reached = energy(&balancer, before.as_ref().unwrap_or(&motion.state()));
        let off = reached - reference - work;
        largest = largest.max(off.abs());
        let now = energy(&balancer, &motion.state());
        // Impacts take energy, and what a ball that stops has left to rounding.
        assert!(now <= reached + 1e-12, "{now} {reached}");
        reference += now - reached;
    }
    assert!(largest < 1e-9, "{largest:e}");
    in_touch
}

#[test]
fn work_accounts_for_the_energy_of_balls_in_contact() {
    let heavy = |mass: f64, diameter_m: f64| Ball {
        mass_kg: 1.4e-4 * mass,
        diameter_m,
        friction_coefficient: 2.75e-3,
        ..Ball::default()
    };
    let machine = |speed_rad_s: f64, balls: Vec<Ball>, friction_coefficient: f64| Machine {
        speed_rad_s,
        balls,
        contact: Some(BallContact { restitution: 0.4, friction_coefficient }),
        ..Machine::default()
    };
    let two = vec![heavy(20.0, 3e-3), heavy(10.0, 2e-3)];
    let three = vec![heavy(8.0, 3e-3), heavy(10.0, 2.5e-3), heavy(12.0, 3e-3)];
    for (speed, friction) in [(-216.3772, 0.1), (-247.3, 0.0), (-173.1803, 0.2)] {
        let start = |beta: &[f64], beta_dot: &[f64]| {
            Start::of_balancer([0.01, 0.02], beta, [0.0; 2], beta_dot)
        };
        let [two, three] = [&two, &three].map(|balls| machine(speed, balls.clone(), friction));
        for [dampers, ring, between] in [
            follow::<2>(&two, &start(&[1.0, 1.35], &[0.5, 0.3]), 300.0),
            follow::<3>(&three, &start(&[1.0, 1.4, 2.0], &[0.5, 0.3, -0.4]), 300.0),
        ] {
            assert!(dampers.abs() > 1e-6 && ring < -1e-6, "{dampers:e} {ring:e}");
            assert!(if friction == 0.0 { between == 0.0 } else { between < -1e-6 }, "{between:e}");
        }
    }
}
