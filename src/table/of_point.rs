//! Tables with any number of rows per point of the sweep, and the columns that identify the point: `time_to_rest.parquet`,
//! `equilibrium_histogram.parquet` and `cycles.parquet`.

use super::column::{Column, Columns};
use super::runs::{add_swept, class_meaning};
use crate::analysis::{CycleGroup, HistogramBin, RestStep, bin_edges};
use crate::model::Model;
use crate::study::{ParameterValue, Point, Study};

/// The point of the sweep that a row belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct PointKey {
    /// Number of the point, from 0.
    pub point_id: u64,
    /// Values of the swept parameters, in the order of [`crate::study::Plan::swept`].
    pub swept: Vec<ParameterValue>,
}

impl PointKey {
    /// Returns the key of a point.
    pub fn of(point: &Point) -> Self {
        PointKey { point_id: point.point_id, swept: point.swept.clone() }
    }
}

/// A row of a table that has any number of rows for each point.
#[derive(Clone, Debug, PartialEq)]
pub struct OfPoint<T> {
    /// The point.
    pub point: PointKey,
    /// The other values of the row.
    pub value: T,
}

impl<T> OfPoint<T> {
    /// Creates a row of a point.
    pub fn new(point: &PointKey, value: T) -> Self {
        OfPoint { point: point.clone(), value }
    }
}

/// Adds the columns that identify the point of the sweep; `point` gets it from a row.
pub(crate) fn add_point<R: 'static>(
    list: &mut Columns<R>,
    study: &Study,
    point: impl Fn(&R) -> &PointKey + Copy + Send + Sync + 'static,
) {
    list.point_id(move |row| point(row).point_id);
    add_swept(list, study, move |row| &point(row).swept);
}

/// The state of a point's curve at a time.
pub type RestRow = OfPoint<RestStep>;

/// Returns the columns of `time_to_rest.parquet`.
pub fn rest_columns(study: &Study) -> Vec<Column<RestRow>> {
    let mut list = Columns::new();
    add_point(&mut list, study, |row: &RestRow| &row.point);
    list.number("time_s", "s", |row| row.value.time_s).meaning("simulated time");
    list.count("at_risk", |row| row.value.at_risk).meaning(
        "runs at risk just before this time, without failed runs; if the curve is thinned to 1000 \
         rows, before the first rest after the preceding row",
    );
    list.count("came_to_rest", |row| row.value.came_to_rest)
        .meaning("runs that came to rest after the preceding row, up to and including this time");
    list.count("censored", |row| row.value.censored).meaning(
        "censored runs: stopped while moving before the next row; limit cycles count at the last \
         end time",
    );
    list.number("probability_at_rest", "1", |row| row.value.probability)
        .meaning("probability of being at rest by this time (Kaplan-Meier)");
    list.number("ci_low", "1", |row| row.value.interval.0).meaning(
        "lower end of its 95 % confidence interval (Greenwood, log(-log); exact binomial at 0 and \
         1)",
    );
    list.number("ci_high", "1", |row| row.value.interval.1)
        .meaning("upper end of its 95 % confidence interval");
    list.finish()
}

/// An occupied bin at a point.
pub type HistogramRow = OfPoint<HistogramBin>;

/// Returns the columns of `equilibrium_histogram.parquet`. For one or two balls, a bin has the
/// angles of all balls; for more balls, it has the angle of one ball. A sweep over the number of
/// balls has the columns of all its numbers.
pub fn histogram_columns(study: &Study) -> Vec<Column<HistogramRow>> {
    let (fewest, most) = study.numbers_of_balls().into_inner();
    let angles = if fewest > 2 { 1 } else { most.min(2) };
    let mut list = Columns::new();
    add_point(&mut list, study, |row: &HistogramRow| &row.point);
    if most > 2 {
        list.count("ball", |row| (row.value.bins.len() == 1).then_some(row.value.ball as u64 + 1)).meaning(
            "first ball of the group of identical balls, from 1; the row counts the angle of each \
             ball of the group separately",
        );
    }
    for angle in 0..angles {
        let number = angle + 1;
        list.count(format!("bin_{number}"), move |row| {
            row.value.bins.get(angle).map(|&bin| bin as u64)
        })
        .meaning(
            "interval of the angle, from 0, 10° wide; for two identical balls, the smaller angle comes \
             first; for three or more balls, the angle of any ball in the group of the column ball",
        );
        for (end, word, verb) in [(0, "from", "begins"), (1, "to", "ends")] {
            list.number(format!("beta_{number}_{word}_rad"), "rad", move |row| {
                row.value.bins.get(angle).map(|&bin| bin_edges(bin)[end])
            })
            .meaning(format!("angle from the imbalance at which the bin {verb}"));
        }
    }
    list.count("runs", |row| row.value.runs).meaning(
        "equilibria in the bin; for three or more balls, equilibria with at least one ball of the \
         group in the bin",
    );
    list.number("fraction", "1", |row| row.value.fraction)
        .meaning("fraction of all equilibria of the point");
    list.number("ci_low", "1", |row| row.value.interval.0)
        .meaning("lower end of its 95 % confidence interval (Wilson)");
    list.number("ci_high", "1", |row| row.value.interval.1)
        .meaning("upper end of its 95 % confidence interval (Wilson)");
    list.finish()
}

/// A class of limit cycles at a point, with its runs.
pub type CycleRow = OfPoint<CycleGroup>;

/// Returns the columns of `cycles.parquet`.
pub fn cycle_columns(study: &Study) -> Vec<Column<CycleRow>> {
    let balls = study.model().balls();
    let mut list = Columns::new();
    add_point(&mut list, study, |row: &CycleRow| &row.point);
    list.text("class", |row| row.value.class.clone()).meaning(
        class_meaning(study.model())
            + "; other for the remaining classes if there are more than 1000",
    );
    if balls > 0 {
        list.small_count("balls_running", |row| row.value.balls_running())
            .meaning("balls that circulate in the ring");
    }
    list.count("runs", |row| row.value.runs).meaning("runs that end on a cycle of this class");
    list.number("fraction", "1", |row| row.value.fraction)
        .meaning("fraction of all runs of the point");
    list.number("ci_low", "1", |row| row.value.interval.0)
        .meaning("lower end of its 95 % confidence interval (Wilson; counts no failed run)");
    list.number("ci_high", "1", |row| row.value.interval.1)
        .meaning("upper end of its 95 % confidence interval (Wilson; counts all failed runs)");
    list.number("period_s", "s", |row| row.value.period_s.map(|period| period.middle))
        .meaning("period: median over the runs");
    list.number("period_low_s", "s", |row| row.value.period_s.map(|period| period.least))
        .meaning("shortest period");
    list.number("period_high_s", "s", |row| row.value.period_s.map(|period| period.greatest))
        .meaning("longest period");
    if study.model().ball_balancer().is_none() {
        for contact in 0..study.model().contacts() {
            add_sliding_speed(&mut list, study.model(), contact);
        }
        let meaning = "half the distance between the extreme positions of the block: mean over \
                       the runs";
        add_amplitude(&mut list, ["amplitude_m", "amplitude_low_m", "amplitude_high_m"], meaning);
    }
    for ball in 0..balls {
        add_ball(&mut list, ball);
    }
    if balls > 0 {
        let names = ["amplitude_rms_m", "amplitude_rms_low_m", "amplitude_rms_high_m"];
        let meaning = "root-mean-square amplitude of the table's vibration over the period: mean \
                       over the runs";
        add_amplitude(&mut list, names, meaning);
        list.number("amplitude_peak_m", "m", |row| row.value.amplitude_peak_m)
            .meaning("largest displacement of the table in any run");
        list.number("min_friction_margin", "1", |row| row.value.least_margin)
            .meaning("smallest unused fraction of the friction limit of a resting ball in any run");
    }
    list.number("largest_multiplier", "1", |row| row.value.largest_multiplier()).meaning(
        "largest modulus of the Floquet multipliers, without those of neutral directions, in any \
         run; below 1 if the cycle is attracting",
    );
    list.numbers("multipliers", "1", |row| row.value.multipliers.clone()).meaning(
        "moduli of the Floquet multipliers of the run with the largest one, in descending order",
    );
    list.small_count("neutral_directions", |row| row.value.neutral_directions).meaning(
        "dimension of the continuous family to which the cycles belong; its members differ in the \
         positions of the resting balls",
    );
    list.finish()
}

/// Adds the extreme sliding speeds of a contact of a model without balls.
fn add_sliding_speed(list: &mut Columns<CycleRow>, model: &Model, contact: usize) {
    let (ending, unit) = model.sliding_speed_unit(contact);
    for (end, name, word) in [(0, "min_speed", "smallest"), (1, "max_speed", "largest")] {
        list.number(format!("{name}{ending}"), &unit, move |row| {
            row.value.roles.get(contact).map(|role| role.speed_extremes[end])
        })
        .meaning(format!("{word} sliding speed in any run"));
    }
}

/// Adds mean, least and greatest amplitude.
fn add_amplitude(list: &mut Columns<CycleRow>, [mean, low, high]: [&str; 3], meaning: &str) {
    list.number(mean, "m", |row| row.value.amplitude_m.map(|range| range.middle)).meaning(meaning);
    list.number(low, "m", |row| row.value.amplitude_m.map(|range| range.least))
        .meaning("smallest amplitude over the runs");
    list.number(high, "m", |row| row.value.amplitude_m.map(|range| range.greatest))
        .meaning("largest amplitude over the runs");
}

/// Adds the columns of the ball at one place of the class.
fn add_ball(list: &mut Columns<CycleRow>, place: usize) {
    let ball = place + 1;
    list.integer(format!("turns_{ball}"), move |row| {
        row.value.roles.get(place).map(|role| role.role.turns)
    })
    .meaning(
        "turns around the ring per period of the ball at this place of the class, negative against \
         the rotation of the disc",
    );
    list.number(format!("mean_speed_{ball}_rad_s"), "rad/s", move |row| {
        row.value.roles.get(place).map(|role| role.mean_speed)
    })
    .meaning(
        "mean speed of that ball relative to the ring over the median period, negative against the \
         rotation of the disc",
    );
    for (end, name, word) in [(0, "min_speed", "smallest"), (1, "max_speed", "largest")] {
        list.number(format!("{name}_{ball}_rad_s"), "rad/s", move |row| {
            row.value.roles.get(place).map(|role| role.speed_extremes[end])
        })
        .meaning(format!(
            "{word} speed of that ball in any run, negative against the rotation of the disc"
        ));
    }
    list.number(format!("rest_from_{ball}_rad"), "rad", move |row| {
        row.value.roles.get(place)?.stays_between.map(|[from, _]| from)
    })
    .meaning(
        "for a ball that rests or oscillates: start of the shortest arc that contains its angles \
         from the imbalance in all runs",
    );
    list.number(format!("rest_to_{ball}_rad"), "rad", move |row| {
        row.value.roles.get(place)?.stays_between.map(|[_, to]| to)
    })
    .meaning("end of that arc; the arc contains 0 if its start is above its end");
}
