//! Figure: the natural frequencies of a system over the speed of its part that turns, and its critical speeds.

use crate::model::CampbellDiagram;
use crate::numbers::significant;
use crate::report::chart::{Colour, Figure, Layer, Mark, Panel, Symbol, Tooltips, axis};
use crate::report::data::ReportData;

/// Plots the Campbell diagram of the fastest point in detail, with uncertain parameters at their medians.
pub fn figure(data: &ReportData<'_>) -> Option<Figure> {
    let models = data.details().filter_map(|point| {
        let mut model = data.study.median_model(point.point_id).ok()?;
        let speed = model.speed_parameter()?.numbers(&mut model, None).pop()?.abs();
        Some((speed, point, model))
    });
    let (_, fastest, model) = models.max_by(|left, right| left.0.total_cmp(&right.0))?;
    let diagram = CampbellDiagram::of(&model)?;
    let unit = data.study.units().speed();
    let speeds: Vec<f64> = diagram.speeds_rad_s.iter().map(|speed| unit.of(*speed)).collect();
    let modes = diagram.frequencies_rad_s.iter().map(Vec::len).max().unwrap_or(0);
    let mode = |mode: usize| {
        let at = |(speed, all): (&f64, &Vec<f64>)| {
            [*speed, all.get(mode).map_or(f64::NAN, |frequency| unit.of(*frequency))]
        };
        let points = speeds.iter().zip(&diagram.frequencies_rad_s).map(at).collect();
        let name = format!("natural frequency {}", mode + 1);
        Layer::new(&name, Colour::Series(mode), Mark::Line { points, dashed: false })
    };
    let mut layers: Vec<Layer> = (0..modes).map(mode).collect();
    let most = speeds.last().copied().unwrap_or(0.0);
    let points = vec![[0.0, 0.0], [most, most]];
    layers.push(Layer::new("speed", Colour::Faint, Mark::Line { points, dashed: true }));
    let critical: Vec<f64> = diagram.critical_rad_s.iter().map(|speed| unit.of(*speed)).collect();
    let tooltips = Tooltips::numbers([("critical speed", critical.clone())]);
    let places: Vec<[f64; 2]> = critical.iter().map(|speed| [*speed; 2]).collect();
    let dots = Mark::dots(Symbol::Diamond, &places, tooltips);
    layers.push(Layer::new("critical speed", Colour::Ink, dots));
    let of_point = match data.point_count {
        1 => String::new(),
        _ => format!(" This is the diagram of {}.", fastest.title),
    };
    let shown: Vec<String> = critical.iter().map(|speed| significant(*speed)).collect();
    let alternative = match shown.len() {
        0 => "There is no critical speed.".to_owned(),
        _ => format!("The critical speeds are {} {}.", shown.join(", "), unit.symbol),
    };
    let (x, y) = (axis("speed", &unit.symbol), axis("natural frequency", &unit.symbol));
    Figure::new(
        "campbell",
        "Natural frequencies (Campbell diagram)",
        format!(
            "Natural frequencies of the coordinates that no contact moves, or of all coordinates without friction if \
             contacts move all of them. At a critical speed, a natural frequency equals the speed.{of_point}"
        ),
        alternative,
        vec![Panel::new(x, y, layers)],
    )
}
