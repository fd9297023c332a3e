//! Panels of values of points over a swept parameter, or over the points if no number is swept.

use super::sweep_axis::SweepAxis;
use crate::report::chart::{Axis, Panel};
use crate::report::data::{PointFacts, ReportData};

/// The panels of points over a parameter, one for each combination of the other parameters.
pub struct OverSweep {
    /// The parameter; empty if the panels are over the points.
    pub parameter: String,
    /// Sentences on what is not shown; empty if everything is.
    pub left_out: String,
    /// The abscissa.
    x: Axis,
    /// The title of each panel, and its points with their abscissas.
    groups: Vec<(String, Vec<Placed>)>,
}

/// An abscissa and the index of a point.
type Placed = (f64, usize);

impl OverSweep {
    /// Chooses the parameter with the most values; thins out the points so that `values` values of each stay within the
    /// budget.
    pub fn new(data: &ReportData<'_>, values: usize) -> Self {
        let index = |point: &PointFacts| {
            let place = data.points.binary_search_by_key(&point.point_id, |other| other.point_id);
            place.unwrap_or_default()
        };
        let Some(sweep) = SweepAxis::all(data, 2).into_iter().next() else {
            let named: Vec<&PointFacts> = data.details().collect();
            let points = named.iter().enumerate();
            let points = points.map(|(place, point)| (place as f64, index(point))).collect();
            return OverSweep {
                parameter: String::new(),
                left_out: data.left_out(),
                x: data.axis_of_points(&named),
                groups: vec![(String::new(), points)],
            };
        };
        let mut groups = sweep.groups(data);
        // The groups with the most points come first.
        groups.sort_by_key(|group| std::cmp::Reverse(group.points.len()));
        let more = groups.len().saturating_sub(data.budget.details);
        groups.truncate(data.budget.details);
        let each = data.budget.points / values.max(1) / groups.len().max(1);
        let mut most_left_out = 1;
        let mut placed = Vec::new();
        for group in &groups {
            let one_in = group.points.len().div_ceil(each.max(1)).max(1);
            most_left_out = most_left_out.max(one_in);
            let points = group.points.iter().step_by(one_in);
            let points = points.map(|(x, point)| (*x, index(point))).collect();
            placed.push((group.title.clone(), points));
        }
        let mut left_out = match more {
            0 => String::new(),
            more => format!(" {more} other combinations of parameters are not shown."),
        };
        if most_left_out > 1 {
            left_out += &format!(" Every {most_left_out}th point is shown.");
        }
        OverSweep { parameter: sweep.axis.name.clone(), left_out, x: sweep.axis, groups: placed }
    }

    /// Returns one panel per combination of the other parameters, with the layers of its points.
    pub fn panels<'a>(
        &self,
        data: &'a ReportData<'_>,
        y: &Axis,
        layers: impl Fn(&[(f64, &'a PointFacts)]) -> Vec<crate::report::chart::Layer>,
    ) -> Vec<Panel> {
        let panel = |(title, placed): &(String, Vec<Placed>)| {
            let points = placed.iter();
            let points = points.filter_map(|(x, index)| Some((*x, data.points.get(*index)?)));
            let points: Vec<(f64, &PointFacts)> = points.collect();
            Panel { title: title.clone(), ..Panel::new(self.x.clone(), y.clone(), layers(&points)) }
        };
        self.groups.iter().map(panel).collect()
    }
}
