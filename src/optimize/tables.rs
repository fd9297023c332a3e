//! Columns of `finalists.parquet`, `pareto.parquet` and `sensitivities.parquet`.

use super::finalists::{Finalist, FinalistRole};
use super::goal::Goal;
use super::sensitivity::Sensitivity;
use crate::responses::Answer;
use crate::responses::columns::{answer_columns, estimate_columns, variable_columns};
use crate::study::{Optimization, Study};
use crate::table::column::Column;

/// Returns the columns of `finalists.parquet`: one row per design of the finalists and point of the sweep. `design` is
/// null if the search did not evaluate the design.
pub fn finalist_columns(study: &Study) -> Vec<Column<(FinalistRole, Answer)>> {
    let mut columns = answer_columns(study, |row: &(FinalistRole, Answer)| &row.1);
    columns.insert(
        0,
        Column::word(
            "role",
            "what the design is: finalist, best, pareto or compare_with; all roles but pareto and finalist \
             have runs of their own",
            |row: &(FinalistRole, Answer)| row.0.name(),
        ),
    );
    columns
}

/// Returns the columns of `pareto.parquet`: one row per design of the search's Pareto front, with the estimates of its
/// final runs over all points of the sweep.
pub fn pareto_columns(study: &Study, optimization: &Optimization) -> Vec<Column<Finalist>> {
    let mut columns =
        vec![Column::count("design", "number of the design in the search", |row: &Finalist| {
            row.design
        })];
    columns.extend(variable_columns(study, |row: &Finalist| row.values.as_slice()));
    for (place, quantity) in Goal::new(study, optimization).quantities().iter().enumerate() {
        let Some(response) = study.responses().get(quantity.response) else { continue };
        let (name, unit) = (&response.name, response.unit());
        // A response has several quantities if different points are its worst.
        if !columns.iter().any(|column| column.name() == name) {
            let meaning = format!("{} over all points", response.meaning());
            columns.extend(estimate_columns(name, unit, &meaning, move |row: &Finalist| {
                row.estimates.get(place)
            }));
        }
    }
    columns
        .push(Column::truth("met", "whether all limits are met", |row: &Finalist| Some(row.met)));
    columns.push(Column::truth(
        "on_front",
        "whether it is also on the Pareto front of these runs",
        |row: &Finalist| row.on_front,
    ));
    columns
}

/// Returns the columns of `sensitivities.parquet`: one row per response and variable.
pub fn sensitivity_columns() -> Vec<Column<Sensitivity>> {
    let number = |name: &str, meaning: &str, of: fn(&super::Indices) -> Option<f64>| {
        Column::number(name, "1", meaning, move |row: &Sensitivity| {
            row.indices.as_ref().and_then(of)
        })
    };
    vec![
        Column::text("response", "name of the response", |row: &Sensitivity| {
            Some(row.response.clone())
        }),
        Column::text("variable", "name of the variable", |row: &Sensitivity| {
            Some(row.variable.clone())
        }),
        Column::word(
            "source",
            "where responses were taken from: runs of new designs, or the search's surrogates",
            |row: &Sensitivity| row.from.name(),
        ),
        Column::count("samples", "base samples", |row: &Sensitivity| Some(row.samples)),
        number("first_order", "fraction of the variance that the variable alone explains", |one| {
            Some(one.first_order)
        }),
        number("first_order_low", "lower end of its 95 % interval, null from surrogates", |one| {
            one.first_order_interval.map(|ends| ends[0])
        }),
        number("first_order_high", "upper end of its 95 % interval, null from surrogates", |one| {
            one.first_order_interval.map(|ends| ends[1])
        }),
        number(
            "total",
            "fraction of the variance that remains if all other variables are known",
            |one| Some(one.total),
        ),
        number("total_low", "lower end of its 95 % interval, null from surrogates", |one| {
            one.total_interval.map(|ends| ends[0])
        }),
        number("total_high", "upper end of its 95 % interval, null from surrogates", |one| {
            one.total_interval.map(|ends| ends[1])
        }),
        Column::text(
            "reason",
            "why indices or their intervals are missing",
            |row: &Sensitivity| row.reason.clone(),
        ),
    ]
}
