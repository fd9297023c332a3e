//! Results as files: Parquet tables with units and provenance, and the manifest beside them.
//!
//! Only this module writes Parquet files; `tabular` reads them for both studies and results.
//!
//! - Read `column` first, then `motion_values`, which has the units of motions. Then read the columns of the tables of a
//!   study: `runs` has one row per run, `stages` one per run and stage, and `equilibria` one per run that came to rest.
//!   `touches` and `replay` declare the tables of one replayed run.
//! - `file_entry` is a file with its hash, which `verified_files` checks. `durable_directories` and `atomic_files` survive
//!   kills and power loss, and `manifest` lists the files of a directory.
//! - `writer` turns rows into columns for a `memory_table` or for files. An `unfinished_table` gets its name last, and
//!   `table_files` writes into it. `file_list` lists the files of a directory without a manifest.
//! - `row` is a row as a reader sees it, `read` opens a table and reads its rows, and `stored_run` compares a row with a run that is computed again.
//! - `points` has one row per point. Other tables have several rows per point, which `point_key` names. `study_tables` and
//!   `equilibrium_files` hold the tables of a command, and `results` is the output directory of a study. `output_state`
//!   inspects such a directory before a run, and `previous_results` moves earlier results aside.

mod atomic_files;
pub mod cell;
pub mod column;
mod cycles;
mod durable_directories;
mod equilibria;
mod equilibrium_files;
mod equilibrium_histogram;
mod equilibrium_set;
mod estimate;
mod file_entry;
mod file_list;
mod frictionless_equilibria;
mod manifest;
mod memory_table;
mod motion_values;
mod output_state;
mod point_key;
mod points;
mod previous_results;
mod provenance;
mod read;
mod replay;
mod response_samples;
mod results;
mod row;
mod run_record;
mod runs;
mod shard;
mod stages;
mod stored_run;
mod study_tables;
mod table_error;
mod table_files;
mod time_to_rest;
mod touches;
mod unfinished_table;
mod verified_files;
mod writer;

pub use crate::tabular::{ColumnValues, Kind};
pub use atomic_files::{clear_temporaries, write_atomically, write_once};
pub(crate) use atomic_files::{is_own, temporary_file};
pub use cycles::{CycleRow, cycle_columns};
pub use durable_directories::{is_inside, make_directory, make_inside, sync_directory};
pub use equilibria::{EquilibriumRow, equilibrium_columns};
pub use equilibrium_files::{EquilibriumFiles, EquilibriumTables};
pub use equilibrium_histogram::{HistogramRow, histogram_columns};
pub use equilibrium_set::{SetRow, SetSummaryRow, set_columns, set_summary_columns};
pub(crate) use estimate::add_estimate;
pub use file_entry::FileEntry;
pub(crate) use file_entry::{hexadecimal, read_regular, sha256};
pub use file_list::{FILES, FileList};
pub use frictionless_equilibria::{FrictionlessRow, frictionless_columns};
pub use manifest::{MANIFEST, Manifest};
pub use memory_table::{MemoryRows, MemoryTable, in_memory};
pub use motion_values::phase_name;
pub use output_state::{OutputState, check_path, inspect, manifest_of};
pub(crate) use point_key::add_point;
pub use point_key::{OfPoint, PointKey};
pub use points::{PointRow, point_columns};
pub use previous_results::{EARLIER, close_earlier, put_aside};
pub use provenance::{COMMIT, FORMAT, VERSION, provenance, provenance_with};
pub use read::{Table, TableBatches};
pub use replay::{switch_columns, trajectory_columns};
pub use response_samples::ResponseSamples;
pub use results::{Results, ResultsError};
pub use row::{Batch, Row};
pub use run_record::RunRecord;
pub(crate) use runs::add_swept;
pub use runs::{planned_columns, run_columns};
pub use shard::{Shard, ShardError};
pub use stages::{StageRow, stage_columns};
pub use stored_run::{Difference, StoredRun};
pub use study_tables::{Sink, StudyTables, table_names};
pub use table_error::TableError;
pub use table_files::TableFiles;
pub use time_to_rest::{RestRow, rest_columns};
pub use touches::touch_columns;
pub use writer::{Destination, TableWriter, WriteError};
