//! Encodes figures as JSON for the page's script, with long columns of numbers packed.
//!
//! A packed column is an object with one base64 string of little-endian values: `f` holds 32-bit floats (NaN: no
//! value), `u` 32-bit whole numbers, and `w` 16-bit steps between `from` and `to` (65535: no value). A step is a
//! hundredth of a screen pixel.

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde_json::{Map, Value, json};

use crate::report::chart::{
    Axis, AxisKind, Figure, Layer, Mark, Panel, TooltipColumn, TooltipValues, Tooltips,
};

/// The longest column that is not packed.
const SHORT: usize = 24;
/// The number of dots above which coordinates are packed in 16 bits each.
const MANY: usize = 4000;

/// Encodes a figure.
pub fn figure(figure: &Figure) -> Value {
    json!({
        "id": figure.id,
        "title": figure.title,
        "alternative": figure.alternative,
        "one_at_a_time": figure.one_at_a_time,
        "panels": figure.panels.iter().map(panel).collect::<Vec<_>>(),
    })
}

fn panel(panel: &Panel) -> Value {
    json!({
        "title": panel.title,
        "part": panel.part,
        "x": axis(&panel.x),
        "y": axis(&panel.y),
        "scale": panel.scale,
        "layers": panel.layers.iter().map(layer).collect::<Vec<_>>(),
    })
}

fn axis(axis: &Axis) -> Value {
    let (kind, names) = match &axis.kind {
        AxisKind::Linear => ("linear", None),
        AxisKind::Logarithmic => ("logarithmic", None),
        AxisKind::Angle => ("angle", None),
        AxisKind::Names(names) => ("names", Some(names)),
    };
    json!({"name": axis.name, "unit": axis.unit, "range": axis.range, "kind": kind, "names": names})
}

fn layer(layer: &Layer) -> Value {
    let mut value = mark(&layer.mark);
    value.insert("name".to_owned(), json!(layer.name));
    value.insert("colour".to_owned(), json!(layer.colour));
    Value::Object(value)
}

fn mark(mark: &Mark) -> Map<String, Value> {
    let value = match mark {
        Mark::Line { points, dashed } => {
            json!({"mark": "line", "points": pairs(points), "dashed": dashed})
        }
        Mark::Steps { points } => json!({"mark": "steps", "points": pairs(points)}),
        Mark::Band { x, low, high, steps } => json!({
            "mark": "band", "x": column(x), "low": column(low), "high": column(high), "steps": steps,
        }),
        Mark::Intervals { x, low, high } => {
            json!({"mark": "intervals", "x": column(x), "low": column(low), "high": column(high)})
        }
        Mark::Bars { x, base, top, width } => json!({
            "mark": "bars", "x": column(x), "base": column(base), "top": column(top), "width": width,
        }),
        Mark::Dots { symbol, x, y, tooltips } => json!({
            "mark": "dots", "symbol": symbol, "x": coordinates(x), "y": coordinates(y),
            "tooltips": known(tooltips),
        }),
        Mark::Raster { size, values } => {
            json!({"mark": "raster", "size": size, "values": steps(values)})
        }
        Mark::Cells { edges, values, tooltips } => json!({
            "mark": "cells",
            "edges": column(&edges.iter().flatten().copied().collect::<Vec<_>>()),
            "values": column(&values.iter().map(|v| v.unwrap_or(f64::NAN)).collect::<Vec<_>>()),
            "tooltips": known(tooltips),
        }),
        Mark::Rule { upright, at, label } => {
            json!({"mark": "rule", "upright": upright, "at": at, "label": label})
        }
    };
    match value {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

fn known(tooltips: &Tooltips) -> Value {
    let column = |of: &TooltipColumn| match &of.values {
        TooltipValues::Numbers(values) => json!({"name": of.name, "values": column(values)}),
        TooltipValues::Words(values) => json!({"name": of.name, "words": values}),
    };
    json!({
        "run_ids": whole(&tooltips.run_ids),
        "columns": tooltips.columns.iter().map(column).collect::<Vec<_>>(),
    })
}

/// Encodes points as one flat list; packed in 16 bits if both coordinates have about the same range.
fn pairs(points: &[[f64; 2]]) -> Value {
    let span = |axis: usize| {
        let values = points.iter().map(|point| point[axis]).filter(|value| value.is_finite());
        let (from, to) = ends(values);
        to - from
    };
    let spans = [span(0), span(1)];
    let alike = spans.iter().all(|one| spans.iter().all(|other| one * 20.0 >= *other));
    let flat: Vec<f64> = points.iter().flatten().copied().collect();
    if alike && flat.len() > SHORT { steps(&flat) } else { column(&flat) }
}

fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), v| (from.min(v), to.max(v)))
}

/// Encodes numbers; those that are not finite become null or NaN.
fn column(values: &[f64]) -> Value {
    if values.len() <= SHORT {
        return json!(values);
    }
    let bytes = values.iter().flat_map(|value| (*value as f32).to_le_bytes());
    json!({"f": BASE64.encode(bytes.collect::<Vec<u8>>())})
}

fn whole(values: &[u64]) -> Value {
    let narrow: Option<Vec<u32>> = values.iter().map(|value| u32::try_from(*value).ok()).collect();
    match narrow {
        Some(narrow) if narrow.len() > SHORT => {
            let bytes = narrow.iter().flat_map(|value| value.to_le_bytes());
            json!({"u": BASE64.encode(bytes.collect::<Vec<u8>>())})
        }
        _ => json!(values),
    }
}

fn coordinates(values: &[f64]) -> Value {
    if values.len() < MANY { column(values) } else { steps(values) }
}

/// Encodes numbers in 16 bits each.
fn steps(values: &[f64]) -> Value {
    let (from, to) = ends(values.iter().copied().filter(|value| value.is_finite()));
    let span = to - from;
    if !(span > 0.0 && span.is_finite()) {
        return column(values);
    }
    let step = |value: f64| match value.is_finite() {
        true => ((value - from) / span * 65534.0).round() as u16,
        false => u16::MAX,
    };
    let bytes = values.iter().flat_map(|value| step(*value).to_le_bytes());
    json!({"w": BASE64.encode(bytes.collect::<Vec<u8>>()), "from": from, "to": to})
}
