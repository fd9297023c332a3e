//! The responses of a study, validated.

use std::collections::HashSet;

use crate::study::error::{Fault, Locate, StudyError, shorten};
use crate::study::file::key_path::KeyPath;
use crate::study::file::response_file::ResponseFile;
use crate::study::file::values::Named;
use crate::study::file::yaml_tree::describe_number;
use crate::study::plan::planned_study::Study;
use crate::study::plan::response::{Measure, Response, SUFFIXES, TAKEN};

/// Validates the responses.
///
/// # Errors
/// Returns an error if a name cannot be the name of a column, if a number is invalid, or if
/// `relative` is set for a model without balls.
pub(crate) fn resolve_responses(
    locate: &dyn Locate,
    study: &Study,
    written: Option<&Named<ResponseFile>>,
) -> Result<Vec<Response>, StudyError> {
    let path = KeyPath::of("responses");
    let mut columns = HashSet::new();
    let resolve = |(name, file): &(String, ResponseFile)| {
        let path = path.key(name);
        check_name(name).map_err(|fault| locate.refuse_key(&path, fault))?;
        let own = std::iter::once("").chain(SUFFIXES).map(|suffix| format!("{name}{suffix}"));
        for column in own {
            let swept = study.swept().iter().any(|swept| swept.name == column);
            if swept || TAKEN.contains(&column.as_str()) || !columns.insert(column.clone()) {
                let fault = Fault::new("another column has this name", column, "another name");
                return Err(locate.refuse_key(&path, fault));
            }
        }
        let (measure, relative) = measure(study, file)
            .map_err(|(keys, fault)| locate.refuse_value(&below(&path, keys), fault))?;
        if relative && study.model().balls() == 0 {
            let found = format!("kind: {}", study.model().kind());
            let fault = Fault::new("only for a ball balancer", found, "relative: false");
            return Err(locate.refuse_value(&path, fault));
        }
        Ok(Response { name: name.clone(), measure, relative })
    };
    written.iter().flat_map(|named| &named.0).map(resolve).collect()
}

fn below(path: &KeyPath, keys: &[&str]) -> KeyPath {
    keys.iter().fold(path.clone(), |path, key| path.key(key))
}

/// Checks the name of a variable or response, which becomes a column and a key of results.
pub(crate) fn check_name(name: &str) -> Result<(), Fault> {
    let usual = |character: char| character.is_ascii_alphanumeric() || character == '_';
    let first = name.starts_with(|first: char| first.is_ascii_alphabetic());
    if first && name.len() <= 100 && name.chars().all(usual) {
        return Ok(());
    }
    let allowed = "1 to 100 letters, digits and `_`, beginning with a letter";
    Err(Fault::new("not a name", shorten(name), allowed))
}

type Misplaced = (&'static [&'static str], Fault);

fn measure(study: &Study, file: &ResponseFile) -> Result<(Measure, bool), Misplaced> {
    Ok(match *file {
        ResponseFile::AmplitudeMean { relative } => (Measure::Mean, relative),
        ResponseFile::AmplitudeStdDev { relative } => (Measure::StandardDeviation, relative),
        ResponseFile::AmplitudeWorst { relative } => (Measure::Worst, relative),
        ResponseFile::AmplitudeQuantile { fraction, relative } => {
            if !(fraction > 0.0 && fraction < 1.0) {
                let fault =
                    Fault::new("not a fraction", describe_number(fraction), "above 0 and below 1");
                return Err((&["amplitude_quantile", "fraction"], fault));
            }
            (Measure::Quantile(fraction), relative)
        }
        ResponseFile::AmplitudeAbove { limit, relative } => {
            if limit < 0.0 {
                let fault = Fault::new("not an amplitude", describe_number(limit), "0 or more");
                return Err((&["amplitude_above", "limit"], fault));
            }
            (Measure::Above(limit), relative)
        }
        ResponseFile::AtRestByS(time) => {
            let [_, end] = study.simulation().end_times_s();
            if !(time > 0.0 && time <= end) {
                let allowed = format!("above 0, at most the end time, {}", describe_number(end));
                let fault =
                    Fault::new("a time that no run reaches", describe_number(time), allowed);
                return Err((&["at_rest_by_s"], fault));
            }
            (Measure::AtRestBy(time), false)
        }
        ResponseFile::MedianTimeToRest => (Measure::MedianTimeToRest, false),
    })
}
