//! The values that a run draws for the uncertain parameters.

use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::sweep::PointSampling;
use crate::study::sampling::distribution::Distribution;
use crate::study::sampling::draw::DrawKey;

/// A parameter that is drawn for each run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Uncertain {
    /// The parameter.
    pub parameter: Parameter,
    /// The distribution of the value, or of a factor.
    pub distribution: Distribution,
    /// Whether the draw is a factor that multiplies the nominal value.
    pub factor: bool,
    /// The key of the random numbers.
    pub key: DrawKey,
}

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
            .map(|(place, one)| point.uncertain_design.fraction(place, &one.key, id, sample))
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
        let draw = |(one, fraction): (&Uncertain, &f64)| {
            let drawn = one.distribution.quantile(*fraction);
            if !one.factor {
                return drawn;
            }
            let own = set.iter().find(|(parameter, _)| *parameter == one.parameter);
            let own = own.map_or_else(
                || one.parameter.get(&self.base.model, &self.base.general),
                |(_, value)| *value,
            );
            match own {
                ParameterValue::Number(own) => own * drawn,
                ParameterValue::Text(_) => drawn,
            }
        };
        self.uncertain_parameters.iter().zip(fractions).map(draw).collect()
    }
}
