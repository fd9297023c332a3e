//! `stickslip evaluate --designs FILE`: forms of tables, interruption, failed runs.

use std::fs;
use std::sync::Arc;

use arrow::array::{ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use parquet::arrow::ArrowWriter;

use super::evaluate::{BALLS, DESIGNS, scratch};
use super::support::{Ended, assert_has, counts, table};

/// The designs of `d.csv` are read from a Parquet file in the form of pandas, and from a CSV file with a byte order mark,
/// Windows line ends, blanks and comments.
#[test]
fn other_forms_of_a_table_are_read() {
    let scratch = scratch();
    let parts: Vec<Vec<&str>> = DESIGNS.iter().map(|design| design.split(',').collect()).collect();
    let speeds = parts.iter().map(|part| part[0].parse::<f64>().unwrap());
    let balls = parts.iter().map(|part| part[1].parse::<i64>().unwrap());
    let columns: [(&str, ArrayRef); 3] = [
        ("material", Arc::new(StringArray::from_iter_values(parts.iter().map(|part| part[2])))),
        ("balls", Arc::new(Int64Array::from_iter_values(balls))),
        ("speed_rad_s", Arc::new(Float64Array::from_iter_values(speeds))),
    ];
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let file = fs::File::create(scratch.path("pandas.parquet")).expect("a new file");
    let mut writer = ArrowWriter::try_new(file, batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    let lines = ["speed_rad_s,balls,material"].into_iter().chain(DESIGNS);
    let lines = lines.map(|line| format!(" {line}\r\n")).collect::<String>();
    scratch.write("odd.csv", format!("\u{feff}# designs\r\n{}", lines.trim_start()));
    let [plain, pandas, odd] = ["d.csv", "pandas.parquet", "odd.csv"].map(|designs| {
        let out = format!("of-{designs}.parquet");
        scratch.well(&format!("evaluate balls.yaml --designs {designs} --out {out} --quiet"));
        scratch.bytes(&out)
    });
    assert!(pandas == plain && odd == plain);
}

/// Ctrl-C ends it with 130 and leaves no file; the same command starts again.
#[cfg(target_os = "linux")]
#[test]
fn an_interrupt_leaves_nothing_behind() {
    use super::interrupt::{catches, send, ticks, wait_until};
    let scratch = scratch();
    scratch.write("long.yaml", BALLS.replace("samples: 24", "samples: 1000000"));
    let before = scratch.files();
    let arguments = "evaluate long.yaml --designs d.csv --out r.parquet --threads 2";
    for _ in 0..2 {
        let child = scratch.command(arguments).spawn().unwrap();
        wait_until("the program catches signals", || catches(&child, 2));
        wait_until("some runs are finished", || ticks(&child) >= 20);
        send(&child, "INT");
        let ended = Ended::of(child.wait_with_output().unwrap());
        assert_eq!((ended.code, ended.out.as_str()), (Some(130), ""), "{}", ended.err);
        assert_has(&ended.err, &["interrupted; nothing is written"]);
        assert_eq!(scratch.files(), before);
    }
}

/// With failed runs the table is complete, the message counts them, and the exit code is 3.
#[test]
fn failed_runs_give_a_complete_table_and_exit_code_3() {
    let scratch = scratch();
    let failing = "uncertain:\n  ball_diameter_m: {normal: {mean: 0.001, std_dev: 0.002}}\n ";
    scratch.write("failing.yaml", BALLS.replace("uncertain:\n ", failing));
    let ended = scratch.stickslip("evaluate failing.yaml --designs d.csv --out r.parquet --quiet");
    assert_eq!((ended.code, ended.err.as_str()), (Some(3), ""));
    let rows = table(&scratch.path("r.parquet"));
    assert_eq!(counts(&rows, "runs"), [24; 5]);
    // All designs have the same samples.
    let failed = counts(&rows, "failed");
    assert!(failed[0] > 0 && failed[0] < 24 && failed == [failed[0]; 5], "{failed:?}");
}
