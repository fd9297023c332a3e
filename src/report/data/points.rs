//! The values of a point as people read them, from its row.

use crate::analysis::{AuditCounts, Estimate, HalfWidths, ResidualVibration};
use crate::classification::Label;
use crate::report::data::heading;
use crate::study::{ParameterValue, Study};
use crate::table::{PointRow, Table, TableError, point_columns};

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
    pub labels: [Fraction; Label::ALL.len()],
    /// Fraction of equilibria with the interval that the study asks for, which includes failures.
    pub equilibrium: Fraction,
    /// Whether the intervals are as narrow as the study's precision requires; `None` without a precision.
    pub precise: Option<bool>,
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

/// Reads all points of the study, or evenly spaced ones.
pub fn read(study: &Study, table: &Table) -> Result<Vec<PointFacts>, TableError> {
    let every = table.rows().div_ceil(MOST_POINTS).max(1);
    let (columns, mut points) = (point_columns(study), Vec::new());
    table.for_each(|row| {
        if row.place().is_multiple_of(every) {
            let point = PointRow::read(study, &columns, row);
            let point = point.filter(|point| point.point_id < study.point_count());
            points.extend(point.map(|point| PointFacts::of(study, &point)));
        }
    })?;
    Ok(points)
}

impl PointFacts {
    /// Returns the values of a point whose runs have finished.
    pub fn of(study: &Study, row: &PointRow) -> Self {
        let PointRow { point_id, swept, summary, set_fraction, responses, .. } = row;
        let (counts, runs) = (&summary.counts, summary.counts.total());
        let intervals = counts.intervals();
        let labels = Label::ALL.map(|label| {
            let (of_label, (low, high)) = (counts.of(label), intervals[label as usize]);
            Fraction { runs: of_label, fraction: of_label as f64 / runs as f64, low, high }
        });
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
            precise: study.precision().map(|wanted| HalfWidths::from(wanted).reached(summary)),
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

    /// Returns the number of rests at which balls overlap.
    pub fn overlapping_rests(&self) -> u64 {
        let fraction = self.residual.overlapping_rest_fraction.unwrap_or(0.0);
        (fraction * self.equilibrium.runs as f64).round() as u64
    }

    /// Returns the runs with this label.
    pub fn label(&self, label: Label) -> Fraction {
        self.labels[label as usize]
    }
}

fn title(study: &Study, point_id: u64, swept: &[ParameterValue]) -> String {
    match heading(study, swept, |_| true) {
        title if title.is_empty() => format!("point {point_id}"),
        title => title,
    }
}
