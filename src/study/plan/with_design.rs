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

    use super::{DesignValue, ParameterValue, Study};
    use crate::model::Ball;
    use crate::study::plan::parameter::Parameter;

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
