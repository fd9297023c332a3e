//! Numbers as people read them: a long number has few digits.

use crate::numbers::to_digits;
use crate::study::file::yaml_tree::describe_number;

/// Numbers up to this length, in characters, are shown with all digits. Longer ones are results of a conversion, such
/// as `314.1592653589793` for 3000 rpm, or of the spacing of a range.
const LONGEST: usize = 12;
/// Significant digits of a longer number.
pub(super) const DIGITS: usize = 6;
/// Significant digits that distinguish any two numbers.
const ALL_DIGITS: usize = 17;

/// Returns a number with six significant digits, if it is long.
pub(in crate::study) fn six_digits(number: f64) -> String {
    shown(number, DIGITS)
}

/// Returns the fewest digits, from six on, with which different numbers have different texts.
pub(super) fn fewest_digits(mut numbers: Vec<f64>) -> usize {
    numbers.sort_by(f64::total_cmp);
    numbers.dedup();
    let differ = |digits: &usize| {
        numbers.windows(2).all(|pair| shown(pair[0], *digits) != shown(pair[1], *digits))
    };
    (DIGITS..ALL_DIGITS).find(differ).unwrap_or(ALL_DIGITS)
}

/// Formats a number with at most this number of significant digits, if it is long.
pub(super) fn shown(number: f64, digits: usize) -> String {
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
