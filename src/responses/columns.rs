//! Columns of `responses.parquet`: one row per design and point of the sweep.

use super::estimate::Estimate;
use super::respond::Answer;
use crate::classification::Label;
use crate::study::{DesignValue, ParameterKind, ParameterValue, Study};
use crate::table::column::Column;

/// Returns the answer of a row.
pub(super) type OfRow<R> = fn(&R) -> &Answer;

/// Returns the columns of `responses.parquet`.
pub fn response_columns(study: &Study) -> Vec<Column<Answer>> {
    let mut columns = answer_columns(study, |row: &Answer| row);
    columns.push(Column::truth(
        "discontinuous",
        "whether the fractions of labels differ from those of a nearest other design (all tests of a \
         table together err with 1 %)",
        |row: &Answer| row.discontinuous,
    ));
    columns
}

/// Returns the columns of an answer, for any type of row that contains one.
pub(crate) fn answer_columns<R: 'static>(study: &Study, of: OfRow<R>) -> Vec<Column<R>> {
    let mut columns = vec![Column::count(
        "design",
        "number of the design, from 0 in the order of the table of designs",
        move |row| Some(of(row).design),
    )];
    columns.extend(variable_columns(study, move |row: &R| of(row).values.as_slice()));
    columns.push(Column::count("point_id", "number of the sweep's point, from 0", move |row| {
        Some(of(row).point_id)
    }));
    columns.extend(swept_columns(study, of));
    for (index, response) in study.responses().iter().enumerate() {
        let (name, unit, meaning) = (&response.name, response.unit(), response.meaning());
        columns.extend(estimate_columns(name, unit, &meaning, move |row: &R| {
            of(row).estimates.get(index)
        }));
    }
    columns.push(Column::count("runs", "runs of the design at the point", move |row| {
        Some(of(row).counts.total())
    }));
    for label in Label::ALL {
        let meaning = match label {
            Label::Failed => "runs that failed".to_owned(),
            _ => format!("runs that ended as {}", label.name()),
        };
        columns
            .push(Column::count(label.name(), &meaning, move |row| Some(of(row).counts.of(label))));
    }
    columns
}

/// Returns the columns of an estimate: value, standard error, interval, and the reason for missing values.
pub(crate) fn estimate_columns<R: 'static>(
    name: &str,
    unit: &str,
    meaning: &str,
    of: impl Fn(&R) -> Option<&Estimate> + Copy + Send + Sync + 'static,
) -> Vec<Column<R>> {
    let number = |suffix: &str, meaning: &str, part: fn(&Estimate) -> Option<f64>| {
        Column::number(&format!("{name}{suffix}"), unit, meaning, move |row| of(row).and_then(part))
    };
    vec![
        number("", meaning, |estimate| estimate.value),
        number("_standard_error", "its standard error", |estimate| estimate.standard_error),
        number("_low", "lower end of its 95 % interval", |estimate| estimate.low),
        number("_high", "upper end of its 95 % interval", |estimate| estimate.high),
        Column::text(&format!("{name}_reason"), "why one of these values is missing", move |row| {
            Some(of(row)?.reason.as_ref()?.to_string())
        }),
    ]
}

/// Returns one column per variable of a design.
pub(crate) fn variable_columns<R: 'static>(
    study: &Study,
    of: impl Fn(&R) -> &[DesignValue] + Copy + Send + Sync + 'static,
) -> Vec<Column<R>> {
    let column = |(index, variable): (usize, &crate::study::Variable)| match variable.unit() {
        Some(unit) => Column::number(variable.name(), unit, &variable.meaning(), move |row: &R| {
            match of(row).get(index)? {
                DesignValue::Number(number) => Some(*number),
                DesignValue::Choice(_) => None,
            }
        }),
        None => {
            let own = variable.clone();
            Column::text(variable.name(), &variable.meaning(), move |row: &R| {
                Some(own.describe(*of(row).get(index)?))
            })
        }
    };
    study.variables().iter().enumerate().map(column).collect()
}

fn swept_columns<R: 'static>(study: &Study, of: OfRow<R>) -> Vec<Column<R>> {
    let column = |(index, swept): (usize, &crate::study::VariedParameter)| match swept.kind {
        ParameterKind::Number => {
            Column::number(&swept.name, swept.unit, &swept.meaning, move |row: &R| {
                match of(row).swept.get(index)? {
                    ParameterValue::Number(number) => Some(*number),
                    ParameterValue::Text(_) => None,
                }
            })
        }
        ParameterKind::Text => {
            Column::optional_word(&swept.name, &swept.meaning, move |row: &R| {
                match of(row).swept.get(index)? {
                    ParameterValue::Number(_) => None,
                    ParameterValue::Text(text) => Some(*text),
                }
            })
        }
    };
    study.swept().iter().enumerate().map(column).collect()
}
