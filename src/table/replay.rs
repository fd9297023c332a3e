//! `trajectory.parquet` and `switches.parquet`: the motion of one run, in SI units and
//! non-dimensional.

use super::column::{Column, NON_DIMENSIONAL};
use crate::classification::{ContactSample, Sample, Switch};
use crate::model::{Ground, Model, wrap_to_two_pi};
use crate::motion::Phase;

/// Conversion of non-dimensional values of a model to SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Units {
    /// Natural frequency, rad/s: the reciprocal of the unit of time.
    pub natural_rad_s: f64,
    /// Unit of length, m.
    pub length_m: f64,
    /// Unit of a contact's position: 1 rad for a ball, the unit of length for a block.
    pub position: f64,
    /// Unit of force of each contact, N.
    pub force_n: Vec<f64>,
    /// Speed of the disc, rad/s; 0 without a disc.
    pub disc_rad_s: f64,
    /// Speed of the ground of a block, m/s; 0 for a ball.
    pub ground_m_s: f64,
}

impl Units {
    /// Returns the units of a model.
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

    /// Converts a time to s.
    pub fn seconds(&self, time: f64) -> f64 {
        time / self.natural_rad_s
    }

    /// Returns position and velocity of the ring's centre in the inertial frame, m and m/s. At time
    /// 0, the axes of the disc and of the inertial frame coincide.
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

    /// Returns the sliding speed of a contact: rad/s for a ball, m/s for a block.
    pub fn sliding_speed(&self, contact: &ContactSample) -> f64 {
        contact.speed * self.position * self.natural_rad_s
    }

    /// Converts a force on a contact to N.
    pub fn newtons(&self, contact: usize, force: f64) -> Option<f64> {
        self.force_n.get(contact).map(|unit| unit * force)
    }
}

/// Returns the name of a phase.
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

const PHASE: &str = "phase: stick; slip_forward or slip_backward; transition_forward or \
                     transition_backward, in the band around zero speed without sticking; free, if \
                     the friction law has no stick";
const FRICTION: &str = "friction force, positive against positive speed; during stick, the force \
                        that sticking requires";
const LIMIT: &str = "friction limit: static coefficient times normal force";

/// Returns the columns of `trajectory.parquet`.
pub fn trajectory_columns(model: &Model) -> Vec<Column<Sample>> {
    let units = Units::of(model);
    let natural = units.natural_rad_s;
    let mut columns = vec![
        Column::number("time_s", "s", "time since the start", move |row: &Sample| {
            Some(row.time / natural)
        }),
        Column::count(
            "step",
            "number of the integration step that contains the row or ends there; 0 at the start",
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
            ("x", "position of the ring's centre towards the imbalance, in the rotating frame"),
            ("y", "position of the ring's centre perpendicular to x, in the rotating frame"),
            ("x_dot", "velocity along x in the rotating frame"),
            ("y_dot", "velocity along y in the rotating frame"),
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
        ("y_m", "m", "position of the ring's centre perpendicular to x", length),
        ("x_dot_m_s", "m/s", "velocity of the ring's centre along x", speed),
        ("y_dot_m_s", "m/s", "velocity of the ring's centre along y", speed),
    ];
    let space = [
        (
            "x_inertial_m",
            "m",
            "position of the ring's centre along the imbalance's direction at t = 0",
        ),
        ("y_inertial_m", "m", "position of the ring's centre perpendicular to x_inertial"),
        ("x_dot_inertial_m_s", "m/s", "velocity of the ring's centre along x_inertial"),
        ("y_dot_inertial_m_s", "m/s", "velocity of the ring's centre along y_inertial"),
    ];
    let turning = turning.into_iter().enumerate().map(|(axis, (name, unit, meaning, factor))| {
        let meaning = format!("{meaning}, in the frame that rotates with the disc");
        Column::number(name, unit, &meaning, move |row: &Sample| Some(factor * row.table?[axis]))
    });
    let space = space.into_iter().enumerate().map(|(axis, (name, unit, meaning))| {
        let (units, meaning) = (units.clone(), format!("{meaning}, in the inertial frame"));
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
            |contact| wrap_to_two_pi(contact.position),
        ),
        of_contact(
            ball,
            &format!("beta_unwrapped_{number}_rad"),
            "rad",
            "angle of the ball from the imbalance, including complete turns since the start",
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
            "speed of the block relative to the ground",
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

/// Speed and forces, non-dimensional.
fn plain_columns(contact: usize, suffix: &str) -> Vec<Column<Sample>> {
    let column = |stem: &str, meaning: &str, value: fn(&ContactSample) -> f64| {
        of_contact(contact, &format!("{stem}{suffix}"), NON_DIMENSIONAL, meaning, value)
    };
    let speed = if suffix.is_empty() { "sliding_speed" } else { "beta_dot" };
    vec![
        column(speed, "sliding speed divided by natural frequency and unit of length", |c| c.speed),
        column(
            "friction",
            "friction force divided by its unit (m ω_n² L; for a block, its normal force)",
            |c| c.friction,
        ),
        column("friction_limit", "friction limit, divided by the same unit", |c| c.limit),
        column("normal", "normal force divided by the same unit", |c| c.normal),
    ]
}

/// Returns the columns of `switches.parquet`.
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
    columns.push(Column::word("to", "phase after the switch", |row: &Switch| {
        phase_name(row.after.phase)
    }));
    let (position, position_unit) =
        if model.balls() > 0 { ("beta_rad", "rad") } else { ("position_m", "m") };
    let turns = model.balls() > 0;
    let unit = units.position;
    columns.push(Column::number(
        position,
        position_unit,
        "place: angle of the ball from the imbalance, in [0, 2π), or position of the block",
        move |row: &Switch| {
            let place = row.after.position * unit;
            Some(if turns { wrap_to_two_pi(place) } else { place })
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
