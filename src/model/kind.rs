//! The kinds of models and their parameters: the one table that the study file, the JSON Schema, sweeps,
//! distributions, design variables, columns and the documentation read.

use std::fmt;

use super::coordinate::unit_ending;
use super::{
    Ball, BallContact, Kick, Machine, Model, OwnKind, OwnModel, ProfilePart, Ramp, SlidingSpeed,
    SpeedProfile,
};

/// The name of the (kinetic) friction coefficient in every kind of model.
pub const FRICTION_COEFFICIENT: &str = "friction_coefficient";

/// A kind of model.
pub struct ModelKind {
    /// The name in a study file.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub meaning: &'static str,
    /// Its parameters without those of the friction law, in the order of the documentation.
    pub parameters: &'static [ParameterDescriptor],
    /// The word for the body at each contact, such as `block`.
    pub body: &'static str,
    /// The unit of its sliding speeds.
    pub sliding_speed: SlidingSpeed,
    /// What the program offers for it beside its motion.
    pub offers: Capabilities,
    /// The model with the default values.
    pub default: DefaultModel,
}

/// The model of a kind with the default values.
pub enum DefaultModel {
    /// A model of this crate, with one ball if it has balls.
    BuiltIn(fn() -> Model),
    /// An own model; the value computes its coordinates, units and system.
    Own(&'static dyn OwnKind),
}

/// What the program offers for a kind of model beside its motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities {
    /// Residual vibration, compared with that of the same machine without balls.
    pub vibration: bool,
    /// Equilibrium sets and equilibria without friction, by closed forms.
    pub equilibrium_set: bool,
    /// Animations of runs.
    pub animation: bool,
}

impl Capabilities {
    /// Nothing beside the motion.
    pub const MOTION: Self =
        Capabilities { vibration: false, equilibrium_set: false, animation: false };
}

impl ModelKind {
    /// Returns a model with the default values.
    pub fn default_model(&'static self) -> Model {
        match self.default {
            DefaultModel::BuiltIn(model) => model(),
            DefaultModel::Own(own) => OwnModel::new(self, own).into(),
        }
    }

    /// Returns whether the study gives the law of friction of contacts.
    pub fn has_law_of_study(&self) -> bool {
        match self.default {
            DefaultModel::Own(own) => own.has_law_of_study(),
            DefaultModel::BuiltIn(_) => true,
        }
    }

    /// Returns the system file, as plain values, of a kind that a file defines.
    pub fn source(&self) -> Option<&'static serde_json::Value> {
        match self.default {
            DefaultModel::Own(own) => own.source(),
            DefaultModel::BuiltIn(_) => None,
        }
    }
}

impl fmt::Debug for ParameterDescriptor {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name)
    }
}

impl PartialEq for ModelKind {
    fn eq(&self, other: &Self) -> bool {
        // Definitions are long.
        std::ptr::eq(self, other) || (self.name, self.source()) == (other.name, other.source())
    }
}

impl fmt::Debug for ModelKind {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name)
    }
}

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

    /// Returns whether a model has a value; only a parameter that determines another one may have none.
    pub fn is_given(&self, model: &mut Model) -> bool {
        match (self.field, model) {
            (Field::OfMachine { number, .. }, Model::BallBalancer(machine)) => {
                number(machine).is_some()
            }
            (Field::OfBall { number, .. }, Model::BallBalancer(machine)) => {
                machine.balls.iter_mut().any(|ball| number(ball).is_some())
            }
            _ => true,
        }
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

    /// Returns the numbers of a model that the parameter sets: those of all members, such as balls, or of one, counted
    /// from 1. None for a model without this parameter.
    pub fn numbers<'a>(&self, model: &'a mut Model, member: Option<usize>) -> Vec<&'a mut f64> {
        let parts = |model: &'a mut Model| {
            let profile = model.speed_profile_mut().as_mut();
            profile.into_iter().flat_map(|one| &mut one.parts)
        };
        let machine = match (self.field, model) {
            (Field::Profile(field), model) => {
                return model.speed_profile_mut().as_mut().map(field).into_iter().collect();
            }
            (Field::Ramp(field), model) => {
                let ramps = parts(model).filter_map(|part| match part {
                    ProfilePart::Ramp(ramp) => Some(ramp),
                    _ => None,
                });
                return meant(ramps, member).filter_map(field).collect();
            }
            (Field::Hold, model) => {
                let holds = parts(model).filter_map(|part| match part {
                    ProfilePart::Hold(lasts_s) => Some(lasts_s),
                    _ => None,
                });
                return meant(holds, member).filter_map(Option::as_mut).collect();
            }
            (Field::Own { .. } | Field::Count { .. }, Model::Own(own)) => {
                return own.number_mut(self).into_iter().collect();
            }
            (_, Model::Own(_)) => return Vec::new(),
            (_, Model::BallBalancer(machine)) => machine,
        };
        match self.field {
            Field::Kick(field) => meant(&mut machine.kicks, member).map(field).collect(),
            Field::Machine(field) => vec![field(machine)],
            Field::OfMachine { number, following, .. } => {
                let value = following(machine);
                vec![number(machine).get_or_insert(value)]
            }
            Field::Contact(field) => machine.contact.as_mut().map(field).into_iter().collect(),
            Field::OfBall { number, following, .. } => {
                let of_ball = |ball: &'a mut Ball| {
                    let value = following(ball);
                    number(ball).get_or_insert(value)
                };
                meant(&mut machine.balls, member).map(of_ball).collect()
            }
            Field::Ball(field) => meant(&mut machine.balls, member).map(field).collect(),
            _ => Vec::new(),
        }
    }
}

/// Returns all members, or one of them, counted from 1.
fn meant<T>(all: impl IntoIterator<Item = T>, member: Option<usize>) -> impl Iterator<Item = T> {
    let numbered = (1..).zip(all);
    numbered.filter(move |(number, _)| member.is_none_or(|own| own == *number)).map(|(_, one)| one)
}

/// Returns the name of one member's own value of a parameter with a unit.
pub(super) fn member_name(general: &str, unit: &str, number: usize) -> String {
    let ending = unit_ending(unit);
    match general.strip_suffix(&*ending) {
        Some(stem) => format!("{stem}_{number}{ending}"),
        None => format!("{general}_{number}"),
    }
}
