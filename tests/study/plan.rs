//! Points and runs by their numbers.

use std::time::Instant;

use super::{machine_at, study, swept_numbers, text_with_design, with_design};

const SMALL: &str = "{monte_carlo: {samples: 4}}";

#[test]
fn without_a_sweep_there_is_one_point() {
    let study = with_design(SMALL, "");
    assert_eq!((study.point_count(), study.run_count(), study.model().balls()), (1, 4, 2));
    assert!(study.swept().is_empty() && study.point(0).swept.is_empty());
    let case = study.planned_run(3).case.unwrap();
    assert_eq!(case.model, *study.model());
    assert_eq!(case.simulation, *study.simulation());
}

#[test]
fn grids_run_through_their_last_key_first_and_blocks_follow_one_another() {
    let study = with_design(
        SMALL,
        "sweep:
  - grid: {speed_rad_s: [-1, -2], damping_n_s_m: [1, 2, 3]}
  - zip: {damping_n_s_m: [7, 8], stiffness_n_m: [100, 200]}
    design: {monte_carlo: {samples: 2}}
  - table: {columns: [speed_rad_s], rows: [[-9]]}
",
    );
    let names: Vec<&str> = study.swept().iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["speed_rad_s", "damping_n_s_m", "stiffness_n_m"]);
    assert_eq!(study.swept()[2].unit, "N/m");
    assert_eq!((study.point_count(), study.run_count()), (9, 6 * 4 + 2 * 2 + 4));
    assert_eq!(swept_numbers(&study, 0), [-1.0, 1.0, 1.07e4]);
    assert_eq!(swept_numbers(&study, 1), [-1.0, 2.0, 1.07e4]);
    assert_eq!(swept_numbers(&study, 3), [-2.0, 1.0, 1.07e4]);
    assert_eq!(swept_numbers(&study, 7), [-216.3772, 8.0, 200.0]);
    assert_eq!(swept_numbers(&study, 8), [-9.0, 1.28, 1.07e4]);
    let mut next = 0;
    for id in 0..9 {
        let point = study.point(id);
        assert_eq!(point.first_run, next);
        for run in next..next + point.sampling.most {
            let planned = study.planned_run(run);
            assert_eq!((planned.run_id, planned.point_id), (run, id));
            assert_eq!(planned.swept, point.swept);
            assert_eq!(planned.case.unwrap().model, *point.model());
        }
        next += point.sampling.most;
    }
    assert_eq!(next, study.run_count());
}

#[test]
fn one_balls_value_is_set_after_that_of_all() {
    let study = with_design(
        SMALL,
        "sweep: [{grid: {friction_coefficient_2: [0.5], friction_coefficient: [0.1, 0.2]}},
  {grid: {friction_coefficient: [0.3]}}]\n",
    );
    let friction = |point| {
        let machine = machine_at(&study, point);
        machine.balls.iter().map(|ball| ball.friction_coefficient).collect::<Vec<_>>()
    };
    assert_eq!(friction(1), [0.2, 0.5]);
    // If a block sweeps only the value of all balls, one ball's column follows it.
    assert_eq!(friction(2), [0.3, 0.3]);
    assert_eq!(swept_numbers(&study, 2), [0.3, 0.3]);
}

#[test]
fn balls_may_differ() {
    let text = text_with_design(SMALL).replace(
        "{kind: ball_balancer}",
        "{kind: ball_balancer, parameters: {ball_mass_kg: 2, balls: [{}, {mass_kg: 3}, {}]}}",
    );
    let study = study(&format!("{text}sweep: [{{grid: {{ball_mass_3_kg: [4]}}}}]\n"));
    let masses: Vec<f64> = machine_at(&study, 0).balls.iter().map(|ball| ball.mass_kg).collect();
    assert_eq!(masses, [2.0, 3.0, 4.0]);
    assert_eq!(study.planned_run(0).start.0.len(), 10);
}

#[test]
fn a_draw_without_physical_meaning_is_a_run_without_a_case() {
    let rest = "uncertain: {imbalance_mass_kg: {normal: {mean: 0, std_dev: 1.0e-5}}}\n";
    let study = with_design("{monte_carlo: {samples: 100}}", rest);
    let runs: Vec<_> = (0..100).map(|run| study.planned_run(run)).collect();
    let failed = runs.iter().filter(|run| run.case.is_err()).count();
    assert!((25..75).contains(&failed), "{failed}");
    for run in runs {
        assert_eq!(run.case.is_err(), run.uncertain[0] <= 0.0);
        match run.case {
            Ok(case) => {
                assert_eq!(case.model.ball_balancer().unwrap().imbalance_mass_kg, run.uncertain[0]);
                assert_eq!(case.start, run.start);
            }
            Err(invalid) => assert_eq!(invalid.name, "imbalance_mass_kg"),
        }
    }
}

#[test]
fn enormous_studies_load_at_once_and_any_run_is_at_hand() {
    let clock = Instant::now();
    for design in ["monte_carlo", "latin_hypercube"] {
        for samples in [1_000_000, 1_000_000_000, 250_000_000_000_000_u64] {
            let design = format!("{{{design}: {{samples: {samples}}}}}");
            let rest = "sweep: [{grid: {speed_rad_s: [-1, -2, -3, -4]}}]\n";
            let study = with_design(&design, rest);
            assert_eq!(study.run_count(), 4 * samples);
            for run in [0, samples - 1, samples, 3 * samples + samples / 2, 4 * samples - 1] {
                let planned = study.planned_run(run);
                assert_eq!((planned.point_id, planned.replicate), (run / samples, run % samples));
            }
        }
    }
    let values: Vec<String> = (1..=1000).map(|value| value.to_string()).collect();
    let list = values.join(", ");
    let rest = format!(
        "sweep: [{{grid: {{stiffness_n_m: [{list}], damping_n_s_m: [{list}], \
         speed_rad_s: [{list}]}}}}]\nexpect: [{{point: {{damping_n_s_m: 77, speed_rad_s: 1000}}, \
         failed_fraction: [0, 0]}}]\n"
    );
    let study = with_design(SMALL, &rest);
    assert_eq!(study.point_count(), 1_000_000_000);
    assert_eq!(swept_numbers(&study, 123_456_789), [124.0, 457.0, 790.0]);
    assert!(clock.elapsed().as_secs_f64() < 5.0, "{:?}", clock.elapsed());
}

#[test]
fn expectations_select_points_by_value() {
    let study = with_design(
        SMALL,
        "sweep: [{grid: {speed_rad_s: [-1, -2], normal_force: [lagrange, newton]}}]
expect:
  - {point: {normal_force: newton, speed_rad_s: -2}, equilibrium_fraction: [0.25, 0.5]}
  - {limit_cycle_fraction: [0, 0.5], failed_fraction: [0, 0]}
",
    );
    let [first, second] = study.expectations() else { panic!() };
    let selected = |expectation: &stickslip::study::Expectation| {
        (0..4)
            .filter(|id| expectation.selects(study.swept(), &study.point(*id).swept))
            .collect::<Vec<u64>>()
    };
    assert_eq!((selected(first), selected(second)), (vec![3], vec![0, 1, 2, 3]));
    assert_eq!(first.fractions, [("equilibrium", [0.25, 0.5])]);
    assert_eq!(second.fractions, [("limit_cycle", [0.0, 0.5]), ("failed", [0.0, 0.0])]);
}
