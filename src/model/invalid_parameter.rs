//! A parameter without physical meaning, and the checks that find one.

use thiserror::Error;

/// An invalid parameter value.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{name} is {found}, but must be {allowed}")]
pub struct InvalidParameter {
    /// The parameter's name, as in a study file.
    pub name: String,
    /// The value found.
    pub found: String,
    /// The allowed values.
    pub allowed: &'static str,
}

pub(super) fn invalid(name: &str, found: &str, allowed: &'static str) -> InvalidParameter {
    InvalidParameter { name: name.to_owned(), found: found.to_owned(), allowed }
}

/// Returns an error unless a value is finite and allowed.
fn checked(
    name: &str,
    value: f64,
    is_allowed: bool,
    allowed: &'static str,
) -> Result<(), InvalidParameter> {
    match value.is_finite() && is_allowed {
        true => Ok(()),
        false => Err(invalid(name, &value.to_string(), allowed)),
    }
}

pub(super) fn positive(name: &str, value: f64) -> Result<(), InvalidParameter> {
    checked(name, value, value > 0.0, "a positive, finite number")
}

pub(super) fn not_negative(name: &str, value: f64) -> Result<(), InvalidParameter> {
    checked(name, value, value >= 0.0, "a finite number, zero or more")
}

pub(super) fn finite(name: &str, value: f64) -> Result<(), InvalidParameter> {
    checked(name, value, true, "a finite number")
}
