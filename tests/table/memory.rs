//! Tables in memory equal the tables in files.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use arrow::array::{AsArray, StringArray};
use arrow::datatypes::{Int32Type, UInt64Type};
use stickslip::engine::{EngineOptions, Progress, run_study};
use stickslip::study::Study;
use stickslip::table::column::Columns;
use stickslip::table::{MemoryTable, StudyTables, Table, in_memory, manifest_of, table_names};

use crate::cli::support::{Scratch, study_text};

/// Asserts equal names, types, units and descriptions of the columns, and equal values.
fn assert_same(mine: &MemoryTable, other: &MemoryTable) {
    assert_eq!(mine.schema.fields(), other.schema.fields());
    assert_eq!(mine.rows(), other.rows());
    let columns = |table: &MemoryTable| -> Vec<_> {
        table.batches.iter().flat_map(|batch| batch.columns().to_vec()).collect()
    };
    assert_eq!(columns(mine), columns(other));
}

#[test]
fn what_is_computed_is_what_is_written() {
    let scratch = Scratch::new();
    let sweep = "sweep: [{grid: {speed_rad_s: [-160, -216], normal_force: [lagrange, newton]}}]\n";
    let text = study_text("a", "{monte_carlo: {samples: 12}}", 4.0, sweep);
    let path = scratch.write("a.yaml", text);
    let ended = scratch.command("run a.yaml --out out -q").status().unwrap();
    // Some runs fail with Newton's normal force.
    assert_eq!(ended.code(), Some(3));
    let manifest = manifest_of(&scratch.path("out")).expect("readable").expect("a manifest");
    let read = |name| Table::open(&scratch.path("out"), &manifest, name).unwrap().in_memory();

    let study = Study::load(&path).expect("a valid study");
    let mut sink = StudyTables::in_memory(&study);
    let progress = Progress::new(study.run_count(), true);
    let options = EngineOptions { threads: 2, chunk: 7, ..EngineOptions::default() };
    let go_on = AtomicBool::new(false);
    run_study(&study, options, &go_on, &progress, None, &mut sink).expect("a finished study");
    let tables = sink.finish().expect("tables in memory");
    assert_eq!(tables.len(), 6, "no stages");
    assert_eq!(tables[0].rows() as u64, study.run_count());
    for (name, table) in table_names(&study).zip(&tables) {
        assert_same(table, &read(name).unwrap());
        let about = &table.schema.metadata()["stickslip"];
        assert!(about.contains(&format!("\"table\":\"{name}\"")), "{about}");
    }

    // Damage is reported, or affects a value that is still valid; it never causes a panic.
    let file = scratch.path("out/runs.parquet");
    let whole = fs::read(&file).unwrap();
    let table = Table::open(&scratch.path("out"), &manifest, "runs").unwrap();
    let mut refused = 0;
    for place in (0..whole.len()).step_by(whole.len() / 40) {
        let mut damaged = whole.clone();
        damaged[place] ^= 0x55;
        fs::write(&file, damaged).unwrap();
        match table.in_memory() {
            Ok(read) => assert_eq!(read.rows(), tables[0].rows()),
            Err(error) => {
                assert_eq!(error.file, file);
                refused += 1;
            }
        }
    }
    assert!(refused > 5, "{refused}");
}

/// A study whose disc starts has one more table.
#[test]
fn stages_are_those_that_are_written() {
    let scratch = Scratch::new();
    let model =
        "model: {kind: ball_balancer, speed_profile: [{ramp: {from_rad_s: -50, over_s: 0.2}}]}\n";
    let text = study_text("a", "{monte_carlo: {samples: 6}}", 0.5, model);
    let path = scratch.write("a.yaml", text);
    scratch.well("run a.yaml --out out --quiet");
    let manifest = manifest_of(&scratch.path("out")).expect("readable").expect("a manifest");
    let written =
        Table::open(&scratch.path("out"), &manifest, "stages").expect("the table of stages");
    let study = Study::load(&path).expect("a valid study");
    let mut sink = StudyTables::in_memory(&study);
    let progress = Progress::new(study.run_count(), true);
    let go_on = AtomicBool::new(false);
    run_study(&study, EngineOptions::default(), &go_on, &progress, None, &mut sink)
        .expect("a finished study");
    let tables = sink.finish().expect("tables in memory");
    let stages = tables.last().expect("stages");
    assert_eq!(stages.rows() as u64, 2 * study.run_count());
    let numbers = stages.batches[0].column_by_name("stage").expect("the number of the stage");
    let numbers = numbers.as_primitive::<UInt64Type>().values();
    assert_eq!(numbers[..4], [1, 2, 1, 2]);
    assert_same(stages, &written.in_memory().expect("a table in memory"));
}

/// Rows per batch.
const BATCH: u64 = 65_536;

/// All batches have one dictionary for their words.
#[test]
fn rows_keep_their_order_over_batches() {
    for rows in [0, 1, BATCH, 2 * BATCH + 5] {
        let word = |row: &u64| if *row < 5000 { "early" } else { "late" };
        let mut list = Columns::<u64>::new();
        list.count("row", |row| *row).meaning("number of the row");
        list.word("when", word).meaning("early or late");
        let table = in_memory(list.finish(), "here", 0..rows).expect("values of their types");
        assert_eq!(table.rows() as u64, rows);
        assert_eq!(table.batches.len() as u64, rows.div_ceil(BATCH));
        assert_eq!(table.schema.metadata()["stickslip"], "here");
        let numbers = table.batches.iter().flat_map(|batch| {
            assert_eq!(batch.schema(), table.schema);
            let words = batch.column(1).as_dictionary::<Int32Type>();
            let first = table.batches[0].column(1).as_dictionary::<Int32Type>();
            assert!(Arc::ptr_eq(words.values(), first.values()));
            assert!(words.values().len() <= 2);
            let words = words.downcast_dict::<StringArray>().unwrap();
            let numbers = batch.column(0).as_primitive::<UInt64Type>();
            for (number, found) in numbers.values().iter().zip(words) {
                assert_eq!(found, Some(word(number)));
            }
            numbers.values().to_vec()
        });
        assert!(numbers.eq(0..rows));
    }
}
