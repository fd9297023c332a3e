//! Axes on paper: where they begin and end, their ticks, and what is written at them.

use std::f64::consts::PI;

use super::font;
use crate::report::chart::{Axis, AxisKind, Mark, Panel};

/// Height of the font in points.
pub const SIZE: f64 = 8.0;

/// An axis with its range and its ticks.
#[derive(Clone, Debug, PartialEq)]
pub struct Ruled {
    /// Where it begins and ends.
    pub range: [f64; 2],
    /// Whether it is logarithmic.
    pub logarithmic: bool,
    /// Whether it is not shown.
    pub hidden: bool,
    /// Places with words.
    pub ticks: Vec<(f64, String)>,
    /// Places without.
    pub minor: Vec<f64>,
    /// What it measures, with its unit.
    pub name: String,
}

impl Ruled {
    /// The part of the axis at which a value is; not a number where it has no place.
    pub fn part(&self, value: f64) -> f64 {
        let [from, to] = self.range;
        if self.logarithmic {
            let value = if value > 0.0 { value.log10() } else { f64::NAN };
            (value - from.log10()) / (to.log10() - from.log10())
        } else {
            (value - from) / (to - from)
        }
    }

    /// The width of its widest tick's words.
    pub fn widest(&self) -> f64 {
        self.ticks.iter().map(|(_, words)| font::width(words, SIZE)).fold(0.0, f64::max)
    }
}

/// Which axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The abscissa.
    X,
    /// The ordinate.
    Y,
}

/// An axis of a panel with ticks that have room on so many points.
pub fn ruled(panel: &Panel, which: Which, length: f64) -> Ruled {
    let axis = match which {
        Which::X => &panel.x,
        Which::Y => &panel.y,
    };
    let range = range(panel, axis, which);
    let logarithmic = axis.kind == AxisKind::Logarithmic;
    let room = |ticks: &[(f64, String)]| {
        let spacing = length / (ticks.len().max(2) - 1) as f64;
        let widest = ticks.iter().map(|(_, words)| font::width(words, SIZE)).fold(0.0, f64::max);
        match which {
            Which::X => widest + 8.0 <= spacing,
            Which::Y => 1.9 * SIZE <= spacing,
        }
    };
    let mut minor = Vec::new();
    let mut factor = 0;
    let ticks = match &axis.kind {
        AxisKind::Hidden => Vec::new(),
        AxisKind::Angle => angles(range),
        AxisKind::Names(names) => {
            let words = |name: &String| with_minus(name);
            names.iter().enumerate().map(|(place, name)| (place as f64, words(name))).collect()
        }
        AxisKind::Logarithmic => {
            let (major, between) = decades(range, room);
            minor = between;
            major
        }
        AxisKind::Linear => {
            let power = factor_of(range);
            factor = power;
            let most = (2..=9).rev().map(|most| linear(range, most, power));
            let mut all: Vec<Vec<(f64, String)>> = most.collect();
            let fits = all.iter().position(|ticks| room(ticks)).unwrap_or(all.len() - 1);
            all.swap_remove(fits)
        }
    };
    let unit = multiple(factor, &axis.unit);
    let name = match unit.is_empty() {
        true => axis.name.clone(),
        false => format!("{} [{unit}]", axis.name),
    };
    Ruled { range, logarithmic, hidden: axis.kind == AxisKind::Hidden, ticks, minor, name }
}

/// A unit with a power of ten: a prefix where it has one, or the power before it.
fn multiple(power: i32, unit: &str) -> String {
    let prefix = match power {
        -9 => "n",
        -6 => "µ",
        -3 => "m",
        3 => "k",
        6 => "M",
        _ => "",
    };
    let takes_prefix = matches!(unit, "m" | "s" | "N" | "Hz") || unit == "m/s";
    match (power, prefix) {
        (0, _) => unit.to_owned(),
        (_, prefix) if !prefix.is_empty() && takes_prefix => format!("{prefix}{unit}"),
        _ => format!("10{} {unit}", superscript(power)).trim_end().to_owned(),
    }
}

/// Words with the sign for minus before numbers.
pub fn with_minus(words: &str) -> String {
    let mut proper = String::with_capacity(words.len());
    let mut letters = words.chars().peekable();
    let mut before = ' ';
    while let Some(letter) = letters.next() {
        let number = letters.peek().is_some_and(char::is_ascii_digit);
        let begins = !before.is_alphanumeric();
        proper.push(if letter == '-' && number && begins { '−' } else { letter });
        before = letter;
    }
    proper
}

/// Where an axis begins and ends: as it says, or round the marks.
fn range(panel: &Panel, axis: &Axis, which: Which) -> [f64; 2] {
    let usable = |[from, to]: &[f64; 2]| {
        let positive = axis.kind != AxisKind::Logarithmic || *from > 0.0;
        from.is_finite() && to.is_finite() && from < to && positive
    };
    if let Some(range) = axis.range.filter(usable) {
        return range;
    }
    match &axis.kind {
        AxisKind::Angle => return [0.0, 2.0 * PI],
        AxisKind::Names(names) => return [-0.5, names.len().max(1) as f64 - 0.5],
        _ => {}
    }
    let logarithmic = axis.kind == AxisKind::Logarithmic;
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for layer in &panel.layers {
        visit(&layer.mark, which, &mut |value| {
            if value.is_finite() && !(logarithmic && value <= 0.0) {
                (least, most) = (least.min(value), most.max(value));
            }
        });
    }
    if least > most {
        return if logarithmic { [1.0, 10.0] } else { [0.0, 1.0] };
    }
    if logarithmic {
        let beside = (most / least).powf(0.04).max(1.05);
        return [least / beside, most * beside];
    }
    let beside = match most - least {
        0.0 => 0.1 * least.abs().max(1e-9),
        span => 0.04 * span,
    };
    // A count or a share begins at 0 where it comes near it.
    let from_zero = least == 0.0;
    [if from_zero { 0.0 } else { least - beside }, most + beside]
}

/// Shows all values of a mark along an axis.
fn visit(mark: &Mark, which: Which, see: &mut impl FnMut(f64)) {
    let axis = usize::from(which == Which::Y);
    let mut all = |values: &[f64]| values.iter().for_each(|value| see(*value));
    match (mark, which) {
        (Mark::Line { points, .. } | Mark::Steps { points }, _) => {
            points.iter().for_each(|point| see(point[axis]));
        }
        (Mark::Words { at, .. }, _) => at.iter().for_each(|point| see(point[axis])),
        (Mark::Regions { rings, .. }, _) => {
            rings.iter().flatten().for_each(|point| see(point[axis]));
        }
        (Mark::Band { x, .. } | Mark::Intervals { x, .. } | Mark::Dots { x, .. }, Which::X) => {
            all(x);
        }
        (Mark::Band { low, high, .. } | Mark::Intervals { low, high, .. }, Which::Y) => {
            all(low);
            all(high);
        }
        (Mark::Dots { y, .. }, Which::Y) => all(y),
        (Mark::Bars { x, width, .. }, Which::X) => x.iter().for_each(|x| {
            see(x - 0.5 * width);
            see(x + 0.5 * width);
        }),
        (Mark::Bars { base, top, .. }, Which::Y) => {
            all(base);
            all(top);
        }
        (Mark::Cells { edges, .. }, _) => edges.iter().for_each(|edge| {
            see(edge[2 * axis]);
            see(edge[2 * axis + 1]);
        }),
        (Mark::Rule { upright, at, .. }, _) => {
            if *upright == (which == Which::X) {
                see(*at);
            }
        }
    }
}

/// The least number of 1, 2 and 5 times a power of ten that is not below.
fn nice(step: f64) -> f64 {
    let power = 10.0_f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= step * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// The power of ten, a multiple of 3, that is taken out of numbers that would be long.
fn factor_of([from, to]: [f64; 2]) -> i32 {
    let most = from.abs().max(to.abs());
    if (1e-2..1e5).contains(&most) {
        return 0;
    }
    3 * ((most.log10() + 1e-9) / 3.0).floor() as i32
}

/// At most so many even ticks, with a power of ten taken out.
fn linear([from, to]: [f64; 2], most: usize, power: i32) -> Vec<(f64, String)> {
    let step = nice((to - from) / most as f64);
    if !(step.is_normal() && (to - from) / step < 1e3) {
        return Vec::new();
    }
    let unit = 10.0_f64.powi(power);
    let decimals = (-(step / unit).log10() - 1e-9).ceil().clamp(0.0, 12.0) as usize;
    let first = (from / step - 1e-9).ceil() as i64;
    let last = (to / step + 1e-9).floor() as i64;
    let tick = |k: i64| {
        let value = k as f64 * step;
        (value, signed(format!("{:.decimals$}", value / unit)))
    };
    (first..=last).map(tick).collect()
}

/// With the sign for minus.
fn signed(number: String) -> String {
    match number.strip_prefix('-') {
        Some(rest) if rest.chars().all(|letter| "0.".contains(letter)) => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => number,
    }
}

/// Multiples of π/2, or of π where there are many.
fn angles([from, to]: [f64; 2]) -> Vec<(f64, String)> {
    let step: i64 = if to - from > 4.5 * PI { 2 } else { 1 };
    let quarter = PI / 2.0;
    let (first, last) = ((from / quarter - 1e-6).ceil(), (to / quarter + 1e-6).floor());
    if last - first > 64.0 {
        return Vec::new();
    }
    let (first, last) = (first as i64, last as i64);
    let words = |k: i64| {
        let sign = if k < 0 { "−" } else { "" };
        match (k.abs(), k % 2 == 0) {
            (0, _) => "0".to_owned(),
            (2, _) => format!("{sign}π"),
            (k, true) => format!("{sign}{}π", k / 2),
            (1, _) => format!("{sign}π/2"),
            (k, _) => format!("{sign}{k}π/2"),
        }
    };
    (first..=last).filter(|k| k % step == 0).map(|k| (k as f64 * quarter, words(k))).collect()
}

/// Powers of ten, or 1, 2 and 5 times them where there are few; and what is between.
fn decades(
    [from, to]: [f64; 2],
    room: impl Fn(&[(f64, String)]) -> bool,
) -> (Vec<(f64, String)>, Vec<f64>) {
    let first = (from.log10() - 1e-9).ceil() as i32;
    let last = (to.log10() + 1e-9).floor() as i32;
    let within = |value: &f64| (from * (1.0 - 1e-9)..=to * (1.0 + 1e-9)).contains(value);
    let times = |factors: &[f64]| -> Vec<f64> {
        let all = (first - 1..=last + 1)
            .flat_map(|power| factors.iter().map(move |factor| factor * 10.0_f64.powi(power)));
        all.filter(within).collect()
    };
    let minor =
        if last - first > 12 { Vec::new() } else { times(&[2., 3., 4., 5., 6., 7., 8., 9.]) };
    if last - first < 1 {
        let plain = |value: &f64| (*value, signed(format!("{}", round(*value))));
        let few: Vec<(f64, String)> = times(&[1.0, 2.0, 5.0]).iter().map(plain).collect();
        return (few, minor);
    }
    let plain = first >= -3 && last <= 4;
    let words = |power: i32| match plain {
        true => format!("{}", round(10.0_f64.powi(power))),
        false => format!("10{}", superscript(power)),
    };
    for step in 1..=last - first {
        let ticks: Vec<(f64, String)> = (first..=last)
            .filter(|power| power % step == 0)
            .map(|power| (10.0_f64.powi(power), words(power)))
            .collect();
        if room(&ticks) {
            return (ticks, minor);
        }
    }
    (vec![(10.0_f64.powi(first), words(first))], minor)
}

fn round(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// A power in raised digits.
fn superscript(power: i32) -> String {
    let raised = |letter| match letter {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        // The others follow one another from 0 on.
        digit => char::from_u32(0x2070 + u32::from(digit) - u32::from('0')).unwrap_or(digit),
    };
    power.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::{Which, multiple, ruled, superscript, with_minus};
    use crate::report::chart::{Axis, AxisKind, Panel};

    fn words(kind: AxisKind, range: [f64; 2], length: f64) -> (Vec<String>, String) {
        let axis = Axis { name: "a".into(), unit: "m".into(), range: Some(range), kind };
        let panel = Panel {
            title: String::new(),
            part: String::new(),
            x: axis.clone(),
            y: axis,
            scale: None,
            layers: vec![],
        };
        let ruled = ruled(&panel, Which::X, length);
        (ruled.ticks.into_iter().map(|(_, words)| words).collect(), ruled.name)
    }

    #[test]
    fn ticks_are_round_numbers_that_have_room() {
        assert_eq!(
            words(AxisKind::Linear, [-0.3, 1.0], 200.0).0,
            ["−0.2", "0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(words(AxisKind::Linear, [0.0, 16.5], 40.0).0, ["0", "10"]);
        let (small, name) = words(AxisKind::Linear, [0.0, 5.5e-5], 200.0);
        assert_eq!((small[1].as_str(), name.as_str()), ("10", "a [µm]"));
        assert_eq!(
            words(AxisKind::Angle, [0.0, std::f64::consts::TAU], 90.0).0,
            ["0", "π/2", "π", "3π/2", "2π"]
        );
        assert_eq!(words(AxisKind::Logarithmic, [0.02, 30.0], 200.0).0, ["0.1", "1", "10"]);
        assert_eq!(words(AxisKind::Logarithmic, [1e-9, 1.0], 100.0).0.len(), 4);
        assert_eq!(words(AxisKind::Logarithmic, [1.5, 6.0], 100.0).0, ["2", "5"]);
        assert_eq!(superscript(-10), "⁻¹⁰");
    }

    #[test]
    fn minus_is_before_numbers_only() {
        assert_eq!(
            with_minus("speed -1.5 rad/s, 1e-3, a-1, (-2)"),
            "speed −1.5 rad/s, 1e-3, a-1, (−2)"
        );
        assert_eq!(multiple(-6, "1/s"), "10⁻⁶ 1/s");
        assert_eq!(multiple(3, ""), "10³");
    }

    #[test]
    fn any_range_has_an_axis() {
        for range in [[0.0, 0.0], [f64::NAN, 1.0], [-f64::MAX, f64::MAX], [1.0, 1.0 + 1e-15]] {
            for kind in [AxisKind::Linear, AxisKind::Logarithmic, AxisKind::Angle] {
                assert!(words(kind, range, 100.0).0.len() < 100, "{range:?}");
            }
        }
    }
}
