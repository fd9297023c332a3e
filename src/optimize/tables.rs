//! Columns of `finalists.parquet`, `pareto.parquet` and `sensitivities.parquet`.

use super::finalists::{Finalist, FinalistRole};
use super::goal::Goal;
use super::sensitivity::Sensitivity;
use crate::responses::Answer;
use crate::responses::columns::{add_variables, answer_columns};
use crate::study::{Optimization, Study};
use crate::table::add_estimate;
use crate::table::column::{Column, Columns};

/// Returns the columns of `finalists.parquet`: one row per design of the finalists and point of the sweep. `design` is
/// null if the search did not evaluate the design.
pub fn finalist_columns(study: &Study) -> Vec<Column<(FinalistRole, Answer)>> {
    let mut list = Columns::<(FinalistRole, Answer)>::new();
    list.word("role", |row| row.0.name()).meaning(
        "what the design is: finalist, best, pareto or compare_with; all roles but pareto and \
         finalist have runs of their own",
    );
    list.extend(answer_columns(study, |row: &(FinalistRole, Answer)| &row.1));
    list.finish()
}

/// Returns the columns of `pareto.parquet`: one row per design of the search's Pareto front, with the estimates of its
/// final runs over all points of the sweep.
pub fn pareto_columns(study: &Study, optimization: &Optimization) -> Vec<Column<Finalist>> {
    let mut list = Columns::<Finalist>::new();
    list.count("design", |row| row.design).meaning("number of the design in the search");
    add_variables(&mut list, study, |row: &Finalist| row.values.as_slice());
    for (place, quantity) in Goal::new(study, optimization).quantities.iter().enumerate() {
        let Some(response) = study.responses().get(quantity.response) else { continue };
        let (name, unit) = (&response.name, response.unit());
        // A response has several quantities if different points are its worst.
        if !list.contains(name) {
            let meaning = format!("{} over all points", response.meaning());
            add_estimate(&mut list, name, unit, &meaning, move |row: &Finalist| {
                row.estimates.get(place)
            });
        }
    }
    list.boolean("met", |row| row.met).meaning("whether all limits are met");
    list.boolean("on_front", |row| row.on_front)
        .meaning("whether it is also on the Pareto front of these runs");
    list.finish()
}

/// Returns the columns of `sensitivities.parquet`: one row per response and variable.
pub fn sensitivity_columns() -> Vec<Column<Sensitivity>> {
    let mut list = Columns::<Sensitivity>::new();
    list.text("response", |row| row.response.clone()).meaning("name of the response");
    list.text("variable", |row| row.variable.clone()).meaning("name of the variable");
    list.word("source", |row| row.from.name()).meaning(
        "where responses were taken from: runs of new designs, or the search's surrogates",
    );
    list.count("samples", |row| row.samples).meaning("base samples");
    let mut number = |name: &str, meaning: &str, of: fn(&super::Indices) -> Option<f64>| {
        list.number(name, "1", move |row| row.indices.as_ref().and_then(of)).meaning(meaning);
    };
    let low = "lower end of its 95 % interval, null from surrogates";
    let high = "upper end of its 95 % interval, null from surrogates";
    number("first_order", "fraction of the variance that the variable alone explains", |indices| {
        Some(indices.first_order)
    });
    number("first_order_low", low, |indices| indices.first_order_interval.map(|ends| ends[0]));
    number("first_order_high", high, |indices| indices.first_order_interval.map(|ends| ends[1]));
    number(
        "total",
        "fraction of the variance that remains if all other variables are known",
        |indices| Some(indices.total),
    );
    number("total_low", low, |indices| indices.total_interval.map(|ends| ends[0]));
    number("total_high", high, |indices| indices.total_interval.map(|ends| ends[1]));
    list.text("reason", |row| row.reason.clone())
        .meaning("why indices or their intervals are missing");
    list.finish()
}
