//! The balancer in non-dimensional form (thesis section 3.4): lengths over `L`, time times `ω_n`,
//! masses over the whole vibrating mass `M`.

use super::{Friction, Machine, NormalForce, Number};

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

/// Polar moment of inertia of a homogeneous sphere over `m d²`.
pub const SPHERE_INERTIA: f64 = 0.1;

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

/// Positions and velocities, non-dimensional: of the `FREE` coordinates that no friction acts on,
/// and of `N` contacts.
///
/// In the balancer the free coordinates are the ring's centre in the frame that turns with the
/// disc, and the contacts are the balls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<const N: usize, T = f64, const FREE: usize = 2> {
    /// The centre of the disc `(x, y)`, which is that of the ring if it has no runout.
    pub position: [T; FREE],
    /// Its velocity `(ẋ, ẏ)`.
    pub velocity: [T; FREE],
    /// Angle of each ball from the imbalance, rad; position of a block.
    pub beta: [T; N],
    /// Sliding speed of each contact: of a ball relative to the ring, of a block relative to its
    /// support.
    pub beta_dot: [T; N],
}

impl<const N: usize, T: Number, const FREE: usize> State<N, T, FREE> {
    /// Adds `factor` times another state, component by component.
    #[inline]
    pub fn add_scaled(&mut self, factor: T, other: &Self) {
        for axis in 0..FREE {
            self.position[axis] = self.position[axis] + factor * other.position[axis];
            self.velocity[axis] = self.velocity[axis] + factor * other.velocity[axis];
        }
        for ball in 0..N {
            self.beta[ball] = self.beta[ball] + factor * other.beta[ball];
            self.beta_dot[ball] = self.beta_dot[ball] + factor * other.beta_dot[ball];
        }
    }

    /// All components zero.
    #[inline]
    pub fn zero() -> Self {
        let zero = T::constant(0.0);
        State {
            position: [zero; FREE],
            velocity: [zero; FREE],
            beta: [zero; N],
            beta_dot: [zero; N],
        }
    }
}
