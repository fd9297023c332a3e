//! Variables of a design, and the study with the values of a design.

use super::error::{Fault, list_names, shorten};
use super::node::describe_number;
use super::parameter::{Parameter, ParameterValue};
use super::plan::Study;

/// A variable of a design.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    pub(super) name: String,
    pub(super) domain: Domain,
}

/// The values that a variable accepts.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Domain {
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
        match &self.domain {
            Domain::Parameter { parameter, .. } => Some(parameter.unit()),
            Domain::Balls { .. } => Some("1"),
            Domain::Choices(_) => None,
        }
    }

    /// Returns the meaning.
    pub fn meaning(&self) -> String {
        match &self.domain {
            Domain::Parameter { parameter, .. } => parameter.meaning(),
            Domain::Balls { .. } => "number of balls".to_owned(),
            Domain::Choices(_) => "name of a choice".to_owned(),
        }
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

    pub(super) fn ball_numbers(&self) -> Option<std::ops::RangeInclusive<u64>> {
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
    ///
    /// # Errors
    /// Returns an error if the word is not a choice, or if the variable accepts numbers.
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

    /// Returns the name of a choice, or the text of a number.
    pub fn describe(&self, value: DesignValue) -> String {
        match (value, &self.domain) {
            (DesignValue::Choice(index), Domain::Choices(choices)) => {
                choices.get(index).map(|(name, _)| name.clone()).unwrap_or_default()
            }
            (DesignValue::Choice(index), _) => index.to_string(),
            (DesignValue::Number(number), _) => describe_number(number),
        }
    }
}

impl Study {
    /// Returns the coordinates of a design on the scales of [`Variable::scaled`].
    pub fn scaled(&self, values: &[DesignValue]) -> Vec<f64> {
        let each = self.variables.iter().zip(values);
        each.flat_map(|(variable, value)| variable.scaled(*value)).collect()
    }

    /// Sets the variables, one value for each in their order, and returns the study of the design.
    /// Values that are not set are unchanged.
    ///
    /// # Errors
    /// Returns a sentence if the values are physically impossible together.
    pub fn set(&self, values: &[DesignValue]) -> Result<Study, String> {
        self.with_design(values).map_err(|Fault { problem, found, .. }| {
            format!("{problem}: {}", found.unwrap_or_default())
        })
    }

    /// Sets the variables, one value for each in their order, and returns the study of the design.
    /// Start states and random numbers are those of this study, and so are name, hash and resolved
    /// file.
    ///
    /// # Errors
    /// Returns a fault if the values are physically impossible together at a point of the sweep.
    pub(crate) fn with_design(&self, values: &[DesignValue]) -> Result<Study, Fault> {
        let (mut balls, mut set) = (None, Vec::new());
        for (variable, value) in self.variables.iter().zip(values) {
            match (&variable.domain, *value) {
                (Domain::Parameter { parameter, .. }, DesignValue::Number(number)) => {
                    set.push((*parameter, number));
                }
                (Domain::Balls { from, .. }, DesignValue::Number(number)) => {
                    balls = usize::try_from(number as u64 - from).ok();
                }
                (Domain::Choices(choices), DesignValue::Choice(index)) => {
                    set.extend(choices.get(index).into_iter().flat_map(|(_, values)| values));
                }
                // `number` and `word` return the kind of value that belongs to the variable.
                _ => {}
            }
        }
        let mut study = balls.and_then(|index| self.by_balls.get(index)).unwrap_or(self).clone();
        set.sort_by_key(|(parameter, _)| parameter.general().is_some());
        for (parameter, number) in set {
            parameter.set(&mut study.base.model, ParameterValue::Number(number));
            parameter.set_general(&mut study.base.general, number);
        }
        for point_id in 0..study.point_count().min(MOST_POINTS) {
            study.point(point_id).model().validate().map_err(|invalid| {
                let found = format!("{} {} at point {point_id}", invalid.name, invalid.found);
                Fault::new("no physical meaning", found, invalid.allowed)
            })?;
        }
        Ok(study)
    }
}

/// The largest number of points that are checked; in a larger sweep, the runs of an impossible
/// point fail.
const MOST_POINTS: u64 = 1000;

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{DesignValue, Parameter, ParameterValue, Study};
    use crate::model::Ball;

    fn parse(text: &str) -> Study {
        Study::parse(Path::new("a.yaml"), text.to_owned()).unwrap_or_else(|error| panic!("{error}"))
    }

    /// Every numeric parameter of every model and friction law can be a variable, and a design has
    /// the cases of a sweep over the same value.
    #[test]
    fn every_numeric_parameter_can_be_a_variable() {
        let (mut tried, mut refused) = (0, 0);
        for (kind, speed) in
            [("ball_balancer", "rad_s"), ("block_on_spring", "m_s"), ("block_on_belt", "m_s")]
        {
            for friction in [
                "coulomb".to_owned(),
                format!(
                    "{{stribeck: {{static_friction_coefficient: 0.5, stribeck_speed_{speed}: 1}}}}"
                ),
                format!("{{smooth: {{smoothing_speed_{speed}: 0.01}}}}"),
                "{viscous: {viscous_coefficient_n_s_m: 0.01}}".to_owned(),
            ] {
                let plain = format!(
                    "schema: 1\nname: a\nseed: 1\nmodel: {{kind: {kind}, friction: {friction}}}\n\
                     initial_conditions: {{design: {{monte_carlo: {{samples: 4}}}}}}\n"
                );
                let study = parse(&plain);
                for parameter in Parameter::all(study.model()) {
                    let ParameterValue::Number(number) =
                        parameter.get(study.model(), &Ball::default())
                    else {
                        continue;
                    };
                    let name = parameter.name();
                    let other = if number == 0.0 { 0.1 } else { 1.25 * number };
                    let (from, to) = (number.min(other), number.max(other));
                    let design = format!("{plain}design: {{{name}: {{from: {from}, to: {to}}}}}\n");
                    if parameter.is_unused(study.model()) {
                        let error = Study::parse(Path::new("a.yaml"), design).unwrap_err();
                        assert!(error.problem().contains("does not use it"), "{error}");
                        refused += 1;
                        continue;
                    }
                    let set = parse(&design).set(&[DesignValue::Number(other)]).unwrap();
                    let swept =
                        parse(&format!("{plain}sweep: [{{grid: {{{name}: [{other}]}}}}]\n"));
                    for run in 0..4 {
                        let [set, swept] = [&set, &swept].map(|study| study.planned_run(run));
                        let place = format!("{name} of {kind}, {friction}, run {run}");
                        assert_eq!((&set.case, &set.start), (&swept.case, &swept.start), "{place}");
                        assert_ne!(set.case, study.planned_run(run).case, "{place}");
                    }
                    tried += 1;
                }
            }
        }
        // A balancer with two balls has 16 parameters and the blocks have 4 and 5; the friction
        // laws add 0, 2, 1 and 1. Viscous friction does not use three parameters of the balls and
        // one of each block.
        assert_eq!((tried, refused), (4 * (16 + 4 + 5) + 3 * 4 - 5, 5));
    }
}
