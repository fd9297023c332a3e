//! The balancer in non-dimensional form (thesis section 3.4): lengths over `L`, time times `ω_n`,
//! masses over the whole vibrating mass `M`.

use super::{Friction, Machine, NormalForce, Number, SPHERE_INERTIA};

/// A ball's non-dimensional parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BalancerBall<T = f64> {
    /// Mass over `M`.
    pub mass: T,
    /// `J / (m d²)`: 0.1 for a homogeneous sphere.
    pub inertia: T,
    /// Diameter over `L`.
    pub diameter: T,
    /// Friction between ball and ring.
    pub friction: Friction,
    /// `1 / (1 + 4 J)`: how much of a tangential force turns into angular acceleration.
    pub mobility: T,
    /// Coefficient of `β̇` in the rolling term `r` of the normal force: `2 J d ω`, or 0 (Newton).
    pub rolling_linear: T,
    /// Coefficient of `β̇²` in the rolling term: `-4 J`, or 0 (Newton).
    pub rolling_quadratic: T,
}

/// The machine's non-dimensional parameters, for `N` balls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balancer<const N: usize, T = f64> {
    /// Speed of the disc over `ω_n`.
    pub speed: T,
    /// Acceleration of the disc over `ω_n²`; `None` at constant speed.
    pub acceleration: Option<T>,
    /// Damping ratio of the suspension, `ζ = b / (2 M ω_n)`.
    pub damping_ratio: T,
    /// Imbalance `m_I e`, over `M L`.
    pub imbalance: T,
    /// Position `(ε_x, ε_y)` of the ring's centre in the disc, over `L`; `None` for a ring whose centre is that of the disc.
    pub runout: Option<[T; 2]>,
    /// The balls.
    pub balls: [BalancerBall<T>; N],
}

impl<const N: usize> Balancer<N> {
    /// The non-dimensional form of a machine with exactly `N` balls; `None` for another number.
    pub fn new(machine: &Machine) -> Option<Self> {
        let total = machine.total_mass_kg();
        let natural = machine.natural_frequency_rad_s();
        let speed = machine.speed_rad_s / natural;
        let balls: &[_; N] = machine.balls.as_slice().try_into().ok()?;
        let rolling = match machine.normal_force {
            NormalForce::Lagrange => 1.0,
            NormalForce::Newton => 0.0,
        };
        Some(Balancer {
            speed,
            acceleration: None,
            damping_ratio: machine.damping_n_s_m / (2.0 * total * natural),
            imbalance: machine.imbalance_mass_kg / total * machine.imbalance_radius_m
                / machine.ring_radius_m,
            runout: (machine.ring_runout_m != 0.0).then(|| {
                let (sine, cosine) = libm::sincos(machine.ring_runout_angle_rad);
                [cosine, sine].map(|part| part * machine.ring_runout_m / machine.ring_radius_m)
            }),
            balls: balls.map(|ball| {
                let diameter = ball.diameter_m / machine.ring_radius_m;
                BalancerBall {
                    mass: ball.mass_kg / total,
                    inertia: SPHERE_INERTIA,
                    diameter,
                    friction: machine.ball_friction(&ball),
                    mobility: 1.0 / (1.0 + 4.0 * SPHERE_INERTIA),
                    rolling_linear: rolling * 2.0 * SPHERE_INERTIA * diameter * speed,
                    rolling_quadratic: rolling * -4.0 * SPHERE_INERTIA,
                }
            }),
        })
    }
}

impl<const N: usize> Balancer<N> {
    /// Returns this balancer in another arithmetic.
    #[inline]
    pub fn lifted<T: Number>(&self) -> Balancer<N, T> {
        Balancer {
            speed: T::constant(self.speed),
            acceleration: self.acceleration.map(T::constant),
            damping_ratio: T::constant(self.damping_ratio),
            imbalance: T::constant(self.imbalance),
            runout: self.runout.map(|runout| runout.map(T::constant)),
            balls: self.balls.map(|ball| BalancerBall {
                mass: T::constant(ball.mass),
                inertia: T::constant(ball.inertia),
                diameter: T::constant(ball.diameter),
                friction: ball.friction,
                mobility: T::constant(ball.mobility),
                rolling_linear: T::constant(ball.rolling_linear),
                rolling_quadratic: T::constant(ball.rolling_quadratic),
            }),
        }
    }
}

impl<const N: usize> Balancer<N> {
    /// Changes the components of a state by a jump of the table's velocity, non-dimensional, in the turning frame. Returns
    /// the number of balls that the blow lifts off the ring.
    ///
    /// If the velocity of the table jumps by `(Δẋ, Δẏ)`, the ring's impulse on a ball, over its mass, is `P = -c Δẋ - s Δẏ`,
    /// and the ball's speed jumps by
    ///
    /// ```text
    /// (1 + 4J) Δβ̇ = s Δẋ - c Δẏ - q,    q ∈ μ P Sign(β̇⁺)
    /// ```
    ///
    /// with the friction impulse `q` (the equations of motion, integrated over the blow). Where `P` is negative, the blow lifts
    /// the ball off the ring, which the model does not follow: there is no friction impulse, and such balls are counted.
    pub(super) fn jump_of_balls(&self, components: &mut [f64], jump: [f64; 2]) -> u32 {
        let [x_jump, y_jump] = jump;
        let (table, balls) = components.split_at_mut(4);
        table[2] += x_jump;
        table[3] += y_jump;
        let (angles, speeds) = balls.split_at_mut(N);
        let mut lifted = 0;
        for ((ball, angle), speed) in self.balls.iter().zip(angles).zip(speeds) {
            let BalancerBall { mobility, friction, .. } = ball;
            let (sine, cosine) = libm::sincos(*angle);
            let pressed = -cosine * x_jump - sine * y_jump;
            let without_friction = *speed + mobility * (sine * x_jump - cosine * y_jump);
            let friction = mobility * friction.limit * pressed.max(0.0);
            *speed = without_friction.signum() * (without_friction.abs() - friction).max(0.0);
            lifted += u32::from(pressed < 0.0);
        }
        lifted
    }
}
