//! From uncertain parameters as written to checked distributions with the keys of their draws.

use super::distribution::Distribution;
use super::draw::DrawKey;
use super::error::{Fault, Locate, StudyError};
use super::file::DistributionFile;
use super::file_values::Named;
use super::key_path::KeyPath;
use super::node::describe_number;
use super::parameter::Parameter;
use super::resolve_model::Base;
use super::resolve_sweep::find_parameter;

/// A parameter that is drawn for every run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Uncertain {
    /// The parameter.
    pub parameter: Parameter,
    /// Its distribution.
    pub distribution: Distribution,
    /// The key of its draws.
    pub key: DrawKey,
}

/// Checks the uncertain parameters, in the order of the model's parameters.
///
/// # Errors
/// A name that is no numeric parameter, one that is swept as well, a distribution without
/// meaning or with bounds that its parameter cannot take.
pub(crate) fn resolve_uncertain(
    locate: &dyn Locate,
    written: Option<&Named<DistributionFile>>,
    base: &Base,
    swept: &[Parameter],
    seed: u64,
) -> Result<Vec<Uncertain>, StudyError> {
    let mut all = Vec::new();
    for (name, distribution) in written.iter().flat_map(|named| &named.0) {
        let path = KeyPath::of("uncertain").key(name);
        let parameter =
            find_uncertain(name, base, swept).map_err(|fault| locate.refuse_key(&path, fault))?;
        let path = path.key(kind(distribution));
        let distribution = Distribution::resolve(distribution)
            .map_err(|(key, fault)| locate.refuse_value(&path.key(key), fault))?;
        for (key, bound) in distribution.bounds() {
            // Draws stay strictly inside a range, so that its end may itself be just too small.
            let inside = if key == "min" { bound.next_up() } else { bound };
            if let (Err(allowed), Err(_)) =
                (parameter.check(bound, &base.model), parameter.check(inside, &base.model))
            {
                let fault = Fault::new("no physical meaning", describe_number(bound), allowed);
                return Err(locate.refuse_value(&path.key(key), fault));
            }
        }
        let key = DrawKey::new(seed, "uncertain", name);
        all.push(Uncertain { parameter, distribution, key });
    }
    all.sort_by_key(|uncertain| uncertain.parameter);
    Ok(all)
}

fn find_uncertain(name: &str, base: &Base, swept: &[Parameter]) -> Result<Parameter, Fault> {
    let parameter = find_parameter(name, &base.model)?;
    if !parameter.is_number() {
        return Err(Fault::new("not a number", name, "a numeric parameter (or sweep it)"));
    }
    base.check_varied(parameter)?;
    let clash = |other: &&Parameter| **other == parameter || other.general() == Some(parameter);
    match swept.iter().find(clash) {
        None => Ok(parameter),
        Some(other) => Err(Fault::new(
            "both uncertain and swept",
            format!("{name} here and {} in `sweep`", other.name()),
            "either a distribution or a sweep for a parameter",
        )),
    }
}

fn kind(distribution: &DistributionFile) -> &'static str {
    match distribution {
        DistributionFile::Normal { .. } => "normal",
        DistributionFile::TruncatedNormal { .. } => "truncated_normal",
        DistributionFile::Lognormal { .. } => "lognormal",
        DistributionFile::Uniform { .. } => "uniform",
        DistributionFile::Triangular { .. } => "triangular",
        DistributionFile::Choice { .. } => "choice",
    }
}
