//! The probability of being at rest by time t, of each point.

use super::layers::{axis, moving, share_axis};
use crate::report::chart::{Colour, Figure, Layer, Mark, Panel};
use crate::report::gathered::{Gathered, PointFacts, RestCurve};

/// Curves with their bands, up to the study's end time.
pub fn figure(gathered: &Gathered<'_>) -> Option<Figure> {
    let end = gathered.study.simulation().end_time_s;
    let mut layers = Vec::new();
    let curve_of =
        |point: &PointFacts| gathered.rest.iter().find(|curve| curve.point_id == point.point_id);
    let with_curves: Vec<(&PointFacts, &RestCurve)> =
        gathered.details().filter_map(|point| Some((point, curve_of(point)?))).collect();
    for (place, (point, curve)) in with_curves.iter().enumerate() {
        let mark = Mark::Band {
            x: curve.time_s.clone(),
            low: curve.low.clone(),
            high: curve.high.clone(),
            steps: true,
        };
        layers.push(Layer { name: point.title.clone(), colour: Colour::Series(place), mark });
    }
    for (place, (point, curve)) in with_curves.iter().enumerate() {
        let steps = curve.time_s.iter().zip(&curve.probability).map(|(t, p)| [*t, *p]);
        let mut points: Vec<[f64; 2]> = std::iter::once([0.0, 0.0]).chain(steps).collect();
        // Nothing more happens up to the end.
        if let Some([time, probability]) = points.last().copied().filter(|[time, _]| *time < end) {
            points.push([end.max(time), probability]);
        }
        let mark = Mark::Steps { points };
        layers.push(Layer { name: point.title.clone(), colour: Colour::Series(place), mark });
    }
    if layers.is_empty() {
        return None;
    }
    let last = with_curves.iter().filter_map(|(_, curve)| curve.time_s.last().copied());
    let x = axis("time", "s");
    let x = super::super::chart::Axis { range: Some([0.0, last.fold(end, f64::max)]), ..x };
    let panel = Panel {
        title: String::new(),
        part: String::new(),
        x,
        y: share_axis("probability of being at rest"),
        scale: None,
        layers,
    };
    let medians: Vec<String> = with_curves
        .iter()
        .map(|(point, _)| match point.time_to_rest_s[1] {
            Some(median) => format!("{}: half at rest by {median:.3} s", point.title),
            None => format!("{}: less than half at rest", point.title),
        })
        .collect();
    Some(Figure {
        id: "time-to-rest".to_owned(),
        title: format!("When the {} come to rest", moving(gathered.study))
            .replace("block come", "block comes")
            .replace("ball come", "ball comes"),
        caption: format!(
            "Probability of being at rest by time t (Kaplan and Meier; runs that still move at the end \
             are censored), with 95 % bands.{}",
            gathered.left_out()
        ),
        alternative: medians.join("; "),
        panels: vec![panel],
        one_at_a_time: false,
    })
}
