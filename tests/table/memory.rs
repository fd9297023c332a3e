//! Tables in memory equal the tables in files.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use arrow::array::{AsArray, StringArray};
use arrow::datatypes::{Int32Type, UInt64Type};
use stickslip::engine::{EngineOptions, Progress, run_study};
use stickslip::study::Study;
use stickslip::table::column::Columns;
use stickslip::table::{MemoryTable, StudyTables, Table, in_memory, manifest_of, table_names};

use crate::cli::support::{Scratch, study_text};

/// Some runs fail with Newton's normal force; a study whose disc starts has one more table.
#[test]
fn what_is_computed_is_what_is_written() {
    let sweep = "sweep: [{grid: {speed_rad_s: [-160, -216], normal_force: [lagrange, newton]}}]\n";
    let starting =
        "model: {kind: ball_balancer, speed_profile: [{ramp: {from_rad_s: -50, over_s: 0.2}}]}\n";
    let columns = |table: &MemoryTable| -> Vec<_> {
        table.batches.iter().flat_map(|batch| batch.columns().to_vec()).collect()
    };
    for (samples, end_time_s, rest, code, count) in
        [(12, 4.0, sweep, 3, 6), (6, 0.5, starting, 0, 7)]
    {
        let design = format!("{{monte_carlo: {{samples: {samples}}}}}");
        let scratch = Scratch::with(study_text("a", &design, end_time_s, rest));
        scratch.ended("run a.yaml --out out -q", code);
        let manifest = manifest_of(&scratch.path("out")).expect("readable").expect("a manifest");
        let open = |name| Table::open(&scratch.path("out"), &manifest, name).expect("a table");

        let study = Study::load(&scratch.path("a.yaml")).expect("a valid study");
        let mut sink = StudyTables::in_memory(&study);
        let progress = Progress::new(study.run_count(), true);
        let options = EngineOptions { threads: 2, chunk: 7, ..EngineOptions::default() };
        let go_on = AtomicBool::new(false);
        run_study(&study, options, &go_on, &progress, None, &mut sink).expect("a finished study");
        let tables = sink.finish().expect("tables in memory");
        assert_eq!((tables.len(), tables[0].rows() as u64), (count, study.run_count()));
        for (name, table) in table_names(&study).zip(&tables) {
            let read = open(name).in_memory().expect("a readable table");
            // Names, types, units and descriptions of the columns, and values.
            assert_eq!(table.schema.fields(), read.schema.fields());
            assert_eq!(columns(table), columns(&read));
            let about = &table.schema.metadata()["stickslip"];
            assert!(about.contains(&format!("\"table\":\"{name}\"")), "{about}");
        }
        if count == 7 {
            assert_eq!(tables[6].rows() as u64, 2 * study.run_count());
            let numbers = tables[6].batches[0].column_by_name("stage").expect("stages");
            assert_eq!(numbers.as_primitive::<UInt64Type>().values()[..4], [1, 2, 1, 2]);
        }
    }
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
