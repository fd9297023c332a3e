//! The machine of a study for `check`: every parameter with its unit and the origin of its value, the equations of a system
//! file as they were read, with what the program can prove about their rest, and which accelerations of the disc the balls
//! follow.

use serde_json::{Value, json};

use super::output::StudyFacts;
use crate::analysis::{RunUp, run_ups};
use crate::check::points_to_examine;
use crate::model::{Graph, Model};
use crate::numbers::{counted, short};
use crate::printed_table::text_table;
use crate::responses::{add_known, merged};
use crate::study::{ListedParameter, ParameterValue, Study, Unit, short_name};

/// Returns the parameters as lines of text.
pub(super) fn machine_text(study: &Study) -> String {
    let row = |entry: ListedParameter| {
        let unit = study.units().of_parameter(&entry.name);
        let name = unit.map_or_else(|| entry.name.clone(), |_| short_name(&entry.name, entry.unit));
        [String::new(), name, value(&entry, unit), origin(&entry, unit)]
    };
    let rows: Vec<_> = study.parameters().into_iter().map(row).collect();
    format!("machine ({})\n{}", study.model().kind().name, text_table(&rows, &[0, 1, 2, 3]))
}

/// Returns the value with its unit, or the range of a value that is swept or part of a design.
fn value(parameter: &ListedParameter, shown: Option<&Unit>) -> String {
    let unit = match shown.map_or(parameter.unit, |unit| unit.symbol.as_str()) {
        "" | "1" => String::new(),
        unit => format!(" {unit}"),
    };
    let long = |value: f64| long(shown.map_or(value, |unit| unit.of(value)));
    let swept = parameter.swept.as_ref().and_then(|swept| swept.range);
    match (parameter.design.or(swept), parameter.value) {
        (Some([low, high]), _) if low == high => format!("{}{unit}", long(low)),
        (Some([low, high]), _) => format!("{} to {}{unit}", long(low), long(high)),
        (None, ParameterValue::Number(number)) => format!("{}{unit}", long(number)),
        (None, ParameterValue::Text(text)) => text.to_owned(),
    }
}

/// Formats a number of a study file with all its digits, and a computed one with few.
fn long(number: f64) -> String {
    let all = ParameterValue::Number(number).to_string();
    if all.len() <= 12 { all } else { short(number) }
}

/// Returns the origin of the value in words; nothing if the study gives a fixed value.
fn origin(parameter: &ListedParameter, shown: Option<&Unit>) -> String {
    let mut words = Vec::new();
    if parameter.is_default && !parameter.is_varied() {
        words.push("(default)".to_owned());
    }
    if let Some(swept) = &parameter.swept {
        words.push(format!("swept, {}", counted(swept.count as u64, "value")));
    }
    if parameter.design.is_some() {
        words.push("design".to_owned());
    }
    if let Some(uncertain) = parameter.uncertain {
        let shown = shown.filter(|_| !uncertain.factor);
        let [low, high] = uncertain.range.map(|end| short(shown.map_or(end, |unit| unit.of(end))));
        let what = if uncertain.factor { "uncertain, times" } else { "uncertain, median;" };
        words.push(format!("{what} {low} to {high} in 95 % of the runs"));
    }
    words.join("; ")
}

/// Returns the parameters as JSON.
pub(super) fn machine_json(study: &Study) -> Value {
    study.parameters().iter().map(parameter_json).collect()
}

fn parameter_json(parameter: &ListedParameter) -> Value {
    let unit = Some(parameter.unit).filter(|unit| !unit.is_empty());
    let mut object = json!({
        "name": parameter.name,
        "value": parameter.value,
        "unit": unit,
        "default": parameter.is_default && !parameter.is_varied(),
    });
    let swept = parameter.swept.as_ref().map(|swept| {
        let [from, to] = [0, 1].map(|end| swept.range.map(|range| range[end]));
        json!({"values": swept.count, "from": from, "to": to})
    });
    let uncertain = parameter.uncertain.map(|uncertain| {
        let [low, high] = uncertain.range;
        json!({"low": low, "high": high, "factor": uncertain.factor})
    });
    let design = parameter.design.map(|[from, to]| json!({"from": from, "to": to}));
    for (key, value) in [("swept", swept), ("uncertain", uncertain), ("design", design)] {
        add_known(&mut object, key, value);
    }
    object
}

/// Returns the equations as lines of text; nothing for a kind of model that no file defines.
pub(super) fn system_text(study: &Study) -> String {
    let Some(source) = study.model().kind().source() else { return String::new() };
    let row = |name: String, text: String| [String::new(), name, text];
    let named = |key: &str, word: &'static str| {
        entries(&source[key]).map(move |(name, node)| row(format!("{word} {name}"), in_words(node)))
    };
    let mut rows: Vec<[String; 3]> = named("coordinates", "coordinate").collect();
    for (line, columns) in entries(&source["mass"]) {
        for (column, formula) in entries(columns) {
            rows.push(row(format!("mass {line}, {column}"), in_words(formula)));
        }
    }
    for (key, word) in
        [("force", "force"), ("contacts", "contact"), ("outputs", "output"), ("derived", "derived")]
    {
        rows.extend(named(key, word));
    }
    for (name, node) in entries(&source["motions"]) {
        let table = node["table"]["rows"].as_array().map_or(&[][..], Vec::as_slice);
        let end = table.last().map_or("0".to_owned(), |row| in_words(&row[0]));
        let keys = entries(node).filter(|(key, _)| *key != "table");
        let keys = keys.map(|(key, value)| format!("{key}: {}, ", in_words(value)));
        let text = format!("{}{} rows until {end} s", keys.collect::<String>(), table.len());
        rows.push(row(format!("motion {name}"), text));
    }
    for key in ["turning", "period"] {
        rows.extend(source.get(key).map(|value| row(key.to_owned(), in_words(value))));
    }
    rows.push(row("rest".to_owned(), rest_in_words(study.model())));
    format!("\nsystem ({})\n{}", study.model().kind().name, text_table(&rows, &[0, 1, 2]))
}

fn entries(map: &Value) -> impl Iterator<Item = (&String, &Value)> {
    map.as_object().into_iter().flatten()
}

/// Returns a value as a study file may write it, on one line.
fn in_words(value: &Value) -> String {
    match value {
        Value::String(text) => text.split_whitespace().collect::<Vec<_>>().join(" "),
        Value::Object(fields) => {
            let each = fields.iter().map(|(key, value)| format!("{key}: {}", in_words(value)));
            each.collect::<Vec<_>>().join(", ")
        }
        Value::Array(items) => {
            format!("[{}]", items.iter().map(in_words).collect::<Vec<_>>().join(", "))
        }
        other => other.to_string(),
    }
}

/// Returns whether a rest with all contacts sticking can be certified.
fn rest_in_words(model: &Model) -> String {
    let Some(system) = model.system() else { return String::new() };
    if system.contacts() == 0 {
        return "where all forces vanish and small motions decay".to_owned();
    }
    let graph = Graph::of(system.as_ref());
    let contacts = 0..system.contacts();
    let without: Vec<String> = contacts
        .filter(|contact| system.friction(*contact).can_stick() && !graph.holds_position(*contact))
        .map(|contact| model.contact_in_words(contact))
        .collect();
    match without.is_empty() {
        true => "certified where all contacts stick and cannot break loose again".to_owned(),
        false => format!(
            "certified where contacts hold all bodies in all directions; not while one of them moves on, because {} may stick \
             while all coordinates move, or has a sliding speed with factors that change",
            without.join(", ")
        ),
    }
}

/// The most points whose run-ups are compared.
const MOST_POINTS: u64 = 1000;

/// Returns the changes of speed at the point at which the balls slip longest, and the number of that point if the points
/// differ.
fn longest_slipping(study: &Study) -> (Option<u64>, Vec<RunUp>) {
    let of_point = |point_id: u64| {
        let point = study.point(point_id);
        (point_id, point.model().ball_balancer().map(run_ups).unwrap_or_default())
    };
    let slips = |all: &[RunUp]| {
        let each =
            all.iter().map(|ramp| ramp.slipping_fraction * (ramp.time_s[1] - ramp.time_s[0]));
        each.sum::<f64>()
    };
    let points = points_to_examine(study.point_count(), MOST_POINTS).into_iter();
    let all: Vec<(u64, Vec<RunUp>)> = points.map(of_point).collect();
    let differ = all.windows(2).any(|pair| pair[0].1 != pair[1].1);
    let longest = all
        .into_iter()
        .reduce(|longest, other| if slips(&other.1) > slips(&longest.1) { other } else { longest });
    longest.map_or_else(Default::default, |(point_id, all)| (differ.then_some(point_id), all))
}

/// Returns a fact for each change of speed.
pub(super) fn run_ups_of(study: &Study) -> StudyFacts {
    let (point_id, all) = longest_slipping(study);
    let at = point_id.map(|id| format!(" (point {id}, where they slip longest)"));
    let at = at.unwrap_or_default();
    let unit = study.units().speed();
    let row = |run_up| ("run-up", format!("{}{at}", words(run_up, &unit)));
    let json = |run_up: &RunUp| merged(json!(run_up), json!({"point_id": point_id}));
    StudyFacts { words: all.iter().map(row).collect(), json: all.iter().map(json).collect() }
}

fn words(run_up: &RunUp, unit: &Unit) -> String {
    let RunUp { time_s, speed_rad_s, acceleration_rad_s2, followed_rad_s2, slipping_fraction } =
        run_up;
    let [from, to] = speed_rad_s.map(|speed| short(unit.of(speed)));
    let symbol = &unit.symbol;
    let [begin, end] = time_s.map(short);
    let [slow, fast] = followed_rad_s2.map(short);
    let change = format!(
        "{from} to {to} {symbol} from {begin} to {end} s, at most {} rad/s²",
        short(*acceleration_rad_s2)
    );
    let followed =
        format!("sticking balls follow {slow} rad/s² at its begin and {fast} at its end");
    let slips = match slipping_fraction {
        0.0 => "they can follow all of it".to_owned(),
        fraction => format!("they slip in {} % of its time or more", short(100.0 * fraction)),
    };
    format!("{change}; {followed}: {slips}")
}
