//! Positions of the balls that balance the imbalance: `m_I e + Σ m e^{iβ} = 0`, the table at rest.
//!
//! The imbalance and the balls' masses are then the sides of a closed polygon. One ball balances
//! only an imbalance equal to its own. Two balls form a triangle, which has a mirror image (two
//! identical balls: `cos β = -m_I e / (2 m L)`, thesis appendix D.3). Three or more balls have a
//! family of positions with as many dimensions as there are balls beyond two. Without an imbalance,
//! two equal balls balance wherever they are opposite each other, a family of one dimension. Balls with
//! contact balance only where they do not overlap; of three or more, such a position is sought.

use nalgebra::Complex;

use super::identical_balls::sorted_where_identical;
use super::rest_form::{RestForm, direction};
use super::set_samples::sample;
use crate::model::wrap_to_two_pi;

/// Where the balls balance the imbalance.
#[derive(Clone, Debug, PartialEq)]
pub enum Balance {
    /// Nowhere: one of the masses exceeds the sum of all others.
    Nowhere,
    /// At these angles, one per ball in [0, 2π), ascending among identical balls, and at the mirror
    /// image `2π - β`.
    Position(Vec<f64>),
    /// In a family of positions that contains these angles.
    Family {
        /// One position, one angle per ball in [0, 2π).
        example: Vec<f64>,
        /// Number of dimensions of the family.
        dimension: usize,
    },
}

impl Balance {
    /// Returns where the balls of a machine balance its imbalance.
    pub fn of(form: &RestForm) -> Self {
        let count = form.mass.len();
        let found = balanced(form).filter(|beta| form.is_possible(beta)).or_else(|| apart(form));
        let found = found.map(|beta| sorted_where_identical(&beta, &form.balls));
        match (found, count) {
            (None, _) => Balance::Nowhere,
            (Some(example), 2) if form.imbalance.norm() == 0.0 => {
                Balance::Family { example, dimension: 1 }
            }
            (Some(position), 1 | 2) => Balance::Position(position),
            (Some(example), _) => Balance::Family { example, dimension: count - 2 },
        }
    }

    /// Returns one balanced position, or `None` if there is none.
    pub fn position(&self) -> Option<&[f64]> {
        match self {
            Balance::Nowhere => None,
            Balance::Position(beta) | Balance::Family { example: beta, .. } => Some(beta),
        }
    }

    /// Returns the identifier that the tables use.
    pub fn name(&self) -> &'static str {
        match self {
            Balance::Nowhere => "nowhere",
            Balance::Position(_) => "position",
            Balance::Family { .. } => "family",
        }
    }
}

/// Relative tolerance below which two sums of masses count as equal.
const EQUAL_MASSES: f64 = 1e-14;

/// Relative size below which the sum of all imbalances counts as zero.
const ZERO_IMBALANCE: f64 = 1e-12;

/// Returns whether the balls at these angles balance the imbalance.
pub(super) fn balances(form: &RestForm, beta: &[f64]) -> bool {
    let scale = form.imbalance.norm() + form.mass.iter().sum::<f64>();
    form.imbalance_at(beta).norm() <= ZERO_IMBALANCE * scale
}

/// Returns one balanced position.
///
/// All balls except the two heaviest lie side by side or opposite each other, along a direction in
/// which the two heaviest can close the polygon. If any position balances, some choice of signs
/// allows this: flipping one ball changes the sum of the others by no more than the two heaviest
/// can compensate.
fn balanced(form: &RestForm) -> Option<Vec<f64>> {
    let mut heaviest: Vec<usize> = (0..form.mass.len()).collect();
    heaviest.sort_by(|&i, &j| form.mass[j].total_cmp(&form.mass[i]));
    let (pair, rest) = heaviest.split_at(heaviest.len().min(2));
    let [mass_1, mass_2] = [0, 1].map(|place| pair.get(place).map_or(0.0, |&ball| form.mass[ball]));
    let (imbalance, towards) = (form.imbalance.norm(), form.imbalance.arg());
    (0..1_u32 << rest.len()).find_map(|signs| {
        let sign = |place: usize| if signs >> place & 1 == 0 { 1.0 } else { -1.0 };
        let along: f64 =
            rest.iter().enumerate().map(|(place, &ball)| sign(place) * form.mass[ball]).sum();
        // The two heaviest balls can produce any force from their difference to their sum.
        let low = (imbalance - along.abs()).abs().max(mass_1 - mass_2);
        let high = (imbalance + along.abs()).min(mass_1 + mass_2);
        if low > high * (1.0 + EQUAL_MASSES) {
            return None;
        }
        let force = low.midpoint(high);
        let turn = angle_between(imbalance, along, force);
        let sum = Complex::from(imbalance) + direction(turn) * along;
        let mut beta = vec![0.0; form.mass.len()];
        for (place, &ball) in rest.iter().enumerate() {
            beta[ball] = turn + if sign(place) < 0.0 { std::f64::consts::PI } else { 0.0 };
        }
        let opposite = sum.arg() + std::f64::consts::PI;
        let force = sum.norm();
        if let Some(&ball) = pair.first() {
            beta[ball] = opposite + side_angle(mass_1, mass_2, force);
        }
        if let Some(&ball) = pair.get(1) {
            beta[ball] = opposite - side_angle(mass_2, mass_1, force);
        }
        Some(beta.into_iter().map(|beta| wrap_to_two_pi(beta + towards)).collect())
    })
}

/// Number of positions from which balanced positions without overlap are sought.
const STARTS: u32 = 1024;
/// Number of corrections of each.
const CORRECTIONS: usize = 20;

/// Returns a balanced position of three or more balls with contact: the first one found from quasi-random positions by
/// Newton's method with the smallest corrections.
fn apart(form: &RestForm) -> Option<Vec<f64>> {
    let balls = form.mass.len();
    if form.touching.is_none() || balls < 3 {
        return None;
    }
    (0..STARTS).find_map(|start| {
        let mut beta = sample(balls, 0, start);
        for _ in 0..CORRECTIONS {
            // The rate of change of the sum with each angle.
            let slopes: Vec<Complex<f64>> = beta
                .iter()
                .zip(&form.mass)
                .map(|(beta, mass)| direction(*beta) * Complex::new(0.0, *mass))
                .collect();
            let sum = form.imbalance_at(&beta);
            let [mut xx, mut xy, mut yy] = [0.0; 3];
            for slope in &slopes {
                xx += slope.re * slope.re;
                xy += slope.re * slope.im;
                yy += slope.im * slope.im;
            }
            let determinant = xx * yy - xy * xy;
            let along = (yy * sum.re - xy * sum.im) / determinant;
            let across = (xx * sum.im - xy * sum.re) / determinant;
            for (beta, slope) in beta.iter_mut().zip(&slopes) {
                *beta -= slope.re * along + slope.im * across;
            }
        }
        let found: Vec<f64> = beta.into_iter().map(wrap_to_two_pi).collect();
        (found.iter().all(|beta| beta.is_finite())
            && balances(form, &found)
            && form.is_possible(&found))
        .then_some(found)
    })
}

/// Returns the angle from a first vector to a second one of given lengths whose sum has a given
/// length.
fn angle_between(first: f64, second: f64, sum: f64) -> f64 {
    if first == 0.0 || second == 0.0 {
        return 0.0;
    }
    let cosine = (sum * sum - first * first - second * second) / (2.0 * first * second);
    cosine.clamp(-1.0, 1.0).acos()
}

/// Returns the angle between one side of a triangle and the side `base`; `other` is the third side.
/// With a base of length 0, both sides are perpendicular to it, and so opposite each other.
fn side_angle(side: f64, other: f64, base: f64) -> f64 {
    if other == 0.0 {
        return 0.0;
    }
    if base == 0.0 {
        return std::f64::consts::FRAC_PI_2;
    }
    let cosine = (base * base + side * side - other * other) / (2.0 * base * side);
    cosine.clamp(-1.0, 1.0).acos()
}
