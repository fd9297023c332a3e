//! Columns of `responses.parquet`: one row per design and point of the sweep.

use super::respond::Answer;
use crate::classification::Label;
use crate::study::{DesignValue, Study};
use crate::table::column::{Column, Columns};
use crate::table::{add_estimate, add_swept};

/// Returns the answer of a row.
pub(super) type OfRow<R> = fn(&R) -> &Answer;

/// Returns the columns of `responses.parquet`.
pub fn response_columns(study: &Study) -> Vec<Column<Answer>> {
    let mut list = Columns::<Answer>::new();
    list.extend(answer_columns(study, |row: &Answer| row));
    list.boolean("discontinuous", |row| row.discontinuous).meaning(
        "whether the fractions of labels differ from those of a nearest other design (all tests of \
         a table together err with 1 %)",
    );
    list.finish()
}

/// Returns the columns of an answer, for any type of row that contains one.
pub(crate) fn answer_columns<R: 'static>(study: &Study, of: OfRow<R>) -> Vec<Column<R>> {
    let mut list = Columns::new();
    list.count("design", move |row| of(row).design)
        .meaning("number of the design, from 0 in the order of the table of designs");
    add_variables(&mut list, study, move |row| of(row).values.as_slice());
    list.count("point_id", move |row| of(row).point_id)
        .meaning("number of the sweep's point, from 0");
    add_swept(&mut list, study, move |row| &of(row).swept);
    for (index, response) in study.responses().iter().enumerate() {
        let (name, unit, meaning) = (&response.name, response.unit(), response.meaning());
        add_estimate(&mut list, name, unit, &meaning, move |row| of(row).estimates.get(index));
    }
    list.count("runs", move |row| of(row).counts.total())
        .meaning("runs of the design at the point");
    for label in Label::ALL {
        list.count(label.name(), move |row| of(row).counts.of(label)).meaning(match label {
            Label::Failed => "runs that failed".to_owned(),
            _ => format!("runs that ended as {}", label.name()),
        });
    }
    list.finish()
}

/// Adds one column per variable of a design.
pub(crate) fn add_variables<R: 'static>(
    list: &mut Columns<R>,
    study: &Study,
    of: impl Fn(&R) -> &[DesignValue] + Copy + Send + Sync + 'static,
) {
    for (index, variable) in study.variables().iter().enumerate() {
        let column = match variable.unit() {
            Some(unit) => {
                list.number(variable.name(), unit, move |row| match of(row).get(index)? {
                    DesignValue::Number(number) => Some(*number),
                    DesignValue::Choice(_) => None,
                })
            }
            None => {
                let copy = variable.clone();
                list.text(variable.name(), move |row| Some(copy.describe(*of(row).get(index)?)))
            }
        };
        column.meaning(variable.meaning());
    }
}
