//! Files with a mechanical system: what is wrong in one is said with its place and a remedy, and right ones keep their
//! meaning in every notation.

use stickslip::study::system_in_latex;

use super::{parse, says};
use crate::support::{cases, rows, shipped, shipped_study};

/// A study with a valid system, one key per line.
const GOOD: &str = "\
schema: 1
name: good
seed: 5
model:
  system:
    system: two_carts
    meaning: Two carts on a belt.
    parameters:
      carts: {value: 2, most: 5, meaning: number of carts}
      m: {value: 2 kg, meaning: mass of a cart}
      k: {value: 300 N/m, meaning: stiffness}
      f: 20 N
      mu: 0.2
      v: 0.1 m/s
      omega: 5 rad/s
    repeat:
      cart: carts
    coordinates:
      x[cart]: {unit: m, start: [-5 mm, f / k], start_rate: 0}
    mass:
      x[cart]: {'x[cart]': m}
    force:
      x[cart]: -k * x[cart] + if(cart > 1, k * (x[cart - 1] - x[cart]), 0) + f * cos(omega * t)
    contacts:
      belt[cart]:
        normal: 9.81 * f / 9.81
        sliding: x[cart]' - v
        friction: {stribeck: {coefficient: mu, static_coefficient: 2 * mu, stribeck_speed: v}}
    period: 2 * pi / omega
initial_conditions:
  design: {monte_carlo: {samples: 3}}
";

/// Replaces one text by another and checks the message.
#[track_caller]
fn refused(old: &str, new: &str, line: usize, problem: &str, found: &str, allowed: &str) {
    assert!(GOOD.contains(old), "{old}");
    let text = GOOD.replacen(old, new, 1);
    let error = parse(&text).err().unwrap_or_else(|| panic!("accepted: {new}"));
    assert_eq!(error.line(), Some(line), "{error}");
    assert!(error.column().is_some() && !error.key().is_empty(), "{error}");
    assert!(error.problem().contains(problem), "{error}");
    says(&error, found, allowed);
}

#[test]
fn the_good_system_is_good() {
    let study = parse(GOOD).unwrap_or_else(|error| panic!("{error}"));
    let names: Vec<String> =
        study.model().coordinates().into_iter().map(|coordinate| coordinate.name).collect();
    assert_eq!(names, ["x_1_m", "x_2_m", "x_rate_1_m_s", "x_rate_2_m_s"]);
    let parameters = study.model().kind().parameters;
    let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name).collect();
    assert_eq!(names, ["carts", "m_kg", "k_n_m", "f_n", "mu", "v_m_s", "omega_rad_s"]);
}

/// Shapes, with what is wrong, what was found and what is allowed.
const WRONG_SHAPES: &str = r#"{polygon: [[0, 0], [0, 0]], circle: [0, 0]} ¦ not one form ¦ 2 forms ¦ one of `circle`
{contact: 'belt[cart]'} ¦ not one form ¦ 0 forms ¦ one of `circle`
{square: [0, 0]} ¦ unknown key ¦ square ¦ circle
{circle: [0, 0]} ¦ has a radius ¦ no `radius` ¦ with `radius`
{line: [[0, 0], [0, 0]], radius: 1} ¦ has a radius ¦ of another ¦ with `radius`
{line: [[0, 0]]} ¦ another number of points ¦ 1 ¦ at least 2
{spring: [[0, 0], [1, 1], [2, 2]]} ¦ another number of points ¦ 3 ¦ 2 points
{circle: [0, 0, 1], radius: 1} ¦ not a point ¦ 3 values ¦ quotation marks
{mark: [0, 0]} ¦ without a contact ¦ no `contact` ¦ contact:
{circle: [0, 0], radius: 1, contact: belts} ¦ not a contact ¦ belts ¦ belt
{circle: [0, 0], radius: 1, contact: 'belt[cart + 1]'} ¦ not a contact ¦ belt[cart + 1] ¦ belt[cart]
{circle: [0, 0], radius: 1, contact: belt} ¦ not a contact ¦ belt ¦ belt[cart]
{circle: [0, 0], radius: k} ¦ another quantity ¦ N/m ¦ m
{circle: ["x[cart]' * 1", 0], radius: 1} ¦ rates of change ¦ x[cart] ¦ positions
{circle: [y, 0], radius: 1} ¦ unknown name ¦ y ¦ x"#;

/// Pictures: a shape has one form with points of positions in m, and an existing contact.
#[test]
fn pictures_have_shapes_of_positions() {
    let end = "    period: 2 * pi / omega\n";
    let with = |shape: &str| {
        format!("    draw:\n      side:\n        shapes:\n          cart[cart]: {shape}\n{end}")
    };
    let good =
        "{polygon: [['x[cart]', 0], [f / k, cart * f / k], ['x[1]', 1 mm]], contact: 'belt[cart]'}";
    let study =
        parse(&GOOD.replacen(end, &with(good), 1)).unwrap_or_else(|error| panic!("{error}"));
    let drawing = study.model().drawing(&study.planned_run(0).start).expect("pictures");
    let [first, second] = &drawing.views[0].shapes[..] else { panic!("two carts") };
    assert_eq!([first.contact, second.contact], [Some(0), Some(1)]);
    assert_eq!([&first.values[0], &second.values[0]], ["q[0]", "q[1]"]);
    for [shape, problem, found, allowed] in cases(WRONG_SHAPES) {
        refused(end, &with(&shape), 32, &problem, &found, &allowed);
    }
    let turns = with(good).replace("shapes:", "turns: true\n        shapes:");
    refused(end, &turns, 31, "without a part that turns", "true", "`turning`");
    let name = with(good).replace("side", "a-b");
    refused(end, &name, 31, "not a name", "a-b", "letters");
    let name = with(good).replace(" cart[cart]:", " a.b[cart]:");
    refused(end, &name, 32, "not a name", "a.b", "letters");
}

#[test]
fn a_derived_quantity_has_parameters_only() {
    let end = "    period: 2 * pi / omega\n";
    let with = |derived: &str| format!("    derived:\n      limit: {derived}\n{end}");
    refused(end, &with("2 * x[1]"), 30, "changes with the state", "2 * x[1]", "parameters");
    refused(end, &with("{value: f / k, unit: s}"), 30, "another quantity", "m", "s");
    refused(end, &with("{value: f / k, unit: mm}"), 30, "not an SI unit", "mm", "m");
    let of_bodies = with("f / k").replace("limit", "limit[cart]");
    refused(end, &of_bodies, 30, "a quantity of a body", "limit[cart]", "without an index");
    refused(end, &with("f / k").replace("limit", "k"), 30, "given twice", "k", "one name");
    let text = GOOD.replacen(end, &with("{value: f / k, unit: m, meaning: static deflection}"), 1);
    let study = parse(&text).unwrap_or_else(|error| panic!("{error}"));
    let stickslip::model::Model::Own(written) = study.model() else { panic!("not a system") };
    let [limit] = &written.derived()[..] else { panic!("one quantity") };
    assert_eq!((limit.name.name.as_str(), limit.name.unit.as_str()), ("limit_m", "m"));
    assert!((limit.value - 20.0 / 300.0).abs() < 1e-15 && limit.is_shown, "{limit:?}");
    let ranged = |ranges: &str| with(&format!("{{value: f / k, {ranges}}}"));
    refused(end, &ranged("usual: [0, 1 s]"), 30, "another quantity", "s", "m");
    let refuse = parse(&GOOD.replacen(end, &ranged("within: [0, f / (2 * k)]"), 1));
    let error = refuse.expect_err("a static deflection above half of it").to_string();
    assert!(error.contains("limit is 0.066") && error.contains("between 0 and 0.033"), "{error}");
    let text = GOOD.replacen(end, &ranged("usual: [0, f / (2 * k)]"), 1);
    let study = parse(&text).unwrap_or_else(|error| panic!("{error}"));
    let warnings = stickslip::check::warnings(&study);
    let [warning] = &warnings[..] else { panic!("one warning: {warnings:?}") };
    assert!(warning.problem.contains("outside of its usual range"), "{warning}");
    assert_eq!(warning.key, "model.limit_m");
    assert!(warning.remedy.ends_with("from 0 m to 0.03333 m"), "{warning}");
}

#[test]
fn a_number_of_bodies_may_be_zero_if_the_file_says_so() {
    let count = "carts: {value: 2, most: 5,";
    refused(
        count,
        "carts: {value: 2, least: 3, most: 5,",
        9,
        "not a number of bodies",
        "2",
        "least",
    );
    let text = GOOD.replacen(count, "carts: {value: 0, least: 0, most: 5,", 1);
    let text = text.replacen("x[cart]: {unit", "y: {unit: m}\n      x[cart]: {unit", 1);
    let text = text.replacen("mass:\n", "mass:\n      y: {y: m}\n", 1);
    let text = text.replacen("force:\n", "force:\n      y: -k * y\n", 1);
    let study = parse(&text).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(study.model().contacts(), 0);
}

#[test]
fn formulas_are_read_in_full() {
    let force = "-k * x[cart] + if(cart > 1, k * (x[cart - 1] - x[cart]), 0) + f * cos(omega * t)";
    for (formula, problem, found, allowed) in [
        ("-k * * x[cart]", "not a formula", "`*`", "a number, a name"),
        ("-k * x[cart", "not a formula", "its end", "`]`"),
        ("(-k * x[cart]", "not a formula", "its end", "`)`"),
        ("-k x[cart]", "not a formula", "`x` at character 4", "an operator"),
        ("-2k * x[cart]", "not a formula", "`k`", "`*` between a number and a name"),
        ("-q * x[cart]", "unknown name", "`q` at character 2", "x, carts"),
        ("-kk * x[cart]", "unknown name", "`kk`", "k (did you mean this?)"),
        ("-k * x", "one of several bodies", "`x`", "x[1]"),
        ("-k * m[cart]", "not a coordinate", "`m`", "only a coordinate"),
        ("-k * x[cart + 1]", "a body that does not exist", "`x[3]` of 2", "if(condition"),
        ("-k * x[f]", "not a whole number", "`f`", "whole numbers"),
        ("-k * abs(x[cart])", "not smooth", "abs", "a contact with a gap"),
        ("f * ln(x[cart])", "unknown function", "ln", "log is the natural"),
        ("f * sine(t)", "unknown function", "sine", "sin, cos"),
        ("f * if(x[cart] > 0, 1, 0)", "not a whole number", "x", "a contact"),
        ("f * if(cart, 1, 0)", "not a formula", "`,`", "a comparison"),
        ("x[cart]''", "an acceleration", "x[cart]''", "linear there"),
        ("f * x[cart]^m", "not a constant exponent", "m", "a number"),
        ("f * 2^(1/3)", "an exponent", "0.333", "a multiple of 1/2"),
        ("sum(wheel, f)", "unknown index", "`wheel`", "cart"),
        ("1e400 * f", "not a number", "1e400", "a finite number"),
        ("f = 3", "not a formula", "`=`", "`==` for a comparison"),
        ("f * 'x", "not a formula", "`'`", "a prime only after a coordinate"),
        ("m * x[cart]", "another quantity", "kg m", "N"),
        ("k * x[cart] + m", "a sum of different quantities", "kg", "N"),
        ("f * sin(x[cart])", "the argument of a function with a dimension", "m", "no dimension"),
        ("f + 3 * k", "a sum of different quantities", "N/m", "N"),
    ] {
        refused(force, &format!("\"{formula}\""), 23, problem, found, allowed);
    }
}

/// What is replaced, by what, the line of the message, its problem, what it found, and what it allows.
const WRONG_KEYS: &str = r#"system: two_carts ¦ system: Two Carts ¦ 6 ¦ not a name of a system ¦ Two Carts ¦ lower-case
meaning: Two carts on a belt. ¦ means: x ¦ 7 ¦ unknown key ¦ means ¦ meaning (did you
2 kg, meaning ¦ 2 kq, meaning ¦ 10 ¦ unknown unit ¦ kq ¦ an SI unit
2 kg, meaning ¦ 20 Hz, meaning ¦ 10 ¦ unknown unit ¦ Hz ¦ 1/s for a frequency
m: {value: 2 kg ¦ m: {value: heavy ¦ 10 ¦ not a value ¦ heavy ¦ 0.3 kg
mu: 0.2 ¦ l_m: 0.2 ¦ 13 ¦ a name that ends like a unit ¦ l_m ¦ another ending
mu: 0.2 ¦ pi: 0.2 ¦ 13 ¦ another meaning ¦ pi ¦ a name of its own
mu: 0.2 ¦ x: 0.2 ¦ 19 ¦ given twice ¦ x ¦ one name
most: 5 ¦ most: 1 ¦ 9 ¦ not a number of bodies ¦ most: 1 ¦ a whole number
cart: carts ¦ cart: m ¦ 17 ¦ not a number of bodies ¦ m ¦ carts
x[cart]: {unit: m ¦ x[wheel]: {unit: m ¦ 19 ¦ unknown index ¦ wheel ¦ cart
{unit: m, start ¦ {unit: furlong, start ¦ 19 ¦ unknown unit ¦ furlong ¦ an SI unit
start: [-5 mm ¦ start: [-5 s ¦ 19 ¦ another quantity ¦ s ¦ m
x[cart]: {unit: m ¦ x[cart]: {unit: mm ¦ 19 ¦ not an SI unit ¦ mm ¦ m; values
mu: 0.2 ¦ label: 0.2 ¦ 13 ¦ another column ¦ label ¦ another name
x[cart]: {unit: m ¦ x[cart]: {unit: m, start: 0}\n      x_1: {unit: m ¦ 20 ¦ another column ¦ x_1 ¦ another name
  x[cart]: -k ¦   x[cart + 1]: -k ¦ 23 ¦ a body that does not exist ¦ x[3] ¦ x[1] to x[2]
sliding: x[cart]' - v ¦ sliding: v ¦ 27 ¦ without a rate of change ¦ v ¦ one prime
sliding: x[cart]' - v ¦ sliding: x[cart]' - v\n        restitution: 0.5 ¦ 25 ¦ without an impact ¦ no gap ¦ only with
normal: 9.81 * f / 9.81 ¦ normal: carts ¦ 26 ¦ another quantity ¦ no dimension ¦ N
normal: 9.81 * f / 9.81 ¦ normal: 20 mm ¦ 26 ¦ another quantity ¦ m ¦ N
start: [-5 mm, f / k] ¦ start: [0, f] ¦ 19 ¦ another quantity ¦ N ¦ m
start: [-5 mm, f / k] ¦ start: [0, 0, 1] ¦ 19 ¦ not a range ¦ 3 values ¦ two values
start: [-5 mm, f / k] ¦ start: 0 * t ¦ 19 ¦ changes with the state or the time ¦ t ¦ parameters
start_rate: 0 ¦ start_rate: 0, periodic: true ¦ 19 ¦ periodic ¦ m ¦ rad
]': m} ¦ ]': k} ¦ 21 ¦ another quantity ¦ N/m ¦ kg
{'x[cart] ¦ {'y[cart] ¦ 21 ¦ unknown name ¦ y ¦ x
]': m} ¦ ]': "m * x[cart]'"} ¦ 21 ¦ rates of change ¦ m * x ¦ positions
normal: 9.81 * f / 9.81 ¦ force: f ¦ 26 ¦ unknown key ¦ force ¦ gap, normal
  normal: 9.81 * f / 9.81\n ¦ \n ¦ 25 ¦ no normal force ¦ neither ¦ `gap: ...`
normal: 9.81 * f / 9.81 ¦ normal: m ¦ 26 ¦ another quantity ¦ kg ¦ N
normal: 9.81 * f / 9.81 ¦ normal: f * x[cart]''^2 / 1 ¦ 26 ¦ an acceleration ¦ f * x ¦ linear there
sliding: x[cart]' - v ¦ sliding: (x[cart]' - v)^2 ¦ 27 ¦ not linear ¦ ^2 ¦ a sum of rates
sliding: x[cart]' - v ¦ gap: x[cart] ¦ 25 ¦ two normal forces ¦ `gap` and ¦ given force
coefficient: mu, ¦ coefficent: mu, ¦ 28 ¦ unknown key ¦ coefficent ¦ coefficient (did you
stribeck_speed: v} ¦ stribeck_speed: f} ¦ 28 ¦ another quantity ¦ N ¦ m/s
{stribeck: {coefficient: mu, static_coefficient: 2 * mu, stribeck_speed: v}} ¦ study ¦ 9 ¦ the law of the study without ¦ friction_coefficient ¦ among the parameters
{stribeck: {coefficient: mu, static_coefficient: 2 * mu, stribeck_speed: v}} ¦ stribeck ¦ 28 ¦ not allowed here ¦ stribeck ¦ `study`
{stribeck: { ¦ {stribek: { ¦ 28 ¦ unknown choice ¦ stribek ¦ stribeck (did you
, stribeck_speed: v ¦  ¦ 28 ¦ missing key ¦ no such key ¦ stribeck_speed
period: 2 * pi / omega ¦ period: 2 * pi / omega\n    outputs: {load: k * y} ¦ 30 ¦ unknown name ¦ y ¦ x
period: 2 * pi / omega ¦ period: 2 * pi / omega\n    outputs: {load: {value: "k * x[1]''"}} ¦ 30 ¦ an acceleration ¦ k * x ¦ only in the normal
period: 2 * pi / omega ¦ period: 2 * pi / omega\n    outputs: {mu: f} ¦ 30 ¦ given twice ¦ mu ¦ one name
period: 2 * pi / omega ¦ period: 2 * pi / omega\n    outputs: {x_rate: f} ¦ 30 ¦ another column ¦ x_rate ¦ another name
x[cart]: {'x[cart]': m} ¦ {} ¦ 21 ¦ a coordinate without a mass ¦ x[cart] ¦ x[cart]: {x[cart]: ...}
period: 2 * pi / omega ¦ period: omega ¦ 29 ¦ another quantity ¦ 1/s ¦ s
+ f * cos(omega * t) ¦  ¦ 29 ¦ a period without the time ¦ 2 * pi ¦ no period
period: 2 * pi / omega ¦ turning: {q: omega, p: omega} ¦ 29 ¦ several parts that turn ¦ 2 ¦ one part
period: 2 * pi / omega ¦ turning: {q: m} ¦ 29 ¦ not a speed ¦ m ¦ 3000 rpm
period: 2 * pi / omega ¦ turning: {x: omega} ¦ 29 ¦ given twice ¦ x ¦ one name
period: 2 * pi / omega ¦ turning: {q: omega} ¦ 23 ¦ the time beside a part that turns ¦ t ¦ the angle q
  system:\n ¦   kind: ball_balancer\n  system:\n ¦ 5 ¦ not beside `system` ¦ kind ¦ `system`"#;

#[test]
fn keys_of_a_system_are_checked() {
    for [old, new, line, problem, found, allowed] in cases(WRONG_KEYS) {
        refused(&old, &new, line.parse().expect("a line"), &problem, &found, &allowed);
    }
}

/// Numbers without physical meaning are found when a study gives values.
#[test]
fn values_without_meaning_are_refused() {
    let with = |parameters: &str| {
        let text = GOOD.replace(
            "initial_conditions",
            &format!("  parameters: {{{parameters}}}\ninitial_conditions"),
        );
        parse(&text)
    };
    for (parameters, found) in [
        ("m: -2 kg", "not positive definite in the middle of the start ranges, in the row of x"),
        ("m: 0 kg", "not positive definite"),
        ("omega: 0 rad/s", "inf"),
        ("mu: -0.1", "-0.1"),
        ("carts: 0", "0"),
        ("carts: 6", "6"),
        ("carts: 1.5", "1.5"),
        ("n: 1", "n"),
    ] {
        let error = with(parameters).err().unwrap_or_else(|| panic!("accepted: {parameters}"));
        assert!(error.to_string().contains(found), "{error}");
        assert!(error.line().is_some(), "{error}");
    }
    let normal = "normal: f + 0.01 * m * cos(0.4 * omega * t) * x[cart]''";
    for (old, new, found) in [
        ("period: 2 * pi / omega", "period: 3 / omega", "0.6"),
        ("normal: 9.81 * f / 9.81", normal, "1.25"),
    ] {
        let error = parse(&GOOD.replace(old, new)).expect_err("not the period").to_string();
        assert!(error.contains(found) && error.contains("all formulas repeat"), "{error}");
    }
    let study = with("carts: 5, m: 300 g").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(study.model().contacts(), 5);
}

/// A formula that exists for the default number of bodies only is refused where a study gives another one.
#[test]
fn numbers_of_bodies_without_formulas_are_refused() {
    let cut = GOOD
        .replace("sliding: x[cart]' - v", "sliding: x[cart]' - v + if(cart == 3, 0 * x[9]', 0)");
    assert!(parse(&cut).is_ok());
    let text = cut.replace("initial_conditions", "  parameters: {carts: 3}\ninitial_conditions");
    let error = parse(&text).expect_err("x[9] does not exist").to_string();
    assert!(error.contains("a body that does not exist"), "{error}");
    let many = (0..70).map(|number| format!("      y{number}: {{unit: m}}\n"));
    let many = GOOD.replace("    mass:\n", &format!("{}    mass:\n", many.collect::<String>()));
    let error = parse(&many).expect_err("75 coordinates").to_string();
    assert!(error.contains("75 coordinates") && error.contains("at most 64"), "{error}");
}

#[test]
fn a_resolved_study_contains_its_system() {
    let study = parse(GOOD).unwrap_or_else(|error| panic!("{error}"));
    let again = parse(&study.resolved_yaml()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(study.hash(), again.hash());
    assert_eq!(study.resolved_yaml(), again.resolved_yaml());
    let other = parse(&GOOD.replace("-k * x[cart] +", "-2 * k * x[cart] +"));
    assert_ne!(study.hash(), other.unwrap_or_else(|error| panic!("{error}")).hash());
}

/// A study gives the part that turns a speed profile, whose values are parameters. The resolved study contains the profile.
#[test]
fn a_part_that_turns_follows_a_profile() {
    let profile =
        "  speed_profile: [{ramp: {from_rad_s: 1, over_s: 2}}, {hold_s: 3}]\ninitial_conditions";
    let turning = GOOD
        .replace("cos(omega * t)", "cos(q)")
        .replace("period: 2 * pi / omega", "turning: {q: omega}");
    let study = parse(&turning.replace("initial_conditions", profile));
    let study = study.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(study.model().stage_begins_s(5.0), [0.0, 2.0]);
    let again = parse(&study.resolved_yaml()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(study.hash(), again.hash());
    let swept = format!(
        "{profile}:\n  design: {{monte_carlo: {{samples: 3}}}}\nsweep: [{{grid: {{ramp_over_1_s: [1, 4]}}}}]\n"
    );
    let (head, _) = turning.split_once("initial_conditions").expect("it has some");
    let study = parse(&format!("{head}{swept}")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(study.point(1).model().stage_begins_s(9.0), [0.0, 4.0]);
    for (text, problem) in [
        (GOOD.replace("initial_conditions", profile), "no part of this model turns"),
        (turning.replace("cos(q)", "cos(1)"), "an angle without effect"),
        (turning.replace("cos(q)", "cos(q) * omega / omega"), "the last speed of a part"),
        (turning.replace("cos(q)", "cos(q / 2)"), "not all formulas are the same after a turn"),
        (turning.replace("omega: 5 rad/s", "omega: 5"), "not a speed of this system"),
        (turning.replace("omega: 5 rad/s", "omega: 0 rad/s"), "no physical meaning"),
    ] {
        let error = parse(&text).expect_err("a wrong study").to_string();
        assert!(error.contains(problem), "{error}");
    }
}

/// Formulas without a meaning.
const HOSTILE: &str = "\u{0}f ¦ f\u{202e} ¦ x[999999999999999999999] ¦ x[1 - 9223372036854775807] ¦ x[-cart]' ¦ pi' ¦ t[1] ¦  ¦     ¦ ()
if ¦ sum ¦ sum() ¦ if(1 < 2, f) ¦ x[cart][cart] ¦ ' ¦ 1e ¦ 0x10 * f ¦ f % 2 ¦ f ** ";

/// Texts that try to exhaust time or memory end with a message.
#[test]
fn hostile_systems_are_refused() {
    let force = "-k * x[cart] + if(cart > 1, k * (x[cart - 1] - x[cart]), 0) + f * cos(omega * t)";
    let deep = |open: &str, close: &str| format!("{}f{}", open.repeat(3000), close.repeat(3000));
    for formula in [
        deep("(", ")"),
        deep("-", ""),
        deep("sin(", ")"),
        deep("sum(cart, ", ")"),
        format!("f{}", " + f".repeat(40_000)),
        format!("f * {}1{}", "sum(cart, ".repeat(40), ")".repeat(40)),
        "f * 2^99".to_owned() + &"^99".repeat(500),
        "f * (x[cart] / (1 m))^1e300".to_owned(),
    ]
    .into_iter()
    .chain(rows(HOSTILE).flatten())
    {
        let text = GOOD.replacen(force, &serde_json::Value::from(formula.as_str()).to_string(), 1);
        let error = parse(&text).err().unwrap_or_else(|| panic!("accepted: {formula:.80}"));
        assert!(error.line().is_some() && error.to_string().len() < 3000, "{error}");
    }
}

/// A motion that a table gives: the resolved study contains its rows, and a system file names a table beside itself.
#[test]
fn a_motion_has_a_table() {
    let end = "    period: 2 * pi / omega\n";
    let moving = GOOD.replace("f * cos(omega * t)", "k * road").replace(end, "");
    let with = |keys: &str| {
        moving
            .replace("    contacts:\n", &format!("    motions: {{road: {keys}}}\n    contacts:\n"))
    };
    let good = "{unit: m, table: {columns: [time_s, 'road [mm]'], rows: [[0, 0], [0.5, 2]]}}";
    let study = parse(&with(good)).unwrap_or_else(|error| panic!("{error}"));
    let again = parse(&study.resolved_yaml()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((study.hash(), study.resolved_yaml()), (again.hash(), again.resolved_yaml()));
    assert_eq!(study.model().given_motions()[0].rows(), [[0.0, 0.0], [0.5, 0.002]]);
    let of_file = shipped_study("shaken-block.yaml");
    let of_rows = parse(&of_file.resolved_yaml()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(of_file.hash(), of_rows.hash());
    assert_eq!(of_file.model().last_stage_begins_s(), 4.0);
    let cut = format!("{}simulation: {{end_time_s: 0.5, extend: {{factor: 4}}}}\n", with(good));
    let error = parse(&cut).expect_err("runs are continued from within the motion");
    assert!(error.problem().contains("before their last stage"), "{error}");
    for [old, new, problem, found, allowed] in cases(WRONG_MOTIONS) {
        let text = with(good).replace(&old, &new);
        let error = parse(&text).err().unwrap_or_else(|| panic!("accepted: {new}"));
        assert!(error.line().is_some() && error.problem().contains(&problem), "{error}");
        says(&error, &found, &allowed);
    }
}

/// A text of a system with a motion, its replacement, and what is wrong, found and allowed.
const WRONG_MOTIONS: &str = r"[0.5, 2] ¦ [0, 2] ¦ do not ascend ¦ 0 ¦ later times
[[0, 0], ¦ [[0.1, 0], ¦ do not ascend ¦ 0.1 ¦ 0 in the first row
, [0.5, 2]] ¦ ] ¦ one row only ¦ 1 row ¦ two rows
time_s ¦ t ¦ unknown column ¦ t ¦ time_s
road [mm] ¦ road ¦ unknown column ¦ road ¦ road_m
{unit: m, ¦ {unit: mm, ¦ not an SI unit ¦ mm ¦ m
k * road ¦ k * x[1] ¦ without effect ¦ road ¦ an equation
k * road ¦ f * cos(omega * t) ¦ the time beside a motion ¦ t ¦ given motions
k * road ¦ k * roads ¦ unknown name ¦ roads ¦ road
k * road ¦ k * road' ¦ different quantities ¦ kg m s^-3 ¦ N
f: 20 N ¦ road: 20 N ¦ given twice ¦ road ¦ one name
table: { ¦ tables: { ¦ unknown key ¦ tables ¦ table";

/// The equations in LaTeX: parentheses where precedence needs them, and the index of each body.
#[test]
fn equations_in_latex() {
    let equations = |system: &str| system_in_latex(system, &shipped("systems")).expect("no fault");
    let text = "system: a\nparameters: {m_1: 2, k: 3.0e-5, b: 1, n: {value: 2, most: 3}}\nrepeat: {cart: n}\n\
                coordinates: {'x[cart]': {start: 0}}\nmass: {'x[cart]': {'x[cart]': m_1}}\n\
                force: {'x[cart]': \"-(k + b) * x[cart] / (m_1 * b) - (x[1]' - x[2]')^2 + sqrt(exp(-x[1])) * 2\"}\n\
                contacts: {'pad[cart]': {normal: 2 * b, sliding: \"x[cart]' - b\", friction: {coulomb: {coefficient: k}}}}\n";
    let force = |body: u32| {
        format!(
            r"-\frac{{\left(k + b\right) \, x_{{{body}}}}}{{m_{{\mathrm{{1}}}} \, b}} - \left(\dot{{x}}_{{1}} - \dot{{x}}_{{2}}\right)^{{2}} + \sqrt{{\exp\left(-x_{{1}}\right)}} \cdot 2"
        )
    };
    let pad = |body: u32| {
        format!(
            r"& \text{{pad {body}: }} \text{{normal}} = 2 \, b, \quad \text{{sliding}} = \dot{{x}}_{{{body}}} - b"
        )
    };
    let expected = format!(
        r"$\displaystyle \begin{{aligned}} & \begin{{bmatrix}} m_{{\mathrm{{1}}}} & 0 \\ 0 & m_{{\mathrm{{1}}}} \end{{bmatrix}} \begin{{bmatrix}} \ddot{{x}}_{{1}} \\ \ddot{{x}}_{{2}} \end{{bmatrix}} = \begin{{bmatrix}} {} \\ {} \end{{bmatrix}} + \text{{contacts}} \\ {} \\ {} \end{{aligned}}$",
        force(1),
        force(2),
        pad(1),
        pad(2)
    );
    assert_eq!(equations(text), expected);
    for file in [
        "woodpecker",
        "ball_balancer",
        "unbalanced_shaft",
        "block_chain",
        "shaken_block",
        "rocking_block",
    ] {
        let text = std::fs::read_to_string(shipped(&format!("systems/{file}.yaml"))).expect(file);
        let latex = equations(&text);
        let depth = latex.chars().try_fold(0_u32, |depth, letter| match letter {
            '{' => Some(depth + 1),
            '}' => depth.checked_sub(1),
            _ => Some(depth),
        });
        assert_eq!(depth, Some(0), "{latex}");
    }
}
