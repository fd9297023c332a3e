//! Variables of a design, and the study with the values of a design.

use std::ops::Deref;

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::error::{Fault, describe_number, list_names, shorten};
use crate::study::file::schema_parts as schema;
use crate::study::plan::parameter::{Parameter, VariedParameter};
use crate::study::plan::units::six_digits;

/// A variable of a design: either `from` and `to`, or `choices`.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct VariableFile {
    /// Smallest value, in the unit of the parameter.
    pub from: Option<f64>,
    /// Largest value, in the unit of the parameter; at least `from`.
    pub to: Option<f64>,
    /// Choices by name; each choice sets the same numeric parameters.
    #[serde(default)]
    #[schemars(schema_with = "schema::choices")]
    pub choices: Option<IndexMap<String, IndexMap<String, f64>>>,
}

/// A variable of a design.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// The name, unit and meaning of the values.
    pub(in crate::study) column: VariedParameter,
    pub(in crate::study) domain: Domain,
}

/// Names, units and numbers as people read them are those of a column.
impl Deref for Variable {
    type Target = VariedParameter;

    fn deref(&self) -> &VariedParameter {
        &self.column
    }
}

/// The values that a variable accepts.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::study) enum Domain {
    /// A parameter within a range.
    Parameter { parameter: Parameter, from: f64, to: f64 },
    /// The number of balls.
    Balls { from: u64, to: u64 },
    /// Several parameters together, by the name of the choice.
    Choices(Vec<(String, Vec<(Parameter, f64)>)>),
}

/// The value of a variable, within its range or one of its choices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DesignValue {
    /// A number within the range.
    Number(f64),
    /// The index of a choice, from zero.
    Choice(usize),
}

/// The values that a variable accepts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Values {
    /// All numbers of a closed interval.
    Numbers(f64, f64),
    /// The integers of a closed interval.
    Whole(u64, u64),
    /// The number of choices.
    Choices(usize),
}

impl Variable {
    /// Returns the accepted values.
    pub fn values(&self) -> Values {
        match &self.domain {
            Domain::Parameter { from, to, .. } => Values::Numbers(*from, *to),
            Domain::Balls { from, to } => Values::Whole(*from, *to),
            Domain::Choices(choices) => Values::Choices(choices.len()),
        }
    }

    /// Returns the name, as in the study file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the unit: `1` for a number of balls, `None` for choices.
    pub fn unit(&self) -> Option<&'static str> {
        Some(self.column.unit).filter(|unit| !unit.is_empty())
    }

    /// Returns the name with the unit in which people read the values, such as `speed [rpm]`.
    pub fn shown_name(&self) -> String {
        match self.shown_unit() {
            "" => self.name.clone(),
            unit => format!("{} [{unit}]", self.short_name()),
        }
    }

    /// Returns a value in words, such as `speed_rad_s 300`, `speed 3000 rpm` or `material steel`.
    pub fn in_words(&self, value: DesignValue) -> String {
        let (name, unit) = self.name_and_unit();
        format!("{name} {} {unit}", self.describe(value)).trim_end().to_owned()
    }

    /// Returns the name without a unit and the unit that the study chooses, or the whole name and no unit.
    pub fn name_and_unit(&self) -> (String, &str) {
        match &self.shown {
            Some(unit) => (self.short_name(), &unit.symbol),
            None => (self.name.clone(), ""),
        }
    }

    /// Returns the meaning.
    pub fn meaning(&self) -> String {
        self.column.meaning.clone()
    }

    /// Returns the smallest and the largest value, or `None` for choices.
    pub fn range(&self) -> Option<[f64; 2]> {
        match self.domain {
            Domain::Parameter { from, to, .. } => Some([from, to]),
            Domain::Balls { from, to } => Some([from as f64, to as f64]),
            Domain::Choices(_) => None,
        }
    }

    /// Returns whether the values are integers.
    pub fn is_whole(&self) -> bool {
        matches!(self.domain, Domain::Balls { .. })
    }

    /// Returns the names of the choices, if the variable has choices.
    pub fn choices(&self) -> Option<impl Iterator<Item = &str>> {
        match &self.domain {
            Domain::Choices(choices) => Some(choices.iter().map(|(name, _)| name.as_str())),
            _ => None,
        }
    }

    /// Returns whether the variable sets the parameter of this name.
    pub(in crate::study) fn sets(&self, name: &str) -> bool {
        match &self.domain {
            Domain::Parameter { parameter, .. } => parameter.name() == name,
            Domain::Balls { .. } => name == "balls",
            Domain::Choices(choices) => {
                let mut set = choices.iter().flat_map(|(_, values)| values);
                set.any(|(parameter, _)| parameter.name() == name)
            }
        }
    }

    pub(in crate::study) fn ball_numbers(&self) -> Option<std::ops::RangeInclusive<u64>> {
        match self.domain {
            Domain::Balls { from, to } => Some(from..=to),
            _ => None,
        }
    }

    /// Describes the accepted values in words.
    pub(crate) fn allowed(&self) -> String {
        match &self.domain {
            Domain::Parameter { parameter, from, to } => {
                let [from, to] = [from, to].map(|end| describe_number(*end));
                match parameter.unit() {
                    "1" => format!("a number from {from} to {to}"),
                    unit => format!("a number from {from} to {to} ({unit})"),
                }
            }
            Domain::Balls { from, to } => format!("a whole number from {from} to {to}"),
            Domain::Choices(choices) => {
                let names: Vec<&str> = choices.iter().map(|(name, _)| name.as_str()).collect();
                format!("one of {}", names.join(", "))
            }
        }
    }

    /// Validates a number as a value of this variable.
    ///
    /// # Errors
    /// Returns an error if the number is out of range, if a number of balls is not an integer, or
    /// if the variable has choices.
    pub(crate) fn number(&self, number: f64) -> Result<DesignValue, Fault> {
        let problem = match self.domain {
            Domain::Parameter { from, to, .. } if from <= number && number <= to => None,
            Domain::Balls { .. } if number.fract() != 0.0 => Some("not a whole number"),
            Domain::Balls { from, to } if from as f64 <= number && number <= to as f64 => None,
            Domain::Choices(_) => Some("not a choice"),
            _ => Some("out of range"),
        };
        match problem {
            None => Ok(DesignValue::Number(number)),
            Some(problem) => Err(Fault::new(problem, describe_number(number), self.allowed())),
        }
    }

    /// Validates a word as a value of this variable.
    pub(crate) fn word(&self, word: &str) -> Result<DesignValue, Fault> {
        let Domain::Choices(choices) = &self.domain else {
            let found = format!("text {:?}", shorten(word));
            return Err(Fault::new("not a number", found, self.allowed()));
        };
        choices.iter().position(|(name, _)| name == word).map(DesignValue::Choice).ok_or_else(
            || {
                let names: Vec<&str> = choices.iter().map(|(name, _)| name.as_str()).collect();
                Fault::new("not a choice", shorten(word), list_names(word, &names))
            },
        )
    }

    /// Scales a value such that the range has width 1 and any two choices have distance 1.
    pub fn scaled(&self, value: DesignValue) -> Vec<f64> {
        let number = |from: f64, width: f64| match value {
            DesignValue::Number(number) if width > 0.0 => vec![(number - from) / width],
            _ => vec![0.0],
        };
        match &self.domain {
            Domain::Parameter { from, to, .. } => number(*from, to - from),
            Domain::Balls { from, to } => number(*from as f64, (to - from) as f64),
            Domain::Choices(choices) => {
                let is = |index| value == DesignValue::Choice(index);
                let side = std::f64::consts::FRAC_1_SQRT_2;
                (0..choices.len()).map(|index| if is(index) { side } else { 0.0 }).collect()
            }
        }
    }

    /// Returns the name of a choice, or the text of a number in the unit in which people read it.
    pub fn describe(&self, value: DesignValue) -> String {
        match (value, &self.domain) {
            (DesignValue::Choice(index), Domain::Choices(choices)) => {
                choices.get(index).map(|(name, _)| name.clone()).unwrap_or_default()
            }
            (DesignValue::Choice(index), _) => index.to_string(),
            (DesignValue::Number(number), _) => six_digits(self.shown_number(number)),
        }
    }
}
