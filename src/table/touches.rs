//! Contact between bodies in the tables of a replay: the columns of gaps in `trajectory.parquet`, and `touches.parquet`.

use super::column::{Column, Columns, NON_DIMENSIONAL};
use super::motion_values::phase_name;
use crate::classification::{MotionSample, Touch};
use crate::model::{Model, SlidingSpeed, wrap_to_two_pi};
use crate::motion::Phase;

/// Adds width and contact of each gap, between the contacts `[behind, ahead]`.
pub(super) fn add_gaps(list: &mut Columns<MotionSample>, model: &Model, gaps: &[[usize; 2]]) {
    let factor = model.units().contacts.first().map_or(f64::NAN, |contact| contact.position);
    let unit = position_unit(model);
    let body = model.kind().body;
    for (index, &contacts) in gaps.iter().enumerate() {
        let [behind, ahead] = contacts.map(|contact| contact + 1);
        let gap = move |row: &MotionSample| row.gaps.get(index).copied();
        list.number(format!("gap_{behind}_{ahead}_{unit}"), unit, move |row| {
            gap(row).map(|gap| gap.width * factor)
        })
        .meaning(format!(
            "width of the gap from {body} {behind} forward to {body} {ahead}; 0 where they touch"
        ));
        list.boolean(format!("touching_{behind}_{ahead}"), move |row| {
            gap(row).map(|gap| gap.phase == Phase::Closed)
        })
        .meaning(format!("whether {body} {behind} and {body} {ahead}, which is ahead, touch"));
    }
}

/// Returns the columns of `touches.parquet`.
pub fn touch_columns(model: &Model) -> Vec<Column<Touch>> {
    let units = model.units();
    let factor = units.contacts.first().map_or(f64::NAN, |contact| contact.position);
    let natural = units.natural_rad_s;
    let (body, unit) = (model.kind().body, position_unit(model));
    let mut list = Columns::<Touch>::new();
    list.number("time_s", "s", move |row| row.time / natural).meaning("time since the start");
    list.count(format!("{body}_behind"), |row| row.after.contacts[0] as u64 + 1)
        .meaning(format!("number of the {body} behind the gap, from 1"));
    list.count(format!("{body}_ahead"), |row| row.after.contacts[1] as u64 + 1)
        .meaning(format!("number of the {body} ahead of the gap, from 1"));
    list.word("from", |row| phase_name(row.before.phase)).meaning(
        "gap before: open, and the event is an impact; or closed, and the event is the end of lasting contact",
    );
    list.word("to", |row| phase_name(row.after.phase))
        .meaning("gap after: closed in lasting contact, otherwise open");
    let is_angle = unit == "rad";
    for (side, name) in ["behind", "ahead"].into_iter().enumerate() {
        let (column, place) = match model.ball_balancer() {
            Some(_) => (format!("beta_{name}_rad"), "angle, in [0, 2π),"),
            None => (format!("position_{name}_{unit}"), "position"),
        };
        list.number(column, unit, move |row| {
            let position = row.positions[side] * factor;
            if is_angle { wrap_to_two_pi(position) } else { position }
        })
        .meaning(format!("{place} of the {body} {name} of the gap"));
    }
    let speed_unit = format!("{unit}/s");
    let before = units.clone();
    list.number(format!("opening_speed_before_{unit}_s"), &speed_unit, move |row| {
        before.opening_speed(&row.before)
    })
    .meaning("speed at which the gap opens, just before; negative where it closes");
    list.number(format!("opening_speed_after_{unit}_s"), &speed_unit, move |row| {
        units.opening_speed(&row.after)
    })
    .meaning("speed at which the gap opens, just after");
    list.number("time", NON_DIMENSIONAL, |row| row.time)
        .meaning("time times the natural frequency");
    list.finish()
}

/// Returns the unit of the positions of the contacts.
fn position_unit(model: &Model) -> &'static str {
    match model.kind().sliding_speed {
        SlidingSpeed::RadS => "rad",
        SlidingSpeed::MS => "m",
    }
}
