//! The values of the uncertain parameters: those that a run draws, and those at quantiles of their distributions.

use crate::model::{InvalidParameter, Model};
use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::sweep::PointSampling;
use crate::study::plan::uncertain_parameter::UncertainParameter;

impl Plan {
    /// Returns the design of the uncertain parameters and the number of their rank correlations; `None` if all draws are
    /// independent.
    pub fn uncertain_sampling(&self) -> Option<(&'static str, usize)> {
        let file = self.resolved.uncertain_sampling.as_ref()?;
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

impl Plan {
    /// Returns the model at a point, with each uncertain parameter at the quantile of the fraction that `fraction`
    /// returns for its name; the fraction 0.5 gives the median.
    ///
    /// # Errors
    /// Returns the first parameter that is physically impossible, as a median may be.
    ///
    /// # Panics
    /// If `point_id` is not below [`Plan::point_count`].
    pub fn model_at_quantiles(
        &self,
        point_id: u64,
        fraction: impl Fn(&str) -> f64,
    ) -> Result<Model, InvalidParameter> {
        assert!(point_id < self.point_count(), "there is no point {point_id}");
        let block = &self.blocks[self.block_of(point_id)];
        let mut values = block.values(point_id - block.first_point);
        let each = self.uncertain_parameters.iter().map(|draw| fraction(&draw.parameter.name()));
        let drawn = self.drawn(&values, &each.collect::<Vec<f64>>());
        let parameters = self.uncertain_parameters.iter().map(|draw| draw.parameter);
        values.extend(parameters.zip(drawn.into_iter().map(ParameterValue::Number)));
        let model = self.model_with(&values);
        model.validate().map(|()| model)
    }

    /// Returns the model at a point, with each uncertain parameter at its median.
    ///
    /// # Errors
    /// Returns the first parameter that is physically impossible.
    ///
    /// # Panics
    /// If `point_id` is not below [`Plan::point_count`].
    pub fn median_model(&self, point_id: u64) -> Result<Model, InvalidParameter> {
        self.model_at_quantiles(point_id, |_| 0.5)
    }

    /// Returns the index of the block that contains a point.
    pub(in crate::study) fn block_of(&self, point_id: u64) -> usize {
        self.blocks.partition_point(|block| block.first_point <= point_id).saturating_sub(1)
    }
}
