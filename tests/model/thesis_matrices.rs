//! The thesis's own form of the equations of motion, "extended Lagrange with constraints"
//! (its equations 3.13-3.16), for all nine stick/slip/transition configurations of two balls
//! (appendix C). It is the cross-check of the 2×2 form in `Balancer::forces`; it is far too slow to simulate with.
//!
//! Generalised coordinates `q = (x, y, β_1, β_2, l_1, l_2)`; `l_i`, the distance of ball `i` from
//! the ring's centre, is kept constant by a constraint whose multiplier is the normal force. A
//! sticking ball adds the constraint `β̇_i = 0`, whose multiplier is its friction force:
//!
//! ```text
//! M(q) q̈ + h(q, q̇) + S λ = Rᵀ λ        R q̈ = 0
//! λ = (R M⁻¹ (Rᵀ - S))⁻¹ R M⁻¹ h         q̈ = M⁻¹ ((Rᵀ - S) λ - h)
//! ```
//!
//! `M` is as printed; the scan has lost `h`, which is derived anew from the kinematics of
//! appendix B.1. The time-derivative of the spin that the rolling constraint gives each ball
//! enters through `4 J` and, for the thesis's normal force, the rolling term.

use nalgebra::{DMatrix, DVector};

use stickslip::model::{Balancer, Forces, State};

/// The configuration of one ball, as in the thesis's table 4.2. Slip and transition share their
/// equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Configuration {
    /// The ball rests on the ring; its friction force is a constraint force.
    Stick,
    /// The ball moves, or starts to move, against friction of this sign (1 or -1).
    Slip(f64),
}

/// Returns accelerations and forces of two balls by the thesis's matrices; `None` if a matrix is
/// singular.
pub fn extended_lagrange(
    balancer: &Balancer<2>,
    state: &State<2>,
    configurations: [Configuration; 2],
) -> Option<Forces<2>> {
    let omega = balancer.speed;
    let [x, y] = state.position;
    let [x_dot, y_dot] = state.velocity;
    let mut mass = DMatrix::<f64>::zeros(6, 6);
    let mut h = DVector::<f64>::zeros(6);
    mass[(0, 0)] = 1.0;
    mass[(1, 1)] = 1.0;
    let coriolis =
        [-2.0 * omega * y_dot - omega * omega * x, 2.0 * omega * x_dot - omega * omega * y];
    let drag = 2.0 * balancer.damping_ratio;
    h[0] = coriolis[0] + x + drag * (x_dot - omega * y) - balancer.imbalance * omega * omega;
    h[1] = coriolis[1] + y + drag * (y_dot + omega * x);
    for i in 0..2 {
        let ball = &balancer.balls[i];
        let (sine, cosine) = state.beta[i].sin_cos();
        let beta_dot = state.beta_dot[i];
        let (angle, length) = (2 + i, 4 + i);
        mass[(0, angle)] = -ball.mass * sine;
        mass[(1, angle)] = ball.mass * cosine;
        mass[(0, length)] = ball.mass * cosine;
        mass[(1, length)] = ball.mass * sine;
        mass[(angle, 0)] = -sine;
        mass[(angle, 1)] = cosine;
        mass[(angle, angle)] = 1.0 + 4.0 * ball.inertia;
        mass[(length, 0)] = cosine;
        mass[(length, 1)] = sine;
        mass[(length, length)] = 1.0;
        let w = omega + beta_dot;
        let rolling = ball.rolling_linear * beta_dot + ball.rolling_quadratic * beta_dot * beta_dot;
        h[0] -= ball.mass * cosine * w * w;
        h[1] -= ball.mass * sine * w * w;
        h[angle] = -sine * coriolis[0] + cosine * coriolis[1];
        h[length] = cosine * coriolis[0] + sine * coriolis[1] - w * w + rolling;
    }

    // Multipliers: the friction forces of sticking balls, then the two normal forces.
    let sticking: Vec<usize> =
        (0..2).filter(|&i| configurations[i] == Configuration::Stick).collect();
    let count = sticking.len() + 2;
    let mut r = DMatrix::<f64>::zeros(count, 6);
    let mut s = DMatrix::<f64>::zeros(6, count);
    for (row, &ball) in sticking.iter().enumerate() {
        r[(row, 2 + ball)] = -1.0;
    }
    for (ball, configuration) in configurations.iter().enumerate() {
        let row = sticking.len() + ball;
        r[(row, 4 + ball)] = -1.0;
        if let Configuration::Slip(sign) = configuration {
            s[(2 + ball, row)] = balancer.balls[ball].friction.coefficient * sign;
        }
    }

    let inverse = mass.try_inverse()?;
    let applied = r.transpose() - &s;
    let multipliers = (&r * &inverse * &applied).try_inverse()? * &r * &inverse * &h;
    let accelerations = inverse * (applied * &multipliers - h);
    let normal = [multipliers[count - 2], multipliers[count - 1]];
    let friction = std::array::from_fn(|i| match configurations[i] {
        Configuration::Stick => {
            sticking.iter().position(|&ball| ball == i).map_or(0.0, |row| multipliers[row])
        }
        Configuration::Slip(sign) => balancer.balls[i].friction.coefficient * sign * normal[i],
    });
    Some(Forces {
        table_acceleration: [accelerations[0] + coriolis[0], accelerations[1] + coriolis[1]],
        beta_ddot: [accelerations[2], accelerations[3]],
        normal,
        friction,
    })
}
