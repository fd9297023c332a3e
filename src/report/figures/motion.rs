//! The motion of a run over time, from what `stickslip replay` has written (thesis figures 5.6 and 5.15).

use std::f64::consts::PI;

use nalgebra::Complex;

use super::layers::axis;
use crate::analysis::RestForm;
use crate::model::Case;
use crate::report::chart::{Axis, AxisKind, Colour, Figure, Layer, Mark, Panel};
use crate::table::{Kind, Table, TableError};

/// Most rows that are read.
const MOST_ROWS: usize = 2_000_000;
/// Points of the motion after the balls have come to rest.
const AT_REST: usize = 20_000;

/// The figure: angles and speeds of the balls and the table's position, or position, speed and friction of
/// a block. A run that was recorded from end to end, and ended because its balls rest for good, is drawn on
/// to its end time in closed form: `case` is that run.
///
/// # Errors
/// Where a column is missing or cannot be read.
pub fn motion(
    table: &Table,
    balls: usize,
    title: &str,
    case: Option<&Case>,
) -> Result<Option<Figure>, TableError> {
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
    let (mut time, mut columns) = read(table, &names)?;
    let (Some(begin), Some(last)) = (time.first().copied(), time.last().copied()) else {
        return Ok(None);
    };
    let on = match case {
        Some(case) => at_rest(table, case, last)?,
        None => Vec::new(),
    };
    for [at, x, y] in &on {
        time.push(*at);
        let count = columns.len();
        for (place, column) in columns.iter_mut().enumerate() {
            let stays = column.last().copied().unwrap_or(f64::NAN);
            column.push(match count - place {
                2 => *x,
                1 => *y,
                _ => stays,
            });
        }
    }
    let end = time.last().copied().unwrap_or(last);
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
            && alike(&one.mark, &other.mark)
        {
            one.name = "balls 1 and 2, side by side".to_owned();
            one.colour = Colour::Ink;
            layers.truncate(1);
        }
        panels.push(Panel {
            title: String::new(),
            part: String::new(),
            x: Axis { range: Some([begin, end]), ..axis("time", "s") },
            y,
            scale: None,
            layers,
        });
    }
    let rest = match on.is_empty() {
        true => String::new(),
        false => format!(
            " From {last:.2} s on nothing can move the balls, and the curves are closed forms."
        ),
    };
    let whose = if balls == 0 { "a block" } else { "balls and table" };
    Ok(Some(Figure {
        id: "motion".to_owned(),
        title: title.to_owned(),
        caption: match balls {
            0 => "Position, sliding speed and friction over time.".to_owned(),
            _ => "Angles of the balls from the imbalance, their speeds relative to the ring, and the \
                  position of the ring's centre in the frame that turns with the disc, x towards the \
                  imbalance."
                .to_owned()
                + &rest,
        },
        alternative: format!("The motion of {whose} from {begin:.4} s to {end:.4} s."),
        panels,
        one_at_a_time: false,
    }))
}

/// The motion of the table from the last row on, up to the end time, where all balls stick: time in s, x
/// and y in m. Seen from the disc it obeys `ü + 2(ζ + iω) u̇ + (1 - ω² + 2iζω) u = 0` about its rest point
/// (thesis section 5.2), with the eigenvalues `-iω - ζ ± i sqrt(1 - ζ²)`.
fn at_rest(table: &Table, case: &Case, last: f64) -> Result<Vec<[f64; 3]>, TableError> {
    let end = case.simulation.end_times_s()[0];
    let Some(machine) = case.model.ball_balancer().filter(|_| last < end) else {
        return Ok(Vec::new());
    };
    let balls = 1..=machine.balls.len();
    let angles: Vec<String> = balls.clone().map(|ball| format!("beta_{ball}_rad")).collect();
    let phases: Vec<String> = balls.map(|ball| format!("phase_{ball}")).collect();
    let state = ["x", "y", "x_dot", "y_dot"];
    let numbers = state.into_iter().chain(angles.iter().map(String::as_str));
    let mut wanted: Vec<(&str, Kind)> = numbers.map(|name| (name, Kind::Number)).collect();
    wanted.extend(phases.iter().map(|name| (name.as_str(), Kind::Text)));
    let (mut values, mut stuck) = (Vec::new(), false);
    for batch in table.read(&wanted)? {
        let batch = batch?;
        if batch.rows == 0 {
            continue;
        }
        values.clear();
        for (name, kind) in &wanted {
            if *kind == Kind::Number {
                values.push(batch.numbers(name)?.last().copied().flatten().unwrap_or(f64::NAN));
            }
        }
        stuck = true;
        for name in &phases {
            stuck &= batch.texts(name)?.last().and_then(|phase| phase.as_deref()) == Some("stick");
        }
    }
    let (Some(form), [x, y, x_dot, y_dot, beta @ ..]) = (RestForm::new(machine), &values[..])
    else {
        return Ok(Vec::new());
    };
    let (damping, natural) = (form.damping_ratio, form.natural_frequency_rad_s);
    let still = form.rest_point(beta);
    if !stuck || !still.is_finite() || damping.is_nan() || damping >= 1.0 {
        return Ok(Vec::new());
    }
    let (away, speed) = (Complex::new(*x, *y) - still, Complex::new(*x_dot, *y_dot));
    let turn = (1.0 - damping * damping).sqrt();
    let [one, other] = [turn, -turn].map(|turn| Complex::new(-damping, turn - form.speed));
    let first = (speed - other * away) / (one - other);
    let second = away - first;
    let point = |k: usize| {
        let time = (end - last) * k as f64 / AT_REST as f64;
        let value = |rate: Complex<f64>| (rate * (natural * time)).exp();
        let z = (still + first * value(one) + second * value(other)) * form.ring_radius_m;
        [last + time, z.re, z.im]
    };
    Ok((1..=AT_REST).map(point).collect())
}

/// Whether two lines are the same, gaps and all.
fn alike(one: &Mark, other: &Mark) -> bool {
    match (one, other) {
        (Mark::Line { points: one, .. }, Mark::Line { points: other, .. }) => {
            let same = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan());
            one.len() == other.len() && one.iter().flatten().zip(other.iter().flatten()).all(same)
        }
        _ => false,
    }
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
