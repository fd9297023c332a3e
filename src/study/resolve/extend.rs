//! Resolution of the key `simulation.extend`.

use crate::model::Extend;
use crate::study::error::{Fault, StudyError, list_names, shorten};
use crate::study::file::schema_parts::EXTENDED_LABELS;
use crate::study::file::study_file::ExtendFile;
use crate::study::file::yaml_tree::{Source, describe_number};

/// The largest ratio of the later end time to the end time.
const LARGEST_FACTOR: f64 = 1000.0;

/// Validates the extension.
///
/// # Errors
/// Returns an error if the factor is not above 1, is too large, or makes the end time infinite; if
/// there are no labels or a label is repeated; or if a run with a label cannot be continued.
pub(crate) fn resolve_extend(
    source: &Source,
    written: &ExtendFile,
    end_time_s: f64,
) -> Result<Extend, StudyError> {
    let factor = written.factor;
    let extends = factor > 1.0 && factor <= LARGEST_FACTOR;
    // Rounding may lose a factor slightly above 1, and a long end time may overflow.
    if !(extends && factor * end_time_s > end_time_s && (factor * end_time_s).is_finite()) {
        let problem = if factor <= 1.0 { "extends nothing" } else { "too far" };
        let allowed = format!("more than 1, at most {LARGEST_FACTOR}");
        let fault = Fault::new(problem, describe_number(factor), allowed);
        return Err(source.path("simulation.extend.factor").refuse_value(fault));
    }
    let path = source.path("simulation.extend.labels");
    let names: Vec<&str> = match &written.labels {
        None => EXTENDED_LABELS.to_vec(),
        Some(labels) => labels.iter().map(String::as_str).collect(),
    };
    if names.is_empty() {
        let allowed =
            format!("one of {} at least, or no `labels` for both", EXTENDED_LABELS.join(", "));
        return Err(path.wrong_value("no labels", "an empty list", allowed));
    }
    for (index, name) in names.iter().enumerate() {
        let problem = match *name {
            _ if names[..index].contains(name) => "the label is given twice",
            name if EXTENDED_LABELS.contains(&name) => continue,
            "equilibrium" | "limit_cycle" => "a run with this label has already ended",
            "failed" => "a run that failed cannot be continued",
            _ => "unknown label",
        };
        let fault = Fault::new(problem, shorten(name), list_names(name, &EXTENDED_LABELS));
        return Err(path.item(index).refuse_value(fault));
    }
    let [undecided, irregular] = EXTENDED_LABELS.map(|label| names.contains(&label));
    Ok(Extend { factor, undecided, irregular })
}

/// Returns the extension in the form of a study file, with all values.
pub(crate) fn extend_to_file(extend: Extend) -> ExtendFile {
    let continued = [extend.undecided, extend.irregular];
    let labels = EXTENDED_LABELS.into_iter().zip(continued).filter(|(_, continued)| *continued);
    ExtendFile {
        factor: extend.factor,
        labels: Some(labels.map(|(label, _)| label.to_owned()).collect()),
    }
}
