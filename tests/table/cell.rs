//! Cells as text.

use std::sync::Arc;

use arrow::array::builder::{Float64Builder, ListBuilder};
use arrow::array::{
    Array, ArrayRef, BooleanArray, DictionaryArray, Float64Array, Int32Array, StringArray,
    UInt8Array, UInt64Array,
};
use arrow::datatypes::Int32Type;
use arrow::util::display::{ArrayFormatter, FormatOptions};
use stickslip::table::column::cell_text;

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
