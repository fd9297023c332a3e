//! `stickslip check`: validates a study and prints its size, cost, machine, closed forms and warnings, without
//! computing a run.

use clap::Args;
use serde_json::{Value, json};

use super::arguments::StudyArgument;
use super::check_machine::{machine_json, machine_text};
use super::check_points::ClosedForms;
use super::check_run_up::{run_up_json, run_up_rows};
use super::check_system::system_text;
use super::cost::Cost;
use super::design_cost::{DesignCost, identify_json, identify_row};
use super::existence::Existence;
use super::exit::{CliError, End};
use super::output::{print, print_json};
use crate::check::{ExaminedDesign, Warning, points_to_examine, warnings};
use crate::counted::counted;
use crate::engine::say;
use crate::model::{Endings, Extend, Method};
use crate::printed_table::text_table;
use crate::responses::merged;
use crate::study::{Response, Study, Variable, VariedParameter, describe_number};

const EXAMPLES: &str = "\
Examples:
  stickslip check study.yaml
  stickslip check study.yaml --json
  stickslip check study.yaml --existence
  stickslip check study.yaml --strict && stickslip run study.yaml

Prints the size and the cost of the study, its machine with every default, and what closed forms say at each point: \
whether the balls can balance, and how strongly the machine can vibrate when they rest elsewhere. Values that are \
probably slips are warnings on standard error.";

/// Check a study file and print its size, cost, machine and closed forms; computes no run
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct CheckArguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Also print at which points of the sweep stick and slip always have exactly one solution
    #[arg(long)]
    existence: bool,

    /// Exit with 2 if there are warnings
    #[arg(long)]
    strict: bool,

    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Checks the study and prints its plan.
pub fn check(arguments: &CheckArguments) -> Result<End, CliError> {
    let study = arguments.study.load()?;
    let warnings = warnings(&study);
    let end = if arguments.strict && !warnings.is_empty() { End::Warned } else { End::Well };
    if arguments.json {
        print_json(&format!("{:#}\n", check_json(&study, arguments.existence)))?;
        say_all(&warnings, arguments.strict);
        return Ok(end);
    }
    let cost = Cost::of(&study);
    let has_variables = !study.variables().is_empty();
    let designs = has_variables.then(|| DesignCost::of(&study)).flatten();
    let existence = arguments.existence.then(|| Existence::of(&study));
    let design = ExaminedDesign::of(&study);
    let described = design.as_ref().map_or(&study, |design| &design.study);
    let mut rows = rows(&study, described, &cost, designs.as_ref());
    rows.extend(existence.iter().flat_map(Existence::rows));
    let rows: Vec<Vec<String>> =
        rows.into_iter().map(|(key, text)| vec![key.to_owned(), text]).collect();
    print(&text_table(&rows, &[0, 1]))?;
    if let Some(existence) = existence {
        print(&existence.details())?;
    }
    print(&format!("\n{}", machine_text(&study)))?;
    print(&system_text(&study))?;
    let closed_forms = ClosedForms::of(&study, design.as_ref(), most_printed(&study));
    print(&format!("\n{}", closed_forms.text()))?;
    say_all(&warnings, arguments.strict);
    Ok(end)
}

/// Returns the result of the command as JSON, with the answer to `--existence` if it is wanted.
pub fn check_json(study: &Study, existence: bool) -> Value {
    let names = |columns: &[VariedParameter]| -> Vec<String> {
        columns.iter().map(|column| column.name.clone()).collect()
    };
    let (swept, uncertain) = (names(study.swept()), names(study.uncertain()));
    let design = ExaminedDesign::of(study);
    let mut report = json!({
        "study": study.name(),
        "hash": study.hash(),
        "seed": study.seed(),
        "points": study.point_count(),
        "runs": study.run_count(),
        "model": study.model().kind().name,
        "method": method_name(study.simulation().method),
        "endings": study.simulation().endings,
        "balls": study.model().balls(),
        "swept": swept,
        "uncertain": uncertain,
        "design": study.variables().iter().map(variable).collect::<Vec<Value>>(),
        "responses": study.responses().iter().map(response).collect::<Vec<Value>>(),
        "expectations": study.expectations().len(),
    });
    report = merged(report, json!(Cost::of(study)));
    if let Some((design, correlations)) = study.uncertain_sampling() {
        report["uncertain_sampling"] = json!({"design": design, "correlations": correlations});
    }
    if let Some(audit) = study.audit() {
        report["audit_fraction"] = json!(audit.fraction);
    }
    if let Some(precision) = study.precision() {
        report["least_runs"] = study.least_run_count().into();
        for (name, half_width, _) in precision.half_widths() {
            let key = match name {
                "equilibrium_fraction" => "precision".to_owned(),
                amplitude => format!("precision_{amplitude}"),
            };
            report[key] = json!(half_width);
        }
    }
    report["machine"] = machine_json(study);
    if study.has_stages() {
        report["run_up"] = run_up_json(design.as_ref().map_or(study, |one| &one.study));
    }
    report["closed_form"] = ClosedForms::of(study, design.as_ref(), most_points(study)).json();
    report["warnings"] = warnings(study).iter().map(Warning::json).collect();
    if let Some(designs) = DesignCost::of(study) {
        report = merged(report, designs.json());
    }
    if let Some(cost) = identify_json(study) {
        report["identify"] = cost;
    }
    if existence {
        report["existence"] = Existence::of(study).json();
    }
    report
}

/// Returns the largest number of points in the printed table. The closed forms of many balls take longer.
fn most_printed(study: &Study) -> u64 {
    if study.model().balls() <= 4 { 20 } else { 8 }
}

/// Returns the largest number of points in JSON.
fn most_points(study: &Study) -> u64 {
    let balls = study.model().balls().max(1) as u64;
    (1000 / (balls * balls)).max(most_printed(study))
}

fn say_all(warnings: &[Warning], strict: bool) {
    warnings.iter().for_each(|warning| say(&format!("warning: {warning}")));
    if strict && !warnings.is_empty() {
        let count = warnings.len();
        let warnings = if count == 1 { "warning" } else { "warnings" };
        say(&format!("error: {count} {warnings}, which --strict does not allow"));
    }
}

/// Returns the rows of the plan: a key and its text. `described` is the study of the examined design.
fn rows(
    study: &Study,
    described: &Study,
    cost: &Cost,
    designs: Option<&DesignCost>,
) -> Vec<(&'static str, String)> {
    let listed = |names: Vec<&str>| {
        if names.is_empty() { "nothing".to_owned() } else { names.join(", ") }
    };
    let names = |columns: &'_ [VariedParameter]| {
        listed(columns.iter().map(|column| column.name.as_str()).collect())
    };
    let model = described.model();
    let kind = model.kind();
    let what = match model.contacts() {
        most if described.sweeps_balls() => {
            let fewest = described.numbers_of_balls().start().to_owned();
            format!("{} with {fewest} to {most} {}s", kind.name, kind.body)
        }
        1 => format!("{} with 1 {}", kind.name, kind.body),
        contacts => format!("{} with {contacts} {}s", kind.name, kind.body),
    };
    let friction = match model.friction_in_words() {
        name if name.is_empty() => "no friction".to_owned(),
        name => format!("{name} friction"),
    };
    let natural = natural_frequency(described);
    let (hash, seed) = (&study.hash()[..12], study.seed());
    let mut rows = vec![
        ("study", format!("{} (hash {hash}, seed {seed})", study.name())),
        ("model", format!("{what}, {friction}{natural}")),
        ("swept", names(study.swept())),
        ("uncertain", names(study.uncertain()) + &sampled_together(study)),
    ];
    if !study.variables().is_empty() {
        rows.push(("design", listed(study.variables().iter().map(Variable::name).collect())));
    }
    if !study.responses().is_empty() {
        let responses = study.responses().iter().map(|one| one.name.as_str());
        rows.push(("responses", listed(responses.collect())));
    }
    rows.push(("points", study.point_count().to_string()));
    rows.push(("runs", runs(study)));
    if let Some(audit) = study.audit() {
        let method = method_name(study.simulation().counter_check().method);
        let fraction = audit.fraction;
        let text = format!(
            "a fraction {fraction} of the runs again, with method {method} and a tenth of the \
                 tolerances"
        );
        rows.push(("audit", text));
    }
    rows.extend(run_up_rows(described));
    rows.push(("expectations", study.expectations().len().to_string()));
    rows.push(("cost", cost.in_words()));
    if let Some(designs) = designs {
        rows.extend(designs.rows());
    }
    rows.extend(identify_row(study));
    rows
}

/// Returns the least and the largest natural frequency at the points, with uncertain parameters at their medians, after a comma.
fn natural_frequency(study: &Study) -> String {
    let points = points_to_examine(study.point_count(), most_points(study)).into_iter();
    let of = |point: u64| study.point(point).model().natural_frequencies().first_rad_s().to_vec();
    let each: Vec<Vec<f64>> = points.map(of).collect();
    let all = || each.iter().flatten().copied();
    let ends = [all().reduce(f64::min), all().reduce(f64::max)];
    let [Some(low), Some(high)] = ends else { return String::new() };
    let unit = study.units().speed();
    let [least, most] = [low, high].map(|one| format!("{:.3}", unit.of(one)));
    let range = if least == most { least } else { format!("{least} to {most}") };
    let has_several = each.iter().any(|one| one.len() > 1);
    let name = if has_several { "natural frequencies" } else { "natural frequency" };
    format!(", {name} {range} {}", unit.symbol)
}

/// Returns how the uncertain parameters are sampled together, in parentheses; empty if their draws are independent.
fn sampled_together(study: &Study) -> String {
    let Some((design, correlations)) = study.uncertain_sampling() else { return String::new() };
    let correlations = match correlations {
        0 => String::new(),
        count => format!(", {}", counted(count as u64, "rank correlation")),
    };
    format!(" (design {design}{correlations})")
}

/// Returns the number of runs, and when each of them ends.
fn runs(study: &Study) -> String {
    let simulation = study.simulation();
    let count = study.run_count();
    let runs = match study.precision() {
        None => count.to_string(),
        Some(precision) => {
            format!("{} to {count} (until {})", study.least_run_count(), precision.in_words())
        }
    };
    let [_, later] = simulation.end_times_s();
    let extended = match simulation.extend {
        Some(extend) => format!(" ({} runs to {} s)", labels(extend), describe_number(later)),
        None => String::new(),
    };
    let only = match simulation.endings {
        Endings::All => "",
        Endings::Rest => ", detects rest only",
    };
    let (end, method) = (describe_number(simulation.end_time_s), method_name(simulation.method));
    format!("{runs}, each to {end} s{extended} or until its ending is known, method {method}{only}")
}

/// Returns what an optimiser needs to know of a variable.
fn variable(variable: &Variable) -> Value {
    let mut about = json!({"name": variable.name()});
    if let Some(unit) = variable.unit() {
        about["unit"] = json!(unit);
    }
    if let Some([from, to]) = variable.range() {
        about["from"] = json!(from);
        about["to"] = json!(to);
        about["integer"] = json!(variable.is_whole());
    }
    if let Some(choices) = variable.choices() {
        about["choices"] = choices.collect();
    }
    about
}

fn response(response: &Response) -> Value {
    json!({"name": response.name, "unit": response.unit(), "meaning": response.meaning()})
}

/// Returns the names of the labels whose runs are continued.
fn labels(extend: Extend) -> &'static str {
    match (extend.labels.undecided, extend.labels.irregular) {
        (true, true) => "undecided and irregular",
        (true, false) => "undecided",
        (false, true) => "irregular",
        (false, false) => "no",
    }
}

fn method_name(method: Method) -> &'static str {
    match method {
        Method::Switch => "switch",
        Method::Event => "event",
    }
}
