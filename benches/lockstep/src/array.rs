//! Eight lanes as a plain array, left to the compiler to vectorise (for comparison).
use std::ops::{Add, Mul, Neg, Sub};
use stickslip::model::Number;

#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Array(pub [f64; 8]);

macro_rules! each {
    ($i:ident => $value:expr) => {{
        let mut out = [0.0; 8];
        let mut $i = 0;
        while $i < 8 {
            out[$i] = $value;
            $i += 1;
        }
        Array(out)
    }};
}
impl Add for Array {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        each!(i => self.0[i] + o.0[i])
    }
}
impl Sub for Array {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        each!(i => self.0[i] - o.0[i])
    }
}
impl Mul for Array {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        each!(i => self.0[i] * o.0[i])
    }
}
impl Neg for Array {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        each!(i => -self.0[i])
    }
}
impl Number for Array {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Array([value; 8])
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        each!(i => 1.0 / self.0[i])
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (mut s, mut c) = ([0.0; 8], [0.0; 8]);
        for i in 0..8 {
            (s[i], c[i]) = one(self.0[i]);
        }
        (Array(s), Array(c))
    }
}
#[inline(always)]
fn one(x: f64) -> (f64, f64) {
    const R: f64 = 6_755_399_441_055_744.0;
    let shifted = x.mul_add(std::f64::consts::FRAC_2_PI, R);
    let q = shifted - R;
    let r = q.mul_add(-std::f64::consts::FRAC_PI_2, x);
    let r = q.mul_add(-6.123_233_995_736_766e-17, r);
    let z = r * r;
    let s = z.mul_add(
        z.mul_add(
            z.mul_add(
                z.mul_add(
                    z.mul_add(1.589_690_995_211_55e-10, -2.505_076_025_340_686_3e-8),
                    2.755_731_370_707_006_8e-6,
                ),
                -1.984_126_982_985_795e-4,
            ),
            8.333_333_333_322_49e-3,
        ),
        -1.666_666_666_666_663_2e-1,
    );
    let s = (r * z).mul_add(s, r);
    let c = z.mul_add(
        z.mul_add(
            z.mul_add(
                z.mul_add(
                    z.mul_add(-1.135_964_755_778_819_5e-11, 2.087_572_321_298_175e-9),
                    -2.755_731_435_139_066_3e-7,
                ),
                2.480_158_728_947_673e-5,
            ),
            -1.388_888_888_887_411e-3,
        ),
        4.166_666_666_666_66e-2,
    );
    let c = (z * z).mul_add(c, z.mul_add(-0.5, 1.0));
    let bits = shifted.to_bits();
    let (a, b) = if bits & 1 == 1 { (c, s) } else { (s, c) };
    (
        f64::from_bits(a.to_bits() ^ ((bits >> 1) << 63)),
        f64::from_bits(b.to_bits() ^ (((bits + 1) >> 1) << 63)),
    )
}
