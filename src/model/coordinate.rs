//! A start state, and its coordinates with their default ranges.

use serde::Serialize;

use super::parameter_name::member_name;

/// A start state: one value for each of [`super::Model::coordinates`], in that order.
///
/// The balancer's are non-dimensional as in the thesis (lengths over `L`, time times `ω_n`), in the
/// frame that turns with the disc; a block's are in m and m/s.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Start(pub Vec<f64>);

impl Start {
    /// A start state of the balancer: table position and velocity, angle and speed of each ball.
    ///
    /// ```
    /// use stickslip::model::Start;
    ///
    /// let start = Start::of_balancer([0.01, 0.0], &[1.0, 4.0], [0.0, 0.02], &[0.5, -0.3]);
    /// assert_eq!(start.0, [0.01, 0.0, 1.0, 4.0, 0.0, 0.02, 0.5, -0.3]);
    /// ```
    pub fn of_balancer(
        position: [f64; 2],
        beta: &[f64],
        velocity: [f64; 2],
        beta_dot: &[f64],
    ) -> Self {
        Start([&position, beta, &velocity, beta_dot].concat())
    }
}

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
        let coordinate = Coordinate::new(name, unit, meaning, default_range);
        Coordinate { of_every_body: Some(of_every_body), ..coordinate }
    }

    pub(super) fn non_dimensional(
        name: impl Into<String>,
        meaning: &'static str,
        unit_in_words: &'static str,
        half_width: f64,
    ) -> Self {
        let range = [0.0 - half_width, half_width]; // not -0.0 for no width
        Coordinate { unit: None, ..Coordinate::new(name, unit_in_words, meaning, range) }
    }
}
