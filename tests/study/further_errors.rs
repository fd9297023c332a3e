//! A wrong study lists all errors that do not depend on each other.

use super::{parse, study};

fn keys(text: &str) -> Vec<(String, Option<usize>)> {
    let error = parse(text).unwrap_err();
    let all = std::iter::once(&error).chain(error.others());
    all.map(|error| (error.key().to_owned(), error.line())).collect()
}

fn key(name: &str, line: usize) -> (String, Option<usize>) {
    (name.to_owned(), Some(line))
}

const WRONG: &str = "schema: 1
name: a b
seed: x
model:
  kind: ball_balancer
  parameters: {sped: 3000 rpm, ball_mass: 0.1, table_mass_kg: -1, stiffness: 10 kg}
sweep:
  - grid: {speed_rad_s: [], ball_diameter_m: [0.003]}
uncertan: {}
initial_conditions: {design: {monte_carlo: {samples: 4}}}
simulation: {end_time_s: 2, methd: switch}
responses: {a: {amplitude_above: {limit: 3 kg}}}
";

#[test]
fn all_independent_errors_are_listed() {
    let found = keys(WRONG);
    let expected = [
        key("name", 2),
        key("seed", 3),
        key("model.parameters.sped", 6),
        key("model.parameters.ball_mass", 6),
        key("model.parameters.table_mass_kg", 6),
        key("model.parameters.stiffness", 6),
        key("sweep[0].grid.speed_rad_s", 8),
        key("uncertan", 9),
        key("simulation.methd", 11),
        key("responses.a.amplitude_above.limit", 12),
    ];
    for place in &expected {
        // A check between keys may not follow an error on which it could depend.
        let may_be_missing =
            ["name", "model.parameters.table_mass_kg", "sweep[0].grid.speed_rad_s"];
        assert!(
            found.contains(place) || may_be_missing.contains(&place.0.as_str()),
            "{place:?} {found:?}"
        );
    }
    assert!(found.iter().all(|place| expected.contains(place)), "{found:?}");
    // Each message stands alone, with what was found and what is allowed.
    let text = parse(WRONG).unwrap_err().to_string();
    assert_eq!(text.matches("\n  allowed: ").count(), found.len(), "{text}");
}

/// An error that follows from another one is not listed: without the wrong end time, the default end time would be too short
/// for the kick.
#[test]
fn consequences_are_not_listed() {
    let text = |end: &str| {
        format!(
            "schema: 1\nname: a\nseed: 1\nmodel: {{kind: ball_balancer, disturbances: [{{kick: {{at_s: 20, speed_m_s: 0.01, direction: random}}}}]}}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 4}}}}}}\nsimulation: {{end_time_s: {end}}}\n"
        )
    };
    study(&text("30"));
    assert_eq!(keys(&text("30 s")), [key("simulation.end_time_s", 6)]);
    // Each value that is left out leaves a study that is read to its end.
    let two = text("30").replace("at_s: 20", "at_s: 20, sped: 1").replace("seed: 1", "seed: -1");
    assert_eq!(keys(&two).len(), 2);
}

/// The first error is the one of a study without the others, and a single error stands alone.
#[test]
fn a_single_error_stands_alone() {
    let fewer =
        WRONG.lines().filter(|line| !line.starts_with("uncertan")).collect::<Vec<_>>().join("\n");
    assert_eq!(keys(&fewer)[0], keys(WRONG)[0]);
    let single = "schema: 1\nname: a\nseed: 1\nmodel: {kind: ball_balancer}\nnothing: 1\n\
                  initial_conditions: {design: {monte_carlo: {samples: 4}}}\n";
    let error = parse(single).unwrap_err();
    assert_eq!((error.key(), error.others().len()), ("nothing", 0));
}
