//! The cost of one design of a study, of a whole search with `stickslip optimize`, and of an inference with `stickslip
//! identify`.

use serde_json::{Value, json};

use super::cost::Cost;
use super::output::StudyFacts;
use crate::numbers::describe_number;
use crate::responses::merged;
use crate::study::{Limit, Objective, Optimization, OverPoints, Plan, SensitivityFrom, Study};

/// Returns the size and the cost of one design, and of the search if the study has one, with the keys `design_cost` and
/// `optimize`; `None` for a study without variables and responses.
pub(super) fn design_cost(study: &Study) -> Option<StudyFacts> {
    if study.variables().is_empty() && study.responses().is_empty() {
        return None;
    }
    let of_balls = study.by_number_of_balls().iter();
    // The largest number of runs of a design, over all points together.
    let runs = of_balls.map(Plan::least_run_count).max().unwrap_or_default();
    let cost = Cost::of_a_design(study);
    let mut words = vec![("one design", format!("{runs} runs; {}", cost.in_words()))];
    let mut json = json!({"design_cost": cost_json(runs, &cost)});
    if let Some(optimization) = study.optimization() {
        let search = search_cost(study, optimization, runs, cost);
        words.extend(search.words);
        json["optimize"] = search.json;
    }
    Some(StudyFacts { words, json })
}

/// Returns the cost of the parameter sets of `identify`, if the study has this key.
pub(super) fn identify_cost(study: &Study) -> Option<StudyFacts> {
    let (study, identification) = study.for_identification()?;
    let sets = identification.designs;
    let runs = sets.saturating_mul(study.least_run_count());
    let cost = Cost::of_a_design(&study).times(sets as f64);
    let words = format!("{sets} parameter sets, {runs} runs; {}", cost.in_words());
    let json = merged(cost_json(runs, &cost), json!({"designs": sets}));
    Some(StudyFacts { words: vec![("identify", words)], json })
}

fn cost_json(runs: u64, cost: &Cost) -> Value {
    merged(json!({"runs": runs}), cost)
}

/// Returns the goal, the size and the cost of a search in which a design has this number of runs and this cost.
fn search_cost(study: &Study, optimization: &Optimization, runs: u64, design: Cost) -> StudyFacts {
    let Optimization { designs, start_designs, finalists, final_samples, .. } = optimization;
    // The runs of the designs that the search evaluates.
    let search_runs = designs.saturating_mul(runs);
    let samples = if study.is_random() { *final_samples } else { 1 };
    // The finalists, the best design and the reference design have at most these runs of their own.
    let final_runs = finalists.saturating_add(2).saturating_mul(samples).saturating_mul(runs);
    let variables = study.variables().len();
    // The runs for the Sobol' indices.
    let sensitivity_runs = match optimization.sensitivity_from {
        SensitivityFrom::Surrogates => 0,
        SensitivityFrom::Runs => {
            let samples = optimization.sensitivity_samples;
            samples.saturating_mul(variables as u64 + 2).saturating_mul(runs)
        }
    };
    let all = search_runs.saturating_add(final_runs).saturating_add(sensitivity_runs);
    let cost = design.times(all as f64 / (runs as f64).max(1.0));

    let objective =
        |aim: &Objective| json!({"response": name(study, aim.response), "goal": goal(aim)});
    let limit =
        |bound: &Limit| json!({"response": name(study, bound.response), side(bound): bound.value});
    let json = json!({
        "objectives": optimization.objectives.iter().map(objective).collect::<Vec<_>>(),
        "limits": optimization.limits.iter().map(limit).collect::<Vec<_>>(),
        "over_points": optimization.over_points,
        "variables": variables,
        "designs": designs,
        "start_designs": start_designs,
        "finalists": finalists,
        "final_samples": final_samples,
        "search_runs": search_runs,
        "final_runs": final_runs,
        "sensitivity_runs": sensitivity_runs,
    });
    let sensitivities = match sensitivity_runs {
        0 => String::new(),
        runs => format!(", {runs} runs for Sobol' indices"),
    };
    let size = format!(
        "{variables} variables, {designs} designs ({start_designs} of them space-filling), {finalists} finalists \
         with {final_samples} times the runs{sensitivities}"
    );
    let surrogates = "and the time to fit the surrogates, which depends on the designs";
    let words = vec![
        ("optimize", goal_in_words(study, optimization)),
        ("search", size),
        ("search cost", format!("{all} runs at most; {}", cost.in_words())),
        ("", surrogates.to_owned()),
    ];
    StudyFacts { words, json: merged(cost_json(all, &cost), json) }
}

fn goal_in_words(study: &Study, optimization: &Optimization) -> String {
    let objective = |aim: &Objective| format!("{} {}", goal(aim), name(study, aim.response));
    let objectives: Vec<String> = optimization.objectives.iter().map(objective).collect();
    let limit = |bound: &Limit| {
        let (side, value) = (side(bound).replace('_', " "), describe_number(bound.value));
        format!("{} {side} {value}", name(study, bound.response))
    };
    let limits = match optimization.limits.iter().map(limit).collect::<Vec<_>>() {
        none if none.is_empty() => "without limits".to_owned(),
        limits => format!("subject to {}", limits.join(", ")),
    };
    let points = match (study.point_count(), optimization.over_points) {
        (1, _) => String::new(),
        (points, OverPoints::Worst) => format!("; worst of {points} points"),
        (points, OverPoints::Mean) => format!("; mean of {points} points"),
    };
    format!("{}, {limits}{points}", objectives.join(" and "))
}

fn goal(objective: &Objective) -> &'static str {
    if objective.maximize { "maximize" } else { "minimize" }
}

fn side(limit: &Limit) -> &'static str {
    if limit.least { "at_least" } else { "at_most" }
}

/// Returns the name of a response.
fn name(study: &Study, response: usize) -> &str {
    study.responses().get(response).map_or("", |response| response.name.as_str())
}
