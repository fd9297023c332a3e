//! The validated key `identify` of a study.

use crate::study::plan::planned_study::Study;
use crate::study::plan::variable::Variable;

/// What is to be inferred from measurements, and the effort.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The parameters with the ranges of their priors.
    pub parameters: Vec<Variable>,
    /// Number of parameter sets in the initial space-filling sample.
    pub start_designs: u64,
    /// Number of parameter sets in total.
    pub designs: u64,
    /// Number of samples of the posterior.
    pub posterior_samples: u64,
}

impl Study {
    /// Returns this study with the parameters of `identify` as the variables of its designs, if it has this key. Runs, name
    /// and hash are those of this study.
    pub fn for_identification(&self) -> Option<(Study, Identification)> {
        let identification = self.identification.clone()?;
        let variables = identification.parameters.clone();
        Some((Study { variables, by_balls: Vec::new(), ..self.clone() }, identification))
    }
}
