//! `stickslip evaluate --designs FILE`: Parquet, interruption, failed runs, invalid tables.

use std::fs;
use std::sync::Arc;

use arrow::array::{ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use parquet::arrow::ArrowWriter;

use super::evaluate::{BALLS, DESIGNS, scratch};
use super::support::{Ended, Scratch, assert_has, counts, table};

/// The designs of `d.csv` as a Parquet file in the form of pandas.
fn write_parquet(scratch: &Scratch, name: &str) {
    let parts: Vec<Vec<&str>> = DESIGNS.iter().map(|design| design.split(',').collect()).collect();
    let speeds = parts.iter().map(|part| part[0].parse::<f64>().unwrap());
    let balls = parts.iter().map(|part| part[1].parse::<i64>().unwrap());
    let columns: [(&str, ArrayRef); 3] = [
        ("material", Arc::new(StringArray::from_iter_values(parts.iter().map(|part| part[2])))),
        ("balls", Arc::new(Int64Array::from_iter_values(balls))),
        ("speed_rad_s", Arc::new(Float64Array::from_iter_values(speeds))),
    ];
    let batch = RecordBatch::try_from_iter(columns).unwrap();
    let file = fs::File::create(scratch.path(name)).unwrap();
    let mut writer = ArrowWriter::try_new(file, batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
}

#[test]
fn designs_in_a_parquet_file() {
    let scratch = scratch();
    write_parquet(&scratch, "d.parquet");
    scratch.well("evaluate balls.yaml --designs d.csv --out csv.parquet --quiet");
    scratch.well("evaluate balls.yaml --designs d.parquet --out parquet.parquet --quiet");
    let read = |name: &str| fs::read(scratch.path(name)).unwrap();
    assert_eq!(read("csv.parquet"), read("parquet.parquet"));
    // Errors name row and column there, too.
    let batch = RecordBatch::try_from_iter([
        ("speed_rad_s", Arc::new(Float64Array::from(vec![Some(-200.0), None])) as ArrayRef),
        ("balls", Arc::new(Float64Array::from(vec![2.0, 2.5]))),
        ("material", Arc::new(StringArray::from(vec!["steel", "steel"]))),
    ]);
    let batch = batch.unwrap();
    let file = fs::File::create(scratch.path("wrong.parquet")).unwrap();
    let mut writer = ArrowWriter::try_new(file, batch.schema(), None).unwrap();
    writer.write(&batch).unwrap();
    writer.close().unwrap();
    let parts = ["wrong.parquet", "row 2, column speed_rad_s", "an empty value"];
    scratch.refused("evaluate balls.yaml --designs wrong.parquet --out r.parquet", &parts);
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

#[test]
fn tables_that_are_no_tables() {
    let scratch = scratch();
    let header = "speed_rad_s,balls,material\n";
    // A byte order mark, Windows line ends, blanks and comments are not errors.
    let odd =
        format!("\u{feff}# designs\r\n{}", DESIGNS.map(|line| format!(" {line}\r\n")).concat());
    scratch.write(
        "odd.csv",
        odd.replacen("\r\n", &format!("\r\n{}", header.replace('\n', "\r\n")), 1),
    );
    scratch.well("evaluate balls.yaml --designs odd.csv --out odd.parquet --quiet");
    scratch.well("evaluate balls.yaml --designs d.csv --out d.parquet --quiet");
    let read = |name: &str| fs::read(scratch.path(name)).unwrap();
    assert_eq!(read("odd.parquet"), read("d.parquet"));

    let many = format!("{header}{}", "-200,2,steel\n".repeat(3)) + "-200,2,\"st\neel\"\n";
    let cases: [(&str, Vec<u8>, [&str; 2]); 12] = [
        ("a.csv", format!("{header}nan,2,steel\n").into(), ["row 1, column speed_rad_s", "finite"]),
        ("b.csv", format!("{header}-inf,2,steel\n").into(), ["row 1, column speed_rad_s", "-inf"]),
        ("c.csv", format!("{header}1e999,2,steel\n").into(), ["column speed_rad_s", "1e999"]),
        ("d2.csv", format!("{header}-200,two,steel\n").into(), ["row 1, column balls", "\"two\""]),
        (
            "e.csv",
            format!("{header}-200,99999999999999999999,steel\n").into(),
            ["column balls", "range"],
        ),
        (
            "f.csv",
            format!("{header}-200,2,steel\n-200,2\n").into(),
            ["f.csv:3", "wrong number of values"],
        ),
        ("g.csv", b"speed_rad_s,balls,balls\n-200,2,2\n".to_vec(), ["column balls", "given twice"]),
        ("h.csv", b"speed_rad_s,balls,\xff\n".to_vec(), ["h.csv", "not UTF-8"]),
        ("i.csv", b"".to_vec(), ["i.csv", "empty"]),
        ("j.csv", many.into(), ["row 4, column material", "not a choice"]),
        ("k.parquet", b"PAR1PAR1".to_vec(), ["k.parquet", "found:"]),
        ("l.parquet", read("d.csv"), ["l.parquet", "found:"]),
    ];
    for (name, text, parts) in cases {
        scratch.write(name, text);
        scratch.refused(&format!("evaluate balls.yaml --designs {name} --out r.parquet"), &parts);
    }
    fs::create_dir(scratch.path("m.csv")).unwrap();
    let arguments = "evaluate balls.yaml --designs m.csv --out r.parquet";
    scratch.refused(arguments, &["m.csv", "a directory"]);
    let nowhere = "evaluate balls.yaml --designs d.csv --out nowhere/r.parquet";
    scratch.refused(nowhere, &["nowhere/r.parquet", "a directory that can be written to"]);
}
