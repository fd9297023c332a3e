//! Equilibria without friction over the speed of the disc: a panel for each kind (thesis figure 5.1).

use std::f64::consts::{PI, TAU};

use super::layers::axis;
use crate::analysis::FrictionlessKind;
use crate::model::Machine;
use crate::report::chart::{
    Axis, AxisKind, Colour, Figure, Layer, Mark, Panel, Symbol, TipColumn, TipValues, Tips,
};
use crate::table::{Kind, Table, TableError};

/// Most rows of the table that are read.
const MOST_ROWS: usize = 200_000;
/// About so many circles on a branch over all speeds.
const CIRCLES: usize = 30;

/// A row of `frictionless.parquet`.
struct Row {
    /// Speed of the disc, rad/s.
    speed: f64,
    kind: FrictionlessKind,
    beta: Vec<f64>,
    stable: bool,
}

/// A kind as the thesis writes it.
fn symbol(kind: FrictionlessKind) -> &'static str {
    match kind {
        FrictionlessKind::A1Plus => "A1+",
        FrictionlessKind::A1Minus => "A1−",
        FrictionlessKind::A2 => "A2",
        FrictionlessKind::B1 => "B1",
        FrictionlessKind::Other => "on one line",
        FrictionlessKind::Everywhere => "everywhere",
    }
}

/// The figure; none unless the table has rows at several speeds.
///
/// # Errors
/// Where a column is missing or cannot be read.
pub fn branches(table: &Table, machine: &Machine) -> Result<Option<Figure>, TableError> {
    let balls = machine.balls.len();
    let rows = read(table, balls)?;
    let mut speeds: Vec<f64> = rows.iter().map(|row| row.speed).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let (Some(least), Some(most)) = (speeds.first(), speeds.last()) else { return Ok(None) };
    if speeds.len() < 3 {
        return Ok(None);
    }
    // To the right the disc turns faster, whichever way.
    let clockwise = *most <= 0.0;
    let sign = if clockwise { -1.0 } else { 1.0 };
    let mut range = [sign * least, sign * most];
    range.sort_by(f64::total_cmp);
    let natural = machine.natural_frequency_rad_s();
    let kinds = FrictionlessKind::ALL.into_iter();
    let panels: Vec<Panel> = kinds
        .filter_map(|kind| {
            let mut own: Vec<&Row> = rows.iter().filter(|row| row.kind == kind).collect();
            own.sort_by(|a, b| (sign * a.speed).total_cmp(&(sign * b.speed)));
            if own.iter().all(|row| row.beta.is_empty()) {
                return None;
            }
            let mut layers = vec![
                rule(sign * if clockwise { -natural } else { natural }),
                words_only("stable", Mark::Line { points: Vec::new(), dashed: false }),
                words_only("unstable", Mark::Line { points: Vec::new(), dashed: true }),
                words_only("unstable", dots(&[], &[])),
            ];
            layers.extend(layers_of(&own, &speeds, sign, balls));
            Some(Panel {
                title: symbol(kind).to_owned(),
                part: String::new(),
                x: Axis { range: Some(range), ..speed_axis(clockwise) },
                y: Axis {
                    range: Some([0.0, TAU]),
                    kind: AxisKind::Angle,
                    ..axis("angle of the balls", "rad")
                },
                scale: None,
                layers,
            })
        })
        .collect();
    if panels.is_empty() {
        return Ok(None);
    }
    let stable = |kind: FrictionlessKind| {
        let of_kind = || rows.iter().filter(move |row| row.kind == kind);
        let (all, stable) = (of_kind().count(), of_kind().filter(|row| row.stable).count());
        format!("{} is stable at {stable} of the {all} speeds at which it exists", symbol(kind))
    };
    let present = FrictionlessKind::ALL
        .into_iter()
        .filter(|kind| rows.iter().any(|row| row.kind == *kind && !row.beta.is_empty()));
    let facts: Vec<String> = present.map(stable).collect();
    Ok(Some(Figure {
        id: "frictionless-branches".to_owned(),
        title: "Equilibria without dry friction over the speed of the disc".to_owned(),
        caption: "Where the balls rest without dry friction: A1+ and A1− all together, A2 opposite each \
                  other, B1 balanced. Solid: stable; dashed with circles: unstable; ωₙ: natural frequency."
            .to_owned(),
        alternative: format!("{}; of {} speeds.", facts.join("; "), speeds.len()),
        panels,
        one_at_a_time: false,
    }))
}

fn speed_axis(clockwise: bool) -> Axis {
    axis(if clockwise { "speed of the disc −ω" } else { "speed of the disc ω" }, "rad/s")
}

fn read(table: &Table, balls: usize) -> Result<Vec<Row>, TableError> {
    let angles: Vec<String> = (1..=balls).map(|ball| format!("beta_{ball}_rad")).collect();
    let mut wanted =
        vec![("speed_rad_s", Kind::Number), ("kind", Kind::Text), ("stability", Kind::Text)];
    wanted.extend(angles.iter().map(|name| (name.as_str(), Kind::Number)));
    let mut rows = Vec::new();
    for batch in table.read(&wanted)? {
        let batch = batch?;
        let speeds = batch.numbers("speed_rad_s")?;
        let (kinds, stability) = (batch.texts("kind")?, batch.texts("stability")?);
        let beta = angles.iter().map(|name| batch.numbers(name)).collect::<Result<Vec<_>, _>>()?;
        for place in 0..batch.rows {
            let word = kinds.get(place).and_then(|kind| kind.as_deref()).unwrap_or_default();
            let kind = FrictionlessKind::ALL.into_iter().find(|kind| kind.name() == word);
            let number = |values: &[Option<f64>]| values.get(place).copied().flatten();
            let (Some(speed), Some(kind)) = (number(speeds), kind) else { continue };
            let beta: Option<Vec<f64>> = beta.iter().map(|angle| number(angle)).collect();
            let stability = stability.get(place).and_then(|word| word.as_deref());
            let stable = stability == Some("stable");
            rows.push(Row { speed, kind, beta: beta.unwrap_or_default(), stable });
        }
        if rows.len() >= MOST_ROWS {
            break;
        }
    }
    Ok(rows)
}

fn rule(at: f64) -> Layer {
    let mark = Mark::Rule { upright: true, at, label: "ωₙ".to_owned() };
    Layer { name: String::new(), colour: Colour::Faint, mark }
}

/// Only for the legend.
fn words_only(name: &str, mark: Mark) -> Layer {
    Layer { name: name.to_owned(), colour: Colour::Ink, mark }
}

fn dots(x: &[f64], y: &[f64]) -> Mark {
    let tips = Tips {
        run_ids: Vec::new(),
        columns: vec![TipColumn {
            name: "speed of the disc [rad/s]".to_owned(),
            values: TipValues::Numbers(x.to_vec()),
        }],
    };
    Mark::Dots { symbol: Symbol::Circle, x: x.to_vec(), y: y.to_vec(), tips }
}

/// The branches of a kind: for each ball, or for all where they are together.
fn layers_of(rows: &[&Row], speeds: &[f64], sign: f64, balls: usize) -> Vec<Layer> {
    let together = rows.iter().all(|row| row.beta.windows(2).all(|pair| pair[0] == pair[1]));
    let drawn = if together { 1 } else { balls };
    let mut layers = Vec::new();
    for ball in 0..drawn {
        let (name, colour) = match together {
            true => ("balls together".to_owned(), Colour::Series(2)),
            false => (format!("ball {}", ball + 1), Colour::Series(ball)),
        };
        let points = |stable| -> Vec<(usize, [f64; 2])> {
            let of_kind = rows.iter().filter(|row| row.stable == stable);
            let point = |row: &&&Row| {
                let place = speeds.partition_point(|speed| *speed < row.speed);
                Some((place, [sign * row.speed, *row.beta.get(ball)?]))
            };
            of_kind.filter_map(|row| point(&row)).collect()
        };
        for (stable, name) in [(true, name.as_str()), (false, "")] {
            let points = points(stable);
            let line = Mark::Line { points: connected(&points), dashed: !stable };
            layers.push(Layer { name: name.to_owned(), colour, mark: line });
            if !stable {
                let every = speeds.len().div_ceil(CIRCLES);
                let few = points.iter().filter(|(place, _)| place % every == every / 2);
                let (x, y): (Vec<f64>, Vec<f64>) = few.map(|(_, [x, y])| (*x, *y)).unzip();
                layers.push(Layer { name: String::new(), colour, mark: dots(&x, &y) });
            }
        }
    }
    layers
}

/// Points at neighbouring speeds as a line, broken where a speed is left out and where an angle goes
/// round.
fn connected(points: &[(usize, [f64; 2])]) -> Vec<[f64; 2]> {
    let mut line: Vec<[f64; 2]> = Vec::new();
    for (number, (place, point)) in points.iter().enumerate() {
        if let Some((before, last)) = number.checked_sub(1).and_then(|k| points.get(k))
            && (place.abs_diff(*before) > 1 || (point[1] - last[1]).abs() > PI)
        {
            line.push([f64::NAN; 2]);
        }
        line.push(*point);
    }
    line
}
