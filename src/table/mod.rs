//! Results as files: Parquet tables with units and provenance, and the manifest beside them.
//!
//! Only this module writes Parquet files; `tabular` reads them for both studies and results.
//!
//! - Read `column` first, then `motion_values`, which has the units of motions. Then read the columns of the tables of a
//!   study: `runs` has one row per run, and `run_rows` are further tables of runs. `points` has one row per point, and the
//!   tables of `of_point` have several. `replay` declares the tables of one replayed run, and `equilibrium_set` and
//!   `steady_states` those of `stickslip equilibria`.
//! - `durable_files` survive kills and power loss. `file_entry` is a file with its hash, and `manifest` lists the files of a
//!   directory; `file_list` lists those of a directory without a manifest.
//! - `writer` turns rows into columns in memory or for files. An `unfinished_table` gets its name last, and `table_files`
//!   writes into it.
//! - `row` is a row as a reader sees it, `read` opens a table and reads its rows, and `stored_run` compares a row with a run
//!   that is computed again.
//! - `results` holds the tables of a study, in memory or in an output directory. `output_state` inspects such a directory
//!   before a run, and `previous_results` moves earlier results aside.

pub mod column;
mod durable_files;
mod equilibrium_set;
mod estimate;
mod file_entry;
mod file_list;
mod manifest;
mod motion_values;
mod of_point;
mod output_state;
mod points;
mod previous_results;
mod provenance;
mod read;
mod replay;
mod results;
mod row;
mod run_record;
mod run_rows;
mod runs;
mod shard;
mod steady_states;
mod stored_run;
mod table_error;
mod table_files;
mod unfinished_table;
mod writer;

pub use crate::tabular::{ColumnValues, Kind};
pub use durable_files::{
    clear_temporaries, is_inside, make_directory, make_inside, sync_directory, write_atomically,
    write_once,
};
pub(crate) use durable_files::{is_own, temporary_file};
pub use equilibrium_set::{
    EquilibriumColumns, EquilibriumTables, FrictionlessRow, SetRow, SetSummaryRow,
    frictionless_columns, set_columns, set_summary_columns,
};
pub(crate) use estimate::add_estimate;
pub use file_entry::FileEntry;
pub(crate) use file_entry::{hexadecimal, read_regular, sha256};
pub use file_list::{FILES, FileList};
pub use manifest::{MANIFEST, Manifest};
pub use motion_values::phase_name;
pub(crate) use of_point::add_point;
pub use of_point::{
    CycleRow, HistogramRow, OfPoint, PointKey, RestRow, cycle_columns, histogram_columns,
    rest_columns,
};
pub use output_state::{OutputState, check_path, inspect, manifest_of};
pub use points::{PointRow, point_columns};
pub use previous_results::{EARLIER, close_earlier, put_aside};
pub use provenance::{COMMIT, FORMAT, VERSION, provenance, provenance_with};
pub use read::{Table, TableBatches};
pub use replay::{switch_columns, touch_columns, trajectory_columns};
pub use results::{Results, ResultsError, Sink, StudyTables, table_names};
pub use row::{Batch, Row};
pub use run_record::{ResponseSamples, RunRecord};
pub use run_rows::{EquilibriumRow, StageRow, equilibrium_columns, stage_columns};
pub(crate) use runs::add_swept;
pub use runs::{planned_columns, run_columns};
pub use shard::{Shard, ShardError};
pub use steady_states::{HeldPositionRow, HeldSetRow, SteadyStateRow, places, steady_columns};
pub use stored_run::{Difference, StoredRun};
pub use table_error::TableError;
pub use table_files::TableFiles;
pub use writer::{Destination, MemoryRows, MemoryTable, TableWriter, WriteError, in_memory};
