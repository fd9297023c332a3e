//! The designs of a study: their variables, and the plan of the study for given values of the variables.

use crate::study::error::Fault;
use crate::study::plan::parameter::ParameterValue;
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::variable::{DesignValue, Domain, Variable};

/// The largest number of points that are checked; in a larger sweep, the runs of an impossible
/// point fail.
const MAX_CHECKED_POINTS: u64 = 1000;

/// What designs set.
#[derive(Clone, Debug)]
pub(in crate::study) struct Designs {
    /// The variables.
    pub variables: Vec<Variable>,
    /// The plan for each number of balls that a design may have, in ascending order; none if designs do not vary the
    /// number of balls.
    pub by_balls: Vec<Plan>,
}

impl Designs {
    /// Sets the variables, one value for each in their order, in a plan and returns the plan of the design. Start states
    /// and random numbers are those of the given plan.
    pub fn set(&self, plan: &Plan, values: &[DesignValue]) -> Result<Plan, Fault> {
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
        let mut plan = balls.and_then(|index| self.by_balls.get(index)).unwrap_or(plan).clone();
        set.sort_by_key(|(parameter, _)| parameter.general().is_some());
        for (parameter, number) in set {
            parameter.set(&mut plan.base.model, ParameterValue::Number(number));
            parameter.set_general(&mut plan.base.general, number);
        }
        for point_id in 0..plan.point_count().min(MAX_CHECKED_POINTS) {
            plan.point(point_id).model().validate().map_err(|invalid| {
                let found = format!("{} {} at point {point_id}", invalid.name, invalid.found);
                Fault::new("no physical meaning", found, invalid.allowed)
            })?;
        }
        Ok(plan)
    }
}
