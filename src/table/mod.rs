//! Results as files: Parquet tables with units and provenance, and the manifest beside them.
//!
//! The only room that knows Arrow, and that writes Parquet (`study` reads tables in it, behind guards
//! that the reading of results fractions).

pub mod cell;
mod checked;
pub mod column;
mod cycles;
mod design_rows;
mod destination;
mod directory;
mod earlier;
mod equilibria;
mod equilibrium_files;
mod equilibrium_histogram;
mod file_list;
mod frictionless;
mod manifest;
mod memory;
mod memory_results;
mod points;
mod provenance;
mod read;
mod read_memory;
mod read_values;
mod record;
mod replay;
mod rest;
mod results;
mod runs;
mod set;
mod staging;
mod stored_run;
mod temporary;
mod writer;

pub use cycles::{CycleRow, cycle_columns};
pub use design_rows::designs_in_arrow;
pub use destination::{Destination, check_path, inspect, manifest_of};
pub use directory::{is_inside, make_directory, make_inside, sync_directory};
pub use earlier::{EARLIER, close_earlier, put_aside};
pub use equilibria::{EquilibriumRow, equilibrium_columns};
pub use equilibrium_files::{EquilibriumFiles, EquilibriumTables};
pub use equilibrium_histogram::{HistogramRow, histogram_columns};
pub use file_list::{FILES, FileList};
pub use frictionless::{FrictionlessRow, frictionless_columns};
pub(crate) use manifest::read_regular;
pub use manifest::{FileEntry, MANIFEST, Manifest};
pub use memory::{MemoryTable, MemoryWriter, in_memory};
pub use memory_results::{MemoryResults, TABLES};
pub use points::{PointRow, point_columns};
pub use provenance::{COMMIT, FORMAT, VERSION, provenance, provenance_with};
pub use read::{Batches, Table, TableError};
pub use read_values::{Batch, Kind, Values};
pub use record::RunRecord;
pub use replay::{Units, in_circle, phase_name, switch_columns, trajectory_columns};
pub use rest::{RestRow, rest_columns};
pub use results::{Circumstances, Results, ResultsError};
pub use runs::{planned_columns, run_columns};
pub use set::{PointKey, SetRow, SetSummaryRow, set_columns, set_summary_columns};
pub use stored_run::{Difference, StoredRun};
pub(crate) use temporary::is_one_of;
pub use temporary::{clear_temporaries, write_atomically, write_once};
pub use writer::{TableWriter, WriteCause, WriteError};
