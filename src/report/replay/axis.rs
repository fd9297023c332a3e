//! Where the ticks of an axis are, and what is written at them.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

/// An axis: its ends, its ticks, and how many digits these need.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) ticks: Vec<f64>,
    digits: usize,
    /// Digits behind the first, where numbers are too long to be written in full.
    significant: Option<usize>,
    /// What is written is the value times this.
    factor: f64,
    angle: bool,
}

impl Axis {
    /// With ticks at multiples of 1, 2 or 5 times a power of ten, about so many of them; `from` is less
    /// than `to`.
    pub(super) fn new(from: f64, to: f64, about: u32) -> Self {
        let rough = (to - from) / f64::from(about + 1);
        let power = libm::floor(libm::log10(rough));
        // The number that is nearest to the power of ten, which products need not be.
        let ten: f64 = format!("1e{power}").parse().unwrap_or(rough);
        let step = [1.0, 2.0, 5.0, 10.0].map(|of| of * ten).into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(rough);
        let digits = (-libm::floor(libm::log10(step * 1.000_001))).clamp(0.0, 15.0) as usize;
        let ends = [(from / step - 1e-9).ceil(), (to / step + 1e-9).floor()];
        let count = (ends[1] - ends[0]).clamp(0.0, 100.0) as u32;
        let ticks = (0..=count).map(|k| (ends[0] + f64::from(k)) * step).collect();
        // How many powers of ten a number spans, from its first digit to the last that counts.
        let first = libm::floor(libm::log10(from.abs().max(to.abs())));
        let last = libm::floor(libm::log10(step * 1.000_001));
        let long = digits > 6 || first > 6.0;
        let significant = long.then_some((first - last).clamp(0.0, 15.0) as usize);
        Axis { from, to, ticks, digits, significant, factor: 1.0, angle: false }
    }

    /// From 0 to 2π, with a tick at every quarter.
    pub(super) fn angle() -> Self {
        let ticks = (0..5).map(|quarter| f64::from(quarter) * FRAC_PI_2).collect();
        Axis { from: 0.0, to: TAU, ticks, digits: 0, significant: None, factor: 1.0, angle: true }
    }

    /// Of times in s, and the unit in which they are written.
    pub(super) fn time(from: f64, to: f64, about: u32) -> (Self, &'static str) {
        let (unit, factor) = unit_of_time(to - from);
        let Axis { ticks, digits, significant, .. } = Axis::new(factor * from, factor * to, about);
        let ticks = ticks.into_iter().map(|tick| tick / factor).collect();
        (Axis { from, to, ticks, digits, significant, factor, angle: false }, unit)
    }

    /// Around values, with room on both sides.
    pub(super) fn around(values: impl Iterator<Item = f64>, about: u32) -> Self {
        let finite = values.filter(|value| value.is_finite());
        let (least, most) =
            finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if least > most {
            return Axis::new(0.0, 1.0, about);
        }
        // A constant has rounding errors only.
        let room = 0.06 * (most - least);
        let room = match most.abs() {
            0.0 if room == 0.0 => 1.0,
            size if room <= 1e-9 * size => size,
            _ => room,
        };
        Axis::new(least - room, most + room, about)
    }

    /// What is written at a tick.
    pub(super) fn label(&self, value: f64) -> String {
        if self.angle {
            let quarter = (value / FRAC_PI_2).round() as usize;
            return ["0", "π/2", "π", "3π/2", "2π"]
                .get(quarter)
                .copied()
                .unwrap_or_default()
                .into();
        }
        let value = self.factor * value;
        let text = match self.significant {
            Some(digits) if value != 0.0 => format!("{value:.digits$e}"),
            Some(_) => "0".to_owned(),
            None => format!("{value:.*}", self.digits),
        };
        match text.strip_prefix('-') {
            Some(zero) if zero.chars().all(|c| "0.".contains(c)) => zero.to_owned(),
            Some(positive) => format!("−{positive}"),
            None => text,
        }
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        let part = (value - self.from) / (self.to - self.from);
        first + (f64::from(last - first) * part).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.from..self.to
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        self.label(*value)
    }
}

/// The unit in which a span of time is told, and how many of it are a second.
fn unit_of_time(span_s: f64) -> (&'static str, f64) {
    match span_s {
        span if span >= 0.5 => ("s", 1.0),
        span if span >= 5e-4 => ("ms", 1e3),
        span if span >= 5e-7 => ("µs", 1e6),
        _ => ("ns", 1e9),
    }
}

/// A time, given in s, as text with its unit, with four digits behind the point.
pub fn time_text(time_s: f64) -> String {
    let (unit, factor) = if time_s > 0.0 { unit_of_time(5.0 * time_s) } else { ("s", 1.0) };
    format!("{:.4} {unit}", factor * time_s)
}

#[cfg(test)]
mod tests {
    use super::{Axis, time_text, unit_of_time};

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks.iter().map(|tick| axis.label(*tick)).collect()
    }

    #[test]
    fn ticks_are_round_numbers_inside() {
        assert_eq!(
            labels(&Axis::new(0.0, 2.1875, 9)),
            ["0.0", "0.5", "1.0", "1.5", "2.0"].map(str::to_owned)
        );
        assert_eq!(labels(&Axis::new(-0.32, 0.21, 4)), ["−0.2", "0.0", "0.2"].map(str::to_owned));
        assert_eq!(labels(&Axis::new(99.5, 310.0, 5)), ["100", "150", "200", "250", "300"]);
        assert_eq!(labels(&Axis::new(-3e-7, 3e-7, 2)), ["−2e-7", "0", "2e-7"]);
        assert_eq!(labels(&Axis::angle()), ["0", "π/2", "π", "3π/2", "2π"]);
        for (from, to) in [(0.0, 1e-12), (-7e11, 3.0), (5.0, 5.0 + 1e-9), (0.1, 0.3)] {
            let axis = Axis::new(from, to, 5);
            let count = axis.ticks.len();
            assert!((2..=7).contains(&count), "{from} {to}: {:?}", axis.ticks);
            let room = 1e-8 * (to - from);
            assert!(axis.ticks.iter().all(|tick| (from - room..=to + room).contains(tick)));
        }
    }

    #[test]
    fn constants_have_an_axis() {
        for value in [0.0, 3.0, -1e-7] {
            let axis = Axis::around([value, value].into_iter(), 5);
            assert!(axis.from < value && value < axis.to && axis.ticks.len() > 1);
        }
        assert_eq!(Axis::around([f64::NAN].into_iter(), 5), Axis::new(0.0, 1.0, 5));
    }

    #[test]
    fn times_are_told_in_units_that_fit() {
        assert_eq!(
            [66.0, 0.02, 1e-5, 1e-9].map(|span| unit_of_time(span).0),
            ["s", "ms", "µs", "ns"]
        );
        assert_eq!(
            [2.18754, 0.1, 0.00386, 0.0].map(time_text),
            ["2.1875 s", "0.1000 s", "3.8600 ms", "0.0000 s"]
        );
    }
}
