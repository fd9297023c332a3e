//! A farm whose runs and points are kept in memory.

use std::sync::atomic::AtomicBool;

use stickslip::analysis::PointDetail;
use stickslip::classification::Outcome;
use stickslip::engine::{FarmError, FarmOptions, Progress, Sink, Tally, farm};
use stickslip::model::Case;
use stickslip::study::Study;
use stickslip::table::{PointRow, RunRecord};

/// Runs and points as they come; refuses runs where there is no more room.
#[derive(Default)]
pub struct Kept {
    pub runs: Vec<RunRecord>,
    pub points: Vec<PointRow>,
    pub room: Option<usize>,
}

impl Sink for Kept {
    type Error = &'static str;

    fn run(&mut self, record: RunRecord) -> Result<(), Self::Error> {
        if self.room == Some(self.runs.len()) {
            return Err("the disk is full");
        }
        self.runs.push(record);
        Ok(())
    }

    fn point(&mut self, point: PointRow, _: PointDetail) -> Result<(), Self::Error> {
        self.points.push(point);
        Ok(())
    }
}

/// Farms a study with three threads, four runs at a time.
pub fn farmed(
    study: &Study,
    sink: &mut Kept,
    stop: &AtomicBool,
    simulate: impl Fn(&Case) -> Outcome + Sync,
) -> Result<Tally, FarmError<&'static str>> {
    let options = FarmOptions { threads: 3, chunk: 4, ..FarmOptions::default() };
    farm(study, options, simulate, stop, &Progress::new(study.run_count(), true), None, sink)
}
