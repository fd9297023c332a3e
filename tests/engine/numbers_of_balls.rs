//! A sweep over the number of balls gives the rows of separate studies.

use arrow::array::{Array, RecordBatch};

use crate::cli::support::{Scratch, assert_has, column, numbers, row, study_text};

const SWEEP: &str = "sweep: [{grid: {speed_rad_s: [-160.8103, -216.3772], balls: [3, 1, 2]}}]\n";

fn study(design: &str, rest: &str) -> String {
    study_text("a", design, 2.0, &format!("{SWEEP}{rest}"))
}

/// Returns the rows of a table at a point, as text by column, without columns that number or name the point.
fn rows_at(table: &RecordBatch, point: u64) -> Vec<Vec<(String, String)>> {
    let all = (0..table.num_rows())
        .filter(|&index| crate::cli::support::counts(table, "point_id")[index] == point);
    let without = ["run_id", "point_id", "balls", "speed_rad_s"];
    let kept = |index| {
        let cells = row(table, index, &without).into_iter();
        cells.filter(|(_, value)| value != "null").collect()
    };
    all.map(kept).collect()
}

/// Every value of a point is that of the study with this number of balls; columns of other balls are null.
#[test]
fn tables_have_the_rows_of_separate_studies() {
    let scratch = Scratch::new();
    let design = "{latin_hypercube: {samples: 9}}";
    let model = "model: {kind: ball_balancer, contact: {restitution: 0.36, friction_coefficient: 0.1}, \
                 protocol: startup}\n";
    for (name, model) in [("free", "model: {kind: ball_balancer}\n"), ("contact", model)] {
        let sweep = study(design, model);
        scratch.write("sweep.yaml", sweep);
        scratch.well(&format!("run sweep.yaml --out {name} --threads 2"));
        for (point, speed, balls) in
            [(0, -160.8103, 3), (1, -160.8103, 1), (2, -160.8103, 2), (4, -216.3772, 1)]
        {
            let parameters = format!("parameters: {{balls: {balls}, speed_rad_s: {speed}}}");
            let model =
                model.replace("kind: ball_balancer", &format!("kind: ball_balancer, {parameters}"));
            scratch.write("one.yaml", study_text("a", design, 2.0, &model));
            let out = format!("{name}-{point}");
            scratch.well(&format!("run one.yaml --out {out}"));
            let mut tables = vec!["runs", "points", "equilibria", "cycles", "time_to_rest"];
            if !model.contains("startup") {
                tables.push("equilibrium_histogram");
            } else {
                tables.push("stages");
            }
            for table in tables {
                let whole = scratch.table(name, table);
                let separate = scratch.table(&out, table);
                let (found, expected) = (rows_at(&whole, point), rows_at(&separate, 0));
                let found =
                    if table == "equilibrium_histogram" { without_ball(found) } else { found };
                assert_eq!(found, without_ball(expected), "{table} of point {point}, {name}");
            }
        }
    }
}

/// Removes the column `ball`, which a study with one or two balls does not have.
fn without_ball(rows: Vec<Vec<(String, String)>>) -> Vec<Vec<(String, String)>> {
    let kept = |row: Vec<(String, String)>| row.into_iter().filter(|(name, _)| name != "ball");
    rows.into_iter().map(|row| kept(row).collect()).collect()
}

#[test]
fn columns_of_balls_that_a_point_lacks_are_null() {
    let scratch = Scratch::ran(study("{monte_carlo: {samples: 3}}", ""));
    let runs = scratch.table("out", "runs");
    let balls = numbers(&runs, "balls");
    for (name, ball) in [
        ("initial_beta_1", 1.0),
        ("initial_beta_3", 3.0),
        ("initial_beta_dot_2", 2.0),
        ("initial_x_dot", 1.0),
        ("initial_beta_dot_3", 3.0),
        ("beta_2_rad", 2.0),
        ("beta_3_rad", 3.0),
        ("ball_speed_3_rad_s", 3.0),
    ] {
        let column = column(&runs, name);
        for (index, balls) in balls.iter().enumerate() {
            let has = balls.is_some_and(|balls| balls >= ball);
            assert_eq!(column.is_valid(index), has, "{name} in row {index}");
        }
    }
    column(&scratch.table("out", "equilibria"), "beta_3_rad");
}

/// The runs of a study with one number of balls are those of a point of the sweep, so that they are not computed again.
#[test]
fn runs_of_one_number_of_balls_are_reused() {
    let design = "{stratified: {parts_per_axis: 2, samples_per_cell: 1}}";
    let scratch = Scratch::ran(study_text("a", design, 0.1, ""));
    let sweep = study_text("a", design, 0.1, "sweep: [{grid: {balls: [1, 2]}}]\n");
    scratch.write("a.yaml", sweep);
    let ended = scratch.stickslip("run a.yaml --out out");
    assert_has(&ended.err, &["256 finished earlier, 64 computed"]);
}

#[test]
fn commands_serve_a_sweep_over_the_number_of_balls() {
    let scratch = Scratch::with(study("{monte_carlo: {samples: 4}}", ""));
    let text = scratch.well("check a.yaml");
    assert_has(&text, &["ball_balancer with 1 to 3 balls", "swept, 3 values"]);
    let check = scratch.json("check a.yaml --json --existence");
    assert_eq!((&check["balls"], &check["runs"]), (&3.into(), &24.into()));
    scratch.well("run a.yaml --out out");
    scratch.well("report out --out report.html");
    assert_has(&scratch.text("report.html"), &["Preferred equilibria", "One ball: its angle"]);
    for run in [0, 5, 9] {
        scratch.well(&format!("replay out {run} --out replay-{run}"));
    }
    scratch.well("summary out");
    let text = scratch.well("equilibria a.yaml --grid 64 --samples 16384 --out sets");
    assert_has(&text, &["95 % interval", "components"]);
    let positions = scratch.table("sets", "equilibrium_positions");
    let (third, balls) = (column(&positions, "beta_3_rad"), numbers(&positions, "balls"));
    for index in [0, positions.num_rows() / 2 - 1, positions.num_rows() - 1] {
        assert_eq!(third.is_valid(index), balls[index] == Some(3.0));
    }
    scratch.refused("equilibria a.yaml --grid 64 --samples 7 --out no", &["a power of two"]);
}

/// The cost of a sweep is the sum of the costs of separate studies, whose runs differ in number and length.
#[test]
fn a_sweep_costs_as_much_as_separate_studies() {
    let design = "{stratified: {parts_per_axis: 2, samples_per_cell: 1}}";
    let cost = |text: &str| {
        let scratch = Scratch::with(text);
        let check = scratch.json("check a.yaml --json");
        ["runs", "steps", "core_seconds", "most_steps", "most_core_seconds"]
            .map(|key| check[key].as_f64().unwrap())
    };
    let sweep = cost(&study_text("a", design, 2.0, "sweep: [{grid: {balls: [3, 1]}}]\n"));
    let [one, three] = [1, 3].map(|balls| {
        let model = format!("model: {{kind: ball_balancer, parameters: {{balls: {balls}}}}}\n");
        cost(&study_text("a", design, 2.0, &model))
    });
    for ((sweep, one), three) in sweep.into_iter().zip(one).zip(three) {
        assert!((sweep - (one + three)).abs() <= 1e-12 * sweep, "{sweep} {one} {three}");
    }
}

/// A sweep over the number of balls that is stopped and resumed writes the same files as one that is not stopped.
#[test]
fn a_stopped_sweep_goes_on() {
    let text = study("{monte_carlo: {samples: 16}}", "").replace("[3, 1, 2]", "[2, 1]");
    let scratch = Scratch::with(text);
    scratch.well("run a.yaml --out whole");
    let stopped = scratch.stickslip("run a.yaml --out stopped --chunk 5 --max-seconds 0.05");
    assert!([Some(130), Some(0)].contains(&stopped.code), "{}", stopped.err);
    scratch.stickslip("resume stopped --threads 2");
    assert_eq!(scratch.data("stopped"), scratch.data("whole"));
}

/// Each point of a design has its own row, with the response of the study with its number of balls.
#[test]
fn designs_have_a_response_for_each_number_of_balls() {
    let rest = "design: {friction_coefficient: {from: 1.0e-3, to: 4.0e-3}}\n\
                responses: {vibration: {amplitude_mean: {relative: true}}}\n";
    let design = "{sobol: {samples: 8}}";
    let answers = |more: &str| {
        let scratch = Scratch::with(study_text("a", design, 2.0, &format!("{more}{rest}")));
        scratch.write("designs.csv", "friction_coefficient\n0.002\n0.003\n");
        scratch.well("evaluate a.yaml --designs designs.csv --out answers.parquet");
        numbers(&scratch.table(".", "answers"), "vibration")
    };
    let sweep = answers("sweep: [{grid: {balls: [1, 3]}}]\n");
    let [one, three] = [1, 3].map(|balls| {
        let model = format!("model: {{kind: ball_balancer, parameters: {{balls: {balls}}}}}\n");
        answers(&model)
    });
    assert_eq!(sweep, [one[0], three[0], one[1], three[1]]);
    assert!(sweep.iter().all(Option::is_some));
}
