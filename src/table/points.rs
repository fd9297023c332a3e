//! `points.parquet`: one row per point of the sweep.

use super::column::Column;
use super::runs::swept_columns;
use crate::analysis::{
    AuditCounts, EscapeRate, PointSummary, is_narrow, reference_amplitude, set_fraction,
};
use crate::classification::Label;
use crate::model::{ExistenceVerdict, Machine};
use crate::study::{ParameterValue, Point, Study};

/// One point of the sweep with the results of its runs.
#[derive(Clone, Debug, PartialEq)]
pub struct PointRow {
    /// Number of the point, from 0.
    pub point_id: u64,
    /// Values of the swept parameters, in the order of [`Study::swept`].
    pub swept: Vec<ParameterValue>,
    /// Summary of its runs.
    pub summary: PointSummary,
    /// Amplitude without balls, m.
    pub amplitude_without_balls_m: Option<f64>,
    /// Fraction of all ball positions that are equilibria.
    pub set_fraction: Option<f64>,
    /// Whether stick and slip always have exactly one solution.
    pub existence: Option<ExistenceVerdict>,
}

impl PointRow {
    /// Creates the row of a point.
    pub fn new(point: &Point, summary: PointSummary) -> Self {
        PointRow {
            point_id: point.point_id,
            swept: point.swept.clone(),
            summary,
            amplitude_without_balls_m: point.model().ball_balancer().and_then(reference_amplitude),
            set_fraction: point.model().ball_balancer().and_then(set_fraction),
            existence: point.model().ball_balancer().map(Machine::existence),
        }
    }
}

/// Returns the columns of `points.parquet`.
pub fn point_columns(study: &Study) -> Vec<Column<PointRow>> {
    let mut columns =
        vec![Column::count("point_id", "number of the sweep's point, from 0", |row: &PointRow| {
            Some(row.point_id)
        })];
    columns.extend(swept_columns(study, |row: &PointRow| &row.swept));
    columns.push(Column::count(
        "runs",
        "finished runs, including failed runs",
        |row: &PointRow| Some(row.summary.counts.total()),
    ));
    for label in Label::ALL {
        columns.push(Column::count(
            &format!("{}_runs", label.name()),
            &format!("runs with the label {}", label.name()),
            move |row: &PointRow| Some(row.summary.counts.of(label)),
        ));
    }
    columns.extend([
        Column::number(
            "equilibrium_fraction",
            "1",
            "fraction of runs that ended in equilibrium by the end time (extended runs: by the \
             later end time); if ci_method is stratified, every cell has the same weight",
            |row: &PointRow| Some(row.summary.equilibrium_fraction),
        ),
        Column::number(
            "ci_low",
            "1",
            "lower end of its 95 % confidence interval (counts no failed run as equilibrium)",
            |row: &PointRow| Some(row.summary.interval.low),
        ),
        Column::number(
            "ci_high",
            "1",
            "upper end of its 95 % confidence interval (counts all failed runs as equilibrium)",
            |row: &PointRow| Some(row.summary.interval.high),
        ),
        Column::word(
            "ci_method",
            "method of the confidence interval: wilson; or stratified, from the variation within \
             the cells of the design (Yan and Su, with bounds), for at least two runs per cell and \
             at most 65,536 cells",
            |row: &PointRow| row.summary.interval.method.name(),
        ),
    ]);
    columns.extend(label_interval_columns());
    for (index, fraction) in PointSummary::TIME_FRACTIONS.into_iter().enumerate() {
        let percent = (100.0 * fraction).round();
        columns.push(Column::number(
            &format!("time_to_rest_p{percent:02}_s"),
            "s",
            &format!(
                "time by which {percent} % of the runs are at rest (Kaplan-Meier); null if \
                 not reached"
            ),
            move |row: &PointRow| row.summary.time_to_rest_s[index],
        ));
    }
    columns.extend(median_and_escape_columns());
    for (index, fraction) in PointSummary::AMPLITUDE_FRACTIONS.into_iter().enumerate() {
        let percent = (100.0 * fraction).round();
        columns.push(Column::number(
            &format!("amplitude_p{percent:02}_m"),
            "m",
            &format!("quantile {percent} % of the amplitude over all runs except failed runs"),
            move |row: &PointRow| row.summary.amplitude_m[index],
        ));
    }
    columns.push(precision_column(study));
    columns.extend(audit_columns(study));
    if study.model().balls() == 0 {
        return columns;
    }
    columns.extend([
        Column::number(
            "amplitude_without_balls_m",
            "m",
            "amplitude of the same machine without balls, whose mass is also removed",
            |row: &PointRow| row.amplitude_without_balls_m,
        ),
        Column::number(
            "set_fraction",
            "1",
            "fraction of all ball positions that are equilibria: exact for one ball, to about \
             0.001 for two and 0.005 for three or more balls; without uncertain draws",
            |row: &PointRow| row.set_fraction,
        ),
        Column::word(
            "uniqueness",
            "unique: stick and slip provably have exactly one solution at all positions and for \
             all forces; not_unique: some runs may end in no_solution; without uncertain draws",
            |row: &PointRow| row.existence.as_ref().map_or("", ExistenceVerdict::word),
        ),
        Column::number(
            "min_principal_minor",
            "1",
            "criterion of uniqueness: the smallest principal minor of the contact matrix over all \
             positions, divided by the product of its diagonal entries; 1 if the balls are not \
             coupled, 0 or less if the solution is not unique",
            |row: &PointRow| row.existence.as_ref().map(ExistenceVerdict::least_minor),
        ),
    ]);
    columns
}

/// Whether the fraction of equilibria reaches the requested precision; null in a study without a
/// precision.
fn precision_column(study: &Study) -> Column<PointRow> {
    let widest = study.precision().map(|precision| precision.equilibrium_fraction);
    Column::truth(
        "precision_reached",
        "whether the half width of ci_low to ci_high is at most the precision of the study; null \
         without a precision",
        move |row: &PointRow| widest.map(|widest| is_narrow(row.summary.interval.ends(), widest)),
    )
}

/// How often the label of an audited run changes; null in a study without an audit.
fn audit_columns(study: &Study) -> [Column<PointRow>; 6] {
    let has_audit = study.audit().is_some();
    let count = |name: &str, meaning: &str, value: fn(&AuditCounts) -> u64| {
        Column::count(name, meaning, move |row: &PointRow| {
            has_audit.then(|| value(&row.summary.audit))
        })
    };
    let fraction = |name: &str, meaning: &str, value: fn(&AuditCounts) -> Option<f64>| {
        Column::number(name, "1", meaning, move |row: &PointRow| {
            has_audit.then(|| value(&row.summary.audit)).flatten()
        })
    };
    [
        count(
            "audited_runs",
            "runs recomputed by the other method with a tenth of both tolerances; null without an \
             audit",
            |audit| audit.runs,
        ),
        count("audit_flips", "audited runs whose label changed", |audit| audit.flips),
        count(
            "audit_rest_flips",
            "audited runs that were an equilibrium in only one of the two computations",
            |audit| audit.rest_flips,
        ),
        fraction(
            "audit_flip_rate",
            "fraction of audited runs whose label changed",
            AuditCounts::flip_rate,
        ),
        fraction("audit_flip_low", "lower end of its 95 % confidence interval (Wilson)", |audit| {
            Some(audit.interval().0)
        }),
        fraction(
            "audit_flip_high",
            "upper end of its 95 % confidence interval (Wilson)",
            |audit| Some(audit.interval().1),
        ),
    ]
}

/// Simultaneous confidence intervals of the fractions of all labels.
fn label_interval_columns() -> impl Iterator<Item = Column<PointRow>> {
    Label::ALL.into_iter().enumerate().flat_map(|(index, label)| {
        let name = label.name();
        let failures = match label {
            Label::Failed => "",
            _ => "; counts all failed runs as this label",
        };
        [
            Column::number(
                &format!("{name}_low"),
                "1",
                &format!(
                    "lower end of the confidence interval of the fraction of {name} runs; the \
                     intervals of all labels hold simultaneously with 95 % (Goodman, with \
                     Bonferroni's points)"
                ),
                move |row: &PointRow| Some(row.summary.counts.intervals()[index].0),
            ),
            Column::number(
                &format!("{name}_high"),
                "1",
                &format!("upper end of that interval{failures}"),
                move |row: &PointRow| Some(row.summary.counts.intervals()[index].1),
            ),
        ]
    })
}

/// The confidence interval of the median time to rest, and the rate at which late runs come to
/// rest.
fn median_and_escape_columns() -> [Column<PointRow>; 6] {
    let median = |end: usize, name: &str, meaning: &str| {
        Column::number(name, "s", meaning, move |row: &PointRow| row.summary.median_interval_s[end])
    };
    let escape = |name: &str, unit: &str, meaning: &str, value: fn(&EscapeRate) -> f64| {
        Column::number(name, unit, meaning, move |row: &PointRow| {
            row.summary.escape.as_ref().map(value)
        })
    };
    [
        median(
            0,
            "time_to_rest_p50_low_s",
            "lower end of the 95 % confidence interval of the median time to rest (Brookmeyer and \
             Crowley, log(-log) curve)",
        ),
        median(1, "time_to_rest_p50_high_s", "upper end of that interval; null if not reached"),
        escape(
            "escape_rate_per_s",
            "1/s",
            "constant rate at which runs that still move after escape_from_s come to rest; null if \
             no tail with at least 10 rests and a tenth of all rests is exponential",
            |escape| escape.rate_per_s,
        ),
        escape(
            "escape_rate_low_per_s",
            "1/s",
            "lower end of its 95 % confidence interval (Garwood)",
            |escape| escape.interval_per_s.0,
        ),
        escape(
            "escape_rate_high_per_s",
            "1/s",
            "upper end of its 95 % confidence interval (Garwood)",
            |escape| escape.interval_per_s.1,
        ),
        escape(
            "escape_from_s",
            "s",
            "earliest time after which a constant rate is not rejected (Kolmogorov, level 0.1)",
            |escape| escape.from_s,
        ),
    ]
}
