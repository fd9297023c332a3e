//! A friction law with the values of its parameters, as a study gives it.

use std::fmt;

use serde::{Serialize, Serializer};

use super::{Law, LawParameter, Lowest, MAX_LAW_PARAMETERS, SlidingSpeed};
use crate::model::InvalidParameter;
use crate::model::invalid_parameter::{invalid, not_negative, positive};

/// A friction law with the values of its parameters, in SI units. Sliding speeds are rad/s for a ball
/// relative to the ring, and m/s for a block.
#[derive(Clone, Copy)]
pub struct FrictionLaw {
    pub(super) law: &'static dyn Law,
    pub(super) values: [f64; MAX_LAW_PARAMETERS],
}

impl FrictionLaw {
    /// A law with the values of its parameters, in their order. Missing values are 0, and further
    /// values have no effect.
    pub const fn new(law: &'static dyn Law, values: &[f64]) -> Self {
        let mut padded = [0.0; MAX_LAW_PARAMETERS];
        let mut index = 0;
        while index < MAX_LAW_PARAMETERS && index < values.len() {
            padded[index] = values[index];
            index += 1;
        }
        FrictionLaw { law, values: padded }
    }

    /// The law itself.
    pub fn law(&self) -> &'static dyn Law {
        self.law
    }

    /// The law's name in a study file.
    pub fn name(&self) -> &'static str {
        self.law.name()
    }

    /// The values of the law's parameters, in their order.
    pub fn values(&self) -> &[f64] {
        &self.values[..self.law.parameters().len()]
    }

    /// Returns the value of the parameter with this name, with or without a unit of sliding speeds.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.index(name).map(|index| self.values[index])
    }

    /// Returns the value of the parameter with this name, mutably.
    pub fn value_mut(&mut self, name: &str) -> Option<&mut f64> {
        self.index(name).map(|index| &mut self.values[index])
    }

    fn index(&self, name: &str) -> Option<usize> {
        let is_named = |known: &LawParameter| known.name == name || known.names().contains(&name);
        self.law.parameters().iter().position(is_named)
    }

    /// Returns whether bodies can stick: whether the force at rest can take any value in an
    /// interval.
    pub fn can_stick(&self) -> bool {
        self.law.can_stick()
    }

    /// Returns the name of the coefficient that limits friction in stick.
    pub fn limiting_coefficient(&self) -> &'static str {
        let is_limit = |parameter: &&LawParameter| parameter.lowest == Lowest::FrictionCoefficient;
        let limit = self.law.parameters().iter().find(is_limit);
        limit.map_or("friction_coefficient", |parameter| parameter.name)
    }

    /// Whether friction in slip is a fixed part of the normal force and a drag in proportion to speed, for
    /// a contact with this (kinetic) coefficient.
    pub fn is_linear(&self, friction_coefficient: f64) -> bool {
        self.law.is_linear(friction_coefficient, self.values())
    }

    /// Checks that all values have a physical meaning, for a contact with this (kinetic)
    /// coefficient.
    pub(in crate::model) fn validate(
        &self,
        friction_coefficient: f64,
        speed: SlidingSpeed,
    ) -> Result<(), InvalidParameter> {
        for (parameter, &value) in self.law.parameters().iter().zip(self.values()) {
            let name = parameter.name(speed);
            match parameter.lowest {
                Lowest::Zero => not_negative(name, value)?,
                Lowest::AboveZero => positive(name, value)?,
                Lowest::FrictionCoefficient
                    if !value.is_finite() || value < friction_coefficient =>
                {
                    let allowed = "a finite number, not below the friction coefficient";
                    return Err(invalid(name, &value.to_string(), allowed));
                }
                Lowest::FrictionCoefficient => {}
            }
        }
        Ok(())
    }
}

impl PartialEq for FrictionLaw {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name() && self.values() == other.values()
    }
}

impl fmt::Debug for FrictionLaw {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.debug_tuple(self.name()).field(&self.values()).finish()
    }
}

/// The name and the values determine the law, and with them the stored results of a case.
impl Serialize for FrictionLaw {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (self.name(), self.values()).serialize(serializer)
    }
}
