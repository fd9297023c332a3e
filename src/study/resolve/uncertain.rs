//! Resolution of uncertain parameters.

use std::f64::consts::TAU;

use indexmap::IndexMap;

use crate::study::error::{Fault, StudyError, describe_number};
use crate::study::file::source::Source;
use crate::study::file::uncertain_file::DistributionFile;
use crate::study::plan::base::Base;
use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::plan::uncertain_parameter::UncertainParameter;
use crate::study::resolve::sweep::find_parameter;
use crate::study::sampling::distribution::Distribution;
use crate::study::sampling::draw::DrawKey;

/// Validates the uncertain parameters and returns them in the order of the model's parameters.
///
/// # Errors
/// Returns an error if a name is not a numeric parameter, if a parameter is also swept, if a
/// distribution is invalid, or if its bounds are impossible values of the parameter.
pub(crate) fn resolve_uncertain(
    source: &Source,
    written: Option<&IndexMap<String, DistributionFile>>,
    base: &Base,
    swept: &[Parameter],
    seed: u64,
) -> Result<Vec<UncertainParameter>, StudyError> {
    let mut all = Vec::new();
    for (name, distribution) in written.into_iter().flatten() {
        let path = source.path("uncertain").key(name);
        let (factor, drawn) = match distribution {
            DistributionFile::Times(of) => (true, of.as_ref()),
            other => (false, other),
        };
        let parameter =
            find_uncertain(name, base, swept, factor).map_err(|fault| path.refuse_key(fault))?;
        let path = if factor { path.chosen() } else { path };
        let path = path.chosen();
        let scale = match parameter.get(&base.model, &base.general) {
            ParameterValue::Number(number) if factor => number,
            _ => 1.0,
        };
        let distribution = Distribution::resolve(drawn)
            .map_err(|(key, fault)| path.key(key).refuse_value(fault))?;
        for (key, bound) in distribution.bounds() {
            // Draws are strictly inside a range, so its lower end may itself be just too small.
            let inside = if key == "min" { bound.next_up() } else { bound };
            if let (Err(fault), Err(_)) = (
                parameter.check(scale * bound, &base.model),
                parameter.check(scale * inside, &base.model),
            ) {
                let fault = Fault { found: Some(describe_number(bound)), ..fault };
                return Err(path.key(key).refuse_value(fault));
            }
        }
        let key = DrawKey::new(seed, "uncertain", name);
        all.push(UncertainParameter { parameter, distribution, factor, key });
    }
    all.extend(random_directions(base, swept, &all, seed));
    all.sort_by_key(|uncertain| uncertain.parameter.key());
    Ok(all)
}

/// Returns the directions of kicks that the study calls random, unless it sweeps or draws them.
fn random_directions(
    base: &Base,
    swept: &[Parameter],
    drawn: &[UncertainParameter],
    seed: u64,
) -> Vec<UncertainParameter> {
    let all_directions = Distribution::Uniform { min: 0.0, max: TAU };
    let direction = Parameter::find("kick_direction_rad", &base.model);
    let directions =
        base.random_kicks.iter().filter_map(|kick| Some(direction?.of_one_member(*kick)));
    let varied: Vec<Parameter> =
        swept.iter().copied().chain(drawn.iter().map(|uncertain| uncertain.parameter)).collect();
    let is_free = |parameter: &Parameter| {
        !varied.iter().any(|other| other == parameter || parameter.general() == Some(*other))
    };
    let uncertain = |parameter: Parameter| UncertainParameter {
        parameter,
        distribution: all_directions.clone(),
        factor: false,
        key: DrawKey::new(seed, "uncertain", &parameter.name()),
    };
    directions.filter(is_free).map(uncertain).collect()
}

fn find_uncertain(
    name: &str,
    base: &Base,
    swept: &[Parameter],
    factor: bool,
) -> Result<Parameter, Fault> {
    let parameter = find_parameter(name, &base.model)?;
    if !parameter.is_number() {
        return Err(Fault::new("not a number", name, "a numeric parameter (or sweep it)"));
    }
    base.check_varied(parameter)?;
    // A factor multiplies a known nominal value: that of the same parameter. It cannot combine the
    // value of all balls with that of one ball.
    let clash = |other: &&Parameter| {
        (**other == parameter && !factor)
            || other.general() == Some(parameter)
            || (factor && parameter.general() == Some(**other))
    };
    match swept.iter().find(clash) {
        None => Ok(parameter),
        Some(other) => Err(Fault::new(
            "both uncertain and swept",
            format!("{name} here and {} in `sweep`", other.name()),
            "either a distribution or a sweep, or `times` with the distribution of a factor",
        )),
    }
}
