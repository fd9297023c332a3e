//! The two-sided 95 % point of Student's distribution.

use std::f64::consts::PI;

use crate::analysis::Z_95;

/// The number `t` that a Student variable with so many degrees of freedom exceeds in size with a
/// probability of 0.05. Degrees of freedom that are no whole number are rounded down, which is on
/// the safe side; there is one at least.
///
/// Source: G. W. Hill, Algorithm 396, Commun. ACM 13 (1970) 619, doi:10.1145/355598.355600.
pub(super) fn student_95(degrees: f64) -> f64 {
    let p = 0.05;
    let n = degrees.floor().max(1.0);
    if n < 1.5 {
        return 1.0 / libm::tan(0.5 * p * PI);
    }
    if n < 2.5 {
        return (2.0 / (p * (2.0 - p)) - 2.0).sqrt();
    }
    let a = 1.0 / (n - 0.5);
    let b = 48.0 / (a * a);
    let mut c = ((20_700.0 * a / b - 98.0) * a - 16.0) * a + 96.36;
    let d = ((94.5 / (b + c) - 3.0) / b + 1.0) * (0.5 * a * PI).sqrt() * n;
    let mut y = libm::pow(d * p, 2.0 / n);
    if y > 0.05 + a {
        let x = -Z_95;
        y = x * x;
        if n < 5.0 {
            c += 0.3 * (n - 4.5) * (x + 0.6);
        }
        c += (((0.05 * d * x - 5.0) * x - 7.0) * x - 2.0) * x + b;
        y = (((((0.4 * y + 6.3) * y + 36.0) * y + 94.5) / c - y - 3.0) / b + 1.0) * x;
        y = libm::expm1(a * y * y);
    } else {
        let inner = (n + 6.0) / (n * y) - 0.089 * d - 0.822;
        y = ((1.0 / (inner * (n + 2.0) * 3.0) + 0.5 / (n + 4.0)) * y - 1.0) * (n + 1.0) / (n + 2.0)
            + 1.0 / y;
    }
    (n * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::student_95;

    /// The values that every table prints.
    #[test]
    fn the_table() {
        for (degrees, printed) in [
            (1.0, 12.706),
            (2.0, 4.303),
            (2.9, 4.303),
            (3.0, 3.182),
            (4.0, 2.776),
            (5.0, 2.571),
            (10.0, 2.228),
            (30.0, 2.042),
            (120.0, 1.980),
            (1.0e6, 1.960),
        ] {
            let found = student_95(degrees);
            assert!((found - printed).abs() < 6e-4, "{degrees}: {found} {printed}");
        }
    }
}
