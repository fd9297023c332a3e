//! A sweep over the number of balls: each point has the runs of a study with its number of balls.

use stickslip::study::PlannedRun;

use super::{parse, says, study, swept_numbers, text_with_design};
use crate::support::cases;

/// A study of this design with a number of balls in the study file, and further lines.
fn text(design: &str, balls: &str, rest: &str) -> String {
    let kind = "model: {kind: ball_balancer}";
    let model = format!("model: {{kind: ball_balancer, parameters: {{balls: {balls}}}}}");
    format!("{}{rest}", text_with_design(design)).replace(kind, &model)
}

/// Returns a run without the numbers that depend on the other points of its study.
fn unnumbered(run: PlannedRun) -> PlannedRun {
    PlannedRun { run_id: 0, point_id: 0, swept: Vec::new(), ..run }
}

/// Checks that run numbers are consecutive and that every point of [`SWEEP`] has the runs of the study with its number of
/// balls, these keys of the model, and these further lines.
#[track_caller]
fn has_runs_of_separate_studies(design: &str, keys: &str, rest: &str) {
    let kind = "kind: ball_balancer, ";
    let with = |balls: &str, rest: &str| {
        study(&text(design, balls, rest).replace(kind, &format!("{kind}{keys}")))
    };
    let swept = with("2", &format!("{SWEEP}{rest}"));
    let number_at = [3, 1, 2];
    let found: Vec<usize> =
        (0..swept.point_count()).map(|point| swept.point(point).model().balls()).collect();
    assert_eq!(found, number_at);
    let mut next = 0;
    for (id, number) in (0..).zip(number_at) {
        let point = swept.point(id);
        let separate = with(&number.to_string(), rest);
        assert_eq!(point.model(), separate.point(0).model());
        assert_eq!(point.first_run, next);
        assert_eq!(point.sampling, separate.point(0).sampling, "{design}");
        assert_eq!(point.cells, separate.point(0).cells);
        for sample in 0..point.sampling.most {
            let run = swept.planned_run(next);
            assert_eq!((run.run_id, run.point_id), (next, id));
            assert_eq!(run.swept, point.swept);
            assert_eq!(
                unnumbered(run),
                unnumbered(separate.planned_run(sample)),
                "{design}: {sample}"
            );
            next += 1;
        }
    }
    assert_eq!(swept.run_count(), next);
    assert_eq!(study(&swept.resolved_yaml()).hash(), swept.hash());
}

const SWEEP: &str = "sweep: [{grid: {balls: [3, 1, 2]}}]\n";
const UNCERTAIN: &str = "uncertain:
  ball_mass_kg: {normal: {mean: 1.4e-4, std_dev: 2.0e-5}}
  friction_coefficient_1: {times: {uniform: {min: 0.5, max: 2}}}
";

#[test]
fn each_point_has_the_runs_of_a_study_with_its_number_of_balls() {
    let designs = [
        "{stratified: {parts_per_axis: 2, samples_per_cell: 2}}",
        "{grid: {points_per_axis: 2}}",
        "{latin_hypercube: {samples: 7}}",
        "{sobol: {samples: 8}}",
        "{monte_carlo: {samples: 5}}",
    ];
    for design in designs {
        has_runs_of_separate_studies(design, "", "");
        has_runs_of_separate_studies(design, "", UNCERTAIN);
    }
}

#[test]
fn uncertain_parameters_are_sampled_as_in_a_separate_study() {
    for (design, sampling) in [
        ("{sobol: {samples: 8}}", "joint"),
        ("{latin_hypercube: {samples: 7}}", "joint"),
        ("{stratified: {parts_per_axis: 2, samples_per_cell: 1}}", "latin_hypercube"),
        ("{stratified: {parts_per_axis: 2, samples_per_cell: 1}}", "sobol"),
    ] {
        let rest = format!("{UNCERTAIN}uncertain_sampling: {{design: {sampling}}}\n");
        has_runs_of_separate_studies(design, "", &rest);
    }
}

/// Precision reserves different numbers of runs; contact maps the start angles.
#[test]
fn with_precision_contact_and_a_speed_profile() {
    let design = "{stratified: {parts_per_axis: 2, samples_per_cell: 1}}";
    let precision = "precision: {equilibrium_fraction: 0.1, max_runs: 1000}\n";
    has_runs_of_separate_studies(design, "", precision);
    for keys in [
        "contact: {restitution: 0.36, friction_coefficient: 0.1}, ",
        "protocol: {startup_and_hammer: {hits: 2}}, ",
    ] {
        has_runs_of_separate_studies(design, keys, "");
    }
}

#[test]
fn given_start_states_have_the_coordinates_of_their_balls() {
    let three = "{table: {columns: [beta_3, x, y, beta_1, beta_2, x_dot, y_dot, beta_dot_1, beta_dot_3, beta_dot_2], \
                 rows: [[3, 0.01, 0.02, 1, 2, 0.03, 0.04, 0.1, 0.3, 0.2], [6, 0, 0, 4, 5, 0, 0, 0, 0, 0]]}}";
    let swept = study(&text(three, "2", SWEEP));
    assert_eq!(swept.run_count(), 6);
    let start = |run| swept.planned_run(run).start.0;
    assert_eq!(start(0), [0.01, 0.02, 1.0, 2.0, 3.0, 0.03, 0.04, 0.1, 0.2, 0.3]);
    assert_eq!(start(2), [0.01, 0.02, 1.0, 0.03, 0.04, 0.1]);
    assert_eq!(start(4), [0.01, 0.02, 1.0, 2.0, 0.03, 0.04, 0.1, 0.2]);
    // A block with a design of its own needs only the coordinates of its own balls.
    let of_ball =
        "{table: {columns: [x, y, beta_1, x_dot, y_dot, beta_dot_1], rows: [[0, 0, 5, 0, 0, 0]]}}";
    let blocks = format!(
        "sweep:\n  - {{zip: {{balls: [1]}}, design: {of_ball}}}\n  - {{zip: {{balls: [3]}}}}\n"
    );
    let swept = study(&text(three, "2", &blocks));
    let runs: Vec<usize> = (0..3).map(|run| swept.planned_run(run).start.0.len()).collect();
    assert_eq!(runs, [6, 10, 10]);
}

/// Grids in any order of their keys, zips and tables; a block that does not sweep the number has that of the file.
#[test]
fn the_number_of_balls_is_swept_like_any_parameter() {
    let design = "{stratified: {parts_per_axis: 2, samples_per_cell: 1}}";
    let sweep = "sweep:
  - grid: {speed_rad_s: [-100, -200], balls: [1, 4, 4], damping_n_s_m: [1, 2]}
  - zip: {balls: [3, 3, 1], stiffness_n_m: [100, 200, 300]}
  - table: {columns: [friction_coefficient, balls], rows: [[0.1, 2], [0.2, 1]]}
  - grid: {speed_rad_s: [-300, -400]}
";
    let swept = study(&text(design, "2", sweep));
    let names: Vec<&str> = swept.swept().iter().map(|column| column.name.as_str()).collect();
    let columns =
        ["speed_rad_s", "balls", "damping_n_s_m", "stiffness_n_m", "friction_coefficient"];
    assert_eq!(names, columns);
    let unit = &swept.swept()[1];
    assert_eq!((unit.unit, unit.meaning.as_str()), ("1", "number of balls"));
    let of_grid = [1, 1, 4, 4, 4, 4].repeat(2);
    let expected: Vec<usize> =
        of_grid.into_iter().chain([3, 3, 1]).chain([2, 1]).chain([2, 2]).collect();
    let mut next = 0;
    for (id, number) in (0..).zip(&expected) {
        let point = swept.point(id);
        assert_eq!((point.model().balls(), point.first_run), (*number, next), "point {id}");
        assert_eq!(swept_numbers(&swept, id)[1], *number as f64);
        let runs = 1_u64 << (4 + 2 * number);
        assert_eq!((point.sampling.most, point.cells), (runs, Some(runs)));
        for run in [next, next + runs - 1] {
            assert_eq!(swept.planned_run(run).point_id, id);
        }
        next += runs;
    }
    assert_eq!((swept.point_count(), swept.run_count()), (expected.len() as u64, next));
    assert_eq!(swept_numbers(&swept, 3), [-100.0, 4.0, 2.0, 1.07e4, 2.75e-3]);
    assert_eq!(swept_numbers(&swept, 14), [-216.3772, 1.0, 1.28, 300.0, 2.75e-3]);
    assert_eq!(swept_numbers(&swept, 17), [-300.0, 2.0, 1.28, 1.07e4, 2.75e-3]);
    assert_eq!((swept.model().balls(), swept.numbers_of_balls()), (4, 1..=4));
    let ranges: Vec<u64> =
        swept.point_ranges().flat_map(|(points, runs)| points.map(move |_| runs)).collect();
    let runs_of: Vec<u64> = expected.iter().map(|number| 1_u64 << (4 + 2 * number)).collect();
    assert_eq!(ranges, runs_of);
}

/// The file's number of balls is not that of any point, so that no point has ball 2.
#[test]
fn expectations_select_numbers_of_balls() {
    let rest = "sweep: [{grid: {balls: [1, 3]}}]
expect: [{point: {balls: 3}, equilibrium_fraction: [0, 1]}]
";
    let swept = study(&text("{monte_carlo: {samples: 2}}", "2", rest));
    let expectation = &swept.expectations()[0];
    let selected = (0..2).filter(|id| expectation.selects(swept.swept(), &swept.point(*id).swept));
    assert_eq!(selected.collect::<Vec<u64>>(), [1]);
}

#[test]
fn a_design_sets_other_parameters_at_all_numbers_of_balls() {
    let rest = "sweep: [{grid: {balls: [1, 3]}}]
design: {ball_mass_kg: {from: 1.0e-4, to: 2.0e-4}}
";
    let swept = study(&text("{monte_carlo: {samples: 2}}", "2", rest));
    let value = stickslip::study::DesignValue::Number(1.5e-4);
    let design = swept.set(&[value]).expect("possible values");
    for (point, number) in [(0, 1), (1, 3)] {
        let machine = super::machine_at(&design, point);
        assert_eq!(machine.balls.len(), number);
        assert!(machine.balls.iter().all(|ball| ball.mass_kg == 1.5e-4));
    }
}

/// The balls of a study and its further lines, the key of the message, its problem, what it found, and what it allows.
const WRONG: &str = r#"2 ¦ sweep: [{grid: {balls: [two]}}] ¦ sweep[0].grid.balls[0] ¦ not a number ¦ text "two" ¦ a number
# A list of balls does not go with a sweep over their number.
[{mass_kg: 1.4e-4}, {mass_kg: 2.0e-4}] ¦ sweep: [{grid: {balls: [1, 2]}}] ¦ sweep[0].grid.balls ¦ balls have their own values ¦ a list of balls ¦ model.parameters.balls
# Parameters of balls that some points lack; the second block of the last study has two balls.
2 ¦ sweep: [{grid: {balls: [2, 4]}}]\nuncertain: {ball_mass_3_kg: {uniform: {min: 1.0e-4, max: 2.0e-4}}} ¦ uncertain.ball_mass_3_kg ¦ some points do not have this ball ¦ no ball 3 ¦ every point has, 1 to 2
2 ¦ sweep: [{grid: {balls: [2, 4]}}]\ndesign: {ball_mass_3_kg: {from: 1.0e-4, to: 2.0e-4}} ¦ design.ball_mass_3_kg ¦ some points do not have this ball ¦ no ball 3 ¦ every point has, 1 to 2
2 ¦ sweep: [{grid: {balls: [2, 4], ball_mass_3_kg: [1.0e-4]}}] ¦ sweep[0].grid.ball_mass_3_kg ¦ some points do not have this ball ¦ no ball 3 ¦ every point has, 1 to 2
2 ¦ sweep: [{grid: {balls: [4], ball_mass_3_kg: [1.0e-4]}}, {grid: {speed_rad_s: [-160]}}] ¦ sweep[0].grid.ball_mass_3_kg ¦ some points do not have this ball ¦ no ball 3 ¦ every point has, 1 to 2
# The number of balls has one origin.
2 ¦ sweep: [{grid: {balls: [1, 2]}}]\ndesign: {balls: {from: 1, to: 3}} ¦ design.balls ¦ varied twice ¦ balls here and balls in `sweep` ¦ `design` or in `sweep`
2 ¦ sweep: [{grid: {balls: [1, 2]}}]\nidentify: {parameters: {friction_coefficient: {from: 1.0e-4, to: 1.0e-2}}} ¦ identify ¦ a sweep over the number of balls ¦ `sweep` ¦ a sweep without `balls`"#;

#[test]
fn wrong_numbers_of_balls_are_refused() {
    let impossible = ["0", "9", "2.5", "-1"].into_iter().flat_map(|number| {
        [
            (format!("grid: {{balls: [1, {number}]}}"), "grid.balls[1]"),
            (format!("zip: {{balls: [1, {number}]}}"), "zip.balls[1]"),
            (format!("table: {{columns: [balls], rows: [[1], [{number}]]}}"), "table.rows[1][0]"),
        ]
        .map(|(block, key)| {
            let (sweep, key) = (format!("sweep: [{{{block}}}]"), format!("sweep[0].{key}"));
            let words = ["not a number of balls", number, "a whole number from 1 to 8"];
            let [problem, found, allowed] = words.map(str::to_owned);
            ["2".to_owned(), sweep, key, problem, found, allowed]
        })
    });
    for [balls, rest, key, problem, found, allowed] in cases(WRONG).chain(impossible) {
        let text = text("{monte_carlo: {samples: 2}}", &balls, &format!("{rest}\n"));
        let error = parse(&text).expect_err(&rest);
        assert!(error.problem().contains(&problem), "{error}");
        says(&error, &found, &allowed);
        assert_eq!((error.key(), error.line().is_some()), (key.as_str(), true), "{error}");
    }
    let block = "schema: 1\nname: a\nseed: 5\nmodel: {kind: block_on_spring}\n\
                 initial_conditions: {design: {monte_carlo: {samples: 2}}}\n\
                 sweep: [{grid: {balls: [1]}}]\n";
    let error = parse(block).expect_err("a block has no balls");
    assert!(error.problem().contains("not a parameter of block_on_spring"), "{error}");
}

#[test]
fn a_range_of_a_ball_that_all_points_lack_is_refused() {
    let text = text("{monte_carlo: {samples: 2}}", "3", "sweep: [{grid: {balls: [1, 2]}}]\n");
    let text =
        text.replace("initial_conditions:\n", "initial_conditions:\n  box: {beta_3: [0, 1]}\n");
    let error = parse(&text).expect_err("no point has three balls");
    assert_eq!((error.key(), error.line()), ("initial_conditions.box.beta_3", Some(6)), "{error}");
    // All points have balls 1 and 2; some points have ball 3.
    let swept = study(&text.replace("balls: [1, 2]", "balls: [2, 3]"));
    assert!(swept.planned_run(2).start.0[4] <= 1.0 && swept.planned_run(0).start.0.len() == 8);
}

/// Numbers that overflow, and many points of different numbers of balls, are found at once.
#[test]
fn many_points_have_numbers_at_once() {
    let design = "{stratified: {parts_per_axis: 2, samples_per_cell: 1}}";
    let sweep = "sweep: [{grid: {speed_rad_s: {from: -1000, to: -1, count: 100000}, balls: [1, 2], \
                 damping_n_s_m: {from: 1, to: 2, count: 1000}}}]\n";
    let swept = study(&text(design, "2", sweep));
    let (points, pair) = (200_000_000, 1000 * (64 + 256));
    assert_eq!((swept.point_count(), swept.run_count()), (points, 100_000 * pair));
    let last = swept.planned_run(swept.run_count() - 1);
    assert_eq!((last.point_id, last.cell), (points - 1, 255));
    let first_of_two = swept.planned_run(77 * pair + 1000 * 64);
    assert_eq!((first_of_two.point_id, first_of_two.cell), (77 * 2000 + 1000, 0));
    let text = text("{stratified: {parts_per_axis: 10, samples_per_cell: 1}}", "2", sweep);
    let error = parse(&text).expect_err("10^8 runs at 10^8 points");
    assert!(error.problem().contains("too many runs"), "{error}");
    says(&error, "samples at each: at most 100000000", "");
}
