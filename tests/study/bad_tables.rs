//! Invalid tables: file, row and column of each error.

use stickslip::study::{Study, StudyError};

use crate::support::cases;

fn load(rest: &str, design: &str, table: &[u8]) -> Result<Study, StudyError> {
    super::load_with("table.csv", table, rest, design)
}

fn sweep(table: &str) -> Result<Study, StudyError> {
    load("sweep: [{table: table.csv}]\n", "{monte_carlo: {samples: 10}}", table.as_bytes())
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

/// A table, the line of the message, its key, what it found, and what it allows.
const WRONG: &str = r"# Cells.
speed_rad_s\n-160\nfast\n ¦ 3 ¦ row 2, column speed_rad_s ¦ fast ¦ a number
speed_rad_s\n-160\nNaN\n ¦ 3 ¦ row 2, column speed_rad_s ¦ NaN ¦ a finite number
speed_rad_s\n-160\n1e999\n ¦ 3 ¦ row 2, column speed_rad_s ¦ 1e999 ¦ a finite number
speed_rad_s,damping_n_s_m\n1,1\n,1\n ¦ 3 ¦ row 2, column speed_rad_s ¦ nothing ¦ a number
ball_mass_kg\n-1\n ¦ 2 ¦ row 1, column ball_mass_kg ¦ -1 ¦ a positive
normal_force\neuler\n ¦ 2 ¦ row 1, column normal_force ¦ euler ¦ newton
# Comments and empty lines count as lines, but not as rows.
#a\n\nspeed_rad_s\n1\n\n# b\nx\n ¦ 7 ¦ row 2, column speed_rad_s ¦ x ¦ a number
# Shapes.
speed_rad_s,damping_n_s_m\n1,1\n1\n ¦ 3 ¦ row 2 ¦ 1 values ¦ 2, one per
speed_rad_s\n1,2\n ¦ 2 ¦ row 1 ¦ 2 values ¦ 1, one per
speed_rad_s\n ¦ 1 ¦  ¦ 0 rows ¦ at least one row
 ¦  ¦  ¦ no header ¦ column names
speed_rad_s;damping_n_s_m\n1,5;2\n ¦ 1 ¦  ¦ speed_rad_s;damping_n_s_m ¦ a comma between two columns
speed\n1\n ¦ 1 ¦ column speed ¦ speed ¦ speed_rad_s (did you mean this?)
speed_rad_s,speed_rad_s\n1,2\n ¦ 1 ¦ column speed_rad_s ¦  ¦ once
ball\n1\n ¦ 1 ¦ column ball ¦ ball ¦ balls (did you mean this?)";

#[test]
fn wrong_tables_are_refused() {
    for [table, line, key, found, allowed] in cases(WRONG) {
        let error = sweep(&table).err().unwrap_or_else(|| panic!("accepted: {table}"));
        assert!(error.file().ends_with("table.csv"), "{error}");
        assert_eq!((error.line(), error.key()), (line.parse().ok(), key.as_str()), "{error}");
        super::says(&error, &found, &allowed);
    }
}

#[test]
fn tables_of_other_bytes_are_refused() {
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
