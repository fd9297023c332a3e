//! Speed profiles and kicks in a study file.

use std::f64::consts::TAU;
use std::fs;

use stickslip::model::{Machine, ProfilePart, Ramp, RampShape, SpeedProfile};
use stickslip::study::Study;
use tempfile::tempdir;

use super::{parse, study as study_of};
use crate::support::cases;

fn text(model: &str, rest: &str) -> String {
    format!(
        "schema: 1\nname: a\nseed: 1\nmodel: {{kind: ball_balancer, {model}}}\n\
         initial_conditions: {{design: {{monte_carlo: {{samples: 4}}}}}}\n{rest}"
    )
}

fn refusal(text: &str) -> String {
    parse(text).expect_err("refused").to_string()
}

fn machine(study: &Study) -> &Machine {
    study.model().ball_balancer().expect("a balancer")
}

fn profile(study: &Study) -> &SpeedProfile {
    machine(study).speed_profile.as_ref().expect("a profile")
}

fn ramp(shape: RampShape, to_rad_s: Option<f64>, over_s: f64) -> ProfilePart {
    ProfilePart::Ramp(Ramp { shape, to_rad_s, over_s })
}

/// The last ramp leads to the speed of the parameters, each other part begins at the speed before.
#[test]
fn parts_follow_one_another() {
    let written = text(
        "parameters: {speed_rad_s: -250}, speed_profile: [{ramp: {from_rad_s: -31, to_rad_s: -100, over: 2000 ms}}, \
         {hold_s: 3}, {table: {columns: [time_s, speed_rad_s], rows: [[0, -100], [1, -150]]}}, \
         {smooth_ramp: {from_rad_s: -150, over_s: 0.5}}, {hold_s: 4.5}]",
        "",
    );
    let study = study_of(&written);
    let expected = SpeedProfile {
        start_speed_rad_s: -31.0,
        parts: vec![
            ramp(RampShape::Linear, Some(-100.0), 2.0),
            ProfilePart::Hold(Some(3.0)),
            ProfilePart::Table(vec![[0.0, -100.0], [1.0, -150.0]]),
            ramp(RampShape::Smooth, None, 0.5),
            ProfilePart::Hold(Some(4.5)),
        ],
    };
    assert_eq!(profile(&study), &expected);
    assert_eq!(machine(&study).speed_rad_s, -250.0);
    // The run ends with the plateau at the end.
    assert_eq!(study.simulation().end_time_s, 11.0);
    let again = study_of(&study.resolved_yaml());
    assert_eq!(profile(&again), &expected);
    assert_eq!(again.hash(), study.hash());
    // Table and balls start at rest on the disc.
    let start = study.planned_run(2).start.0;
    assert_eq!([start[0], start[1]], [0.0; 2]);
    assert_eq!(start[4..], [0.0; 4]);
    assert!(start[2] != 0.0 && start[3] != 0.0);
}

/// Without a speed among the parameters, the profile gives it; without a plateau at the end, `end_time_s` ends the run.
#[test]
fn the_last_speed_may_be_given_by_the_profile() {
    let study = study_of(&text(
        "speed_profile: [{ramp: {from_rad_s: -31, to_rad_s: -99.5, over_s: 2}}]",
        "simulation: {end_time_s: 7}\n",
    ));
    assert_eq!((machine(&study).speed_rad_s, study.simulation().end_time_s), (-99.5, 7.0));
    let study = study_of(&text("speed_profile: [{ramp: {from_rad_s: -31, over_s: 2}}]", ""));
    assert_eq!(machine(&study).speed_rad_s, Machine::default().speed_rad_s);
}

#[test]
fn a_profile_is_read_from_a_file() {
    let scratch = tempdir().expect("a folder");
    fs::write(scratch.path().join("profile.csv"), "time_s,speed_rad_s\n0,-20\n1.5,-80\n4,-200\n")
        .expect("a written table");
    let study = text("speed_profile: [{table: profile.csv}]", "");
    let study = Study::parse(&scratch.path().join("a.yaml"), study).expect("a valid study");
    let rows = vec![[0.0, -20.0], [1.5, -80.0], [4.0, -200.0]];
    assert_eq!(profile(&study).parts, [ProfilePart::Table(rows)]);
}

/// Each number of the profile and of the kicks is swept, drawn and designed; the end of a run follows its own durations.
#[test]
fn each_number_varies() {
    let study = study_of(&text(
        "contact: {}, speed_profile: [{ramp: {from_rad_s: -31, to_rad_s: -100, over_s: 2}}, {hold_s: 1}, \
         {ramp: {over_s: 3}}, {hold_s: 5}], \
         disturbances: [{kick: {at_s: 7, speed_m_s: 0.01, direction_rad: 1}}, {kick: {at_s: 8, speed_m_s: 0.02}}]",
        "sweep: [{grid: {speed_rad_s: [-200, -220], ramp_over_2_s: [3, 4]}}]\n\
         uncertain: {kick_speed_m_s: {times: {uniform: {min: 0.5, max: 1.5}}}, hold_1_s: {uniform: {min: 1, max: 2}}}\n\
         design: {start_speed_rad_s: {from: -40, to: -20}, ramp_to_1_rad_s: {from: -150, to: -50}}\n",
    ));
    assert_eq!(study.point_count(), 4);
    let names: Vec<&str> = study.uncertain().iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["hold_1_s", "kick_speed_m_s", "kick_direction_2_rad"]);
    let mut directions = Vec::new();
    for run in 0..study.run_count() {
        let planned = study.planned_run(run);
        let case = planned.case.expect("a possible run");
        let machine = case.model.ball_balancer().expect("a balancer");
        let parts = &machine.speed_profile.as_ref().expect("a profile").parts;
        let ProfilePart::Hold(Some(first)) = parts[1] else { panic!("{parts:?}") };
        let over_s = [3.0, 4.0][(planned.point_id % 2) as usize];
        assert_eq!(parts[2], ramp(RampShape::Linear, None, over_s));
        assert_eq!(machine.speed_rad_s, [-200.0, -220.0][(planned.point_id / 2) as usize]);
        assert!((1.0..2.0).contains(&first));
        assert_eq!(case.simulation.end_time_s, 2.0 + first + over_s + 5.0);
        let [first, other] = [0, 1].map(|kick| machine.kicks[kick]);
        assert_eq!((first.direction_rad, first.speed_m_s), (1.0, other.speed_m_s));
        assert!((0.0..TAU).contains(&other.direction_rad));
        directions.push(other.direction_rad);
    }
    directions.sort_by(f64::total_cmp);
    directions.dedup();
    // Each point has the same draws.
    assert_eq!(directions.len(), 4);
}

/// A swept speed is the last one of the profile.
#[test]
fn runs_of_a_swept_speed_reach_it() {
    let study = study_of(&text(
        "parameters: {speed_rad_s: -100}, speed_profile: [{ramp: {from_rad_s: -10, over_s: 2}}]",
        "sweep: [{grid: {speed_rad_s: [-150, -200]}}]\n",
    ));
    for (run, speed) in [(0, -150.0), (4, -200.0)] {
        let case = study.planned_run(run).case.expect("a possible run");
        let stages = case.model.stages(&case.start, case.simulation.end_time_s).expect("two balls");
        let speeds: Vec<[f64; 2]> =
            stages.iter().map(|stage| stage.speeds_rad_s.expect("a disc")).collect();
        assert_eq!(speeds, [[-10.0, speed], [speed; 2]]);
    }
}

#[test]
fn wrong_profiles_are_refused_with_their_key() {
    for [model, rest, key, part] in cases(
        r"speed_profile: [{ramp: {over_s: 2}}] ¦  ¦ model.speed_profile[0].ramp ¦ from_rad_s
parameters: {speed_rad_s: -90}, speed_profile: [{ramp: {from_rad_s: -31, to_rad_s: -100, over_s: 2}}] ¦  ¦ model.speed_profile[0].ramp.to_rad_s ¦ -90
speed_profile: [{ramp: {from_rad_s: 31, to_rad_s: -100, over_s: 2}}] ¦  ¦ model.speed_profile[0].ramp ¦ from 31 to -100
speed_profile: [{ramp: {from_rad_s: -31, to_rad_s: -100, over_s: 0}}] ¦  ¦ model.speed_profile[0].ramp.over_s ¦ above 0
speed_profile: [{ramp: {from_rad_s: -31, to_rad_s: -100, over_s: 2}}, {ramp: {from_rad_s: -90, to_rad_s: -120, over_s: 1}}] ¦  ¦ model.speed_profile[1].ramp ¦ -100, the speed before
speed_profile: [{ramp: {from_rad_s: -31, to_rad_s: -100, over_s: 2}}, {hold_s: 3}] ¦ simulation: {end_time_s: 8}\n ¦ simulation.end_time_s ¦ 5, no such key
speed_profile: [{table: {columns: [time_s, speed_rad_s], rows: [[1, -10], [2, -20]]}}] ¦  ¦ model.speed_profile[0].table.rows[0][0] ¦ 0 in the first row
disturbances: [{kick: {at_s: 20, speed_m_s: 0.01}}] ¦  ¦ model.disturbances[0].kick.at_s ¦ before the end
disturbances: [{kick: {at_s: 2, speed_m_s: -0.01}}] ¦  ¦ model.disturbances[0].kick.speed_m_s ¦ at least 0
disturbances: [{kick: {at_s: 2, speed_m_s: 0.1, direction: random, direction_rad: 1}}] ¦  ¦ model.disturbances[0].kick.direction_rad ¦ one of both",
    ) {
        let message = refusal(&text(&model, &rest));
        assert!(message.contains(&key) && message.contains(&part), "{model}: {message}");
    }
    let block = "schema: 1\nname: a\nseed: 1\nmodel: {kind: block_on_spring, disturbances: []}\n\
                 initial_conditions: {design: {monte_carlo: {samples: 4}}}\n";
    assert!(refusal(block).contains("only for a ball balancer"));
}

/// A protocol is short for a speed profile and kicks; the resolved study contains those.
#[test]
fn protocols_of_the_thesis() {
    let resolved = |model: &str, rest: &str| study_of(&text(model, rest)).resolved_yaml();
    let ramp =
        "parameters: {speed_rad_s: -100}, speed_profile: [{ramp: {from_rad_s: -31, over_s: 2}}";
    let startup = resolved("parameters: {speed_rad_s: -100}, protocol: startup", "");
    assert_eq!(startup, resolved(&format!("{ramp}]"), ""));
    assert!(!startup.contains("protocol"), "{startup}");
    let hits = "parameters: {speed_rad_s: -100}, protocol: {startup_and_hammer: {hits: 2, wait: 4000 ms, over_s: 2}}";
    let kicks = format!(
        "{ramp}, {{hold_s: 12}}], disturbances: [{{kick: {{at_s: 6, speed_m_s: 0.01}}}}, \
         {{kick: {{at_s: 10, speed_m_s: 0.01, direction: random}}}}]"
    );
    assert_eq!(resolved(hits, ""), resolved(&kicks, ""));
    let counter_clockwise = "parameters: {speed_rad_s: 300}, protocol: {startup: {over_s: 3}}";
    let written =
        "parameters: {speed_rad_s: 300}, speed_profile: [{ramp: {from_rad_s: 31, over_s: 3}}]";
    assert_eq!(resolved(counter_clockwise, ""), resolved(written, ""));
}

#[test]
fn protocols_that_are_refused() {
    for [model, problem] in cases(
        "protocol: start ¦ model.protocol
protocol: startup, disturbances: [{kick: {at_s: 1, speed_m_s: 1}}] ¦ disturbances beside protocol
protocol: {startup: {over_s: 0}} ¦ `model.protocol.startup.over_s`: out of range
protocol: {startup: {from_rad_s: 31}} ¦ `model.protocol.startup.from_rad_s`: not a first speed
protocol: {startup_and_hammer: {hits: 9}} ¦ `model.protocol.startup_and_hammer.hits`: out of range
protocol: {startup_and_hammer: {wait_s: -1}} ¦ `model.protocol.startup_and_hammer.wait_s`: out of range
protocol: {startup_and_hammer: {speed_m_s: -1}} ¦ `model.protocol.startup_and_hammer.speed_m_s`: out of range",
    ) {
        let message = refusal(&text(&model, ""));
        assert!(message.contains(&problem), "{model}: {message}");
    }
}

/// The peak amplitude is a response of runs with stages, and of no others.
#[test]
fn responses_of_the_peak_amplitude() {
    let with =
        |model: &str, response: &str| text(model, &format!("responses: {{r: {response}}}\n"));
    let peak = "{amplitude_quantile: {fraction: 0.95, of: peak}}";
    let study = study_of(&with("protocol: startup", peak));
    let [response] = study.responses() else { panic!("one response") };
    assert_eq!(
        (response.unit(), &*response.meaning()),
        ("m", "quantile 0.95 of the peak amplitude")
    );
    let message = refusal(&with("friction: coulomb", peak));
    assert!(message.contains("no peak amplitude at constant speed"), "{message}");
    let relative = "{amplitude_quantile: {fraction: 0.95, of: peak, relative: true}}";
    let message = refusal(&with("protocol: startup", relative));
    assert!(message.contains("no counterpart without balls"), "{message}");
}
