//! The coordinates of a start state, with their default ranges.

use std::f64::consts::TAU;

use super::Model;
use super::kind::member_name;

/// Default half width of positions and table speeds. Like the ball speed below, it is
/// *reconstructed*: the thesis's box is illegible, and this box reproduces its six counts.
const HALF_WIDTH: f64 = 0.05;

/// Default largest ball speed divided by the natural frequency (reconstructed).
const BALL_SPEED: f64 = 1.0;

/// A coordinate of a start state.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
    /// Name, as in a study file.
    pub name: String,
    /// The name that stands for this coordinate of every body, for a coordinate of one of several bodies.
    pub of_every_body: Option<&'static str>,
    /// Unit; `None` for a non-dimensional value.
    pub unit: Option<&'static str>,
    /// The unit in words.
    pub unit_in_words: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// The default range, lowest value first.
    pub default_range: [f64; 2],
    /// The default range in words, where numbers are not clear.
    pub default_in_words: Option<&'static str>,
}

impl Coordinate {
    /// A coordinate in this unit, such as `m`.
    pub fn new(
        name: impl Into<String>,
        unit: &'static str,
        meaning: &'static str,
        default_range: [f64; 2],
    ) -> Self {
        Coordinate {
            name: name.into(),
            of_every_body: None,
            unit: Some(unit),
            unit_in_words: unit,
            meaning,
            default_range,
            default_in_words: None,
        }
    }

    /// A coordinate of one of several bodies, counted from 1: `position_2_m` for the second body and the name
    /// `position_m`, which stands for this coordinate of every body.
    pub fn of_body(
        of_every_body: &'static str,
        body: usize,
        unit: &'static str,
        meaning: &'static str,
        default_range: [f64; 2],
    ) -> Self {
        let name = member_name(of_every_body, unit, body);
        let own = Coordinate::new(name, unit, meaning, default_range);
        Coordinate { of_every_body: Some(of_every_body), ..own }
    }

    fn non_dimensional(
        name: impl Into<String>,
        meaning: &'static str,
        unit_in_words: &'static str,
        half_width: f64,
    ) -> Self {
        let range = [0.0 - half_width, half_width]; // not -0.0 for no width
        Coordinate { unit: None, ..Coordinate::new(name, unit_in_words, meaning, range) }
    }
}

/// Returns the ending of names with this unit: `_n_m` for `N/m`; nothing for dimensionless numbers.
pub fn unit_ending(unit: &str) -> String {
    match unit {
        "" | "1" => String::new(),
        // `_n_m` is that of N/m.
        "N m" => "_nm".to_owned(),
        unit => format!("_{}", unit.replace([' ', '/'], "_").to_lowercase()),
    }
}

impl Model {
    /// The coordinates of a start state, in order.
    pub fn coordinates(&self) -> Vec<Coordinate> {
        match self {
            Model::Own(own) => own.own().coordinates(own),
            Model::BallBalancer(machine) => {
                of_balancer(machine.balls.len(), machine.speed_profile.is_some())
            }
        }
    }
}

/// Returns the coordinates of a balancer. One whose disc starts has its table and its balls at rest on the disc by default.
fn of_balancer(balls: usize, starts: bool) -> Vec<Coordinate> {
    let [half_width, ball_speed] = if starts { [0.0; 2] } else { [HALF_WIDTH, BALL_SPEED] };
    let table =
        |name: &str, meaning, unit| Coordinate::non_dimensional(name, meaning, unit, half_width);
    let each = |stem: &'static str, of_one: &dyn Fn(String) -> Coordinate| -> Vec<Coordinate> {
        let of_ball = |ball: usize| Coordinate {
            of_every_body: Some(stem),
            ..of_one(format!("{stem}_{ball}"))
        };
        (1..=balls).map(of_ball).collect()
    };
    let angle = |name: String| Coordinate {
        unit: Some("rad"),
        default_range: [0.0, TAU],
        default_in_words: Some("[0, 2π]"),
        ..Coordinate::non_dimensional(
            name,
            "start angle of the ball from the imbalance",
            "rad",
            0.0,
        )
    };
    let speed = |name: String| {
        let meaning = "start speed of the ball relative to the ring";
        Coordinate::non_dimensional(name, meaning, "divided by the natural frequency", ball_speed)
    };
    const LENGTH: &str = "in ring radii";
    const VELOCITY: &str = "in ring radii, with time multiplied by the natural frequency";
    let across = "start position of the disc's centre at right angles to that";
    let mut all = vec![
        table("x", "start position of the disc's centre towards the imbalance", LENGTH),
        table("y", across, LENGTH),
    ];
    all.extend(each("beta", &angle));
    all.push(table("x_dot", "start velocity along x", VELOCITY));
    all.push(table("y_dot", "start velocity along y", VELOCITY));
    all.extend(each("beta_dot", &speed));
    all
}
