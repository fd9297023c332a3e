//! The text of a resolved study in the form of a study file.

use serde_json::Value;

use crate::study::file::study_file::StudyFile;

/// Words that YAML 1.1 or some parsers do not treat as text.
const AMBIGUOUS_WORDS: [&str; 11] =
    ["true", "false", "yes", "no", "on", "off", "y", "n", "null", "nan", "inf"];

/// Returns the file as plain values, without keys that are not given. Its types always serialise.
pub(in crate::study) fn to_value(file: &StudyFile) -> Value {
    let mut value = serde_json::to_value(file).unwrap_or_default();
    remove_absent(&mut value);
    value
}

fn remove_absent(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|_, value| !value.is_null());
            fields.values_mut().for_each(remove_absent);
        }
        Value::Array(items) => items.iter_mut().for_each(remove_absent),
        _ => {}
    }
}

/// Returns the file in block style, with small values on one line.
pub(in crate::study) fn to_yaml(file: &StudyFile) -> String {
    block_text(&to_value(file))
}

/// Returns a value in block style, with small values on one line.
pub(in crate::study) fn block_text(value: &Value) -> String {
    let mut out = String::new();
    write_block(value, 0, &mut out);
    out
}

fn write_block(value: &Value, indent: usize, out: &mut String) {
    let margin = " ".repeat(indent);
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                out.push_str(&margin);
                write_text(key, out);
                out.push(':');
                if fits_one_line(value) {
                    out.push(' ');
                    write_flow(value, out);
                    out.push('\n');
                } else {
                    out.push('\n');
                    write_block(value, indent + 2, out);
                }
            }
        }
        Value::Array(items) => {
            for item in items {
                out.push_str(&margin);
                out.push_str("- ");
                if fits_one_line(item) {
                    write_flow(item, out);
                    out.push('\n');
                } else {
                    let mut below = String::new();
                    write_block(item, indent + 2, &mut below);
                    out.push_str(below.trim_start());
                }
            }
        }
        scalar => write_flow(scalar, out),
    }
}

/// Returns whether a value is written on one line: single values, lists of them, and small maps of
/// them.
fn fits_one_line(value: &Value) -> bool {
    let single = |value: &Value| !value.is_array() && !value.is_object();
    match value {
        Value::Object(fields) => {
            fields.is_empty() || fields.len() <= 4 && fields.values().all(single)
        }
        Value::Array(items) => items.iter().all(single),
        _ => true,
    }
}

/// Writes a value on one line.
pub(in crate::study) fn write_flow(value: &Value, out: &mut String) {
    match value {
        Value::Object(fields) => {
            out.push('{');
            for (index, (key, value)) in fields.iter().enumerate() {
                out.push_str(if index == 0 { "" } else { ", " });
                write_text(key, out);
                out.push_str(": ");
                write_flow(value, out);
            }
            out.push('}');
        }
        Value::Array(items) => {
            out.push('[');
            for (index, item) in items.iter().enumerate() {
                out.push_str(if index == 0 { "" } else { ", " });
                write_flow(item, out);
            }
            out.push(']');
        }
        Value::String(text) => write_text(text, out),
        Value::Number(number) => out.push_str(&number_for_all(&number.to_string())),
        other => out.push_str(&other.to_string()),
    }
}

/// Writes a number so that YAML 1.1 reads it, too: with a point before the exponent, and a sign in it.
fn number_for_all(number: &str) -> String {
    let Some((mantissa, exponent)) = number.split_once('e') else { return number.to_owned() };
    let point = if mantissa.contains('.') { "" } else { ".0" };
    let sign = if exponent.starts_with(['+', '-']) { "" } else { "+" };
    format!("{mantissa}{point}e{sign}{exponent}")
}

/// Writes a text, in quotation marks if a YAML parser may take it for something else.
pub(in crate::study) fn write_text(text: &str, out: &mut String) {
    let usual = |character: char| character.is_ascii_alphanumeric() || "-_.".contains(character);
    let plain = text.starts_with(|first: char| first.is_ascii_alphabetic())
        && text.chars().all(usual)
        && !AMBIGUOUS_WORDS.contains(&text.to_ascii_lowercase().as_str());
    if plain {
        out.push_str(text);
    } else {
        out.push_str(&Value::from(text).to_string());
    }
}
