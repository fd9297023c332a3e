//! `trajectory.parquet`, `switches.parquet` and `touches.parquet`: the motion of one run, in SI units and non-dimensional.

use super::column::{Column, Columns, NON_DIMENSIONAL};
use super::motion_values::phase_name;
use crate::classification::{ContactSample, MotionSample, Switch, Touch};
use crate::model::{
    DiscMotion, Model, OutputName, SlidingSpeed, Units, unit_ending, wrap_to_two_pi,
};
use crate::motion::Phase;

const PHASE: &str = "phase: stick; slip_forward or slip_backward; transition_forward or \
                     transition_backward, in the band around zero speed without sticking; free, if \
                     the friction law has no stick; apart, if the bodies do not touch";
const FRICTION: &str = "friction force, positive against positive speed; during stick, the force \
                        that sticking requires";
const LIMIT: &str = "friction limit: static coefficient times normal force";

/// Returns the columns of `trajectory.parquet` of a run with these gaps ([`Model::gaps`]).
pub fn trajectory_columns(model: &Model, gaps: &[[usize; 2]]) -> Vec<Column<MotionSample>> {
    let units = model.units();
    let natural = units.natural_rad_s;
    let mut list = Columns::<MotionSample>::new();
    list.number("time_s", "s", move |row| row.time / natural).meaning("time since the start");
    list.count("step", |row| row.step).meaning(
        "number of the integration step that contains the row or ends there; 0 at the start",
    );
    if let Some(disc) = model.disc_motion() {
        if model.has_stages() {
            let disc = disc.clone();
            list.number("speed_rad_s", "rad/s", move |row| disc.speed_rad_s(row.time / natural))
                .meaning("speed of the disc");
        }
        if model.ball_balancer().is_some() {
            add_table(&mut list, &units, &disc);
        }
    }
    for contact in 0..model.contacts() {
        match model.ball_balancer() {
            Some(_) => add_ball(&mut list, model, contact),
            None => add_body(&mut list, model, contact),
        }
    }
    let sizes = units.outputs.iter().map(|output| output.size);
    for (place, (output, size)) in model.output_names().into_iter().zip(sizes).enumerate() {
        let OutputName { name, unit, meaning } = output;
        list.number(name, &unit, move |row| Some(size * row.outputs.get(place)?)).meaning(meaning);
    }
    add_gaps(&mut list, model, gaps);
    list.number("time", NON_DIMENSIONAL, |row| row.time)
        .meaning("time times the natural frequency");
    if model.ball_balancer().is_some() {
        for (axis, name, meaning) in [
            (0, "x", "position of the disc's centre towards the imbalance, in the rotating frame"),
            (1, "y", "position of the disc's centre perpendicular to x, in the rotating frame"),
            (2, "x_dot", "velocity along x in the rotating frame"),
            (3, "y_dot", "velocity along y in the rotating frame"),
        ] {
            list.number(name, NON_DIMENSIONAL, move |row| Some(row.table?[axis])).meaning(meaning);
        }
        for ball in 0..model.balls() {
            add_non_dimensional(&mut list, ball);
        }
    }
    list.finish()
}

/// Adds a column of a contact.
fn of_contact<'a>(
    list: &'a mut Columns<MotionSample>,
    contact: usize,
    name: impl Into<String>,
    unit: &str,
    value: impl Fn(&ContactSample) -> f64 + Send + Sync + 'static,
) -> &'a mut Column<MotionSample> {
    list.number(name, unit, move |row| row.contacts.get(contact).map(&value))
}

/// Adds position and velocity of the disc's centre.
fn add_table(list: &mut Columns<MotionSample>, units: &Units, disc: &DiscMotion) {
    let (length, speed) = (units.length_m, units.length_m * units.natural_rad_s);
    for (axis, name, unit, factor, meaning) in [
        (0, "x_m", "m", length, "position of the disc's centre towards the imbalance"),
        (1, "y_m", "m", length, "position of the disc's centre perpendicular to x"),
        (2, "x_dot_m_s", "m/s", speed, "velocity of the disc's centre along x"),
        (3, "y_dot_m_s", "m/s", speed, "velocity of the disc's centre along y"),
    ] {
        list.number(name, unit, move |row| Some(factor * row.table?[axis]))
            .meaning(format!("{meaning}, in the frame that rotates with the disc"));
    }
    let along = "position of the disc's centre along the imbalance's direction at t = 0";
    for (axis, name, unit, meaning) in [
        (0, "x_inertial_m", "m", along),
        (1, "y_inertial_m", "m", "position of the disc's centre perpendicular to x_inertial"),
        (2, "x_dot_inertial_m_s", "m/s", "velocity of the disc's centre along x_inertial"),
        (3, "y_dot_inertial_m_s", "m/s", "velocity of the disc's centre along y_inertial"),
    ] {
        let (units, disc) = (units.clone(), disc.clone());
        list.number(name, unit, move |row| Some(units.in_space(&disc, row)?[axis]))
            .meaning(format!("{meaning}, in the inertial frame"));
    }
}

fn add_ball(list: &mut Columns<MotionSample>, model: &Model, ball: usize) {
    let number = ball + 1;
    let natural = model.natural_frequency_rad_s();
    of_contact(list, ball, format!("beta_{number}_rad"), "rad", |ball| {
        wrap_to_two_pi(ball.position)
    })
    .meaning("angle of the ball from the imbalance, in [0, 2π)");
    of_contact(list, ball, format!("beta_unwrapped_{number}_rad"), "rad", |ball| ball.position)
        .meaning("angle of the ball from the imbalance, including complete turns since the start");
    of_contact(list, ball, format!("ball_speed_{number}_rad_s"), "rad/s", move |ball| {
        ball.speed * natural
    })
    .meaning("speed of the ball relative to the ring, positive where its angle grows");
    add_forces(list, model, ball, &format!("_{number}"));
}

/// Adds speed and forces of a contact of a system of one's own.
fn add_body(list: &mut Columns<MotionSample>, model: &Model, contact: usize) {
    let (units, suffix) = (model.units(), model.contact_suffix(contact));
    let Some(unit) = units.contacts.get(contact).copied() else { return };
    let body = model.contact_in_words(contact);
    let (ending, per_second) = model.sliding_speed_unit(contact);
    of_contact(list, contact, format!("sliding_speed{ending}"), &per_second, move |sample| {
        sample.speed * unit.sliding_speed
    })
    .meaning(format!("sliding speed of {body}"));
    add_forces(list, model, contact, &suffix);
}

/// Adds the phase of a contact, and its forces in N.
fn add_forces(list: &mut Columns<MotionSample>, model: &Model, contact: usize, suffix: &str) {
    let (units, symbol) = (model.units(), model.force_unit(contact));
    let ending = unit_ending(&symbol);
    let force = units.contacts.get(contact).map_or(f64::NAN, |unit| unit.force_n);
    list.word(format!("phase{suffix}"), move |row| {
        row.contacts.get(contact).map(|contact| phase_name(contact.phase))
    })
    .meaning(PHASE);
    of_contact(list, contact, format!("friction{suffix}{ending}"), &symbol, move |c| {
        c.friction * force
    })
    .meaning(FRICTION);
    of_contact(list, contact, format!("friction_limit{suffix}{ending}"), &symbol, move |c| {
        c.limit * force
    })
    .meaning(LIMIT);
    of_contact(list, contact, format!("normal{suffix}{ending}"), &symbol, move |c| {
        c.normal * force
    })
    .meaning("normal force, compression positive");
}

/// Adds the non-dimensional speed and forces of a ball.
fn add_non_dimensional(list: &mut Columns<MotionSample>, ball: usize) {
    let mut number = |name: &str, value: fn(&ContactSample) -> f64, meaning: &str| {
        of_contact(list, ball, format!("{name}_{}", ball + 1), NON_DIMENSIONAL, value)
            .meaning(meaning);
    };
    let meaning = "sliding speed divided by natural frequency and unit of length";
    number("beta_dot", |contact| contact.speed, meaning);
    let meaning = "friction force divided by its unit, m ω_n² L";
    number("friction", |contact| contact.friction, meaning);
    let meaning = "friction limit, divided by the same unit";
    number("friction_limit", |contact| contact.limit, meaning);
    number("normal", |contact| contact.normal, "normal force divided by the same unit");
}

/// Returns the columns of `switches.parquet`.
pub fn switch_columns(model: &Model) -> Vec<Column<Switch>> {
    let units = model.units();
    let natural = units.natural_rad_s;
    let mut list = Columns::<Switch>::new();
    list.number("time_s", "s", move |row| row.time / natural).meaning("time since the start");
    let body = model.kind().body;
    list.count(body, |row| row.contact as u64 + 1).meaning(format!("number of the {body}, from 1"));
    list.word("from", |row| phase_name(row.before.phase)).meaning(PHASE);
    list.word("to", |row| phase_name(row.after.phase)).meaning("phase after the switch");
    let is_ball = model.ball_balancer().is_some();
    let (name, unit) = if is_ball { ("beta_rad", "rad") } else { ("position", "SI") };
    let factors: Vec<f64> = units.contacts.iter().map(|contact| contact.position).collect();
    list.number(name, unit, move |row| {
        let position = row.after.position * factors.get(row.contact)?;
        Some(if is_ball { wrap_to_two_pi(position) } else { position })
    })
    .meaning("place: angle of the ball from the imbalance, in [0, 2π), or position of the block");
    let mut force = |name: &str, meaning: &str, value: fn(&Switch) -> f64| {
        let units = units.clone();
        list.number(name, "N", move |row| units.newtons(row.contact, value(row))).meaning(meaning);
    };
    force("friction_n", "friction force just before", |row| row.before.friction);
    force("friction_after_n", "friction force just after", |row| row.after.friction);
    force("friction_limit_n", LIMIT, |row| row.before.limit);
    force("normal_n", "normal force just before", |row| row.before.normal);
    force("normal_after_n", "normal force just after", |row| row.after.normal);
    list.number("time", NON_DIMENSIONAL, |row| row.time)
        .meaning("time times the natural frequency");
    list.finish()
}

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
