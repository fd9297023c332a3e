//! `responses.parquet`: one row per design and point of the sweep.

use super::estimate::Estimate;
use super::respond::Answer;
use crate::ending::Label;
use crate::study::{DesignValue, ParameterKind, ParameterValue, Study};
use crate::table::column::Column;

/// The columns of `responses.parquet`.
pub fn response_columns(study: &Study) -> Vec<Column<Answer>> {
    let mut columns = vec![Column::count(
        "design",
        "number of the design, from 0 in the order of the table of designs",
        |row: &Answer| Some(row.design),
    )];
    columns.extend(variable_columns(study));
    columns.push(Column::count(
        "point_id",
        "number of the sweep's point, from 0",
        |row: &Answer| Some(row.point_id),
    ));
    columns.extend(swept_columns(study));
    for (index, response) in study.responses().iter().enumerate() {
        let (name, unit, meaning) = (&response.name, response.unit(), response.meaning());
        let mut number = |suffix: &str, meaning: &str, of: fn(&Estimate) -> Option<f64>| {
            columns.push(Column::number(
                &format!("{name}{suffix}"),
                unit,
                meaning,
                move |row: &Answer| row.estimates.get(index).and_then(of),
            ));
        };
        number("", &meaning, |estimate| estimate.value);
        number("_standard_error", "its standard error", |estimate| estimate.standard_error);
        number("_low", "lower end of its 95 % interval", |estimate| estimate.low);
        number("_high", "upper end of its 95 % interval", |estimate| estimate.high);
        columns.push(Column::text(
            &format!("{name}_reason"),
            "why something of this is missing",
            move |row: &Answer| Some(row.estimates.get(index)?.reason?.to_owned()),
        ));
    }
    columns.push(Column::count("runs", "runs of the design at the point", |row: &Answer| {
        Some(row.counts.total())
    }));
    columns.push(Column::count("failed", "runs that failed", |row: &Answer| {
        Some(row.counts.of(Label::Failed))
    }));
    columns.push(Column::truth(
        "discontinuous",
        "whether the shares of labels differ from those of a nearest other design (all tests of a \
         table together err with 1 %)",
        |row: &Answer| row.discontinuous,
    ));
    columns
}

fn variable_columns(study: &Study) -> Vec<Column<Answer>> {
    let column = |(index, variable): (usize, &crate::study::Variable)| match variable.unit() {
        Some(unit) => Column::number(
            variable.name(),
            unit,
            &variable.meaning(),
            move |row: &Answer| match row.values.get(index)? {
                DesignValue::Number(number) => Some(*number),
                DesignValue::Choice(_) => None,
            },
        ),
        None => {
            let own = variable.clone();
            Column::text(variable.name(), &variable.meaning(), move |row: &Answer| {
                Some(own.describe(*row.values.get(index)?))
            })
        }
    };
    study.variables().iter().enumerate().map(column).collect()
}

fn swept_columns(study: &Study) -> Vec<Column<Answer>> {
    let column = |(index, swept): (usize, &crate::study::VariedParameter)| match swept.kind {
        ParameterKind::Number => {
            Column::number(&swept.name, swept.unit, &swept.meaning, move |row: &Answer| {
                match row.swept.get(index)? {
                    ParameterValue::Number(number) => Some(*number),
                    ParameterValue::Text(_) => None,
                }
            })
        }
        ParameterKind::Text => {
            Column::optional_word(&swept.name, &swept.meaning, move |row: &Answer| {
                match row.swept.get(index)? {
                    ParameterValue::Number(_) => None,
                    ParameterValue::Text(text) => Some(*text),
                }
            })
        }
    };
    study.swept().iter().enumerate().map(column).collect()
}
