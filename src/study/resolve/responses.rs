//! The responses of a study, validated.

use std::collections::HashSet;

use indexmap::IndexMap;

use crate::study::error::{Fault, StudyError};
use crate::study::file::response_file::{Amplitude, AmplitudeFile, ResponseFile};
use crate::study::file::source_path::SourcePath;
use crate::study::file::values::NumberOrLength;
use crate::study::file::yaml_tree::{Content, Source, describe_number};
use crate::study::plan::planned_study::Study;
use crate::study::plan::response::{AmplitudeKind, Measure, RESERVED_COLUMNS, Response, SUFFIXES};
use crate::study::resolve::names::check_column_name;

/// Validates the responses.
///
/// # Errors
/// Returns an error if a name cannot be the name of a column, if a number is invalid, or if the runs do not have the
/// amplitude.
pub(crate) fn resolve_responses(
    source: &Source,
    study: &Study,
    written: Option<&IndexMap<String, ResponseFile>>,
) -> Result<Vec<Response>, StudyError> {
    let path = source.path("responses");
    let mut columns = HashSet::new();
    let resolve = |(name, file): (&String, &ResponseFile)| {
        let path = path.key(name);
        check_column_name(name).map_err(|fault| path.refuse_key(fault))?;
        let own = std::iter::once("").chain(SUFFIXES).map(|suffix| format!("{name}{suffix}"));
        for column in own {
            let swept = study.swept().iter().any(|swept| swept.name == column);
            if swept
                || RESERVED_COLUMNS.contains(&column.as_str())
                || !columns.insert(column.clone())
            {
                let fault = Fault::new("another column has this name", column, "another name");
                return Err(path.refuse_key(fault));
            }
        }
        let measure = measure(study, &path, file)?;
        let amplitude = amplitude(study, &path, file)?;
        Ok(Response { name: name.clone(), measure, amplitude })
    };
    written.into_iter().flatten().map(resolve).collect()
}

/// Returns which amplitude a response measures.
fn amplitude(
    study: &Study,
    path: &SourcePath<'_>,
    file: &ResponseFile,
) -> Result<AmplitudeKind, StudyError> {
    let (key, Amplitude { relative, of }) = match *file {
        ResponseFile::AmplitudeMean(own) => ("amplitude_mean", own),
        ResponseFile::AmplitudeStdDev(own) => ("amplitude_std_dev", own),
        ResponseFile::AmplitudeQuantile { relative, of, .. } => {
            ("amplitude_quantile", Amplitude { relative, of })
        }
        ResponseFile::AmplitudeWorst(own) => ("amplitude_worst", own),
        ResponseFile::AmplitudeAbove { relative, of, .. } => {
            ("amplitude_above", Amplitude { relative, of })
        }
        ResponseFile::AtRestByS(_) | ResponseFile::MedianTimeToRest => {
            return Ok(AmplitudeKind::Residual);
        }
    };
    if relative && !study.model().kind().offers.vibration {
        let found = format!("kind: {}", study.model().kind().name);
        let fault = Fault::new("only for a ball balancer", found, "relative: false");
        return Err(path.refuse_value(fault));
    }
    let path = path.key(key);
    match (of, relative) {
        (AmplitudeFile::Residual, false) => Ok(AmplitudeKind::Residual),
        (AmplitudeFile::Residual, true) => Ok(AmplitudeKind::RelativeResidual),
        (AmplitudeFile::Peak, true) => {
            let problem = "a peak amplitude has no counterpart without balls";
            let fault = Fault::new(problem, "relative: true", "of: residual, or relative: false");
            Err(path.key("relative").refuse_value(fault))
        }
        (AmplitudeFile::Peak, false) if !study.has_stages() => {
            let problem = "no peak amplitude at constant speed without disturbances";
            let allowed = "of: residual, or a speed_profile or disturbances in the model";
            Err(path.key("of").refuse_value(Fault::new(problem, "of: peak", allowed)))
        }
        (AmplitudeFile::Peak, false) => Ok(AmplitudeKind::Peak),
    }
}

fn measure(
    study: &Study,
    path: &SourcePath<'_>,
    file: &ResponseFile,
) -> Result<Measure, StudyError> {
    Ok(match *file {
        ResponseFile::AmplitudeMean(_) => Measure::Mean,
        ResponseFile::AmplitudeStdDev(_) => Measure::StandardDeviation,
        ResponseFile::AmplitudeWorst(_) => Measure::Worst,
        ResponseFile::AmplitudeQuantile { fraction, .. } => {
            if !(fraction > 0.0 && fraction < 1.0) {
                let fault =
                    Fault::new("not a fraction", describe_number(fraction), "above 0 and below 1");
                return Err(path.key("amplitude_quantile").key("fraction").refuse_value(fault));
            }
            Measure::Quantile(fraction)
        }
        ResponseFile::AmplitudeAbove { limit: NumberOrLength(limit), relative, .. } => {
            let path = path.key("amplitude_above").key("limit");
            let text = path.node().filter(|node| matches!(node.content, Content::Text(_)));
            if let Some(node) = text.filter(|_| relative) {
                return Err(path.refuse_value(Fault::new(
                    "a value with a unit, although `relative` is true",
                    node.describe(),
                    "a number, the amplitude over that without balls; or `relative: false`",
                )));
            }
            if limit < 0.0 {
                let fault = Fault::new("not an amplitude", describe_number(limit), "0 or more");
                return Err(path.refuse_value(fault));
            }
            Measure::Above(limit)
        }
        ResponseFile::AtRestByS(time) => {
            let [_, end] = study.simulation().end_times_s();
            if !(time > 0.0 && time <= end) {
                let allowed = format!("above 0, at most the end time, {}", describe_number(end));
                let fault =
                    Fault::new("a time that no run reaches", describe_number(time), allowed);
                return Err(path.key("at_rest_by_s").refuse_value(fault));
            }
            Measure::AtRestBy(time)
        }
        ResponseFile::MedianTimeToRest => Measure::MedianTimeToRest,
    })
}
