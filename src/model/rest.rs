//! Closed forms for balls at rest: rest point of the table, forces there, the equilibrium set.
//!
//! With all balls stuck the table is a damped linear oscillator seen from inertial space, with
//! eigenvalues `-iω - ζ ± i sqrt(1 - ζ²)`. Its rest point follows from the balls' positions
//! (thesis equations 5.3 and 5.4), and the equilibrium set from the friction that resting there
//! takes (its equation 5.5).

use super::{Balancer, State};

/// The table at rest in the turning frame, with the balls held where they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestPoint<const N: usize> {
    /// The centre of the disc `(x_0, y_0)`, non-dimensional.
    pub position: [f64; 2],
    /// Normal force on each ball.
    pub normal: [f64; N],
    /// Friction force that holds each ball.
    pub friction: [f64; N],
}

impl<const N: usize> Balancer<N> {
    /// Where the table rests when the balls stay at `beta` (thesis equations 5.3, 5.4):
    /// `z_0 = ω² F / (1 - ω² + 2iζω)` with `F = m_I e + Σ m e^{iβ}`. With a runout `ε` of the ring, `F` gains `Σ m ε`, and
    /// the ring's centre is at `z_0 + ε`.
    pub fn rest_point(&self, beta: &[f64; N]) -> RestPoint<N> {
        let omega = self.speed;
        let trigonometry = beta.map(libm::sincos);
        let (mut force_x, mut force_y) = (0.0, 0.0);
        for (ball, (s, c)) in self.balls.iter().zip(&trigonometry) {
            force_x += ball.mass * c;
            force_y += ball.mass * s;
        }
        force_x += self.imbalance;
        let [e_x, e_y] = self.runout.unwrap_or_default();
        if self.runout.is_some() {
            let balls: f64 = self.balls.iter().map(|ball| ball.mass).sum();
            force_x += balls * e_x;
            force_y += balls * e_y;
        }
        let real = 1.0 - omega * omega;
        let imaginary = 2.0 * self.damping_ratio * omega;
        let scale = omega * omega / (real * real + imaginary * imaginary);
        let x = scale * (real * force_x + imaginary * force_y);
        let y = scale * (real * force_y - imaginary * force_x);
        let [ring_x, ring_y] = [x + e_x, y + e_y];
        let normal = trigonometry.map(|(s, c)| omega * omega * (1.0 + c * ring_x + s * ring_y));
        let friction = trigonometry.map(|(s, c)| -omega * omega * (s * ring_x - c * ring_y));
        RestPoint { position: [x, y], normal, friction }
    }

    /// Amplitude of the table's vibration with balls at rest at `beta`, over `L`.
    pub fn rest_amplitude(&self, beta: &[f64; N]) -> f64 {
        let [x, y] = self.rest_point(beta).position;
        x.hypot(y)
    }

    /// Returns the largest ratio of required friction to friction limit, over all balls, if the
    /// table's acceleration may differ from that at the rest point by up to `disturbance`:
    /// `(|f_w| + a) / (μ (f_n - a))`. At most 1 means that no ball can break loose.
    pub fn friction_use(&self, rest: &RestPoint<N>, disturbance: f64) -> f64 {
        let used = |i: usize| {
            let limit = self.balls[i].friction.limit * (rest.normal[i] - disturbance);
            let needed = rest.friction[i].abs() + disturbance;
            if limit > 0.0 {
                needed / limit
            } else if needed == 0.0 {
                0.0
            } else {
                f64::INFINITY
            }
        };
        (0..N).map(used).fold(0.0, f64::max)
    }

    /// Distance of the table from its rest point in phase space, for balls at rest:
    /// `R = sqrt(|u|² + |v|²)`, `u = z - z_0`, `v = u̇ + iωu`. `R²/2` is the energy of a damped
    /// oscillator in inertial space, so `R` never grows.
    pub fn distance_from_rest(&self, state: &State<N>, rest: &RestPoint<N>) -> f64 {
        let u = [state.position[0] - rest.position[0], state.position[1] - rest.position[1]];
        let v = [state.velocity[0] - self.speed * u[1], state.velocity[1] + self.speed * u[0]];
        (u[0] * u[0] + u[1] * u[1] + (v[0] * v[0] + v[1] * v[1])).sqrt()
    }

    /// Returns bounds on the effect of the residual speeds of sticking balls in the switch model,
    /// which decay as `e^{-t}`: on each ball's normal force, and on the table's distance from rest.
    pub fn residual_disturbance(&self, state: &State<N>) -> (f64, f64) {
        let (mut normal, mut push) = (0.0_f64, 0.0);
        for (ball, speed) in self.balls.iter().zip(state.beta_dot.map(f64::abs)) {
            let centrifugal = (2.0 * self.speed.abs() + speed) * speed;
            let rolling = ball.rolling_linear.abs() + ball.rolling_quadratic.abs() * speed;
            normal = normal.max(centrifugal + rolling * speed);
            push += ball.mass * centrifugal;
        }
        (normal, push)
    }

    /// Returns a bound for all later times on the difference of the table's acceleration from that
    /// at the rest point, from the distance `R`: `|a_u| ≤ |u| + 2ζ|v| ≤ sqrt(1 + 4ζ²) R`.
    pub fn acceleration_bound(&self, distance: f64) -> f64 {
        distance * (1.0 + 4.0 * self.damping_ratio * self.damping_ratio).sqrt()
    }
}
