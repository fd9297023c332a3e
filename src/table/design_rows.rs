//! Designs in Arrow tables: columns of numbers and of text, of any width and encoding.

use std::path::Path;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float16Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type,
    UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{ArrayRef, RecordBatchReader};
use arrow_schema::DataType;

use crate::study::file_values::Entry;
use crate::study::{DesignValue, Fault, MAX_VALUES, Study, StudyError};

/// The designs in an Arrow table, which messages call `name`: columns named as variables, one design per
/// row.
///
/// # Errors
/// As for [`Study::designs_in_memory`]; a column that is neither of numbers nor of text; a table that
/// cannot be read.
pub fn designs_in_arrow(
    study: &Study,
    name: &str,
    reader: impl RecordBatchReader,
) -> Result<Vec<Vec<DesignValue>>, StudyError> {
    let refuse = |key: String, fault| StudyError::new(Path::new(name), None, key, fault, None);
    let columns: Vec<String> =
        reader.schema().fields().iter().map(|field| field.name().clone()).collect();
    let wanted: Vec<bool> = columns
        .iter()
        .map(|column| study.variables().iter().any(|variable| variable.name() == column))
        .collect();
    let mut rows = Vec::new();
    for batch in reader {
        let batch = batch.map_err(|error| {
            let fault = Fault::new("not a table", error.to_string(), "an Arrow table");
            refuse(String::new(), fault)
        })?;
        let mut values = Vec::with_capacity(columns.len());
        for ((column, wanted), array) in columns.iter().zip(&wanted).zip(batch.columns()) {
            // A column that is no variable will be refused by its name.
            let read = if *wanted { entries(array) } else { Some(vec![None; batch.num_rows()]) };
            let read = read.ok_or_else(|| {
                let found = format!("a column of {}", array.data_type());
                let fault = Fault::new("wrong type", found, "a column of numbers or of text");
                refuse(format!("column {column}"), fault)
            })?;
            values.push(read.into_iter());
        }
        // Each column of a batch has as many values as the batch has rows.
        let row = |_| values.iter_mut().map(|column| column.next().flatten()).collect();
        rows.extend((0..batch.num_rows()).map(row));
        if rows.len() > MAX_VALUES {
            break;
        }
    }
    study.designs_in_memory(name, columns, rows)
}

/// The values of a column; none where they are neither numbers nor text.
fn entries(column: &ArrayRef) -> Option<Vec<Option<Entry>>> {
    macro_rules! numbers {
        ($type:ty, $number:expr) => {
            column
                .as_primitive_opt::<$type>()?
                .iter()
                .map(|number| number.map($number).map(Entry::Number))
                .collect()
        };
    }
    let text = |text: Option<&str>| Some(Entry::Text(text?.to_owned()));
    Some(match column.data_type() {
        DataType::Int8 => numbers!(Int8Type, f64::from),
        DataType::Int16 => numbers!(Int16Type, f64::from),
        DataType::Int32 => numbers!(Int32Type, f64::from),
        DataType::Int64 => numbers!(Int64Type, |number| number as f64),
        DataType::UInt8 => numbers!(UInt8Type, f64::from),
        DataType::UInt16 => numbers!(UInt16Type, f64::from),
        DataType::UInt32 => numbers!(UInt32Type, f64::from),
        DataType::UInt64 => numbers!(UInt64Type, |number| number as f64),
        DataType::Float16 => numbers!(Float16Type, f64::from),
        DataType::Float32 => numbers!(Float32Type, f64::from),
        DataType::Float64 => numbers!(Float64Type, f64::from),
        DataType::Utf8 => column.as_string_opt::<i32>()?.iter().map(text).collect(),
        DataType::LargeUtf8 => column.as_string_opt::<i64>()?.iter().map(text).collect(),
        DataType::Utf8View => column.as_string_view_opt()?.iter().map(text).collect(),
        DataType::Dictionary(..) => {
            let words = column.as_any_dictionary_opt()?;
            let values = entries(words.values())?;
            let places = words.normalized_keys().into_iter().enumerate();
            let entry = |(row, place): (usize, usize)| {
                if column.is_null(row) { None } else { values.get(place).cloned().flatten() }
            };
            places.map(entry).collect()
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use arrow_array::types::Int8Type;
    use arrow_array::{
        ArrayRef, BooleanArray, DictionaryArray, Float32Array, Int16Array, LargeStringArray,
        RecordBatch, RecordBatchIterator, UInt64Array,
    };

    use super::{designs_in_arrow, entries};
    use crate::study::file_values::Entry;
    use crate::study::{DesignValue, Study, StudyError};

    fn study() -> Study {
        let text = "
schema: 1
name: two
seed: 1
model: {kind: ball_balancer}
initial_conditions: {design: {monte_carlo: {samples: 2}}}
design:
  speed_rad_s: {from: -260, to: -140}
  material: {choices: {steel: {ball_mass_kg: 1.4e-4}, tin: {ball_mass_kg: 1.2e-4}}}
";
        Study::parse(Path::new("two.yaml"), text.to_owned()).unwrap()
    }

    fn read(columns: Vec<(&str, ArrayRef)>) -> Result<Vec<Vec<DesignValue>>, StudyError> {
        let batch = RecordBatch::try_from_iter(columns).unwrap();
        let batches = [Ok(batch.clone()), Ok(batch.clone())];
        designs_in_arrow(&study(), "designs", RecordBatchIterator::new(batches, batch.schema()))
    }

    fn speeds() -> ArrayRef {
        Arc::new(Int16Array::from(vec![-150, -200]))
    }

    #[test]
    fn columns_in_any_order_and_encoding() {
        let words: DictionaryArray<Int8Type> = [Some("tin"), Some("steel")].into_iter().collect();
        let designs = read(vec![("material", Arc::new(words)), ("speed_rad_s", speeds())]).unwrap();
        let row = |speed, choice| vec![DesignValue::Number(speed), DesignValue::Choice(choice)];
        let (first, second) = (row(-150.0, 1), row(-200.0, 0));
        assert_eq!(designs, [first.clone(), second.clone(), first, second]);
    }

    #[test]
    fn numbers_and_text_of_any_width() {
        let number = |number| Some(Entry::Number(number));
        let numbers: [ArrayRef; 2] = [
            Arc::new(Float32Array::from(vec![Some(0.5), None])),
            Arc::new(UInt64Array::from(vec![Some(1 << 53), None])),
        ];
        assert_eq!(entries(&numbers[0]), Some(vec![number(0.5), None]));
        assert_eq!(entries(&numbers[1]), Some(vec![number(2.0_f64.powi(53)), None]));
        let text: ArrayRef = Arc::new(LargeStringArray::from(vec![Some("tin"), None]));
        assert_eq!(entries(&text), Some(vec![Some(Entry::Text("tin".to_owned())), None]));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let truths: ArrayRef = Arc::new(BooleanArray::from(vec![true, false]));
        let text = |words: [Option<&str>; 2]| -> ArrayRef {
            Arc::new(LargeStringArray::from(words.to_vec()))
        };
        for (columns, key, problem) in [
            (vec![("speed_rad_s", Arc::clone(&truths))], "column speed_rad_s", "wrong type"),
            (vec![("speed", truths)], "column speed", "unknown column"),
            (vec![("speed_rad_s", speeds())], "", "no column material"),
            (
                vec![("speed_rad_s", speeds()), ("material", text([Some("tin"), None]))],
                "row 2, column material",
                "an empty value",
            ),
            (
                vec![("speed_rad_s", speeds()), ("material", text([Some("tan"), Some("tin")]))],
                "row 1, column material",
                "not a choice",
            ),
        ] {
            let error = read(columns).unwrap_err();
            assert_eq!((error.key(), error.problem()), (key, problem), "{error}");
            assert_eq!(error.file(), Path::new("designs"));
        }
    }
}
