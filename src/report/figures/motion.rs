//! The motion of a run over time, from what `stickslip replay` has written (thesis figures 5.6 and 5.15).

use std::f64::consts::PI;

use super::layers::axis;
use crate::report::chart::{Axis, AxisKind, Colour, Figure, Layer, Mark, Panel};
use crate::table::{Kind, Table, TableError};

/// Most rows that are read.
const MOST_ROWS: usize = 2_000_000;

/// The figure: angles and speeds of the balls and the table's position, or position, speed and friction of
/// a block.
///
/// # Errors
/// Where a column is missing or cannot be read.
pub fn motion(table: &Table, balls: usize, title: &str) -> Result<Option<Figure>, TableError> {
    let of_ball = |stem: &str, unit: &str| -> Vec<String> {
        (1..=balls).map(|ball| format!("{stem}_{ball}_{unit}")).collect()
    };
    let one = |name: &str| vec![name.to_owned()];
    // Names of columns, name and unit of the axis, and what its values are multiplied by.
    let parts: Vec<(Vec<String>, Axis, f64)> = match balls {
        0 => vec![
            (one("position_m"), axis("position", "m"), 1.0),
            (one("sliding_speed_m_s"), axis("sliding speed", "m/s"), 1.0),
            (one("friction_n"), axis("friction", "N"), 1.0),
        ],
        _ => vec![
            (
                of_ball("beta", "rad"),
                Axis { kind: AxisKind::Angle, ..axis("angle of the balls", "rad") },
                1.0,
            ),
            (of_ball("ball_speed", "rad_s"), axis("speed of the balls", "rad/s"), 1.0),
            (one("x_m"), axis("x of the table", "µm"), 1e6),
            (one("y_m"), axis("y of the table", "µm"), 1e6),
        ],
    };
    let names: Vec<&str> = parts.iter().flat_map(|(names, ..)| names).map(String::as_str).collect();
    let (time, columns) = read(table, &names)?;
    let (Some(begin), Some(end)) = (time.first(), time.last()) else { return Ok(None) };
    if begin >= end {
        return Ok(None);
    }
    let mut columns = columns.into_iter();
    let mut panels = Vec::new();
    for (names, y, factor) in parts {
        let mut layers: Vec<Layer> = Vec::new();
        let angle = y.kind == AxisKind::Angle;
        let count = names.len();
        for (ball, values) in columns.by_ref().take(count).enumerate() {
            let points = time.iter().zip(values).map(|(time, value)| [*time, factor * value]);
            let points = if angle { unbroken(points) } else { points.collect() };
            let (name, colour) = match count {
                1 => (String::new(), Colour::Ink),
                _ => (format!("ball {}", ball + 1), Colour::Series(ball)),
            };
            layers.push(Layer { name, colour, mark: Mark::Line { points, dashed: false } });
        }
        // A ball side by side with another would not be seen.
        if let [one, other] = &mut layers[..]
            && one.mark == other.mark
        {
            one.name = "balls 1 and 2, side by side".to_owned();
            one.colour = Colour::Ink;
            layers.truncate(1);
        }
        panels.push(Panel {
            title: String::new(),
            part: String::new(),
            x: Axis { range: Some([*begin, *end]), ..axis("time", "s") },
            y,
            scale: None,
            layers,
        });
    }
    let whose = if balls == 0 { "a block" } else { "balls and table" };
    Ok(Some(Figure {
        id: "motion".to_owned(),
        title: title.to_owned(),
        caption: match balls {
            0 => "Position, sliding speed and friction over time.".to_owned(),
            _ => "Angles of the balls from the imbalance, their speeds relative to the ring, and the \
                  position of the ring's centre in the frame that turns with the disc, x towards the \
                  imbalance."
                .to_owned(),
        },
        alternative: format!("The motion of {whose} from {begin:.4} s to {end:.4} s."),
        panels,
        one_at_a_time: false,
    }))
}

/// Time and these columns.
fn read(table: &Table, names: &[&str]) -> Result<(Vec<f64>, Vec<Vec<f64>>), TableError> {
    let mut wanted = vec![("time_s", Kind::Number)];
    wanted.extend(names.iter().map(|name| (*name, Kind::Number)));
    let mut time = Vec::new();
    let mut columns = vec![Vec::new(); names.len()];
    for batch in table.read(&wanted)? {
        let batch = batch?;
        let number = |value: &Option<f64>| value.unwrap_or(f64::NAN);
        time.extend(batch.numbers("time_s")?.iter().map(number));
        for (column, name) in columns.iter_mut().zip(names) {
            column.extend(batch.numbers(name)?.iter().map(number));
        }
        if time.len() >= MOST_ROWS {
            break;
        }
    }
    Ok((time, columns))
}

/// Angles over time, broken where one goes round.
fn unbroken(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut line: Vec<[f64; 2]> = Vec::new();
    for point in points {
        if line.last().is_some_and(|last| (point[1] - last[1]).abs() > PI) {
            line.push([f64::NAN; 2]);
        }
        line.push(point);
    }
    line
}
