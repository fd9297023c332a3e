//! The columns of an estimate: value, standard error, 95 % interval, and the reason for missing values.

use super::column::Columns;
use super::row::Row;
use crate::analysis::Estimate;

/// The numbers of an estimate: the end of the column's name, its meaning, and the number.
type Part = (&'static str, &'static str, fn(&Estimate) -> Option<f64>);

const PARTS: [Part; 4] = [
    ("", "", |estimate| estimate.value),
    ("_standard_error", "standard error of", |estimate| estimate.standard_error),
    ("_low", "lower end of the 95 % interval of", |estimate| estimate.low),
    ("_high", "upper end of the 95 % interval of", |estimate| estimate.high),
];

const REASON: &str = "_reason";

/// Adds the columns of an estimate; `meaning` is that of its value.
pub(crate) fn add_estimate<R: 'static>(
    list: &mut Columns<R>,
    name: &str,
    unit: &str,
    meaning: &str,
    of: impl Fn(&R) -> Option<&Estimate> + Copy + Send + Sync + 'static,
) {
    for (ending, words, part) in PARTS {
        list.number(format!("{name}{ending}"), unit, move |row| of(row).and_then(part)).meaning(
            match words {
                "" => meaning.to_owned(),
                words => format!("{words} {name}"),
            },
        );
    }
    list.text(format!("{name}{REASON}"), move |row| Some(of(row)?.reason.as_ref()?.to_string()))
        .meaning(format!("why the value, standard error or interval of {name} is missing"));
}

impl Row<'_> {
    /// Returns an estimate.
    pub fn estimate(&self, name: &str) -> Estimate {
        let part = |ending: &str| self.number(&format!("{name}{ending}"));
        let [value, standard_error, low, high] = PARTS.map(|(ending, ..)| part(ending));
        let reason = self.text(&format!("{name}{REASON}")).map(Into::into);
        Estimate { value, standard_error, low, high, reason }
    }
}
