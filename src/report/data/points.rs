//! The values of a point, from its finished runs or from a row of `points.parquet`.

use crate::analysis::{AuditCounts, Estimate, HalfWidths, ResidualVibration};
use crate::classification::Label;
use crate::report::data::heading;
use crate::study::{ParameterValue, Response, Study};
use crate::table::{Batch, Kind, PointRow, Table, TableError, estimate_kinds, read_estimate};

/// The largest number of points in memory; of larger sweeps every second, third and so on is read.
const MOST_POINTS: u64 = 50_000;

/// A fraction of a point's runs with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fraction {
    /// Number of runs.
    pub runs: u64,
    /// The fraction.
    pub fraction: f64,
    /// Lower end of its interval.
    pub low: f64,
    /// Upper end of its interval.
    pub high: f64,
}

/// The values of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct PointFacts {
    /// Number of the point.
    pub point_id: u64,
    /// Values of the swept parameters.
    pub swept: Vec<ParameterValue>,
    /// The values that distinguish the point, in words; `point 0` if nothing is swept.
    pub title: String,
    /// Finished runs.
    pub runs: u64,
    /// Fractions of the labels, in the order of [`Label::ALL`].
    pub labels: [Fraction; 5],
    /// Fraction of equilibria with the interval that the study asks for, which includes failures.
    pub equilibrium: Fraction,
    /// Whether the intervals are as narrow as the study's precision requires; `None` without a precision.
    pub precise: Option<bool>,
    /// Method of that interval.
    pub ci_method: String,
    /// Quartiles and 95 % quantile of time to rest, s.
    pub time_to_rest_s: [Option<f64>; 4],
    /// 5 %, 50 % and 95 % quantiles of residual amplitude, m.
    pub amplitude_m: [Option<f64>; 3],
    /// What the balls leave: the comparison with the machine without balls, balance quality and overlaps.
    pub residual: ResidualVibration,
    /// Fraction of all ball positions that are equilibria.
    pub set_fraction: Option<f64>,
    /// Results of the audit.
    pub audit: AuditCounts,
    /// The rate of flips and its interval.
    pub flip_rate: Option<[f64; 3]>,
    /// One estimate per response of the study.
    pub responses: Vec<Estimate>,
    /// The value of each response for the machines without balls, if they have one.
    pub responses_without_balls: Vec<Option<f64>>,
}

const TIMES: [&str; 4] =
    ["time_to_rest_p25_s", "time_to_rest_p50_s", "time_to_rest_p75_s", "time_to_rest_p95_s"];
const AMPLITUDES: [&str; 3] = ["amplitude_p05_m", "amplitude_p50_m", "amplitude_p95_m"];
const FLIPS: [&str; 3] = ["audit_flip_rate", "audit_flip_low", "audit_flip_high"];
const COUNTS: [&str; 5] = ["point_id", "runs", "audited_runs", "audit_flips", "audit_rest_flips"];
const METHOD: &str = "ci_method";
const PRECISE: &str = "precision_reached";
const FRACTION: [&str; 3] = ["equilibrium_fraction", "ci_low", "ci_high"];
const WITHOUT_BALLS: &str = "amplitude_without_balls_m";
const SET_FRACTION: &str = "set_fraction";
const RELATIVE: [&str; 3] =
    ["relative_amplitude_p05", "relative_amplitude_p50", "relative_amplitude_p95"];
const WORSE: [&str; 3] = [
    "worse_than_without_balls_fraction",
    "worse_than_without_balls_low",
    "worse_than_without_balls_high",
];
const GRADES: [&str; 2] = ["balance_quality_grade_p50_mm_s", "balance_quality_grade_p95_mm_s"];
const OVERLAPPING: &str = "overlapping_rest_fraction";

fn of_label(label: Label, what: &str) -> String {
    format!("{}_{what}", label.name())
}

/// Returns `k` if one of every `k` points is read.
pub fn every(table: &Table) -> u64 {
    table.rows().div_ceil(MOST_POINTS).max(1)
}

/// Reads all points, or evenly spaced ones. Values of swept parameters are taken from the study.
pub fn read(study: &Study, table: &Table) -> Result<Vec<PointFacts>, TableError> {
    let mut points = Vec::new();
    PointFacts::for_each(study, table, every(table), |point| points.push(point))?;
    Ok(points)
}

impl PointFacts {
    /// Returns the values of a point whose runs have finished.
    pub fn of(study: &Study, row: &PointRow) -> Self {
        let PointRow { point_id, swept, summary, set_fraction, responses, .. } = row;
        let (counts, runs) = (&summary.counts, summary.counts.total());
        let intervals = counts.intervals();
        let mut labels = Label::ALL.map(|label| Fraction::of(counts.of(label), runs));
        for (fraction, (low, high)) in labels.iter_mut().zip(intervals) {
            *fraction = Fraction { low, high, ..*fraction };
        }
        let (low, high) = summary.interval.ends();
        let fraction = summary.equilibrium_fraction;
        let (audit, (flip_low, flip_high)) = (summary.audit, summary.audit.interval());
        PointFacts {
            point_id: *point_id,
            swept: swept.clone(),
            title: title(study, *point_id, swept),
            runs,
            labels,
            equilibrium: Fraction { fraction, low, high, ..labels[0] },
            precise: study.precision().map(|own| HalfWidths::from(own).reached(summary)),
            ci_method: summary.interval.method.name().to_owned(),
            time_to_rest_s: summary.time_to_rest_s,
            amplitude_m: summary.amplitude_m,
            residual: summary.residual,
            set_fraction: *set_fraction,
            audit,
            flip_rate: audit.flip_rate().map(|rate| [rate, flip_low, flip_high]),
            responses: responses.clone(),
            responses_without_balls: row.responses_without_balls.clone(),
        }
    }

    /// Reads one of every `every` points of `points.parquet` and passes each to `take`.
    ///
    /// # Errors
    /// Returns an error if the table lacks a column or cannot be read.
    pub fn for_each(
        study: &Study,
        table: &Table,
        every: u64,
        mut take: impl FnMut(PointFacts),
    ) -> Result<(), TableError> {
        let balls = study.model().kind().offers.vibration;
        let of_labels = |what| Label::ALL.map(|label| of_label(label, what));
        let [runs, low, high] = ["runs", "low", "high"].map(of_labels);
        let counts = COUNTS.into_iter().chain(runs.iter().map(String::as_str));
        let numbers = FRACTION.iter().chain(&TIMES).chain(&AMPLITUDES).chain(&FLIPS);
        let balancer = [&WITHOUT_BALLS, &SET_FRACTION, &OVERLAPPING].into_iter();
        let balancer = balancer.chain(&RELATIVE).chain(&WORSE).chain(&GRADES);
        let numbers = numbers.chain(balancer.filter(|_| balls)).copied();
        let numbers = numbers.chain(low.iter().chain(&high).map(String::as_str));
        let responses: Vec<(String, Kind)> =
            study.responses().iter().flat_map(|one| estimate_kinds(&one.column())).collect();
        let mut columns: Vec<(&str, Kind)> = counts.map(|name| (name, Kind::Count)).collect();
        columns.extend(responses.iter().map(|(name, kind)| (name.as_str(), *kind)));
        let without_balls = study.responses().iter().filter(|one| one.has_value_without_balls());
        let without_balls: Vec<String> =
            without_balls.filter(|_| balls).map(Response::column_without_balls).collect();
        columns.extend(without_balls.iter().map(|name| (name.as_str(), Kind::Number)));
        columns.extend(numbers.map(|name| (name, Kind::Number)));
        columns.extend([(METHOD, Kind::Text), (PRECISE, Kind::Boolean)]);
        for batch in table.read(&columns)? {
            let batch = batch?;
            for row in 0..batch.rows {
                if (batch.first_row + row as u64).is_multiple_of(every) {
                    take(Self::in_row(study, &batch, row)?);
                }
            }
        }
        Ok(())
    }

    fn in_row(study: &Study, batch: &Batch, row: usize) -> Result<PointFacts, TableError> {
        let number = |name: &str| batch.number(name, row);
        // A missing count belongs to a kind of run that did not occur.
        let count = |name: &str| Ok::<_, TableError>(batch.count(name, row)?.unwrap_or(0));
        let value = |name: &str| Ok::<_, TableError>(number(name)?.unwrap_or(f64::NAN));
        let (point_id, runs) = (count(COUNTS[0])?, count(COUNTS[1])?);
        let mut labels = [Fraction::of(0, runs); 5];
        for (fraction, label) in labels.iter_mut().zip(Label::ALL) {
            let [low, high] = ["low", "high"].map(|end| value(&of_label(label, end)));
            *fraction = Fraction {
                low: low?,
                high: high?,
                ..Fraction::of(count(&of_label(label, "runs"))?, runs)
            };
        }
        let [fraction, low, high] = FRACTION.map(value);
        let [rate, flip_low, flip_high] = FLIPS.map(number);
        let flip_rate = rate?.zip(flip_low?).zip(flip_high?);
        let balls = study.model().kind().offers.vibration;
        let set_fraction = if balls { number(SET_FRACTION)? } else { None };
        let residual = if balls { residual(batch, row)? } else { ResidualVibration::default() };
        let swept =
            if point_id < study.point_count() { study.point(point_id).swept } else { Vec::new() };
        let without_balls =
            study.responses().iter().map(|one| match balls && one.has_value_without_balls() {
                true => number(&one.column_without_balls()),
                false => Ok(None),
            });
        let responses = study.responses().iter();
        let responses = responses.map(|one| read_estimate(batch, &one.column(), row));
        let [p25, p50, p75, p95] = TIMES.map(number);
        let [p05, median, p95_m] = AMPLITUDES.map(number);
        Ok(PointFacts {
            point_id,
            title: title(study, point_id, &swept),
            swept,
            runs,
            labels,
            equilibrium: Fraction { fraction: fraction?, low: low?, high: high?, ..labels[0] },
            precise: batch.truth(PRECISE, row)?,
            ci_method: batch.text(METHOD, row)?.unwrap_or_default(),
            time_to_rest_s: [p25?, p50?, p75?, p95?],
            amplitude_m: [p05?, median?, p95_m?],
            residual,
            set_fraction,
            audit: AuditCounts {
                runs: count(COUNTS[2])?,
                flips: count(COUNTS[3])?,
                rest_flips: count(COUNTS[4])?,
            },
            flip_rate: flip_rate.map(|((rate, low), high)| [rate, low, high]),
            responses: responses.collect::<Result<_, _>>()?,
            responses_without_balls: without_balls.collect::<Result<_, _>>()?,
        })
    }

    /// Returns the number of rests at which balls overlap.
    pub fn overlapping_rests(&self) -> u64 {
        let fraction = self.residual.overlapping_rest_fraction.unwrap_or(0.0);
        (fraction * self.equilibrium.runs as f64).round() as u64
    }

    /// Returns the runs with this label.
    pub fn label(&self, label: Label) -> Fraction {
        let found = Label::ALL.iter().zip(self.labels).find(|(other, _)| **other == label);
        found.map_or(Fraction::of(0, self.runs), |(_, fraction)| fraction)
    }
}

impl Fraction {
    /// Returns the fraction of `runs` in `all` runs, without an interval.
    fn of(runs: u64, all: u64) -> Self {
        Fraction { runs, fraction: runs as f64 / all as f64, low: f64::NAN, high: f64::NAN }
    }
}

/// Reads what the balls leave.
fn residual(batch: &Batch, row: usize) -> Result<ResidualVibration, TableError> {
    let number = |name: &str| batch.number(name, row);
    let [fraction, low, high] = WORSE.map(number);
    let worse = fraction?.zip(low?).zip(high?);
    let [median, p95] = GRADES.map(number);
    let [relative_p05, relative_p50, relative_p95] = RELATIVE.map(number);
    Ok(ResidualVibration {
        amplitude_without_balls_m: number(WITHOUT_BALLS)?,
        relative_amplitude: [relative_p05?, relative_p50?, relative_p95?],
        worse_than_without_balls: worse.map(|((fraction, low), high)| [fraction, low, high]),
        balance_quality_grade_mm_s: [median?, p95?],
        overlapping_rest_fraction: number(OVERLAPPING)?,
    })
}

fn title(study: &Study, point_id: u64, swept: &[ParameterValue]) -> String {
    match heading(study, swept, |_| true) {
        title if title.is_empty() => format!("point {point_id}"),
        title => title,
    }
}
