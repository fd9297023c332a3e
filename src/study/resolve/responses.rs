//! The responses of a study, validated.

use std::collections::HashSet;

use indexmap::IndexMap;

use crate::analysis::Measure;
use crate::model::{OutputName, OutputValue};
use crate::study::error::{StudyError, describe_number, list_names};
use crate::study::file::source::{Source, SourcePath};
use crate::study::file::yaml_tree::Content;
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::response::{
    Amplitude, AmplitudeKind, Response, ResponseFile, SUFFIXES, is_reserved,
};
use crate::study::resolve::names::check_column_name;

/// Validates the responses.
///
/// # Errors
/// Returns an error if a name cannot be the name of a column, if a number is invalid, or if the runs do not have the
/// amplitude.
pub(crate) fn resolve_responses(
    source: &Source,
    plan: &Plan,
    written: Option<&IndexMap<String, ResponseFile>>,
) -> Result<Vec<Response>, StudyError> {
    let path = source.path("responses");
    let mut columns = HashSet::new();
    let resolve = |(name, file): (&String, &ResponseFile)| {
        let path = path.key(name);
        check_column_name(name).map_err(|fault| path.refuse_key(fault))?;
        let names = std::iter::once("").chain(SUFFIXES).map(|suffix| format!("{name}{suffix}"));
        for column in names {
            let swept = plan.swept().iter().any(|swept| swept.name == column);
            if swept || is_reserved(&column) || !columns.insert(column.clone()) {
                return Err(path.wrong_key("another column has this name", column, "another name"));
            }
        }
        let (measure, amplitude, output) = quantity(plan, &path, file)?;
        Ok(Response { name: name.clone(), measure, amplitude, output })
    };
    written.into_iter().flatten().map(resolve).collect()
}

/// A measure, and the amplitude that is measured, with the name and the unit of an output.
type Quantity = (Measure, AmplitudeKind, Option<(String, String)>);

/// Returns the measure of a response and the amplitude that it measures, with name and unit if that is one of an output.
fn quantity(
    plan: &Plan,
    path: &SourcePath<'_>,
    file: &ResponseFile,
) -> Result<Quantity, StudyError> {
    let (measure, Amplitude { relative, of }) = file.parts();
    let at = path.chosen();
    let refuse = |path: &SourcePath<'_>, problem: &str, found: String, allowed: &str| {
        Err(path.wrong_value(problem, found, allowed))
    };
    match measure {
        Measure::Above(_) => {
            let path = at.key("limit");
            let text = path.node().filter(|node| matches!(node.content, Content::Text(_)));
            if let Some(node) = text.filter(|_| relative) {
                let problem = "a value with a unit, although `relative` is true";
                let allowed =
                    "a number, the amplitude over that without balls; or `relative: false`";
                return refuse(&path, problem, node.describe(), allowed);
            }
        }
        Measure::AtRestBy(time) => {
            let [_, end] = plan.simulation().end_times_s();
            if time > end {
                let allowed = format!("above 0, at most the end time, {}", describe_number(end));
                return refuse(&at, "a time that no run reaches", describe_number(time), &allowed);
            }
        }
        _ => {}
    }
    if relative && !plan.model().kind().offers.vibration {
        let found = format!("kind: {}", plan.model().kind().name);
        return refuse(path, "only for a ball balancer", found, "relative: false");
    }
    let amplitude = match (of.0.as_str(), relative) {
        ("residual", false) => AmplitudeKind::Residual,
        ("residual", true) => AmplitudeKind::RelativeResidual,
        ("peak", true) => {
            let problem = "a peak amplitude has no counterpart without balls";
            let allowed = "of: residual, or relative: false";
            return refuse(&at.key("relative"), problem, "relative: true".to_owned(), allowed);
        }
        ("peak", false) if plan.model().kind().offers.vibration && !plan.has_stages() => {
            let problem = "no peak amplitude at constant speed without disturbances";
            let allowed = "of: residual, or a speed_profile or disturbances in the model";
            return refuse(&at.key("of"), problem, "of: peak".to_owned(), allowed);
        }
        ("peak", false) if plan.has_peaks() => AmplitudeKind::Peak,
        (name, _) => {
            let outputs = plan.model().output_names();
            let each = outputs.iter().enumerate();
            let mut all = each.flat_map(|(place, OutputName { name, unit, .. })| {
                let values = OutputValue::COLUMNS
                    .into_iter()
                    .chain([OutputValue::CREEP, ("", OutputValue::Amplitude)]);
                values.map(move |(before, value)| {
                    (format!("{before}{name}"), AmplitudeKind::Output(place, value), unit)
                })
            });
            if let Some((column, amplitude, unit)) = all.find(|(column, ..)| column == name) {
                return Ok((measure, amplitude, Some((column, unit.clone()))));
            }
            let mut names = vec!["residual".to_owned()];
            names.extend(plan.has_peaks().then(|| "peak".to_owned()));
            names.extend(outputs.iter().map(|output| output.name.clone()));
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let (problem, allowed) = ("not a quantity of a run", list_names(name, &names));
            return refuse(&at.key("of"), problem, name.to_owned(), &allowed);
        }
    };
    Ok((measure, amplitude, None))
}
