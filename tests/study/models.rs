//! Blocks and laws of friction in study files: the parameters of each model, defaults, round trips,
//! and errors.

use crate::support::cases;

use super::{laws, parse, refused, same_runs, study};

/// Returns a study of a model with these lines under `model`, from line 5 on.
fn text(model: &str, rest: &str) -> String {
    let rest = if rest.contains("initial_conditions") {
        rest.to_owned()
    } else {
        format!("{rest}initial_conditions: {{design: {{monte_carlo: {{samples: 3}}}}}}\n")
    };
    format!("schema: 1\nname: a\nseed: 5\nmodel:\n{model}{rest}")
}

const STRIBECK: &str =
    "  friction: {stribeck: {static_friction_coefficient: 0.3, stribeck_speed_m_s: 0.1}}\n";

/// Parameters are varied under their names and units, also those of the laws of friction.
#[test]
fn parameters_have_names_and_units() {
    for [kind, friction, name, unit] in cases(
        r"block_on_spring ¦ coulomb ¦ mass_kg ¦ kg
block_on_spring ¦ coulomb ¦ stiffness_n_m ¦ N/m
block_on_spring ¦ coulomb ¦ normal_force_n ¦ N
block_on_spring ¦ coulomb ¦ friction_coefficient ¦ 1
block_on_belt ¦ coulomb ¦ belt_speed_m_s ¦ m/s
block_on_belt ¦ {stribeck: {static_friction_coefficient: 0.3, stribeck_speed_m_s: 0.1}} ¦ stribeck_speed_m_s ¦ m/s
block_on_spring ¦ {smooth: {smoothing_speed_m_s: 0.01}} ¦ smoothing_speed_m_s ¦ m/s
block_on_belt ¦ {viscous: {viscous_coefficient_n_s_m: 2}} ¦ viscous_coefficient_n_s_m ¦ N s/m
ball_balancer ¦ {stribeck: {static_friction_coefficient: 0.01, stribeck_speed_rad_s: 1}} ¦ static_friction_coefficient ¦ 1
ball_balancer ¦ {stribeck: {static_friction_coefficient: 0.01, stribeck_speed_rad_s: 1}} ¦ stribeck_speed_rad_s ¦ rad/s
ball_balancer ¦ {smooth: {smoothing_speed_rad_s: 0.1}} ¦ smoothing_speed_rad_s ¦ rad/s
ball_balancer ¦ {coulomb_viscous: {viscous_coefficient_n_s_m: 1e-4}} ¦ viscous_coefficient_n_s_m ¦ N s/m",
    ) {
        let model = format!("  kind: {kind}\n  friction: {friction}\n");
        let swept = study(&text(&model, &format!("sweep: [{{zip: {{{name}: [0.7, 0.9]}}}}]\n")));
        assert_eq!((swept.swept()[0].name.as_str(), swept.swept()[0].unit), (&*name, &*unit));
        let [first, other] = [0, 1].map(|point| format!("{:?}", swept.point(point).model()));
        assert!(first != other && other.contains("0.9"), "{name}: {other}");
        let range = format!("uncertain: {{{name}: {{uniform: {{min: 0.7, max: 0.9}}}}}}\n");
        let run = study(&text(&model, &range)).planned_run(2);
        assert!((0.7..0.9).contains(&run.uncertain[0]), "{name}");
        let drawn = format!("{:?}", run.case.expect("a valid sample").model);
        assert!(drawn.contains(&format!("{:?}", run.uncertain[0])), "{name}: {drawn}");
    }
}

/// Each model with each law resolves to a complete text that is the same study.
#[test]
fn every_model_and_law_resolves_to_itself() {
    for (kind, unit) in
        [("block_on_spring", "m_s"), ("block_on_belt", "m_s"), ("ball_balancer", "rad_s")]
    {
        let at_once =
            format!("{{stribeck: {{static_friction_coefficient: 0.3, stribeck_speed_{unit}: 0}}}}");
        for law in laws(unit).into_iter().chain([at_once]) {
            let first = study(&text(&format!("  kind: {kind}\n  friction: {law}\n"), ""));
            let written = first.resolved_yaml();
            let second = study(&written);
            assert_eq!(second.resolved_yaml(), written);
            assert_eq!((second.hash(), second.model()), (first.hash(), first.model()));
            assert_eq!(first.model().kind().name, kind);
            let name = law.trim_matches(['{', '}']).split(':').next().expect("a name");
            assert!(written.contains(name), "{law}: {written}");
            same_runs(&second, &first);
        }
    }
}

/// By default a block starts at rest in m and m/s, within the interval that full friction would
/// hold.
#[test]
fn a_block_has_a_default_start_box() {
    let design = "initial_conditions: {design: {grid: {points_per_axis: 2}}}\n";
    let default = study(&text("  kind: block_on_spring\n", design));
    assert_eq!(default.run_count(), 2);
    for (run, place) in [(0, -0.05), (1, 0.05)] {
        let start = default.planned_run(run).start.0;
        assert!((start[0] - place).abs() < 1e-15 && start[1] == 0.0, "{start:?}");
    }
    let given = "initial_conditions:\n  box: {velocity_m_s: [1, 1], position_m: [0.2, 0.2]}\n  \
                 design: {monte_carlo: {samples: 1}}\n";
    let given = study(&text("  kind: block_on_belt\n", given));
    assert_eq!(given.planned_run(0).start.0, [0.2, 1.0]);
    for name in ["beta", "x", "beta_dot_1", "positon"] {
        let rest = format!("initial_conditions:\n  box: {{{name}: [0, 1]}}\n");
        let text = text("  kind: block_on_spring\n", &rest);
        let key = format!("initial_conditions.box.{name}");
        refused(&text, 7, &key, name, "position_m");
    }
    let balls = "initial_conditions:\n  box: {position_m: [0, 1]}\n";
    let balls = text("  kind: ball_balancer\n", balls);
    refused(&balls, 7, "initial_conditions.box.position_m", "position_m", "beta, beta_dot, x");
}

/// Start states of a block may be given in a table, in any order of the columns.
#[test]
fn starts_of_a_block_from_a_table() {
    let table = |columns: &str| {
        let rest = format!(
            "initial_conditions:\n  design:\n    table: {{columns: [{columns}], rows: [[1, 2], [3, 4]]}}\n"
        );
        text("  kind: block_on_spring\n", &rest)
    };
    let given = study(&table("velocity_m_s, position_m"));
    assert_eq!(given.run_count(), 2);
    assert_eq!(given.planned_run(1).start.0, [4.0, 3.0]);
    let key = "initial_conditions.design.table.columns[1]";
    refused(&table("position_m, x_dot"), 8, key, "x_dot", "velocity_m_s");
}

/// Position and velocity are two dimensions of the Sobol' sequence: of 256 points exactly one lies
/// in each of 16 x 16 cells.
#[test]
fn sobol_starts_of_a_block_fill_the_plane() {
    let rest = "initial_conditions:\n  box: {position_m: [0, 16], velocity_m_s: [0, 16]}\n  \
                design: {sobol: {samples: 256}}\n";
    let study = study(&text("  kind: block_on_belt\n", rest));
    let mut cells = std::collections::BTreeSet::new();
    for run in 0..256 {
        let start = study.planned_run(run).start.0;
        cells.insert([start[0].floor() as u8, start[1].floor() as u8]);
    }
    assert_eq!(cells.len(), 256);
}

#[test]
fn parameters_of_other_models_are_refused() {
    let spring = "  kind: block_on_spring\n";
    let given = |line: &str| text(&format!("{spring}  parameters:\n    {line}\n"), "");
    for (line, name) in [
        ("belt_speed_m_s: 1", "belt_speed_m_s"),
        ("speed_rad_s: -200", "speed_rad_s"),
        ("table_mass_kg: 1", "table_mass_kg"),
        ("ball_mass_kg: 1", "ball_mass_kg"),
        ("damping_n_s_m: 1", "damping_n_s_m"),
    ] {
        refused(&given(line), 7, &format!("model.parameters.{name}"), name, "normal_force_n");
        let swept = text(spring, &format!("sweep:\n  - grid: {{{name}: [1]}}\n"));
        refused(&swept, 7, &format!("sweep[0].grid.{name}"), name, "normal_force_n");
        let drawn =
            text(spring, &format!("uncertain:\n  {name}: {{uniform: {{min: 1, max: 2}}}}\n"));
        refused(&drawn, 7, &format!("uncertain.{name}"), name, "normal_force_n");
    }
    // A law's own parameters exist with that law only.
    for name in [
        "static_friction_coefficient",
        "stribeck_speed_m_s",
        "smoothing_speed_m_s",
        "viscous_coefficient_n_s_m",
    ] {
        let swept = text(spring, &format!("sweep:\n  - grid: {{{name}: [1]}}\n"));
        refused(&swept, 7, &format!("sweep[0].grid.{name}"), name, "friction_coefficient");
        let error = parse(&swept).expect_err("refused");
        assert!(error.problem().contains("block_on_spring with coulomb friction"), "{error}");
    }
}

/// The kind, further lines of the model and of the study, the line of the message, its key, what it found, and what it allows.
const WRONG: &str = r"# Keys of other models.
block_on_spring ¦   parameters: {balls: 2}\n ¦  ¦ 6 ¦ model.parameters.balls ¦ block_on_spring ¦ ball_balancer
block_on_spring ¦   normal_force: newton\n ¦  ¦ 6 ¦ model.normal_force ¦ kind: block_on_spring ¦ ball_balancer
block_on_spring ¦  ¦ sweep: [{grid: {normal_force: [newton]}}]\n ¦ 6 ¦ sweep[0].grid.normal_force[0] ¦ newton ¦ a force, such as 10 N
ball_balancer ¦  ¦ sweep: [{grid: {mass_kg: [1]}}]\n ¦ 6 ¦ sweep[0].grid.mass_kg ¦ mass_kg ¦ ball_mass_kg
# Missing keys of a law, and speeds in the unit of the other kind of model.
block_on_belt ¦   friction: {stribeck: {static_friction_coefficient: 0.3}}\n ¦  ¦ 6 ¦ model.friction.stribeck ¦ no such key ¦ stribeck_speed_m_s
ball_balancer ¦   friction: {stribeck: {static_friction_coefficient: 0.3}}\n ¦  ¦ 6 ¦ model.friction.stribeck ¦ no such key ¦ stribeck_speed_rad_s
block_on_belt ¦   friction: {stribeck: {stribeck_speed_m_s: 0}}\n ¦  ¦ 6 ¦ model.friction.stribeck.static_friction_coefficient ¦ no such key ¦ static
block_on_belt ¦   friction: {smooth: {}}\n ¦  ¦ 6 ¦ model.friction.smooth ¦ no such key ¦ smoothing_speed_m_s
block_on_belt ¦   friction: {viscous: {}}\n ¦  ¦ 6 ¦ model.friction.viscous.viscous_coefficient_n_s_m ¦ no such key ¦ viscous_coefficient_n_s_m
ball_balancer ¦   friction: {coulomb_viscous: {}}\n ¦  ¦ 6 ¦ model.friction.coulomb_viscous.viscous_coefficient_n_s_m ¦ no such key ¦ viscous_coefficient_n_s_m
block_on_belt ¦   friction: {smooth: {smoothing_speed_rad_s: 1}}\n ¦  ¦ 6 ¦ model.friction.smooth.smoothing_speed_rad_s ¦ smoothing_speed_rad_s ¦ smoothing_speed_m_s
ball_balancer ¦   friction: {stribeck: {static_friction_coefficient: 1, stribeck_speed_m_s: 1}}\n ¦  ¦ 6 ¦ model.friction.stribeck.stribeck_speed_m_s ¦ stribeck_speed_m_s ¦ stribeck_speed_rad_s
# Values of a law.
block_on_belt ¦   friction: {stribeck: {static_friction_coefficient: 0.3, stribeck_speed_m_s: -1}}\n ¦  ¦ 6 ¦ model.friction.stribeck.stribeck_speed_m_s ¦ -1 ¦ at least 0
block_on_belt ¦   friction: {smooth: {smoothing_speed_m_s: 0}}\n ¦  ¦ 6 ¦ model.friction.smooth.smoothing_speed_m_s ¦ 0 ¦ a number above 0
block_on_belt ¦   friction: {viscous: {viscous_coefficient_n_s_m: -2}}\n ¦  ¦ 6 ¦ model.friction.viscous.viscous_coefficient_n_s_m ¦ -2 ¦ at least 0
ball_balancer ¦   friction: {coulomb_viscous: {viscous_coefficient_n_s_m: -2}}\n ¦  ¦ 6 ¦ model.friction.coulomb_viscous.viscous_coefficient_n_s_m ¦ -2 ¦ at least 0
block_on_belt ¦   friction: {stribeck: {static_friction_coefficient: 0.05, stribeck_speed_m_s: 1}}\n ¦  ¦ 6 ¦ model.friction.stribeck.static_friction_coefficient ¦ 0.05 ¦ not below the friction coefficient
# With a parameter that the law does not use, all points would be equal.
block_on_spring ¦   friction: {viscous: {viscous_coefficient_n_s_m: 2}}\n ¦ sweep: [{grid: {friction_coefficient: [0.1, 0.2]}}]\n ¦ 7 ¦ sweep[0].grid.friction_coefficient ¦ friction_coefficient ¦ viscous_coefficient_n_s_m
block_on_spring ¦   friction: {viscous: {viscous_coefficient_n_s_m: 2}}\n ¦ uncertain: {friction_coefficient: {uniform: {min: 0.1, max: 0.2}}}\n ¦ 7 ¦ uncertain.friction_coefficient ¦ friction_coefficient ¦ viscous_coefficient_n_s_m
# A static coefficient below the kinetic one is refused, wherever in a sweep the two meet, also for one ball.
STRIBECK ¦  ¦ sweep: [{grid: {static_friction_coefficient: [0.2, 0.05]}}]\n ¦ 7 ¦ sweep[0].grid.static_friction_coefficient[1] ¦ 0.05 ¦ not below the friction coefficient
STRIBECK ¦  ¦ sweep: [{grid: {friction_coefficient: [0, 0.1, 0.4]}}]\n ¦ 7 ¦ sweep[0].grid.friction_coefficient[2] ¦ friction_coefficient 0.4 ¦ not below the friction coefficient
STRIBECK ¦  ¦ sweep: [{grid: {friction_coefficient: [0.1, 0.25], static_friction_coefficient: [0.2, 0.3]}}]\n ¦ 7 ¦ sweep[0].grid.static_friction_coefficient[0] ¦ static_friction_coefficient 0.2 at point 2 (friction_coefficient 0.25, static ¦ not below
STRIBECK ¦  ¦ sweep: [{zip: {friction_coefficient: [0.1, 0.25], static_friction_coefficient: [0.2, 0.2]}}]\n ¦ 7 ¦ sweep[0].zip.static_friction_coefficient[1] ¦ 0.2 ¦ not below the friction coefficient
STRIBECK ¦  ¦ sweep: [{table: {columns: [static_friction_coefficient], rows: [[0.2], [0.01]]}}]\n ¦ 7 ¦ sweep[0].table ¦ 0.01 at point 1 ¦ not below the friction coefficient
ball_balancer ¦   friction: {stribeck: {static_friction_coefficient: 0.003, stribeck_speed_rad_s: 1}}\n ¦ sweep: [{grid: {friction_coefficient_2: [0.003, 0.004]}}]\n ¦ 7 ¦ sweep[0].grid.friction_coefficient_2[1] ¦ friction_coefficient_2 0.004 ¦ not below";

#[test]
fn wrong_models_are_refused() {
    for [kind, model, rest, line, key, found, allowed] in cases(WRONG) {
        let model = match kind.as_str() {
            "STRIBECK" => format!("  kind: block_on_belt\n{STRIBECK}"),
            kind => format!("  kind: {kind}\n{model}"),
        };
        refused(&text(&model, &rest), line.parse().expect("a line"), &key, &found, &allowed);
    }
}

/// Pairs of a static and a kinetic coefficient that do not meet, or are sampled, are no error of the study.
#[test]
fn coefficients_that_do_not_meet_are_accepted() {
    let model = format!("  kind: block_on_belt\n{STRIBECK}");
    let both = "friction_coefficient: [0.1, 0.25], static_friction_coefficient: [0.2, 0.3]";
    let zip = text(&model, &format!("sweep: [{{zip: {{{both}}}}}]\n"));
    assert_eq!(study(&zip).point_count(), 2);
    let drawn = text(
        &model,
        "sweep: [{grid: {static_friction_coefficient: [0.05, 0.5]}}]\n\
         uncertain: {friction_coefficient: {uniform: {min: 0, max: 0.1}}}\n",
    );
    let drawn = study(&drawn);
    assert!((3..6).all(|run| drawn.planned_run(run).case.is_ok()));
}
