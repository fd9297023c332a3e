//! Numbers as people read them, with few significant digits, and numbers of things.

use std::fmt::Display;

/// Formats a number for a message: plain, or with an exponent if that is shorter.
pub(crate) fn describe_number(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1.0e-4..1.0e15).contains(&size) {
        format!("{number:e}")
    } else {
        number.to_string()
    }
}

/// Rounds a number to this many significant digits.
pub(crate) fn to_digits(number: f64, digits: usize) -> f64 {
    // A formatted number can always be parsed.
    format!("{number:.*e}", digits - 1).parse().unwrap_or(number)
}

/// Returns a number with at most four significant digits.
pub(crate) fn short(number: f64) -> String {
    describe_number(to_digits(number, 4))
}

/// Returns a number with four significant digits, also if they are zeros.
pub(crate) fn four_digits(number: f64) -> String {
    let size = number.abs();
    if number == 0.0 || (1e-3..1e5).contains(&size) {
        let digits = if number == 0.0 { 0 } else { (3 - size.log10().floor() as i32).max(0) };
        return format!("{number:.*}", digits as usize);
    }
    format!("{number:.3e}")
}

/// Returns a number with four significant digits, without zeros at the end of a fraction.
pub(crate) fn trimmed(number: f64) -> String {
    let text = four_digits(number);
    match text.contains('.') && !text.contains('e') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// Returns a number with four significant digits for a page, with a minus sign instead of a hyphen.
pub(crate) fn significant(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = 3 - value.abs().log10().floor() as i32;
    let text = match digits {
        -3..=8 => format!("{value:.0$}", digits.max(0) as usize),
        _ => format!("{value:.3e}"),
    };
    text.replace('-', "\u{2212}")
}

/// Returns a number with three significant digits and at most three decimals, or with an exponent if its size is below 0.001.
pub fn three_digits(value: f64) -> String {
    // Zero has no sign.
    let value = value + 0.0;
    let size = value.abs();
    if size > 0.0 && size < 1e-3 {
        return format!("{value:.2e}");
    }
    let digits = if size > 0.0 { 2 - size.log10().floor() as i32 } else { 0 };
    format!("{value:.0$}", digits.clamp(0, 3) as usize)
}

/// Returns a fraction in %, which is rounded to 0 or 100 only if it has that value.
pub fn percent(fraction: f64) -> String {
    let rounded = format!("{:.1}", 100.0 * fraction);
    match rounded.as_str() {
        "0.0" if fraction > 0.0 => "<0.1".to_owned(),
        "100.0" if fraction < 1.0 => ">99.9".to_owned(),
        _ => rounded,
    }
}

/// Returns a number of things, such as `1 run` or `2 runs`.
pub(crate) fn counted<N: Display + From<u8> + PartialEq>(count: N, thing: &str) -> String {
    let ending = if count == N::from(1) { "" } else { "s" };
    format!("{count} {thing}{ending}")
}

#[cfg(test)]
mod tests {
    use super::{percent, three_digits, to_digits};

    #[test]
    fn numbers_have_three_digits() {
        let found = [0.0, 0.0124, 0.5302, 28.31, 99.96, 1234.5].map(three_digits);
        assert_eq!(found, ["0", "0.012", "0.530", "28.3", "100.0", "1234"]);
        let found = [-0.0, -0.0124, -28.31, -1e-5].map(three_digits);
        assert_eq!(found, ["0", "-0.012", "-28.3", "-1.00e-5"]);
        let found = [0.0, 1e-4, 0.875, 0.9999, 1.0].map(percent);
        assert_eq!(found, ["0.0", "<0.1", "87.5", ">99.9", "100.0"]);
    }

    #[test]
    fn numbers_have_six_digits() {
        let found = [123.456789, -0.000123456789, 0.0].map(|number| to_digits(number, 6));
        assert_eq!(found, [123.457, -0.000123457, 0.0]);
    }
}
