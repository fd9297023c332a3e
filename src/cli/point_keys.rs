//! A point of the sweep in messages: the values of its swept parameters.

use crate::study::VariedParameter;

/// Returns the values of the swept parameters for a message, each after a blank, as ` speed_rad_s=-160` or, with a unit
/// that the study chooses, ` speed=-1528 rpm`. The values are those of [`crate::study::Study::shown`].
pub fn swept_text(columns: &[VariedParameter], shown: &[String]) -> String {
    let each = columns.iter().zip(shown);
    each.map(|(column, value)| match &column.shown {
        Some(unit) => format!(" {}={value} {}", column.short_name(), unit.symbol),
        None => format!(" {}={value}", column.name),
    })
    .collect()
}
