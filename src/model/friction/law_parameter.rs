//! The parameters of a friction law: names, dimensions and lowest values.

/// The largest number of parameters of a law.
pub const MAX_LAW_PARAMETERS: usize = 4;

/// A parameter of a friction law.
#[derive(Clone, Copy, Debug)]
pub struct LawParameter {
    /// Name in a study file where it does not depend on the unit of sliding speeds.
    pub name: &'static str,
    /// Its dimension.
    pub dimension: LawDimension,
    /// Its lowest value.
    pub lowest: Lowest,
    /// Its meaning, in a few words.
    pub meaning: &'static str,
    /// What a special value means, as the rest of a sentence; empty if there is none.
    pub note: &'static str,
    /// Values of an example for balls and for blocks.
    pub examples: [f64; 2],
}

/// The dimension of a law's parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawDimension {
    /// Dimensionless.
    Ratio,
    /// A sliding speed, whose name has its unit.
    SlidingSpeed {
        /// Name in rad/s, for balls.
        rad_s: &'static str,
        /// Name in m/s, for blocks.
        m_s: &'static str,
    },
    /// A force over a speed, N s/m.
    Drag,
}

/// The lowest value of a law's parameter; all values are finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lowest {
    /// Zero or more.
    Zero,
    /// More than zero.
    AboveZero,
    /// The (kinetic) friction coefficient or more.
    FrictionCoefficient,
}

/// The unit of the sliding speeds of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SlidingSpeed {
    /// rad/s, of balls relative to the ring.
    RadS,
    /// m/s.
    MS,
}

impl LawParameter {
    /// Returns the name in a study file.
    pub fn name(&self, speed: SlidingSpeed) -> &'static str {
        match (self.dimension, speed) {
            (LawDimension::SlidingSpeed { rad_s, .. }, SlidingSpeed::RadS) => rad_s,
            (LawDimension::SlidingSpeed { m_s, .. }, SlidingSpeed::MS) => m_s,
            _ => self.name,
        }
    }

    /// Returns the names for both units of sliding speeds.
    pub fn names(&self) -> [&'static str; 2] {
        [SlidingSpeed::RadS, SlidingSpeed::MS].map(|speed| self.name(speed))
    }

    /// Returns the unit; `1` for dimensionless numbers.
    pub fn unit(&self, speed: SlidingSpeed) -> &'static str {
        match (self.dimension, speed) {
            (LawDimension::Ratio, _) => "1",
            (LawDimension::Drag, _) => "N s/m",
            (LawDimension::SlidingSpeed { .. }, SlidingSpeed::RadS) => "rad/s",
            (LawDimension::SlidingSpeed { .. }, SlidingSpeed::MS) => "m/s",
        }
    }
}
