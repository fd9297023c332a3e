//! Every part of a system file replaced by values that do not belong there: each is read or refused with its place, what was
//! found and a remedy, and no run of what was read panics.

use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::parse;
use crate::support::places;
use stickslip::classification::{Label, simulate};

/// Far more than a system takes, for a slow machine.
const LONGEST: Duration = Duration::from_secs(20);

/// Files with contacts that open, several bodies, given normal forces, and reactions.
const SYSTEMS: [&str; 4] = ["woodpecker", "block_chain", "belt_oscillator", "ball_balancer"];

/// Values that belong to no place, or to a few.
const HOSTILE: &str = r#"[null, true, -1, 0, 1.5, 1e308, 18446744073709551615, "", "x", "1 kg", "0 m", ".nan", "y' * y'",
"sum(block, x[block])", "\u0000\u202e'\"[{", "t", "tanh(1e9 * t)", [], [0, 1], [1, 0], {}, {"x": "x"}]"#;

fn hostile() -> Vec<Value> {
    let mut all: Vec<Value> = serde_json::from_str(HOSTILE).expect("JSON");
    all.push((0..200).fold(json!(1), |inner, _| json!([inner])));
    all
}

#[test]
fn hostile_values_are_refused_or_read() {
    let (mut read, mut refused, mut failed, mut simulated) = (0, 0, 0, 0);
    for system in SYSTEMS {
        let file = format!("{}/studies/systems/{system}.yaml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(file).expect("a system");
        let good: Value = serde_saphyr::from_str(&text).expect("YAML");
        for (place, at) in places(&good, usize::MAX).iter().enumerate() {
            // A third of all pairs of a place and a value.
            for (which, value) in hostile().into_iter().enumerate().skip(place % 3).step_by(3) {
                let mut changed = good.clone();
                *changed.pointer_mut(at).expect("a place") = value.clone();
                let study = json!({
                    "schema": 1,
                    "name": "a",
                    "seed": 1,
                    "model": {"system": changed},
                    "initial_conditions": {"design": {"monte_carlo": {"samples": 1}}},
                    "simulation": {"end_time_s": 0.2},
                });
                let begun = Instant::now();
                match parse(&serde_json::to_string_pretty(&study).expect("JSON")) {
                    Err(error) => {
                        let said = error.to_string();
                        let is_complete = error.line().is_some()
                            && error.found().is_some()
                            && error.allowed().is_some();
                        assert!(is_complete && said.len() < 4000, "{system}{at}: {value}: {said}");
                        refused += 1;
                    }
                    Ok(study) => {
                        read += 1;
                        // A seventh of what is valid runs.
                        if (place + which) % 7 == 0
                            && let Ok(case) = study.planned_run(0).case
                        {
                            simulated += 1;
                            failed += i32::from(simulate(&case).label() == Label::Failed);
                        }
                    }
                }
                assert!(begun.elapsed() < LONGEST, "{system}{at}: {value}");
            }
        }
    }
    assert!(read > 100 && refused > 1000, "{read} read, {refused} refused");
    assert!(simulated > 20 && failed < simulated, "{failed} of {simulated} failed");
}
