//! Intervals with their rates of change along a direction: bounds of the equations of motion over a box of states.
//!
//! Each operation rounds outwards (R. E. Moore, R. B. Kearfott, M. J. Cloud, *Introduction to Interval Analysis*, SIAM 2009,
//! doi:10.1137/1.9780898717716). Where a function is not defined on an interval, the result is not a number.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{Dual, Elementary, Function, Number};

/// All numbers between two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

/// The relative error of an elementary function.
const FUNCTION_ERROR: f64 = 4.0 * f64::EPSILON;

impl Interval {
    /// Returns the numbers that differ from another one by at most a radius.
    pub fn around(middle: f64, radius: f64) -> Self {
        Interval { low: (middle - radius).next_down(), high: (middle + radius).next_up() }
    }

    /// Returns a single number.
    pub fn exact(value: f64) -> Self {
        Interval { low: value, high: value }
    }

    /// Returns the largest distance of a number in the interval from another one.
    pub fn farthest_from(self, value: f64) -> f64 {
        let [low, high] = [(self.low - value).abs(), (self.high - value).abs()];
        // Not a number unless both ends are numbers.
        if low.is_nan() || high.is_nan() { f64::NAN } else { low.max(high) }
    }

    /// Returns the interval between the least and the greatest of some numbers, and rounds outwards.
    fn of(ends: &[f64]) -> Self {
        if ends.iter().any(|end| end.is_nan()) {
            return Interval::exact(f64::NAN);
        }
        let low = ends.iter().copied().fold(f64::INFINITY, f64::min);
        let high = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Interval { low: low.next_down(), high: high.next_up() }
    }

    /// Returns the values of a function that grows.
    fn growing(self, function: impl Fn(f64) -> f64) -> Self {
        let [low, high] = [function(self.low), function(self.high)];
        Interval::of(&[low - FUNCTION_ERROR * low.abs(), high + FUNCTION_ERROR * high.abs()])
    }

    /// Returns the sine.
    fn sine(self) -> Self {
        let (low, high) = (self.low, self.high);
        if high - low >= TAU {
            return Interval { low: -1.0, high: 1.0 };
        }
        let ends = Interval::of(&[libm::sin(low), libm::sin(high)]);
        // Whether it contains an angle that differs from another one by whole turns, to rounding.
        let slack = FUNCTION_ERROR * (1.0 + low.abs().max(high.abs()));
        let contains = |angle: f64| {
            let next = angle + TAU * ((low - slack - angle) / TAU).ceil();
            next <= high + slack
        };
        Interval {
            low: if contains(-FRAC_PI_2) { -1.0 } else { ends.low - FUNCTION_ERROR },
            high: if contains(FRAC_PI_2) { 1.0 } else { ends.high + FUNCTION_ERROR },
        }
    }

    fn reciprocal(self) -> Self {
        match self.low > 0.0 || self.high < 0.0 {
            true => Interval::of(&[1.0 / self.low, 1.0 / self.high]),
            false => Interval::exact(f64::NAN),
        }
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        if other == Interval::exact(0.0) {
            return self;
        }
        Interval::of(&[self.low + other.low, self.high + other.high])
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let zero = Interval::exact(0.0);
        let finite = |factor: Interval| factor.low.is_finite() && factor.high.is_finite();
        if (self == zero && finite(other)) || (other == zero && finite(self)) {
            return zero;
        }
        let products = [self.low * other.low, self.low * other.high];
        Interval::of(&[products[0], products[1], self.high * other.low, self.high * other.high])
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Interval { low: -self.high, high: -self.low }
    }
}

/// Values and rates of change along a direction, for all states of a box.
pub type Bounded = Dual<Interval>;

impl Div for Bounded {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let inverse = other.reciprocal();
        Bounded {
            value: self.value * inverse.value,
            slope: self.slope * inverse.value + self.value * inverse.slope,
        }
    }
}

impl Number for Bounded {
    fn constant(value: f64) -> Self {
        Bounded { value: Interval::exact(value), slope: Interval::exact(0.0) }
    }

    fn sin_cos(self) -> (Self, Self) {
        let sine = self.value.sine();
        // The sum is not exact, but the slack of the sine is larger.
        let cosine = (self.value + Interval::exact(FRAC_PI_2)).sine();
        (self.chain(sine, cosine), self.chain(cosine, -sine))
    }

    fn reciprocal(self) -> Self {
        let value = self.value.reciprocal();
        self.chain(value, -(value * value))
    }
}

impl Elementary for Bounded {
    fn value(self) -> f64 {
        0.5 * (self.value.low + self.value.high)
    }

    fn is_zero(self) -> bool {
        self == Bounded::constant(0.0)
    }

    fn sqrt(self) -> Self {
        let root = self.value.growing(libm::sqrt);
        self.chain(root, Interval::exact(0.5) * root.reciprocal())
    }

    fn function(self, function: Function) -> Self {
        let value = self.value.growing(|number| function.of(number));
        let slope = match function {
            Function::Exponential => value,
            Function::ArcTangent => {
                let square = self.value * self.value;
                let square = Interval { low: square.low.max(0.0), ..square };
                (Interval::exact(1.0) + square).reciprocal()
            }
            Function::Logarithm => self.value.reciprocal(),
        };
        self.chain(value, slope)
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::{Bounded, Interval};
    use crate::model::{Dual, Elementary, Function, Number};

    fn probe<T: Elementary>(x: T, which: usize) -> T {
        let (sine, cosine) = x.sin_cos();
        match which {
            0 => sine * cosine,
            1 => (x * x + T::constant(0.5)).sqrt(),
            2 => (cosine * x).function(Function::Exponential) - sine,
            3 => (x * x + T::constant(0.2)).reciprocal(),
            4 => (x * x + T::constant(0.3)).function(Function::Logarithm),
            _ => (x * x * x - sine).function(Function::ArcTangent),
        }
    }

    /// Values and slopes at random places of random intervals are within the bounds; the bounds of narrow intervals are narrow.
    #[test]
    fn intervals_contain_values_and_slopes() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let mut unknown = 0;
        for _ in 0..20_000 {
            let middle = rng.random_range(-8.0..8.0);
            let radius = rng.random::<f64>().powi(6) * 4.0;
            let which = rng.random_range(0..6_usize);
            let box_of_x =
                Bounded { value: Interval::around(middle, radius), slope: Interval::exact(1.0) };
            let bounds = probe(box_of_x, which);
            let x = middle + radius * rng.random_range(-1.0..1.0);
            let Dual { value, slope } = probe(Dual { value: x, slope: 1.0 }, which);
            for (bounds, found) in [(bounds.value, value), (bounds.slope, slope)] {
                // The product of a wide interval with itself may be negative: no bound is known then.
                if bounds.low.is_nan() && radius > 0.1 {
                    unknown += 1;
                    continue;
                }
                assert!(
                    bounds.low <= found && found <= bounds.high,
                    "{which}: {found} at {x}, {bounds:?} in {middle} +- {radius}"
                );
                if radius < 1e-6 {
                    let width = bounds.high - bounds.low;
                    assert!(width < 1e6 * radius + 1e-10 * (1.0 + found.abs()), "{which}: {width}");
                }
            }
        }
        assert!(unknown < 2000, "{unknown}");
        let undefined = Bounded::constant(0.0).reciprocal().value;
        assert!(undefined.low.is_nan() && undefined.farthest_from(0.0).is_nan());
    }
}
