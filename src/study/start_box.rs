//! The box of start states: one range per coordinate, and how coordinates make a start state.

use std::f64::consts::TAU;

use super::error::{Fault, Locate, StudyError, list_names};
use super::file_values::{Named, Range};
use super::key_path::KeyPath;
use super::node::describe_number;
use crate::model::Start;

/// Default half width of positions and table speeds. Like the ball speed below it is
/// *reconstructed*: the thesis's box is lost, and this one reproduces its six counts.
const DEFAULT_HALF_WIDTH: f64 = 0.05;

/// Default largest ball speed over the natural frequency (reconstructed).
const DEFAULT_BALL_SPEED: f64 = 1.0;

/// Names of the coordinates of a start state in their order: `x`, `y`, `beta_1` ..., `x_dot`,
/// `y_dot`, `beta_dot_1` ...
pub(crate) fn axis_names(balls: usize) -> Vec<String> {
    let own = |stem: &'static str| (1..=balls).map(move |ball| format!("{stem}_{ball}"));
    ["x", "y"]
        .into_iter()
        .map(str::to_owned)
        .chain(own("beta"))
        .chain(["x_dot", "y_dot"].into_iter().map(str::to_owned))
        .chain(own("beta_dot"))
        .collect()
}

/// The start state with these coordinates, in the order of [`axis_names`].
pub(crate) fn start_of(coordinates: &[f64]) -> Start {
    let balls = coordinates.len().saturating_sub(4) / 2;
    let at = |index: usize| coordinates.get(index).copied().unwrap_or(0.0);
    let run = |first: usize| coordinates.iter().skip(first).take(balls).copied().collect();
    Start {
        x: at(0),
        y: at(1),
        beta: run(2),
        x_dot: at(2 + balls),
        y_dot: at(3 + balls),
        beta_dot: run(4 + balls),
    }
}

/// One coordinate of the box.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    /// Name, such as `beta_dot_2`.
    pub name: String,
    /// Smallest value.
    pub low: f64,
    /// Largest value; equal to `low` where the coordinate is fixed.
    pub high: f64,
}

impl Axis {
    /// Whether there is nothing to sample.
    pub fn is_fixed(&self) -> bool {
        self.low == self.high
    }

    /// The value at this share of the range, from zero to one.
    pub fn at(&self, share: f64) -> f64 {
        (self.low + share * (self.high - self.low)).clamp(self.low, self.high)
    }
}

/// The box with every axis written out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StartBox {
    /// One axis per coordinate, in the order of [`axis_names`].
    pub axes: Vec<Axis>,
}

impl StartBox {
    /// Fills in the ranges that are not given.
    ///
    /// # Errors
    /// A name that is no coordinate, or a range whose low end is above its high one.
    pub fn resolve(
        locate: &dyn Locate,
        path: &KeyPath,
        written: Option<&Named<Range>>,
        balls: usize,
    ) -> Result<StartBox, StudyError> {
        let names = axis_names(balls);
        for (name, Range([low, high])) in written.iter().flat_map(|ranges| &ranges.0) {
            if !names.contains(name) && name != "beta" && name != "beta_dot" {
                let mut allowed = vec!["beta".to_owned(), "beta_dot".to_owned()];
                allowed.extend(names);
                let fault = Fault::new("unknown key", name, list_names(name, &allowed));
                return Err(locate.refuse_key(&path.key(name), fault));
            }
            if low > high {
                let found = format!("[{}, {}]", describe_number(*low), describe_number(*high));
                let allowed = "[low, high] with low not above high";
                let fault = Fault::new("reversed range", found, allowed);
                return Err(locate.refuse_value(&path.key(name), fault));
            }
            if !(high - low).is_finite() {
                let found = format!("[{}, {}]", describe_number(*low), describe_number(*high));
                let fault = Fault::new("too wide a range", found, "a finite width");
                return Err(locate.refuse_value(&path.key(name), fault));
            }
        }
        let range = |name: &str| {
            let general = general_name(name);
            let given = written.and_then(|ranges| ranges.get(name).or_else(|| ranges.get(general)));
            given.map_or_else(|| default_range(general), |range| range.0)
        };
        let axes = names
            .into_iter()
            .map(|name| {
                let [low, high] = range(&name);
                Axis { name, low, high }
            })
            .collect();
        Ok(StartBox { axes })
    }

    /// The box as a study file writes it.
    pub fn to_file(&self) -> Named<Range> {
        let ranges = self.axes.iter().map(|axis| (axis.name.clone(), Range([axis.low, axis.high])));
        Named(ranges.collect())
    }
}

fn general_name(name: &str) -> &str {
    ["beta_dot", "beta"].into_iter().find(|stem| name.starts_with(stem)).unwrap_or(name)
}

fn default_range(general: &str) -> [f64; 2] {
    match general {
        "beta" => [0.0, TAU],
        "beta_dot" => [-DEFAULT_BALL_SPEED, DEFAULT_BALL_SPEED],
        _ => [-DEFAULT_HALF_WIDTH, DEFAULT_HALF_WIDTH],
    }
}
