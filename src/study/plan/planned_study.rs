//! A study: the plan of its runs, with the expectations, responses, designs, search and inference that it requests.

use std::ops::Deref;

use crate::study::error::Fault;
use crate::study::plan::expectation::Expectation;
use crate::study::plan::parameter::ParameterValue;
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::response::Response;
use crate::study::plan::searches::{Identification, Optimization};
use crate::study::plan::variable::{DesignValue, Domain, Variable};

/// A validated study with every default filled in; it is immutable.
///
/// It gives all that its [`Plan`] gives, such as points and runs.
#[derive(Clone, Debug)]
pub struct Study {
    pub(in crate::study) plan: Plan,
    pub(in crate::study) expectations: Vec<Expectation>,
    pub(in crate::study) responses: Vec<Response>,
    pub(in crate::study) designs: Designs,
    pub(in crate::study) optimization: Option<Optimization>,
    pub(in crate::study) identification: Option<Identification>,
}

impl Deref for Study {
    type Target = Plan;

    fn deref(&self) -> &Plan {
        &self.plan
    }
}

impl Study {
    /// Returns the expectations of the study.
    pub fn expectations(&self) -> &[Expectation] {
        &self.expectations
    }

    /// Returns the variables of designs.
    pub fn variables(&self) -> &[Variable] {
        &self.designs.variables
    }

    /// Returns the responses of designs.
    pub fn responses(&self) -> &[Response] {
        &self.responses
    }

    /// Returns the settings of the optimisation, if there are any.
    pub fn optimization(&self) -> Option<&Optimization> {
        self.optimization.as_ref()
    }

    /// Returns this study with the parameters of `identify` as the variables of its designs, if it has this key. Runs, name
    /// and hash are those of this study.
    pub fn for_identification(&self) -> Option<(Study, Identification)> {
        let identification = self.identification.clone()?;
        let designs =
            Designs { variables: identification.parameters.clone(), by_balls: Vec::new() };
        Some((Study { designs, ..self.clone() }, identification))
    }

    /// Returns the largest number of runs of a design, over all points together.
    pub fn most_runs_of_a_design(&self) -> u64 {
        self.by_number_of_balls().iter().map(Plan::run_count).max().unwrap_or(0)
    }

    /// Returns the plan for each number of balls that a design may have, or the plan of this study alone if all designs
    /// have the same number.
    pub fn by_number_of_balls(&self) -> &[Plan] {
        match self.designs.by_balls.as_slice() {
            [] => std::slice::from_ref(&self.plan),
            plans => plans,
        }
    }

    /// Returns the coordinates of a design on the scales of [`Variable::scaled`].
    pub fn scaled(&self, values: &[DesignValue]) -> Vec<f64> {
        let each = self.variables().iter().zip(values);
        each.flat_map(|(variable, value)| variable.scaled(*value)).collect()
    }

    /// Sets the variables, one value for each in their order, and returns the plan of the design.
    /// Values that are not set are unchanged.
    ///
    /// # Errors
    /// Returns a sentence if the values are physically impossible together.
    pub fn set(&self, values: &[DesignValue]) -> Result<Plan, String> {
        self.with_design(values).map_err(|Fault { problem, found, .. }| {
            format!("{problem}: {}", found.unwrap_or_default())
        })
    }

    /// Returns this study with the plan of a design.
    ///
    /// # Errors
    /// Returns those of [`Study::set`].
    pub fn of_design(&self, values: &[DesignValue]) -> Result<Study, String> {
        Ok(Study { plan: self.set(values)?, ..self.clone() })
    }

    /// Sets the variables like [`Study::set`].
    pub(crate) fn with_design(&self, values: &[DesignValue]) -> Result<Plan, Fault> {
        self.designs.set(&self.plan, values)
    }
}

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
