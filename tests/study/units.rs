//! Values with units: the same study as with SI keys, to the last bit, and errors that name key, unit and remedy.

use std::path::Path;

use stickslip::study::{ParameterValue, Study, VariedParameter};

use super::{machine_at, parse, refused, same_runs, study, swept_numbers};
use crate::support::{assert_has, cases};

/// Returns a study of a balancer with these parameters, in line 6, and further lines from line 7 on.
fn text(parameters: &str, rest: &str) -> String {
    let end = match rest.contains("initial_conditions") {
        true => "",
        false => "initial_conditions: {design: {monte_carlo: {samples: 4}}}\n",
    };
    format!(
        "schema: 1\nname: a\nseed: 5\nmodel:\n  kind: ball_balancer\n  \
         parameters: {{{parameters}}}\n{rest}{end}"
    )
}

#[track_caller]
fn same(with_units: &str, si: &str) {
    let [with_units, si] = [with_units, si].map(study);
    // The last key names the units that the study writes.
    let without_units =
        |study: &Study| study.resolved_yaml().split("\nunits:").next().unwrap().to_owned();
    let [resolved, expected] = [&with_units, &si].map(without_units);
    assert_eq!(resolved.trim_end(), expected.trim_end());
    assert_eq!(with_units.hash(), si.hash());
    same_runs(&with_units, &si);
}

fn stiffness(written: &str) -> f64 {
    machine_at(&study(&text(&format!("stiffness: {written}"), "")), 0).stiffness_n_m
}

/// A decimal value with a decimal unit is the nearest double, as if the SI value were written.
#[test]
fn decimal_units_are_exact() {
    let diameter = |written: &str| {
        let machine = machine_at(&study(&text(&format!("ball_diameter: {written}"), "")), 0);
        machine.balls[0].diameter_m
    };
    for digits in ["6", "6.0", "0.1", "1.1", "56", "0.14", "7", "2.9", "123456.789", "3e-1"] {
        let micro = ["µm", "um", "μm"].map(|unit| (unit, -6));
        let others = [("mm", -3), ("cm", -2), ("nm", -9), ("m", 0), ("km", 3)];
        for (unit, tens) in micro.into_iter().chain(others) {
            let (mantissa, exponent) = digits.split_once('e').unwrap_or((digits, "0"));
            let exponent = exponent.parse::<i32>().unwrap() + tens;
            let expected: f64 = format!("{mantissa}e{exponent}").parse().unwrap();
            assert_eq!(diameter(&format!("{digits} {unit}")), expected, "{digits} {unit}");
        }
    }
    assert_eq!(diameter("6mm"), 6.0e-3);
    let many = "0.1234567890123456789012345678901234567890123456789";
    assert!((diameter(&format!("{many} mm")) / 1.2345678901234568e-4 - 1.0).abs() < 3e-16);
    assert_eq!(diameter("0.25 in"), 6.35e-3);
    let mass = |written: &str| {
        machine_at(&study(&text(&format!("imbalance_mass: {written}"), "")), 0).imbalance_mass_kg
    };
    assert_eq!((mass("56 mg"), mass("5 µg"), mass("56e3 ug")), (5.6e-5, 5.0e-9, 5.6e-5));
    let [a, b, c] = ["10.7 N/mm", "10.7 kN/m", "10700 kg/s^2"].map(stiffness);
    assert_eq!([a, b, c], [1.07e4; 3]);
    assert_eq!(stiffness("10700 N·m⁻¹".replace("m⁻¹", "m^-1").as_str()), 1.07e4);
    let damping = |written: &str| {
        machine_at(&study(&text(&format!("damping: {written}"), "")), 0).damping_n_s_m
    };
    assert_eq!(["40 N s/m", "40 N*s/m", "40 kg/s", "0.04 N s/mm"].map(damping), [40.0; 4]);
}

#[test]
fn speeds_of_rotation() {
    let speed =
        |written: &str| machine_at(&study(&text(&format!("speed: {written}"), "")), 0).speed_rad_s;
    let exact = 200.0 * std::f64::consts::PI;
    for written in ["6000 rpm", "6000 rev/min", "100 rev/s", "36000 deg/s", "36000 °/s"] {
        assert!((speed(written) / exact - 1.0).abs() < 5.0e-16, "{written}: {}", speed(written));
    }
    assert_eq!(speed("-216.3772 rad/s"), -216.3772);
}

/// Keys without units are allowed wherever SI keys are, and give the same study.
#[test]
fn every_place_accepts_units() {
    let short = text(
        "table_mass: 324 g, balls: [{mass: 0.14 g, diameter: 3 mm}, {}], imbalance_radius: 37 mm",
        "sweep:\n  - grid: {speed: [-150 rad/s, -200 rad/s], ball_mass_2: [0.1 g, 0.2 g]}\n  \
         - zip: {speed: [-210 rad/s], damping: [1.3 N s/m]}\n\
         uncertain:\n  imbalance_mass: {normal: {mean: 56 mg, std_dev: 5 mg}}\n  \
         ring_radius: {choice: {values: [11 mm, 12 mm], weights: [1, 3]}}\n  \
         stiffness: {times: {uniform: {min: 0.9, max: 1.1}}}\n\
         simulation: {end_time: 0.25 min}\n\
         expect: [{point: {speed: -210 rad/s}, equilibrium_fraction: [0, 1]}]\n\
         design: {table_mass: {from: 300 g, to: 350 g}, ball: {choices: {small: \
         {ball_diameter_1: 2 mm}, large: {ball_diameter_1: 4 mm}}}}\n\
         responses: {early: {at_rest_by: 2 s}}\n\
         optimize: {maximize: early, compare_with: {table_mass: 320 g, ball: small}}\n",
    );
    let si = text(
        "table_mass_kg: 0.324, balls: [{mass_kg: 1.4e-4, diameter_m: 3e-3}, {}], \
         imbalance_radius_m: 0.037",
        "sweep:\n  - grid: {speed_rad_s: [-150, -200], ball_mass_2_kg: [1e-4, 2e-4]}\n  \
         - zip: {speed_rad_s: [-210], damping_n_s_m: [1.3]}\n\
         uncertain:\n  imbalance_mass_kg: {normal: {mean: 56e-6, std_dev: 5e-6}}\n  \
         ring_radius_m: {choice: {values: [0.011, 0.012], weights: [1, 3]}}\n  \
         stiffness_n_m: {times: {uniform: {min: 0.9, max: 1.1}}}\n\
         simulation: {end_time_s: 15}\n\
         expect: [{point: {speed_rad_s: -210}, equilibrium_fraction: [0, 1]}]\n\
         design: {table_mass_kg: {from: 0.3, to: 0.35}, ball: {choices: {small: \
         {ball_diameter_1_m: 2e-3}, large: {ball_diameter_1_m: 4e-3}}}}\n\
         responses: {early: {at_rest_by_s: 2}}\n\
         optimize: {maximize: early, compare_with: {table_mass_kg: 0.32, ball: small}}\n",
    );
    same(&short, &si);
    let block = |key: &str, sweep: &str, friction: &str, place: &str| {
        format!(
            "schema: 1\nname: a\nseed: 1\nmodel: {{kind: block_on_spring, parameters: {{{key}}}, \
             friction: {friction}}}\nsweep: [{{grid: {{{sweep}}}}}]\n\
             initial_conditions: {{box: {{{place}}}, design: {{monte_carlo: {{samples: 2}}}}}}\n"
        )
    };
    same(
        &block(
            "mass: 2 kg, normal_force: 0.02 kN",
            "normal_force: [5 N, 6 N], stribeck_speed: [1 mm/s]",
            "{stribeck: {static_friction_coefficient: 0.3, stribeck_speed: 2 cm/s}}",
            "position: [-1 cm, 10 mm], velocity: [0 m/s, 1 m/s]",
        ),
        &block(
            "mass_kg: 2, normal_force_n: 20",
            "normal_force_n: [5, 6], stribeck_speed_m_s: [1e-3]",
            "{stribeck: {static_friction_coefficient: 0.3, stribeck_speed_m_s: 0.02}}",
            "position_m: [-0.01, 0.01], velocity_m_s: [0, 1]",
        ),
    );
}

#[test]
fn a_choice_may_have_the_name_of_a_parameter_without_its_unit() {
    let rest = "design: {speed: {choices: {slow: {speed_rad_s: 100}, fast: {speed: 3000 rpm}}}}\n\
                responses: {early: {at_rest_by: 2 s}}\n\
                optimize: {maximize: early, compare_with: {speed: slow}}\n";
    let study = study(&text("", rest));
    assert_eq!(study.variables()[0].name(), "speed");
}

/// A parameter, the end of its key, what the message found, and what it allows.
const WRONG_PARAMETERS: &str = r#"speed: 6 mm ¦ speed ¦ "6 mm", a length ¦ ROTATION
speed: 100 1/s ¦ speed ¦ 1 ¦ ROTATION
speed: 100 s^-1 ¦ speed ¦ 100 s^-1 ¦ ROTATION
speed: 6000 ¦ speed ¦ 6000 ¦ `speed_rad_s` for a number in rad/s, or a speed of rot
speed: "6000" ¦ speed ¦ 6000 ¦ `speed_rad_s` for a number in rad/s
speed: fast ¦ speed ¦ fast ¦ ROTATION
speed: 6000 RPM ¦ speed ¦ RPM ¦ 6000 rpm; the units are rpm (did you mean this?), rad/s
speed: 100 Hz ¦ speed ¦ Hz ¦ the units are rev/s (did you mean this?), rpm
speed: 6000 rmp ¦ speed ¦ rmp ¦ ROTATION
speed_rad_s: 6000 rpm ¦ speed_rad_s ¦ 6000 rpm ¦ a number in rad/s, or `speed`
speeed: 1 rpm ¦ speeed ¦ speeed ¦ speed (did you mean this?), speed_rad_s
damping: 3 Ns/m ¦ damping ¦ Ns ¦ the units are N s/m (did you mean this?), N s/mm
damping: ¦ damping ¦ nothing ¦ a viscous damping, such as 1.28 N s/m
damping_n_s_m: null ¦ damping_n_s_m ¦ nothing ¦ or `damping` with a viscous damping
damping: 3 N s/m s ¦ damping ¦ N s/m s ¦ a quotient `N/m`
damping: 3 N s//m ¦ damping ¦ N s//m ¦ a quotient `N/m`
damping: 1e400 N s/m ¦ damping ¦ 1e400 ¦ a finite number
damping: 1e99999999999 N s/m ¦ damping ¦ 1e99999999999 ¦ a finite number
ball_mass: 3 KG ¦ ball_mass ¦ KG ¦ the units are kg (did you mean this?), g, mg
ball_mass: "6,5 g" ¦ ball_mass ¦ 6,5 g ¦ a decimal point, as in 6.5 g
ball_mass: "1,000 g" ¦ ball_mass ¦ 1,000 g ¦ no comma between digits
ball_mass_kg: "6,5" ¦ ball_mass_kg ¦ 6,5 ¦ a decimal point, as in 6.5
ball_mass: 3 N ¦ ball_mass ¦ 3 N ¦ a mass, such as 0.056 kg or 56 g
ball_mass: -1 g ¦ ball_mass ¦ -0.001 ¦ a positive, finite number
# A list of stiffnesses for two directions is refused with the reason; other lists may be sweeps.
stiffness: [60 kN/m, 45 kN/m] ¦ stiffness ¦ a list of 2 ¦ a number: the suspension is isotropic
damping_n_s_m: [1, 2] ¦ damping_n_s_m ¦ a list of 2 ¦ a number: the suspension is isotropic
speed: [6000 rpm, 7000 rpm] ¦ speed ¦ a list of 2 ¦ a sweep contains several values"#;

/// A line of a study, its key, what the message found, and what it allows.
const WRONG_LINES: &str = r#"sweep: [{grid: {speed: [6000 rpm, 6000]}}] ¦ sweep[0].grid.speed[1] ¦ 6000 ¦ `speed_rad_s` for a number in rad/s
uncertain: {ball_mass: {normal: {mean: 1 g, std_dev: 1 mm}}} ¦ uncertain.ball_mass.normal.std_dev ¦ 1 mm ¦ a mass, such as
# A later check names the key as the file writes it.
uncertain: {ball_mass: {uniform: {min: 2 g, max: 1 g}}} ¦ uncertain.ball_mass.uniform.max ¦ 0.001 ¦ above min
# Tables in a study have SI columns only.
sweep: [{table: {columns: [speed], rows: [[1]]}}] ¦ sweep[0].table.columns[0] ¦ speed ¦ speed_rad_s
# Ranges without meaning.
RANGE {from: 1, to: 2} ¦ .count ¦ no such key ¦ step: 0.5
RANGE {to: 2, count: 2} ¦ .from ¦ no such key ¦ from: 1
RANGE {from: 1, to: 2, count: 1} ¦ .count ¦ 1 ¦ from 2 to 1000000
RANGE {from: 1, to: 2, count: 2.5} ¦ .count ¦ 2.5 ¦ from 2 to 1000000
RANGE {from: 1, to: 2, count: 1000001} ¦  ¦ 1000001 values ¦ at most 1000000
RANGE {from: 0, to: 1, step: 1e-300} ¦  ¦ values ¦ at most 1000000
RANGE {from: 1, to: 2, step: -1} ¦ .step ¦ step -1 from 1 to 2 ¦ negative downwards
RANGE {from: 1, to: 2, step: 0} ¦ .step ¦ step 0 ¦ positive upwards
RANGE {from: 1, to: 2, step: 1, count: 2} ¦ .step ¦ both keys ¦ one of the two
RANGE {from: 1, to: 2, step: 1, spacing: logarithmic} ¦ .step ¦ `step` ¦ `count` with
RANGE {from: 0, to: 2, count: 3, spacing: logarithmic} ¦ .spacing ¦ from 0 ¦ above 0
RANGE {from: -1, to: 2, count: 3, spacing: logarithmic} ¦ .spacing ¦ from -1 ¦ below 0
RANGE {from: 1, to: 2, count: 3, spacing: even} ¦ .spacing ¦ even ¦ linear, logarithmic
RANGE {from: 1, to: 2, counts: 3} ¦  ¦ counts ¦ count (did you mean this?)
RANGE {from: a, to: 2, count: 3} ¦ .from ¦ text "a" ¦ a number
sweep: [{grid: {speed: {from: 1 rpm, to: 2 rad/s, count: 3}}}] ¦ sweep[0].grid.speed.to ¦ in rad/s ¦ a value in rpm
sweep: [{grid: {speed: {from: 1 rpm, to: 2, count: 3}}}] ¦ sweep[0].grid.speed.to ¦ without a unit ¦ a value in rpm
sweep: [{grid: {speed: {from: 1, to: 2, count: 3}}}] ¦ sweep[0].grid.speed[0] ¦ 1 ¦ `speed_rad_s` for a number in rad/s
sweep: [{zip: {speed_rad_s: {from: 0, to: 1, count: 600000}, damping_n_s_m: {from: 0, to: 1, count: 600000}}}] ¦ sweep[0].zip.damping_n_s_m ¦ 600000 values ¦ in all ranges"#;

#[test]
fn wrong_units_and_ranges_are_refused_with_the_remedy() {
    let rotation = "a speed of rotation, such as 628.3 rad/s or 6000 rpm";
    for [parameter, key, found, allowed] in cases(WRONG_PARAMETERS) {
        let allowed = allowed.replace("ROTATION", rotation);
        let key = format!("model.parameters.{key}");
        refused(&text(&parameter, ""), 6, &key, &found, &allowed);
    }
    for [line, key, found, allowed] in cases(WRONG_LINES) {
        let (line, key) = match line.strip_prefix("RANGE ") {
            Some(range) => (
                format!("sweep: [{{grid: {{speed_rad_s: {range}}}}}]"),
                format!("sweep[0].grid.speed_rad_s{key}"),
            ),
            None => (line, key),
        };
        refused(&text("", &format!("{line}\n")), 7, &key, &found, &allowed);
    }
    let table = "sweep: [{table: {columns: [speed_rad_s], rows: [[1]]}}]\n";
    assert!(parse(&text("", table)).is_ok());
}

#[test]
fn both_keys_at_once_are_refused_with_their_lines() {
    let both = text("", "simulation:\n  end_time_s: 3\n  end_time: 3 s\n");
    let error = parse(&both).unwrap_err();
    assert_eq!((error.key(), error.line()), ("simulation.end_time", Some(9)));
    assert_eq!(error.found(), Some("`end_time` in line 9 and `end_time_s` in line 8"));
}

fn values(range: &str) -> Vec<f64> {
    let study = study(&text("", &format!("sweep: [{{grid: {{{range}}}}}]\n")));
    numbers(&study)
}

fn numbers(study: &Study) -> Vec<f64> {
    (0..study.point_count()).map(|point| swept_numbers(study, point)[0]).collect()
}

#[test]
fn ranges_are_lists() {
    let list = ["{from: 0, to: 1, count: 11}", "{from: 0, to: 1, step: 0.1}"];
    let tenths: Vec<f64> = (0..=10).map(|tenth| format!("{tenth}e-1").parse().unwrap()).collect();
    for range in list {
        assert_eq!(values(&format!("friction_coefficient: {range}")), tenths, "{range}");
    }
    assert_eq!(values("speed_rad_s: {from: -1, to: -3, step: -0.75}"), [-1.0, -1.75, -2.5]);
    assert_eq!(values("balls: {from: 1, to: 4, step: 1}"), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(values("speed_rad_s: {from: -0.3, to: 0.3, step: 0.1}")[2..4], [-0.1, 0.0]);
    let logarithmic = "{from: 1e-3, to: 10, count: 5, spacing: logarithmic}";
    assert_eq!(
        values(&format!("friction_coefficient: {logarithmic}")),
        [1e-3, 1e-2, 0.1, 1.0, 10.0]
    );
    // The ends are exact, and the ratios equal.
    let uneven = values("speed_rad_s: {from: -0.1, to: -7.7, count: 4, spacing: logarithmic}");
    assert_eq!((uneven[0], uneven[3]), (-0.1, -7.7));
    for pair in uneven.windows(2) {
        assert!((pair[1] / pair[0] - 77.0_f64.cbrt()).abs() < 1e-13, "{uneven:?}");
    }
    let widest = values("speed_rad_s: {from: 1e-300, to: 1e300, count: 3, spacing: logarithmic}");
    assert!((widest[1] - 1.0).abs() < 1e-12, "{widest:?}");
    assert_eq!(values("speed_rad_s: {from: -1e308, to: 1e308, count: 3}"), [-1e308, 0.0, 1e308]);
    // Each value is that of the same text, so that a point can be selected by it.
    let speeds = values("speed: {from: 1000 rpm, to: 6000 rpm, count: 6}");
    let listed = values("speed: [1000 rpm, 2000 rpm, 3000 rpm, 4000 rpm, 5000 rpm, 6000 rpm]");
    assert_eq!(speeds, listed);
    let zip =
        "sweep: [{zip: {speed_rad_s: {from: 1, to: 3, count: 3}, damping_n_s_m: [1, 2, 3]}}]\n";
    assert_eq!(numbers(&study(&text("", zip))), [1.0, 2.0, 3.0]);
    let resolved = study(&text("", zip)).resolved_yaml();
    assert!(resolved.contains("speed_rad_s: [1.0, 2.0, 3.0]"), "{resolved}");
}

/// `units` chooses how a parameter is shown; else the first unit that the study writes does.
#[test]
fn people_read_the_units_of_the_study() {
    let text = |units: &str| {
        format!(
            "schema: 1\nname: a\nseed: 1\nmodel: {{kind: ball_balancer, parameters: {{ball_mass: 0.2 g, table_mass: 0.4 kg}}}}\n\
             sweep: [{{grid: {{speed: [-3000 rpm], ball_mass: [0.1 g, 0.2 g]}}}}]\n\
             uncertain: {{table_mass_kg: {{normal: {{mean: 0.4, std_dev: 0.01}}}}}}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 2}}}}}}\n{units}"
        )
    };
    let parse = |units: &str| Study::parse(Path::new("a.yaml"), text(units));
    let names = |units: &str| -> Vec<String> {
        let study = parse(units).unwrap();
        let again = Study::parse(Path::new("b.yaml"), study.resolved_yaml()).unwrap();
        let shown = |study: &Study| {
            let names = study.swept().iter().chain(study.uncertain());
            let names: Vec<String> = names.map(VariedParameter::shown_name).collect();
            (names, study.shown(&study.point(1).swept), study.units().vibration().symbol)
        };
        assert_eq!(shown(&study), shown(&again), "{}", study.resolved_yaml());
        assert_eq!(study.hash(), again.hash());
        let (mut names, values, vibration) = shown(&study);
        names.extend(values);
        names.push(vibration);
        names
    };
    let written = ["speed [rpm]", "ball_mass [g]", "table_mass_kg", "-3000", "0.2", "µm"];
    assert_eq!(names(""), written);
    let chosen = ["speed [rev/s]", "ball_mass [mg]", "table_mass [mg]", "-50", "200", "mm"];
    assert_eq!(names("units: {mass: mg, speed: rev/s, vibration: mm}\n"), chosen);
    let of_balls = ["speed [rpm]", "ball_mass [mg]", "table_mass_kg", "-3000", "200", "µm"];
    assert_eq!(names("units: {ball_mass: mg}\n"), of_balls);
    assert_eq!(parse("").unwrap().hash(), parse("units: {mass: g}\n").unwrap().hash());
    for (units, parts) in [
        ("units: {sped: rpm}\n", ["units.sped", "speed (did you mean this?)"]),
        ("units: {speed: mm}\n", ["units.speed", "a speed of rotation, such as"]),
        ("units: {mass: grams}\n", ["units.mass", "unknown unit"]),
    ] {
        assert_has(&parse(units).expect_err(units).to_string(), &parts);
    }
}

/// A column with a unit in its name has the values of the SI column.
#[test]
fn columns_may_have_units() {
    let folder = tempfile::tempdir().unwrap();
    let text = |table: &str| {
        format!(
            "schema: 1\nname: a\nseed: 1\nmodel: {{kind: ball_balancer}}\nsweep: [{{table: {table}}}]\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 2}}}}}}\n"
        )
    };
    let study = |csv: &str| {
        std::fs::write(folder.path().join("t.csv"), csv).unwrap();
        Study::parse(&folder.path().join("a.yaml"), text("t.csv"))
    };
    let swept = |study: Study| (study.point(0).swept, study.point(1).swept);
    let plain = study("speed_rad_s,ball_mass_kg\n-100,1.1e-4\n-200,1.3e-4\n").unwrap();
    let units = study("speed_rad_s [rad/s],ball_mass [g]\n-100,0.11\n-200,0.13\n").unwrap();
    assert_eq!(swept(units), swept(plain));
    let inline = "{columns: [\"speed [rpm]\"], rows: [[-3000], [-6000]]}";
    let (first, _) = swept(Study::parse(Path::new("a.yaml"), text(inline)).expect("valid"));
    let ParameterValue::Number(speed) = first[0] else { panic!("a number") };
    assert!((speed + 100.0 * std::f64::consts::PI).abs() < 1e-12);
    for (header, parts) in [
        ("speed [mm]", ["column speed [mm]", "a speed of rotation, such as"]),
        ("speed [rpn]", ["unknown unit", "rpm (did you mean this?)"]),
        ("sped [rpm]", ["unknown column", "speed_rad_s"]),
        ("speed_rad_s,speed [rpm]", ["a column given twice", "each column once"]),
    ] {
        let row = if header.contains(',') { "1,2" } else { "1" };
        let error = study(&format!("{header}\n{row}\n")).expect_err(header);
        assert_has(&error.to_string(), &parts);
    }
}
