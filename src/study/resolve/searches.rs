//! Resolution of the keys `optimize` and `identify`.

use indexmap::IndexMap;

use crate::analysis::Measure;
use crate::study::error::{Fault, StudyError, describe_number, from_to, list_names};
use crate::study::file::searches_file::{
    IdentifyFile, LimitFile, MAX_DESIGNS, MOST_DESIGNS, MOST_PARAMETERS, OptimizeFile, PriorFile,
    PriorSpacing, ResponseNames, SensitivityFile, SensitivityFrom,
};
use crate::study::file::source::{Source, SourcePath};
use crate::study::file::values::{Count, Entry};
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::planned_study::Designs;
use crate::study::plan::response::Response;
use crate::study::plan::searches::{Identification, Limit, Objective, Optimization};
use crate::study::plan::variable::{DesignValue, VariableFile};
use crate::study::resolve::variables::resolve_variables;

/// The largest number of variables. There are 256 Sobol' dimensions, and the Sobol' indices need
/// two per variable.
const MAX_VARIABLES: usize = 100;
/// The default number of samples of the posterior.
const USUAL_SAMPLES: u64 = 4000;
/// The default number of initial parameter sets for one parameter, two, and more.
const USUAL_START: [u64; 3] = [128, 1000, 2000];

/// Validates the key `optimize`.
///
/// # Errors
/// Returns an error if a response or variable is unknown, if the number of objectives is not one or
/// two, if no value meets a limit, or if the reference design is invalid.
pub(crate) fn resolve_optimization(
    source: &Source,
    plan: &Plan,
    designs: &Designs,
    responses: &[Response],
    written: Option<&OptimizeFile>,
) -> Result<Option<Optimization>, StudyError> {
    let Some(file) = written else { return Ok(None) };
    let goals = Goals { plan, designs, responses, path: source.path("optimize") };
    for (empty, key, example) in [
        (designs.variables.is_empty(), "design", "{speed_rad_s: {from: -260, to: -140}}"),
        (responses.is_empty(), "responses", "{vibration: {amplitude_mean: {}}}"),
    ] {
        if empty {
            return Err(goals.path.wrong_key(
                format!("`optimize` without `{key}`"),
                format!("no `{key}`"),
                format!("`{key}` in the study, such as {key}: {example}"),
            ));
        }
    }
    if designs.variables.len() > MAX_VARIABLES {
        let found = format!("{} variables", designs.variables.len());
        let fault = Fault::new("too many variables", found, format!("at most {MAX_VARIABLES}"));
        return Err(source.path("design").refuse_key(fault));
    }
    let objectives = goals.objectives(file)?;
    let limits = goals.limits(file.subject_to.as_ref())?;
    let variables = designs.variables.len() as u64;
    let given = [file.start_designs, file.designs];
    let usual = (5 * variables).max(10);
    let [start_designs, designs] =
        effort(&goals.path, given, usual, |start| 4 * start, MAX_DESIGNS, "designs")?;
    let sensitivity = file.sensitivity.unwrap_or(SensitivityFile { from: None, samples: None });
    let from = sensitivity.from.unwrap_or_default();
    let default = if from == SensitivityFrom::Runs { 64 } else { 1024 };
    Ok(Some(Optimization {
        objectives,
        limits,
        over_points: file.over_points.unwrap_or_default(),
        start_designs,
        designs,
        finalists: Count::or(file.finalists, 5),
        final_samples: Count::or(file.final_samples, 16),
        sensitivity_from: from,
        sensitivity_samples: Count::or(sensitivity.samples, default),
        compare_with: file
            .compare_with
            .as_ref()
            .map(|values| goals.compare_with(values))
            .transpose()?,
    }))
}

/// Returns the numbers of designs at the start and in total, which is at most `most`. By default, the start has the `usual`
/// number, and the total is a function of it. `what` are the designs in words.
fn effort(
    path: &SourcePath<'_>,
    [start, total]: [Option<Count>; 2],
    usual: u64,
    usual_total: impl Fn(u64) -> u64,
    most: u64,
    what: &str,
) -> Result<[u64; 2], StudyError> {
    let start = Count::or(start, usual.min(Count::or(total, most)));
    let total = Count::or(total, usual_total(start).min(most));
    if start > total {
        let problem = format!("more {what} at the start than in all");
        let found = format!("{start} of {total} {what}");
        return Err(path.key("start_designs").wrong_value(problem, found, "at most `designs`"));
    }
    Ok([start, total])
}

/// The objectives and limits, and the study that they belong to.
struct Goals<'a> {
    plan: &'a Plan,
    designs: &'a Designs,
    responses: &'a [Response],
    path: SourcePath<'a>,
}

impl Goals<'_> {
    fn response(&self, name: &str) -> Result<usize, Fault> {
        let responses = self.responses;
        responses.iter().position(|known| known.name == name).ok_or_else(|| {
            let names: Vec<&str> = responses.iter().map(|known| known.name.as_str()).collect();
            Fault::new("not a response", name, list_names(name, &names))
        })
    }

    fn objectives(&self, file: &OptimizeFile) -> Result<Vec<Objective>, StudyError> {
        let mut objectives: Vec<Objective> = Vec::new();
        for (key, names, maximize) in
            [("minimize", &file.minimize, false), ("maximize", &file.maximize, true)]
        {
            let path = self.path.key(key);
            for name in names.iter().flat_map(ResponseNames::as_slice) {
                let response = self.response(name).map_err(|fault| path.refuse_value(fault))?;
                if objectives.iter().any(|other| other.response == response) {
                    return Err(path.wrong_value("an objective twice", name.as_str(), "each once"));
                }
                let worst = self.responses.get(response).map(|found| found.measure);
                if worst == Some(Measure::Worst) {
                    let problem = "an objective that is bounded from below only";
                    let allowed = "a quantile, such as amplitude_quantile: {fraction: 0.95}";
                    return Err(path.wrong_value(problem, name.as_str(), allowed));
                }
                objectives.push(Objective { response, maximize });
            }
        }
        if (1..=2).contains(&objectives.len()) {
            return Ok(objectives);
        }
        let found = format!("{} objectives", objectives.len());
        let allowed = "one or two responses under `minimize` and `maximize` together";
        Err(self.path.wrong_key("no objective, or too many", found, allowed))
    }

    fn limits(
        &self,
        written: Option<&IndexMap<String, LimitFile>>,
    ) -> Result<Vec<Limit>, StudyError> {
        let path = self.path.key("subject_to");
        let mut limits = Vec::new();
        for (name, LimitFile { at_least, at_most }) in written.into_iter().flatten() {
            let path = path.key(name);
            let response = self.response(name).map_err(|fault| path.refuse_key(fault))?;
            let refuse = |fault| Err(path.refuse_value(fault));
            match (at_least, at_most) {
                (None, None) => {
                    let allowed = "`at_least`, `at_most` or both";
                    return refuse(Fault::new("a limit without a number", "nothing", allowed));
                }
                (Some(least), Some(most)) if least > most => {
                    let found = format!(
                        "at least {} and at most {}",
                        describe_number(*least),
                        describe_number(*most)
                    );
                    let allowed = "`at_least` not above `at_most`";
                    return refuse(Fault::new("limits that nothing meets", found, allowed));
                }
                _ => {}
            }
            let probability = matches!(
                self.responses.get(response).map(|found| found.measure),
                Some(Measure::Above(_) | Measure::AtRestBy(_))
            );
            let impossible = at_least.filter(|least| probability && *least > 1.0);
            if let Some(end) = impossible.or(at_most.filter(|most| probability && *most < 0.0)) {
                let allowed = "limits of a probability, from 0 to 1";
                return refuse(Fault::new("nothing meets it", describe_number(end), allowed));
            }
            let ends = [(at_least, true), (at_most, false)];
            limits
                .extend(ends.into_iter().filter_map(|(value, least)| {
                    Some(Limit { response, value: (*value)?, least })
                }));
        }
        Ok(limits)
    }

    fn compare_with(
        &self,
        written: &IndexMap<String, Entry>,
    ) -> Result<Vec<DesignValue>, StudyError> {
        let path = self.path.key("compare_with");
        let variables = &self.designs.variables;
        let names: Vec<&str> = variables.iter().map(|variable| variable.name()).collect();
        if let Some(name) = written.keys().find(|name| !names.contains(&name.as_str())) {
            let fault = Fault::new("not a variable", name.as_str(), list_names(name, &names));
            return Err(path.key(name).refuse_key(fault));
        }
        let mut values = Vec::with_capacity(variables.len());
        for variable in variables {
            let path = path.key(variable.name());
            let value = match written.get(variable.name()) {
                Some(Entry::Number(number)) => variable.number(*number),
                Some(Entry::Text(word)) => variable.word(word),
                None => Err(Fault::new("missing key", "no such key", variable.allowed())),
            };
            values.push(value.map_err(|fault| path.refuse_value(fault))?);
        }
        self.designs.set(self.plan, &values).map_err(|fault| path.refuse_value(fault))?;
        Ok(values)
    }
}

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
            let found = from_to(*from, *to);
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
    let given = [file.start_designs, file.designs];
    let further = |start| start + start / 4;
    let [start_designs, designs] =
        effort(&path, given, usual, further, MOST_DESIGNS, "parameter sets")?;
    Ok(Some(Identification {
        parameters,
        spacings,
        start_designs,
        designs,
        posterior_samples: Count::or(file.posterior_samples, USUAL_SAMPLES),
    }))
}
