//! The model at a point of the sweep, with its uncertain parameters at quantiles of their distributions.

use crate::model::{InvalidParameter, Model};
use crate::study::plan::parameter::ParameterValue;
use crate::study::plan::planned_runs::Plan;

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
