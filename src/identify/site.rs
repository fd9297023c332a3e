//! Where and when balls were measured: a point of the sweep and a stage of its runs.

use std::collections::BTreeMap;

use crate::study::{MeasuredRun, Study};

/// The measured runs at one point of the sweep and one stage.
#[derive(Clone, Debug, PartialEq)]
pub struct Site {
    /// Number of the point.
    pub point_id: u64,
    /// Number of the stage, from 1.
    pub stage: u64,
    /// The runs that were seen to rest.
    pub rests: Vec<MeasuredRest>,
    /// The number of runs that were seen to move.
    pub moving: u64,
}

/// A measured position of rest.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredRest {
    /// Angles of the balls in any order, rad.
    pub angles: Vec<f64>,
    /// Standard deviation of an angle, rad.
    pub std_dev_rad: f64,
}

impl Site {
    /// Returns the number of measured runs.
    pub fn runs(&self) -> u64 {
        self.rests.len() as u64 + self.moving
    }
}

/// Returns the sites of measured runs, in the order of points and stages.
///
/// # Errors
/// Returns a sentence if a stage does not exist, or if the speed changes in it.
pub fn sites(study: &Study, measured: &[MeasuredRun]) -> Result<Vec<Site>, String> {
    let mut stages_of: BTreeMap<u64, Vec<bool>> = BTreeMap::new();
    let mut sites: BTreeMap<(u64, u64), Site> = BTreeMap::new();
    for (row, run) in (1..).zip(measured) {
        let point_id = run.point_id;
        let stages = stages_of.entry(point_id).or_insert_with(|| constant_stages(study, point_id));
        let stage = run.stage.unwrap_or(stages.len() as u64);
        let exists = stage.checked_sub(1).and_then(|index| stages.get(index as usize));
        if exists != Some(&true) {
            let constant = (1..).zip(&*stages).filter(|(_, constant)| **constant);
            let constant: Vec<String> = constant.map(|(stage, _)| stage.to_string()).collect();
            return Err(format!(
                "row {row}: stage {stage} is no stage of constant speed\n  allowed: {}",
                constant.join(", ")
            ));
        }
        let first = || Site { point_id, stage, rests: Vec::new(), moving: 0 };
        let site = sites.entry((point_id, stage)).or_insert_with(first);
        match &run.rest {
            Some(angles) => {
                let (angles, std_dev_rad) = (angles.clone(), run.std_dev_rad);
                site.rests.push(MeasuredRest { angles, std_dev_rad });
            }
            None => site.moving += 1,
        }
    }
    Ok(sites.into_values().collect())
}

/// Returns whether the speed is constant in each stage of the runs at a point.
fn constant_stages(study: &Study, point_id: u64) -> Vec<bool> {
    let run = study.planned_run(study.point(point_id).first_run);
    let end_time_s = run.case.as_ref().map_or(f64::INFINITY, |case| case.simulation.end_time_s);
    let stages = study.point(point_id).model().stages(&run.start, end_time_s);
    stages.unwrap_or_default().iter().map(|stage| !stage.is_driven).collect()
}
