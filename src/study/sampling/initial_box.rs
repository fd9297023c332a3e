//! The box of start states: one range per coordinate.

use std::f64::consts::TAU;

use indexmap::IndexMap;

use crate::model::{Coordinate, Model};
use crate::study::error::{Fault, StudyError, list_names};
use crate::study::file::source_path::SourcePath;
use crate::study::file::values::Range;
use crate::study::file::yaml_tree::describe_number;

/// Default half width of positions and table speeds. Like the ball speed below, it is
/// *reconstructed*: the thesis's box is illegible, and this box reproduces its six counts.
const DEFAULT_HALF_WIDTH: f64 = 0.05;

/// Default largest ball speed divided by the natural frequency (reconstructed).
const DEFAULT_BALL_SPEED: f64 = 1.0;

/// Names that stand for a coordinate of every ball.
pub(crate) const GENERAL_AXES: [&str; 2] = ["beta", "beta_dot"];

/// Returns the names of the coordinates of a start state, in their order.
pub(crate) fn axis_names(model: &Model) -> Vec<String> {
    model.coordinates().into_iter().map(|coordinate| coordinate.name).collect()
}

/// Returns the names that a box may have, those of all balls and those of one ball, each with its
/// meaning, unit and default range.
pub(crate) fn axes_in_words(model: &Model) -> Vec<(String, String)> {
    let mut axes: Vec<(String, String)> = Vec::new();
    for Coordinate { name, unit, meaning } in model.coordinates() {
        let general = general_name(&name);
        let unit = match general {
            "x" | "y" => "in ring radii",
            "x_dot" | "y_dot" => "in ring radii, with time multiplied by the natural frequency",
            "beta_dot" => "divided by the natural frequency",
            _ => unit.unwrap_or_default(),
        };
        let range = match (general, default_range(general, model)) {
            ("beta", _) => "[0, 2π]".to_owned(),
            ("position_m", _) => "± `normal_force_n` / `stiffness_n_m`".to_owned(),
            (_, [low, high]) => {
                format!("[{}, {}]", describe_number(low), describe_number(high))
            }
        };
        if general != name && !axes.iter().any(|(known, _)| known == general) {
            let of_all = meaning.replace("the ball", "every ball");
            axes.push((general.to_owned(), format!("{of_all}, {unit}; default {range}.")));
        }
        let range = if general == name { range } else { format!("that of `{general}`") };
        axes.push((name, format!("{meaning}, {unit}; default {range}.")));
    }
    axes
}

/// One coordinate of the box.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BoxAxis {
    /// Name, such as `beta_dot_2`.
    pub name: String,
    /// Smallest value.
    pub low: f64,
    /// Largest value; equal to `low` for a fixed coordinate.
    pub high: f64,
}

impl BoxAxis {
    /// Returns whether the coordinate is fixed.
    pub fn is_fixed(&self) -> bool {
        self.low == self.high
    }

    /// Returns the value at a fraction of the range, from zero to one.
    pub fn at(&self, fraction: f64) -> f64 {
        (self.low + fraction * (self.high - self.low)).clamp(self.low, self.high)
    }
}

/// The box with all axes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct InitialBox {
    /// One axis per coordinate, in the order of [`axis_names`].
    pub axes: Vec<BoxAxis>,
}

impl InitialBox {
    /// Fills in the default ranges.
    ///
    /// # Errors
    /// Returns an error if a name is not a coordinate, or if the lower end of a range is above the
    /// upper end.
    pub fn resolve(
        path: &SourcePath<'_>,
        written: Option<&IndexMap<String, Range>>,
        model: &Model,
    ) -> Result<InitialBox, StudyError> {
        let names = axis_names(model);
        let general_names: &[&str] = if model.balls() > 0 { &GENERAL_AXES } else { &[] };
        for (name, Range([low, high])) in written.into_iter().flatten() {
            if !names.contains(name) && !general_names.contains(&name.as_str()) {
                let mut allowed: Vec<String> =
                    general_names.iter().map(|&name| name.to_owned()).collect();
                allowed.extend(names);
                let fault = Fault::new("unknown key", name, list_names(name, &allowed));
                return Err(path.key(name).refuse_key(fault));
            }
            if low > high {
                let found = format!("[{}, {}]", describe_number(*low), describe_number(*high));
                let allowed = "[low, high] with low not above high";
                let fault = Fault::new("reversed range", found, allowed);
                return Err(path.key(name).refuse_value(fault));
            }
            if !(high - low).is_finite() {
                let found = format!("[{}, {}]", describe_number(*low), describe_number(*high));
                let fault = Fault::new("too wide a range", found, "a finite width");
                return Err(path.key(name).refuse_value(fault));
            }
        }
        let range = |name: &str| {
            let general = general_name(name);
            let given = written.and_then(|ranges| ranges.get(name).or_else(|| ranges.get(general)));
            given.map_or_else(|| default_range(general, model), |range| range.0)
        };
        let axes = names
            .into_iter()
            .map(|name| {
                let [low, high] = range(&name);
                BoxAxis { name, low, high }
            })
            .collect();
        Ok(InitialBox { axes })
    }

    /// Returns the box in the form of a study file.
    pub fn to_file(&self) -> IndexMap<String, Range> {
        let ranges = self.axes.iter().map(|axis| (axis.name.clone(), Range([axis.low, axis.high])));
        ranges.collect()
    }
}

fn general_name(name: &str) -> &str {
    ["beta_dot", "beta"].into_iter().find(|stem| name.starts_with(stem)).unwrap_or(name)
}

fn default_range(general: &str, model: &Model) -> [f64; 2] {
    let either_way = |half: f64| [-half, half];
    match (general, model) {
        ("beta", _) => [0.0, TAU],
        ("beta_dot", _) => either_way(DEFAULT_BALL_SPEED),
        ("velocity_m_s", _) => [0.0, 0.0],
        ("position_m", Model::Block(block)) => either_way(block.unit_length_m()),
        _ => either_way(DEFAULT_HALF_WIDTH),
    }
}
