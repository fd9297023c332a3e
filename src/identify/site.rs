//! Where and when balls were measured, a point of the sweep and a stage of its runs; and how a simulated run ends, as a
//! measurement would show it.

use std::collections::BTreeMap;

use crate::classification::Label;
use crate::model::{Machine, Model, wrap_to_pi};
use crate::study::{MeasuredRun, Study};
use crate::table::RunRecord;

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
    let mut constant: Vec<bool> = Vec::new();
    for stage in stages.unwrap_or_default() {
        match constant.last_mut().filter(|_| stage.continues) {
            Some(last) => *last = !stage.is_driven,
            None => constant.push(!stage.is_driven),
        }
    }
    constant
}

/// Balls whose gap is at most this wide rest in touch, rad: far below any measured distance.
const IN_TOUCH: f64 = 1e-6;

/// Where the balls of a simulated run are at the end of a stage.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedEnd {
    /// Number of the run.
    pub run_id: u64,
    /// Number of its point.
    pub point_id: u64,
    /// Number of the stage, from 1; a run without stages has one.
    pub stage: u64,
    /// What the balls do.
    pub end: BallsEnd,
}

/// What balls do when they are measured.
#[derive(Clone, Debug, PartialEq)]
pub enum BallsEnd {
    /// All balls rest.
    Rest {
        /// Angle of each ball from the imbalance, rad.
        angles: Vec<f64>,
        /// The group of each ball: balls in a group touch each other in a row. Groups are numbered from 0.
        groups: Vec<u8>,
    },
    /// A ball moves.
    Moving,
    /// The run failed, or the speed of the disc changes.
    Unknown,
}

impl BallsEnd {
    /// Returns the name in tables.
    pub fn name(&self) -> &'static str {
        match self {
            BallsEnd::Rest { .. } => "rest",
            BallsEnd::Moving => "moving",
            BallsEnd::Unknown => "unknown",
        }
    }
}

impl SimulatedEnd {
    /// Returns the ends of the stages of a run.
    pub fn of(record: &RunRecord) -> Vec<SimulatedEnd> {
        let RunRecord { planned, outcome, .. } = record;
        let model = planned.case.as_ref().ok().map(|case| &case.model);
        let machine = model.and_then(|model| model.ball_balancer());
        let contacts = model.map_or_else(Vec::new, Model::angle_contacts);
        let rest = |positions: &Vec<f64>| {
            let angles: Vec<f64> = contacts.iter().map(|contact| positions[*contact]).collect();
            BallsEnd::Rest { groups: groups(machine, &angles), angles }
        };
        let last = match (outcome.label(), &outcome.position) {
            (Label::Equilibrium, Some(angles)) => rest(angles),
            (Label::Failed, _) | (_, None) => BallsEnd::Unknown,
            (_, Some(_)) => BallsEnd::Moving,
        };
        let before = outcome.stages.split_last().map_or(&[][..], |(_, before)| before);
        let mut ends: Vec<BallsEnd> = before
            .iter()
            .map(|stage| match stage.is_at_rest {
                Some(true) => rest(&stage.position),
                Some(false) => BallsEnd::Moving,
                None => BallsEnd::Unknown,
            })
            .collect();
        ends.push(last);
        let of = |(stage, end)| SimulatedEnd {
            run_id: planned.run_id,
            point_id: planned.point_id,
            stage,
            end,
        };
        (1..).zip(ends).map(of).collect()
    }
}

/// Returns the group of each ball; without contact each ball is a group of its own.
fn groups(machine: Option<&Machine>, angles: &[f64]) -> Vec<u8> {
    let count = angles.len();
    let mut groups: Vec<u8> = (0..).take(count).collect();
    let Some(machine) = machine.filter(|machine| machine.contact.is_some()) else { return groups };
    for ball in 0..count.min(machine.balls.len()) {
        for other in 0..ball {
            let touching = machine.contact_angle_rad(&machine.balls[ball], &machine.balls[other]);
            let apart = wrap_to_pi(angles[ball] - angles[other]).abs() - touching;
            if apart < IN_TOUCH && groups[ball] != groups[other] {
                let (from, to) = (groups[ball].max(groups[other]), groups[ball].min(groups[other]));
                groups.iter_mut().filter(|group| **group == from).for_each(|group| *group = to);
            }
        }
    }
    groups
}
