//! What is shown of a run over time, panel by panel, before it is drawn.

use std::f64::consts::TAU;

use crate::ending::{ContactSample, Sample};
use crate::model::Model;
use crate::motion::Phase;
use crate::report::course::{stretches, thinned};
use crate::table::{Units, in_circle};

/// A curve over time.
pub(super) struct Curve {
    /// What it is of.
    pub(super) of: Of,
    pub(super) points: Vec<(f64, f64)>,
}

/// What a curve is of; a block is contact 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    Contact(usize),
    /// Turns of a ball that are so short that a picture shows hardly more than that there are some.
    Running(usize),
    Table,
    /// The most that friction can hold, in either direction.
    Limit,
}

/// One part of the figure.
pub(super) struct Panel {
    /// Its name in the picture.
    pub(super) id: String,
    pub(super) title: String,
    pub(super) curves: Vec<Curve>,
    /// Shaded stretches of time.
    pub(super) shaded: Vec<(f64, f64)>,
    /// Whether the ordinate is an angle, from 0 to 2π.
    pub(super) angle: bool,
    /// Height of what is between its axes, px.
    pub(super) height: u32,
}

/// Turns shorter than this are hard to tell apart, px; of those as near to each other as that, one is drawn.
const SHORT_TURN: f64 = 6.0;
const SAME_TURN: f64 = 4.0;

/// The panels of a run between two times, s, whose axes are so many pixels wide.
pub(super) fn panels(
    model: &Model,
    units: &Units,
    samples: &[Sample],
    range: (f64, f64),
    width: u32,
) -> Vec<Panel> {
    let (contacts, balls) = (model.contacts(), model.balls() > 0);
    let many = contacts > 3;
    let series = |of: Of, value: &dyn Fn(&Sample) -> Option<f64>| -> Curve {
        let point = |sample: &Sample| Some((units.seconds(sample.time), value(sample)?));
        let points: Vec<(f64, f64)> = samples.iter().filter_map(point).collect();
        Curve { of, points: thinned(&points, range, width) }
    };
    let panel = |id: &str, title: &str, curves: Vec<Curve>, height: u32| Panel {
        id: id.to_owned(),
        title: title.to_owned(),
        curves,
        shaded: Vec::new(),
        angle: false,
        height,
    };
    let mut panels = Vec::new();
    if balls {
        let curves = (0..contacts).flat_map(|ball| turns(units, samples, ball, range, width));
        let mut curves: Vec<Curve> = curves.collect();
        // What is pale lies under what is not.
        curves.sort_by_key(|curve| !matches!(curve.of, Of::Running(_)));
        let title = "angle of the balls from the imbalance [rad]";
        let height = if many { 200 } else { 120 };
        panels.push(Panel { angle: true, ..panel("angle", title, curves, height) });
    } else {
        let place =
            |sample: &Sample| sample.contacts.first().map(|block| block.position * units.position);
        let curves = vec![series(Of::Contact(0), &place)];
        panels.push(panel("position", "position of the block [m]", curves, 120));
    }
    let speed = |contact: usize| {
        let value =
            move |sample: &Sample| sample.contacts.get(contact).map(|c| units.sliding_speed(c));
        series(Of::Contact(contact), &value)
    };
    let title = if balls {
        "speed of the balls relative to the ring [rad/s]"
    } else {
        "sliding speed of the block [m/s]"
    };
    let speeds = (0..contacts).map(speed).collect();
    panels.push(panel("speed", title, speeds, if many { 160 } else { 110 }));
    if balls {
        let away = |sample: &Sample| {
            let [x, y, ..] = sample.table?;
            Some(1e3 * units.length_m * x.hypot(y))
        };
        let title = "displacement of the table [mm]";
        panels.push(panel("displacement", title, vec![series(Of::Table, &away)], 100));
    }
    let (fraction, unit) = if balls { (1e3, "mN") } else { (1.0, "N") };
    for contact in 0..contacts {
        let force = |value: fn(&ContactSample) -> f64| {
            move |sample: &Sample| {
                let newtons = value(sample.contacts.get(contact)?);
                Some(fraction * units.newtons(contact, newtons)?)
            }
        };
        let course = |sample: &Sample| {
            let stuck = sample.contacts.get(contact)?.phase == Phase::Stick;
            Some((units.seconds(sample.time), stuck))
        };
        let course: Vec<(f64, bool)> = samples.iter().filter_map(course).collect();
        let whose = if balls { format!("ball {}", contact + 1) } else { "the block".to_owned() };
        let id = if balls { format!("friction-{}", contact + 1) } else { "friction".to_owned() };
        let curves = vec![
            series(Of::Limit, &force(|contact| contact.limit)),
            series(Of::Limit, &force(|contact| -contact.limit)),
            series(Of::Contact(contact), &force(|contact| contact.friction)),
        ];
        let title = format!("friction on {whose} [{unit}]");
        panels.push(Panel {
            shaded: stretches(&course, range, width as usize),
            ..panel(&id, &title, curves, if many { 70 } else { 100 })
        });
    }
    panels
}

/// The angle of a ball over time, one curve for each turn.
fn turns(
    units: &Units,
    samples: &[Sample],
    ball: usize,
    range: (f64, f64),
    width: u32,
) -> Vec<Curve> {
    let pixel = (range.1 - range.0) / f64::from(width);
    let mut turns: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut turn = f64::NAN;
    for sample in samples {
        let Some(contact) = sample.contacts.get(ball) else { continue };
        let now = (contact.position / TAU).floor();
        if now != turn {
            turns.push(Vec::new());
            turn = now;
        }
        if let Some(points) = turns.last_mut() {
            points.push((units.seconds(sample.time), in_circle(contact.position)));
        }
    }
    let count = turns.len();
    let mut last = f64::NEG_INFINITY;
    let curve = |(index, points): (usize, Vec<(f64, f64)>)| {
        let (Some((begin, _)), Some((end, _))) = (points.first(), points.last()) else {
            return None;
        };
        // The first and the last need not be whole.
        let short = end - begin < SHORT_TURN * pixel && index > 0 && index + 1 < count;
        if short && begin - last < SAME_TURN * pixel {
            return None;
        }
        if short {
            last = *begin;
        }
        let of = if short { Of::Running(ball) } else { Of::Contact(ball) };
        Some(Curve { of, points: thinned(&points, range, width) })
    };
    turns.into_iter().enumerate().filter_map(curve).collect()
}
