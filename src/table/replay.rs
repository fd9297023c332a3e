//! `trajectory.parquet` and `switches.parquet`: the motion of one run, with and without dimensions.

use super::column::{Column, NON_DIMENSIONAL};
use crate::classification::{ContactSample, Sample, Switch};
use crate::model::{Ground, Model};
use crate::motion::Phase;

/// What turns non-dimensional values of a model into SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Units {
    /// Natural frequency, rad/s: 1 over the unit of time.
    pub natural_rad_s: f64,
    /// Unit of length, m.
    pub length_m: f64,
    /// Unit of a contact's position: 1 rad of a ball, the unit of length of a block.
    pub position: f64,
    /// Unit of force of each contact, N.
    pub force_n: Vec<f64>,
    /// Speed of the disc, rad/s; 0 without one.
    pub disc_rad_s: f64,
    /// Speed of what a block lies on, m/s; 0 of a ball.
    pub ground_m_s: f64,
}

impl Units {
    /// Those of a model.
    pub fn of(model: &Model) -> Self {
        let natural = model.natural_frequency_rad_s();
        match model {
            Model::BallBalancer(machine) => Units {
                natural_rad_s: natural,
                length_m: machine.ring_radius_m,
                position: 1.0,
                force_n: (machine.balls.iter())
                    .map(|ball| ball.mass_kg * natural * natural * machine.ring_radius_m)
                    .collect(),
                disc_rad_s: machine.speed_rad_s,
                ground_m_s: 0.0,
            },
            Model::Block(block) => Units {
                natural_rad_s: natural,
                length_m: block.unit_length_m(),
                position: block.unit_length_m(),
                force_n: vec![block.normal_force_n],
                disc_rad_s: 0.0,
                ground_m_s: match block.ground {
                    Ground::Fixed => 0.0,
                    Ground::Belt { speed_m_s } => speed_m_s,
                },
            },
        }
    }

    /// Time of an instant, s.
    pub fn seconds(&self, time: f64) -> f64 {
        time / self.natural_rad_s
    }

    /// Position and velocity of the ring's centre in space, m and m/s; at the time 0 the axes of the disc
    /// are those of space.
    pub fn in_space(&self, sample: &Sample) -> Option<[f64; 4]> {
        let [x, y, x_dot, y_dot] = sample.table?;
        let omega = self.disc_rad_s / self.natural_rad_s;
        let (sine, cosine) = (omega * sample.time).sin_cos();
        let (u, v) = (x_dot - omega * y, y_dot + omega * x);
        let speed = self.length_m * self.natural_rad_s;
        Some([
            self.length_m * (cosine * x - sine * y),
            self.length_m * (sine * x + cosine * y),
            speed * (cosine * u - sine * v),
            speed * (sine * u + cosine * v),
        ])
    }

    /// A contact's sliding speed, rad/s of a ball, m/s of a block.
    pub fn sliding_speed(&self, contact: &ContactSample) -> f64 {
        contact.speed * self.position * self.natural_rad_s
    }

    /// A force on a contact, N.
    pub fn newtons(&self, contact: usize, force: f64) -> Option<f64> {
        self.force_n.get(contact).map(|unit| unit * force)
    }
}

/// The name of what a contact does.
pub fn phase_name(phase: Phase) -> &'static str {
    match phase {
        Phase::Stick => "stick",
        Phase::Slip(direction) if direction > 0.0 => "slip_forward",
        Phase::Slip(_) => "slip_backward",
        Phase::Transition(direction) if direction > 0.0 => "transition_forward",
        Phase::Transition(_) => "transition_backward",
        Phase::Free => "free",
    }
}

/// An angle in [0, 2π).
pub fn in_circle(angle: f64) -> f64 {
    let wrapped = angle.rem_euclid(std::f64::consts::TAU);
    if wrapped < std::f64::consts::TAU { wrapped } else { 0.0 }
}

const PHASE: &str = "what it does: stick; slip_forward or slip_backward; transition_forward or \
                     transition_backward, in the band around zero speed but not held; free, where its \
                     law has no stick";
const FRICTION: &str =
    "friction force, acting against positive speed; in stick, what sticking takes";
const LIMIT: &str = "most that friction can hold: static coefficient times normal force";

/// The columns of `trajectory.parquet`.
pub fn trajectory_columns(model: &Model) -> Vec<Column<Sample>> {
    let units = Units::of(model);
    let natural = units.natural_rad_s;
    let mut columns = vec![
        Column::number("time_s", "s", "time since the start", move |row: &Sample| {
            Some(row.time / natural)
        }),
        Column::count(
            "step",
            "number of the integration step that the row is in or at the end of; 0 at the start",
            |row: &Sample| Some(row.step),
        ),
    ];
    if model.balls() > 0 {
        columns.extend(table_columns(&units));
        for ball in 0..model.balls() {
            columns.extend(ball_columns(&units, ball));
        }
    } else {
        columns.extend(block_columns(&units));
    }
    columns.push(Column::number(
        "time",
        NON_DIMENSIONAL,
        "time times the natural frequency",
        |row: &Sample| Some(row.time),
    ));
    if model.balls() > 0 {
        let names = [
            ("x", "position of the ring's centre towards the imbalance, in the turning frame"),
            ("y", "position of the ring's centre at right angles to that, in the turning frame"),
            ("x_dot", "velocity along x in the turning frame"),
            ("y_dot", "velocity along y in the turning frame"),
        ];
        columns.extend(names.into_iter().enumerate().map(|(axis, (name, meaning))| {
            let value = move |row: &Sample| Some(row.table?[axis]);
            Column::number(name, NON_DIMENSIONAL, meaning, value)
        }));
        for ball in 0..model.balls() {
            columns.extend(plain_columns(ball, &format!("_{}", ball + 1)));
        }
    } else {
        columns.push(of_contact(0, "position", NON_DIMENSIONAL, "position over F_n / k", |c| {
            c.position
        }));
        columns.extend(plain_columns(0, ""));
    }
    columns
}

fn of_contact(
    contact: usize,
    name: &str,
    unit: &str,
    meaning: &str,
    value: impl Fn(&ContactSample) -> f64 + Send + Sync + 'static,
) -> Column<Sample> {
    Column::number(name, unit, meaning, move |row: &Sample| row.contacts.get(contact).map(&value))
}

fn table_columns(units: &Units) -> Vec<Column<Sample>> {
    let (length, speed) = (units.length_m, units.length_m * units.natural_rad_s);
    let turning = [
        ("x_m", "m", "position of the ring's centre towards the imbalance", length),
        ("y_m", "m", "position of the ring's centre at right angles to that", length),
        ("x_dot_m_s", "m/s", "velocity of the ring's centre along x", speed),
        ("y_dot_m_s", "m/s", "velocity of the ring's centre along y", speed),
    ];
    let space = [
        (
            "x_inertial_m",
            "m",
            "position of the ring's centre along the imbalance's direction at t = 0",
        ),
        ("y_inertial_m", "m", "position of the ring's centre at right angles to that"),
        ("x_dot_inertial_m_s", "m/s", "velocity of the ring's centre along the first"),
        ("y_dot_inertial_m_s", "m/s", "velocity of the ring's centre along the second"),
    ];
    let turning = turning.into_iter().enumerate().map(|(axis, (name, unit, meaning, factor))| {
        let meaning = format!("{meaning}, in the frame that turns with the disc");
        Column::number(name, unit, &meaning, move |row: &Sample| Some(factor * row.table?[axis]))
    });
    let space = space.into_iter().enumerate().map(|(axis, (name, unit, meaning))| {
        let (units, meaning) = (units.clone(), format!("{meaning}, in space"));
        Column::number(name, unit, &meaning, move |row: &Sample| Some(units.in_space(row)?[axis]))
    });
    turning.chain(space).collect()
}

fn ball_columns(units: &Units, ball: usize) -> Vec<Column<Sample>> {
    let number = ball + 1;
    let natural = units.natural_rad_s;
    let mut columns = vec![
        of_contact(
            ball,
            &format!("beta_{number}_rad"),
            "rad",
            "angle of the ball from the imbalance, in [0, 2π)",
            |contact| in_circle(contact.position),
        ),
        of_contact(
            ball,
            &format!("beta_unwrapped_{number}_rad"),
            "rad",
            "angle of the ball from the imbalance with the whole turns made since the start",
            |contact| contact.position,
        ),
        of_contact(
            ball,
            &format!("ball_speed_{number}_rad_s"),
            "rad/s",
            "speed of the ball relative to the ring, positive where its angle grows",
            move |contact| contact.speed * natural,
        ),
    ];
    columns.extend(contact_columns(units, ball, &format!("_{number}")));
    columns
}

fn block_columns(units: &Units) -> Vec<Column<Sample>> {
    let (length, speed) = (units.length_m, units.length_m * units.natural_rad_s);
    let ground = units.ground_m_s;
    let mut columns = vec![
        of_contact(
            0,
            "position_m",
            "m",
            "position of the block, from where the spring is free",
            move |block| block.position * length,
        ),
        of_contact(0, "velocity_m_s", "m/s", "velocity of the block", move |block| {
            block.speed * speed + ground
        }),
        of_contact(
            0,
            "sliding_speed_m_s",
            "m/s",
            "speed of the block relative to what it lies on",
            move |block| block.speed * speed,
        ),
    ];
    columns.extend(contact_columns(units, 0, ""));
    columns
}

/// Phase and forces in N.
fn contact_columns(units: &Units, contact: usize, suffix: &str) -> Vec<Column<Sample>> {
    let force = units.force_n.get(contact).copied().unwrap_or(f64::NAN);
    vec![
        Column::optional_word(&format!("phase{suffix}"), PHASE, move |row: &Sample| {
            row.contacts.get(contact).map(|contact| phase_name(contact.phase))
        }),
        of_contact(contact, &format!("friction{suffix}_n"), "N", FRICTION, move |c| {
            c.friction * force
        }),
        of_contact(contact, &format!("friction_limit{suffix}_n"), "N", LIMIT, move |c| {
            c.limit * force
        }),
        of_contact(
            contact,
            &format!("normal{suffix}_n"),
            "N",
            "normal force, compression positive",
            move |c| c.normal * force,
        ),
    ]
}

/// Speed and forces without dimensions.
fn plain_columns(contact: usize, suffix: &str) -> Vec<Column<Sample>> {
    let column = |stem: &str, meaning: &str, value: fn(&ContactSample) -> f64| {
        of_contact(contact, &format!("{stem}{suffix}"), NON_DIMENSIONAL, meaning, value)
    };
    let speed = if suffix.is_empty() { "sliding_speed" } else { "beta_dot" };
    vec![
        column(speed, "sliding speed over the natural frequency and the unit of length", |c| {
            c.speed
        }),
        column(
            "friction",
            "friction force over its unit (m ω_n² L; of a block its normal force)",
            |c| c.friction,
        ),
        column("friction_limit", "most that friction can hold, over the same unit", |c| c.limit),
        column("normal", "normal force over the same unit", |c| c.normal),
    ]
}

/// The columns of `switches.parquet`.
pub fn switch_columns(model: &Model) -> Vec<Column<Switch>> {
    let units = Units::of(model);
    let natural = units.natural_rad_s;
    let mut columns =
        vec![Column::number("time_s", "s", "time since the start", move |row: &Switch| {
            Some(row.time / natural)
        })];
    if model.balls() > 0 {
        columns.push(Column::count("ball", "number of the ball, from 1", |row: &Switch| {
            Some(row.contact as u64 + 1)
        }));
    }
    columns.push(Column::word("from", PHASE, |row: &Switch| phase_name(row.before.phase)));
    columns.push(Column::word("to", "the same after the switch", |row: &Switch| {
        phase_name(row.after.phase)
    }));
    let (position, position_unit) =
        if model.balls() > 0 { ("beta_rad", "rad") } else { ("position_m", "m") };
    let turns = model.balls() > 0;
    let unit = units.position;
    columns.push(Column::number(
        position,
        position_unit,
        "where: angle of the ball from the imbalance, in [0, 2π); position of the block",
        move |row: &Switch| {
            let place = row.after.position * unit;
            Some(if turns { in_circle(place) } else { place })
        },
    ));
    let mut force = |name: &str, meaning: &str, value: fn(&Switch) -> f64| {
        let units = units.clone();
        columns.push(Column::number(name, "N", meaning, move |row: &Switch| {
            units.newtons(row.contact, value(row))
        }));
    };
    force("friction_n", "friction force just before", |row| row.before.friction);
    force("friction_after_n", "friction force just after", |row| row.after.friction);
    force("friction_limit_n", LIMIT, |row| row.before.limit);
    force("normal_n", "normal force just before", |row| row.before.normal);
    force("normal_after_n", "normal force just after", |row| row.after.normal);
    columns.push(Column::number(
        "time",
        NON_DIMENSIONAL,
        "time times the natural frequency",
        |row: &Switch| Some(row.time),
    ));
    columns
}
