//! An in-memory sink for the runs and points of a study.

use std::sync::atomic::AtomicBool;

use stickslip::CommandError;
use stickslip::analysis::PointDetail;
use stickslip::classification::Outcome;
use stickslip::engine::{EngineOptions, Progress, RunTotals, Sink, run_study_with};
use stickslip::model::Case;
use stickslip::study::Study;
use stickslip::table::{PointRow, RunRecord, WriteError};

/// Runs and points in order of arrival; refuses runs above its capacity.
#[derive(Default)]
pub struct Kept {
    pub runs: Vec<RunRecord>,
    pub points: Vec<PointRow>,
    pub room: Option<usize>,
}

impl Sink for Kept {
    fn run(&mut self, record: RunRecord) -> Result<(), WriteError> {
        if self.room == Some(self.runs.len()) {
            let cause = std::io::Error::other("the disk is full");
            return Err(WriteError { path: "runs".into(), cause });
        }
        self.runs.push(record);
        Ok(())
    }

    fn point(&mut self, point: PointRow, _: PointDetail) -> Result<(), WriteError> {
        self.points.push(point);
        Ok(())
    }
}

/// Computes a study with three threads, four runs at a time.
pub fn run_in_memory(
    study: &Study,
    sink: &mut Kept,
    stop: &AtomicBool,
    simulate: impl Fn(&Case) -> Outcome + Sync,
) -> Result<RunTotals, CommandError> {
    let options = EngineOptions { threads: 3, chunk: 4, ..EngineOptions::default() };
    run_study_with(
        study,
        options,
        simulate,
        stop,
        &Progress::new(study.run_count(), true),
        None,
        sink,
    )
}
