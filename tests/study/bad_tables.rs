//! Invalid tables: file, row and column of each error.

use stickslip::study::{Study, StudyError};

fn load(rest: &str, design: &str, table: &[u8]) -> Result<Study, StudyError> {
    super::load_with("table.csv", table, rest, design)
}

fn sweep(table: &str) -> Result<Study, StudyError> {
    load("sweep: [{table: table.csv}]\n", "{monte_carlo: {samples: 10}}", table.as_bytes())
}

#[track_caller]
fn refused(table: &str, line: Option<usize>, key: &str, found: &str, allowed: &str) {
    let error = sweep(table).err().unwrap_or_else(|| panic!("accepted: {table}"));
    assert!(error.file().ends_with("table.csv"), "{error}");
    assert_eq!(error.line(), line, "{error}");
    assert_eq!(error.key(), key, "{error}");
    assert!(error.found().unwrap_or_default().contains(found), "{error}");
    assert!(error.allowed().unwrap_or_default().contains(allowed), "{error}");
}

#[test]
fn a_right_table_makes_points() {
    let table = "# designs\nspeed_rad_s, normal_force\n-160.5, newton\n\n-200, lagrange\n";
    let study = sweep(table).unwrap();
    assert_eq!((study.point_count(), study.run_count()), (2, 20));
    assert_eq!(super::machine_at(&study, 0).speed_rad_s, -160.5);
    let with_mark = sweep(&format!("\u{feff}{table}")).unwrap();
    assert_eq!(with_mark.hash(), study.hash());
}

#[test]
fn wrong_cells_are_named_by_row_and_column() {
    let column = "row 2, column speed_rad_s";
    refused("speed_rad_s\n-160\nfast\n", Some(3), column, "fast", "a number");
    refused("speed_rad_s\n-160\nNaN\n", Some(3), column, "NaN", "a finite number");
    refused("speed_rad_s\n-160\n1e999\n", Some(3), column, "1e999", "a finite number");
    refused("speed_rad_s,damping_n_s_m\n1,1\n,1\n", Some(3), column, "nothing", "a number");
    refused("ball_mass_kg\n-1\n", Some(2), "row 1, column ball_mass_kg", "-1", "a positive");
    refused("normal_force\neuler\n", Some(2), "row 1, column normal_force", "euler", "newton");
    // Comments and empty lines count as lines, but not as rows.
    refused("# a\n\nspeed_rad_s\n1\n\n# b\nx\n", Some(7), column, "\"x\"", "a number");
}

#[test]
fn wrong_shapes_are_refused() {
    refused("speed_rad_s,damping_n_s_m\n1,1\n1\n", Some(3), "row 2", "1 values", "2, one per");
    refused("speed_rad_s\n1,2\n", Some(2), "row 1", "2 values", "1, one per");
    refused("speed_rad_s\n", Some(1), "", "0 rows", "at least one row");
    refused("", None, "", "no header", "column names");
    let separated = "speed_rad_s;damping_n_s_m";
    refused(
        &format!("{separated}\n1,5;2\n"),
        Some(1),
        "",
        separated,
        "a comma between two columns",
    );
    refused("speed\n1\n", Some(1), "column speed", "speed", "speed_rad_s (did you mean this?)");
    refused("speed_rad_s,speed_rad_s\n1,2\n", Some(1), "column speed_rad_s", "", "once");
    refused("ball\n1\n", Some(1), "column ball", "ball", "balls (did you mean this?)");
}

#[test]
fn files_that_cannot_be_read_are_reported_at_the_study_s_key() {
    for (name, problem) in [("nothing.csv", "No such file"), (".", "a directory")] {
        let rest = format!("sweep: [{{table: {name}}}]\n");
        let error = load(&rest, "{monte_carlo: {samples: 10}}", b"").unwrap_err();
        assert_eq!((error.line(), error.key()), (Some(7), "sweep[0].table"), "{error}");
        assert!(error.problem().contains(problem), "{error}");
        assert_eq!(error.found(), Some(name));
    }
    let design = "{monte_carlo: {samples: 10}}";
    let error = load("sweep: [{table: table.csv}]\n", design, b"speed_rad_s\n\xff\n").unwrap_err();
    assert!(error.problem().contains("not UTF-8"), "{error}");
}

#[test]
fn start_tables_are_checked() {
    let header = "x,y,beta_1,beta_2,x_dot,y_dot,beta_dot_1,beta_dot_2";
    let starts = |table: String| load("", "{table: table.csv}", table.as_bytes());
    let study = starts(format!("{header}\n1,2,3,4,5,6,7,8\n0,0,0,0,0,0,0,0\n")).unwrap();
    assert_eq!(super::coordinates(&study, 0), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    assert_eq!((study.run_count(), study.planned_run(1).cell), (2, 1));

    let error = starts(format!("{header}\n1,2,3,4,5,6,7,east\n")).unwrap_err();
    assert_eq!((error.line(), error.key()), (Some(2), "row 1, column beta_dot_2"), "{error}");
    let error = starts("x,y\n1,2\n".to_owned()).unwrap_err();
    assert!(error.problem().contains("a missing column"), "{error}");
    assert_eq!(error.allowed(), Some("a column `beta_1`"));
    let error = starts(format!("{header},beta_3\n1,2,3,4,5,6,7,8,9\n")).unwrap_err();
    assert_eq!(error.key(), "column beta_3", "{error}");
}

#[test]
fn inline_tables_are_checked() {
    let design = "{monte_carlo: {samples: 10}}";
    for (table, key) in [
        ("{columns: [speed_rad_s], rows: [[1], [1, 2]]}", "sweep[0].table.rows[1]"),
        ("{columns: [speed_rad_s], rows: [[1], [a]]}", "sweep[0].table.rows[1][0]"),
        ("{columns: [speed_rad_s, speed_rad_s], rows: [[1, 2]]}", "sweep[0].table.columns[1]"),
        ("{columns: [speed], rows: [[1]]}", "sweep[0].table.columns[0]"),
        ("{columns: [speed_rad_s], rows: []}", "sweep[0].table"),
        ("{columns: [speed_rad_s], rows: [[.nan]]}", "sweep[0].table.rows[0][0]"),
        ("{colums: [speed_rad_s], rows: []}", "sweep[0].table.colums"),
    ] {
        let error = load(&format!("sweep: [{{table: {table}}}]\n"), design, b"").unwrap_err();
        assert_eq!((error.line(), error.key()), (Some(7), key), "{error}");
    }
}
