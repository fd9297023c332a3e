//! The units of a system file in which the motion is computed: powers of two, so that conversion is exact.

use super::formula::{Dimension, WHOLE};

/// The exponents of two of the units of mass, length and time, in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Scales(pub [i32; 3]);

impl Scales {
    /// Returns the units nearest to these sizes in SI units.
    pub fn near(sizes: [f64; 3]) -> Scales {
        let exponent = |size: f64| match size.is_finite() && size > 0.0 {
            true => libm::round(libm::log2(size)).clamp(-200.0, 200.0) as i32,
            false => 0,
        };
        Scales(sizes.map(exponent))
    }

    /// Returns the unit of a dimension in SI units.
    pub fn unit(&self, dimension: Dimension) -> f64 {
        let exponents = self.0.iter().zip(dimension);
        let sum: i32 = exponents.map(|(unit, exponent)| unit * exponent).sum();
        match sum % WHOLE {
            0 => libm::ldexp(1.0, sum / WHOLE),
            _ => libm::exp2(f64::from(sum) / f64::from(WHOLE)),
        }
    }
}
