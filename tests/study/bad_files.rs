//! Invalid study files: each gives one message with its place, and nothing panics.

use std::fmt::Write;

use super::{parse, says, text_with_design};
use crate::support::cases;

#[track_caller]
fn refused(text: &str, line: Option<usize>, problem: &str) {
    let error = parse(text).err().unwrap_or_else(|| panic!("accepted: {text}"));
    assert!(error.problem().contains(problem), "{error}");
    assert_eq!(error.line(), line, "{error}");
    assert!(error.to_string().starts_with("a.yaml"), "{error}");
}

fn good() -> String {
    text_with_design("{monte_carlo: {samples: 10}}")
}

/// Empty files and other values are no studies, and errors of YAML have their place.
#[test]
fn what_is_no_study_is_refused() {
    refused("", None, "the file is empty");
    refused("# only a comment\n", None, "the file is empty");
    refused("[1, 2]", Some(1), "not a study");
    refused("study", Some(1), "not a study");
    refused("schema: [1", Some(1), "not valid YAML");
    refused("schema: 1\nname: b: c\n", Some(2), "not valid YAML");
    refused("schema: 1\nname: \"a\n", Some(3), "not valid YAML");
    refused("schema: 1\nname: *nothing\n", Some(2), "not valid YAML");
    refused("schema: 1\n<<: {name: a}\n", Some(2), "merge keys");
    refused(&format!("{0}---\n{0}", good()), Some(8), "more than one YAML document");
}

#[test]
fn deep_nesting_is_refused_without_overflow() {
    let flow = format!("model: {}{}\n", "[".repeat(200_000), "]".repeat(200_000));
    refused(&flow, Some(1), "too deep");
    let mut block = String::new();
    for depth in 0..3_000 {
        let _ = writeln!(block, "{}a:", " ".repeat(depth));
    }
    refused(&block, Some(25), "too deep");
}

#[test]
fn alias_bombs_are_refused() {
    let mut bomb = String::from("a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n");
    for (old, new) in ('a'..='k').zip('b'..='l') {
        let _ = writeln!(bomb, "{new}: &{new} [{}]", vec![format!("*{old}"); 10].join(", "));
    }
    refused(&bomb, Some(5), "too many aliases");
    let text = good().replace("seed: 5", "seed: &five 5");
    let text = format!("{text}sweep: [{{grid: {{speed_rad_s: [*five]}}}}]\n");
    assert!(parse(&text).is_ok(), "a small alias");
}

/// The search for the nearest name takes time and memory that do not grow with the wrong name.
#[test]
fn names_of_megabytes_are_unknown_names() {
    let word = "newton".repeat(4_000_000);
    for sweep in [
        format!("grid: {{normal_force: [{word}]}}"),
        format!("table: {{columns: [{word}], rows: [[1]]}}"),
    ] {
        let error = parse(&format!("{}sweep: [{{{sweep}}}]\n", good())).unwrap_err();
        assert!(error.problem().starts_with("unknown"), "{}", error.problem());
        assert!(error.to_string().len() < 5000, "{} bytes", error.to_string().len());
    }
}

#[test]
fn a_message_shows_file_line_key_finding_remedy_and_source() {
    let text = good().replace(
        "{kind: ball_balancer}",
        "\n  kind: ball_balancer\n  parameters:\n    table_mas_kg: 0.3",
    );
    let message = parse(&text).unwrap_err().to_string();
    let lines: Vec<&str> = message.lines().collect();
    assert_eq!(lines[0], "a.yaml:7:5: `model.parameters.table_mas_kg`: unknown key");
    assert_eq!(lines[1], "  found:   table_mas_kg");
    assert!(lines[2].starts_with(
        "  allowed: table_mass_kg (did you mean this?), stiffness_n_m, damping_n_s_m"
    ));
    assert!(!lines[2].contains("belt_speed_m_s"), "a balancer has no belt: {}", lines[2]);
    assert_eq!(lines[3], "  7 |     table_mas_kg: 0.3");
}

/// Returns a study with units, whose parameters are in lines 7 to 9.
fn with_units() -> String {
    "schema: 1\nname: a\nseed: 5\nmodel:\n  kind: ball_balancer\n  parameters:\n    speed: 6000 rpm\n    \
     damping: 60 N s/m\n    stiffness: 100 N/mm\ninitial_conditions:\n  design: {monte_carlo: {samples: 10}}\n"
        .to_owned()
}

/// What is replaced, by what, the line of the message, its problem, what it found, and what it allows.
const FREQUENT: &str = "    damping ¦ \tdamping ¦ 8 ¦ a tab in the indentation ¦ a tab ¦ replace the tab by spaces
    stiffness ¦     \tstiffness ¦ 9 ¦ a tab in the indentation ¦ a tab ¦ replace the tab by spaces
  kind ¦ \tkind ¦ 5 ¦ a tab in the indentation ¦ a tab ¦ replace the tab by spaces
damping: 6 ¦ damping:6 ¦ 8 ¦ a space is missing after the colon ¦ damping:60 N s/m ¦ damping: 60 N s/m
speed: 6 ¦ speed:6 ¦ 7 ¦ a space is missing after the colon ¦ speed:6000 rpm ¦ speed: 6000 rpm
seed: 5 ¦ seed:5 ¦ 3 ¦ a space is missing after the colon ¦ seed:5 ¦ seed: 5
    damping ¦    damping ¦ 8 ¦ wrong indentation ¦ 3 spaces ¦ the same indentation
    damping ¦      damping ¦ 8 ¦ wrong indentation ¦ 5 spaces ¦ the same indentation
    stiffness ¦       stiffness ¦ 9 ¦ wrong indentation ¦ 6 spaces ¦ the same indentation
name: a ¦ name: b: c ¦ 2 ¦ a second colon ¦ b: c ¦ quotes around";

/// The faults that occur most have their own line and remedy.
#[test]
fn frequent_yaml_errors_have_a_remedy() {
    assert!(parse(&with_units()).is_ok());
    for [from, to, line, problem, found, allowed] in cases(FREQUENT) {
        assert!(with_units().contains(&from));
        let text = with_units().replace(&from, &to);
        refused(&text, line.parse().ok(), &problem);
        says(&parse(&text).expect_err(&text), &found, &allowed);
    }
}

#[test]
fn a_duplicate_key_names_its_path_and_its_first_line() {
    let text = with_units().replace("    stiffness", "    speed: 1 rpm\n    stiffness");
    let error = parse(&text).unwrap_err();
    assert_eq!((error.key(), error.line()), ("model.parameters.speed", Some(9)));
    assert!(error.found().unwrap().ends_with("; the first is in line 7"), "{error}");
    let flow = good().replace("{samples: 10}", "{samples: 10, samples: 11}");
    let error = parse(&flow).unwrap_err();
    assert_eq!(error.key(), "initial_conditions.design.monte_carlo.samples");
    let block = good().replace("{kind: ball_balancer}", "\n  kind: a\n  kind: b");
    refused(&block, Some(6), "given twice");
    let tagged = "sweep: [{grid: {speed_rad_s: [1], !other speed_rad_s: [2]}}]\n";
    assert!(parse(&format!("{}{tagged}", good())).is_err(), "a tag does not make another key");
    let top = format!("{}\"seed\": 6\n", good());
    let error = parse(&top).unwrap_err();
    assert!(error.key() == "seed" && error.found().unwrap().ends_with("in line 3"), "{error}");
}

/// One missing key has the same example as several.
#[test]
fn a_missing_key_has_an_example() {
    for (part, key, example) in [
        ("seed: 5\n", "seed", "such as seed: 1"),
        ("  kind: ball_balancer\n", "model.kind", "such as model: {kind: ball_balancer}"),
        (
            "initial_conditions:\n  design: {monte_carlo: {samples: 10}}\n",
            "initial_conditions",
            "such as initial_conditions: {design: {monte_carlo: {samples: 100}}}",
        ),
    ] {
        let error = parse(&with_units().replace(part, "")).unwrap_err();
        assert_eq!(error.key(), key);
        assert!(error.allowed().unwrap().ends_with(example), "{error}");
    }
}
