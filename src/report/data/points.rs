//! Points from `points.parquet`.

use crate::analysis::AuditCounts;
use crate::classification::Label;
use crate::report::data::heading;
use crate::study::{ParameterValue, Study};
use crate::table::{Batch, Kind, Table, TableError};

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
    /// Quartiles and 95 % quantile of time to rest, s.
    pub time_to_rest_s: [Option<f64>; 4],
    /// 5 %, 50 % and 95 % quantiles of residual amplitude, m.
    pub amplitude_m: [Option<f64>; 3],
    /// Amplitude without balls, m.
    pub without_balls_m: Option<f64>,
    /// Fraction of all ball positions that are equilibria.
    pub set_fraction: Option<f64>,
    /// Results of the audit.
    pub audit: AuditCounts,
    /// The rate of flips and its interval.
    pub flip_rate: Option<[f64; 3]>,
}

const TIMES: [&str; 4] =
    ["time_to_rest_p25_s", "time_to_rest_p50_s", "time_to_rest_p75_s", "time_to_rest_p95_s"];
const AMPLITUDES: [&str; 3] = ["amplitude_p05_m", "amplitude_p50_m", "amplitude_p95_m"];
const FLIPS: [&str; 3] = ["audit_flip_rate", "audit_flip_low", "audit_flip_high"];
const COUNTS: [&str; 5] = ["point_id", "runs", "audited_runs", "audit_flips", "audit_rest_flips"];
const FRACTION: [&str; 3] = ["equilibrium_fraction", "ci_low", "ci_high"];
const BALANCER: [&str; 2] = ["amplitude_without_balls_m", "set_fraction"];

fn of_label(label: Label, what: &str) -> String {
    format!("{}_{what}", label.name())
}

/// Reads all points, or evenly spaced ones. Values of swept parameters are taken from the study.
pub fn read(study: &Study, table: &Table) -> Result<Vec<PointFacts>, TableError> {
    let balls = study.model().balls() > 0;
    let mut columns: Vec<(String, Kind)> =
        COUNTS.iter().map(|name| ((*name).to_owned(), Kind::Count)).collect();
    columns.extend(Label::ALL.map(|label| (of_label(label, "runs"), Kind::Count)));
    let numbers = FRACTION.iter().chain(&TIMES).chain(&AMPLITUDES).chain(&FLIPS);
    let numbers = numbers.chain(BALANCER.iter().filter(|_| balls));
    columns.extend(numbers.map(|name| ((*name).to_owned(), Kind::Number)));
    for label in Label::ALL {
        columns.extend(["low", "high"].map(|end| (of_label(label, end), Kind::Number)));
    }
    let wanted: Vec<(&str, Kind)> =
        columns.iter().map(|(name, kind)| (name.as_str(), *kind)).collect();
    let every = table.rows().div_ceil(MOST_POINTS).max(1);
    let mut points = Vec::new();
    for batch in table.read(&wanted)? {
        let batch = batch?;
        for row in 0..batch.rows {
            if (batch.first_row + row as u64).is_multiple_of(every) {
                points.push(point(study, &batch, row, balls)?);
            }
        }
    }
    Ok(points)
}

fn point(study: &Study, batch: &Batch, row: usize, balls: bool) -> Result<PointFacts, TableError> {
    let number = |name: &str| Ok::<_, TableError>(batch.numbers(name)?.get(row).copied().flatten());
    let count = |name: &str| {
        Ok::<_, TableError>(batch.counts(name)?.get(row).copied().flatten().unwrap_or(0))
    };
    let many =
        |names: &[&str]| names.iter().map(|name| number(name)).collect::<Result<Vec<_>, _>>();
    let (point_id, runs) = (count("point_id")?, count("runs")?);
    let mut labels = [Fraction { runs: 0, fraction: f64::NAN, low: f64::NAN, high: f64::NAN }; 5];
    for (fraction, label) in labels.iter_mut().zip(Label::ALL) {
        let counted = count(&of_label(label, "runs"))?;
        *fraction = Fraction {
            runs: counted,
            fraction: counted as f64 / runs as f64,
            low: number(&of_label(label, "low"))?.unwrap_or(f64::NAN),
            high: number(&of_label(label, "high"))?.unwrap_or(f64::NAN),
        };
    }
    let of_equilibria: Vec<f64> =
        many(&FRACTION)?.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect();
    let equilibrium = match of_equilibria[..] {
        [fraction, low, high] => Fraction { fraction, low, high, ..labels[0] },
        _ => labels[0],
    };
    let swept =
        if point_id < study.point_count() { study.point(point_id).swept } else { Vec::new() };
    let title = match heading(study, &swept, |_| true) {
        title if title.is_empty() => format!("point {point_id}"),
        title => title,
    };
    let times = many(&TIMES)?;
    let amplitudes = many(&AMPLITUDES)?;
    let flips = many(&FLIPS)?;
    let at = |values: &[Option<f64>], index: usize| values.get(index).copied().flatten();
    Ok(PointFacts {
        point_id,
        swept,
        title,
        runs,
        labels,
        equilibrium,
        time_to_rest_s: [0, 1, 2, 3].map(|index| at(&times, index)),
        amplitude_m: [0, 1, 2].map(|index| at(&amplitudes, index)),
        without_balls_m: if balls { number(BALANCER[0])? } else { None },
        set_fraction: if balls { number(BALANCER[1])? } else { None },
        audit: AuditCounts {
            runs: count("audited_runs")?,
            flips: count("audit_flips")?,
            rest_flips: count("audit_rest_flips")?,
        },
        flip_rate: match flips[..] {
            [Some(rate), Some(low), Some(high)] => Some([rate, low, high]),
            _ => None,
        },
    })
}
