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
//!
//! A disc whose speed changes at the rate `α` adds Euler forces, on the table, on the imbalance and on the balls, which
//! roll against the turning ring:
//!
//! ```text
//! a_x + …  = … + Σ m s α        a_y + … = … - m_I e α - Σ m c α        (1 + 4J) β̈ = … - (1 - 2 J d) α
//! a_x = ẍ - 2ω ẏ - ω² x - α y        a_y = ÿ + 2ω ẋ - ω² y + α x
//! ```
//!
//! A ring whose centre is at `(ε_x, ε_y)` in the disc (runout) has the acceleration `a - S`, `S_x = ω² ε_x + α ε_y` and
//! `S_y = ω² ε_y - α ε_x`, which takes the place of `a` in the equations of the balls, and the forces of the balls on the
//! table gain `Σ m S`. With `a - S` as the unknowns, the equations above have the further force `-(1 - Σ m) S`.

use super::{Balancer, BalancerBall, Contact, Number, State};

/// Accelerations and contact forces in one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces<const N: usize, T = f64> {
    /// Absolute acceleration `(a_x, a_y)` of the ring's centre, resolved in the turning frame: that of the table, if the ring
    /// has no runout.
    pub table_acceleration: [T; 2],
    /// Angular acceleration `β̈` of each ball relative to the ring.
    pub beta_ddot: [T; N],
    /// Normal force on each contact, compression positive.
    pub normal: [T; N],
    /// Friction force on each contact, acting against positive `β̇`; in stick, the force required
    /// to stick.
    pub friction: [T; N],
}

/// A ball's part in the equations of motion.
#[derive(Clone, Copy)]
pub(super) struct BallTerms<T> {
    pub(super) sine: T,
    pub(super) cosine: T,
    /// `w² - r`.
    pub(super) pressed: T,
    /// `m β̈ = along · a - held` where it slips.
    pub(super) along: [T; 2],
    pub(super) held: T,
    /// `m w²`.
    pub(super) outward: T,
    /// `m α`; `None` at constant speed.
    pub(super) euler: Option<T>,
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
        let (one, zero) = (T::constant(1.0), T::constant(0.0));
        let terms = self.ball_terms(state, contacts, turned);
        // Sums over the balls are separate from the table's own terms, so that exchanging two balls exchanges the results bit
        // for bit.
        let (mut m_xx, mut m_xy, mut m_yx, mut m_yy) = (zero, zero, zero, zero);
        let (mut balls_x, mut balls_y) = (zero, zero);
        for term in &terms {
            let BallTerms { sine: s, cosine: c, along: [along_x, along_y], outward, .. } = *term;
            let held = term.euler.map_or(term.held, |euler| term.held - euler);
            m_xx = m_xx + s * along_x;
            m_xy = m_xy + s * along_y;
            m_yx = m_yx + c * along_x;
            m_yy = m_yy + c * along_y;
            balls_x = balls_x + (c * outward - s * held);
            balls_y = balls_y + (s * outward + c * held);
        }
        // `(1 - m_xx) a_x - m_xy a_y = x` and `m_yx a_x + (1 + m_yy) a_y = y`.
        let [x, y] = self.force_on_table(state, [balls_x, balls_y]);
        let [[a, b], [c, d]] = [[one - m_xx, -m_xy], [m_yx, one + m_yy]];
        let inverse = (a * d - b * c).reciprocal();
        let [a_x, a_y] = [(d * x - b * y) * inverse, (a * y - c * x) * inverse];
        let mut forces = Forces {
            table_acceleration: [a_x, a_y],
            beta_ddot: [zero; N],
            normal: [zero; N],
            friction: [zero; N],
        };
        for (i, term) in terms.iter().enumerate() {
            let Contact { free, signed_friction, drag } = contacts[i];
            let BallTerms { sine, cosine, pressed, .. } = *term;
            let mut tangential = sine * a_x - cosine * a_y;
            let normal = pressed - (cosine * a_x + sine * a_y);
            if let Some(euler) = self.euler_force(i) {
                tangential = tangential - euler;
            }
            let slipping = signed_friction * normal + drag;
            forces.beta_ddot[i] = free * self.balls[i].mobility * (tangential - slipping);
            forces.normal[i] = normal;
            forces.friction[i] = free * slipping + (one - free) * tangential;
        }
        forces
    }

    /// Returns each ball's part in the equations of motion.
    #[inline]
    pub(super) fn ball_terms(
        &self,
        state: &State<N, T>,
        contacts: &[Contact<T>; N],
        turned: &[(T, T); N],
    ) -> [BallTerms<T>; N] {
        std::array::from_fn(|i| {
            let ball = &self.balls[i];
            let Contact { free, signed_friction, drag } = contacts[i];
            let (sine, cosine) = turned[i];
            let beta_dot = state.beta_dot[i];
            let w = self.speed + beta_dot;
            let w_squared = w * w;
            let rolling = (ball.rolling_linear + ball.rolling_quadratic * beta_dot) * beta_dot;
            let pressed = w_squared - rolling;
            let mobile = ball.mass * ball.mobility * free;
            let held = signed_friction * pressed + drag;
            let held = self.euler_force(i).map_or(held, |euler| held + euler);
            BallTerms {
                sine,
                cosine,
                pressed,
                along: [
                    mobile * (sine + signed_friction * cosine),
                    mobile * (signed_friction * sine - cosine),
                ],
                held: mobile * held,
                outward: ball.mass * w_squared,
                euler: self.acceleration.map(|acceleration| ball.mass * acceleration),
            }
        })
    }

    /// Returns the Euler force on a ball against positive `β`, over its mass: `(1 - 2 J d) α`.
    #[inline]
    pub(super) fn euler_force(&self, ball: usize) -> Option<T> {
        self.acceleration.map(|acceleration| {
            let BalancerBall { inertia, diameter, .. } = self.balls[ball];
            (T::constant(1.0) - T::constant(2.0) * inertia * diameter) * acceleration
        })
    }

    /// Returns how much more the table accelerates than the ring's centre, whose distance from the disc's centre turns with
    /// the disc: `S`.
    #[inline]
    fn runout_acceleration(&self) -> Option<[T; 2]> {
        let [e_x, e_y] = self.runout?;
        let centripetal = self.speed * self.speed;
        let [s_x, s_y] = [centripetal * e_x, centripetal * e_y];
        Some(match self.acceleration {
            None => [s_x, s_y],
            Some(acceleration) => [s_x + acceleration * e_y, s_y - acceleration * e_x],
        })
    }

    /// Returns the force on the table, with that of the balls.
    #[inline]
    pub(super) fn force_on_table(&self, state: &State<N, T>, balls: [T; 2]) -> [T; 2] {
        let [x, y] = state.position;
        let [x_dot, y_dot] = state.velocity;
        let omega = self.speed;
        let drag = T::constant(2.0) * self.damping_ratio;
        let [balls_x, balls_y] = balls;
        let force_x = balls_x + (self.imbalance * omega * omega - x - drag * (x_dot - omega * y));
        let force_y = balls_y - y - drag * (y_dot + omega * x);
        let euler = self.acceleration.map(|acceleration| self.imbalance * acceleration);
        let force_y = euler.map_or(force_y, |euler| force_y - euler);
        match self.runout_acceleration() {
            None => [force_x, force_y],
            Some([s_x, s_y]) => {
                let zero = T::constant(0.0);
                let balls = self.balls.iter().fold(zero, |sum, ball| sum + ball.mass);
                let table = T::constant(1.0) - balls;
                [force_x - table * s_x, force_y - table * s_y]
            }
        }
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
        if let Some(acceleration) = self.acceleration {
            let [x_ddot, y_ddot] = derivative.velocity;
            derivative.velocity = [x_ddot + acceleration * y, y_ddot - acceleration * x];
        }
        if let Some([s_x, s_y]) = self.runout_acceleration() {
            let [x_ddot, y_ddot] = derivative.velocity;
            derivative.velocity = [x_ddot + s_x, y_ddot + s_y];
        }
        for (i, contact) in contacts.iter().enumerate() {
            let stuck = one - contact.free;
            derivative.beta[i] = contact.free * state.beta_dot[i];
            derivative.beta_dot[i] = forces.beta_ddot[i] - stuck * state.beta_dot[i];
        }
        derivative
    }
}
