//! `cycles.parquet`: the limit cycles, with one row per point of the sweep and class of cycles.

use super::column::Column;
use super::points::PointRow;
use super::runs::{class_meaning, swept_columns};
use crate::analysis::{CycleGroup, CycleRange, CycleRole};
use crate::study::{ParameterValue, Study};

/// A class of limit cycles at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleRow {
    /// Number of the point, from 0.
    pub point_id: u64,
    /// Values of the swept parameters, in the order of [`Study::swept`].
    pub swept: Vec<ParameterValue>,
    /// The class and its runs.
    pub group: CycleGroup,
}

impl CycleRow {
    /// Creates the row of a class at a point.
    pub fn new(point: &PointRow, group: CycleGroup) -> Self {
        CycleRow { point_id: point.point_id, swept: point.swept.clone(), group }
    }
}

/// Returns the columns of `cycles.parquet`.
pub fn cycle_columns(study: &Study) -> Vec<Column<CycleRow>> {
    let balls = study.model().balls();
    let mut columns =
        vec![Column::count("point_id", "number of the sweep's point, from 0", |row: &CycleRow| {
            Some(row.point_id)
        })];
    columns.extend(swept_columns(study, |row: &CycleRow| &row.swept));
    columns.push(Column::text(
        "class",
        &(class_meaning(balls) + "; other where there are more than 1000"),
        |row: &CycleRow| Some(row.group.class.clone()),
    ));
    if balls > 0 {
        columns.push(Column::small_count(
            "balls_running",
            "balls that circulate in the ring",
            |row: &CycleRow| row.group.balls_running(),
        ));
    }
    columns.extend([
        Column::count("runs", "runs that end on a cycle of this class", |row: &CycleRow| {
            Some(row.group.runs)
        }),
        Column::number("fraction", "1", "fraction of all runs of the point", |row: &CycleRow| {
            Some(row.group.fraction)
        }),
        Column::number(
            "ci_low",
            "1",
            "lower end of its 95 % confidence interval (Wilson; counts no failed run)",
            |row: &CycleRow| Some(row.group.interval.0),
        ),
        Column::number(
            "ci_high",
            "1",
            "upper end of its 95 % confidence interval (Wilson; counts all failed runs)",
            |row: &CycleRow| Some(row.group.interval.1),
        ),
        Column::number("period_s", "s", "period: median over the runs", |row: &CycleRow| {
            row.group.period_s.map(|period| period.middle)
        }),
        Column::number("period_low_s", "s", "shortest period", |row: &CycleRow| {
            row.group.period_s.map(|period| period.least)
        }),
        Column::number("period_high_s", "s", "longest period", |row: &CycleRow| {
            row.group.period_s.map(|period| period.greatest)
        }),
    ]);
    if balls == 0 {
        columns.extend(block_columns());
    }
    for ball in 0..balls {
        columns.extend(ball_columns(ball));
    }
    if balls > 0 {
        columns.extend(table_columns());
    }
    columns.extend([
        Column::number(
            "largest_multiplier",
            "1",
            "largest modulus of the Floquet multipliers off the neutral directions in any run; \
             below 1 if the cycle is attracting",
            |row: &CycleRow| row.group.largest_multiplier(),
        ),
        Column::numbers(
            "multipliers",
            "1",
            "moduli of the Floquet multipliers of the run with the largest one, in descending \
             order",
            |row: &CycleRow| row.group.multipliers.clone(),
        ),
        Column::small_count(
            "neutral_directions",
            "dimension of the continuous family of the cycles, in which resting balls have other \
             positions",
            |row: &CycleRow| row.group.neutral_directions,
        ),
    ]);
    columns
}

fn range_columns(
    [middle, low, high]: [(&str, &str); 3],
    range: fn(&CycleGroup) -> Option<CycleRange>,
) -> [Column<CycleRow>; 3] {
    let column = |(name, meaning): (&str, &str), value: fn(CycleRange) -> f64| {
        Column::number(name, "m", meaning, move |row: &CycleRow| range(&row.group).map(value))
    };
    [
        column(middle, |range| range.middle),
        column(low, |range| range.least),
        column(high, |range| range.greatest),
    ]
}

fn table_columns() -> Vec<Column<CycleRow>> {
    let names = [
        (
            "amplitude_rms_m",
            "root-mean-square amplitude of the table's vibration over the period: mean over the \
             runs",
        ),
        ("amplitude_rms_low_m", "smallest such amplitude"),
        ("amplitude_rms_high_m", "largest such amplitude"),
    ];
    let mut columns = Vec::from(range_columns(names, |group| group.amplitude_m));
    columns.extend([
        Column::number(
            "amplitude_peak_m",
            "m",
            "largest displacement of the table in any run",
            |row: &CycleRow| row.group.amplitude_peak_m,
        ),
        Column::number(
            "min_friction_margin",
            "1",
            "smallest unused fraction of the friction limit of a resting ball in any run",
            |row: &CycleRow| row.group.least_margin,
        ),
    ]);
    columns
}

/// Returns the columns of the ball at one place of the class.
fn ball_columns(place: usize) -> Vec<Column<CycleRow>> {
    let ball = place + 1;
    let number = |name: String, unit: &str, meaning: &str, value: fn(&CycleRole) -> Option<f64>| {
        Column::number(&name, unit, meaning, move |row: &CycleRow| {
            row.group.roles.get(place).and_then(value)
        })
    };
    vec![
        Column::integer(
            &format!("turns_{ball}"),
            "turns around the ring per period of the ball at this place of the class, negative \
             against the rotation of the disc",
            move |row: &CycleRow| Some(row.group.roles.get(place)?.role.turns),
        ),
        number(
            format!("mean_speed_{ball}_rad_s"),
            "rad/s",
            "its mean speed relative to the ring in the median period, negative against the \
             rotation of the disc",
            |role| Some(role.mean_speed),
        ),
        number(
            format!("min_speed_{ball}_rad_s"),
            "rad/s",
            "its smallest speed in any run, negative against the rotation of the disc",
            |role| Some(role.speed_extremes[0]),
        ),
        number(
            format!("max_speed_{ball}_rad_s"),
            "rad/s",
            "its largest speed in any run, negative against the rotation of the disc",
            |role| Some(role.speed_extremes[1]),
        ),
        number(
            format!("rest_from_{ball}_rad"),
            "rad",
            "for a ball that rests or oscillates: start of the shortest arc that contains its \
             angles from the imbalance in all runs",
            |role| role.stays_between.map(|[from, _]| from),
        ),
        number(
            format!("rest_to_{ball}_rad"),
            "rad",
            "end of that arc; the arc contains 0 if its start is above its end",
            |role| role.stays_between.map(|[_, to]| to),
        ),
    ]
}

fn block_columns() -> Vec<Column<CycleRow>> {
    let speed = |name: &str, meaning: &str, end: usize| {
        Column::number(name, "m/s", meaning, move |row: &CycleRow| {
            row.group.roles.first().map(|role| role.speed_extremes[end])
        })
    };
    let names = [
        (
            "amplitude_m",
            "half the distance between the extreme positions of the block: mean over the runs",
        ),
        ("amplitude_low_m", "smallest such amplitude"),
        ("amplitude_high_m", "largest such amplitude"),
    ];
    let speeds = [
        speed("min_speed_m_s", "smallest speed relative to the belt in any run", 0),
        speed("max_speed_m_s", "largest speed relative to the belt in any run", 1),
    ];
    speeds.into_iter().chain(range_columns(names, |group| group.amplitude_m)).collect()
}
