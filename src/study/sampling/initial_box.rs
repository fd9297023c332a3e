//! The box of start states: one range per coordinate.

use indexmap::IndexMap;

use crate::model::{Coordinate, Model};
use crate::study::error::{StudyError, list_names, low_high};
use crate::study::file::source::SourcePath;
use crate::study::file::values::Range;

/// Returns the names of the coordinates of a start state, in their order.
pub(crate) fn axis_names(model: &Model) -> Vec<String> {
    model.coordinates().into_iter().map(|coordinate| coordinate.name).collect()
}

/// Returns the names that a box may have, those of all balls and those of one ball, each with its
/// meaning, unit and default range.
pub(crate) fn axes_in_words(model: &Model) -> Vec<(String, String)> {
    let mut axes: Vec<(String, String)> = Vec::new();
    for coordinate in model.coordinates() {
        let Coordinate { meaning, unit_in_words: unit, default_range: [low, high], .. } =
            coordinate;
        let range = match coordinate.default_in_words {
            Some(words) => words.to_owned(),
            None => low_high(low, high),
        };
        let Some(general) = coordinate.of_every_body else {
            axes.push((coordinate.name, format!("{meaning}, {unit}; default {range}.")));
            continue;
        };
        if !axes.iter().any(|(known, _)| known == general) {
            let body = model.kind().body;
            let of_all = meaning.replace(&format!("the {body}"), &format!("every {body}"));
            axes.push((general.to_owned(), format!("{of_all}, {unit}; default {range}.")));
        }
        let words = format!("{meaning}, {unit}; default that of `{general}`.");
        axes.push((coordinate.name, words));
    }
    axes
}

/// Returns the names that stand for a coordinate of every ball.
pub(crate) fn general_axes(model: &Model) -> Vec<&'static str> {
    let mut names: Vec<&str> =
        model.coordinates().iter().filter_map(|coordinate| coordinate.of_every_body).collect();
    names.dedup();
    names
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
        let general_names = general_axes(model);
        for (name, Range([low, high])) in written.into_iter().flatten() {
            if !names.contains(name) && !general_names.contains(&name.as_str()) {
                let mut allowed: Vec<String> =
                    general_names.iter().map(|&name| name.to_owned()).collect();
                allowed.extend(names);
                let allowed = list_names(name, &allowed);
                return Err(path.key(name).wrong_key("unknown key", name, allowed));
            }
            if low > high {
                let (found, allowed) =
                    (low_high(*low, *high), "[low, high] with low not above high");
                return Err(path.key(name).wrong_value("reversed range", found, allowed));
            }
            if !(high - low).is_finite() {
                let found = low_high(*low, *high);
                return Err(path.key(name).wrong_value(
                    "too wide a range",
                    found,
                    "a finite width",
                ));
            }
        }
        let range = |coordinate: &Coordinate| {
            let given = written.and_then(|ranges| {
                let found = ranges.get(&coordinate.name);
                found.or_else(|| ranges.get(coordinate.of_every_body?))
            });
            given.map_or(coordinate.default_range, |range| range.0)
        };
        let axis = |coordinate: Coordinate| {
            let [low, high] = range(&coordinate);
            BoxAxis { name: coordinate.name, low, high }
        };
        let axes: Vec<BoxAxis> = model.coordinates().into_iter().map(axis).collect();
        // The default ranges of a system file are formulas.
        let is_reversed = |axis: &&BoxAxis| {
            let width = axis.high - axis.low;
            width.is_nan() || width < 0.0
        };
        if let Some(BoxAxis { name, low, high }) = axes.iter().find(is_reversed) {
            let found = format!("{} by default", low_high(*low, *high));
            let allowed = "[low, high] with finite numbers and low not above high";
            return Err(path.key(name).wrong_key("reversed range", found, allowed));
        }
        Ok(InitialBox { axes })
    }

    /// Returns the ranges of the coordinates of a model. The box has all these coordinates.
    pub fn of(&self, model: &Model) -> InitialBox {
        let names = axis_names(model);
        let axes = self.axes.iter().filter(|axis| names.contains(&axis.name));
        InitialBox { axes: axes.cloned().collect() }
    }

    /// Returns the box in the form of a study file.
    pub fn to_file(&self) -> IndexMap<String, Range> {
        let ranges = self.axes.iter().map(|axis| (axis.name.clone(), Range([axis.low, axis.high])));
        ranges.collect()
    }
}
