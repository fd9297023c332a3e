//! The values of a point, from its finished runs or from a row of `points.parquet`.

use crate::analysis::{AuditCounts, Estimate, HalfWidths, ResidualVibration};
use crate::classification::Label;
use crate::report::data::heading;
use crate::study::{ParameterValue, Study};
use crate::table::{PointRow, Row, Table, TableError};

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

/// Reads all points, or evenly spaced ones.
pub fn read(study: &Study, table: &Table) -> Result<Vec<PointFacts>, TableError> {
    let every = table.rows().div_ceil(MOST_POINTS).max(1);
    let mut points = Vec::new();
    table.for_each(|row| {
        if row.place().is_multiple_of(every) {
            points.extend(PointFacts::in_row(study, row));
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

    /// Returns the values in a row of `points.parquet`; `None` if its number is missing. Values of swept parameters are
    /// taken from the study.
    pub fn in_row(study: &Study, row: &Row<'_>) -> Option<PointFacts> {
        let count = |name: &str| row.count(name).unwrap_or(0);
        let number = |name: &str| row.number(name);
        let (point_id, runs) = (row.count("point_id"), count("runs"));
        let interval = |name: &str| {
            let [low, high] = ["low", "high"].map(|end| row.number(&format!("{name}_{end}")));
            [low, high].map(|end| end.unwrap_or(f64::NAN))
        };
        let labels = Label::ALL.map(|label| {
            let [low, high] = interval(label.name());
            let own = count(&format!("{}_runs", label.name()));
            Fraction { low, high, ..Fraction::of(own, runs) }
        });
        let [low, high] = interval("ci");
        let fraction = number("equilibrium_fraction").unwrap_or(f64::NAN);
        let balls = study.model().kind().offers.vibration;
        let responses = study.responses().iter();
        let mut facts = PointFacts {
            point_id: 0,
            title: String::new(),
            swept: Vec::new(),
            runs,
            labels,
            equilibrium: Fraction { fraction, low, high, ..labels[0] },
            precise: row.truth("precision_reached"),
            ci_method: row.text("ci_method").unwrap_or_default(),
            time_to_rest_s: ["25", "50", "75", "95"]
                .map(|percent| number(&format!("time_to_rest_p{percent}_s"))),
            amplitude_m: ["05", "50", "95"]
                .map(|percent| number(&format!("amplitude_p{percent}_m"))),
            residual: if balls { residual(row) } else { ResidualVibration::default() },
            set_fraction: if balls { number("set_fraction") } else { None },
            audit: AuditCounts {
                runs: count("audited_runs"),
                flips: count("audit_flips"),
                rest_flips: count("audit_rest_flips"),
            },
            flip_rate: row.all(["audit_flip_rate", "audit_flip_low", "audit_flip_high"]),
            responses: responses.clone().map(|one| row.estimate(&one.column())).collect(),
            responses_without_balls: responses
                .map(|one| match balls && one.has_value_without_balls() {
                    true => number(&one.column_without_balls()),
                    false => None,
                })
                .collect(),
        };
        facts.point_id = point_id?;
        if facts.point_id < study.point_count() {
            facts.swept = study.point(facts.point_id).swept;
        }
        facts.title = title(study, facts.point_id, &facts.swept);
        Some(facts)
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
fn residual(row: &Row<'_>) -> ResidualVibration {
    let number = |name: &str| row.number(name);
    ResidualVibration {
        amplitude_without_balls_m: number("amplitude_without_balls_m"),
        relative_amplitude: ["05", "50", "95"]
            .map(|percent| number(&format!("relative_amplitude_p{percent}"))),
        worse_than_without_balls: row.all([
            "worse_than_without_balls_fraction",
            "worse_than_without_balls_low",
            "worse_than_without_balls_high",
        ]),
        balance_quality_grade_mm_s: ["50", "95"]
            .map(|percent| number(&format!("balance_quality_grade_p{percent}_mm_s"))),
        overlapping_rest_fraction: number("overlapping_rest_fraction"),
    }
}

fn title(study: &Study, point_id: u64, swept: &[ParameterValue]) -> String {
    match heading(study, swept, |_| true) {
        title if title.is_empty() => format!("point {point_id}"),
        title => title,
    }
}
