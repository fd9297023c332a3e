//! Resolution of the key `identify`.

use indexmap::IndexMap;

use crate::study::error::{Fault, StudyError};
use crate::study::file::searches_file::{
    IdentifyFile, MOST_DESIGNS, MOST_PARAMETERS, PriorFile, PriorSpacing,
};
use crate::study::file::source::Source;
use crate::study::file::values::Count;
use crate::study::file::yaml_tree::describe_number;
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::response::Response;
use crate::study::plan::searches::Identification;
use crate::study::plan::variable::VariableFile;
use crate::study::resolve::variables::resolve_variables;

/// The default number of samples of the posterior.
const USUAL_SAMPLES: u64 = 4000;
/// The default number of initial parameter sets for one parameter, two, and more.
const USUAL_START: [u64; 3] = [128, 1000, 2000];

/// Validates the key `identify`.
pub(crate) fn resolve_identification(
    source: &Source,
    plan: &Plan,
    responses: &[Response],
    written: Option<&IdentifyFile>,
) -> Result<Option<Identification>, StudyError> {
    let Some(file) = written else { return Ok(None) };
    let path = source.path("identify");
    if plan.sweeps_balls() {
        let allowed =
            "a sweep without `balls`; compare the fit of two studies for numbers of balls";
        let fault = Fault::new("a sweep over the number of balls", "`balls` in `sweep`", allowed);
        return Err(path.refuse_key(fault));
    }
    let section = path.key("parameters");
    if file.parameters.is_empty() || file.parameters.len() > MOST_PARAMETERS {
        let found = format!("{} parameters", file.parameters.len());
        let allowed = format!("1 to {MOST_PARAMETERS} parameters, each with `from` and `to`");
        return Err(section.wrong_value("nothing to identify, or too much", found, allowed));
    }
    let mut ranges: IndexMap<String, VariableFile> = IndexMap::new();
    let mut spacings = Vec::new();
    for (name, PriorFile { from, to, spacing }) in &file.parameters {
        let path = section.key(name);
        if name == "balls" {
            let allowed =
                "a numeric parameter; compare the fit of two studies for numbers of balls";
            return Err(path.wrong_key("not a number to infer", name.as_str(), allowed));
        }
        if from.total_cmp(to).is_ge() {
            let found = format!("from {} to {}", describe_number(*from), describe_number(*to));
            return Err(path.wrong_value("an empty range", found, "`from` below `to`"));
        }
        let spacing = spacing.unwrap_or_default();
        if spacing == PriorSpacing::Logarithmic && *from <= 0.0 {
            let problem = "a logarithmic range that is not positive";
            let allowed = "`from` above 0, or `spacing: linear`";
            let fault = Fault::new(problem, format!("from {}", describe_number(*from)), allowed);
            return Err(path.key("from").refuse_value(fault));
        }
        spacings.push(spacing);
        let range = VariableFile { from: Some(*from), to: Some(*to), choices: None };
        ranges.insert(name.clone(), range);
    }
    let parameters = resolve_variables(&section, plan, responses, Some(&ranges))?;
    let usual = USUAL_START[parameters.len().clamp(1, USUAL_START.len()) - 1];
    let usual = usual.min(Count::or(file.designs, MOST_DESIGNS));
    let start = Count::or(file.start_designs, usual);
    let designs = Count::or(file.designs, (start + start / 4).min(MOST_DESIGNS));
    if start > designs {
        let found = format!("{start} of {designs} parameter sets");
        let problem = "more parameter sets at the start than in all";
        return Err(path.key("start_designs").wrong_value(problem, found, "at most `designs`"));
    }
    Ok(Some(Identification {
        parameters,
        spacings,
        start_designs: start,
        designs,
        posterior_samples: Count::or(file.posterior_samples, USUAL_SAMPLES),
    }))
}
