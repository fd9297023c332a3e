//! Resolution of the variables of a design.

use indexmap::IndexMap;

use crate::model::MAX_BALLS;
use crate::study::error::{Fault, StudyError, from_to};
use crate::study::file::source::SourcePath;
use crate::study::plan::parameter::{
    Parameter, ParameterKind, VariedParameter, check_number_of_balls,
};
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::response::{Response, SUFFIXES, is_reserved};
use crate::study::plan::variable::{Domain, Variable, VariableFile};
use crate::study::resolve::names::{check_column_name, check_name};
use crate::study::resolve::sweep::find_parameter;

/// Validates the variables at a place of the study file.
///
/// # Errors
/// Returns an error if a name or range is invalid, if a parameter is set twice, swept or uncertain,
/// or if choices do not set the same parameters.
pub(crate) fn resolve_variables(
    path: &SourcePath<'_>,
    plan: &Plan,
    responses: &[Response],
    written: Option<&IndexMap<String, VariableFile>>,
) -> Result<Vec<Variable>, StudyError> {
    let min_balls = written
        .and_then(|named| named.get("balls"))
        .and_then(|balls| balls.from)
        .map_or(plan.base.fewest_balls, |from| from.max(0.0) as usize);
    let rules = VariableRules { plan, responses, min_balls };
    let mut variables: Vec<Variable> = Vec::new();
    let mut set: Vec<Parameter> = Vec::new();
    for (name, file) in written.into_iter().flatten() {
        let path = path.key(name);
        let refuse = |fault| path.refuse_key(fault);
        check_column_name(name).and_then(|()| rules.check_no_column_has(name)).map_err(refuse)?;
        let domain = rules.domain(&path, name, file)?;
        for parameter in domain.parameters() {
            if set.contains(&parameter) {
                let problem = "two variables set the same parameter";
                return Err(refuse(Fault::new(problem, parameter.name(), "each parameter once")));
            }
            set.push(parameter);
        }
        let column = match &domain {
            Domain::Parameter { parameter, .. } => parameter.column().shown_in(&plan.units),
            Domain::Balls { .. } => Parameter::BALLS.column(),
            Domain::Choices(_) => VariedParameter {
                name: name.clone(),
                unit: "",
                meaning: "name of a choice".to_owned(),
                kind: ParameterKind::Text,
                shown: None,
            },
        };
        variables.push(Variable { column, domain });
    }
    Ok(variables)
}

impl Domain {
    fn parameters(&self) -> Vec<Parameter> {
        match self {
            Domain::Parameter { parameter, .. } => vec![*parameter],
            Domain::Balls { .. } => Vec::new(),
            Domain::Choices(choices) => {
                let first = choices.first().into_iter().flat_map(|(_, values)| values);
                first.map(|(parameter, _)| *parameter).collect()
            }
        }
    }
}

/// What variables may set.
struct VariableRules<'a> {
    plan: &'a Plan,
    responses: &'a [Response],
    /// The smallest number of balls of a design.
    min_balls: usize,
}

impl VariableRules<'_> {
    fn check_no_column_has(&self, name: &str) -> Result<(), Fault> {
        let of_response = self.responses.iter().any(|response| {
            let rest = name.strip_prefix(response.name.as_str());
            rest.is_some_and(|rest| rest.is_empty() || SUFFIXES.contains(&rest))
        });
        if of_response || is_reserved(name) {
            let problem = "a result column has this name";
            return Err(Fault::new(problem, name, "another name"));
        }
        Ok(())
    }

    fn domain(
        &self,
        path: &SourcePath<'_>,
        name: &str,
        file: &VariableFile,
    ) -> Result<Domain, StudyError> {
        if let Some(choices) = &file.choices {
            if file.from.is_some() || file.to.is_some() {
                return Err(path.wrong_value(
                    "both a range and choices",
                    "from or to",
                    "`choices`, or `from` and `to`",
                ));
            }
            let range = name == "balls" || find_parameter(name, self.plan.model()).is_ok();
            if range {
                let allowed = "`from` and `to`, or another name for the choices";
                return Err(path.wrong_key("choices with the name of a parameter", name, allowed));
            }
            return self.choices(&path.key("choices"), choices);
        }
        let [from, to] = self.range(path, file)?;
        if name == "balls" {
            return self.balls(path, from, to);
        }
        let parameter = self.parameter(name).map_err(|fault| path.refuse_key(fault))?;
        for (key, end) in [("from", from), ("to", to)] {
            let path = path.key(key);
            parameter.check(end, self.plan.model()).map_err(|fault| path.refuse_value(fault))?;
        }
        Ok(Domain::Parameter { parameter, from, to })
    }

    fn range(&self, path: &SourcePath<'_>, file: &VariableFile) -> Result<[f64; 2], StudyError> {
        let missing = |key: &str| {
            path.key(key).wrong_value("missing key", "no such key", "`from` and `to`, or `choices`")
        };
        let from = file.from.ok_or_else(|| missing("from"))?;
        let to = file.to.ok_or_else(|| missing("to"))?;
        if from > to {
            let allowed = "`from` not above `to`";
            return Err(path.wrong_value("reversed range", from_to(from, to), allowed));
        }
        Ok([from, to])
    }

    fn balls(&self, path: &SourcePath<'_>, from: f64, to: f64) -> Result<Domain, StudyError> {
        if self.plan.model().ball_balancer().is_none() {
            let found = format!("kind: {}", self.plan.model().kind().name);
            return Err(path.wrong_key("only for a ball balancer", found, "kind: ball_balancer"));
        }
        self.plan.base.check_number_varies().map_err(|fault| path.refuse_key(fault))?;
        if self.plan.sweeps_balls() {
            return Err(path.refuse_key(varied_twice("balls", "balls", "sweep")));
        }
        for (key, end) in [("from", from), ("to", to)] {
            check_number_of_balls(end).map_err(|fault| path.key(key).refuse_value(fault))?;
        }
        Ok(Domain::Balls { from: from as u64, to: to as u64 })
    }

    /// Returns the numeric parameter of this name if nothing else varies it.
    fn parameter(&self, name: &str) -> Result<Parameter, Fault> {
        let parameter = find_parameter(name, self.plan.model())?;
        if !parameter.is_number() {
            return Err(Fault::new("not a number", name, "a numeric parameter"));
        }
        self.plan.base.check_varied(parameter)?;
        let exists = |ball| parameter == parameter.of_one_member(ball);
        if parameter.is_of_balls() && (self.min_balls + 1..=MAX_BALLS).any(exists) {
            let allowed = format!("a ball that every design has, 1 to {}", self.min_balls);
            return Err(Fault::new("some designs do not have this ball", name, allowed));
        }
        // A factor does not set the parameter itself, so a design may vary it.
        let drawn = self.plan.uncertain_parameters.iter();
        let drawn = drawn.filter(|uncertain| !uncertain.factor || uncertain.parameter != parameter);
        let drawn = drawn.map(|uncertain| uncertain.parameter);
        for (place, mut others) in [
            ("sweep", self.plan.swept_parameters.clone()),
            ("uncertain", drawn.collect::<Vec<_>>()),
        ] {
            others.retain(|other| {
                *other == parameter
                    || other.general() == Some(parameter)
                    || parameter.general() == Some(*other)
            });
            if let Some(other) = others.first() {
                return Err(varied_twice(name, &other.name(), place));
            }
        }
        Ok(parameter)
    }

    fn choices(
        &self,
        path: &SourcePath<'_>,
        choices: &IndexMap<String, IndexMap<String, f64>>,
    ) -> Result<Domain, StudyError> {
        let mut all: Vec<(String, Vec<(Parameter, f64)>)> = Vec::new();
        for (name, values) in choices {
            let path = path.key(name);
            check_choice(name).map_err(|fault| path.refuse_key(fault))?;
            let mut choice = Vec::new();
            for (key, value) in values {
                let path = path.key(key);
                let parameter = self.parameter(key).map_err(|fault| path.refuse_key(fault))?;
                let checked = parameter.check(*value, self.plan.model());
                checked.map_err(|fault| path.refuse_value(fault))?;
                choice.push((parameter, *value));
            }
            choice.sort_by_key(|(parameter, _)| parameter.key());
            let names = |values: &[(Parameter, f64)]| {
                let names: Vec<String> = values.iter().map(|(varied, _)| varied.name()).collect();
                names.join(", ")
            };
            if choice.is_empty() {
                return Err(path.wrong_value("an empty choice", "nothing", "values of parameters"));
            }
            let first = all.first().map_or_else(|| names(&choice), |(_, first)| names(first));
            if names(&choice) != first {
                let problem = "choices that set different parameters";
                return Err(path.wrong_value(problem, names(&choice), first));
            }
            all.push((name.clone(), choice));
        }
        if all.is_empty() {
            return Err(path.wrong_value("no choices", "nothing", "at least one choice"));
        }
        Ok(Domain::Choices(all))
    }
}

fn varied_twice(name: &str, other: &str, place: &str) -> Fault {
    let found = format!("{name} here and {other} in `{place}`");
    Fault::new("varied twice", found, format!("a parameter in `design` or in `{place}`"))
}

/// Checks the name of a choice, which must also differ from a number in a CSV file.
fn check_choice(name: &str) -> Result<(), Fault> {
    let allowed =
        "1 to 100 letters, digits, `_`, `-`, `.` and blanks, beginning with a letter, not a number";
    let is_number = name.parse::<f64>().is_ok();
    let is_first = |first: char| first.is_ascii_alphabetic() && !is_number && !name.ends_with(' ');
    check_name(name, "_-. ", is_first, allowed)
}
