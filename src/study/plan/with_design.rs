//! A study with its design variables set.

use crate::study::error::Fault;
use crate::study::plan::parameter::ParameterValue;
use crate::study::plan::planned_study::Study;
use crate::study::plan::variable::{DesignValue, Domain};

impl Study {
    /// Returns the coordinates of a design on the scales of [`crate::study::Variable::scaled`].
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
        // The copies for the numbers of balls have no variables.
        study.variables.clone_from(&self.variables);
        set.sort_by_key(|(parameter, _)| parameter.general().is_some());
        for (parameter, number) in set {
            parameter.set(&mut study.base.model, ParameterValue::Number(number));
            parameter.set_general(&mut study.base.general, number);
        }
        for point_id in 0..study.point_count().min(MAX_CHECKED_POINTS) {
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
const MAX_CHECKED_POINTS: u64 = 1000;
