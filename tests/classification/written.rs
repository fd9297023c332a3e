//! Systems in files end as the systems of Rust programs, and as publications say.

use stickslip::classification::{
    Instants, Label, Outcome, RunRecorder, simulate, simulate_recorded,
};
use stickslip::model::{Case, Machine, Model, Simulation};
use stickslip::study::Study;

use crate::support::{angular_distance, balancer_of_a_file, cases_of, parse, shipped};

/// Returns the outcomes of the runs of a study of this folder, with some texts replaced.
fn outcomes(name: &str, replaced: &[(&str, &str)]) -> Vec<Outcome> {
    let mut text = std::fs::read_to_string(shipped(name)).expect("a study");
    for (old, new) in replaced {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    cases_of(&parse(text)).iter().map(simulate).collect()
}

/// Steady sliding of the oscillator of Stender et al. (2020) in 0.312 of the start states; of 600 here, 4 standard errors.
#[test]
fn a_belt_oscillator_of_a_file_slides_as_often_as_published() {
    let all = outcomes("belt-oscillator.yaml", &[("samples: 4000", "samples: 600")]);
    let fraction =
        |label| all.iter().filter(|outcome| outcome.label() == label).count() as f64 / 600.0;
    let slides = fraction(Label::Equilibrium);
    assert!((slides - 0.312).abs() < 4.0 * (0.312_f64 * 0.688 / 600.0).sqrt(), "{slides}");
    assert_eq!(fraction(Label::Undecided) + fraction(Label::Failed), 0.0);
}

/// A pendulum without contacts comes to rest if it is damped: an amplitude of 1 rad decays as exp(-t / 10 s) to 1e-6 in 138 s.
/// Without damping it swings on, which no evidence decides.
#[test]
fn a_damped_pendulum_comes_to_rest() {
    let folder = tempfile::tempdir().expect("a folder");
    for (damping, label) in [("0.2", Label::Equilibrium), ("0", Label::Periodic)] {
        let system = format!(
            "system: pendulum\nmeaning: a pendulum\nparameters: {{l: 1 m, c: {damping} N m s, g: 9.81 m/s^2, m: 1 kg}}\n\
             coordinates:\n  phi: {{unit: rad, start: [0.1, 1], periodic: true}}\n\
             mass: {{phi: {{phi: m * l^2}}}}\nforce: {{phi: -m * g * l * sin(phi) - c * phi'}}\n"
        );
        std::fs::write(folder.path().join("pendulum.yaml"), system).expect("a file");
        let study = "schema: 1\nname: a\nseed: 1\nmodel: {system: pendulum.yaml}\n\
                     initial_conditions: {design: {latin_hypercube: {samples: 8}}}\nsimulation: {end_time_s: 200}\n";
        let study = Study::parse(&folder.path().join("a.yaml"), study.to_owned()).expect("valid");
        for case in cases_of(&study) {
            let outcome = simulate(&case);
            assert_eq!(outcome.label(), label, "{outcome:?}");
            if label == Label::Equilibrium {
                let time = outcome.time_to_rest_s().expect("a time");
                assert!((100.0..145.0).contains(&time), "{time}");
                let angle = outcome.outputs[0].end;
                assert!(angular_distance(angle, 0.0) < 1e-5, "{angle}");
            }
        }
    }
}

/// The balancer with two balls, written as a file, ends as the built-in one does: its normal forces are reactions that contain
/// accelerations.
#[test]
fn a_balancer_of_a_file_ends_as_the_built_one() {
    let mut rests = 0;
    for speed_rad_s in [-160.8103, -216.3772] {
        let machine = Machine { speed_rad_s, ..Machine::default() };
        let end = 16.5 * machine.natural_frequency_rad_s();
        let text = balancer_of_a_file(&machine)
            + &format!(
                "initial_conditions: {{design: {{monte_carlo: {{samples: 48}}}}}}\nsimulation: {{end_time_s: {end}}}\n"
            );
        for (run, written) in cases_of(&parse(text)).into_iter().enumerate() {
            let (model, start) = (machine.clone().into(), written.start.clone());
            let built = simulate(&Case { model, start, simulation: Simulation::default() });
            let written = simulate(&written);
            assert_eq!(
                built.evidence.name(),
                written.evidence.name(),
                "{speed_rad_s} {run}: {built:?} {written:?}"
            );
            if built.label() == Label::Equilibrium {
                let [built, written] =
                    [built, written].map(|outcome| outcome.position.expect("positions"));
                for (built, written) in built.iter().zip(written) {
                    assert!(angular_distance(*built, written) < 1e-5, "{run}: {built} {written}");
                }
                rests += 1;
            }
        }
    }
    assert!(rests > 60, "{rests}");
}

/// Stick and slip of light balls are decided in one way in all states, and those of balls as heavy as the machine are not.
#[test]
fn light_balls_have_one_solution_everywhere() {
    let sure = |kind: &str| {
        let text = format!(
            "schema: 1\nname: a\nseed: 1\nmodel: {kind}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 1}}}}}}\n"
        );
        parse(text).model().system().expect("a system").surely_one_solution()
    };
    let balancer = |values: &str| {
        sure(&format!("{{system: systems/ball_balancer.yaml, parameters: {{{values}}}}}"))
    };
    assert!(balancer("count: 2") && balancer("count: 8") && sure("{kind: rotor_balancer}"));
    assert!(!balancer("m: 0.4") && !balancer("m: 0.1, mu: 5"));
}

/// A block on ground that a table moves by `3 t² - 2 t³` m in 1 s, with a friction limit of 4 m/s² times its mass: it slips backward
/// until 1/3 s, sticks until 5/6 s, and slips forward until it rests at 25/24 s. The spline is this polynomial, also with a row
/// between. Both methods agree, and the position of the block as coordinate in place of that from the ground.
#[test]
fn a_block_on_ground_that_a_table_moves() {
    let slip = -(3.0 / 9.0 - 2.0 / 27.0) + 2.0 / 9.0 + 2.0 / 216.0 + (1.0_f64 / 6.0).powi(2) / 8.0;
    let relative = ("-m * ground''", "x'", slip);
    let absolute = ("0", "x' - ground'", 1.0 + slip);
    for (method, (force, sliding, end)) in
        [("event", relative), ("switch", relative), ("event", absolute)]
    {
        let study = parse(format!(
            "schema: 1\nname: a\nseed: 1\nmodel:\n  system:\n    system: a\n    parameters: {{m: 2 kg, load: 8 N, mu: 1}}\n\
             \x20   motions: {{ground: {{unit: m, table: {{columns: ['time [ms]', ground_m], rows: [[0, 0], [300, 0.216], [1000, 1]]}}}}}}\n\
             \x20   coordinates: {{x: {{unit: m}}}}\n    mass: {{x: {{x: m}}}}\n    force: {{x: \"{force}\"}}\n\
             \x20   contacts: {{ground: {{normal: load, sliding: \"{sliding}\", friction: {{coulomb: {{coefficient: mu}}}}}}}}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 1}}}}}}\nsimulation: {{method: {method}, end_time_s: 3}}\n"
        ));
        let [case] = &cases_of(&study)[..] else { panic!("one run") };
        assert_eq!(case.model.stage_begins_s(3.0), [0.0, 0.3, 1.0]);
        let mut recorder = RunRecorder::new(Instants::EveryStep { inside: 0 }, 1000);
        let outcome = simulate_recorded(case, &mut recorder);
        assert_eq!(outcome.evidence.name(), "rest_certified");
        assert!((outcome.outputs[0].end - end).abs() < 1e-8, "{method}: {outcome:?}");
        let rate = case.model.units().natural_rad_s;
        let switches = recorder.finish().switches;
        let times: Vec<f64> = switches.iter().map(|switch| switch.time / rate).collect();
        for expected in [1.0 / 3.0, 5.0 / 6.0, 25.0 / 24.0] {
            let is_there = times.iter().any(|time| (time - expected).abs() < 1e-6);
            assert!(is_there, "{method} {expected}: {times:?}");
        }
    }
}

/// The permanent displacements of the shipped study are those of Newmark's method: small steps in which the block slides with the
/// acceleration that friction leaves, or moves with the ground. The page of system files has one of them.
#[test]
fn a_shaken_block_slides_as_far_as_by_small_steps() {
    let page = include_str!("../../docs/system-files.md");
    let study = parse(std::fs::read_to_string(shipped("shaken-block.yaml")).expect("a study"));
    let mut all = Vec::new();
    for case in cases_of(&study) {
        let Model::Own(model) = &case.model else { panic!("a system") };
        let (weight, limit) = {
            let [slope, g, mu] = ["slope_rad", "g_m_s2", "mu"].map(|name| model.number(name));
            (g * slope.sin(), mu * g * slope.cos())
        };
        let ground = case.model.given_motions()[0];
        let (mut slip, mut speed, step) = (0.0_f64, 0.0_f64, 2e-5);
        for number in 0..250_000 {
            let force = match ground.terms_from((f64::from(number) + 0.5) * step)[..] {
                [_, _, second, _] => weight - 2.0 * second,
                _ => weight,
            };
            let sliding = if speed == 0.0 { force } else { speed };
            let next = speed + step * (force - limit * sliding.signum());
            let stops = next * sliding <= 0.0 || speed == 0.0 && force.abs() <= limit;
            let after = if stops { 0.0 } else { next };
            slip += step * 0.5 * (speed + after);
            speed = after;
        }
        let outcome = simulate(&case);
        assert_eq!(outcome.evidence.name(), "rest_certified");
        let end = outcome.outputs[0].end;
        assert!((end - slip).abs() < 2e-4, "{end} {slip}");
        all.push(end);
    }
    let words = format!("displaced by {:.0} mm down a slope of 5°", 1e3 * all[3]);
    assert!(page.replace('\n', " ").contains(&words), "{words}");
}

/// Sliding speeds that contain the time, of contacts with static friction above kinetic friction: no run fails, and rows of a table
/// at which a contact sticks are no switches.
#[test]
fn sliding_speeds_with_the_time_are_decided() {
    let rows = (0..=60).map(|row| f64::from(row) / 20.0);
    let rows =
        rows.map(|time| format!("[{time}, {}]", 0.2 * (1.0 - (2.0 * time).cos()) * (3.0 - time)));
    let rows = rows.collect::<Vec<String>>().join(", ");
    let table =
        format!("motions: {{g: {{unit: m, table: {{columns: [time_s, g_m], rows: [{rows}]}}}}}}");
    let ramp = "  speed_profile: [{ramp: {from: 10 rpm, over: 2 s}}, {hold: 1 s}]\n";
    let mut switches = Vec::new();
    for (keys, sliding, speed, profile, method) in [
        (table.as_str(), "x' - g'", "0.05 m/s", "", "event"),
        (table.as_str(), "x' - g'", "0.05 m/s", "", "switch"),
        ("turning: {theta: speed}", "x' - r * theta'", "0.05 m/s", ramp, "event"),
        ("period: 2 * pi / w", "x' - v * cos(w * t)", "0", "", "event"),
    ] {
        let study = parse(format!(
            "schema: 1\nname: a\nseed: 1\nmodel:\n  system:\n    system: a\n    {keys}\n\
             \x20   parameters: {{m: 1 kg, k: 400 N/m, c: 2 N s/m, load: 10 N, v: 0.2 m/s, w: 7 rad/s, r: 0.12 m, speed: 60 rpm}}\n\
             \x20   coordinates: {{x: {{unit: m, start: [-0.02, 0.02]}}}}\n    mass: {{x: {{x: m}}}}\n    force: {{x: -k * x - c * x'}}\n\
             \x20   contacts: {{pad: {{normal: load, sliding: \"{sliding}\", friction: {{stribeck: {{coefficient: 0.2, \
             static_coefficient: 0.3, stribeck_speed: {speed}}}}}}}}}\n{profile}\
             initial_conditions: {{design: {{latin_hypercube: {{samples: 8}}}}}}\n\
             simulation: {{method: {method}{}}}\n",
            if profile.is_empty() { ", end_time_s: 12" } else { "" }
        ));
        let outcomes: Vec<Outcome> = cases_of(&study).iter().map(simulate).collect();
        let failed = outcomes.iter().find(|outcome| outcome.label() == Label::Failed);
        assert!(failed.is_none(), "{sliding}, {method}: {failed:?}");
        switches.push(outcomes.iter().map(|outcome| outcome.effort.switches).sum::<u64>());
    }
    // The switch model counts up to twice as many, because a contact that sets off passes the band. There are none at the 60 rows.
    let [event, switch] = [switches[0], switches[1]];
    assert!(event <= switch && switch <= 2 * event && event < 60, "{switches:?}");
}

/// A ball that falls from rest bounces after `sqrt(2 h / g)`, and then after the time of flight `2 e^n sqrt(2 h / g)` of each bounce.
#[test]
fn bounces_are_recorded() {
    let study = parse(
        "schema: 1\nname: a\nseed: 1\nmodel:\n  system:\n    system: a\n    parameters: {m: 1 kg, g: 9.81 m/s^2}\n\
         \x20   coordinates: {y: {unit: m, start: 0.5}}\n    mass: {y: {y: m}}\n    force: {y: -m * g}\n\
         \x20   contacts: {floor: {gap: y, restitution: 0.8}}\n\
         initial_conditions: {design: {monte_carlo: {samples: 1}}}\nsimulation: {method: event, end_time_s: 2}\n",
    );
    let [case] = &cases_of(&study)[..] else { panic!("one run") };
    let mut recorder = RunRecorder::new(Instants::EveryStep { inside: 0 }, 1000);
    simulate_recorded(case, &mut recorder);
    let landings = recorder.finish().landings;
    let (fall, mut time) = ((1.0_f64 / 9.81).sqrt(), 0.0);
    for (bounce, (landed, contact)) in landings[..5].iter().enumerate() {
        time += if bounce == 0 { fall } else { 2.0 * 0.8_f64.powi(bounce as i32) * fall };
        let landed = landed / case.model.units().natural_rad_s;
        assert!(*contact == 0 && (landed - time).abs() < 1e-9, "{bounce}: {landed} {time}");
    }
}

/// A motion that rests at 0 changes nothing, although its rows divide the ramp of a shaft into stages.
#[test]
fn a_motion_may_stand_beside_a_part_that_turns() {
    let text = std::fs::read_to_string(shipped("systems/unbalanced_shaft.yaml")).expect("a file");
    let folder = tempfile::tempdir().expect("a folder");
    let outcome = |system: &str| {
        std::fs::write(folder.path().join("shaft.yaml"), system).expect("a file");
        let study = "schema: 1\nname: a\nseed: 1\n\
                     model: {system: shaft.yaml, speed_profile: [{ramp: {from: 300 rpm, over: 1 s}}, {hold: 0.5 s}]}\n\
                     initial_conditions: {box: {x_m: [1.0e-4, 1.0e-4]}, design: {monte_carlo: {samples: 1}}}\n\
                     simulation: {method: event, tolerance: {relative: 1.0e-11, absolute: 1.0e-13}}\n";
        let study = Study::parse(&folder.path().join("a.yaml"), study.to_owned()).expect("valid");
        let [case] = &cases_of(&study)[..] else { panic!("one run") };
        (case.model.stage_begins_s(1.5), simulate(case))
    };
    let motion = "motions: {road: {unit: m, table: {columns: [time_s, road_m], rows: [[0, 0], [0.37, 0], [0.8, 0]]}}}\nturning:";
    let shaken = text
        .replace("turning:", motion)
        .replace("force: {x: \"", "force: {x: \"k * road + m * road'' + ");
    assert!(shaken.contains("m * road''"));
    let [(plain, alone), (divided, beside)] = [&text, &shaken].map(|text| outcome(text));
    assert_eq!((plain, divided), (vec![0.0, 1.0], vec![0.0, 0.37, 0.8, 1.0]));
    assert_eq!(alone.label(), beside.label());
    for (alone, beside) in alone.outputs.iter().zip(&beside.outputs) {
        assert!((alone.end - beside.end).abs() < 1e-9, "{alone:?} {beside:?}");
    }
}
