//! `cycles.parquet`: the limit cycles, with one row per point of the sweep and class of cycles.

use super::column::{Column, Columns};
use super::point_key::{OfPoint, add_point};
use super::runs::class_meaning;
use crate::analysis::CycleGroup;
use crate::model::Model;
use crate::study::Study;

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
