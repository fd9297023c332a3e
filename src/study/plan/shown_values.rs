//! Values of swept parameters as people read them: a long number has few digits, as long as different values of the
//! sweep stay different.

use crate::study::plan::parameter::{Parameter, ParameterValue, VariedParameter};
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::units::{DIGITS, fewest_digits, shown};

impl Plan {
    /// Returns the values of the swept parameters of a point as text for terminals and figures, in the units that the study
    /// chooses. Tables, JSON and the resolved file are in SI units and have all digits.
    pub fn shown(&self, swept: &[ParameterValue]) -> Vec<String> {
        let digits = self.shown_digits.get_or_init(|| {
            let each = self.swept_parameters.iter().zip(&self.swept);
            each.map(|(parameter, column)| self.digits_of(*parameter, column)).collect()
        });
        let digits = digits.iter().copied().chain(std::iter::repeat(DIGITS));
        let columns = self.swept.iter().zip(digits);
        let each = swept.iter().zip(columns);
        each.map(|(value, (column, digits))| match value {
            ParameterValue::Number(number) => shown(column.shown_number(*number), digits),
            ParameterValue::Text(text) => (*text).to_owned(),
        })
        .collect()
    }

    /// Returns the number of digits that keeps the values of a swept parameter different.
    fn digits_of(&self, parameter: Parameter, column: &VariedParameter) -> usize {
        let lists = self.blocks.iter().filter_map(|block| block.list(parameter));
        // A block that does not sweep the parameter has its base value.
        let base = self.base.value(parameter);
        let numbers = lists.flatten().chain([&base]).filter_map(|value| match value {
            ParameterValue::Number(number) => Some(column.shown_number(*number)),
            ParameterValue::Text(_) => None,
        });
        fewest_digits(numbers.collect())
    }
}
