//! Tables of designs in Arrow.

use std::path::Path;
use std::sync::Arc;

use arrow::array::types::Int8Type;
use arrow::array::{
    ArrayRef, BooleanArray, DictionaryArray, Int16Array, LargeStringArray, RecordBatch,
    RecordBatchIterator,
};
use stickslip::study::{DesignValue, StudyError, TableSource};

use super::study;

const TWO_VARIABLES: &str = "
schema: 1
name: two
seed: 1
model: {kind: ball_balancer}
initial_conditions: {design: {monte_carlo: {samples: 2}}}
design:
  speed_rad_s: {from: -260, to: -140}
  material: {choices: {steel: {ball_mass_kg: 1.4e-4}, tin: {ball_mass_kg: 1.2e-4}}}
";

fn read(columns: Vec<(&str, ArrayRef)>) -> Result<Vec<Vec<DesignValue>>, StudyError> {
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let batches = [Ok(batch.clone()), Ok(batch.clone())];
    let reader = RecordBatchIterator::new(batches, batch.schema());
    study(TWO_VARIABLES).designs(TableSource::Arrow("designs", Box::new(reader)))
}

fn speeds() -> ArrayRef {
    Arc::new(Int16Array::from(vec![-150, -200]))
}

#[test]
fn columns_may_have_any_order_and_encoding() {
    let words: DictionaryArray<Int8Type> = [Some("tin"), Some("steel")].into_iter().collect();
    let designs = read(vec![("material", Arc::new(words)), ("speed_rad_s", speeds())]).unwrap();
    let row = |speed, choice| vec![DesignValue::Number(speed), DesignValue::Choice(choice)];
    let (first, second) = (row(-150.0, 1), row(-200.0, 0));
    assert_eq!(designs, [first.clone(), second.clone(), first, second]);
}

#[test]
fn errors_name_the_row_and_column() {
    let truths: ArrayRef = Arc::new(BooleanArray::from(vec![true, false]));
    let text =
        |words: [Option<&str>; 2]| -> ArrayRef { Arc::new(LargeStringArray::from(words.to_vec())) };
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
