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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use arrow::util::display::{ArrayFormatter, FormatOptions};
    use arrow_array::builder::{Float64Builder, ListBuilder};
    use arrow_array::types::Int32Type;
    use arrow_array::{
        ArrayRef, BooleanArray, DictionaryArray, Float64Array, Int32Array, StringArray, UInt8Array,
        UInt64Array,
    };

    use super::cell_text;

    /// Compares with arrow's CSV writer.
    #[test]
    fn cells_are_written_as_arrow_writes_them() {
        let mut lists = ListBuilder::new(Float64Builder::new());
        lists.append_value([Some(0.1), None, Some(-3e-9)]);
        lists.append_null();
        lists.append_value([]);
        let words: DictionaryArray<Int32Type> =
            [Some("rest"), None, Some("rest"), Some("a, b")].into_iter().collect();
        let mut numbers = vec![None, Some(f64::NAN), Some(f64::INFINITY), Some(f64::NEG_INFINITY)];
        numbers.extend([0.0, -0.0, 1.0, 5e-324, f64::MAX, 2.75e-3, 123456789.0].map(Some));
        let drawn = |k: i32| libm::sin(f64::from(k)) * f64::powi(10.0, k % 40 - 20);
        numbers.extend((0..1000).map(|k| Some(drawn(k))));
        let columns: [ArrayRef; 8] = [
            Arc::new(Float64Array::from(numbers)),
            Arc::new(UInt64Array::from(vec![Some(u64::MAX), None, Some(0)])),
            Arc::new(UInt8Array::from(vec![Some(255), None])),
            Arc::new(Int32Array::from(vec![Some(-7), None])),
            Arc::new(BooleanArray::from(vec![Some(true), Some(false), None])),
            Arc::new(StringArray::from(vec![Some("a \"b\""), Some(""), None])),
            Arc::new(words),
            Arc::new(lists.finish()),
        ];
        for column in &columns {
            for null in ["", "null"] {
                let options = FormatOptions::default().with_null(null);
                let theirs = ArrayFormatter::try_new(column, &options).unwrap();
                for row in 0..column.len() {
                    assert_eq!(cell_text(column, row, null), theirs.value(row).to_string());
                }
            }
        }
    }
}
