//! What the search for the best design is asked for, validated.

use indexmap::IndexMap;

use crate::analysis::Measure;
use crate::study::error::{Fault, StudyError, list_names};
use crate::study::file::searches_file::{
    LimitFile, MAX_DESIGNS, OptimizeFile, ResponseNames, SensitivityFile, SensitivityFrom,
};
use crate::study::file::source::{Source, SourcePath};
use crate::study::file::values::{Count, Entry};
use crate::study::file::yaml_tree::describe_number;
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::planned_study::Designs;
use crate::study::plan::response::Response;
use crate::study::plan::searches::{Limit, Objective, Optimization};
use crate::study::plan::variable::DesignValue;

/// The largest number of variables. There are 256 Sobol' dimensions, and the Sobol' indices need
/// two per variable.
const MAX_VARIABLES: usize = 100;

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
    let usual = (5 * variables).max(10).min(Count::or(file.designs, MAX_DESIGNS));
    let start_designs = Count::or(file.start_designs, usual);
    let designs = Count::or(file.designs, (4 * start_designs).min(MAX_DESIGNS));
    if start_designs > designs {
        let found = format!("{start_designs} of {designs} designs");
        let fault = Fault::new("more designs at the start than in all", found, "at most `designs`");
        return Err(goals.path.key("start_designs").refuse_value(fault));
    }
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
