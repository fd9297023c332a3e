//! Root isolation in a step: the first fall of a polynomial through zero.
//!
//! A part of the step is compared with the cubic that has the polynomial's values and slopes at its
//! ends: the two differ by at most `M t² (1 - t)² / 24` over a part of length 1, where `M` bounds
//! the fourth derivative. In the Bernstein form of degree four this affects only the middle
//! coefficient. If no coefficient is negative, the polynomial is not negative; if the coefficients
//! change their sign once, it falls through zero once. Parts with neither property are halved.

use super::ORDER;

/// An event is located where its condition is negative by half of this width, a fraction of the
/// relative tolerance within these bounds. The condition has then certainly failed, and one that is
/// met only up to rounding is not met twice.
const WIDTH_OVER_TOLERANCE: f64 = 1e-3;
const WIDTHS: (f64, f64) = (1e-12, 1e-9);

/// Returns the width within which events are located.
pub(in crate::motion) fn width(relative_tolerance: f64) -> f64 {
    (WIDTH_OVER_TOLERANCE * relative_tolerance).clamp(WIDTHS.0, WIDTHS.1)
}

/// Length of the shortest part that is halved.
const SHORTEST_PART: f64 = 1e-9;

/// A condition that is negative at the start by rounding has risen at this fraction of the step or later.
const RISEN: f64 = 1.0 / (1 << 29) as f64;

/// Size of the last step of Halley's method, as a fraction of the step: the remaining error, its
/// third power, is below the smallest width.
const LAST: f64 = 1e-5;

/// The fate of a condition in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ConditionFate {
    /// It holds to the end.
    Holds,
    /// It first fails at this fraction of the step.
    Fails(f64),
    /// It fails from the start.
    FailsAtOnce,
}

/// A polynomial in time over a step of this length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polynomial {
    pub(super) coefficients: [f64; ORDER + 1],
    pub(super) length: f64,
}

/// A place in a step, 0 at its start and 1 at its end, with value and slope there.
#[derive(Clone, Copy, Debug)]
pub(super) struct PolynomialPoint {
    pub(super) at: f64,
    pub(super) value: f64,
    pub(super) slope: f64,
}

/// Bounds of a polynomial without its coefficients: its ends, and a bound of its fourth derivative,
/// with the step's length as the unit of time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) ends: [PolynomialPoint; 2],
    pub(super) fourth_derivative: f64,
}

/// `k (k - 1) (k - 2) (k - 3)`: the factor of power `k` in the fourth derivative.
pub(super) const FOURTH: [f64; ORDER + 1] = {
    let mut all = [0.0; ORDER + 1];
    let mut k = 4;
    while k <= ORDER {
        all[k] = (k * (k - 1) * (k - 2) * (k - 3)) as f64;
        k += 1;
    }
    all
};

impl Bounds {
    /// Returns whether the condition certainly holds throughout.
    #[inline(always)]
    pub(super) fn holds(&self) -> bool {
        let [low, high] = self.ends;
        matches!(part(low, high, self.fourth_derivative), PartVerdict::Holds)
    }
}

impl Polynomial {
    /// Returns the polynomial with these coefficients up to a degree, plus an offset.
    #[inline(always)]
    pub(super) fn of(
        length: f64,
        offset: f64,
        degree: usize,
        coefficient: impl Fn(usize) -> f64,
    ) -> Self {
        let mut coefficients = [0.0; ORDER + 1];
        for (k, of_power) in coefficients[..=degree].iter_mut().enumerate() {
            *of_power = coefficient(k);
        }
        coefficients[0] += offset;
        Polynomial { coefficients, length }
    }

    /// Returns value and slope at a fraction of the step.
    #[inline(always)]
    fn place(&self, at: f64) -> PolynomialPoint {
        self.bend(at).0
    }

    /// Returns value, slope and half of the second derivative. Must be inlined where the
    /// processor's fused multiply-add is available; even and odd powers are separate, so that they
    /// are computed in parallel.
    #[inline(always)]
    fn bend(&self, at: f64) -> (PolynomialPoint, f64) {
        let time = at * self.length;
        let square = time * time;
        // Each with its first derivative by the square of time, and half of its second.
        let mut even = [self.coefficients[ORDER], 0.0, 0.0];
        let mut odd = [0.0; 3];
        for pair in self.coefficients[..ORDER].chunks_exact(2).rev() {
            for (sum, coefficient) in [(&mut even, pair[0]), (&mut odd, pair[1])] {
                sum[2] = sum[2].mul_add(square, sum[1]);
                sum[1] = sum[1].mul_add(square, sum[0]);
                sum[0] = sum[0].mul_add(square, coefficient);
            }
        }
        let slope = (2.0 * time).mul_add(time.mul_add(odd[1], even[1]), odd[0]);
        let bend = (4.0 * square).mul_add(time.mul_add(odd[2], even[2]), even[1]);
        let bend = (3.0 * time).mul_add(odd[1], bend);
        let value = time.mul_add(odd[0], even[0]);
        let place = PolynomialPoint { at, value, slope: slope * self.length };
        (place, bend * (self.length * self.length))
    }

    /// Its ends and a bound of its fourth derivative.
    #[inline(always)]
    pub(super) fn outline(&self) -> Bounds {
        let mut bound = 0.0_f64;
        for k in (4..=ORDER).rev() {
            bound = bound.mul_add(self.length, FOURTH[k] * self.coefficients[k].abs());
        }
        let square = self.length * self.length;
        let [value, slope, ..] = self.coefficients;
        let start = PolynomialPoint { at: 0.0, value, slope: slope * self.length };
        Bounds { ends: [start, self.place(1.0)], fourth_derivative: bound * (square * square) }
    }

    /// Returns where it first becomes negative.
    #[inline(always)]
    pub(super) fn first_fall(&self, outline: &Bounds) -> ConditionFate {
        let Bounds { ends: [mut low, end], fourth_derivative: bound } = *outline;
        if low.value <= 0.0 {
            // Negative by rounding: if it rises, the fall comes later, at most twice as late as the last place before it.
            // Loops, not closures: they must be inlined.
            let mut at = RISEN;
            while at < 1.0 {
                let place = self.place(at);
                if place.value > 0.0 {
                    low = place;
                } else if low.value > 0.0 {
                    break;
                }
                at *= 2.0;
            }
            if low.value <= 0.0 {
                return ConditionFate::FailsAtOnce;
            }
        }
        let mut high = end;
        loop {
            match part(low, high, bound) {
                PartVerdict::Falls => return ConditionFate::Fails(self.fall(low, high)),
                PartVerdict::Open if high.at - low.at > SHORTEST_PART => {
                    high = self.place(0.5 * (low.at + high.at));
                    continue;
                }
                PartVerdict::Open if high.value < 0.0 => {
                    return ConditionFate::Fails(self.fall(low, high));
                }
                PartVerdict::Holds | PartVerdict::Open => {}
            }
            if high.at >= 1.0 {
                return ConditionFate::Holds;
            }
            (low, high) = (high, end);
        }
    }

    /// Returns a located fall to rounding, by Newton's method. The error of [`Polynomial::first_fall`] is a fraction of
    /// the step, which is large where the fall follows soon after the start. A condition that begins at zero without a slope has
    /// nearly a multiple root there, where the method first halves its error only.
    #[inline(always)]
    pub(super) fn refined(&self, mut at: f64) -> f64 {
        const MOST: u32 = 64;
        const USUAL: u32 = 8;
        const CLOSE: f64 = 1e-6;
        for iteration in 1..=MOST {
            let PolynomialPoint { value, slope, .. } = self.place(at);
            let next = (at - value / slope).clamp(0.0, 1.0);
            if slope >= 0.0 || (next - at).abs() <= f64::EPSILON * at {
                break;
            }
            let is_close = (next - at).abs() <= CLOSE * at;
            at = next;
            if is_close && iteration >= USUAL {
                break;
            }
        }
        at
    }

    /// Returns the fall between two points by Halley's method, safeguarded by the bracket, starting
    /// from the fall of the cubic through their values and slopes.
    #[inline(always)]
    fn fall(&self, low: PolynomialPoint, high: PolynomialPoint) -> f64 {
        const MOST: u32 = 60;
        let (mut least, mut most) = (low.at, high.at);
        let length = high.at - low.at;
        let mut at = length.mul_add(guess(low, high), low.at);
        for _ in 0..MOST {
            let (place, bend) = self.bend(at);
            if place.value > 0.0 {
                least = at;
            } else {
                most = at;
            }
            // x = f / (f' - f'' f / (2 f')), without a second division.
            let PolynomialPoint { value, slope, .. } = place;
            let halley = at - value * slope / slope.mul_add(slope, -(bend * value));
            // The remaining error is of third order in this difference.
            if (halley - at).abs() <= LAST && slope < 0.0 {
                return halley.clamp(least, most);
            }
            at = if halley > least && halley < most { halley } else { 0.5 * (least + most) };
        }
        at
    }
}

/// Estimates where between two points, from 0 to 1, the value falls through zero.
#[inline(always)]
pub(super) fn guess(low: PolynomialPoint, high: PolynomialPoint) -> f64 {
    let length = high.at - low.at;
    let (fall, slopes) = (low.value - high.value, [length * low.slope, length * high.slope]);
    // The position as the inverse cubic of the value, from both ends.
    let part = low.value / fall;
    let left = 1.0 - part;
    let bent = part * left * (part / slopes[1] - left / slopes[0]) * fall;
    let at = (part * part).mul_add(2.0_f64.mul_add(left, 1.0), bent);
    if slopes[0] < 0.0 && slopes[1] < 0.0 && at > 0.0 && at < 1.0 {
        return at;
    }
    fall_of_cubic(low, high)
}

/// Estimates where between two points, from 0 to 1, their cubic falls through zero.
#[inline(always)]
fn fall_of_cubic(low: PolynomialPoint, high: PolynomialPoint) -> f64 {
    let length = high.at - low.at;
    let (a, b) = (low.value, length * low.slope);
    let rise = high.value - low.value;
    let last = b + length * high.slope - 2.0 * rise;
    let square = rise - b - last;
    // If it rises first, start from the other end.
    let mut at = if b > 0.0 { 1.0 } else { a / -rise };
    for _ in 0..3 {
        let value = last.mul_add(at, square).mul_add(at, b).mul_add(at, a);
        let slope = (3.0 * last).mul_add(at, 2.0 * square).mul_add(at, b);
        let newton = at - value / slope;
        // If it is NaN or outside, use the chord.
        if !(newton > 0.0 && newton < 1.0) {
            break;
        }
        at = newton;
    }
    at
}

enum PartVerdict {
    Holds,
    Falls,
    Open,
}

/// Returns the bounds for the part between two points; the condition holds at the first of them.
fn part(low: PolynomialPoint, high: PolynomialPoint, fourth_derivative: f64) -> PartVerdict {
    let length = high.at - low.at;
    let third = length / 3.0;
    let (left, right) = (low.value + third * low.slope, high.value - third * high.slope);
    let square = length * length;
    let doubt = fourth_derivative * (square * square) / 144.0;
    let second = 0.25 * (low.value + 3.0 * left);
    let middle = 0.5 * (left + right);
    let fourth = 0.25 * (3.0 * right + high.value);
    if second.min(middle - doubt).min(fourth).min(high.value) >= 0.0 {
        return PartVerdict::Holds;
    }
    if high.value >= 0.0 {
        return PartVerdict::Open;
    }
    // One change of sign for any value of the middle coefficient within its bounds.
    let falls = |middle: f64| {
        let signs = [second >= 0.0, middle >= 0.0, fourth >= 0.0];
        signs.windows(2).all(|pair| pair[0] || !pair[1])
    };
    if falls(middle - doubt) && falls(middle + doubt) {
        PartVerdict::Falls
    } else {
        PartVerdict::Open
    }
}

#[cfg(test)]
mod tests {
    use super::{ConditionFate, ORDER, Polynomial};

    /// The Taylor polynomial of a function with these derivatives at 0.
    fn polynomial(derivative: impl Fn(usize) -> f64) -> Polynomial {
        let mut factorial = 1.0;
        let coefficients = std::array::from_fn(|k| {
            factorial *= k.max(1) as f64;
            derivative(k) / factorial
        });
        Polynomial { coefficients, length: 1.0 }
    }

    fn first_fall(of: Polynomial) -> ConditionFate {
        of.first_fall(&of.outline())
    }

    fn at(course: ConditionFate) -> f64 {
        match course {
            ConditionFate::Fails(at) => at,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn falls_are_located() {
        let line = polynomial(|k| [0.3, -1.0].get(k).copied().unwrap_or(0.0));
        assert!((at(first_fall(line)) - 0.3).abs() < 1e-15);

        // sin(4 t) from just above zero: it rises, and falls at π/4.
        let sine = |k: usize| [0.0, 1.0, 0.0, -1.0][k % 4] * 4.0_f64.powi(k as i32);
        let hump = polynomial(|k| sine(k) + if k == 0 { 1e-12 } else { 0.0 });
        assert!((at(first_fall(hump)) - std::f64::consts::FRAC_PI_4).abs() < 1e-5);
        // The same sine from just below zero.
        let hump = polynomial(|k| sine(k) - if k == 0 { 1e-12 } else { 0.0 });
        assert!((at(first_fall(hump)) - std::f64::consts::FRAC_PI_4).abs() < 1e-5);

        // A dip between two points with positive values, and one that does not reach zero.
        let dip = |over: f64| {
            let dip = [0.16 + over, -0.8, 2.0];
            polynomial(move |k| dip.get(k).copied().unwrap_or(0.0))
        };
        assert!((at(first_fall(dip(-1e-4))) - 0.39).abs() < 1e-12);
        assert!((at(first_fall(dip(-1e-14))) - 0.4).abs() < 1e-6);
        assert_eq!(first_fall(dip(1e-14)), ConditionFate::Holds);

        // Three falls: the first counts. cos(6 t) - 0.2 falls at acos(0.2)/6, rises and falls again.
        let wave = |k: usize| [1.0, 0.0, -1.0, 0.0][k % 4] * 6.0_f64.powi(k as i32);
        let wave = polynomial(|k| wave(k) - if k == 0 { 0.2 } else { 0.0 });
        assert!((at(first_fall(wave)) - libm::acos(0.2) / 6.0).abs() < 1e-6);

        // Negative by rounding, with a fall at 0.06 and positive again from 0.4 on.
        let again = [-1e-15, 0.024, -0.46, 1.0];
        let again = polynomial(|k| again.get(k).map_or(0.0, |c| c * [1.0, 1.0, 2.0, 6.0][k]));
        assert!((at(first_fall(again)) - 0.06).abs() < 1e-9);

        // At rest in contact, from where it falls by its second and third derivatives: nearly a double root at 6.2e-5.
        let pressed = |k: usize| [5.9e-15, -1e-48, -3.1e-6, -6e-3].get(k).copied().unwrap_or(0.0);
        let pressed = polynomial(pressed);
        let found = pressed.refined(at(first_fall(pressed)));
        assert!(
            (found - 6.2e-5).abs() < 1e-5 && pressed.place(found).value.abs() < 1e-24,
            "{found:e}"
        );

        // Negative by rounding, and decreasing.
        let out = polynomial(|k| [-1e-15, -0.1].get(k).copied().unwrap_or(0.0));
        assert_eq!(first_fall(out), ConditionFate::FailsAtOnce);
    }

    /// For polynomials with random coefficients, the first fall agrees with a scan of very many
    /// points.
    #[test]
    fn first_falls_are_first() {
        let mut seed = 1_u64;
        let mut draw = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let mut falls = 0;
        for round in 0..2000 {
            let mut coefficients = [0.0; ORDER + 1];
            for (k, coefficient) in coefficients.iter_mut().enumerate() {
                *coefficient = draw() * 0.7_f64.powi(k as i32);
            }
            coefficients[0] = 0.2 * coefficients[0].abs() + 1e-12;
            // The same polynomial in units of time other than the step.
            let length = [1.0, 0.37][round % 2];
            let mut scaled = coefficients;
            for (k, coefficient) in scaled.iter_mut().enumerate() {
                *coefficient /= libm::pow(length, k as f64);
            }
            let polynomial = Polynomial { coefficients: scaled, length };
            let looked = (1..=4000).map(|k| f64::from(k) / 4000.0);
            let below = looked.into_iter().find(|t| polynomial.place(*t).value < 0.0);
            match (first_fall(polynomial), below) {
                (ConditionFate::Holds, None) => {}
                (ConditionFate::Fails(t), Some(below)) => {
                    falls += 1;
                    let found = polynomial.place(t);
                    assert!(t <= below && found.value.abs() < 1e-14, "{t} {below} {found:?}");
                    assert!(t > below - 1.0 / 3999.0 || polynomial.place(t + 1e-7).value < 0.0);
                }
                // A dip between two points of the scan.
                (ConditionFate::Fails(t), None) => {
                    assert!(polynomial.place(t + 1e-6).value < 0.0, "{t}");
                }
                other => panic!("{other:?} {coefficients:?}"),
            }
        }
        assert!(falls > 500, "{falls}");
    }
}
