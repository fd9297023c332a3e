//! `cycles.parquet`: the limit cycles, one row per point of the sweep and class of cycles.

use super::column::Column;
use super::points::PointRow;
use super::runs::swept_columns;
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
    /// A class at a point.
    pub fn new(point: &PointRow, group: CycleGroup) -> Self {
        CycleRow { point_id: point.point_id, swept: point.swept.clone(), group }
    }
}

/// The columns of `cycles.parquet`.
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
            "balls that go round the ring",
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
            "lower end of its 95 % interval (Wilson; no failed run counted in)",
            |row: &CycleRow| Some(row.group.interval.0),
        ),
        Column::number(
            "ci_high",
            "1",
            "upper end of its 95 % interval (Wilson; all failed runs counted in)",
            |row: &CycleRow| Some(row.group.interval.1),
        ),
        Column::number("period_s", "s", "period: median over the runs", |row: &CycleRow| {
            row.group.period_s.map(|period| period.middle)
        }),
        Column::number("period_low_s", "s", "the shortest period", |row: &CycleRow| {
            row.group.period_s.map(|period| period.least)
        }),
        Column::number("period_high_s", "s", "the longest period", |row: &CycleRow| {
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
            "largest modulus of a Floquet multiplier off the neutral directions in any run; below \
             1 where cycles attract",
            |row: &CycleRow| row.group.largest_multiplier(),
        ),
        Column::numbers(
            "multipliers",
            "1",
            "moduli of the multipliers of the run that has the largest, descending",
            |row: &CycleRow| row.group.multipliers.clone(),
        ),
        Column::small_count(
            "neutral_directions",
            "dimension of the continuous family that the cycles form: resting balls may rest \
             elsewhere",
            |row: &CycleRow| row.group.neutral_directions,
        ),
    ]);
    columns
}

/// What the text of a class means.
pub(super) fn class_meaning(balls: usize) -> String {
    let parts = if balls > 0 {
        "for each ball, joined by |: rest, or turns per period, negative against the disc's \
         rotation, and for one that does several things a colon and their order: S sticks, F slips \
         forward, B slips back (the n-th letters of all balls are at one time); balls that are \
         alike have no order"
    } else {
        "0, a colon and what the block does in order: S sticks, F slips forward on the belt, B \
         slips back"
    };
    format!("class of the limit cycle: {parts}; unknown where it is only known to close")
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
            "amplitude of the table's vibration, root mean square over the period: mean over the \
             runs",
        ),
        ("amplitude_rms_low_m", "the least such amplitude"),
        ("amplitude_rms_high_m", "the greatest such amplitude"),
    ];
    let mut columns = Vec::from(range_columns(names, |group| group.amplitude_m));
    columns.extend([
        Column::number(
            "amplitude_peak_m",
            "m",
            "greatest displacement of the table in any run",
            |row: &CycleRow| row.group.amplitude_peak_m,
        ),
        Column::number(
            "min_friction_margin",
            "1",
            "least part of the friction limit that is left to a resting ball in any run",
            |row: &CycleRow| row.group.least_margin,
        ),
    ]);
    columns
}

/// Columns of the ball in one place of the class.
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
            "turns around the ring per period of the ball in this place of the class, negative \
             against the disc's rotation",
            move |row: &CycleRow| Some(row.group.roles.get(place)?.role.turns),
        ),
        number(
            format!("mean_speed_{ball}_rad_s"),
            "rad/s",
            "its mean speed relative to the ring in the median period, negative against the disc's \
             rotation",
            |role| Some(role.mean_speed),
        ),
        number(
            format!("min_speed_{ball}_rad_s"),
            "rad/s",
            "its least speed in any run, negative against the disc's rotation",
            |role| Some(role.speed_extremes[0]),
        ),
        number(
            format!("max_speed_{ball}_rad_s"),
            "rad/s",
            "its greatest speed in any run, negative against the disc's rotation",
            |role| Some(role.speed_extremes[1]),
        ),
        number(
            format!("rest_from_{ball}_rad"),
            "rad",
            "of a ball that does not go round, but rests or swings, where the shortest arc begins that \
             holds its angles from the imbalance in all runs",
            |role| role.stays_between.map(|[from, _]| from),
        ),
        number(
            format!("rest_to_{ball}_rad"),
            "rad",
            "where that arc ends; it runs through 0 where it begins above its end",
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
            "half of the way between the block's extreme positions: mean over the runs",
        ),
        ("amplitude_low_m", "the least such amplitude"),
        ("amplitude_high_m", "the greatest such amplitude"),
    ];
    let speeds = [
        speed("min_speed_m_s", "least speed relative to the belt in any run", 0),
        speed("max_speed_m_s", "greatest speed relative to the belt in any run", 1),
    ];
    speeds.into_iter().chain(range_columns(names, |group| group.amplitude_m)).collect()
}
