//! Names of parameters and points as a reader knows them: `speed [rad/s]` for `speed_rad_s`.

use crate::report::chart::{Axis, AxisKind};
use crate::study::{ParameterValue, Study, VariedParameter};

/// The name of a parameter without its unit, in words.
fn words(parameter: &VariedParameter) -> String {
    let unit: String = parameter
        .unit
        .to_lowercase()
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    let name = parameter.name.strip_suffix(&format!("_{unit}")).unwrap_or(&parameter.name);
    name.replace('_', " ")
}

fn unit(parameter: &VariedParameter) -> &str {
    if parameter.unit == "1" { "" } else { parameter.unit }
}

/// An axis for a parameter.
pub fn axis_of(parameter: &VariedParameter) -> Axis {
    Axis {
        name: words(parameter),
        unit: unit(parameter).to_owned(),
        range: None,
        kind: AxisKind::Linear,
    }
}

/// A point in words, as `speed -216.3772 rad/s, friction coefficient 0.00275`: those of its parameters
/// for which `wanted` says so.
pub fn heading(study: &Study, values: &[ParameterValue], wanted: impl Fn(usize) -> bool) -> String {
    let parts = study.swept().iter().zip(values).enumerate();
    let part = |(index, (parameter, value)): (usize, (&VariedParameter, &ParameterValue))| {
        let unit = unit(parameter);
        let space = if unit.is_empty() { "" } else { " " };
        wanted(index).then(|| format!("{} {value}{space}{unit}", words(parameter)))
    };
    parts.filter_map(part).collect::<Vec<_>>().join(", ")
}
