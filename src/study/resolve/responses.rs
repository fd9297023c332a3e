//! The responses of a study, validated.

use std::collections::HashSet;

use indexmap::IndexMap;

use crate::study::error::{Fault, StudyError};
use crate::study::file::response_file::ResponseFile;
use crate::study::file::source_path::SourcePath;
use crate::study::file::yaml_tree::{Source, describe_number};
use crate::study::plan::planned_study::Study;
use crate::study::plan::response::{Measure, RESERVED_COLUMNS, Response, SUFFIXES};
use crate::study::resolve::names::check_column_name;

/// Validates the responses.
///
/// # Errors
/// Returns an error if a name cannot be the name of a column, if a number is invalid, or if
/// `relative` is set for a model without balls.
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
        let (measure, relative) = measure(study, &path, file)?;
        if relative && !study.model().kind().offers.vibration {
            let found = format!("kind: {}", study.model().kind().name);
            let fault = Fault::new("only for a ball balancer", found, "relative: false");
            return Err(path.refuse_value(fault));
        }
        Ok(Response { name: name.clone(), measure, relative })
    };
    written.into_iter().flatten().map(resolve).collect()
}

fn measure(
    study: &Study,
    path: &SourcePath<'_>,
    file: &ResponseFile,
) -> Result<(Measure, bool), StudyError> {
    Ok(match *file {
        ResponseFile::AmplitudeMean { relative } => (Measure::Mean, relative),
        ResponseFile::AmplitudeStdDev { relative } => (Measure::StandardDeviation, relative),
        ResponseFile::AmplitudeWorst { relative } => (Measure::Worst, relative),
        ResponseFile::AmplitudeQuantile { fraction, relative } => {
            if !(fraction > 0.0 && fraction < 1.0) {
                let fault =
                    Fault::new("not a fraction", describe_number(fraction), "above 0 and below 1");
                return Err(path.key("amplitude_quantile").key("fraction").refuse_value(fault));
            }
            (Measure::Quantile(fraction), relative)
        }
        ResponseFile::AmplitudeAbove { limit, relative } => {
            if limit < 0.0 {
                let fault = Fault::new("not an amplitude", describe_number(limit), "0 or more");
                return Err(path.key("amplitude_above").key("limit").refuse_value(fault));
            }
            (Measure::Above(limit), relative)
        }
        ResponseFile::AtRestByS(time) => {
            let [_, end] = study.simulation().end_times_s();
            if !(time > 0.0 && time <= end) {
                let allowed = format!("above 0, at most the end time, {}", describe_number(end));
                let fault =
                    Fault::new("a time that no run reaches", describe_number(time), allowed);
                return Err(path.key("at_rest_by_s").refuse_value(fault));
            }
            (Measure::AtRestBy(time), false)
        }
        ResponseFile::MedianTimeToRest => (Measure::MedianTimeToRest, false),
    })
}
