//! The tables of keys on the page about study files have the defaults and units of the schema.

use std::collections::BTreeMap;

use serde_json::Value;
use stickslip::study::json_schema;

use super::STUDY_FILE;

/// Returns the tables below a heading: their rows by the name in the first cell, each with its
/// cells by the titles of the columns.
fn tables(heading: &str) -> BTreeMap<String, BTreeMap<String, String>> {
    let below = STUDY_FILE.split(&format!("\n{heading}\n")).nth(1).expect("the heading");
    let below = below.split("\n#").next().unwrap_or_default();
    let cells = |line: &str| {
        let line = line.trim_matches('|');
        line.split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<String>>()
    };
    let (mut titles, mut rows): (Vec<String>, BTreeMap<_, _>) = (Vec::new(), BTreeMap::new());
    for line in below.lines() {
        match line.strip_prefix('|') {
            None => titles.clear(),
            Some(_) if line.starts_with("|---") => {}
            Some(_) if titles.is_empty() => titles = cells(line),
            Some(_) => {
                let own = cells(line);
                // The key in SI units stands first; `default range` belongs to several keys.
                let names = match titles.contains(&"default range".to_owned()) {
                    true => &own[0],
                    false => own[0].split("`, `").next().unwrap_or_default(),
                };
                let name = names.trim_matches('`').to_owned();
                rows.insert(name, titles.iter().cloned().zip(own).collect());
            }
        }
    }
    rows
}

/// Compares the defaults of a table with those of the schema. Returns how many there are.
#[track_caller]
fn compare(heading: &str, map: &str, prefix: &str) -> usize {
    let schema = json_schema();
    let properties = schema["$defs"][map]["properties"].as_object().expect("properties");
    let rows = tables(heading);
    let mut compared = 0;
    for (name, property) in properties {
        let (Some(default), Some(row)) =
            (property.get("default"), rows.get(&format!("{prefix}{name}")))
        else {
            continue;
        };
        let written = row["default"].trim_matches('`');
        let same = match default {
            Value::Number(number) => written.parse().ok() == number.as_f64(),
            default => default.as_str() == Some(written),
        };
        assert!(same, "{heading}: `{name}`: {written} on the page, {default} in the schema");
        compared += 1;
    }
    compared
}

#[test]
fn defaults_on_the_page_are_those_of_the_program() {
    assert_eq!(compare("## Model", "ModelFile", ""), 3);
    assert_eq!(compare("### Ball balancer", "ParametersFile", ""), 8);
    assert_eq!(compare("### Block on a spring or belt", "ParametersFile", ""), 3);
    assert_eq!(compare("## Simulation", "SimulationFile", ""), 4);
    assert_eq!(compare("## Simulation", "ToleranceFile", "tolerance."), 2);
    assert_eq!(compare("### Rotor balancer", "ParametersFile", ""), 23);
    // These have other defaults in each kind of model.
    let balancer = stickslip::model::Machine::default();
    let block = crate::support::Block::on_belt();
    for (heading, stiffness, friction) in [
        ("### Ball balancer", balancer.stiffness_n_m, balancer.balls[0].friction_coefficient),
        ("### Block on a spring or belt", block.stiffness_n_m, block.friction_coefficient),
    ] {
        let rows = tables(heading);
        let written = |name: &str| rows[name]["default"].parse().ok();
        assert_eq!(written("stiffness_n_m"), Some(stiffness), "{heading}");
        assert_eq!(written("friction_coefficient"), Some(friction), "{heading}");
    }
    let rotor = stickslip::study::model_kind("rotor_balancer").expect("a built-in kind");
    let default = |name: &str| {
        let parameter = rotor.parameters.iter().find(|parameter| parameter.name == name);
        let numbers =
            parameter.map(|own| own.numbers(&mut rotor.default_model(), None).remove(0).to_owned());
        numbers.map(|number| (number * 1e4).round() / 1e4)
    };
    for (name, of_balls) in [
        ("speed_rad_s", balancer.speed_rad_s),
        ("ball_mass_kg", balancer.balls[0].mass_kg),
        ("ball_diameter_m", balancer.balls[0].diameter_m),
    ] {
        let written = |heading: &str| tables(heading)[name]["default"].parse().ok();
        assert_eq!(written("### Ball balancer"), Some(of_balls), "{name}");
        let rounded = written("### Rotor balancer").map(|one: f64| (one * 1e4).round() / 1e4);
        assert_eq!(rounded, default(name), "{name}");
    }
}

/// The unit in a table is that of the key's name and of its description in the schema.
#[test]
fn units_on_the_page_are_those_of_the_schema() {
    let schema = json_schema();
    let units = [
        ("_kg_m3", "kg/m3"),
        ("_kg_m", "kg m"),
        ("_kg", "kg"),
        ("_n_s_m", "N s/m"),
        ("_n_m", "N/m"),
        ("_rad_s", "rad/s"),
        ("_m_s", "m/s"),
        ("_n", "N"),
        ("_m", "m"),
        ("_s", "s"),
        ("_rad", "rad"),
    ];
    let described = &schema["properties"]["uncertain"]["properties"];
    let mut compared = 0;
    for heading in ["### Ball balancer", "### Block on a spring or belt"] {
        for (name, row) in tables(heading).into_iter().filter(|(_, row)| row.contains_key("unit")) {
            let unit = units
                .iter()
                .find(|(ending, _)| name.ends_with(ending))
                .map_or("1", |(_, unit)| *unit);
            assert_eq!(row["unit"], unit, "{name}");
            if let Some(description) = described[&name]["description"].as_str() {
                let written = if unit == "1" { "dimensionless" } else { unit };
                assert!(description.ends_with(&format!(", {written}.")), "{name}: {description}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 23 + 5);
}

/// The default box of start states on the page is that of the schema.
#[test]
fn the_default_box_on_the_page() {
    let schema = json_schema();
    let ranges = &schema["$defs"]["InitialConditionsFile"]["properties"]["box"]["properties"];
    let rows = tables("## Initial conditions");
    let mut compared = 0;
    for (names, row) in rows.iter().filter(|(_, row)| row.contains_key("default range")) {
        for name in names.split(", ").map(|name| name.trim_matches('`')) {
            let Some(description) = ranges[name]["description"].as_str() else { continue };
            if description.starts_with(&format!("`{name}_")) {
                continue; // A key whose values have units.
            }
            let of_one_ball = format!("default that of `{}`.", name.trim_end_matches("_1"));
            let expected = format!("default {}.", row["default range"]);
            let ends = if name.ends_with("_1") { of_one_ball } else { expected };
            assert!(description.ends_with(&ends), "{name}: {description}, {ends}");
            compared += 1;
        }
    }
    assert_eq!(compared, 20);
}
