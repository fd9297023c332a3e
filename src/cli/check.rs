//! `stickslip check`: validates a study and prints its size, cost, machine, closed forms and warnings, without
//! computing a run.

use clap::Args;
use serde_json::{Value, json};

use super::arguments::StudyArgument;
use super::check_machine::{machine_json, machine_text, run_ups_of, system_text};
use super::check_points::ClosedForms;
use super::cost::Cost;
use super::design_cost::{design_cost, identify_cost};
use super::existence::Existence;
use super::output::{CliError, End, print_result};
use crate::check::{ExaminedDesign, points_to_examine, warnings};
use crate::engine::say;
use crate::model::{Endings, Extend, Method};
use crate::numbers::{counted, describe_number};
use crate::printed_table::fact_table;
use crate::responses::{add_known, merged};
use crate::study::{Response, Study, Variable, VariedParameter};

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
pub struct Arguments {
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
pub fn check(arguments: &Arguments) -> Result<End, CliError> {
    let study = arguments.study.load()?;
    let existence = arguments.existence;
    print_result(arguments.json, || check_json(&study, existence), || text(&study, existence))?;
    let warnings = warnings(&study);
    warnings.iter().for_each(|warning| say(&format!("warning: {warning}")));
    if !arguments.strict || warnings.is_empty() {
        return Ok(End::Well);
    }
    let warnings = counted(warnings.len() as u64, "warning");
    say(&format!("error: {warnings}, which --strict does not allow"));
    Ok(End::Warned)
}

/// Returns the result of the command as text, with the answer to `--existence` if it is wanted.
fn text(study: &Study, existence: bool) -> String {
    let design = ExaminedDesign::of(study);
    let described = design.as_ref().map_or(study, |design| &design.study);
    let existence = existence.then(|| Existence::of(study));
    let facts = facts(study, described).into_iter();
    let mut text = fact_table(facts.chain(existence.iter().flat_map(Existence::facts)));
    text += &existence.map_or_else(String::new, |existence| existence.details());
    text += &format!("\n{}{}", machine_text(study), system_text(study));
    let closed_forms = ClosedForms::of(described, design.as_ref(), most_printed(study));
    text + &format!("\n{}", closed_forms.text())
}

/// Returns the result of the command as JSON, with the answer to `--existence` if it is wanted.
pub fn check_json(study: &Study, existence: bool) -> Value {
    let design = ExaminedDesign::of(study);
    let described = design.as_ref().map_or(study, |design| &design.study);
    let mut report = json!({
        "study": study.name(),
        "hash": study.hash(),
        "seed": study.seed(),
        "points": study.point_count(),
        "runs": study.run_count(),
        "model": study.model().kind().name,
        "method": study.simulation().method,
        "endings": study.simulation().endings,
        "balls": study.model().balls(),
        "swept": names(study.swept()),
        "uncertain": names(study.uncertain()),
        "design": study.variables().iter().map(variable).collect::<Vec<Value>>(),
        "responses": study.responses().iter().map(response).collect::<Vec<Value>>(),
        "expectations": study.expectations().len(),
    });
    report = merged(report, Cost::of(study));
    let sampling = study.uncertain_sampling();
    let sampling = sampling.map(|(design, count)| json!({"design": design, "correlations": count}));
    add_known(&mut report, "uncertain_sampling", sampling);
    add_known(&mut report, "audit_fraction", study.audit().map(|audit| audit.fraction));
    if let Some(precision) = study.precision() {
        report["least_runs"] = study.least_run_count().into();
        for (name, half_width, _) in precision.half_widths() {
            let key = match name {
                "equilibrium_fraction" => "precision".to_owned(),
                amplitude => format!("precision_{amplitude}"),
            };
            report[key] = half_width.into();
        }
    }
    report["machine"] = machine_json(study);
    add_known(&mut report, "run_up", study.has_stages().then(|| run_ups_of(described).json));
    report["closed_form"] = json!(ClosedForms::of(described, design.as_ref(), most_points(study)));
    report["warnings"] = json!(warnings(study));
    report = merged(report, design_cost(study).map(|designs| designs.json));
    add_known(&mut report, "identify", identify_cost(study).map(|cost| cost.json));
    add_known(&mut report, "existence", existence.then(|| Existence::of(study)));
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

/// Returns the facts of the plan: a name and its value in words. `described` is the study of the examined design.
fn facts(study: &Study, described: &Study) -> Vec<(&'static str, String)> {
    let known = |names: Vec<&str>| (!names.is_empty()).then(|| names.join(", "));
    let listed = |names| known(names).unwrap_or_else(|| "nothing".to_owned());
    let model = described.model();
    let kind = model.kind();
    let what = match model.contacts() {
        most if described.sweeps_balls() => {
            let fewest = described.numbers_of_balls().start().to_owned();
            format!("{} with {fewest} to {most} {}s", kind.name, kind.body)
        }
        contacts => format!("{} with {}", kind.name, counted(contacts as u64, kind.body)),
    };
    let friction = match model.friction_in_words() {
        name if name.is_empty() => "no friction".to_owned(),
        name => format!("{name} friction"),
    };
    let natural = natural_frequency(described);
    let (hash, seed) = (&study.hash()[..12], study.seed());
    let mut facts = vec![
        ("study", format!("{} (hash {hash}, seed {seed})", study.name())),
        ("model", format!("{what}, {friction}{natural}")),
        ("swept", listed(names(study.swept()))),
        ("uncertain", listed(names(study.uncertain())) + &sampled_together(study)),
    ];
    let variables = known(study.variables().iter().map(Variable::name).collect());
    let responses = known(study.responses().iter().map(|entry| entry.name.as_str()).collect());
    let has_variables = variables.is_some();
    facts.extend(variables.map(|names| ("design", names)));
    facts.extend(responses.map(|names| ("responses", names)));
    facts.push(("points", study.point_count().to_string()));
    facts.push(("runs", runs(study)));
    facts.extend(study.audit().map(|audit| {
        let method = method_name(study.simulation().counter_check().method);
        let fraction = audit.fraction;
        let words = format!(
            "a fraction {fraction} of the runs again, with method {method} and a tenth of the \
                 tolerances"
        );
        ("audit", words)
    }));
    facts.extend(run_ups_of(described).words);
    facts.push(("expectations", study.expectations().len().to_string()));
    facts.push(("cost", Cost::of(study).in_words()));
    let designs = has_variables.then(|| design_cost(study)).flatten();
    let more = designs.into_iter().chain(identify_cost(study));
    facts.extend(more.flat_map(|facts| facts.words));
    facts
}

fn names(columns: &[VariedParameter]) -> Vec<&str> {
    columns.iter().map(|column| column.name.as_str()).collect()
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
    let [least, most] = [low, high].map(|frequency| format!("{:.3}", unit.of(frequency)));
    let range = if least == most { least } else { format!("{least} to {most}") };
    let has_several = each.iter().any(|frequencies| frequencies.len() > 1);
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
    add_known(&mut about, "unit", variable.unit());
    let range = variable.range();
    add_known(&mut about, "from", range.map(|[from, _]| from));
    add_known(&mut about, "to", range.map(|[_, to]| to));
    add_known(&mut about, "integer", range.map(|_| variable.is_whole()));
    add_known(&mut about, "choices", variable.choices().map(Iterator::collect::<Vec<_>>));
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
