//! The tables of keys, parameters and start states on the page about study files, written from the JSON Schema and the declarations
//! of the kinds of models.

use serde_json::{Map, Value};
use stickslip::model::ParameterDescriptor;
use stickslip::study::{json_schema, model_kind};

use super::STUDY_FILE;
use super::generated::compare_or_write_part;

/// Returns the part of the schema to which a node refers.
fn target<'s>(schema: &'s Value, node: &'s Value) -> &'s Value {
    let path = node["$ref"].as_str().and_then(|path| path.strip_prefix('#'));
    path.and_then(|pointer| schema.pointer(pointer)).unwrap_or(node)
}

/// Returns the description of a key on one line.
fn description(node: &Value) -> String {
    // A key that takes a word or a value with a unit is described by the first alternative.
    let described = node["description"].as_str().or(node["anyOf"][0]["description"].as_str());
    described.unwrap_or_default().replace('\n', " ").replace('|', "\\|")
}

/// Returns whether a key takes the value of another one with a unit: its description names that key.
fn has_units_of(node: &Value, name: &str) -> bool {
    description(node).starts_with(&format!("`{name}` as "))
}

/// Returns a key, followed by the one that takes its value with a unit.
fn names(keys: &Map<String, Value>, name: &str) -> String {
    let short = keys.iter().find(|(_, node)| has_units_of(node, name));
    short.map_or(format!("`{name}`"), |(short, _)| format!("`{name}`, `{short}`"))
}

/// Returns the keys that are rows of a table: those whose description does not begin with that of another key.
fn rows(keys: &Map<String, Value>) -> impl Iterator<Item = (&String, &Value)> {
    keys.iter().filter(|(_, node)| !keys.keys().any(|name| has_units_of(node, name)))
}

/// Where keys are described whose name is not the begin of a heading.
const ELSEWHERE: [(&str, &str); 6] = [
    ("parameters", "#ball-balancer"),
    ("uncertain_sampling", "#sampling-of-uncertain-parameters"),
    ("system", "system-files.md"),
    ("normal_force", "methods.md#normal-force"),
    ("contact", "contact.md"),
    ("disturbances", "#kicks"),
];

/// Returns a key as a link to its description on this page or another one; `None` without a description.
fn linked(name: &str) -> Option<String> {
    if let Some((_, place)) = ELSEWHERE.iter().find(|(key, _)| *key == name) {
        return Some(format!("[`{name}`]({place})"));
    }
    let slug = name.replace('_', "-");
    let headings = STUDY_FILE.lines().filter_map(|line| Some(line.split_once("## ")?.1));
    let slugs = headings.map(|heading| heading.to_lowercase().replace(' ', "-"));
    let found = slugs.min_by_key(|other| (!other.starts_with(&slug), other.len()))?;
    found.starts_with(&slug).then(|| format!("[`{name}`](#{found})"))
}

/// Returns the words between which a value chooses, as a sentence, unless the description has all of them.
fn words_of(node: &Value, description: &str) -> String {
    let listed = node["enum"].as_array().into_iter().flatten();
    let described = node["oneOf"].as_array().into_iter().flatten().map(|choice| &choice["const"]);
    let words: Vec<String> =
        listed.chain(described).filter_map(Value::as_str).map(|word| format!("`{word}`")).collect();
    match words.iter().all(|word| description.contains(word)) {
        true => String::new(),
        false => format!(" One of {}.", words.join(", ")),
    }
}

/// Returns the table of a map's keys. A key whose value is a map has a row for each key in it; with `links`, keys lead to their
/// sections.
fn table(map: &str, links: bool) -> String {
    let schema = json_schema();
    let outer = if map.is_empty() { &schema } else { &schema["$defs"][map] };
    let keys = outer["properties"].as_object().expect("keys");
    let mut text = "\n\n| key | content |\n|---|---|\n".to_owned();
    let mut add = |name: String, (map, key): (&Value, &String), node: &Value| {
        let required = map["required"].as_array();
        let is_required = required.is_some_and(|all| all.iter().any(|name| name == key));
        let required = if is_required { " Required." } else { "" };
        let description = description(node);
        let words = words_of(target(&schema, node), &description);
        text += &format!("| {name} | {description}{required}{words} |\n");
    };
    for (name, node) in rows(keys) {
        let inner = target(&schema, node);
        match inner["properties"].as_object().filter(|_| node.get("$ref").is_some() && !links) {
            Some(keys) => keys
                .iter()
                .for_each(|(key, node)| add(format!("`{name}.{key}`"), (inner, key), node)),
            None => {
                let link = linked(name).filter(|_| links);
                add(link.unwrap_or_else(|| names(keys, name)), (outer, name), node);
            }
        }
    }
    text + "\n"
}

/// The contents of choices that are no maps.
const CONTENTS: [(&str, &str); 3] = [
    ("times", "one of the distributions above"),
    ("table", "a [table](#tables)"),
    ("at_rest_by_s", "a time"),
];

/// Returns the table of the choices of a value, with the keys of each.
fn choices(title: &str, of: &str) -> String {
    let schema = json_schema();
    let mut text = format!("\n\n| {title} | keys | content |\n|---|---|---|\n");
    for choice in schema["$defs"][of]["oneOf"].as_array().expect("choices") {
        let Some(keys) = choice["properties"].as_object() else {
            let name = choice["const"].as_str().expect("a word");
            text += &format!("| `{name}` | | {} |\n", description(choice));
            continue;
        };
        let name: Vec<String> = keys.keys().map(|name| format!("`{name}`")).collect();
        let node = target(&schema, keys.values().next().expect("a key"));
        let inner = node["properties"].as_object().map(|inner| {
            rows(inner).map(|(key, _)| names(inner, key)).collect::<Vec<_>>().join(", ")
        });
        let given = CONTENTS.iter().find(|(of, _)| keys.contains_key(*of));
        let inner = given.map(|(_, words)| (*words).to_owned()).or(inner).unwrap_or_default();
        text += &format!("| {} | {inner} | {} |\n", name.join(", "), description(choice));
    }
    text + "\n"
}

/// Returns the table of the parameters of kinds of models, each once.
fn parameters(kinds: &[&str]) -> String {
    let schema = json_schema();
    let keys = schema["$defs"]["ParametersFile"]["properties"].as_object().expect("keys");
    let mut text = "\n\n| parameter | unit | default | meaning |\n|---|---|---|---|\n".to_owned();
    let kinds = kinds.iter().map(|name| model_kind(name).expect("a built-in kind"));
    let mut all: Vec<&str> = Vec::new();
    for kind in kinds {
        let numeric = |parameter: &&ParameterDescriptor| {
            !parameter.unit.is_empty() && keys.contains_key(parameter.name)
        };
        for parameter in kind.parameters.iter().filter(numeric) {
            if all.contains(&parameter.name) {
                continue;
            }
            all.push(parameter.name);
            let number =
                parameter.numbers(&mut kind.default_model(), None).first().map(|number| **number);
            let default = number.filter(|_| parameter.determines().is_none());
            let default = default.map_or("none".to_owned(), |number| match number.abs() {
                0.0 => "0".to_owned(),
                1e-2..1e5 => ((number * 1e4).round() / 1e4).to_string(),
                _ => format!("{number:e}"),
            });
            let (unit, meaning) = (parameter.unit, parameter.meaning);
            let each = if parameter.is_of_each_ball() { " of each ball" } else { "" };
            text += &format!(
                "| {} | {unit} | {default} | {meaning}{each} |\n",
                names(keys, parameter.name)
            );
        }
    }
    if all.contains(&"ball_density_kg_m3") {
        for name in ["balls", "ball_material"] {
            text += &format!("| `{name}` | | | {} |\n", description(&keys[name]));
        }
    }
    text + "\n"
}

/// Returns the table of the coordinates of start states; those of one body have a number.
fn coordinates() -> String {
    let schema = json_schema();
    let ranges = &schema["$defs"]["InitialConditionsFile"]["properties"]["box"]["properties"];
    let keys = ranges.as_object().expect("coordinates");
    let mut text = "\n\n| coordinate | default range | content |\n|---|---|---|\n".to_owned();
    for (name, node) in rows(keys) {
        let description = description(node);
        let (meaning, range) = description.rsplit_once("; default ").expect("a default");
        if !range.starts_with("that of") {
            let meaning = meaning.trim_start_matches("start value: ");
            let range = range.trim_end_matches('.');
            text += &format!("| {} | {range} | {meaning} |\n", names(keys, name));
        }
    }
    text + "\n"
}

#[test]
fn tables_of_the_page_are_those_of_the_program() {
    for (name, table) in [
        ("keys", table("", true)),
        ("model-keys", table("ModelFile", true)),
        ("balancer-parameters", parameters(&["ball_balancer"])),
        ("block-parameters", parameters(&["block_on_spring", "block_on_belt"])),
        ("rotor-parameters", parameters(&["rotor_balancer"])),
        ("distributions", choices("distribution", "DistributionFile")),
        ("uncertain-sampling-keys", table("UncertainSamplingFile", false)),
        ("initial-condition-keys", table("InitialConditionsFile", false)),
        ("coordinates", coordinates()),
        ("designs", choices("design", "DesignFile")),
        ("simulation-keys", table("SimulationFile", false)),
        ("precision-keys", table("PrecisionFile", false)),
        ("audit-keys", table("AuditFile", false)),
        ("expect-keys", table("ExpectationFile", false)),
        ("responses", choices("response", "ResponseFile")),
        ("optimize-keys", table("OptimizeFile", false)),
        ("identify-keys", table("IdentifyFile", false)),
        ("prior-keys", table("PriorFile", false)),
        ("ramp-keys", table("RampFile", false)),
        ("kick-keys", table("KickFile", false)),
        ("hammer-keys", table("HammerFile", false)),
        ("limit-keys", table("LimitFile", false)),
    ] {
        compare_or_write_part("docs/study-file.md", name, &table);
    }
}
