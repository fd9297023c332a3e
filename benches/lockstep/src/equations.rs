//! The equations of motion of a balancer with two balls, for eight runs at once.
//!
//! The same as `model::equations` (the 2×2 system), for Coulomb friction in the exact motion: a ball
//! that sticks has speed zero. What does not change within a smooth phase is computed once.

use fearless_simd::{Simd, f64x8, prelude::*};

use crate::sincos::sin_cos;

/// Components of a state, in this order: x, y, ẋ, ẏ, β1, β2, β̇1, β̇2.
pub const N: usize = 8;
pub type Vector<S> = [f64x8<S>; N];

/// What a ball's equation needs. In each lane another run, so all are vectors.
#[derive(Clone, Copy)]
pub struct Ball<S: Simd> {
    /// m
    pub mass: f64x8<S>,
    /// 1 / (1 + 4 J) where it may accelerate, 0 where it sticks.
    pub mobility: f64x8<S>,
    /// m times that.
    pub mobile_mass: f64x8<S>,
    /// p = ±μ, 0 where it sticks.
    pub friction: f64x8<S>,
    /// -2 J d ω and 4 J (or 0): the rolling term, subtracted.
    pub rolling_linear: f64x8<S>,
    pub rolling_quadratic: f64x8<S>,
}

/// One smooth phase of eight runs.
#[derive(Clone, Copy)]
pub struct Phase<S: Simd> {
    pub omega: f64x8<S>,
    pub two_omega: f64x8<S>,
    pub omega_squared: f64x8<S>,
    /// 2ζ
    pub drag: f64x8<S>,
    /// 2ζω
    pub drag_omega: f64x8<S>,
    /// m_I e ω²
    pub imbalance: f64x8<S>,
    pub balls: [Ball<S>; 2],
}

/// Forces on the balls beside the derivative, for the conditions of stick and slip.
#[derive(Clone, Copy)]
pub struct Contact<S: Simd> {
    pub sine: f64x8<S>,
    pub cosine: f64x8<S>,
    /// Normal force.
    pub normal: f64x8<S>,
    /// What sticking takes: s a_x - c a_y.
    pub tangential: f64x8<S>,
}

impl<S: Simd> Phase<S> {
    /// Derivative with (cos β, sin β) carried along as state in place of β (for comparison).
    #[inline]
    pub fn carried(&self, state: &[f64x8<S>; 10], derivative: &mut [f64x8<S>; 10]) {
        self.omega.simd.vectorize(
            #[inline(always)]
            || {
                let [x, y, u, v, c1, s1, c2, s2, w1, w2] = *state;
                let d =
                    self.with_trigonometry(&[x, y, u, v, c1, c2, w1, w2], [(s1, c1), (s2, c2)]).0;
                *derivative =
                    [d[0], d[1], d[2], d[3], -(s1 * w1), c1 * w1, -(s2 * w2), c2 * w2, d[6], d[7]];
            },
        );
    }

    /// Derivative of the state.
    ///
    /// A function of its own at every level of instructions, not a part of each of its callers: they
    /// are large, and so would be the time to compile them.
    #[inline]
    pub fn derivative(&self, state: &Vector<S>, derivative: &mut Vector<S>) {
        self.omega.simd.vectorize(
            #[inline(always)]
            || *derivative = self.inlined(state).0,
        );
    }

    /// Derivative and forces.
    #[inline(always)]
    pub fn full(&self, state: &Vector<S>) -> (Vector<S>, [Contact<S>; 2]) {
        self.inlined(state)
    }

    #[inline(always)]
    fn inlined(&self, state: &Vector<S>) -> (Vector<S>, [Contact<S>; 2]) {
        self.with_trigonometry(state, [sin_cos(state[4]), sin_cos(state[5])])
    }

    /// The same where sines and cosines are known.
    #[inline(always)]
    pub fn with_trigonometry(
        &self,
        state: &Vector<S>,
        trigonometry: [(f64x8<S>, f64x8<S>); 2],
    ) -> (Vector<S>, [Contact<S>; 2]) {
        let [x, y, x_dot, y_dot, _, _, beta_dot_1, beta_dot_2] = *state;
        // The table's own forces, and frame terms.
        let mut force_x = self.drag_omega.mul_add_precise(y, self.imbalance - x);
        force_x = (-self.drag).mul_add_precise(x_dot, force_x);
        let mut force_y = (-self.drag_omega).mul_add_precise(x, -y);
        force_y = (-self.drag).mul_add_precise(y_dot, force_y);
        let frame_x = self.two_omega.mul_add_precise(y_dot, self.omega_squared * x);
        let frame_y = (-self.two_omega).mul_add_precise(x_dot, self.omega_squared * y);
        let (a, balls, contacts) =
            self.accelerations([force_x, force_y], trigonometry, [beta_dot_1, beta_dot_2]);
        let derivative = [
            x_dot,
            y_dot,
            a[0] + frame_x,
            a[1] + frame_y,
            beta_dot_1,
            beta_dot_2,
            balls[0],
            balls[1],
        ];
        (derivative, contacts)
    }

    /// Absolute acceleration of the table, accelerations of the balls and forces on them, where the
    /// table's own forces (all but the balls') are known.
    #[inline(always)]
    #[expect(clippy::type_complexity)]
    pub fn accelerations(
        &self,
        [mut force_x, mut force_y]: [f64x8<S>; 2],
        trigonometry: [(f64x8<S>, f64x8<S>); 2],
        speeds: [f64x8<S>; 2],
    ) -> ([f64x8<S>; 2], [f64x8<S>; 2], [Contact<S>; 2]) {
        let one = f64x8::splat(force_x.simd, 1.0);
        let one_ball_1 = self.one_ball(0, trigonometry[0], speeds[0]);
        let one_ball_2 = self.one_ball(1, trigonometry[1], speeds[1]);
        let [(s1, c1), (s2, c2)] = trigonometry;
        let (u1, v1, held_1, pressed_1, along_1, push_1) = one_ball_1;
        let (u2, v2, held_2, pressed_2, along_2, push_2) = one_ball_2;
        // Sums that two balls exchanged give to the last bit, without fused operations.
        let m_xx = s1 * along_1[0] + s2 * along_2[0];
        let m_xy = s1 * along_1[1] + s2 * along_2[1];
        let m_yx = c1 * along_1[0] + c2 * along_2[0];
        let m_yy = c1 * along_1[1] + c2 * along_2[1];
        force_x = force_x + (push_1[0] + push_2[0]);
        force_y = force_y + (push_1[1] + push_2[1]);
        let (a, d) = (one - m_xx, one + m_yy);
        // a_x = (d F_x + m_xy F_y) / det, a_y = (a F_y - m_yx F_x) / det, det = a d + m_xy m_yx
        let determinant = a.mul_add_precise(d, m_xy * m_yx);
        let inverse = one / determinant;
        let a_x = d.mul_add_precise(force_x, m_xy * force_y) * inverse;
        let a_y = a.mul_add_precise(force_y, -(m_yx * force_x)) * inverse;
        (
            [a_x, a_y],
            [
                self.balls[0].mobility * u1.mul_add_precise(a_x, v1.mul_add_precise(a_y, -held_1)),
                self.balls[1].mobility * u2.mul_add_precise(a_x, v2.mul_add_precise(a_y, -held_2)),
            ],
            [contact((s1, c1), pressed_1, a_x, a_y), contact((s2, c2), pressed_2, a_x, a_y)],
        )
    }

    /// What one ball adds, before the table's acceleration is known.
    #[inline(always)]
    fn one_ball(&self, i: usize, (s, c): (f64x8<S>, f64x8<S>), speed: f64x8<S>) -> OneBall<S> {
        let ball = &self.balls[i];
        let w = self.omega + speed;
        let w_squared = w * w;
        let rolling = ball.rolling_quadratic.mul_add_precise(speed, ball.rolling_linear);
        let pressed = rolling.mul_add_precise(speed, w_squared);
        let u = ball.friction.mul_add_precise(c, s);
        let v = ball.friction.mul_add_precise(s, -c);
        let held = ball.friction * pressed;
        let along = [ball.mobile_mass * u, ball.mobile_mass * v];
        let outward = ball.mass * w_squared;
        let pulled = ball.mobile_mass * held;
        let push_x = c.mul_add_precise(outward, -(s * pulled));
        let push_y = s.mul_add_precise(outward, c * pulled);
        (u, v, held, pressed, along, [push_x, push_y])
    }
}

type OneBall<S> = (f64x8<S>, f64x8<S>, f64x8<S>, f64x8<S>, [f64x8<S>; 2], [f64x8<S>; 2]);

#[inline(always)]
fn contact<S: Simd>(
    (s, c): (f64x8<S>, f64x8<S>),
    pressed: f64x8<S>,
    a_x: f64x8<S>,
    a_y: f64x8<S>,
) -> Contact<S> {
    Contact {
        sine: s,
        cosine: c,
        normal: pressed - c.mul_add_precise(a_x, s * a_y),
        tangential: s.mul_add_precise(a_x, -(c * a_y)),
    }
}
