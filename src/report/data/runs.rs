//! Runs from `runs.parquet` of the points in detail: all of them, or a subsample.

use std::collections::BTreeMap;

use super::PointFacts;
use crate::classification::Label;
use crate::model::Machine;
use crate::study::{Study, mixed};
use crate::table::{Table, TableError};

/// The largest number of amplitudes in memory.
const MOST_AMPLITUDES: u64 = 2_000_000;
/// The largest number of failed and flipped runs in the list.
const MOST_NOTABLE: usize = 200;

/// A sample of runs, column by column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunSample {
    /// Number of runs of the points in detail.
    pub of: u64,
    /// About one in this many runs is in the sample.
    pub one_in: u64,
    /// Amplitudes at the end of the runs of each point, in m and relative to that of the run's own machine without balls: of
    /// all runs that have one, or of about one in [`Self::amplitude_one_in`].
    pub amplitudes: BTreeMap<u64, [Vec<f64>; 2]>,
    /// About one in this many amplitudes is in `amplitudes`.
    pub amplitude_one_in: u64,
    /// Number of rests at which balls touch, of all runs of each point; empty without contact between balls.
    pub touching_rests: BTreeMap<u64, u64>,
    /// Number of runs, of all, that failed or changed their label in the audit.
    pub notable: u64,
    /// Numbers of the runs.
    pub run_id: Vec<u64>,
    /// Numbers of their points.
    pub point_id: Vec<u64>,
    /// Their labels.
    pub label: Vec<Label>,
    /// Amplitude of the table at the end, m; NaN if the run has none.
    pub amplitude_m: Vec<f64>,
    /// Friction margin at rest; NaN while moving.
    pub friction_margin: Vec<f64>,
    /// Time to rest, s; NaN while moving.
    pub time_to_rest_s: Vec<f64>,
    /// End position of each contact: angles of balls in [0, 2π), rad, or the position of the block, m.
    pub position: Vec<Vec<f64>>,
    /// Start states, coordinate by coordinate in the order of the model.
    pub start: Vec<Vec<f64>>,
}

/// A run that failed, or whose label changed in the audit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotableRun {
    /// Number of the run.
    pub run_id: u64,
    /// Label of the run.
    pub label: String,
    /// Evidence for the label.
    pub evidence: String,
    /// The label in the audit, if it is another one.
    pub audited: Option<String>,
    /// The error, if the run failed.
    pub error: String,
}

/// Reads at most `most` runs of the points `shown`, the failed and flipped ones among all runs, and how many rests touch at
/// each of `points`.
///
/// A hash of the run numbers selects the subsample. Evenly spaced runs would lie in the same cells of a
/// stratified design again and again.
pub fn read(
    study: &Study,
    table: &Table,
    points: &[PointFacts],
    shown: &[&PointFacts],
    most: u64,
) -> Result<(RunSample, Vec<NotableRun>), TableError> {
    let model = study.model();
    let positions = (0..model.contacts()).map(|contact| model.position_column(contact).0);
    let positions: Vec<String> = positions.collect();
    let starts =
        model.coordinates().into_iter().map(|coordinate| format!("initial_{}", coordinate.name));
    let starts: Vec<String> = starts.collect();
    let audit = study.audit().is_some();
    let touches = |machine: &Machine| machine.contact.is_some() && machine.balls.len() > 1;
    let contact = model.ball_balancer().is_some_and(touches);
    let vibrates = model.kind().offers.vibration;

    let of = shown.iter().map(|point| point.runs).fold(0, u64::saturating_add);
    let one_in = of.div_ceil(most.max(1)).max(1);
    let amplitude_one_in = of.div_ceil(MOST_AMPLITUDES).max(1);
    let mut sample = RunSample {
        of,
        one_in,
        amplitude_one_in,
        amplitudes: shown.iter().map(|point| (point.point_id, Default::default())).collect(),
        touching_rests: match contact {
            true => points.iter().map(|point| (point.point_id, 0)).collect(),
            false => BTreeMap::new(),
        },
        position: vec![Vec::new(); positions.len()],
        start: vec![Vec::new(); starts.len()],
        ..RunSample::default()
    };
    let mut notable = Vec::new();
    table.for_each(|row| {
        let (run_id, point_id, label) = (row.count("run_id"), row.count("point_id"), row.label());
        let (evidence, error) = (row.text("evidence"), row.text("error"));
        let audited = if audit { row.text("audit_label") } else { None };
        let touches = contact && row.truth("touching_at_end") == Some(true);
        let numbers =
            ["amplitude_m", "friction_margin", "time_to_rest_s"].map(|name| row.number(name));
        let relative_amplitude = if vibrates { row.number("relative_amplitude") } else { None };
        let places = positions.iter().chain(&starts).map(|name| row.number(name));
        let places: Vec<Option<f64>> = places.collect();
        let Some(((run_id, point_id), label)) = run_id.zip(point_id).zip(label) else { return };
        let audited = audited.filter(|other| other != label.name());
        if label == Label::Failed || audited.is_some() {
            sample.notable += 1;
            if notable.len() < MOST_NOTABLE {
                let (evidence, error) = (evidence.unwrap_or_default(), error.unwrap_or_default());
                let label = label.name().to_owned();
                notable.push(NotableRun { run_id, label, evidence, audited, error });
            }
        }
        if touches
            && label == Label::Equilibrium
            && let Some(rests) = sample.touching_rests.get_mut(&point_id)
        {
            *rests += 1;
        }
        let Some([absolute, relative]) = sample.amplitudes.get_mut(&point_id) else { return };
        if scattered(run_id, amplitude_one_in) {
            absolute.extend(numbers[0]);
            relative.extend(relative_amplitude);
        }
        if scattered(run_id, one_in) {
            sample.run_id.push(run_id);
            sample.point_id.push(point_id);
            sample.label.push(label);
            let RunSample { amplitude_m, friction_margin, time_to_rest_s, position, start, .. } =
                &mut sample;
            let columns = [amplitude_m, friction_margin, time_to_rest_s].into_iter();
            let columns = columns.chain(position).chain(start);
            for (column, number) in columns.zip(numbers.into_iter().chain(places)) {
                column.push(number.unwrap_or(f64::NAN));
            }
        }
    })?;
    Ok((sample, notable))
}

impl RunSample {
    /// Returns a sentence on the size of the subsample; empty if it holds all runs.
    pub fn left_out(&self) -> String {
        if self.one_in <= 1 {
            return String::new();
        }
        let (of, shown, one_in) = (self.of, self.run_id.len(), self.one_in);
        format!(" Subsample: {shown} of the {of} runs of these points, about one in {one_in}.")
    }
}

/// Whether a run belongs to a subsample of about one in `one_in` runs, by a hash of its number.
pub fn scattered(run_id: u64, one_in: u64) -> bool {
    mixed(run_id).is_multiple_of(one_in.max(1))
}

#[cfg(test)]
mod tests {
    use super::scattered;

    /// Every cell of a stratified design has its part, for any period in the run numbers. Counts are binomial; 6 standard
    /// deviations would be exceeded once in 10^8.
    #[test]
    fn runs_are_scattered_over_cells() {
        for (cells, one_in) in [(2, 2), (3, 3), (256, 2), (768, 5), (6561, 7)] {
            let runs = 300_000;
            let all = (0..runs).filter(|run| scattered(*run, one_in)).count() as f64;
            let expected = runs as f64 / one_in as f64;
            assert!((all - expected).abs() < 6.0 * expected.sqrt(), "{cells} {one_in}");
            let first =
                (0..runs).step_by(cells).filter(|run| scattered(*run, one_in)).count() as f64;
            let expected = expected / cells as f64;
            assert!((first - expected).abs() < 6.0 * expected.sqrt() + 1.0, "{cells} {one_in}");
        }
        assert!((0..100).all(|run| scattered(run, 1) && scattered(run, 0)));
    }
}
