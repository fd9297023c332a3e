//! The cost of one design of a study, and of a whole search with `stickslip optimize`.

use serde_json::{Value, json};

use super::cost::Cost;
use crate::responses::merged;
use crate::study::{Objective, Optimization, OverPoints, SensitivityFrom, Study, describe_number};

/// The size and the cost of a design, and of the search if the study has one.
pub(super) struct DesignCost<'a> {
    study: &'a Study,
    /// The largest number of runs of a design, over all points together.
    runs: u64,
    cost: Cost,
    search: Option<SearchCost<'a>>,
}

/// The runs of a search.
struct SearchCost<'a> {
    optimization: &'a Optimization,
    /// Runs of the designs that the search evaluates.
    search_runs: u64,
    /// The largest number of runs of the finalists, the best design and the reference design.
    final_runs: u64,
    /// Runs for the Sobol' indices.
    sensitivity_runs: u64,
    cost: Cost,
}

impl<'a> DesignCost<'a> {
    /// Returns the cost, or `None` for a study without variables and responses.
    pub(super) fn of(study: &'a Study) -> Option<Self> {
        if study.variables().is_empty() && study.responses().is_empty() {
            return None;
        }
        let of_balls = study.by_number_of_balls().iter();
        let runs = of_balls.map(Study::least_run_count).max().unwrap_or_default();
        let cost = Cost::of_a_design(study);
        let search = study.optimization().map(|one| SearchCost::of(study, one, runs, cost));
        Some(DesignCost { study, runs, cost, search })
    }

    /// Returns the cost as rows of a table: a key and its text.
    pub(super) fn rows(&self) -> Vec<(&'static str, String)> {
        let one = format!("{} runs; {}", self.runs, self.cost.in_words());
        let mut rows = vec![("one design", one)];
        if let Some(search) = &self.search {
            rows.push(("optimize", search.goal_in_words(self.study)));
            rows.push(("search", search.size_in_words(self.study)));
            let all = format!("{} runs at most; {}", search.runs(), search.cost.in_words());
            rows.push(("search cost", all));
            rows.push((
                "",
                "and the time to fit the surrogates, which depends on the designs".to_owned(),
            ));
        }
        rows
    }

    /// Returns the keys `design_cost` and `optimize` of the JSON object.
    pub(super) fn json(&self) -> Value {
        let mut object = json!({"design_cost": cost_json(self.runs, &self.cost)});
        if let Some(search) = &self.search {
            object["optimize"] = search.json(self.study);
        }
        object
    }
}

/// Returns the numbers of parameter sets and runs of `identify`, and the cost of these runs, if the study has this key.
fn identify_cost(study: &Study) -> Option<(u64, u64, Cost)> {
    let (study, identification) = study.for_identification()?;
    let sets = identification.designs;
    let runs = sets.saturating_mul(study.least_run_count());
    Some((sets, runs, Cost::of_a_design(&study).times(sets as f64)))
}

/// Returns the cost of `identify` as a row of a table.
pub(super) fn identify_row(study: &Study) -> Option<(&'static str, String)> {
    let (sets, runs, cost) = identify_cost(study)?;
    let text = format!("{sets} parameter sets, {runs} runs; {}", cost.in_words());
    Some(("identify", text))
}

/// Returns the cost of `identify` as JSON.
pub(super) fn identify_json(study: &Study) -> Option<Value> {
    let (sets, runs, cost) = identify_cost(study)?;
    let mut object = cost_json(runs, &cost);
    object["designs"] = sets.into();
    Some(object)
}

fn cost_json(runs: u64, cost: &Cost) -> Value {
    merged(json!({"runs": runs}), json!(cost))
}

impl<'a> SearchCost<'a> {
    fn of(study: &Study, optimization: &'a Optimization, runs: u64, design: Cost) -> Self {
        let search_runs = optimization.designs.saturating_mul(runs);
        let samples = if study.is_random() { optimization.final_samples } else { 1 };
        // The best finalist and the reference design have runs of their own.
        let final_designs = optimization.finalists.saturating_add(2);
        let final_runs = final_designs.saturating_mul(samples).saturating_mul(runs);
        let sensitivity_runs = match optimization.sensitivity_from {
            SensitivityFrom::Surrogates => 0,
            SensitivityFrom::Runs => {
                let designs = study.variables().len() as u64 + 2;
                optimization.sensitivity_samples.saturating_mul(designs).saturating_mul(runs)
            }
        };
        let mut search = SearchCost {
            optimization,
            search_runs,
            final_runs,
            sensitivity_runs,
            cost: Cost::default(),
        };
        search.cost = design.times(search.runs() as f64 / (runs as f64).max(1.0));
        search
    }

    /// Returns the largest number of runs.
    fn runs(&self) -> u64 {
        self.search_runs.saturating_add(self.final_runs).saturating_add(self.sensitivity_runs)
    }

    fn goal_in_words(&self, study: &Study) -> String {
        let optimization = self.optimization;
        let objective =
            |one: &Objective| format!("{} {}", direction(one), name(study, one.response));
        let objectives: Vec<String> = optimization.objectives.iter().map(objective).collect();
        let limits: Vec<String> = optimization
            .limits
            .iter()
            .map(|limit| {
                let side = if limit.least { "at least" } else { "at most" };
                let (name, value) = (name(study, limit.response), describe_number(limit.value));
                format!("{name} {side} {value}")
            })
            .collect();
        let limits = if limits.is_empty() {
            "without limits".to_owned()
        } else {
            format!("subject to {}", limits.join(", "))
        };
        let points = match study.point_count() {
            1 => String::new(),
            points => format!("; {} of {points} points", over_points(optimization.over_points)),
        };
        format!("{}, {limits}{points}", objectives.join(" and "))
    }

    fn size_in_words(&self, study: &Study) -> String {
        let Optimization { designs, start_designs, finalists, final_samples, .. } =
            self.optimization;
        let variables = study.variables().len();
        let sensitivities = match self.sensitivity_runs {
            0 => String::new(),
            runs => format!(", {runs} runs for Sobol' indices"),
        };
        format!(
            "{variables} variables, {designs} designs ({start_designs} of them space-filling), {finalists} finalists \
             with {final_samples} times the runs{sensitivities}"
        )
    }

    fn json(&self, study: &Study) -> Value {
        let optimization = self.optimization;
        let objective = |one: &Objective| json!({"response": name(study, one.response), "goal": direction(one)});
        let limits = optimization.limits.iter().map(|limit| {
            let side = if limit.least { "at_least" } else { "at_most" };
            json!({"response": name(study, limit.response), side: limit.value})
        });
        let facts = json!({
            "objectives": optimization.objectives.iter().map(objective).collect::<Vec<_>>(),
            "limits": limits.collect::<Vec<_>>(),
            "over_points": over_points(optimization.over_points),
            "variables": study.variables().len(),
            "designs": optimization.designs,
            "start_designs": optimization.start_designs,
            "finalists": optimization.finalists,
            "final_samples": optimization.final_samples,
            "search_runs": self.search_runs,
            "final_runs": self.final_runs,
            "sensitivity_runs": self.sensitivity_runs,
        });
        merged(cost_json(self.runs(), &self.cost), facts)
    }
}

fn direction(objective: &Objective) -> &'static str {
    if objective.maximize { "maximize" } else { "minimize" }
}

fn over_points(over: OverPoints) -> &'static str {
    match over {
        OverPoints::Worst => "worst",
        OverPoints::Mean => "mean",
    }
}

/// Returns the name of a response.
fn name(study: &Study, response: usize) -> &str {
    study.responses().get(response).map_or("", |response| response.name.as_str())
}
