//! The limit cycles of one sweep point, by class: number of runs, period, speeds, amplitude,
//! Floquet multipliers, and the angles at which balls rest or swing.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::angle_set::AngleSet;
use super::cycle_class::{CycleClass, Role, speeds_in_sense};
use super::interval::{Z_95, wilson_with_failures};
use super::observed::LabelCounts;
use super::summary_statistics::SummaryStatistics;
use crate::classification::{Label, Outcome};
use crate::model::Model;

/// Largest number of classes that are reported separately at one point; the others are counted
/// together.
pub(super) const MOST_CLASSES: usize = 1000;

/// The distribution of a quantity over the runs of a class.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleRange {
    /// Median of a period, mean of an amplitude.
    pub middle: f64,
    /// Minimum.
    pub least: f64,
    /// Maximum.
    pub greatest: f64,
}

/// Motion of the ball in one place of a class, or of the block, over the runs of the class.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleRole {
    /// The role that defines the class.
    pub role: Role,
    /// Mean speed relative to the ring over the median period, rad/s, counted in the disc's sense;
    /// 0 for a block.
    pub mean_speed: f64,
    /// Least and greatest speed relative to the ring, rad/s, in the disc's sense, or relative to
    /// the belt, m/s.
    pub speed_extremes: [f64; 2],
    /// For a ball that does not revolve: start and end of the shortest arc that contains all its
    /// angles, rad, in [0, 2π). The arc passes through 0 if its start exceeds its end.
    pub stays_between: Option<[f64; 2]>,
}

/// The runs of a point whose limit cycles are in one class.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleGroup {
    /// The class as text, [`CycleClass::UNKNOWN`] or [`CycleGroup::OTHER`].
    pub class: String,
    /// Number of runs in the class.
    pub runs: u64,
    /// Fraction of all runs of the point.
    pub fraction: f64,
    /// 95 % interval of the fraction (Wilson; failures widen it).
    pub interval: (f64, f64),
    /// The period, s: its median and its range.
    pub period_s: Option<CycleRange>,
    /// The amplitude, m: the root mean square for a table, half of the stroke for a block; its mean
    /// and its range.
    pub amplitude_m: Option<CycleRange>,
    /// The greatest displacement of the table in any run, m.
    pub amplitude_peak_m: Option<f64>,
    /// Moduli of the Floquet multipliers, descending, of the run with the largest multiplier.
    pub multipliers: Option<Vec<f64>>,
    /// Number of directions in which the cycles form a continuous family.
    pub neutral_directions: Option<u8>,
    /// The smallest friction margin of a resting ball in any run.
    pub least_margin: Option<f64>,
    /// The role of the ball in each place; empty if unknown.
    pub roles: Vec<CycleRole>,
}

impl CycleGroup {
    /// Name under which the classes in excess of the limit are counted together.
    pub const OTHER: &'static str = "other";

    /// Returns the number of balls that revolve in the ring; `None` if unknown.
    pub fn balls_running(&self) -> Option<u8> {
        let running = self.roles.iter().filter(|role| role.role.turns != 0).count();
        u8::try_from(running).ok().filter(|_| !self.roles.is_empty())
    }

    /// Returns the largest multiplier in any run; `None` if all multipliers belong to neutral
    /// directions.
    pub fn largest_multiplier(&self) -> Option<f64> {
        self.multipliers.as_ref()?.first().copied()
    }
}

/// Collects the limit cycles of one point.
///
/// Above 1000 classes, the classes with the shortest and then the alphabetically first names are
/// reported separately, so that the choice does not depend on the order of runs.
#[derive(Clone, Debug, Default)]
pub(super) struct CycleClasses {
    /// Keyed by the length of the name, then by the name.
    classes: BTreeMap<(usize, String), ClassRuns>,
    other: u64,
}

/// The runs of one class.
#[derive(Clone, Debug, Default)]
struct ClassRuns {
    runs: u64,
    period: SummaryStatistics,
    amplitude: SummaryStatistics,
    amplitude_peak: Option<f64>,
    multipliers: Option<Vec<f64>>,
    neutral_directions: Option<u8>,
    least_margin: Option<f64>,
    places: Vec<ClassPlace>,
}

/// One place of a class.
#[derive(Clone, Debug)]
struct ClassPlace {
    role: Role,
    speed_extremes: Option<[f64; 2]>,
    angles: AngleSet,
}

impl CycleClasses {
    /// Adds one run on a limit cycle of a class.
    pub(super) fn add(&mut self, model: &Model, class: CycleClass, outcome: &Outcome) {
        let key = (class.name.len(), class.name.clone());
        self.classes.entry(key).or_default().add(model, class, outcome);
        if self.classes.len() > MOST_CLASSES
            && let Some((_, last)) = self.classes.pop_last()
        {
            self.other += last.runs;
        }
    }

    /// Returns the classes, those with the most runs first, then by name; `unknown` and `other`
    /// come last. `counts` counts all runs of the point.
    pub(super) fn groups(&self, counts: &LabelCounts) -> Vec<CycleGroup> {
        let fraction = |runs: u64| {
            let (failures, total) = (counts.of(Label::Failed), counts.total());
            let fraction = if total == 0 { 0.0 } else { runs as f64 / total as f64 };
            (fraction, wilson_with_failures(runs, failures, total, Z_95))
        };
        let other = ClassRuns { runs: self.other, ..ClassRuns::default() };
        let other = (self.other > 0).then_some((CycleGroup::OTHER, &other));
        let classes =
            self.classes.iter().map(|((_, name), runs_of_class)| (name.as_str(), runs_of_class));
        let mut groups: Vec<CycleGroup> = classes
            .chain(other)
            .map(|(name, runs_of_class)| runs_of_class.group(name, fraction(runs_of_class.runs)))
            .collect();
        let last = |group: &CycleGroup| match group.class.as_str() {
            CycleGroup::OTHER => 2,
            CycleClass::UNKNOWN => 1,
            _ => 0,
        };
        groups.sort_by(|a, b| {
            let order = last(a).cmp(&last(b)).then(b.runs.cmp(&a.runs));
            order.then_with(|| a.class.cmp(&b.class))
        });
        groups
    }
}

impl ClassRuns {
    fn add(&mut self, model: &Model, class: CycleClass, outcome: &Outcome) {
        self.runs += 1;
        outcome.evidence.period_s().into_iter().for_each(|period| self.period.add(period));
        outcome.amplitude_m.into_iter().for_each(|amplitude| self.amplitude.add(amplitude));
        self.least_margin = [self.least_margin, outcome.evidence.friction_margin()]
            .into_iter()
            .flatten()
            .min_by(f64::total_cmp);
        let Some(cycle) = outcome.evidence.cycle() else { return };
        let peaks = self.amplitude_peak.into_iter().chain([cycle.peak_amplitude_m]);
        self.amplitude_peak = peaks.max_by(f64::total_cmp);
        self.neutral_directions = self.neutral_directions.max(Some(cycle.neutral_directions));
        let largest = self.multipliers.get_or_insert_default();
        if compare(&cycle.multipliers, largest) == Ordering::Greater {
            largest.clone_from(&cycle.multipliers);
        }
        if self.places.is_empty() {
            let place =
                |role| ClassPlace { role, speed_extremes: None, angles: AngleSet::default() };
            self.places = class.roles.into_iter().map(place).collect();
        }
        for (place, ball) in self.places.iter_mut().zip(class.balls) {
            let angles = cycle.position_extremes.get(ball).copied().flatten();
            let angles = angles.filter(|_| model.ball_balancer().is_some());
            angles.into_iter().flatten().for_each(|angle| place.angles.add(angle));
            if let Some(&extremes) = cycle.speed_extremes.get(ball) {
                let [least, greatest] = speeds_in_sense(model, extremes);
                let [low, high] = place.speed_extremes.get_or_insert([least, greatest]);
                *low = low.min(least);
                *high = high.max(greatest);
            }
        }
    }

    fn group(&self, name: &str, (fraction, interval): (f64, (f64, f64))) -> CycleGroup {
        let range = |middle: Option<f64>, statistics: &SummaryStatistics| {
            let [least, greatest] = statistics.ends?;
            Some(CycleRange { middle: middle?, least, greatest })
        };
        let period_s = range(self.period.median(), &self.period);
        let role = |place: &ClassPlace| CycleRole {
            role: place.role.clone(),
            mean_speed: match period_s {
                Some(period) if place.role.turns != 0 => {
                    TAU * f64::from(place.role.turns) / period.middle
                }
                _ => 0.0,
            },
            speed_extremes: place.speed_extremes.unwrap_or_default(),
            stays_between: place.angles.shortest_arc(),
        };
        CycleGroup {
            class: name.to_owned(),
            runs: self.runs,
            fraction,
            interval,
            period_s,
            amplitude_m: range(self.amplitude.mean(), &self.amplitude),
            amplitude_peak_m: self.amplitude_peak,
            multipliers: self.multipliers.clone(),
            neutral_directions: self.neutral_directions,
            least_margin: self.least_margin,
            roles: self.places.iter().map(role).collect(),
        }
    }
}

/// Compares the first two numbers that differ; if there are none, the longer list is greater.
fn compare(a: &[f64], b: &[f64]) -> Ordering {
    let numbers = a.iter().zip(b).fold(Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(b)));
    numbers.then(a.len().cmp(&b.len()))
}
