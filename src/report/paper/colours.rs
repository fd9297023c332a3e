//! Colours on paper, for readers of all kinds of sight, and patterns that tell series apart without them.

use super::scene::{Box2, Paint, Step};
use crate::report::chart::Colour;

/// Series that colour-blind readers can tell apart (Okabe and Ito).
pub const SERIES: [[u8; 3]; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [70, 70, 70],
    [120, 94, 30],
];

/// The colour of text and frames.
pub const INK: [u8; 3] = [0, 0, 0];
/// For what only helps to read.
pub const FAINT: [u8; 3] = [130, 130, 130];
const GROUND: [u8; 3] = [255, 255, 255];

/// Viridis (S. van der Walt and N. Smith, 2015) from its yellow to its blue, in equal steps.
const SEQUENCE: [[f64; 3]; 7] = [
    [253.0, 231.0, 37.0],
    [189.0, 223.0, 38.0],
    [122.0, 209.0, 81.0],
    [68.0, 191.0, 112.0],
    [34.0, 168.0, 132.0],
    [33.0, 145.0, 140.0],
    [42.0, 120.0, 142.0],
];
/// White added to it, so that black dots are seen on all of it.
const WHITE: f64 = 0.35;

/// The colour of a part of the scale, from 0 to 1.
pub fn of_scale(part: f64) -> [u8; 3] {
    let part = if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.0 };
    let place = part * (SEQUENCE.len() - 1) as f64;
    let index = (place.floor() as usize).min(SEQUENCE.len() - 2);
    let (low, high) = (SEQUENCE[index], SEQUENCE[index + 1]);
    [0, 1, 2].map(|k| {
        let pure = low[k] + (place - index as f64) * (high[k] - low[k]);
        (pure + WHITE * (255.0 - pure)).round() as u8
    })
}

/// What a colour looks like; one by value is ink where no value is meant.
pub fn of(colour: Colour) -> Paint {
    Paint::of(match colour {
        Colour::Ink | Colour::Scale => INK,
        Colour::Faint => FAINT,
        Colour::Ground => GROUND,
        Colour::Series(number) => SERIES[number % SERIES.len()],
        Colour::Equilibrium => SERIES[0],
        Colour::LimitCycle => SERIES[1],
        Colour::Irregular => SERIES[3],
        Colour::Undecided => [150, 150, 150],
        Colour::Failed => [0, 0, 0],
    })
}

/// Which pattern goes with a colour; 0 is none.
pub fn pattern(colour: Colour) -> usize {
    match colour {
        Colour::Series(number) => number % 5,
        Colour::LimitCycle => 1,
        Colour::Irregular => 2,
        Colour::Undecided => 3,
        Colour::Failed => 4,
        _ => 0,
    }
}

/// The dashes of a line.
pub fn dash(pattern: usize) -> Vec<f64> {
    match pattern {
        0 => vec![],
        1 => vec![5.0, 1.8],
        2 => vec![1.2, 1.6],
        3 => vec![6.0, 1.6, 1.2, 1.6],
        _ => vec![9.0, 2.0, 2.5, 2.0],
    }
}

/// The lines across an area.
pub fn hatch(pattern: usize, area: Box2) -> Vec<Step> {
    let rising = || slanted(area, 1.0);
    let falling = || slanted(area, -1.0);
    match pattern {
        0 => vec![],
        1 => rising(),
        2 => falling(),
        3 => {
            let (first, last) =
                ((area.top / GAP).ceil() as i64, (area.bottom / GAP).floor() as i64);
            let line = |k: i64| {
                let y = k as f64 * GAP;
                [Step::Move([area.left, y]), Step::Line([area.right, y])]
            };
            (first..=last).flat_map(line).collect()
        }
        _ => [rising(), falling()].concat(),
    }
}

/// Between lines of a hatching.
const GAP: f64 = 3.5;

/// Slanted lines across a rectangle, on which `y + slope x` is a multiple of the gap.
fn slanted(area: Box2, slope: f64) -> Vec<Step> {
    let gap = GAP * std::f64::consts::SQRT_2;
    let corners = [
        area.top + slope * area.left,
        area.top + slope * area.right,
        area.bottom + slope * area.left,
        area.bottom + slope * area.right,
    ];
    let first = corners.iter().copied().fold(f64::INFINITY, f64::min) / gap;
    let last = corners.iter().copied().fold(f64::NEG_INFINITY, f64::max) / gap;
    let mut steps = Vec::new();
    for k in first.ceil() as i64..=last.floor() as i64 {
        let sum = k as f64 * gap;
        // Where the line enters and leaves: between the abscissas of the upper and the lower edge.
        let mut ends = [(sum - area.top) * slope, (sum - area.bottom) * slope];
        ends.sort_by(f64::total_cmp);
        let (from, to) = (ends[0].max(area.left), ends[1].min(area.right));
        if from < to {
            steps.extend([
                Step::Move([from, sum - slope * from]),
                Step::Line([to, sum - slope * to]),
            ]);
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::{hatch, of_scale};
    use crate::report::paper::scene::{Box2, Step};

    /// Relative luminance (WCAG 2): the scale falls evenly, and black on it has a contrast of 5 and more.
    #[test]
    fn the_scale_falls_and_black_is_seen_on_it() {
        let luminance = |part: f64| {
            let linear = of_scale(part).map(|value| (f64::from(value) / 255.0).powf(2.2));
            0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
        };
        let all: Vec<f64> = (0..=20).map(|k| luminance(f64::from(k) / 20.0)).collect();
        assert!(all.windows(2).all(|pair| pair[1] < pair[0]));
        assert!((all[20] + 0.05) / 0.05 > 5.0, "{}", all[20]);
        assert_eq!(of_scale(f64::NAN), of_scale(-1.0));
    }

    #[test]
    fn hatching_stays_inside() {
        let area = Box2 { left: 3.0, top: -20.0, right: 40.0, bottom: 5.0 };
        for pattern in 1..5 {
            let steps = hatch(pattern, area);
            assert!(steps.len() > 4);
            for step in steps {
                let (Step::Move([x, y]) | Step::Line([x, y])) = step else { panic!() };
                assert!((3.0 - 1e-9..=40.0 + 1e-9).contains(&x), "{x}");
                assert!((-20.0 - 1e-9..=5.0 + 1e-9).contains(&y), "{y}");
            }
        }
    }
}
