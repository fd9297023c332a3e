//! Summary of one sweep point: endings of its runs, time to rest, amplitude and what the balls leave.

use super::basin_entropy::Basins;
use super::cycle_class::CycleClass;
use super::cycles::{CycleClasses, CycleGroup};
use super::equilibrium_histogram::{EquilibriumHistogram, HistogramBin};
use super::escape::{EndedRuns, EscapeRate, escape_rate};
use super::identical_balls::{groups_of_identical, sorted_where_identical};
use super::interval::{ConfidenceInterval, IntervalMethod, Z_95, wilson_with_failures};
use super::observed::{AuditCounts, LabelCounts, ObservedRun};
use super::residual_vibration::{ResidualVibration, ResidualVibrationCounts};
use super::rest_curve::{RestStep, rest_curve};
use super::stratified::StratifiedCells;
use super::survival::{STOPPED, SurvivalCurve, rest_or_stop_time};
use super::value_counts::ValueCounts;
use crate::classification::Label;
use crate::model::Ball;

/// The data of a point's separate tables.
#[derive(Clone, Debug, PartialEq)]
pub struct PointDetail {
    /// The probability of being at rest over time.
    pub rest: Vec<RestStep>,
    /// The limit cycles, by class.
    pub cycles: Vec<CycleGroup>,
    /// Histogram of the rest positions of the balls.
    pub histogram: Vec<HistogramBin>,
}

/// Collects the runs of one point.
#[derive(Clone, Debug, Default)]
pub struct PointAccumulator {
    counts: LabelCounts,
    cells: StratifiedCells,
    basins: Basins,
    /// Times at which runs came to rest (kind 0) or were stopped while moving (kind 1). Runs that
    /// have been shown to be on a limit cycle have an infinite time.
    times: ValueCounts,
    /// Times at which runs were stopped because they are on a limit cycle (kind 1).
    cycles: ValueCounts,
    amplitudes: ValueCounts,
    residual: ResidualVibrationCounts,
    cycle_classes: CycleClasses,
    audit: AuditCounts,
    histogram: EquilibriumHistogram,
    /// The balls of the last equilibrium, and their groups of identical balls.
    identical: (Vec<Ball>, Vec<Vec<usize>>),
}

/// The statistics of one point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointSummary {
    /// Number of runs per label.
    pub counts: LabelCounts,
    /// Fraction of equilibria: of all runs, or with equal weights of all cells of a stratified
    /// design.
    pub equilibrium_fraction: f64,
    /// 95 % interval of the fraction; failures widen it.
    pub interval: ConfidenceInterval,
    /// Times by which 25, 50, 75 and 95 % of the runs have come to rest, s (Kaplan-Meier); `None`
    /// if not reached.
    pub time_to_rest_s: [Option<f64>; 4],
    /// 95 % interval of the median time to rest, s; `None` if not reached.
    pub median_interval_s: [Option<f64>; 2],
    /// The constant rate at which late runs come to rest, or `None` if there is no constant rate. A
    /// run on a limit cycle counts as moving until it was stopped.
    pub escape: Option<EscapeRate>,
    /// Quantiles 5, 50 and 95 % of the amplitude over all runs that have one, m.
    pub amplitude_m: [Option<f64>; 3],
    /// 95 % intervals of these quantiles, m; an end is `None` if the runs do not bound it.
    pub amplitude_interval_m: [[Option<f64>; 2]; 3],
    /// The basin entropy; `None` without cells with at least two runs.
    pub basin_entropy: Option<f64>,
    /// The vibration that the balls leave; all `None` for a block.
    pub residual: ResidualVibration,
    /// How often audited runs got another label.
    pub audit: AuditCounts,
}

impl PointSummary {
    /// The fractions of `time_to_rest_s`.
    pub const TIME_FRACTIONS: [f64; 4] = [0.25, 0.5, 0.75, 0.95];
    /// The fractions of `amplitude_m`.
    pub const AMPLITUDE_FRACTIONS: [f64; 3] = ResidualVibration::AMPLITUDE_FRACTIONS;
}

impl PointAccumulator {
    /// Creates an empty accumulator; `cells` is the number of cells of equal size, or `None` if the
    /// design is not stratified.
    pub fn new(cells: Option<u64>) -> Self {
        PointAccumulator {
            cells: cells.map(StratifiedCells::new).unwrap_or_default(),
            basins: cells.map(Basins::new).unwrap_or_default(),
            ..Self::default()
        }
    }

    /// Adds one run. Failed runs contribute no time and no amplitude.
    pub fn add(&mut self, run: ObservedRun<'_>) {
        let outcome = run.outcome;
        let label = outcome.label();
        self.counts.add(label);
        run.audit.into_iter().for_each(|again| self.audit.add(label, again));
        self.cells.add(run.cell, label == Label::Equilibrium, label == Label::Failed);
        if label == Label::Failed {
            return;
        }
        let (rest, end) = (outcome.time_to_rest_s(), outcome.observed_s());
        if let Some((time, kind)) = rest_or_stop_time(label, rest, end) {
            self.times.add(time, kind);
        }
        if let (Label::LimitCycle, None, Some(end)) = (label, rest, end) {
            self.cycles.add(end, STOPPED);
        }
        outcome.amplitude_m.into_iter().for_each(|amplitude| self.amplitudes.add(amplitude, 0));
        let class = run.case.and_then(|case| CycleClass::of(&case.model, outcome));
        self.basins.add(run.cell, label, class.as_ref().map(|class| class.name.as_str()));
        if let (Some(case), Some(class)) = (run.case, class) {
            self.cycle_classes.add(&case.model, class, outcome);
        }
        let machine = run.case.and_then(|case| case.model.ball_balancer());
        machine.into_iter().for_each(|machine| self.residual.add(machine, outcome));
        if let (Label::Equilibrium, Some(machine), Some(beta)) = (label, machine, &outcome.position)
        {
            let balls = &machine.balls;
            if self.identical.0 != *balls {
                self.identical = (balls.clone(), groups_of_identical(balls));
            }
            self.histogram.add(&sorted_where_identical(beta, balls), &self.identical.1);
        }
    }

    /// Returns the data of the point's separate tables. `end_times_s` are the study's end time and
    /// that of continued runs, both since the begin of the last stage.
    pub fn detail(&self, end_times_s: [f64; 2]) -> PointDetail {
        PointDetail {
            rest: rest_curve(&SurvivalCurve::new(self.times.groups()), end_times_s),
            cycles: self.cycle_classes.groups(&self.counts),
            histogram: self.histogram.bins(),
        }
    }

    /// Returns the current fraction of equilibria. The cells of a stratified design have equal
    /// weights, which differs from the fraction of all runs if an interrupted study has more runs
    /// in one cell than in another.
    pub fn equilibrium_fraction(&self) -> f64 {
        self.cells.fraction().unwrap_or_else(|| self.counts.fraction(Label::Equilibrium))
    }

    /// Returns the 95 % interval of the equilibrium fraction. It is based on the variation within
    /// cells if the design is stratified and every cell has at least two runs, and on Wilson's
    /// interval otherwise. It extends from the lower end with no failed run as an equilibrium to
    /// the upper end with all of them.
    pub fn equilibrium_interval(&self) -> ConfidenceInterval {
        if let Some((low, high)) = self.cells.interval() {
            return ConfidenceInterval { low, high, method: IntervalMethod::Stratified };
        }
        let [equilibria, failures] =
            [Label::Equilibrium, Label::Failed].map(|label| self.counts.of(label));
        let (low, high) = wilson_with_failures(equilibria, failures, self.counts.total(), Z_95);
        ConfidenceInterval { low, high, method: IntervalMethod::Wilson }
    }

    /// Returns the current 95 % interval of a quantile of the amplitude over all runs that have one, m; an end is `None`
    /// if the runs do not bound it.
    pub fn amplitude_interval(&self, fraction: f64) -> [Option<f64>; 2] {
        self.amplitudes.quantile_interval(fraction)
    }

    fn escape(&self) -> Option<EscapeRate> {
        let finite = self.times.groups().filter(|(time, _)| time.is_finite());
        let mut groups: Vec<EndedRuns> = finite.chain(self.cycles.groups()).collect();
        groups.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        escape_rate(&groups)
    }

    /// Returns the summary.
    pub fn summary(self) -> PointSummary {
        let curve = SurvivalCurve::new(self.times.groups());
        let counts = self.counts;
        PointSummary {
            counts,
            equilibrium_fraction: self.equilibrium_fraction(),
            interval: self.equilibrium_interval(),
            time_to_rest_s: PointSummary::TIME_FRACTIONS
                .map(|fraction| curve.time_to_rest_quantile(fraction)),
            median_interval_s: curve.time_to_rest_interval(0.5),
            escape: self.escape(),
            amplitude_m: PointSummary::AMPLITUDE_FRACTIONS
                .map(|fraction| self.amplitudes.quantile(fraction)),
            amplitude_interval_m: PointSummary::AMPLITUDE_FRACTIONS
                .map(|fraction| self.amplitude_interval(fraction)),
            basin_entropy: self.basins.entropy(),
            residual: self.residual.summary(counts.of(Label::Failed)),
            audit: self.audit,
        }
    }
}
