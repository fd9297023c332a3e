//! Swept parameters as axes, the points grouped along them, and panels of values of points over them, or over the points if no
//! number is swept.

use indexmap::IndexMap;

use crate::report::chart::{Axis, AxisKind, Layer, Panel};
use crate::report::data::{PointFacts, ReportData, axis_of, heading};
use crate::study::{ParameterValue, Study};

/// A swept parameter as an axis.
pub struct SweepAxis {
    /// Index among the swept parameters.
    pub column: usize,
    /// The axis.
    pub axis: Axis,
}

/// Points that differ in one parameter only.
pub struct SweepGroup<'a> {
    /// The values of the other parameters in words; empty if there is one group.
    pub title: String,
    /// Value of the parameter and the point, by ascending value.
    pub points: Vec<(f64, &'a PointFacts)>,
}

/// Returns the value of a swept parameter at a point, in the unit that the study chooses; `None` if it is not a number.
pub fn number(study: &Study, point: &PointFacts, column: usize) -> Option<f64> {
    match point.swept.get(column) {
        Some(ParameterValue::Number(number)) => {
            Some(study.swept().get(column)?.shown_number(*number))
        }
        _ => None,
    }
}

/// Returns the distinct numbers of a swept parameter, ascending; `None` if a value is not a number.
pub fn distinct(data: &ReportData<'_>, column: usize) -> Option<Vec<f64>> {
    let of_point = |point| number(data.study, point, column);
    let mut values: Vec<f64> = data.points.iter().map(of_point).collect::<Option<_>>()?;
    values.sort_by(f64::total_cmp);
    values.dedup();
    Some(values)
}

/// Whether ascending values belong on a logarithmic axis: they span two decades or more, and most of them are small
/// compared with the largest.
pub fn is_by_decades(values: &[f64]) -> bool {
    let (Some(least), Some(most)) = (values.first(), values.last()) else { return false };
    let small = values.iter().filter(|value| **value < 0.2 * most).count();
    *least > 0.0 && most / least >= 100.0 && 2 * small >= values.len()
}

/// Returns the known values of points in groups that differ in these columns only, in the order of the sweep, with the values
/// of the other parameters in words.
pub fn grouped<'a, T>(
    data: &'a ReportData<'_>,
    columns: &[usize],
    value: impl Fn(&'a PointFacts) -> Option<T>,
) -> Vec<(String, Vec<T>)> {
    let mut groups: IndexMap<String, Vec<T>> = IndexMap::new();
    for point in &data.points {
        let Some(value) = value(point) else { continue };
        let title = heading(data.study, &point.swept, |column| !columns.contains(&column));
        groups.entry(title).or_default().push(value);
    }
    groups.into_iter().collect()
}

impl SweepAxis {
    /// Returns the swept parameters with at least `least` values, the one with the most values first.
    pub fn all(data: &ReportData<'_>, least: usize) -> Vec<SweepAxis> {
        let columns = data.study.swept().iter().enumerate();
        let mut axes: Vec<(usize, SweepAxis)> = columns
            .filter_map(|(column, parameter)| {
                let values = distinct(data, column)?;
                // All panels share the full range of the sweep.
                let (from, to) = (values.first()?, values.last()?);
                let decades = is_by_decades(&values);
                let (range, kind) = if decades {
                    let factor = (to / from).powf(0.04);
                    ([from / factor, to * factor], AxisKind::Logarithmic)
                } else {
                    let margin = 0.04 * (to - from);
                    ([from - margin, to + margin], AxisKind::Linear)
                };
                let axis = Axis { range: Some(range), kind, ..axis_of(parameter) };
                (values.len() >= least).then_some((values.len(), SweepAxis { column, axis }))
            })
            .collect();
        axes.sort_by_key(|(values, _)| std::cmp::Reverse(*values));
        axes.into_iter().map(|(_, axis)| axis).collect()
    }

    /// Returns the points in groups that differ in this parameter only, in the order of the sweep.
    pub fn groups<'a>(&self, data: &'a ReportData<'_>) -> Vec<SweepGroup<'a>> {
        let value = |point| Some((number(data.study, point, self.column)?, point));
        let groups = grouped(data, &[self.column], value).into_iter();
        let sorted = |(title, mut points): (String, Vec<(f64, &'a PointFacts)>)| {
            points.sort_by(|(a, _), (b, _)| a.total_cmp(b));
            SweepGroup { title, points }
        };
        let mut groups: Vec<SweepGroup<'a>> = groups.map(sorted).collect();
        if let [only] = &mut groups[..] {
            only.title.clear();
        }
        groups
    }
}

/// The panels of points over a parameter, one for each combination of the other parameters.
pub struct OverSweep<'a> {
    /// The parameter; empty if the panels are over the points.
    pub parameter: String,
    /// Sentences on what is not shown; empty if everything is.
    pub left_out: String,
    /// The abscissa.
    pub x: Axis,
    /// The points of each panel with their abscissas.
    pub groups: Vec<SweepGroup<'a>>,
}

impl<'a> OverSweep<'a> {
    /// Chooses the parameter with the most values, and shows all its points.
    pub fn all(data: &'a ReportData<'_>) -> Self {
        match SweepAxis::all(data, 2).into_iter().next() {
            Some(sweep) => OverSweep {
                parameter: sweep.axis.name.clone(),
                left_out: String::new(),
                groups: sweep.groups(data),
                x: sweep.axis,
            },
            None => {
                let named: Vec<&PointFacts> = data.details().collect();
                let x = data.axis_of_points(&named);
                let points = (0..).map(f64::from).zip(named).collect();
                let groups = vec![SweepGroup { title: String::new(), points }];
                OverSweep { parameter: String::new(), left_out: data.left_out(), x, groups }
            }
        }
    }

    /// Thins out the points so that `values` values of each stay within the budget.
    pub fn new(data: &'a ReportData<'_>, values: usize) -> Self {
        let mut all = Self::all(data);
        if all.parameter.is_empty() {
            return all;
        }
        let groups = &mut all.groups;
        // The groups with the most points come first.
        groups.sort_by_key(|group| std::cmp::Reverse(group.points.len()));
        let more = groups.len().saturating_sub(data.budget.details);
        groups.truncate(data.budget.details);
        let each = data.budget.points / values.max(1) / groups.len().max(1);
        let mut most_left_out = 1;
        for SweepGroup { points, .. } in groups {
            let one_in = points.len().div_ceil(each.max(1)).max(1);
            most_left_out = most_left_out.max(one_in);
            *points = points.iter().copied().step_by(one_in).collect();
        }
        if more > 0 {
            all.left_out = format!(" {more} other combinations of parameters are not shown.");
        }
        if most_left_out > 1 {
            all.left_out += &format!(" Every {most_left_out}th point is shown.");
        }
        all
    }

    /// Returns one panel per combination of the other parameters, with the layers of its points.
    pub fn panels(
        &self,
        y: &Axis,
        layers: impl Fn(&[(f64, &'a PointFacts)]) -> Vec<Layer>,
    ) -> Vec<Panel> {
        let panel = |SweepGroup { title, points }: &SweepGroup<'a>| Panel {
            title: title.clone(),
            ..Panel::new(self.x.clone(), y.clone(), layers(points))
        };
        self.groups.iter().map(panel).collect()
    }
}
