//! The equations of motion, for any stick/slip configuration, by a 2×2 linear system.
//!
//! The thesis writes them as a 6×6 "extended Lagrange" system with one variant for each of nine
//! configurations (its equations 3.13-3.16 and appendix C; `tests/model/thesis_matrices.rs` compares both forms).
//! Solved for each ball first, they leave two unknowns, the absolute acceleration
//! `(a_x, a_y)` of the ring's centre, for any number of balls:
//!
//! ```text
//! a_x + x + 2ζ(ẋ - ω y) = m_I e ω² + Σ m (  s β̈ + c w² )        s = sin β, c = cos β
//! a_y + y + 2ζ(ẏ + ω x) =            Σ m ( -c β̈ + s w² )        w = ω + β̇
//! (1 + 4J) β̈ = s a_x - c a_y - f_w
//! f_n = w² - c a_x - s a_y - r        r = 2 J d ω β̇ - 4 J β̇²  (or 0: Newton)
//! ```
//!
//! with `f_w = p f_n + q` in slip, for Coulomb friction `p = μ sign(β̇)` and `q = 0`, and `β̈ = 0` in
//! stick. Forces are over `m ω_n² L`.

use super::{Balancer, Contact, Number, State};

/// Accelerations and contact forces in one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces<const N: usize, T = f64, const FREE: usize = 2> {
    /// Absolute acceleration `(a_x, a_y)` of the ring's centre, resolved in the turning frame.
    pub table_acceleration: [T; FREE],
    /// Angular acceleration `β̈` of each ball relative to the ring; acceleration of a block.
    pub beta_ddot: [T; N],
    /// Normal force on each contact, compression positive.
    pub normal: [T; N],
    /// Friction force on each contact, acting against positive `β̇`; in stick, the force required
    /// to stick.
    pub friction: [T; N],
}

impl<const N: usize, T: Number> Balancer<N, T> {
    /// Returns accelerations and forces for given contacts. The residual speed of a sticking ball
    /// in the switch model enters like any other speed, so that the conditions for stick and for
    /// slip coincide exactly at a switch.
    #[inline]
    pub fn forces(&self, state: &State<N, T>, contacts: &[Contact<T>; N]) -> Forces<N, T> {
        self.forces_turned(state, contacts, &state.beta.map(T::sin_cos))
    }

    /// Computes accelerations and forces like [`Balancer::forces`], from a known sine and cosine of
    /// each ball's angle.
    #[inline]
    pub fn forces_turned(
        &self,
        state: &State<N, T>,
        contacts: &[Contact<T>; N],
        turned: &[(T, T); N],
    ) -> Forces<N, T> {
        let zero = T::constant(0.0);
        let one = T::constant(1.0);
        let two = T::constant(2.0);
        let [x, y] = state.position;
        let [x_dot, y_dot] = state.velocity;
        let omega = self.speed;

        // Sums over the balls are separate from the table's own terms, so that exchanging two balls
        // exchanges the results bit for bit.
        let (mut m_xx, mut m_xy, mut m_yx, mut m_yy) = (zero, zero, zero, zero);
        let (mut balls_x, mut balls_y) = (zero, zero);
        let mut sine = [zero; N];
        let mut cosine = [zero; N];
        let mut centrifugal = [zero; N]; // w² - r
        for i in 0..N {
            let ball = &self.balls[i];
            let Contact { free, signed_friction, drag } = contacts[i];
            let (s, c) = turned[i];
            let beta_dot = state.beta_dot[i];
            let w = omega + beta_dot;
            let w_squared = w * w;
            let rolling = (ball.rolling_linear + ball.rolling_quadratic * beta_dot) * beta_dot;
            let pressed = w_squared - rolling;
            let mobile = ball.mass * ball.mobility * free;
            let along_x = mobile * (s + signed_friction * c);
            let along_y = mobile * (signed_friction * s - c);
            let held = mobile * (signed_friction * pressed + drag);
            m_xx = m_xx + s * along_x;
            m_xy = m_xy + s * along_y;
            m_yx = m_yx + c * along_x;
            m_yy = m_yy + c * along_y;
            let outward = ball.mass * w_squared;
            balls_x = balls_x + (c * outward - s * held);
            balls_y = balls_y + (s * outward + c * held);
            sine[i] = s;
            cosine[i] = c;
            centrifugal[i] = pressed;
        }
        let drag = two * self.damping_ratio;
        let force_x = balls_x + (self.imbalance * omega * omega - x - drag * (x_dot - omega * y));
        let force_y = balls_y - y - drag * (y_dot + omega * x);
        let matrix = [[one - m_xx, -m_xy], [m_yx, one + m_yy]];
        let [a_x, a_y] = T::solve_two(matrix, [force_x, force_y]);

        let mut forces = Forces {
            table_acceleration: [a_x, a_y],
            beta_ddot: [zero; N],
            normal: [zero; N],
            friction: [zero; N],
        };
        for i in 0..N {
            let Contact { free, signed_friction, drag } = contacts[i];
            let tangential = sine[i] * a_x - cosine[i] * a_y;
            let normal = centrifugal[i] - (cosine[i] * a_x + sine[i] * a_y);
            let slipping = signed_friction * normal + drag;
            forces.beta_ddot[i] = free * self.balls[i].mobility * (tangential - slipping);
            forces.normal[i] = normal;
            forces.friction[i] = free * slipping + (one - free) * tangential;
        }
        forces
    }

    /// Returns the time derivative of the state. A sticking ball keeps its angle, and its residual
    /// speed decays (switch model, thesis section 4.2: `β' = 0`, `(β̇)' = -β̇`).
    #[inline]
    pub fn derivative(
        &self,
        state: &State<N, T>,
        contacts: &[Contact<T>; N],
        forces: &Forces<N, T>,
    ) -> State<N, T> {
        let one = T::constant(1.0);
        let two = T::constant(2.0);
        let omega = self.speed;
        let [x, y] = state.position;
        let [x_dot, y_dot] = state.velocity;
        let [a_x, a_y] = forces.table_acceleration;
        let mut derivative = State {
            position: state.velocity,
            velocity: [
                a_x + two * omega * y_dot + omega * omega * x,
                a_y - two * omega * x_dot + omega * omega * y,
            ],
            beta: state.beta_dot,
            beta_dot: forces.beta_ddot,
        };
        for (i, contact) in contacts.iter().enumerate() {
            let stuck = one - contact.free;
            derivative.beta[i] = contact.free * state.beta_dot[i];
            derivative.beta_dot[i] = forces.beta_ddot[i] - stuck * state.beta_dot[i];
        }
        derivative
    }
}
