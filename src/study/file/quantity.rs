//! Values with units, such as `6000 rpm` or `40 N s/m`: products and quotients of unit symbols.
//!
//! Decimal factors multiply decimal digits, so that `6 mm` is the same number as `6e-3`.

use std::f64::consts::TAU;

use crate::study::error::{Fault, list_names, shorten};

/// Exponents of length, mass, time and angle. The angle has a dimension, because a number of 1/s is not a speed of rotation.
type Dimension = [i32; 4];

/// A unit symbol with its dimension and its value in SI units.
type Symbol = (&'static str, Dimension, f64);

const LENGTH: Dimension = [1, 0, 0, 0];
const MASS: Dimension = [0, 1, 0, 0];
const TIME: Dimension = [0, 0, 1, 0];
const ANGLE: Dimension = [0, 0, 0, 1];
const FORCE: Dimension = [1, 1, -2, 0];

/// All unit symbols.
const SYMBOLS: [Symbol; 28] = [
    ("m", LENGTH, 1.0),
    ("km", LENGTH, 1e3),
    ("cm", LENGTH, 1e-2),
    ("mm", LENGTH, 1e-3),
    ("µm", LENGTH, 1e-6),
    ("um", LENGTH, 1e-6),
    ("nm", LENGTH, 1e-9),
    ("in", LENGTH, 0.0254),
    ("ft", LENGTH, 0.3048),
    ("kg", MASS, 1.0),
    ("g", MASS, 1e-3),
    ("mg", MASS, 1e-6),
    ("µg", MASS, 1e-9),
    ("ug", MASS, 1e-9),
    ("t", MASS, 1e3),
    ("s", TIME, 1.0),
    ("ms", TIME, 1e-3),
    ("min", TIME, 60.0),
    ("h", TIME, 3600.0),
    ("N", FORCE, 1.0),
    ("mN", FORCE, 1e-3),
    ("kN", FORCE, 1e3),
    ("J", [2, 1, -2, 0], 1.0),
    ("W", [2, 1, -3, 0], 1.0),
    ("rad", ANGLE, 1.0),
    ("deg", ANGLE, TAU / 360.0),
    ("°", ANGLE, TAU / 360.0),
    ("rev", ANGLE, TAU),
];

/// The SI units that keys have. Each has what it measures, with two examples, and the units of this quantity that consist of
/// several symbols.
pub(super) const SI_UNITS: [(&str, &str, &str); 19] = [
    ("m/s2", "an acceleration, such as 9.81 m/s^2", ""),
    ("kg m2", "a moment of inertia, such as 0.02 kg m^2 or 200 kg cm^2", ""),
    ("N m", "a torque, such as 0.2 N m", ""),
    ("N m/rad", "a stiffness of a joint, such as 0.0056 N m/rad", ""),
    ("N m s/rad", "a damping of a joint, such as 0.1 N m s/rad", ""),
    ("1/s", "a rate, such as 3 1/s", ""),
    ("kg", "a mass, such as 0.056 kg or 56 g", ""),
    ("m", "a length, such as 0.006 m or 6 mm", ""),
    ("s", "a time, such as 15 s or 0.25 min", ""),
    ("N", "a force, such as 10 N or 0.01 kN", "kg m/s^2"),
    ("N/m", "a stiffness, such as 10700 N/m or 10.7 N/mm", "N/m, N/mm, kN/m, kg/s^2"),
    ("N s/m", "a viscous damping, such as 1.28 N s/m or 1280 g/s", "N s/m, N s/mm, kg/s, g/s"),
    ("kg/m3", "a density, such as 7810 kg/m^3 or 7.81 g/cm^3", "kg/m^3, g/cm^3"),
    (
        "kg m",
        "a product of mass and radius, such as 4e-5 kg m or 40 g mm",
        "g mm, kg mm, kg m, g cm",
    ),
    ("rad", "an angle, such as 0.5 rad or 30 deg", ""),
    (
        "rad/s",
        "a speed of rotation, such as 628.3 rad/s or 6000 rpm",
        "rpm, rad/s, deg/s, rev/s, rev/min",
    ),
    ("m/s", "a speed, such as 0.1 m/s or 100 mm/s", "m/s, mm/s, cm/s, km/h"),
    ("rad/s2", "a number", ""),
    ("N m s", "a number", ""),
];

/// Further units of mechanics.
const FURTHER_UNITS: [&str; 4] = ["W", "N s", "N/m2", "N/m3"];

/// Returns what an SI unit measures, with two examples.
pub(crate) fn measured(unit: &str) -> &'static str {
    SI_UNITS.iter().find(|(other, ..)| *other == unit).map_or("a number", |(_, text, _)| text)
}

/// Splits a text into the number at its beginning and the unit after it, which may be empty.
pub(crate) fn split_number(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    let end_of_digits = |from: usize| {
        let rest = text.get(from..).unwrap_or_default();
        from + rest.bytes().take_while(u8::is_ascii_digit).count()
    };
    let byte = |at: usize| text.as_bytes().get(at).copied();
    let start = usize::from(matches!(byte(0), Some(b'+' | b'-')));
    let mut end = end_of_digits(start);
    let mut digits = end - start;
    if byte(end) == Some(b'.') {
        digits += end_of_digits(end + 1) - (end + 1);
        end = end_of_digits(end + 1);
    }
    if matches!(byte(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(byte(end + 1), Some(b'+' | b'-')));
        let exponent = end_of_digits(end + 1 + sign);
        end = if exponent > end + 1 + sign { exponent } else { end };
    }
    (digits > 0).then(|| (&text[..end], text[end..].trim()))
}

/// Converts a text such as `40 N s/m` into a number in the given SI unit.
pub(crate) fn convert(text: &str, si_unit: &str) -> Result<f64, Fault> {
    let found = || format!("text {:?}", shorten(text));
    let allowed = measured(si_unit);
    let Some((number, unit)) = split_number(text) else {
        return Err(Fault::new("not a number with a unit", found(), allowed));
    };
    if unit.is_empty() {
        return Err(Fault::new("a number without a unit", found(), allowed));
    }
    if let Some(fault) = decimal_comma(text) {
        return Err(fault);
    }
    let factors = factors(unit).map_err(|symbol| unknown(unit, &symbol, si_unit))?;
    let wanted = factors_of_si(si_unit);
    if dimension_of(&factors) != dimension_of(&wanted) {
        let same = |(known, ..): &&(&str, &str, &str)| {
            dimension_of(&factors_of_si(known)) == dimension_of(&factors)
        };
        let is = SI_UNITS.iter().find(same).and_then(|(_, text, _)| text.split_once(','));
        let is = is.map(|(what, _)| format!(", {what}")).unwrap_or_default();
        return Err(Fault::new("a unit of another quantity", found() + &is, allowed));
    }
    let value = product(number, &factors);
    if value.is_finite() {
        return Ok(value);
    }
    Err(Fault::new("not a finite number", found(), "a finite number"))
}

/// How numbers in a unit become numbers in an SI unit.
pub(crate) struct Conversion(Vec<(Symbol, i32)>);

impl Conversion {
    /// Creates the conversion.
    pub(crate) fn new(unit: &str, si_unit: &str) -> Result<Conversion, Fault> {
        convert(&format!("1 {unit}"), si_unit)?;
        Ok(Conversion(factors(unit).unwrap_or_default()))
    }

    /// Converts a number.
    pub(crate) fn of(&self, number: f64) -> f64 {
        product(&format!("{number:e}"), &self.0)
    }
}

/// Returns the SI unit of a unit, such as `N/m` of `N/mm`, and its exponents of length, mass, time and angle; `1` without any.
pub(crate) fn unit_of(text: &str) -> Result<(String, Dimension), Fault> {
    if text == "1" {
        return Ok(("1".to_owned(), [0; 4]));
    }
    let allowed = match text.to_lowercase().contains("hz") {
        true => {
            "1/s for a frequency `f` in `sin(2 * pi * f * t)`, rad/s, rev/s or rpm for a speed of rotation"
        }
        false => "an SI unit or a multiple of one, such as kg, mm, N, N/m, N s/m, rad/s or kg m^2",
    };
    let factors = factors(text).map_err(|_| Fault::new("unknown unit", shorten(text), allowed))?;
    let dimension = dimension_of(&factors);
    let mut known = SI_UNITS.iter().map(|(unit, ..)| *unit).chain(FURTHER_UNITS);
    if let Some(known) = known.find(|unit| dimension_of(&factors_of_si(unit)) == dimension) {
        return Ok((known.to_owned(), dimension));
    }
    let (mut above, mut below) = (Vec::new(), String::new());
    for (symbol, exponent) in ["m", "kg", "s", "rad"].iter().zip(dimension) {
        let power = if exponent.abs() == 1 { String::new() } else { exponent.abs().to_string() };
        match exponent {
            1.. => above.push(format!("{symbol}{power}")),
            0 => {}
            _ => below += &format!("/{symbol}{power}"),
        }
    }
    let above = if above.is_empty() { "1".to_owned() } else { above.join(" ") };
    Ok((above + &below, dimension))
}

fn factors_of_si(unit: &str) -> Vec<(Symbol, i32)> {
    factors(unit).unwrap_or_default()
}

/// Returns the fault of a number with a decimal comma, such as `6,5 mm`.
pub(crate) fn decimal_comma(text: &str) -> Option<Fault> {
    let (number, rest) = split_number(text)?;
    let fraction = rest.strip_prefix(',')?;
    let digits = fraction.bytes().take_while(u8::is_ascii_digit).count();
    let is_number = digits > 0 && !number.contains(['.', 'e', 'E']);
    is_number.then(|| {
        let found = format!("text {:?}", shorten(text));
        // Three digits after a comma may be thousands.
        let allowed = match digits {
            3 => "a decimal point, and no comma between digits".to_owned(),
            _ => format!("a decimal point, as in {number}.{}", shorten(fraction)),
        };
        Fault::new("a comma in a number", found, allowed)
    })
}

/// Returns the units of the same quantity as an SI unit.
fn units_like(si_unit: &str) -> Vec<&'static str> {
    let wanted = dimension_of(&factors_of_si(si_unit));
    let single = SYMBOLS.iter().filter(|(_, dimension, _)| *dimension == wanted);
    let known = SI_UNITS.iter().filter(|(unit, ..)| *unit == si_unit);
    let compound = known.flat_map(|(.., units)| units.split(", ")).filter(|unit| !unit.is_empty());
    single.map(|(name, ..)| *name).chain(compound).collect()
}

fn unknown(unit: &str, symbol: &str, si_unit: &str) -> Fault {
    let allowed = measured(si_unit);
    if symbol.is_empty() {
        let allowed = format!("{allowed}; a product is `N s`, a quotient `N/m`, a power `s^2`");
        return Fault::new("not a unit", shorten(unit), allowed);
    }
    let units = units_like(si_unit);
    // Units that differ in case only, such as RPM, or in blanks only, such as Ns/m, are the nearest.
    let plain = |text: &str| text.to_lowercase().replace([' ', '*', '·', '⋅'], "");
    let same = units.iter().find(|known| plain(known) == plain(unit));
    let frequency = || (si_unit == "rad/s" && unit.eq_ignore_ascii_case("hz")).then_some(&"rev/s");
    let units = match same.or_else(frequency) {
        Some(nearest) => list_names(nearest, &units),
        None => list_names(unit, &units),
    };
    let allowed = format!("{allowed}; the units are {units}, and products or quotients of units");
    Fault::new("unknown unit", shorten(symbol), allowed)
}

/// Parses a unit such as `N s/m` into symbols with powers.
fn factors(unit: &str) -> Result<Vec<(Symbol, i32)>, String> {
    let unit =
        unit.replace('μ', "µ").replace('²', "^2").replace('³', "^3").replace("rpm", "rev/min");
    let mut all = Vec::new();
    for (place, part) in unit.split('/').enumerate() {
        let mut words = part.split(|blank: char| blank.is_whitespace() || "*·⋅".contains(blank));
        let words: Vec<&str> = words.by_ref().filter(|word| !word.is_empty()).collect();
        // `N/m s` could mean N/(m s) or (N/m) s.
        if words.is_empty() || (place > 0 && words.len() > 1) {
            return Err(String::new());
        }
        for word in words {
            // `m3` is a power, too.
            let digit = word.len() - usize::from(word.ends_with(['2', '3']));
            let (name, power) = match word.split_once('^') {
                Some(parts) => parts,
                None if digit < word.len() => word.split_at(digit),
                None => (word, "1"),
            };
            let power = power.parse::<i32>().ok().filter(|power| (-9..=9).contains(power));
            let power = power.ok_or_else(String::new)?;
            if word == "1" {
                continue;
            }
            let symbol = SYMBOLS.iter().find(|(symbol, ..)| *symbol == name);
            let symbol = symbol.ok_or_else(|| name.to_owned())?;
            all.push((*symbol, if place > 0 { -power } else { power }));
        }
    }
    Ok(all)
}

fn dimension_of(factors: &[(Symbol, i32)]) -> Dimension {
    let mut sum = [0; 4];
    for ((_, dimension, _), power) in factors {
        for (sum, exponent) in sum.iter_mut().zip(dimension) {
            *sum += exponent * power;
        }
    }
    sum
}

/// Multiplies a number by units. Powers of ten and decimal factors are exact; the others follow one after another.
fn product(number: &str, factors: &[(Symbol, i32)]) -> f64 {
    // A number with more digits than fit is rounded before it is multiplied.
    let rounded = || decimal(&format!("{:e}", number.parse::<f64>().ok()?));
    let Some(mut exact) = decimal(number).or_else(rounded) else { return f64::NAN };
    let mut inexact = Vec::new();
    for ((_, _, factor), power) in factors {
        // Twelve digits undo the rounding to binary of a decimal factor such as 1e-9.
        let rounded = decimal(&format!("{factor:.11e}"));
        let is_decimal = |(digits, tens): &(i128, i64)| {
            let same: f64 = format!("{digits}e{tens}").parse().unwrap_or(f64::NAN);
            ((same - factor) / factor).abs() < 1.0e-15
        };
        for _ in 0..power.unsigned_abs() {
            let step = rounded.filter(is_decimal).and_then(|(digits, tens)| match *power > 0 {
                true => Some((exact.0.checked_mul(digits)?, exact.1 + tens)),
                false => (digits == 1).then_some((exact.0, exact.1 - tens)),
            });
            match step {
                Some(step) => exact = step,
                None => inexact.push((*factor, *power > 0)),
            }
        }
    }
    let start: f64 = format!("{}e{}", exact.0, exact.1).parse().unwrap_or(f64::NAN);
    let apply = |value: f64, (factor, times): (f64, bool)| match times {
        true => value * factor,
        false => value / factor,
    };
    inexact.into_iter().fold(start, apply)
}

/// Returns the digits of a decimal number, without trailing zeros, and the power of ten of the last digit.
fn decimal(number: &str) -> Option<(i128, i64)> {
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let all = format!("{whole}{fraction}");
    let (digits, zeros) = match all.trim_end_matches('0') {
        "" | "+" | "-" => ("0", 0),
        digits => (digits, all.len() - digits.len()),
    };
    let exponent: i64 = exponent.parse::<i32>().ok()?.into();
    let places = i64::try_from(fraction.len()).ok()?;
    Some((digits.parse().ok()?, exponent - places + i64::try_from(zeros).ok()?))
}
