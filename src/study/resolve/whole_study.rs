//! Resolves a study: first the plan of its runs, then the responses, searches and other evaluations of results.

use crate::study::error::{Fault, StudyError};
use crate::study::file::model_parts::Balls;
use crate::study::file::source::Source;
use crate::study::file::study_file::StudyFile;
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::planned_study::{Designs, Study};
use crate::study::plan::variable::Variable;
use crate::study::resolve::expectations::resolve_expectations;
use crate::study::resolve::planned_runs::resolve_plan;
use crate::study::resolve::responses::resolve_responses;
use crate::study::resolve::searches::{resolve_identification, resolve_optimization};
use crate::study::resolve::variables::resolve_variables;

/// Validates a study file.
pub(in crate::study) fn resolve(source: &Source, written: &StudyFile) -> Result<Study, StudyError> {
    let plan = resolve_plan(source, written)?;
    let expected = written.expect.as_deref().unwrap_or_default();
    let expectations = resolve_expectations(source, &plan, expected)?;
    let responses = resolve_responses(source, &plan, written.responses.as_ref())?;
    let design = written.design.as_ref();
    let variables = resolve_variables(&source.path("design"), &plan, &responses, design)?;
    let by_balls = by_balls(source, written, &variables)?;
    let designs = Designs { variables, by_balls };
    let optimize = written.optimize.as_ref();
    let optimization = resolve_optimization(source, &plan, &designs, &responses, optimize)?;
    let identify = written.identify.as_ref();
    let identification = resolve_identification(source, &plan, &responses, identify)?;
    Ok(Study { plan, expectations, responses, designs, optimization, identification })
}

/// Returns the plan for each number of balls that a design may have, in ascending order. The list is empty if designs do
/// not vary the number of balls.
fn by_balls(
    source: &Source,
    written: &StudyFile,
    variables: &[Variable],
) -> Result<Vec<Plan>, StudyError> {
    let Some(numbers) = variables.iter().find_map(Variable::ball_numbers) else {
        return Ok(Vec::new());
    };
    let with = |balls: u64| {
        let mut other = StudyFile {
            expect: None,
            design: None,
            responses: None,
            optimize: None,
            identify: None,
            ..written.clone()
        };
        other.model.parameters.get_or_insert_default().balls = Some(Balls::Number(balls));
        // These ranges belong to balls that the design does not have.
        if let Some(ranges) = &mut other.initial_conditions.start_box {
            ranges.retain(|name, _| ball_of(name).is_none_or(|ball| ball <= balls));
        }
        resolve_plan(source, &other).map_err(|error| {
            let problem = format!("with {balls} balls: `{}`: {}", error.key(), error.problem());
            let found = error.found().map(str::to_owned);
            let fault = Fault { problem, found, allowed: error.allowed().map(str::to_owned) };
            source.path("design.balls").refuse_value(fault)
        })
    };
    numbers.map(with).collect()
}

/// Returns the number of the ball of a coordinate such as `beta_dot_2`.
fn ball_of(axis: &str) -> Option<u64> {
    let ball = axis.strip_prefix("beta_dot_").or_else(|| axis.strip_prefix("beta_"))?;
    ball.parse().ok()
}
