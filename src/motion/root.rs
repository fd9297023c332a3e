//! Bracketing root finders for a function of the time in a step that changes from positive to
//! negative.

/// Narrows the bracket `(low, high)` with `f(low) > 0 > f(high)` until it is no wider than `width`
/// and returns its upper end, at which the function is negative.
///
/// Method ITP: I. F. D. Oliveira, R. H. C. Takahashi, ACM Trans. Math. Softw. 47 (2021) 5,
/// doi:10.1145/3423597 (never slower than bisection by more than one step, as fast as the secant
/// method on smooth functions).
pub fn fall_through_zero(
    mut f: impl FnMut(f64) -> f64,
    (mut low, mut f_low): (f64, f64),
    (mut high, mut f_high): (f64, f64),
    width: f64,
) -> f64 {
    let half_steps = ((high - low) / width).log2().ceil().max(0.0) as i32;
    let most = half_steps + 1;
    let truncation = 0.2 / (high - low);
    let mut step = 0;
    while high - low > width && step <= most + 2 {
        let middle = 0.5 * (low + high);
        let radius = 0.5 * width * f64::powi(2.0, most - step) - 0.5 * (high - low);
        let secant = (high * f_low - low * f_high) / (f_low - f_high);
        let towards = (middle - secant).signum();
        let truncated = truncation * (high - low) * (high - low);
        let nudged = if truncated <= (middle - secant).abs() {
            secant + towards * truncated
        } else {
            middle
        };
        let point = if (nudged - middle).abs() <= radius.max(0.0) {
            nudged
        } else {
            middle - towards * radius.max(0.0)
        };
        let value = f(point);
        if value > 0.0 {
            (low, f_low) = (point, value);
        } else {
            (high, f_high) = (point, value);
        }
        step += 1;
    }
    high
}

/// Finds a root like [`fall_through_zero`] for a smooth function with its slope, by Newton's method
/// from a guess, safeguarded by the bracket, with far fewer evaluations. The root is accurate to
/// `width`, on either side of zero.
#[inline(always)]
pub(super) fn fall_of_smooth(
    f: impl Fn(f64) -> (f64, f64),
    (mut low, mut high): (f64, f64),
    guess: f64,
    width: f64,
) -> f64 {
    const MOST: u32 = 100;
    let mut at = guess;
    for _ in 0..MOST {
        let (value, slope) = f(at);
        if value > 0.0 {
            low = at;
        } else {
            high = at;
        }
        let newton = at - value / slope;
        let inside = newton > low && newton < high;
        if (newton - at).abs() <= width || high - low <= width {
            return if inside { newton } else { at };
        }
        at = if inside { newton } else { 0.5 * (low + high) };
    }
    at
}

#[cfg(test)]
mod tests {
    use super::{fall_of_smooth, fall_through_zero};

    type Function = fn(f64) -> f64;

    #[test]
    fn roots_to_the_width_asked_for() {
        let functions: [(Function, f64); 4] = [
            (|t| 0.3 - t, 0.3),
            (|t| (0.7 - t).powi(3), 0.7),
            (|t| (1.0 - t * t).sqrt() - t, std::f64::consts::FRAC_1_SQRT_2),
            (|t| if t < 0.123 { 1.0 } else { -1e-9 }, 0.123),
        ];
        for (f, root) in functions {
            let mut calls = 0;
            let count = |t| {
                calls += 1;
                f(t)
            };
            let found = fall_through_zero(count, (0.0, f(0.0)), (1.0, f(1.0)), 1e-12);
            assert!(f(found) <= 0.0 && (found - root).abs() <= 1e-12, "{found} for {root}");
            assert!(calls <= 44, "{calls} calls for {root}");
        }
    }
    #[test]
    fn roots_of_smooth_functions() {
        type WithSlope = fn(f64) -> (f64, f64);
        let functions: [WithSlope; 4] = [
            |t| (0.3 - t, -1.0),
            |t| ((0.7 - t).powi(3), -3.0 * (0.7 - t).powi(2)),
            |t| (t.cos() - t, -t.sin() - 1.0),
            // It rises and falls three times.
            |t| (0.5 - t + 0.2 * (9.0 * t).sin(), -1.0 + 1.8 * (9.0 * t).cos()),
        ];
        for f in functions {
            let calls = std::cell::Cell::new(0);
            let count = |t| {
                calls.set(calls.get() + 1);
                f(t)
            };
            let chord = f(0.0).0 / (f(0.0).0 - f(1.0).0);
            let found = fall_of_smooth(count, (0.0, 1.0), chord, 1e-13);
            assert!((0.0..=1.0).contains(&found) && f(found).0.abs() < 1e-12, "{found}");
            assert!(calls.get() <= 80, "{} calls to {found}", calls.get());
        }
    }
}
