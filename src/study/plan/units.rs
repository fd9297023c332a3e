//! Numbers as people read them: in the units that a study chooses, and with few digits if they are long. Files of
//! results and JSON stay in SI units.

use indexmap::IndexMap;

use crate::numbers::to_digits;
use crate::study::error::describe_number;
use crate::study::file::key_units::split_unit;

/// The quantities with a unit of their own: the key under `units`, and the SI unit.
pub(crate) const QUANTITIES: [(&str, &str); 10] = [
    ("speed", "rad/s"),
    ("velocity", "m/s"),
    ("length", "m"),
    ("mass", "kg"),
    ("density", "kg/m3"),
    ("imbalance", "kg m"),
    ("force", "N"),
    ("stiffness", "N/m"),
    ("damping", "N s/m"),
    (VIBRATION, "m"),
];

/// The quantity of amplitudes.
const VIBRATION: &str = "vibration";

/// A unit in which a value is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Symbol, such as `rpm`.
    pub symbol: String,
    /// The value of one unit in SI units.
    pub si: f64,
}

impl Unit {
    /// Returns a value in SI units in this unit.
    pub fn of(&self, value_si: f64) -> f64 {
        // If 1/si is a whole number, the product has one rounding error; the quotient would have two, because 1e-6 is rounded.
        let per_si = self.si.recip();
        if per_si.fract() == 0.0 { per_si * value_si } else { value_si / self.si }
    }
}

/// The units of a study, by quantity or by parameter without the unit in its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShownUnits(pub(in crate::study) IndexMap<String, Unit>);

impl ShownUnits {
    /// Returns the unit of a parameter; `None` if it is shown in SI units.
    pub fn of_parameter(&self, name: &str) -> Option<&Unit> {
        let (short, si) = split_unit(name)?;
        let of_all = || short.trim_end_matches(|end: char| end.is_ascii_digit()).strip_suffix('_');
        let unit = self.0.get(short).or_else(|| self.0.get(of_all()?));
        unit.or_else(|| self.0.get(quantity(si)?))
    }

    /// Returns the unit in which a parameter is shown.
    pub fn shown(&self, name: &str) -> Unit {
        let si = split_unit(name).map_or("", |(_, si)| si);
        let default = || Unit { symbol: si.to_owned(), si: 1.0 };
        self.of_parameter(name).cloned().unwrap_or_else(default)
    }

    /// Returns the unit of the amplitudes of vibration: µm unless the study chooses another one.
    pub fn vibration(&self) -> Unit {
        self.of_quantity(VIBRATION, "µm", 1e-6)
    }

    /// Returns whether the study chooses the unit of the amplitudes of vibration.
    pub fn chooses_vibration(&self) -> bool {
        self.0.contains_key(VIBRATION)
    }

    /// Returns the unit of imbalances.
    pub fn imbalance(&self) -> Unit {
        self.of_quantity("imbalance", "g mm", 1e-6)
    }

    /// Returns the unit of a response with this SI unit; without a symbol for pure numbers.
    pub fn of_response(&self, si: &str) -> Unit {
        match si {
            "m" => self.vibration(),
            "1" => Unit { symbol: String::new(), si: 1.0 },
            other => Unit { symbol: other.to_owned(), si: 1.0 },
        }
    }

    /// Returns the unit of speeds of rotation.
    pub fn speed(&self) -> Unit {
        self.of_quantity("speed", "rad/s", 1.0)
    }

    /// Returns the unit that the study chooses for a quantity, or the unit with this symbol and value.
    fn of_quantity(&self, quantity: &str, symbol: &str, si: f64) -> Unit {
        let default = || Unit { symbol: symbol.to_owned(), si };
        self.0.get(quantity).cloned().unwrap_or_else(default)
    }
}

/// Returns the name of a parameter without its unit, such as `ball_mass_1` for `ball_mass_1_kg`.
pub(crate) fn short_name(name: &str, unit: &str) -> String {
    split_unit(name).filter(|(_, si)| *si == unit).map_or(name, |(short, _)| short).to_owned()
}

/// Returns the quantity with this SI unit; a length, not a vibration, for `m`.
pub(in crate::study) fn quantity(si: &str) -> Option<&'static str> {
    QUANTITIES.iter().find(|(_, unit)| *unit == si).map(|(name, _)| *name)
}

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
