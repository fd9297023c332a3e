//! Rows that belong to a point of the sweep, and the columns that identify the point.

use super::column::Columns;
use super::runs::add_swept;
use crate::study::{ParameterValue, Point, Study};

/// The point of the sweep that a row belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct PointKey {
    /// Number of the point, from 0.
    pub point_id: u64,
    /// Values of the swept parameters, in the order of [`crate::study::Plan::swept`].
    pub swept: Vec<ParameterValue>,
}

impl PointKey {
    /// Returns the key of a point.
    pub fn of(point: &Point) -> Self {
        PointKey { point_id: point.point_id, swept: point.swept.clone() }
    }
}

/// A row of a table that has any number of rows for each point.
#[derive(Clone, Debug, PartialEq)]
pub struct OfPoint<T> {
    /// The point.
    pub point: PointKey,
    /// The other values of the row.
    pub value: T,
}

impl<T> OfPoint<T> {
    /// Creates a row of a point.
    pub fn new(point: &PointKey, value: T) -> Self {
        OfPoint { point: point.clone(), value }
    }
}

/// Adds the columns that identify the point of the sweep; `point` gets it from a row.
pub(crate) fn add_point<R: 'static>(
    list: &mut Columns<R>,
    study: &Study,
    point: impl Fn(&R) -> &PointKey + Copy + Send + Sync + 'static,
) {
    list.point_id(move |row| point(row).point_id);
    add_swept(list, study, move |row| &point(row).swept);
}
