//! The text of a table cell in the format of arrow's CSV writer, which preserves every bit of a
//! number.

use arrow_array::Array;
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int32Type, UInt8Type, UInt64Type};
use arrow_schema::DataType;

/// Returns the text of a cell of any type that the result tables have; `null` for an empty cell.
pub fn cell_text(column: &dyn Array, row: usize, null: &str) -> String {
    if column.is_null(row) {
        return null.to_owned();
    }
    match column.data_type() {
        DataType::Float64 => {
            ryu::Buffer::new().format(column.as_primitive::<Float64Type>().value(row)).to_owned()
        }
        DataType::UInt64 => column.as_primitive::<UInt64Type>().value(row).to_string(),
        DataType::UInt8 => column.as_primitive::<UInt8Type>().value(row).to_string(),
        DataType::Int32 => column.as_primitive::<Int32Type>().value(row).to_string(),
        DataType::Boolean => column.as_boolean().value(row).to_string(),
        DataType::Utf8 => column.as_string::<i32>().value(row).to_owned(),
        DataType::List(_) => {
            let values = column.as_list::<i32>().value(row);
            let texts = (0..values.len()).map(|index| cell_text(&values, index, null));
            format!("[{}]", texts.collect::<Vec<_>>().join(", "))
        }
        other => match column.as_dictionary_opt::<Int32Type>() {
            Some(words) => cell_text(words.values(), words.keys().value(row) as usize, null),
            None => format!("a cell of {other}"),
        },
    }
}
