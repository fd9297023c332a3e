//! The smallest and the largest amplitude in the equilibrium set of several balls.
//!
//! With the table displaced by `z = r e^{iθ}`, whether a ball is held depends only on `r` and on
//! the ball's angle `φ` from the displacement: `r |sin φ| ≤ μ (1 + r cos φ)`. The ball is therefore
//! held in an arc about the displacement, in an arc opposite to it, or, for small `r`, anywhere.
//! Balls held in such arcs are consistent with a displacement of this size if they and the
//! imbalance cause it: `r / g = m_I e e^{-iθ} + Σ m e^{iφ}` for some `θ`, which is equivalent to
//! `|r / g - Σ m e^{iφ}| = m_I e`. For one choice of arcs the left side takes all values between
//! its minimum and its maximum. The extremes of the amplitude are the smallest and the largest `r`
//! for which `m_I e` lies in this range, over all choices of arcs: a search in one unknown, for any
//! number of balls.

use std::f64::consts::PI;

use nalgebra::Complex;

use super::identical_balls::groups_of_identical;
use super::rest_form::{RestForm, direction};
use crate::model::wrap_to_two_pi;

/// Number of steps of the search for a displacement, before bisection.
const STEPS: usize = 128;
/// The amplitude below which the disc stands still.
const STANDSTILL: f64 = 1e-100;
/// Largest number of rounds in which the balls are moved one at a time.
const ROUNDS: usize = 200;

/// Returns the smallest and the largest non-dimensional amplitude that the search finds in the set,
/// each with the angles of the balls.
///
/// `None` for an empty set, for balls that can balance (whose smallest amplitude is 0), without
/// imbalance, where all directions are equivalent, and for a ring with runout, with which the balls feel another amplitude
/// than the table's.
pub fn amplitude_extremes(form: &RestForm) -> [Option<(f64, Vec<f64>)>; 2] {
    let Some(above) = above_all(form) else { return [None, None] };
    [found(form, 0.0, above), found(form, above, 0.0)]
}

/// Returns an amplitude above all others, or `None` at standstill, without imbalance, without a finite response and with a
/// runout, with which the amplitude of the table is not that of the ring.
fn above_all(form: &RestForm) -> Option<f64> {
    let imbalance = form.imbalance.norm();
    let most: f64 = form.transfer.norm() * (imbalance + form.mass.iter().sum::<f64>());
    let table_is_ring = form.runout.norm() == 0.0;
    (most > STANDSTILL && most.is_finite() && imbalance > 0.0 && table_is_ring)
        .then_some(most * (1.0 + 1e-9))
}

/// Returns the first amplitude in the set on the way from one to another, with the angles of the balls.
fn found(form: &RestForm, from: f64, to: f64) -> Option<(f64, Vec<f64>)> {
    arc_choices(form).into_iter().fold(None, |best: Option<(f64, Vec<f64>)>, far| {
        // Only displacements better than the best one so far matter.
        let to = best.as_ref().map_or(to, |(size, _)| *size);
        ArcChoice { form, far }.first_displacement(from, to).or(best)
    })
}

/// Returns all choices of the balls opposite to the displacement that differ; among identical
/// balls, the first ones are opposite.
fn arc_choices(form: &RestForm) -> Vec<Vec<bool>> {
    let mut all = vec![vec![false; form.mass.len()]];
    for group in groups_of_identical(&form.balls) {
        let with = |choice: &Vec<bool>, far: usize| {
            let mut choice = choice.clone();
            group.iter().take(far).for_each(|&ball| choice[ball] = true);
            choice
        };
        all = (0..=group.len())
            .flat_map(|far| all.iter().map(move |choice| with(choice, far)))
            .collect();
    }
    all
}

/// A choice of arcs: which balls are held opposite to the displacement.
struct ArcChoice<'a> {
    form: &'a RestForm,
    far: Vec<bool>,
}

/// Comparison of `|r / g - Σ m e^{iφ}|` with the imbalance, over all positions of the balls in
/// their arcs.
#[derive(Clone, Copy, PartialEq)]
enum ImbalanceComparison {
    /// Always greater.
    Greater,
    /// Always less.
    Smaller,
    /// Equality is possible.
    Attainable,
}

impl ArcChoice<'_> {
    /// Returns the first displacement between `from` and `to` at which balls are held in these
    /// arcs, with their angles.
    fn first_displacement(&self, from: f64, to: f64) -> Option<(f64, Vec<f64>)> {
        let at = |step: usize| from + (to - from) * (step as f64 / STEPS as f64);
        let (mut before, mut comparison) = (from, self.compare_with_imbalance(from)?);
        if comparison == ImbalanceComparison::Attainable {
            return Some((from, self.position(from)?));
        }
        for step in 1..=STEPS {
            let mut after = at(step);
            let Some(now) = self.compare_with_imbalance(after) else { continue };
            if now == comparison {
                before = after;
                continue;
            }
            // Between `Greater` and `Smaller` there is a displacement with equality.
            while (after - before).abs() > 1e-14 * from.max(to) {
                let middle = before.midpoint(after);
                if self.compare_with_imbalance(middle) == Some(comparison) {
                    before = middle
                } else {
                    after = middle
                }
            }
            for size in [after, before] {
                if let Some(beta) = self.position(size) {
                    return Some((size, beta));
                }
            }
            (before, comparison) = (at(step), now);
        }
        None
    }

    /// Returns the middle of a ball's arc and half of its width, or `None` if there is no such arc.
    fn arc(&self, ball: usize, size: f64) -> Option<[f64; 2]> {
        let slope = libm::atan(self.form.friction_coefficient[ball]);
        let middle = if self.far[ball] { PI } else { 0.0 };
        if size <= libm::sin(slope) {
            return Some([middle, PI]);
        }
        let half = libm::asin(libm::sin(slope) / size);
        let half = if self.far[ball] { half - slope } else { half + slope };
        (half >= 0.0).then_some([middle, half])
    }

    fn arcs(&self, size: f64) -> Option<Vec<[f64; 2]>> {
        (0..self.far.len()).map(|ball| self.arc(ball, size)).collect()
    }

    /// Compares the modulus of the remainder with the imbalance over all positions in the arcs;
    /// `None` if a ball has no arc.
    fn compare_with_imbalance(&self, size: f64) -> Option<ImbalanceComparison> {
        let (imbalance, arcs) = (self.form.imbalance.norm(), self.arcs(size)?);
        // The middles of the arcs usually decide: no ball is farther from there than the chord to
        // the end of its arc.
        let middles: Vec<f64> = arcs.iter().map(|[middle, _]| *middle).collect();
        let chords =
            self.form.mass.iter().zip(&arcs).map(|(m, [_, half])| 2.0 * m * libm::sin(0.5 * half));
        let (middle, reach) = (self.remainder(size, &middles).norm(), chords.sum::<f64>());
        if middle - reach > imbalance {
            return Some(ImbalanceComparison::Greater);
        }
        if middle + reach < imbalance {
            return Some(ImbalanceComparison::Smaller);
        }
        if self.extreme(size, &arcs, -1.0).0 > imbalance {
            Some(ImbalanceComparison::Greater)
        } else if self.extreme(size, &arcs, 1.0).0 < imbalance {
            Some(ImbalanceComparison::Smaller)
        } else {
            Some(ImbalanceComparison::Attainable)
        }
    }

    /// Returns `r / g - Σ m e^{iφ}` for a displacement `r`.
    fn remainder(&self, size: f64, phi: &[f64]) -> Complex<f64> {
        let balls = self.form.mass.iter().zip(phi).map(|(mass, phi)| direction(*phi) * *mass);
        Complex::from(size) / self.form.transfer - balls.sum::<Complex<f64>>()
    }

    /// Returns the minimum (`sign` -1) or the maximum (1) of the remainder's modulus, and the
    /// angles of the balls there. Each ball is moved to its best angle in turn, from several
    /// starts, until the comparison with the imbalance is decided.
    fn extreme(&self, size: f64, arcs: &[[f64; 2]], sign: f64) -> (f64, Vec<f64>) {
        let imbalance = self.form.imbalance.norm();
        let decided = |modulus: f64| sign * (modulus - imbalance) >= 0.0;
        let mut best: Option<(f64, Vec<f64>)> = None;
        for start in 0..=arcs.len() + 1 {
            let place = |(ball, [middle, half]): (usize, &[f64; 2])| match start {
                0 => *middle,
                _ if ball + 1 < start => middle - half,
                _ => middle + half,
            };
            let mut phi: Vec<f64> = arcs.iter().enumerate().map(place).collect();
            let mut remainder = self.remainder(size, &phi);
            for _ in 0..ROUNDS {
                let before = remainder.norm();
                for (ball, [middle, half]) in arcs.iter().enumerate() {
                    let mass = self.form.mass[ball];
                    let without = remainder + direction(phi[ball]) * mass;
                    let aim = (without * -sign).arg() - middle;
                    phi[ball] =
                        middle + (aim - (aim / (2.0 * PI)).round() * 2.0 * PI).clamp(-half, *half);
                    remainder = without - direction(phi[ball]) * mass;
                }
                if decided(remainder.norm())
                    || (remainder.norm() - before).abs() <= 1e-15 * imbalance
                {
                    break;
                }
            }
            let better = |best: &(f64, Vec<f64>)| sign * (remainder.norm() - best.0) > 0.0;
            if best.as_ref().is_none_or(better) {
                best = Some((remainder.norm(), phi));
            }
            if decided(remainder.norm()) {
                break;
            }
        }
        // There is at least one start.
        best.unwrap_or_default()
    }

    /// Returns the balls' angles from the imbalance in a displacement of this size, on the path
    /// from the minimum to the maximum of the remainder.
    fn position(&self, size: f64) -> Option<Vec<f64>> {
        let arcs = self.arcs(size)?;
        let [(least, low), (most, high)] = [-1.0, 1.0].map(|sign| self.extreme(size, &arcs, sign));
        let imbalance = self.form.imbalance.norm();
        let tiny = 1e-9 * imbalance;
        if least > imbalance + tiny || most < imbalance - tiny {
            return None;
        }
        let between = |part: f64| -> Vec<f64> {
            low.iter().zip(&high).map(|(low, high)| low + part * (high - low)).collect()
        };
        let (mut less, mut more) = (0.0_f64, 1.0_f64);
        for _ in 0..60 {
            let middle = less.midpoint(more);
            let modulus = self.remainder(size, &between(middle)).norm();
            if modulus <= imbalance { less = middle } else { more = middle }
        }
        let phi = between(less);
        let turned = self.remainder(size, &phi).arg();
        Some(phi.into_iter().map(|phi| wrap_to_two_pi(phi - turned)).collect())
    }
}
