//! A state of the motion: positions and velocities, as named parts or as a list of components.

use smallvec::SmallVec;

use super::Number;

/// The components of a state, or of its rate of change, in the order in which the system records them.
pub type Components = SmallVec<[f64; 20]>;

/// Positions and velocities, non-dimensional: of the disc in the frame that turns with it, and of `N` balls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<const N: usize, T = f64> {
    /// The centre of the disc `(x, y)`, which is that of the ring if it has no runout.
    pub position: [T; 2],
    /// Its velocity `(ẋ, ẏ)`.
    pub velocity: [T; 2],
    /// Angle of each ball from the imbalance, rad.
    pub beta: [T; N],
    /// Sliding speed of each ball relative to the ring.
    pub beta_dot: [T; N],
}

impl<const N: usize, T: Number> State<N, T> {
    /// Adds `factor` times another state, component by component.
    #[inline]
    pub fn add_scaled(&mut self, factor: T, other: &Self) {
        for axis in 0..2 {
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
        State { position: [zero; 2], velocity: [zero; 2], beta: [zero; N], beta_dot: [zero; N] }
    }
}

/// The number of components without an allocation: those of a balancer with eight balls.
const INLINE: usize = 20;

impl<const N: usize> State<N> {
    /// Returns the components in the order of a recorded system.
    pub fn components(&self) -> Components {
        let parts = [&self.position[..], &self.velocity, &self.beta, &self.beta_dot];
        // A buffer is filled by plain copies.
        let mut buffer = [0.0; INLINE];
        let length = 2 * (2 + N);
        if length > INLINE {
            return parts.concat().into();
        }
        let mut place = 0;
        for part in parts {
            buffer[place..place + part.len()].copy_from_slice(part);
            place += part.len();
        }
        Components::from_buf_and_len(buffer, length)
    }

    /// Returns the state with these components; `None` for another number of components.
    pub fn of_components(components: &[f64]) -> Option<Self> {
        let (position, rest) = components.split_first_chunk()?;
        let (velocity, rest) = rest.split_first_chunk()?;
        let (beta, rest) = rest.split_first_chunk()?;
        let beta_dot = rest.try_into().ok()?;
        Some(State { position: *position, velocity: *velocity, beta: *beta, beta_dot })
    }
}
