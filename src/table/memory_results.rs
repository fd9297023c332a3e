//! The tables of a study in memory: the content that [`super::Results`] writes to a directory.

use arrow_schema::ArrowError;

use super::cycles::{CycleRow, cycle_columns};
use super::equilibria::{EquilibriumRow, equilibrium_columns};
use super::equilibrium_histogram::{HistogramRow, histogram_columns};
use super::memory_table::{MemoryTable, MemoryWriter};
use super::points::{PointRow, point_columns};
use super::provenance::provenance;
use super::run_record::RunRecord;
use super::runs::run_columns;
use super::stages::{StageRow, stage_columns};
use super::time_to_rest::{RestRow, rest_columns};
use crate::analysis::PointDetail;
use crate::study::Study;

/// The names of a study's tables: the file names without `.parquet`.
pub const TABLES: [&str; 6] =
    ["runs", "points", "time_to_rest", "cycles", "equilibria", "equilibrium_histogram"];

/// The name of the table that only a study whose runs have stages has.
pub const STAGES_TABLE: &str = "stages";

/// The tables of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct MemoryTables {
    /// The tables that each study has, in the order of [`TABLES`].
    pub tables: [MemoryTable; 6],
    /// The stages of the runs; `None` for a study whose runs have no stages.
    pub stages: Option<MemoryTable>,
}

/// Builds the tables of a study row by row.
pub struct MemoryResults {
    runs: MemoryWriter<RunRecord>,
    points: MemoryWriter<PointRow>,
    rest: MemoryWriter<RestRow>,
    cycles: MemoryWriter<CycleRow>,
    equilibria: MemoryWriter<EquilibriumRow>,
    histogram: MemoryWriter<HistogramRow>,
    /// Of a study whose runs have stages.
    stages: Option<MemoryWriter<StageRow>>,
}

impl MemoryResults {
    /// Creates empty tables.
    pub fn new(study: &Study) -> Self {
        let about = |table| provenance(study, table);
        let stages = || MemoryWriter::new(stage_columns(study), about(STAGES_TABLE));
        MemoryResults {
            stages: study.has_stages().then(stages),
            runs: MemoryWriter::new(run_columns(study), about("runs")),
            points: MemoryWriter::new(point_columns(study), about("points")),
            rest: MemoryWriter::new(rest_columns(study), about("time_to_rest")),
            cycles: MemoryWriter::new(cycle_columns(study), about("cycles")),
            equilibria: MemoryWriter::new(equilibrium_columns(study), about("equilibria")),
            histogram: MemoryWriter::new(histogram_columns(study), about("equilibrium_histogram")),
        }
    }

    /// Adds a run.
    ///
    /// # Errors
    /// Returns an error if values do not fit their column, which is a bug.
    pub fn push_run(&mut self, record: RunRecord) -> Result<(), ArrowError> {
        if let Some(equilibrium) = EquilibriumRow::of(&record) {
            self.equilibria.push(equilibrium)?;
        }
        if let Some(stages) = &mut self.stages {
            StageRow::of(&record).try_for_each(|stage| stages.push(stage))?;
        }
        self.runs.push(record)
    }

    /// Adds a point and its rows in the other tables.
    ///
    /// # Errors
    /// Returns an error in the cases of [`MemoryResults::push_run`].
    pub fn push_point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), ArrowError> {
        for step in detail.rest {
            self.rest.push(RestRow::new(&point, step))?;
        }
        for group in detail.cycles {
            self.cycles.push(CycleRow::new(&point, group))?;
        }
        for bin in detail.histogram {
            self.histogram.push(HistogramRow::new(&point, bin))?;
        }
        self.points.push(point)
    }

    /// Returns the tables.
    ///
    /// # Errors
    /// Returns an error in the cases of [`MemoryResults::push_run`].
    pub fn finish(self) -> Result<MemoryTables, ArrowError> {
        let tables = [
            self.runs.finish()?,
            self.points.finish()?,
            self.rest.finish()?,
            self.cycles.finish()?,
            self.equilibria.finish()?,
            self.histogram.finish()?,
        ];
        Ok(MemoryTables { tables, stages: self.stages.map(MemoryWriter::finish).transpose()? })
    }
}
