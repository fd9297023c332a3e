//! Columns of `posterior.parquet`, `parameter_sets.parquet` and `fit.parquet`.

use super::fit_test::SiteFit;
use super::likelihood::LogLikelihood;
use crate::responses::columns::add_variables;
use crate::study::{DesignValue, ParameterValue, Study};
use crate::table::column::{Column, Columns};

/// A row of `parameter_sets.parquet`: number, values and log-likelihood of a parameter set.
type SetRow = (u64, Vec<DesignValue>, LogLikelihood);

/// Returns the columns of `posterior.parquet`: one row per sample.
pub fn posterior_columns(study: &Study) -> Vec<Column<Vec<f64>>> {
    let mut list = Columns::<Vec<f64>>::new();
    for (index, parameter) in study.variables().iter().enumerate() {
        let value = move |row: &Vec<f64>| row.get(index).copied();
        list.number(parameter.name(), parameter.unit().unwrap_or("1"), value)
            .meaning(parameter.meaning());
    }
    list.finish()
}

/// Returns the columns of `parameter_sets.parquet`: one row per parameter set.
pub fn evaluated_set_columns(study: &Study, start_designs: u64) -> Vec<Column<SetRow>> {
    let mut list = Columns::<SetRow>::new();
    list.count("parameter_set", |row| row.0).meaning("number of the parameter set, from 0");
    list.word("origin", move |row| if row.0 < start_designs { "prior" } else { "posterior" })
        .meaning("whether the set fills the prior, or lies where the posterior is");
    add_variables(&mut list, study, |row: &SetRow| row.1.as_slice());
    list.number("log_likelihood", "1", |row| row.2.value)
        .meaning("log-likelihood of all measured runs, up to a constant");
    list.number("log_likelihood_std_error", "1", |row| row.2.variance.sqrt())
        .meaning("its standard error, which comes from the number of simulated runs");
    list.finish()
}

/// Returns the columns of `fit.parquet`: one row per point and stage with measured runs.
pub fn fit_columns(study: &Study) -> Vec<Column<SiteFit>> {
    let mut list = Columns::<SiteFit>::new();
    list.count("point_id", |row| row.point_id).meaning("number of the point of the sweep");
    for (index, parameter) in study.swept().iter().enumerate() {
        let points: Vec<ParameterValue> = (0..study.point_count())
            .filter_map(|one| study.point(one).swept.get(index).copied())
            .collect();
        let value = move |row: &SiteFit| match points.get(usize::try_from(row.point_id).ok()?) {
            Some(ParameterValue::Number(number)) => Some(*number),
            _ => None,
        };
        list.number(&parameter.name, parameter.unit, value).meaning(parameter.meaning.clone());
    }
    list.count("stage", |row| row.stage).meaning("number of the stage, from 1");
    list.count("measured_rests", |row| row.measured[0]).meaning("measured runs that rest");
    list.count("measured_moving", |row| row.measured[1]).meaning("measured runs that move");
    list.number("predicted_rest_fraction", "1", |row| row.predicted_rest_fraction)
        .meaning("fraction of the runs of the posterior predictive distribution that rest");
    list.number("p_positions", "1", |row| row.p_positions).meaning(
        "probability of an energy distance between measured and predicted positions that is at least as large",
    );
    list.number("p_neighbours", "1", |row| row.p_neighbours)
        .meaning("the same for the angles between neighbouring balls; null for one ball");
    list.number("p_value", "1", |row| row.p_value())
        .meaning("the smaller of both probabilities, corrected for two tests (Bonferroni)");
    list.finish()
}
