//! Serializes long columns of numbers for the page's script in packed form.
//!
//! A packed column is an object with one base64 string of little-endian values: `f` holds 32-bit floats (NaN: no
//! value), `u` 32-bit whole numbers, `w` 16-bit steps between `from` and `to` (65535: no value), and `b` 8-bit
//! steps between them (255: no value). A 16-bit step is a hundredth of a screen pixel.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde::{Serialize, Serializer};
use serde_json::json;

/// The longest column that is not packed.
const SHORT: usize = 24;
/// The number of dots above which coordinates are packed in 16 bits each.
const MANY: usize = 4000;

/// Serializes numbers; those that are not finite become null or NaN.
pub fn numbers<S: Serializer>(values: &[f64], out: S) -> Result<S::Ok, S::Error> {
    if values.len() <= SHORT {
        return values.serialize(out);
    }
    let bytes: Vec<u8> = values.iter().flat_map(|value| (*value as f32).to_le_bytes()).collect();
    json!({"f": BASE64.encode(bytes)}).serialize(out)
}

/// Serializes the edges of rectangles as one flat list.
pub fn edges<S: Serializer>(edges: &[[f64; 4]], out: S) -> Result<S::Ok, S::Error> {
    numbers(edges.as_flattened(), out)
}

/// Serializes points as one flat list; packed in 16 bits if both coordinates have about the same range.
pub fn pairs<S: Serializer>(points: &[[f64; 2]], out: S) -> Result<S::Ok, S::Error> {
    let span = |axis: usize| {
        let (from, to) = ends(points.iter().map(|point| point[axis]));
        to - from
    };
    let [x, y] = [span(0), span(1)];
    let flat = points.as_flattened();
    if flat.len() > SHORT && x * 20.0 >= y && y * 20.0 >= x {
        steps(flat, out)
    } else {
        numbers(flat, out)
    }
}

/// Serializes coordinates of dots.
pub fn coordinates<S: Serializer>(values: &[f64], out: S) -> Result<S::Ok, S::Error> {
    if values.len() < MANY { numbers(values, out) } else { steps(values, out) }
}

/// Serializes numbers in 16 bits each.
pub fn steps<S: Serializer>(values: &[f64], out: S) -> Result<S::Ok, S::Error> {
    in_steps(values, 65534.0, "w", |step| (step as u16).to_le_bytes(), out)
}

/// Serializes numbers in 8 bits each, for colours.
pub fn levels<S: Serializer>(values: &[f64], out: S) -> Result<S::Ok, S::Error> {
    in_steps(values, 254.0, "b", |step| [step as u8], out)
}

/// Serializes numbers as steps from 0 to `last` between the least and the largest one, and one more for a value that is not
/// finite.
fn in_steps<const N: usize, S: Serializer>(
    values: &[f64],
    last: f64,
    key: &str,
    bytes: fn(f64) -> [u8; N],
    out: S,
) -> Result<S::Ok, S::Error> {
    let (from, to) = ends(values.iter().copied());
    let span = to - from;
    if !(span > 0.0 && span.is_finite()) {
        return numbers(values, out);
    }
    let step = |value: &f64| match value.is_finite() {
        true => ((value - from) / span * last).round(),
        false => last + 1.0,
    };
    let bytes: Vec<u8> = values.iter().flat_map(|value| bytes(step(value))).collect();
    json!({key: BASE64.encode(bytes), "from": from, "to": to}).serialize(out)
}

/// Serializes whole numbers.
pub fn whole_numbers<S: Serializer>(values: &[u64], out: S) -> Result<S::Ok, S::Error> {
    let narrow: Option<Vec<u32>> = values.iter().map(|value| u32::try_from(*value).ok()).collect();
    match narrow {
        Some(narrow) if narrow.len() > SHORT => {
            let bytes: Vec<u8> = narrow.iter().flat_map(|value| value.to_le_bytes()).collect();
            json!({"u": BASE64.encode(bytes)}).serialize(out)
        }
        _ => values.serialize(out),
    }
}

/// Returns the least and the largest finite value.
fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|value| value.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), v| (from.min(v), to.max(v)))
}
