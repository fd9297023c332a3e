//! Pinned outcomes of each version of the model. Finished runs on disk are reused as long as the
//! version is the same, so that no case may have another outcome under the same version.
//!
//! If a change alters outcomes on purpose, increment `classification::MODEL_VERSION` and renew the
//! pin: `STICKSLIP_PIN_OUTCOMES=1 cargo test --test tests model_version`. The pin holds for every
//! processor that computes in lockstep.

use std::fmt::Write;
use std::path::Path;

use rayon::prelude::*;
use sha2::{Digest, Sha256};
use stickslip::classification::{MODEL_VERSION, simulate};
use stickslip::engine::compute;
use stickslip::study::Study;

use crate::cli::support::parse;

/// Studies that together cover every model, friction law, method and ending.
fn studies() -> Vec<(&'static str, Study)> {
    let balancer = |name, model: &str, rest: &str| {
        let text = format!(
            "schema: 1\nname: a\nseed: 9\nmodel: {{kind: ball_balancer{model}}}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 12}}}}}}\n{rest}"
        );
        (name, parse(&text))
    };
    let block = |name, model: &str| {
        let text = format!(
            "schema: 1\nname: a\nseed: 9\nmodel: {{kind: {model}}}\n\
             initial_conditions: {{box: {{position_m: [-0.1, 0.1], velocity_m_s: [-1, 1]}}, design: {{monte_carlo: \
             {{samples: 12}}}}}}\nsimulation: {{end_time_s: 30}}\n"
        );
        (name, parse(&text))
    };
    let speeds =
        "sweep: [{grid: {speed_rad_s: [-160.8103, -179.2671, -191.6372, -216.3772, -247.3]}}]\n";
    let event = format!(
        "{speeds}simulation: {{method: event, tolerance: {{relative: 1.0e-6, absolute: 1.0e-8}}}}\n"
    );
    let balls = "sweep: [{grid: {speed_rad_s: [-170.0, -230.0]}}]\nsimulation: {end_time_s: 8}\n";
    let stribeck =
        ", friction: {stribeck: {static_friction_coefficient: 4.0e-3, stribeck_speed_rad_s: 1.0}}";
    let viscous = ", friction: {viscous: {viscous_coefficient_n_s_m: 2.0e-4}}";
    let contact = ", contact: {restitution: 0.36, friction_coefficient: 0.1}";
    let start =
        ", contact: {restitution: 0.36}, protocol: {startup_and_hammer: {over_s: 1, wait_s: 2}}";
    let rotor = "schema: 1\nname: a\nseed: 9\nmodel: {kind: rotor_balancer, parameters: {friction_coefficient: 3.0e-3}}\n\
                 initial_conditions: {design: {monte_carlo: {samples: 12}}}\nsimulation: {method: event, end_time_s: 3}\n";
    vec![
        balancer("switch", "", speeds),
        balancer("event", "", &event),
        balancer("one ball", ", parameters: {balls: 1}", balls),
        balancer("three balls", ", parameters: {balls: 3}", balls),
        balancer("newton", ", normal_force: newton", balls),
        balancer("stribeck", stribeck, balls),
        balancer("smooth", ", friction: {smooth: {smoothing_speed_rad_s: 1.0}}", balls),
        balancer("viscous", viscous, balls),
        balancer("contact", contact, speeds),
        balancer("runout", ", parameters: {ring_runout_m: 1.0e-5}", balls),
        balancer("start", start, ""),
        block("block on a spring", "block_on_spring"),
        block("block on a belt", "block_on_belt"),
        ("rotor", parse(rotor)),
    ]
}

#[test]
fn outcomes_are_those_of_the_version() {
    let mut found = format!("version {MODEL_VERSION}\n");
    for (name, study) in studies() {
        let outcomes: Vec<String> = (0..study.run_count())
            .into_par_iter()
            .map(|run_id| {
                let record = compute(&study, run_id, simulate);
                // Debug prints every number so that it parses to the same bits.
                format!("{:?}\n", record.outcome)
            })
            .collect();
        let digest = Sha256::digest(outcomes.concat());
        let digest: String = digest.iter().take(12).map(|byte| format!("{byte:02x}")).collect();
        writeln!(found, "{name}: {} runs, {digest}", outcomes.len()).unwrap();
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/model_version.txt");
    if std::env::var_os("STICKSLIP_PIN_OUTCOMES").is_some() {
        std::fs::write(&path, &found).unwrap();
    }
    let pinned = std::fs::read_to_string(&path).unwrap();
    assert_eq!(found, pinned, "another outcome under the same version: see the top of this file");
}
