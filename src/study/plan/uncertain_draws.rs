//! The values that a run draws for the uncertain parameters.

use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::sweep::PointSampling;
use crate::study::plan::uncertain_parameter::UncertainParameter;

impl Plan {
    /// Returns the design of the uncertain parameters and the number of their rank correlations; `None` if all draws are
    /// independent.
    pub fn uncertain_sampling(&self) -> Option<(&'static str, usize)> {
        let file = self.resolved.file.uncertain_sampling.as_ref()?;
        let correlations = file.correlations.as_ref().map_or(0, Vec::len);
        Some((file.design.unwrap_or_default().name(), correlations))
    }

    /// Returns the fraction of each uncertain parameter's distribution at which a run draws it; `sample` counts the runs
    /// of the point from zero.
    pub(in crate::study) fn drawn_fractions(&self, point: &PointSampling, sample: u64) -> Vec<f64> {
        let id = point.design.identify(sample);
        let each = self.uncertain_parameters.iter().enumerate();
        let fractions: Vec<f64> = each
            .map(|(place, draw)| point.uncertain_design.fraction(place, &draw.key, id, sample))
            .collect();
        match &self.copula {
            Some(copula) => copula.correlate(&fractions),
            None => fractions,
        }
    }

    /// Returns the value of each uncertain parameter at the quantile of its fraction, at a point with the swept values
    /// `set`.
    pub(in crate::study) fn drawn(
        &self,
        set: &[(Parameter, ParameterValue)],
        fractions: &[f64],
    ) -> Vec<f64> {
        let draw = |(uncertain, fraction): (&UncertainParameter, &f64)| {
            let drawn = uncertain.distribution.quantile(*fraction);
            if !uncertain.factor {
                return drawn;
            }
            let given = set.iter().find(|(parameter, _)| *parameter == uncertain.parameter);
            let value = given.map_or_else(
                || uncertain.parameter.get(&self.base.model, &self.base.general),
                |(_, value)| *value,
            );
            match value {
                ParameterValue::Number(number) => number * drawn,
                ParameterValue::Text(_) => drawn,
            }
        };
        self.uncertain_parameters.iter().zip(fractions).map(draw).collect()
    }
}
