//! Values of swept parameters as people read them: a long number has few digits, as long as different values of the
//! sweep stay different.

use crate::numbers::to_digits;
use crate::study::file::yaml_tree::describe_number;
use crate::study::plan::parameter::{Parameter, ParameterValue, VariedParameter};
use crate::study::plan::planned_runs::Plan;

/// Numbers up to this length, in characters, are shown with all digits. Longer ones are results of a conversion, such
/// as `314.1592653589793` for 3000 rpm, or of the spacing of a range.
const LONGEST: usize = 12;
/// Significant digits of a longer number.
const DIGITS: usize = 6;
/// Significant digits that distinguish any two numbers.
const ALL_DIGITS: usize = 17;

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
        let own = self.base.value(parameter);
        let numbers = lists.flatten().chain([&own]).filter_map(|value| match value {
            ParameterValue::Number(number) => Some(column.shown_number(*number)),
            ParameterValue::Text(_) => None,
        });
        fewest_digits(numbers.collect())
    }
}

/// Returns a number with six significant digits, if it is long.
pub(in crate::study) fn six_digits(number: f64) -> String {
    shown(number, DIGITS)
}

/// Returns the fewest digits, from six on, with which different numbers have different texts.
fn fewest_digits(mut numbers: Vec<f64>) -> usize {
    numbers.sort_by(f64::total_cmp);
    numbers.dedup();
    let differ = |digits: &usize| {
        numbers.windows(2).all(|pair| shown(pair[0], *digits) != shown(pair[1], *digits))
    };
    (DIGITS..ALL_DIGITS).find(differ).unwrap_or(ALL_DIGITS)
}

/// Formats a number with at most this number of significant digits, if it is long.
fn shown(number: f64, digits: usize) -> String {
    let all = describe_number(number);
    if all.len() <= LONGEST {
        return all;
    }
    describe_number(to_digits(number, digits))
}

#[cfg(test)]
mod tests {
    use super::{fewest_digits, shown};

    #[test]
    fn long_numbers_have_six_digits() {
        assert_eq!(shown(314.159_265_358_979_3, 6), "314.159");
        assert_eq!(shown(-216.377_2, 6), "-216.3772");
        assert_eq!(shown(1.234_567_890_123e-7, 6), "1.23457e-7");
        assert_eq!(shown(1.0 / 3.0, 17), "0.3333333333333333");
    }

    #[test]
    fn different_numbers_stay_different() {
        let third = 1.0 / 3.0;
        assert_eq!(fewest_digits(vec![third, 2.0 * third, third]), 6);
        assert_eq!(fewest_digits(vec![third, third + 1e-8]), 8);
        assert_eq!(fewest_digits(vec![third, f64::from_bits(third.to_bits() + 1)]), 16);
        assert_eq!(fewest_digits(vec![0.333_333, third]), 7);
    }
}
