//! A study: the plan of its runs, with the expectations, responses, designs, search and inference that it requests.

use std::ops::Deref;

use crate::study::error::Fault;
use crate::study::plan::designs::Designs;
use crate::study::plan::expectation::Expectation;
use crate::study::plan::identification::Identification;
use crate::study::plan::optimization::Optimization;
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::response::Response;
use crate::study::plan::variable::{DesignValue, Variable};

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
