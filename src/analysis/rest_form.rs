//! Non-dimensional parameters of the closed forms at rest, for any number of balls. Equilibrium
//! sets, balancing positions and linearised equations all read a machine's parameters from here.
//!
//! The balls feel the position of the ring's centre. With a runout `ε` of the ring the centre rests at `g F + ε`, where `F`
//! contains `Σ m ε`. This is `g (F + ε/g)`: the balls rest as in a ring without runout on a disc with the imbalance
//! `m_I e + Σ m ε + ε/g`, and only the table's own place differs, by `ε`.

use nalgebra::Complex;

use crate::model::{Balancer, Ball, Machine};

/// The non-dimensional parameters of a machine that determine where its balls can rest.
#[derive(Clone, Debug, PartialEq)]
pub struct RestForm {
    /// Speed of the disc over `ω_n`.
    pub speed: f64,
    /// Damping ratio `ζ` of the suspension.
    pub damping_ratio: f64,
    /// Transfer function from the sum of imbalances to the rest point, `g = ω² / (1 - ω² + 2iζω)`:
    /// not finite at the resonance of an undamped suspension, where nothing rests.
    pub transfer: Complex<f64>,
    /// The imbalance that the balls feel: `m_I e`, and with a runout `ε` of the ring also `Σ m ε + ε/g`.
    pub imbalance: Complex<f64>,
    /// Position `ε` of the ring's centre in the disc; 0 at standstill, where it has no effect.
    pub runout: Complex<f64>,
    /// Mass of each ball.
    pub mass: Vec<f64>,
    /// Largest ratio of friction to normal force of each ball at rest.
    pub friction_coefficient: Vec<f64>,
    /// `1 + 4J` of each ball: the ratio of its inertia along the ring to its mass.
    pub inertia: Vec<f64>,
    /// The balls as specified.
    pub balls: Vec<Ball>,
    /// Radius `L` of the ring, m.
    pub ring_radius_m: f64,
    /// Natural frequency `ω_n`, rad/s.
    pub natural_frequency_rad_s: f64,
    /// The contact between several balls, if they have any.
    pub(super) touching: Option<ContactPairs>,
}

/// One position of the balls at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtRest {
    /// Amplitude of the table's vibration, m.
    pub amplitude_m: f64,
    /// The smallest friction coefficient, equal for all balls, that holds them here; infinite if a
    /// normal force would have to pull.
    pub required_friction: f64,
    /// Largest ratio of the tangential force on a ball to its friction limit: the position is an
    /// equilibrium if it is at most 1.
    pub friction_used: f64,
}

impl AtRest {
    /// Returns whether the balls can rest here.
    pub fn in_set(&self) -> bool {
        self.friction_used <= 1.0
    }

    /// Returns the unused fraction of the friction limit: 0 on the edge of the set, negative
    /// outside.
    pub fn friction_margin(&self) -> f64 {
        1.0 - self.friction_used
    }
}

impl RestForm {
    /// Returns the parameters of a machine, or `None` for an unsupported number of balls.
    pub fn new(machine: &Machine) -> Option<Self> {
        match machine.balls.len() {
            1 => Self::of::<1>(machine),
            2 => Self::of::<2>(machine),
            3 => Self::of::<3>(machine),
            4 => Self::of::<4>(machine),
            5 => Self::of::<5>(machine),
            6 => Self::of::<6>(machine),
            7 => Self::of::<7>(machine),
            8 => Self::of::<8>(machine),
            _ => None,
        }
    }

    fn of<const N: usize>(machine: &Machine) -> Option<Self> {
        let balancer = Balancer::<N>::new(machine)?;
        let (speed, damping_ratio) = (balancer.speed, balancer.damping_ratio);
        let denominator = Complex::new(1.0 - speed * speed, 2.0 * damping_ratio * speed);
        let balls = balancer.balls.iter();
        let runout = balancer.runout.filter(|_| speed != 0.0);
        let runout = runout.map(|[x, y]| Complex::new(x, y));
        let balls_mass: f64 = balls.clone().map(|ball| ball.mass).sum();
        let felt =
            |runout: Complex<f64>| runout * balls_mass + runout * denominator / (speed * speed);
        let imbalance = Complex::from(balancer.imbalance);
        Some(RestForm {
            touching: ContactPairs::of(machine),
            speed,
            damping_ratio,
            transfer: Complex::from(speed * speed) / denominator,
            imbalance: runout.map_or(imbalance, |runout| imbalance + felt(runout)),
            runout: runout.unwrap_or_default(),
            mass: balls.clone().map(|ball| ball.mass).collect(),
            friction_coefficient: balls.clone().map(|ball| ball.friction.limit).collect(),
            inertia: balls.map(|ball| 1.0 / ball.mobility).collect(),
            balls: machine.balls.clone(),
            ring_radius_m: machine.ring_radius_m,
            natural_frequency_rad_s: machine.natural_frequency_rad_s(),
        })
    }

    /// Returns the total imbalance that the balls feel with the balls at `beta`, one angle per ball: without runout
    /// `F = m_I e + Σ m e^{iβ}` (thesis equations 5.3, 5.4).
    pub fn imbalance_at(&self, beta: &[f64]) -> Complex<f64> {
        self.imbalance_of(beta.iter().map(|&beta| direction(beta)))
    }

    fn imbalance_of(&self, directions: impl Iterator<Item = Complex<f64>>) -> Complex<f64> {
        let balls = self.mass.iter().zip(directions).map(|(&mass, direction)| direction * mass);
        self.imbalance + balls.sum::<Complex<f64>>()
    }

    /// Returns the imbalance that acts on the table without the masses that the balls move: `m_I e`, with a runout `ε` of the
    /// ring `m_I e + Σ m ε`.
    pub(super) fn imbalance_of_table(&self) -> Complex<f64> {
        if self.runout.norm() == 0.0 {
            return self.imbalance;
        }
        self.imbalance - self.runout / self.transfer
    }

    /// Returns where the ring's centre rests with the balls at `beta`, `z_0 + ε`, non-dimensional: without runout the table's
    /// rest point `z_0 = x_0 + i y_0`.
    pub fn ring_centre(&self, beta: &[f64]) -> Complex<f64> {
        self.transfer * self.imbalance_at(beta)
    }

    /// Returns the amplitude of the table with the balls at `beta`, m.
    pub fn amplitude_m(&self, beta: &[f64]) -> f64 {
        (self.ring_centre(beta) - self.runout).norm() * self.ring_radius_m
    }

    /// Returns the amplitude and the friction required for rest at `beta` (thesis equation 5.5).
    pub fn at_rest(&self, beta: &[f64]) -> AtRest {
        let z = self.ring_centre(beta);
        let (mut required_friction, mut friction_used) = (0.0, 0.0);
        for (&beta, &coefficient) in beta.iter().zip(&self.friction_coefficient) {
            let e = direction(beta);
            let (required, used) = holding([z.re, z.im], [e.re, e.im], coefficient);
            required_friction = larger(required_friction, required);
            friction_used = larger(friction_used, used);
        }
        let amplitude_m = (z - self.runout).norm() * self.ring_radius_m;
        AtRest { amplitude_m, required_friction, friction_used }
    }

    /// Returns whether the balls can rest in these directions, `e^{iβ}` of each; a faster
    /// [`RestForm::at_rest`] that returns only whether the position is in the set.
    pub(super) fn holds(&self, directions: &[Complex<f64>]) -> bool {
        let z = self.transfer * self.imbalance_of(directions.iter().copied());
        let balls = directions.iter().zip(&self.friction_coefficient);
        balls.fold(true, |held, (e, &coefficient)| {
            held & is_held([z.re, z.im], [e.re, e.im], coefficient)
        })
    }
}

/// Returns `e^{iβ}` from a sine and cosine that give equal bits on all platforms.
pub(super) fn direction(beta: f64) -> Complex<f64> {
    let (sine, cosine) = libm::sincos(beta);
    Complex::new(cosine, sine)
}

/// Returns the friction coefficient that holds a ball in the direction `[c, s]` with the ring's centre at
/// `[x, y]`, `|y c - x s| / (1 + x c + y s)`, and the ratio of the tangential force to the friction
/// limit.
///
/// The square of the speed, a factor of both forces, cancels; at standstill, where no force acts,
/// both results are 0. The function is free of branches, so that loops over it are vectorised.
#[inline]
pub(super) fn holding([x, y]: [f64; 2], [c, s]: [f64; 2], coefficient: f64) -> (f64, f64) {
    let normal = 1.0 + (x * c + y * s);
    let tangential = (y * c - x * s).abs();
    let limit = coefficient * normal;
    let nothing_needed = tangential == 0.0 && normal >= 0.0;
    let without_limit = if nothing_needed { 0.0 } else { f64::INFINITY };
    let required = if normal > 0.0 { tangential / normal } else { without_limit };
    let used = if limit > 0.0 { tangential / limit } else { without_limit };
    (required, used)
}

/// Returns whether the second result of [`holding`] is at most 1, without a division: the quotient
/// of two positive numbers rounds to more than 1 if and only if the first is greater.
#[inline]
pub(super) fn is_held([x, y]: [f64; 2], [c, s]: [f64; 2], coefficient: f64) -> bool {
    let normal = 1.0 + (x * c + y * s);
    let tangential = (y * c - x * s).abs();
    let limit = coefficient * normal;
    let nothing_needed = (tangential == 0.0) & (normal >= 0.0);
    let within = (tangential <= limit) & (tangential < f64::INFINITY);
    (limit > 0.0) & within | nothing_needed
}

/// Returns the larger of two numbers; neither may be NaN.
#[inline]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// The contact between the balls of a machine.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ContactPairs {
    /// The coefficient of friction between two balls.
    pub friction_coefficient: f64,
    /// The angle at which each pair of balls touches, rad, with its cosine.
    pub pairs: Vec<([usize; 2], f64, f64)>,
}

impl ContactPairs {
    /// Returns the contact of a machine with several balls, if it has any.
    pub(super) fn of(machine: &Machine) -> Option<Self> {
        let contact = machine.contact?;
        let balls = machine.balls.len();
        let pairs = (0..balls).flat_map(|ball| (0..ball).map(move |other| [other, ball]));
        let pairs = pairs.map(|pair| {
            let [first, second] = pair.map(|ball| &machine.balls[ball]);
            let angle = machine.contact_angle_rad(first, second);
            (pair, angle, libm::cos(angle))
        });
        let friction_coefficient = contact.friction_coefficient;
        (balls > 1).then(|| ContactPairs { friction_coefficient, pairs: pairs.collect() })
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::{holding, is_held};

    /// The results with and without the division agree, on and near the edge of the set and for NaN
    /// and infinite values.
    #[test]
    fn is_held_agrees_with_the_ratio_to_the_limit() {
        let mut draws = ChaCha8Rng::seed_from_u64(8);
        let (mut held, mut seen) = (0, 0);
        let mut same = |z: [f64; 2], e: [f64; 2], coefficient: f64| {
            let (_, used) = holding(z, e, coefficient);
            assert_eq!(is_held(z, e, coefficient), used <= 1.0, "{z:?} {e:?} {coefficient}");
            held += u32::from(used <= 1.0);
            seen += 1;
        };
        for _ in 0..20_000 {
            let z = [0, 1].map(|_| 3.0 * draws.random::<f64>() - 1.5);
            let (s, c) = libm::sincos(std::f64::consts::TAU * draws.random::<f64>());
            let normal = 1.0 + (z[0] * c + z[1] * s);
            // The coefficient at which the limit is exactly reached, and its neighbours.
            let edge = (z[1] * c - z[0] * s).abs() / normal;
            for coefficient in [draws.random::<f64>(), edge, edge.next_up(), edge.next_down(), 0.0]
            {
                same(z, [c, s], coefficient.max(0.0));
            }
        }
        let special = [0.0, -0.0, 1.0, -1.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE, 5e-324];
        for [x, y, coefficient] in special
            .into_iter()
            .flat_map(|x| special.map(|y| special.map(|coefficient| [x, y, coefficient])))
            .flatten()
        {
            for e in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.6, 0.8]] {
                same([x, y], e, coefficient);
            }
        }
        assert!(held > seen / 10 && held < seen - seen / 10, "{held} of {seen}");
    }
}
