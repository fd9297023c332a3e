//! `stages.parquet`: what happens in each stage of each run, with one row per run and stage. A study whose disc turns at
//! constant speed, without kicks and motions of tables, has no such table.

use super::column::{Column, Columns};
use super::run_record::RunRecord;
use crate::classification::StageOutcome;
use crate::model::OutputName;
use crate::study::Study;

/// A stage of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct StageRow {
    run_id: u64,
    point_id: u64,
    /// The number of the stage, from 1.
    stage: u64,
    outcome: StageOutcome,
}

impl StageRow {
    /// Returns the rows of a run.
    pub fn of(record: &RunRecord) -> impl Iterator<Item = StageRow> + '_ {
        let (run_id, point_id) = (record.planned.run_id, record.planned.point_id);
        let stages = (1..).zip(&record.outcome.stages);
        stages.map(move |(stage, outcome)| StageRow {
            run_id,
            point_id,
            stage,
            outcome: outcome.clone(),
        })
    }

    /// Returns what the stage is, in a word.
    fn kind(&self) -> &'static str {
        let [begin, end] = self.outcome.speed_rad_s;
        if begin.to_bits() == end.to_bits() { "hold" } else { "ramp" }
    }
}

/// Returns the columns of `stages.parquet`.
pub fn stage_columns(study: &Study) -> Vec<Column<StageRow>> {
    let model = study.model();
    let mut list = Columns::<StageRow>::new();
    list.count("run_id", |row| row.run_id).meaning("number of the run in the study, from 0");
    list.point_id(|row| row.point_id);
    list.count("stage", |row| row.stage).meaning("number of the stage in the run, from 1");
    let turns = model.disc_motion().is_some();
    if turns {
        list.word("kind", StageRow::kind)
            .meaning("ramp, in which the speed of the disc changes, or hold, at constant speed");
    }
    if model.kind().offers.vibration {
        list.boolean("kicked", |row| row.outcome.is_kicked)
            .meaning("whether the table is kicked at the begin of the stage");
    }
    list.number("begin_s", "s", |row| row.outcome.time_s[0]).meaning("begin of the stage");
    list.number("end_s", "s", |row| row.outcome.time_s[1])
        .meaning("end of the stage, or of the run in it");
    if turns {
        list.number("begin_speed_rad_s", "rad/s", |row| row.outcome.speed_rad_s[0])
            .meaning("speed of the disc at the begin of the stage");
        list.number("end_speed_rad_s", "rad/s", |row| row.outcome.speed_rad_s[1])
            .meaning("speed of the disc at the end of the stage");
    }
    for ball in 0..model.balls() {
        list.number(format!("beta_{}_rad", ball + 1), "rad", move |row| {
            row.outcome.position.get(ball).copied()
        })
        .meaning("angle of the ball from the imbalance at the end of the stage, in [0, 2π)");
    }
    for ball in 0..model.balls() {
        list.number(format!("ball_speed_{}_rad_s", ball + 1), "rad/s", move |row| {
            row.outcome.ball_speed_rad_s.get(ball).copied()
        })
        .meaning("speed of the ball relative to the ring at the end of the stage");
    }
    for (place, OutputName { name, unit, meaning }) in model.output_names().into_iter().enumerate()
    {
        let of = if meaning.is_empty() { &name } else { &meaning };
        list.number(format!("end_{name}"), &unit, move |row| {
            row.outcome.outputs.get(place).copied()
        })
        .meaning(format!("{of}: at the end of the stage"));
    }
    list.boolean("at_rest", |row| row.outcome.is_at_rest).meaning(
        "whether friction holds all balls for good at the end of the stage; null while the speed changes, and without a certificate",
    );
    if model.kind().offers.vibration {
        add_vibration(&mut list);
    }
    list.finish()
}

/// Adds the columns of stages of a balancer.
fn add_vibration(list: &mut Columns<StageRow>) {
    list.number("displacement_m", "m", |row| row.outcome.amplitude_m)
        .meaning("distance of the table from its place at rest at the end of the stage");
    list.number("peak_amplitude_m", "m", |row| row.outcome.peak.amplitude_m)
        .meaning("largest displacement of the table in the stage");
    list.number("peak_time_s", "s", |row| row.outcome.peak.time_s)
        .meaning("time of that, since the start of the run");
    list.count("lifted_off", |row| u64::from(row.outcome.lifted_off)).meaning(
        "balls that the kick at the begin of the stage lifts off the ring, which the model does not follow",
    );
}
