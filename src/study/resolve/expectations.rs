//! The expectations of a study, validated.

use crate::model::Endings;
use crate::study::error::{StudyError, list_names, low_high, shorten};
use crate::study::file::source::{Source, SourcePath};
use crate::study::file::study_file::ExpectationFile;
use crate::study::file::values::Range;
use crate::study::plan::expectation::Expectation;
use crate::study::plan::parameter::ParameterValue;
use crate::study::plan::planned_runs::Plan;
use crate::study::resolve::sweep::resolve_value;

/// Validates the expectations of a study.
///
/// # Errors
/// Returns an error if a selector names a parameter that is not swept or a value that no point has,
/// if an expectation has no range, or if a range is not within 0 and 1.
pub(crate) fn resolve_expectations(
    source: &Source,
    plan: &Plan,
    written: &[ExpectationFile],
) -> Result<Vec<Expectation>, StudyError> {
    let resolve = |(index, file): (usize, &ExpectationFile)| {
        let path = source.path("expect").item(index);
        let point = resolve_selector(plan, &path.key("point"), file)?;
        let expectation = Expectation {
            point,
            fractions: fractions(plan, &path, file)?,
            audit_flip_rate: audit_flip_rate(plan, &path, file)?,
        };
        if !plan.has_point(&expectation) {
            let found: Vec<String> =
                expectation.point.iter().map(|(name, value)| format!("{name} {value}")).collect();
            return Err(path.key("point").wrong_value(
                "no point of the sweep has these values",
                found.join(", "),
                "values of one point of the sweep",
            ));
        }
        Ok(expectation)
    };
    written.iter().enumerate().map(resolve).collect()
}

fn resolve_selector(
    plan: &Plan,
    path: &SourcePath<'_>,
    file: &ExpectationFile,
) -> Result<Vec<(String, ParameterValue)>, StudyError> {
    let mut point = Vec::new();
    for (name, entry) in file.point.iter().flatten() {
        let path = path.key(name);
        let parameters = &plan.swept_parameters;
        let Some(parameter) = parameters.iter().find(|parameter| parameter.name() == *name) else {
            let names: Vec<String> = parameters.iter().map(|other| other.name()).collect();
            let allowed = match list_names(name, &names) {
                list if list.is_empty() => "no `point`: this study sweeps no parameter".to_owned(),
                list => list,
            };
            return Err(path.wrong_key("not a swept parameter", shorten(name), allowed));
        };
        let value = resolve_value(*parameter, entry, plan.model())
            .map_err(|fault| path.refuse_value(fault))?;
        point.push((name.clone(), value));
    }
    Ok(point)
}

fn fractions(
    plan: &Plan,
    path: &SourcePath<'_>,
    file: &ExpectationFile,
) -> Result<Vec<(&'static str, [f64; 2])>, StudyError> {
    let mut fractions = Vec::new();
    for (label, range) in [
        ("equilibrium", file.equilibrium_fraction),
        ("limit_cycle", file.limit_cycle_fraction),
        ("periodic", file.periodic_fraction),
        ("creep", file.creep_fraction),
        ("quasi_periodic", file.quasi_periodic_fraction),
        ("irregular", file.irregular_fraction),
        ("undecided", file.undecided_fraction),
        ("failed", file.failed_fraction),
    ] {
        let Some(range) = range else { continue };
        let path = path.key(&format!("{label}_fraction"));
        let only_rest = plan.simulation().endings == Endings::Rest;
        if only_rest && !["equilibrium", "undecided", "failed"].contains(&label) {
            let allowed = "simulation: {endings: all}, or no expectation of this label";
            let found = "a study with `endings: rest`";
            return Err(path.wrong_key("the study does not detect this label", found, allowed));
        }
        fractions.push((label, range_of_fractions(&path, range)?));
    }
    if fractions.is_empty() && file.audit_flip_rate.is_none() {
        let allowed = "at least one of equilibrium_fraction, limit_cycle_fraction, periodic_fraction, creep_fraction, \
                       quasi_periodic_fraction, irregular_fraction, undecided_fraction, failed_fraction, audit_flip_rate";
        return Err(path.wrong_value("nothing is expected", "no range", allowed));
    }
    Ok(fractions)
}

fn audit_flip_rate(
    plan: &Plan,
    path: &SourcePath<'_>,
    file: &ExpectationFile,
) -> Result<Option<[f64; 2]>, StudyError> {
    let Some(range) = file.audit_flip_rate else { return Ok(None) };
    let path = path.key("audit_flip_rate");
    if plan.audit().is_none() {
        let allowed =
            "an audit in the study, such as audit: {fraction: 0.05}, or no `audit_flip_rate`";
        return Err(path.wrong_key("the study has no audit", "a study without `audit`", allowed));
    }
    range_of_fractions(&path, range).map(Some)
}

fn range_of_fractions(path: &SourcePath<'_>, range: Range) -> Result<[f64; 2], StudyError> {
    let [low, high] = range.0;
    if 0.0 <= low && low <= high && high <= 1.0 {
        return Ok(range.0);
    }
    let allowed = "0 <= low <= high <= 1";
    Err(path.wrong_value("not a range of fractions", low_high(low, high), allowed))
}
