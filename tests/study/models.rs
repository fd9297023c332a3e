//! Blocks and laws of friction in study files: the parameters of each model, defaults, round trips,
//! and errors.

use crate::support::{Block, Ground, cases};
use stickslip::model::Model;
use stickslip::study::{ParameterValue, Study};

use super::{parse, refused, study};

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
const SMOOTH: &str = "  friction: {smooth: {smoothing_speed_m_s: 0.01}}\n";
const VISCOUS: &str = "  friction: {viscous: {viscous_coefficient_n_s_m: 2}}\n";
const BOTH: &str = "  friction: {coulomb_viscous: {viscous_coefficient_n_s_m: 2}}\n";

fn block_at(study: &Study, point: u64) -> Block {
    Block::of(study.point(point).model()).expect("a block")
}

/// Every parameter of a block can be swept and sampled by its name, without affecting others.
#[test]
fn every_parameter_of_a_block_can_be_varied() {
    type Field = fn(&mut Block) -> &mut f64;
    fn law(block: &mut Block, index: usize) -> Option<&mut f64> {
        let name = block.friction.law().parameters().get(index)?.name;
        block.friction.value_mut(name)
    }
    fn belt(block: &mut Block) -> &mut f64 {
        match &mut block.ground {
            Ground::Belt { speed_m_s } => speed_m_s,
            Ground::Fixed => panic!("on rigid ground"),
        }
    }
    let spring = "  kind: block_on_spring\n";
    let on_belt = "  kind: block_on_belt\n";
    let first: Field = |block| law(block, 0).expect("a law with a value");
    let second: Field = |block| law(block, 1).expect("a law with two values");
    let cases: [(&str, &str, &str, &str, Field); 11] = [
        (spring, "", "mass_kg", "kg", |block| &mut block.mass_kg),
        (spring, "", "stiffness_n_m", "N/m", |block| &mut block.stiffness_n_m),
        (spring, "", "normal_force_n", "N", |block| &mut block.normal_force_n),
        (spring, "", "friction_coefficient", "1", |block| &mut block.friction_coefficient),
        (on_belt, "", "belt_speed_m_s", "m/s", belt),
        (on_belt, STRIBECK, "static_friction_coefficient", "1", first),
        (on_belt, STRIBECK, "stribeck_speed_m_s", "m/s", second),
        (spring, SMOOTH, "smoothing_speed_m_s", "m/s", first),
        (on_belt, VISCOUS, "viscous_coefficient_n_s_m", "N s/m", first),
        (on_belt, BOTH, "viscous_coefficient_n_s_m", "N s/m", first),
        (spring, BOTH, "friction_coefficient", "1", |block| &mut block.friction_coefficient),
    ];
    for (kind, friction, name, unit, field) in cases {
        let model = format!("{kind}{friction}");
        let base = block_at(&study(&text(&model, "")), 0);
        let swept = study(&text(&model, &format!("sweep: [{{grid: {{{name}: [0.7, 0.9]}}}}]\n")));
        assert_eq!((swept.swept()[0].name.as_str(), swept.swept()[0].unit), (name, unit));
        for (point, value) in [(0, 0.7), (1, 0.9)] {
            let mut expected = base.clone();
            *field(&mut expected) = value;
            assert_eq!(block_at(&swept, point), expected, "{name}");
            assert_eq!(swept.point(point).swept, [ParameterValue::Number(value)]);
        }
        let range = format!("uncertain: {{{name}: {{uniform: {{min: 0.7, max: 0.9}}}}}}\n");
        let drawn = study(&text(&model, &range));
        let run = drawn.planned_run(2);
        assert!((0.7..0.9).contains(&run.uncertain[0]), "{name}");
        let mut expected = base;
        *field(&mut expected) = run.uncertain[0];
        assert_eq!(run.case.expect("valid").model, Model::from(expected), "{name}");
    }
}

/// The parameters of the laws can be varied for a ball balancer, with speeds in rad/s.
#[test]
fn laws_of_friction_of_balls_can_be_varied() {
    for [law, name, unit] in cases(
        "stribeck: {static_friction_coefficient: 0.01, stribeck_speed_rad_s: 1} ¦ static_friction_coefficient ¦ 1
stribeck: {static_friction_coefficient: 0.01, stribeck_speed_rad_s: 1} ¦ stribeck_speed_rad_s ¦ rad/s
smooth: {smoothing_speed_rad_s: 0.1} ¦ smoothing_speed_rad_s ¦ rad/s
viscous: {viscous_coefficient_n_s_m: 1e-4} ¦ viscous_coefficient_n_s_m ¦ N s/m
coulomb_viscous: {viscous_coefficient_n_s_m: 1e-4} ¦ viscous_coefficient_n_s_m ¦ N s/m",
    ) {
        let model = format!("  kind: ball_balancer\n  friction: {{{law}}}\n");
        let swept = study(&text(&model, &format!("sweep: [{{zip: {{{name}: [0.2, 0.4]}}}}]\n")));
        assert_eq!(swept.swept()[0].unit, unit);
        let of = |point| *swept.point(point).model().friction();
        assert_ne!(of(0), of(1));
        assert!(format!("{:?}", of(1)).contains("0.4"), "{:?}", of(1));
    }
}

/// Each model with each law resolves to a complete text that is the same study.
#[test]
fn every_model_and_law_resolves_to_itself() {
    for (kind, unit) in
        [("block_on_spring", "m_s"), ("block_on_belt", "m_s"), ("ball_balancer", "rad_s")]
    {
        for law in [
            "coulomb".to_owned(),
            format!("{{stribeck: {{static_friction_coefficient: 0.3, stribeck_speed_{unit}: 0}}}}"),
            format!("{{smooth: {{smoothing_speed_{unit}: 1.0e-3}}}}"),
            "{viscous: {viscous_coefficient_n_s_m: 0.25}}".to_owned(),
            "{coulomb_viscous: {viscous_coefficient_n_s_m: 0.25}}".to_owned(),
        ] {
            let first = study(&text(&format!("  kind: {kind}\n  friction: {law}\n"), ""));
            let written = first.resolved_yaml();
            let second = study(&written);
            assert_eq!(second.resolved_yaml(), written);
            assert_eq!((second.hash(), second.model()), (first.hash(), first.model()));
            assert_eq!(first.model().kind().name, kind);
            assert!(
                written.contains(law.trim_matches(['{', '}']).split(':').next().expect("a name"))
            );
            for run in 0..first.run_count() {
                assert_eq!(second.planned_run(run), first.planned_run(run));
            }
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
    refused(&given("balls: 2"), 7, "model.parameters.balls", "block_on_spring", "ball_balancer");
    let text_of = |lines: &str| text(&format!("{spring}{lines}"), "");
    let newton = text_of("  normal_force: newton\n");
    refused(&newton, 6, "model.normal_force", "kind: block_on_spring", "ball_balancer");
    let swept = text(spring, "sweep:\n  - grid: {normal_force: [newton]}\n");
    refused(&swept, 7, "sweep[0].grid.normal_force[0]", "newton", "a force, such as 10 N");
    let ball = text("  kind: ball_balancer\n", "sweep:\n  - grid: {mass_kg: [1]}\n");
    refused(&ball, 7, "sweep[0].grid.mass_kg", "mass_kg", "ball_mass_kg");
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

#[test]
fn laws_of_friction_are_checked() {
    let block = |law: &str| text(&format!("  kind: block_on_belt\n  friction:\n    {law}\n"), "");
    let balls = |law: &str| text(&format!("  kind: ball_balancer\n  friction:\n    {law}\n"), "");
    let path = "model.friction";
    // Missing keys, and speeds in the unit of the other kind of model.
    let law = "stribeck: {static_friction_coefficient: 0.3}";
    refused(&block(law), 7, &format!("{path}.stribeck"), "no such key", "stribeck_speed_m_s");
    refused(&balls(law), 7, &format!("{path}.stribeck"), "no such key", "stribeck_speed_rad_s");
    let key = format!("{path}.stribeck.static_friction_coefficient");
    refused(&block("stribeck: {stribeck_speed_m_s: 0}"), 7, &key, "no such key", "static");
    refused(
        &block("smooth: {}"),
        7,
        &format!("{path}.smooth"),
        "no such key",
        "smoothing_speed_m_s",
    );
    let key = format!("{path}.viscous.viscous_coefficient_n_s_m");
    refused(&block("viscous: {}"), 7, &key, "no such key", "viscous_coefficient_n_s_m");
    let law = "smooth: {smoothing_speed_rad_s: 1}";
    let key = format!("{path}.smooth.smoothing_speed_rad_s");
    refused(&block(law), 7, &key, "smoothing_speed_rad_s", "smoothing_speed_m_s");
    let law = "stribeck: {static_friction_coefficient: 1, stribeck_speed_m_s: 1}";
    let key = format!("{path}.stribeck.stribeck_speed_m_s");
    refused(&balls(law), 7, &key, "stribeck_speed_m_s", "stribeck_speed_rad_s");
    // Invalid values.
    let law = "stribeck: {static_friction_coefficient: 0.3, stribeck_speed_m_s: -1}";
    refused(&block(law), 7, &key, "-1", "at least 0");
    let key = format!("{path}.smooth.smoothing_speed_m_s");
    refused(&block("smooth: {smoothing_speed_m_s: 0}"), 7, &key, "0", "a number above 0");
    let key = format!("{path}.viscous.viscous_coefficient_n_s_m");
    refused(&block("viscous: {viscous_coefficient_n_s_m: -2}"), 7, &key, "-2", "at least 0");
    let key = format!("{path}.coulomb_viscous.viscous_coefficient_n_s_m");
    for model in [&block, &balls] as [&dyn Fn(&str) -> String; 2] {
        let with = |keys: &str| model(&format!("coulomb_viscous: {keys}"));
        refused(&with("{viscous_coefficient_n_s_m: -2}"), 7, &key, "-2", "at least 0");
        refused(&with("{}"), 7, &key, "no such key", "viscous_coefficient_n_s_m");
    }
    let law = "stribeck: {static_friction_coefficient: 0.05, stribeck_speed_m_s: 1}";
    let key = format!("{path}.stribeck.static_friction_coefficient");
    refused(&block(law), 7, &key, "0.05", "not below the friction coefficient");
}

/// A static coefficient below the kinetic one is refused, wherever in a sweep the two meet.
#[test]
fn points_without_meaning_are_refused() {
    let model = format!("  kind: block_on_belt\n{STRIBECK}");
    let with = |sweep: &str| text(&model, &format!("sweep:\n  - {sweep}\n"));
    let allowed = "not below the friction coefficient";
    let key = "sweep[0].grid.static_friction_coefficient[1]";
    refused(&with("grid: {static_friction_coefficient: [0.2, 0.05]}"), 8, key, "0.05", allowed);
    let key = "sweep[0].grid.friction_coefficient[2]";
    refused(
        &with("grid: {friction_coefficient: [0, 0.1, 0.4]}"),
        8,
        key,
        "friction_coefficient 0.4",
        allowed,
    );
    let both = "friction_coefficient: [0.1, 0.25], static_friction_coefficient: [0.2, 0.3]";
    let key = "sweep[0].grid.static_friction_coefficient[0]";
    let found = "static_friction_coefficient 0.2 at point 2 (friction_coefficient 0.25, static";
    refused(&with(&format!("grid: {{{both}}}")), 8, key, found, allowed);
    assert_eq!(study(&with(&format!("zip: {{{both}}}"))).point_count(), 2);
    let key = "sweep[0].zip.static_friction_coefficient[1]";
    let zip = "zip: {friction_coefficient: [0.1, 0.25], static_friction_coefficient: [0.2, 0.2]}";
    refused(&with(zip), 8, key, "0.2", allowed);
    let table = "table: {columns: [static_friction_coefficient], rows: [[0.2], [0.01]]}";
    refused(&with(table), 8, "sweep[0].table", "0.01 at point 1", allowed);
    // One ball's own kinetic coefficient counts as well.
    let law = "stribeck: {static_friction_coefficient: 0.003, stribeck_speed_rad_s: 1}";
    let balls = text(
        &format!("  kind: ball_balancer\n  friction: {{{law}}}\n"),
        "sweep:\n  - grid: {friction_coefficient_2: [0.003, 0.004]}\n",
    );
    let key = "sweep[0].grid.friction_coefficient_2[1]";
    refused(&balls, 8, key, "friction_coefficient_2 0.004", allowed);
    // A sampled pair of this kind is a failed run, not an invalid study.
    let drawn = text(
        &model,
        "sweep: [{grid: {static_friction_coefficient: [0.05, 0.5]}}]\n\
         uncertain: {friction_coefficient: {uniform: {min: 0, max: 0.1}}}\n",
    );
    let drawn = study(&drawn);
    assert!((3..6).all(|run| drawn.planned_run(run).case.is_ok()));
}

/// Parameters that the law of friction does not use cannot be varied, because all points would be
/// equal.
#[test]
fn a_viscous_law_has_no_coefficient_to_vary() {
    let model = format!("  kind: block_on_spring\n{VISCOUS}");
    let sweep = "sweep: [{grid: {friction_coefficient: [0.1, 0.2]}}]\n";
    let key = "sweep[0].grid.friction_coefficient";
    refused(&text(&model, sweep), 7, key, "friction_coefficient", "viscous_coefficient_n_s_m");
    let drawn = "uncertain: {friction_coefficient: {uniform: {min: 0.1, max: 0.2}}}\n";
    let key = "uncertain.friction_coefficient";
    refused(&text(&model, drawn), 7, key, "friction_coefficient", "viscous_coefficient_n_s_m");
}
