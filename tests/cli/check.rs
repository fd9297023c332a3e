//! `check`: warnings, the machine, closed forms and the cost of a search.

use serde_json::{Value, json};
use stickslip::check::warnings;
use stickslip::study::Study;

use super::support::{AT_ONCE, Scratch, assert_has, numbers, parse, study_text};
use crate::support::{cases, shipped, study_files};

/// The thesis's machine; `ball_mass_kg` is on line 14 of a study.
const MACHINE: &str = "\
model:
  kind: ball_balancer
  parameters:
    table_mass_kg: 0.324
    stiffness_n_m: 10700
    damping_n_s_m: 1.28
    ring_radius_m: 0.0115
    imbalance_mass_kg: 5.6e-5
    imbalance_radius_m: 0.037
    balls: 2
    ball_mass_kg: 1.4e-4
    ball_diameter_m: 0.003
    friction_coefficient: 2.75e-3
    speed_rad_s: -216.4
";

/// Returns a study with a model and further lines.
fn study(model: &str, rest: &str) -> String {
    format!(
        "schema: 1\nname: a\nseed: 5\n{model}initial_conditions: {{design: {{monte_carlo: {{samples: 8}}}}}}\n\
         simulation: {{end_time_s: {AT_ONCE:e}}}\n{rest}"
    )
}

fn report(scratch: &Scratch, path: &str) -> Value {
    scratch.json(&format!("check {path} --json"))
}

/// Returns the report on a study `a.yaml` with a model and further lines.
fn checked(scratch: &Scratch, model: &str, rest: &str) -> Value {
    scratch.write("a.yaml", study(model, rest));
    report(scratch, "a.yaml")
}

/// Returns the part of the report with the warnings, without the program.
fn warned(study: &Study) -> Value {
    json!({"warnings": warnings(study)})
}

fn kinds(report: &Value) -> Vec<String> {
    let warnings = report["warnings"].as_array().unwrap();
    warnings.iter().map(|warning| warning["kind"].as_str().expect("a text").to_owned()).collect()
}

/// Changes of the machine, the kinds of all warnings, and key, line and remedy of the first one.
const SLIPS: &str = r" ¦  ¦  ¦ 0 ¦
ball_mass_kg: 1.4e-4 => ball_mass_kg: 0.14 ¦ ball_density ¦ model.parameters.ball_mass_kg ¦ 14 ¦ a steel ball of this diameter has 0.0001104 kg
ball_mass_kg: 1.4e-4 => ball_mass_kg: 1.0e-6 ¦ ball_density balancing_capacity balls_held_everywhere ¦ model.parameters.ball_mass_kg ¦ 14 ¦ a steel ball of this diameter has 0.0001104 kg
ball_diameter_m: 0.003 => ball_diameter_m: 3 ¦ ball_beyond_ring ball_density ¦ model.parameters.ball_diameter_m ¦ 15 ¦ lengths are in m, not in mm
balls: 2 => balls: 8 ; ball_mass_kg: 1.4e-4 => ball_mass_kg: 4.1e-3 ; ball_diameter_m: 0.003 => ball_diameter_m: 0.01 ¦ balls_do_not_fit ¦ model.parameters.ball_diameter_m ¦ 15 ¦ at most 6 such balls
coefficient: 2.75e-3 => coefficient: 3 ¦ friction_coefficient balls_held_everywhere ¦ model.parameters.friction_coefficient ¦ 16 ¦ 0, or a value from 1e-6 to 2; about 1e-4 to 1e-2 for a hard ball that rolls
coefficient: 2.75e-3 => coefficient: 1e-7 ¦ friction_coefficient ¦ model.parameters.friction_coefficient ¦ 16 ¦ 0, or a value
coefficient: 2.75e-3 => coefficient: 0 ¦  ¦  ¦ 0 ¦
speed_rad_s: -216.4 => speed_rad_s: 2.0e5 ¦ speed balls_held_everywhere ¦ model.parameters.speed_rad_s ¦ 17 ¦ at most 1e5 rad/s
speed_rad_s: -216.4 => speed_rad_s: -100 ¦ subcritical_speed ¦ model.parameters.speed_rad_s ¦ 17 ¦ a speed above the natural frequency, or a softer suspension; 1 rpm is 0.10472 rad/s
coefficient: 2.75e-3 => coefficient: 0.05 ¦ balls_held_everywhere ¦ model.parameters.friction_coefficient ¦ 16 ¦ friction_coefficient below 0.0
ball_diameter_m: 0.003 => ball_diameter: 60 mm ¦ ball_beyond_ring ball_density ¦ model.parameters.ball_diameter ¦ 15 ¦ ball_diameter below twice ring_radius_m
imbalance_mass_kg: 5.6e-5 => imbalance_mass_kg: 5.6e-4 ¦ balancing_capacity ¦ model.parameters.ball_mass_kg ¦ 14 ¦ more or heavier balls
balls: 2 => balls: [{mass_kg: 1.0e-4}] ¦ balancing_capacity balls_held_everywhere ¦ model.parameters.ball_mass_kg ¦ 14 ¦
balls: 2 => balls: 8 ; ball_mass_kg: 1.4e-4 => ball_mass_kg: 1.1e-4 ¦ overlapping_rests ¦ model.parameters.ball_diameter_m ¦ 15 ¦ fewer or smaller balls
balls: 2 => balls: [{}, {mass_kg: 0.2}, {mass_kg: 0.2}] ¦ ball_density ¦ model.parameters.balls[1].mass_kg ¦ 13 ¦ a steel ball
speed_rad_s: -216.4 => speed_rad_s: -216.4\n  contact: {restitution: 1} ¦ elastic_contact ¦ model.contact.restitution ¦ 18 ¦ a restitution below 1
speed_rad_s: -216.4 => speed_rad_s: -216.4\n  contact: {restitution: 0.99} ¦  ¦  ¦ 0 ¦
ring_radius_m: 0.0115 => ring_radius_m: 35 ¦ length balls_held_everywhere ¦ model.parameters.ring_radius_m ¦ 10 ¦ at most 2 m; lengths are in m, not in mm
imbalance_radius_m: 0.037 => imbalance_radius_m: 37 ¦ length balancing_capacity ¦ model.parameters.imbalance_radius_m ¦ 12 ¦ at most 2 m
stiffness_n_m: 10700 => stiffness_n_m: 60 ¦ soft_suspension balls_held_everywhere ¦ model.parameters.stiffness_n_m ¦ 8 ¦ not in N/mm, and masses are in kg, not in g
table_mass_kg: 0.324 => table_mass_kg: 3200 ¦ soft_suspension balls_held_everywhere ¦ model.parameters.stiffness_n_m ¦ 8 ¦ twice the radius of the ring
damping_n_s_m: 1.28 => damping_n_s_m: 40000 ¦ overdamped_suspension balls_held_everywhere ¦ model.parameters.damping_n_s_m ¦ 9 ¦ twice the critical damping
ball_diameter_m: 0.003 => ball_diameter_m: 0.005 ¦ ball_density ¦ model.parameters.ball_mass_kg ¦ 14 ¦ the mass of a ball of this diameter, with the mass in kg and the diameter in m; a steel ball of this diameter has 0.0005112 kg
# The ball of the template `machine` with another diameter.
ball_mass_kg: 1.4e-4 => ball_mass_kg: 0.88e-3 ; ball_diameter_m: 0.003 => ball_diameter_m: 0.0085 ¦ ball_density ¦ model.parameters.ball_mass_kg ¦ 14 ¦ the mass of a ball of this diameter
ball_mass_kg: 1.4e-4 => ball_mass_kg: 0.88e-3 ; ball_diameter_m: 0.003 => ball_diameter_m: 0.006 ¦  ¦  ¦ 0 ¦";

/// A model other than the machine, further lines, the kinds of all warnings, and the key of the first one.
const SLIPS_OF_STUDIES: &str = r" ¦ uncertain: {imbalance_mass_kg: {normal: {mean: 5.6e-5, std_dev: 1.0e-3}}}\n ¦ invalid_draws ¦ uncertain.imbalance_mass_kg
 ¦ sweep: [{grid: {speed: [1000 rpm, 1500 rpm]}}]\n ¦ subcritical_speed overridden_value ¦ sweep[0].grid.speed
 ¦ design: {stiffness_n_m: {from: 30000, to: 60000}}\nresponses: {half: median_time_to_rest}\n ¦ subcritical_speed ¦ model.parameters.speed_rad_s
 ¦ sweep: [{grid: {speed_rad_s: [-200, -216.4, -200]}}]\n ¦ repeated_point ¦ sweep[0]
# Two points with the same parameters but with other start states are two points.
 ¦ sweep:\n  - zip: {speed_rad_s: [-216.4]}\n  - zip: {speed_rad_s: [-216.4]}\n    design: {monte_carlo: {samples: 3}}\n ¦  ¦
 ¦ sweep:\n  - grid: {speed_rad_s: [-200, -216]}\n  - zip: {ball_mass_kg: [0.14]}\n ¦ ball_density ¦ sweep[1].zip.ball_mass_kg
 ¦ uncertain: {friction_coefficient: {uniform: {min: 1, max: 9}}}\n ¦ friction_coefficient balls_held_everywhere overridden_value ¦ uncertain.friction_coefficient
 ¦ design: {balls: {from: 1, to: 8}, ball_diameter_m: {from: 0.002, to: 0.012}}\nresponses: {half: median_time_to_rest}\n ¦ ball_density overlapping_rests designs_without_room ¦ design.ball_diameter_m
 ¦ sweep: [{grid: {ball_diameter_m: [0.003, 0.005]}}]\n ¦ ball_density ¦ sweep[0].grid.ball_diameter_m
model: {kind: ball_balancer, parameters: {table_mass_kg: 3, speed_rad_s: 628}}\n ¦  ¦ balls_held_everywhere mostly_defaults ¦ model.parameters.friction_coefficient
 ¦ sweep: [{grid: {speed_rad_s: [-200, -210]}}]\n ¦ overridden_value ¦ model.parameters.speed_rad_s
 ¦ sweep: [{zip: {balls: [3, 4]}}]\n ¦ overridden_value ¦ model.parameters.balls
model: {kind: ball_balancer, normal_force: newton}\n ¦ sweep: [{grid: {normal_force: [lagrange]}}]\n ¦ overridden_value ¦ model.normal_force
model: {kind: ball_balancer, protocol: startup}\n ¦  ¦ profile_beyond_end ¦ simulation.end_time_s
model: {kind: block_on_belt, parameters: {friction_coefficient: 5}}\n ¦  ¦ friction_coefficient ¦ model.parameters.friction_coefficient
model: {kind: block_on_belt, parameters: {belt_speed_m_s: 5000}}\n ¦  ¦ speed ¦ model.parameters.belt_speed_m_s
model: {system: {system: a, motions: {g: {table: {columns: [time_s, g], rows: [[0, 0], [900, 1]]}}}, coordinates: {x: {start: [0, 1]}}, mass: {x: {x: 1}}, force: {x: -x - x' + g}}}\n ¦  ¦ motion_beyond_end ¦ simulation.end_time_s";

/// Each slip gives its own warnings and no others, with the key and its line.
#[test]
fn slips_are_warnings_with_their_key_and_line() {
    for [changes, expected, key, line, remedy] in cases(SLIPS) {
        let changes: Vec<_> =
            changes.split(" ; ").filter_map(|change| change.split_once(" => ")).collect();
        let model = changes.iter().fold(MACHINE.to_owned(), |model, (from, to)| {
            assert!(model.contains(from), "{from}");
            model.replace(from, to)
        });
        let report = warned(&parse(study(&model, "")));
        assert_eq!(kinds(&report).join(" "), expected, "{changes:?}");
        let first = &report["warnings"][0];
        if !expected.is_empty() {
            let found = format!("{} {}", first["key"], first["line"]);
            assert_eq!(found, format!("{key:?} {line}"), "{changes:?}");
            assert_has(first["remedy"].as_str().expect("a remedy"), &[remedy]);
        }
    }
    for [model, rest, expected, key] in cases(SLIPS_OF_STUDIES) {
        let report = warned(&parse(study(if model.is_empty() { MACHINE } else { &model }, &rest)));
        assert_eq!(kinds(&report).join(" "), expected, "{rest}");
        let first = &report["warnings"][0];
        assert_eq!(first["key"].as_str().unwrap_or_default(), key, "{rest}");
        assert_eq!(first["line"].is_u64(), !expected.is_empty(), "{rest}");
    }
}

/// Values at the limits of the numbers neither stop the command nor keep it busy.
#[test]
fn extreme_values_have_closed_forms() {
    let scratch = Scratch::new();
    for (from, to) in [
        ("speed_rad_s: -216.4", "speed_rad_s: 1.0e-160"),
        ("speed_rad_s: -216.4", "speed_rad_s: 0"),
        ("speed_rad_s: -216.4", "speed_rad_s: 1.0e300"),
        ("friction_coefficient: 2.75e-3", "friction_coefficient: 1.0e300"),
        ("ball_diameter_m: 0.003", "ball_diameter_m: 1.0e-300"),
        ("ball_diameter_m: 0.003", "ball_diameter_m: 1.0e300"),
        ("ball_mass_kg: 1.4e-4", "ball_mass_kg: 1.0e300"),
        ("imbalance_mass_kg: 5.6e-5", "imbalance_mass_kg: 1.0e-300"),
        ("stiffness_n_m: 10700", "stiffness_n_m: 1.0e300"),
        ("table_mass_kg: 0.324", "table_mass_kg: 1.0e300"),
        ("damping_n_s_m: 1.28", "damping_n_s_m: 0"),
    ] {
        let report = checked(&scratch, &MACHINE.replace(from, to), "");
        assert_eq!(report["closed_form"]["points_examined"], json!(1), "{to}");
        scratch.well("check a.yaml");
    }
    let impossible = "uncertain: {ball_mass_kg: {normal: {mean: -1.0, std_dev: 1.0e-3}}}\n";
    let report = checked(&scratch, MACHINE, impossible);
    assert_eq!(
        (kinds(&report), &report["closed_form"]["points"]),
        (vec!["overridden_value".into(), "invalid_draws".into()], &json!([]))
    );
    scratch.prints("check a.yaml", &["at 0 of 1 points"]);
}

/// The remedy names units only to a study that writes none.
#[test]
fn a_remedy_repeats_no_unit_of_the_study() {
    let remedy = |model: &str, rest: &str| warnings(&parse(study(model, rest)))[0].remedy.clone();
    for (from, to) in [
        ("ball_diameter_m: 0.003", "ball_diameter: 60 mm"),
        ("speed_rad_s: -216.4", "speed: 100 rpm"),
        ("speed_rad_s: -216.4", "speed: 3000000 rpm"),
    ] {
        let remedy = remedy(&MACHINE.replace(from, to), "");
        assert!(!remedy.contains("not in mm") && !remedy.contains("1 rpm"), "{remedy}");
    }
    assert!(remedy(MACHINE, "sweep: [{grid: {speed_rad_s: [100]}}]\n").contains("1 rpm"));
}

/// A study with variables describes a machine of the search, and examines the ends of the ranges.
#[test]
fn a_search_describes_a_machine_within_its_ranges() {
    let scratch = Scratch::new();
    let search = |speed: &str, compare: &str| {
        let rest = format!(
            "design:\n  stiffness_n_m: {{from: 60000, to: 90000}}\n  speed_rad_s: {speed}\n  \
             ring: {{choices: {{steel: {{friction_coefficient: 1e-3}}, rubber: {{friction_coefficient: 2e-3}}}}}}\n\
             responses: {{quiet: {{at_rest_by_s: 1.0e-6}}}}\noptimize: {{maximize: quiet, designs: 20{compare}}}\n"
        );
        checked(&scratch, MACHINE, &rest)
    };
    let all = search("{from: -309, to: -300}", "");
    assert_eq!(kinds(&all), ["subcritical_speed"]);
    let warning = &all["warnings"][0];
    assert_eq!(warning["key"], json!("design.speed_rad_s"));
    assert_has(warning["problem"].as_str().unwrap(), &["the disc of all designs is slower"]);
    let found = warning["found"].as_str().unwrap();
    assert_has(found, &["at most 0.718 times", "with stiffness_n_m 60000, speed_rad_s -309"]);
    assert_eq!(
        all["closed_form"]["design"],
        json!({"stiffness_n_m": 75000.0, "speed_rad_s": -304.5, "ring": "steel"})
    );
    let ratio = all["closed_form"]["points"][0]["speed_over_natural_frequency"].as_f64().unwrap();
    assert!((ratio - 0.633).abs() < 1e-3, "{ratio}");
    let said = [
        "natural frequency 480.",
        "the design is the middle of the ranges (stiffness_n_m 75000, speed_rad_s -304.5, ring steel)\n",
    ];
    scratch.prints("check a.yaml", &said);
    let compare = ", compare_with: {stiffness_n_m: 60000, speed_rad_s: -600, ring: rubber}";
    let some = search("{from: -600, to: -500}", compare);
    let warning = &some["warnings"][0];
    assert_has(warning["problem"].as_str().unwrap(), &["the disc of some designs is slower"]);
    assert_has(
        warning["found"].as_str().unwrap(),
        &["0.949 times the natural frequency with stiffness_n_m 90000, speed_rad_s -500; 1.39"],
    );
    scratch.prints("check a.yaml", &["the design is optimize.compare_with ("]);
    assert!(
        !kinds(&search("{from: -700, to: -600}", "")).contains(&"subcritical_speed".to_owned())
    );
}

/// Friction that holds the balls everywhere is a warning if it does so at all points and for all examined designs.
#[test]
fn friction_that_holds_the_balls_everywhere_is_a_warning() {
    let kind = "balls_held_everywhere".to_owned();
    let machine = MACHINE.replace("    friction_coefficient: 2.75e-3\n", "");
    let text = study(&machine, "sweep: [{grid: {friction_coefficient: [0.05, 0.06]}}]\n");
    let scratch = Scratch::with(text);
    let all = report(&scratch, "a.yaml");
    assert_eq!(kinds(&all), [kind.as_str()]);
    assert_has(
        all["warnings"][0]["found"].as_str().unwrap(),
        &["0.05 to 0.06, where", "at all 2 points"],
    );
    scratch
        .prints("check a.yaml", &["at 2 of 2 points friction holds the balls in every position"]);
    scratch.write(
        "a.yaml",
        study(&machine, "sweep: [{grid: {friction_coefficient: [0.05, 1.0e-3]}}]\n"),
    );
    assert!(kinds(&report(&scratch, "a.yaml")).is_empty());
    let search = |to: &str| {
        let design = format!(
            "design: {{friction_coefficient: {{from: 0.05, to: {to}}}}}\n\
             responses: {{half: median_time_to_rest}}\n"
        );
        kinds(&checked(&scratch, MACHINE, &design))
    };
    assert_eq!(search("0.06"), [kind]);
}

/// The friction coefficients of the remedy are below that of the study, and hold the balls in fewer positions, as it says.
#[test]
fn the_remedy_for_friction_that_holds_the_balls_everywhere_helps() {
    let scratch = Scratch::new();
    let of = |friction: f64| {
        study(&MACHINE.replace("coefficient: 2.75e-3", &format!("coefficient: {friction:e}")), "")
    };
    let with = |friction: f64| {
        scratch.write("a.yaml", of(friction));
        report(&scratch, "a.yaml")
    };
    let is_held = |friction: f64| kinds(&warned(&parse(of(friction)))) == ["balls_held_everywhere"];
    // The smallest friction with a warning leaves a few positions without rest.
    let just = (0..).map(|step| 2.75e-3 * 1.01_f64.powi(step)).find(|friction| is_held(*friction));
    for friction in [just.unwrap(), 0.05, 1.9] {
        let warned = with(friction);
        let remedy = warned["warnings"][0]["remedy"].as_str().unwrap();
        let after = |words: &str| -> f64 {
            let (_, rest) = remedy.split_once(words).unwrap();
            rest.split([',', ' ', ';']).next().unwrap().parse().unwrap()
        };
        let (all, half) = (after("friction_coefficient below "), after("and below "));
        assert!(half < all && all < friction, "{friction}: {remedy}");
        assert!(!is_held(all), "{remedy}");
        let held = &with(half)["closed_form"]["points"][0]["rest"]["set_fraction"];
        assert!((0.3..=0.5).contains(&held.as_f64().unwrap()), "{remedy}: {held}");
    }
}

/// The model leaves gravity out; the last line says how much it would do on a horizontal axis.
#[test]
fn gravity_on_a_horizontal_axis_is_named() {
    let model = "model: {kind: ball_balancer, parameters: {ring_radius: 35 mm, friction_coefficient: 0.001, \
                 speed: 10000 rpm}}\n";
    let scratch = Scratch::with(study(model, ""));
    let text = "the axis is vertical: the model leaves gravity out. On a horizontal axis, gravity is 25.55 % of the \
                friction\nμ ω² R that holds a ball, and no ball stays at rest below sqrt(g/(μ R)) = 5055 rpm\n";
    scratch.prints("check a.yaml", &[text]);
    let sweep = "sweep: [{grid: {friction_coefficient: [1.0e-3, 2.75e-3]}}]\n";
    let static_friction =
        "friction: {stribeck: {static_friction_coefficient: 2.0e-3, stribeck_speed_rad_s: 1}}";
    scratch.write("b.yaml", study(MACHINE, sweep));
    scratch.prints("check b.yaml", &["holds a ball at point 0, and no ball stays"]);
    let ratios: Vec<f64> = ["", static_friction]
        .iter()
        .map(|friction| {
            let machine = model.replace("ball_balancer,", &format!("ball_balancer, {friction},"));
            scratch.write("c.yaml", study(&machine.replace(", ,", ","), ""));
            let point = &report(&scratch, "c.yaml")["closed_form"]["points"][0];
            point["gravity_over_friction"].as_f64().unwrap()
        })
        .collect();
    assert!((ratios[0] / ratios[1] - 2.0).abs() < 1e-12, "{ratios:?}");
    let viscous =
        MACHINE.to_owned() + "  friction: {viscous: {viscous_coefficient_n_s_m: 5.0e-4}}\n";
    scratch.write("d.yaml", study(&viscous, ""));
    scratch.prints("check d.yaml", &["the axis is vertical: the model leaves gravity out\n"]);
}

/// Warnings go to standard error; `--strict` makes them an exit code, and `run` repeats them.
#[test]
fn warnings_change_the_exit_code_only_with_strict() {
    let scratch = Scratch::new();
    scratch.write("good.yaml", study(MACHINE, ""));
    scratch.write("bad.yaml", study(&MACHINE.replace("1.4e-4", "0.14"), ""));
    let warning =
        "warning: bad.yaml:14:19: `model.parameters.ball_mass_kg`: no material has the density";
    for (arguments, code) in [
        ("check bad.yaml", 0),
        ("check bad.yaml --strict", 2),
        ("check bad.yaml --strict --json", 2),
    ] {
        let ended = scratch.ended(arguments, code);
        assert_has(
            &ended.err,
            &[warning, "\n  found:  a ball of 0.14 kg", "\n  remedy: 500 to 25000"],
        );
        assert_eq!(ended.err.contains("error: 1 warning, which --strict"), code == 2);
        assert!(!ended.out.is_empty() && !ended.out.contains("warning: "));
    }
    let good = scratch.stickslip("check good.yaml --strict");
    assert_eq!((good.code, good.err.as_str()), (Some(0), ""));
    let ran = scratch.stickslip("run bad.yaml --out out");
    assert_eq!((ran.code, ran.err.matches(warning).count()), (Some(0), 1), "{}", ran.err);
    let quiet = scratch.stickslip("run bad.yaml --out quiet --quiet");
    assert_eq!((quiet.code, quiet.err.as_str()), (Some(0), ""));
}

/// Shipped studies have only the warnings that their comments explain.
#[test]
fn shipped_studies_have_no_false_warnings() {
    let mut studies = 0;
    for path in study_files("studies") {
        studies += 1;
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let expected: &[&str] = match name.as_str() {
            // A machine that cannot be built shows where the model fails.
            "no-unique-solution" => {
                &["ball_density", "friction_coefficient", "subcritical_speed", "mostly_defaults"]
            }
            // These studies are about balls below the natural frequency, too.
            "model-form" | "smooth-friction" | "design" => &["subcritical_speed"],
            // These two studies are about motions that friction allows besides rests everywhere.
            "cycles" | "side-by-side" => &["balls_held_everywhere"],
            // One of its numbers of balls is too small to balance the disc.
            "number-of-balls" => &["balancing_capacity"],
            _ => &[],
        };
        let study = Study::load(&path).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(kinds(&warned(&study)), expected, "{name}");
    }
    assert!(studies > 20);
}

/// The machine is printed with units and the origin of each value.
#[test]
fn the_machine_has_its_defaults_marked() {
    let model = "model: {kind: ball_balancer, parameters: {table_mass_kg: 0.5, balls: [{}, {mass_kg: 2.0e-4}]}}\n";
    let rest = "sweep: [{grid: {speed_rad_s: [-160, -216]}}]\n\
                uncertain:\n  stiffness_n_m: {times: {uniform: {min: 0.9, max: 1.1}}}\n  \
                imbalance_mass_kg: {uniform: {min: 4.0e-5, max: 6.0e-5}}\n\
                design: {ring_radius_m: {from: 0.0095, to: 0.0135}}\nresponses: {half: median_time_to_rest}\n";
    let scratch = Scratch::with(study(model, rest));
    let text = scratch.well("check a.yaml");
    let lines: Vec<String> =
        text.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    for line in [
        "table_mass_kg 0.5 kg",
        "stiffness_n_m 10700 N/m (default); uncertain, times 0.905 to 1.095 in 95 % of the runs",
        "damping_n_s_m 1.28 N s/m (default)",
        "ring_radius_m 0.0095 to 0.0135 m design",
        "imbalance_mass_kg 5e-5 kg uncertain, median; 4.05e-5 to 5.95e-5 in 95 % of the runs",
        "balls 2",
        "ball_mass_kg 0.00014 kg (default)",
        "ball_mass_2_kg 0.0002 kg",
        "friction coulomb (default)",
        "speed_rad_s -216 to -160 rad/s swept, 2 values",
        "normal_force lagrange (default)",
    ] {
        assert!(lines.iter().any(|found| found == line), "no {line:?} in\n{text}");
    }
    let report = report(&scratch, "a.yaml");
    let entry = |name: &str| {
        let machine = report["machine"].as_array().unwrap();
        machine.iter().find(|row| row["name"] == json!(name)).expect("a row of this name").clone()
    };
    assert_eq!(
        entry("table_mass_kg"),
        json!({"name": "table_mass_kg", "value": 0.5, "unit": "kg", "default": false})
    );
    assert_eq!(entry("damping_n_s_m")["default"], json!(true));
    assert_eq!(entry("speed_rad_s")["swept"], json!({"values": 2, "from": -216.0, "to": -160.0}));
    assert_eq!(entry("ring_radius_m")["design"], json!({"from": 0.0095, "to": 0.0135}));
    assert_eq!(entry("stiffness_n_m")["uncertain"]["factor"], json!(true));
}

/// A parameter that only one block sweeps has its base value in the others.
#[test]
fn the_base_value_of_a_swept_parameter_counts_where_a_block_uses_it() {
    let sweep = "sweep:\n  - grid: {speed_rad_s: [-200, -216.4]}\n  \
                 - zip: {friction_coefficient: [1.0e-3, 2.0e-3]}\n";
    let scratch = Scratch::with(study(MACHINE, sweep));
    let report = report(&scratch, "a.yaml");
    let swept = |name: &str| {
        let machine = report["machine"].as_array().unwrap();
        machine.iter().find(|row| row["name"] == json!(name)).expect("a row of this name")["swept"]
            .clone()
    };
    assert_eq!(swept("friction_coefficient"), json!({"values": 3, "from": 1.0e-3, "to": 2.75e-3}));
    assert_eq!(swept("speed_rad_s"), json!({"values": 2, "from": -216.4, "to": -200.0}));
}

/// The closed forms are those of the machine that is drawn, not of the default of an uncertain parameter.
#[test]
fn closed_forms_are_those_of_the_machine_that_is_drawn() {
    let scratch = Scratch::with(study("model: {kind: ball_balancer}\n", ""));
    let uncertain =
        "uncertain: {friction_coefficient: {lognormal: {mean: 5.0e-4, std_dev: 3.0e-4}}}\n";
    scratch.write("b.yaml", study("model: {kind: ball_balancer}\n", uncertain));
    let plain = &report(&scratch, "a.yaml")["closed_form"];
    assert_eq!(
        (&plain["points_examined"], &plain["uncertain_at_medians"]),
        (&json!(1), &json!(false))
    );
    let point = &plain["points"][0];
    assert_eq!((&point["point_id"], &point["balance"]), (&json!(0), &json!("position")));
    assert_eq!(point["balance_stability"], json!("stable"));
    let number = |value: &Value| value.as_f64().unwrap();
    assert!((number(&point["capacity_g_mm"]) - 3.22).abs() < 1e-9);
    assert!((number(&point["imbalance_g_mm"]) - 2.072).abs() < 1e-9);
    assert!((number(&point["speed_over_natural_frequency"]) - 1.1913).abs() < 1e-3);
    assert!((number(&point["rest"]["set_fraction"]) - 0.77).abs() < 0.01);
    assert!(point.get("rest_at_low_friction").is_none());
    let drawn = &report(&scratch, "b.yaml")["closed_form"];
    assert_eq!(drawn["uncertain_at_medians"], json!(true));
    let of = |key: &str| number(&drawn["points"][0][key]["set_fraction"]);
    let [low, median, high] = ["rest_at_low_friction", "rest", "rest_at_high_friction"].map(of);
    assert!(low < median && median < high && median < 0.2, "{low} {median} {high}");
    let said = [
        "without simulation, with uncertain parameters at their medians\n",
        " .. ",
        "(a .. b): the values at the quantiles 2.5 % (a) and 97.5 % (b) of uncertain friction\n",
    ];
    scratch.prints("check b.yaml", &said);
    let text = scratch.prints(
        "check a.yaml",
        &[
            "times that without balls; balls that keep moving can make it larger\n",
            "overlap",
            "  stable\n",
        ],
    );
    assert!(!text.contains("(a .. b)"), "{text}");
}

/// `check` and `equilibria` give the same set and the same worst rest of the machine that is drawn, with balls that
/// cannot overlap.
#[test]
fn the_worst_rest_is_that_of_equilibria() {
    let rest = "sweep: [{grid: {speed_rad_s: [-216.3772, -179.2671], friction_coefficient: [2.75e-4]}}]\n\
                uncertain: {imbalance_mass: {uniform: {min: 0.03 g, max: 0.09 g}}}\n";
    let machine =
        "model: {kind: ball_balancer, contact: {restitution: 0.36, friction_coefficient: 0.1}}\n";
    let scratch = Scratch::with(study(machine, rest));
    let checked = &report(&scratch, "a.yaml")["closed_form"]["points"];
    let sets = scratch.json("equilibria a.yaml --no-set --out out --json");
    for point in 0..2 {
        let (checked, set) = (&checked[point], &sets["points"][point]);
        assert_eq!(checked["rest"]["set_fraction"], set["fraction"], "{point}");
        assert_eq!(checked["rest"]["max_amplitude_m"], set["amplitude_max_m"], "{point}");
        assert!(set["amplitude_max_m"].as_f64() > Some(1e-5), "{set}");
    }
    let without =
        numbers(&scratch.table("out", "equilibrium_set_summary"), "amplitude_without_balls_m");
    let found = [0, 1].map(|point| checked[point]["amplitude_without_balls_m"].as_f64());
    assert_eq!(without, found);
}

/// At most 20 points are printed, and JSON has more.
#[test]
fn large_sweeps_are_shown_in_part() {
    let speeds: Vec<String> = (0..60).map(|k| format!("{}", -190 - k)).collect();
    let sweep = format!("sweep: [{{grid: {{speed_rad_s: [{}]}}}}]\n", speeds.join(", "));
    let scratch = Scratch::with(study(MACHINE, &sweep));
    let text = scratch.prints("check a.yaml", &["without simulation, at 20 of 60 points\n"]);
    assert_eq!(text.matches("  stable\n").count(), 20, "{text}");
    assert_eq!(report(&scratch, "a.yaml")["closed_form"]["points"].as_array().unwrap().len(), 60);
}

/// The natural frequency is that of the medians at the points, and the speed of a profile is no default.
#[test]
fn the_machine_is_that_of_the_runs() {
    let model = "model: {kind: ball_balancer, speed_profile: [{ramp: {from_rad_s: -31, to_rad_s: -200, over_s: 2}}]}\n";
    let rest = "sweep: [{grid: {table_mass_kg: [0.324, 0.4]}}]\n\
                uncertain: {stiffness_n_m: {uniform: {min: 8000, max: 9000}}}\n";
    let scratch = Scratch::with(study(model, rest));
    let text = scratch.prints("check a.yaml", &["natural frequency 145.7", " to 161.887 rad/s\n"]);
    let speed = text.lines().find(|line| line.contains(" speed_rad_s ")).expect("a row");
    assert!(speed.trim_end().ends_with("-200 rad/s"), "{speed}");
}

/// A study of designs has the cost of one design, and a search its goal, size and cost.
#[test]
fn designs_and_searches_have_a_price() {
    let scratch = Scratch::new();
    let path = shipped("cd-rom.yaml").display().to_string();
    let search = report(&scratch, &path);
    let [design, all] = ["design_cost", "optimize"].map(|key| &search[key]);
    assert_eq!(design["runs"], json!(384));
    for (key, value) in [
        ("objectives", json!([{"response": "vibration_95", "goal": "minimize"}])),
        ("limits", json!([{"response": "quiet", "at_least": 0.9}])),
        ("over_points", json!("worst")),
        ("variables", json!(6)),
        ("designs", json!(150)),
        ("start_designs", json!(60)),
        ("search_runs", json!(150 * 384)),
        ("final_runs", json!(7 * 16 * 384)),
        ("sensitivity_runs", json!(0)),
        ("runs", json!(262 * 384)),
    ] {
        assert_eq!(all[key], value, "{key}");
    }
    let seconds = |cost: &Value, key: &str| cost[key].as_f64().unwrap();
    for key in ["core_seconds", "most_core_seconds"] {
        let ratio = seconds(all, key) / seconds(design, key);
        assert!((ratio - 262.0).abs() < 1e-6, "{key}: {ratio}");
    }
    assert!(seconds(design, "most_core_seconds") > seconds(design, "core_seconds"));
    let said = [
        "optimize      minimize vibration_95, subject to quiet at least 0.9; worst of 3 points\n",
        "search        6 variables, 150 designs (60 of them space-filling), 5 finalists",
        "search cost   100608 runs at most; about ",
        "one design    384 runs; about ",
        "the design is optimize.compare_with (balls 2, ball ",
    ];
    scratch.prints(&format!("check {path}"), &said);
    let designs = report(&scratch, &shipped("design.yaml").display().to_string());
    assert_eq!(designs["design_cost"]["runs"], json!(64));
    assert!(designs.get("optimize").is_none());
    scratch.write("a.yaml", study_text("a", "{sobol: {samples: 1}}", AT_ONCE, ""));
    assert!(report(&scratch, "a.yaml").get("design_cost").is_none());
    let path = shipped("identify-contact.yaml").display().to_string();
    let inference = report(&scratch, &path);
    let ratio =
        seconds(&inference["identify"], "core_seconds") / seconds(&inference, "core_seconds");
    assert!((ratio - 1000.0).abs() < 1e-6, "{ratio}");
    let said = ["identify      1000 parameter sets, 640000 runs; about "];
    scratch.prints(&format!("check {path}"), &said);
}

#[test]
fn the_run_up_is_that_of_the_point_at_which_balls_slip_longest() {
    let of = |sweep: &str| {
        let model = "model: {kind: ball_balancer, speed_profile: [{ramp: {from_rad_s: -31, over_s: 2}}, {hold_s: 1}]}\n";
        let study = "schema: 1\nname: a\nseed: 5\n".to_owned() + model + sweep;
        study + "initial_conditions: {design: {monte_carlo: {samples: 2}}}\n"
    };
    let scratch =
        Scratch::with(of("sweep: [{grid: {speed_rad_s: [-100, -200], ramp_over_1_s: [4, 1]}}]\n"));
    let said = ["-31 to -100 rad/s from 0 to 4 s", "(point 0, where they slip longest)"];
    scratch.prints("check a.yaml", &said);
    let run_up = &report(&scratch, "a.yaml")["run_up"];
    assert_eq!((&run_up[0]["point_id"], &run_up[0]["speed_rad_s"][1]), (&json!(0), &json!(-100.0)));
    scratch.write("b.yaml", of("sweep: [{grid: {imbalance_mass_kg: [5.0e-5, 6.0e-5]}}]\n"));
    assert!(!scratch.well("check b.yaml").contains("slip longest"));
    assert_eq!(report(&scratch, "b.yaml")["run_up"][0]["point_id"], Value::Null);
}
