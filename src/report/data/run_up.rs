//! Runs with stages: the largest vibration of each point, and a sample of runs whose motion is computed again.
//!
//! Only a few runs of a few points are computed again, and only as long as they take few integration steps.

use std::collections::BTreeMap;

use super::motion::{SampledMotion, motion};
use super::{PointFacts, evenly, scattered};
use crate::study::Study;
use crate::table::{Table, TableError};

/// The largest number of points with motions.
const MOST_POINTS: usize = 6;
/// The largest number of integration steps that are computed again.
const MOST_STEPS: u64 = 4_000_000;
/// The largest number of runs of a point from which the sample is chosen.
const MOST_RUNS: u64 = 100_000;
/// The parts of the runs of a point, ordered by their amplitude at the end, at which runs are chosen.
const QUANTILES: [(f64, &str); 4] = [
    (0.5, "median of the amplitude at the end"),
    (1.0, "largest amplitude at the end"),
    (0.0, "smallest amplitude at the end"),
    (0.9, "90 % quantile of the amplitude at the end"),
];

/// What happened in the runs of a study with stages; empty for other studies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SampledRunUps {
    /// The run with the largest vibration of each point.
    pub largest: BTreeMap<u64, PeakOfRun>,
    /// The points with motions, each with its runs.
    pub points: Vec<(u64, Vec<SampledRun>)>,
    /// The number of runs that were chosen but not computed again, because they take too many steps.
    pub left_out: usize,
}

/// The largest vibration of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakOfRun {
    /// Number of the run.
    pub run_id: u64,
    /// The amplitude, m.
    pub amplitude_m: f64,
    /// Its time since the start of the run, s.
    pub time_s: f64,
}

/// A run with its motion.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledRun {
    /// Why it was chosen.
    pub why: &'static str,
    /// Its largest vibration.
    pub peak: PeakOfRun,
    /// Its motion.
    pub motion: SampledMotion,
}

/// A run from which the sample may be chosen.
#[derive(Clone, Copy, Debug)]
struct SampleCandidate {
    peak: PeakOfRun,
    amplitude_m: f64,
    end_s: f64,
    steps: u64,
}

/// The runs of a point from which the sample is chosen.
#[derive(Clone, Debug, Default)]
struct Candidates {
    first: Option<SampleCandidate>,
    largest: Option<SampleCandidate>,
    some: Vec<SampleCandidate>,
}

/// Reads the runs of these points, and computes a few of them again.
pub fn read(
    study: &Study,
    table: &Table,
    points: &[PointFacts],
) -> Result<SampledRunUps, TableError> {
    if !study.has_peaks() {
        return Ok(SampledRunUps::default());
    }
    let mut run_up = SampledRunUps::default();
    let chosen = evenly(points.len(), MOST_POINTS).into_iter().filter_map(|at| points.get(at));
    let mut of_points: BTreeMap<u64, (u64, Candidates)> = chosen
        .map(|point| (point.point_id, (point.runs.div_ceil(MOST_RUNS), Candidates::default())))
        .collect();
    let run_count = study.run_count();
    table.for_each(|row| {
        let run_id = row.count("run_id").filter(|run_id| *run_id < run_count);
        let ids = run_id.zip(row.count("point_id"));
        let peak = row.number("peak_amplitude_m").zip(row.number("peak_time_s"));
        let end = row.number("amplitude_m").zip(row.number("end_time_s"));
        let steps = row.count("steps").unwrap_or(0);
        let Some(((run_id, point_id), (amplitude_m, time_s))) = ids.zip(peak) else { return };
        if points.binary_search_by_key(&point_id, |point| point.point_id).is_err() {
            return;
        }
        let peak = PeakOfRun { run_id, amplitude_m, time_s };
        let largest = run_up.largest.entry(point_id).or_insert(peak);
        if is_larger(&peak, largest) {
            *largest = peak;
        }
        let candidates = of_points.get_mut(&point_id).zip(end);
        if let Some(((one_in, candidates), (amplitude_m, end_s))) = candidates {
            candidates.add(SampleCandidate { peak, amplitude_m, end_s, steps }, *one_in);
        }
    })?;
    let mut steps_left = MOST_STEPS;
    for (point_id, (_, candidates)) in of_points {
        let mut runs = Vec::new();
        for (candidate, why) in candidates.sample() {
            let Some(left) = steps_left.checked_sub(candidate.steps) else {
                run_up.left_out += 1;
                continue;
            };
            steps_left = left;
            let found = motion(study, candidate.peak.run_id, candidate.end_s);
            runs.extend(found.map(|motion| SampledRun { why, peak: candidate.peak, motion }));
        }
        if !runs.is_empty() {
            run_up.points.push((point_id, runs));
        }
    }
    Ok(run_up)
}

/// Whether a run vibrates more than another one; of equal runs, the first one does.
fn is_larger(peak: &PeakOfRun, other: &PeakOfRun) -> bool {
    let order = peak.amplitude_m.total_cmp(&other.amplitude_m);
    order.then(other.run_id.cmp(&peak.run_id)).is_gt()
}

impl Candidates {
    fn add(&mut self, run: SampleCandidate, one_in: u64) {
        let run_id = run.peak.run_id;
        if self.first.is_none_or(|first| run_id < first.peak.run_id) {
            self.first = Some(run);
        }
        if self.largest.is_none_or(|largest| is_larger(&run.peak, &largest.peak)) {
            self.largest = Some(run);
        }
        if scattered(run_id, one_in) {
            self.some.push(run);
        }
    }

    /// Returns different runs with the reason for each.
    fn sample(mut self) -> Vec<(SampleCandidate, &'static str)> {
        let order = |run: &SampleCandidate| (run.amplitude_m, run.peak.run_id);
        self.some.sort_by(|left, right| {
            let ((left, first), (right, second)) = (order(left), order(right));
            left.total_cmp(&right).then(first.cmp(&second))
        });
        let last = self.some.len().saturating_sub(1) as f64;
        let at = |part: f64| self.some.get((part * last).round() as usize).copied();
        let first = [(self.first, "first run"), (self.largest, "largest amplitude of all runs")];
        let others = QUANTILES.into_iter().map(|(part, why)| (at(part), why));
        let mut sample: Vec<(SampleCandidate, &'static str)> = Vec::new();
        for (run, why) in first.into_iter().chain(others) {
            let is_new = |run: &SampleCandidate| {
                sample.iter().all(|(other, _)| other.peak.run_id != run.peak.run_id)
            };
            if let Some(run) = run.filter(is_new) {
                sample.push((run, why));
            }
        }
        sample
    }
}

#[cfg(test)]
mod tests {
    use super::{Candidates, PeakOfRun, SampleCandidate};

    /// Ten runs whose amplitude at the end falls with the number, and whose peak is largest in run 3.
    #[test]
    fn the_sample_has_different_runs() {
        let mut candidates = Candidates::default();
        for run_id in (0..10).rev() {
            let amplitude_m = 1.0 - 0.1 * run_id as f64;
            let peak_m = if run_id == 3 { 5.0 } else { 2.0 };
            let peak = PeakOfRun { run_id, amplitude_m: peak_m, time_s: 1.0 };
            candidates.add(SampleCandidate { peak, amplitude_m, end_s: 9.0, steps: 7 }, 1);
        }
        let runs: Vec<u64> = candidates.sample().iter().map(|(run, _)| run.peak.run_id).collect();
        // The run with the largest amplitude at the end is the first one.
        assert_eq!(runs, [0, 3, 4, 9, 1]);
    }
}
