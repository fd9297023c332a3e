//! The parameters of a kind of models: names, units, meanings, and where their values are.

use std::fmt;

use super::parameter_name::member_name;
use super::{Ball, BallContact, Kick, Machine, Ramp, SpeedProfile};

/// The name of the (kinetic) friction coefficient in every kind of model.
pub const FRICTION_COEFFICIENT: &str = "friction_coefficient";

/// A parameter of a model.
#[derive(Clone, Copy)]
pub struct ParameterDescriptor {
    /// Name in study files and tables, with its unit.
    pub name: &'static str,
    /// Unit, such as `kg`; `1` for dimensionless numbers, empty for words.
    pub unit: &'static str,
    /// Meaning, in a few words.
    pub meaning: &'static str,
    /// Where its value is.
    pub field: Field,
}

impl fmt::Debug for ParameterDescriptor {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name)
    }
}

/// Where the value of a parameter is.
#[derive(Clone, Copy)]
pub enum Field {
    /// A number of a machine.
    Machine(fn(&mut Machine) -> &mut f64),
    /// A number of each ball.
    Ball(fn(&mut Ball) -> &mut f64),
    /// A number of each ball that determines another parameter, if it is given: a density determines the mass.
    OfBall {
        /// The number; `None` if it is not given.
        number: fn(&mut Ball) -> &mut Option<f64>,
        /// Its value that follows from the other parameter.
        following: fn(&Ball) -> f64,
        /// The other parameter.
        determines: &'static str,
    },
    /// A number of a machine that determines another parameter, if it is given.
    OfMachine {
        /// The number; `None` if it is not given.
        number: fn(&mut Machine) -> &mut Option<f64>,
        /// Its value that follows from the other parameter.
        following: fn(&Machine) -> f64,
        /// The other parameter.
        determines: &'static str,
    },
    /// A number of the contact between balls, for balls with contact.
    Contact(fn(&mut BallContact) -> &mut f64),
    /// A number of the speed profile, for a disc whose speed changes.
    Profile(fn(&mut SpeedProfile) -> &mut f64),
    /// A number of each ramp of the speed profile; `None` if a ramp has none.
    Ramp(fn(&mut Ramp) -> Option<&mut f64>),
    /// The duration of each plateau of the speed profile.
    Hold,
    /// A number of each kick of the table.
    Kick(fn(&mut Kick) -> &mut f64),
    /// The form of the normal force, a word.
    NormalForce,
    /// A number of a model that is defined outside this crate.
    Own {
        /// The default.
        default: f64,
        /// The possible values.
        bound: Bound,
    },
    /// A whole number of a model that is defined outside this crate, such as a number of bodies. It is the same for all runs of a
    /// study.
    Count {
        /// The default.
        default: usize,
        /// The least value.
        least: usize,
        /// The largest value.
        most: usize,
    },
}

/// The possible values of a number; all are finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// More than zero.
    Positive,
    /// Zero or more.
    NotNegative,
    /// Any.
    None,
}

impl Field {
    /// Returns the default of a number outside this crate; the others have theirs in the default of their kind.
    pub(super) fn default_number(self) -> f64 {
        match self {
            Field::Own { default, .. } => default,
            Field::Count { default, .. } => default as f64,
            _ => f64::NAN,
        }
    }
}

impl ParameterDescriptor {
    /// A number above zero of a model that is defined outside this crate.
    pub const fn positive(
        name: &'static str,
        unit: &'static str,
        meaning: &'static str,
        default: f64,
    ) -> Self {
        let field = Field::Own { default, bound: Bound::Positive };
        ParameterDescriptor { name, unit, meaning, field }
    }

    /// A number of zero or more of a model that is defined outside this crate.
    pub const fn not_negative(
        name: &'static str,
        unit: &'static str,
        meaning: &'static str,
        default: f64,
    ) -> Self {
        let field = Field::Own { default, bound: Bound::NotNegative };
        ParameterDescriptor { name, unit, meaning, field }
    }

    /// A whole number from 1 to `most` of a model that is defined outside this crate.
    pub const fn count(
        name: &'static str,
        meaning: &'static str,
        default: usize,
        most: usize,
    ) -> Self {
        ParameterDescriptor {
            name,
            unit: "1",
            meaning,
            field: Field::Count { default, least: 1, most },
        }
    }

    /// Returns whether each ball has a value of its own.
    pub fn is_of_each_ball(&self) -> bool {
        matches!(self.field, Field::Ball(_) | Field::OfBall { .. })
    }

    /// Returns the parameter that this one determines, if it is given.
    pub fn determines(&self) -> Option<&'static str> {
        match self.field {
            Field::OfBall { determines, .. } | Field::OfMachine { determines, .. } => {
                Some(determines)
            }
            _ => None,
        }
    }

    /// Returns the word for what has a value of its own each: balls, ramps and plateaus of the speed profile, or kicks;
    /// `None` for a parameter with one value.
    pub fn member(&self) -> Option<&'static str> {
        match self.field {
            Field::Ball(_) | Field::OfBall { .. } => Some("ball"),
            Field::Ramp(_) => Some("ramp"),
            Field::Hold => Some("plateau"),
            Field::Kick(_) => Some("kick"),
            _ => None,
        }
    }

    /// Returns the name of the value of one member, counted from 1: `ball_mass_kg` of ball 2 is `ball_mass_2_kg`,
    /// `friction_coefficient` is `friction_coefficient_2`.
    pub fn name_of_member(&self, number: usize) -> String {
        member_name(self.name, self.unit, number)
    }

    /// Returns whether the values are numbers.
    pub fn is_number(&self) -> bool {
        !matches!(self.field, Field::NormalForce)
    }

    /// Returns the key of `model` that contains the value, such as `contact`; `None` for a value among the parameters
    /// of a study file. A model without that key has no such parameter.
    pub fn own_key(&self) -> Option<&'static str> {
        match self.field {
            Field::Contact(_) => Some("contact"),
            Field::Profile(_) | Field::Ramp(_) | Field::Hold => Some("speed_profile"),
            Field::Kick(_) => Some("disturbances"),
            _ => None,
        }
    }

    /// Returns whether the value stands under a key of its own.
    pub fn has_own_key(&self) -> bool {
        self.own_key().is_some()
    }

    /// Returns the least and the largest value of a whole number; `None` for other parameters.
    pub fn counts(&self) -> Option<[usize; 2]> {
        match self.field {
            Field::Count { least, most, .. } => Some([least, most]),
            _ => None,
        }
    }

    /// Returns the largest value of a whole number; `None` for other parameters.
    pub fn largest_count(&self) -> Option<usize> {
        self.counts().map(|[_, most]| most)
    }
}
