//! How far three balls are from balancing the imbalance, which they can in a family of positions.
//!
//! In that family, `m_I e + Σ m e^{iβ} = 0`, the angle of one ball decides those of the two others
//! but for a mirror image: they close the polygon as two sides of a triangle. The least distance
//! is looked for along the angle of one ball. Where that ball is nearly as heavy as the imbalance, and the
//! others as each other, it can hold the imbalance alone while the others turn opposite each other;
//! then each ball takes its turn. More balls have families of two and more dimensions, which are not
//! searched.

use std::f64::consts::PI;

use nalgebra::Complex;

use super::rest_form::{RestForm, direction};
use super::torus_distance::turn;

/// Positions at which the distance along one branch is looked at.
const SCAN: usize = 48;
/// Steps of the golden section; each shortens the bracket to 0.618.
const REFINEMENTS: usize = 32;
/// Farther than this part of the imbalance from holding it alone, a ball's angle shows all positions.
const ENOUGH: f64 = 0.1;
/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The root mean square over the balls of the angles to the nearest position that balances, rad.
/// None where none does, and for any other number of balls than three.
pub(super) fn distance_to_balance(form: &RestForm, beta: &[f64]) -> Option<f64> {
    let beta: &[f64; 3] = beta.try_into().ok()?;
    let mut least = f64::INFINITY;
    let away = |&first: &usize| away_from_alone(form, first);
    let one = (0..3).max_by(|a, b| away(a).total_cmp(&away(b)));
    let firsts = match one.filter(|first| away(first) > ENOUGH * form.imbalance) {
        Some(first) => first..first + 1,
        None => 0..3,
    };
    for first in firsts {
        for [side, mirror] in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
            if let Some(branch) = Branch::new(form, first, side, mirror) {
                least = branch.least_squares(beta).min(least);
            }
        }
    }
    least.is_finite().then(|| (least / 3.0).sqrt())
}

/// How far a ball is from holding the imbalance alone with the others opposite each other.
fn away_from_alone(form: &RestForm, first: usize) -> f64 {
    let [own, one, other] = [0, 1, 2].map(|place| form.mass[(first + place) % 3]);
    (form.imbalance - own).abs() + (one - other).abs()
}

/// Balanced positions along the angle of one ball, on one side of the imbalance, with the two
/// others in one of two mirror images.
struct Branch<'a> {
    form: &'a RestForm,
    order: [usize; 3],
    side: f64,
    mirror: f64,
    /// The cosines of the first ball's angle at the ends.
    cosines: [f64; 2],
}

impl<'a> Branch<'a> {
    /// None where the two other balls cannot close the polygon.
    fn new(form: &'a RestForm, first: usize, side: f64, mirror: f64) -> Option<Self> {
        let order = [first, (first + 1) % 3, (first + 2) % 3];
        let [own, one, other] = order.map(|ball| form.mass[ball]);
        // The square of what is to be held, m_I² + m² + 2 m_I m cos β, lies between these.
        let cosine = |held: f64| {
            let imbalance = form.imbalance;
            (held * held - imbalance * imbalance - own * own) / (2.0 * imbalance * own)
        };
        let cosines = [cosine(one + other).min(1.0), cosine(one - other).max(-1.0)];
        // Not where one of them is not a number.
        (cosines[0] >= cosines[1]).then_some(Branch { form, order, side, mirror, cosines })
    }

    /// The sum of the squares of the angles from `beta` to the position at `place` in [0, 1].
    fn squares(&self, place: f64, beta: &[f64; 3]) -> f64 {
        let [start, end] = self.cosines.map(libm::acos);
        // Steps shrink towards the ends, where the others' angles change with the root of the way.
        let share = 0.5 * (1.0 - libm::cos(PI * place));
        let angle = self.side * (start + share * (end - start));
        let [own, one, other] = self.order.map(|ball| self.form.mass[ball]);
        let held = -(Complex::from(self.form.imbalance) + direction(angle) * own);
        let (force, along) = (held.re.hypot(held.im), libm::atan2(held.im, held.re));
        let side_angle = |side: f64, third: f64| {
            let cosine = (force * force + side * side - third * third) / (2.0 * force * side);
            if cosine.is_nan() { 0.5 * PI } else { libm::acos(cosine.clamp(-1.0, 1.0)) }
        };
        let angles = [
            angle,
            along + self.mirror * side_angle(one, other),
            along - self.mirror * side_angle(other, one),
        ];
        let pairs = self.order.into_iter().zip(angles);
        pairs.map(|(ball, angle)| turn(beta[ball], angle).powi(2)).sum()
    }

    /// The least of them: every lowest position of a scan, refined by the golden section.
    fn least_squares(&self, beta: &[f64; 3]) -> f64 {
        let place = |index: usize| index as f64 / SCAN as f64;
        let scan: Vec<f64> = (0..=SCAN).map(|index| self.squares(place(index), beta)).collect();
        let lowest = (0..=SCAN).filter(|&index| {
            let before = index.checked_sub(1).map_or(f64::INFINITY, |before| scan[before]);
            let after = scan.get(index + 1).copied().unwrap_or(f64::INFINITY);
            scan[index] <= before && scan[index] <= after
        });
        let refined = lowest.map(|index| {
            let [mut low, mut high] = [index.saturating_sub(1), (index + 1).min(SCAN)].map(place);
            let mut least = scan[index];
            let inner =
                |low: f64, high: f64| [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
            let [mut left, mut right] = inner(low, high).map(|at| self.squares(at, beta));
            for _ in 0..REFINEMENTS {
                least = least.min(left).min(right);
                if left < right {
                    high = inner(low, high)[1];
                    right = left;
                    left = self.squares(inner(low, high)[0], beta);
                } else {
                    low = inner(low, high)[0];
                    left = right;
                    right = self.squares(inner(low, high)[1], beta);
                }
            }
            least
        });
        refined.fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::distance_to_balance;
    use crate::analysis::RestForm;
    use crate::analysis::draws::Draws;
    use crate::analysis::rest_form::direction;
    use crate::model::{Ball, Machine};

    fn forms() -> Vec<RestForm> {
        let ball = Ball::default();
        let of = |masses: [f64; 3]| {
            let balls = masses.map(|mass_kg| Ball { mass_kg, ..ball }).to_vec();
            RestForm::new(&Machine { balls, ..Machine::default() }).unwrap()
        };
        let mut forms =
            vec![of([1.4e-4; 3]), of([1.4e-4, 1.0e-4, 0.5e-4]), of([2e-4, 1e-4, 0.9e-4])];
        // An imbalance just like a ball: the other two may stand anywhere opposite each other.
        let mut like_a_ball = of([1.4e-4; 3]);
        like_a_ball.imbalance = like_a_ball.mass[0];
        let mut nearly = like_a_ball.clone();
        nearly.imbalance *= 1.01;
        let mut more = like_a_ball.clone();
        more.imbalance *= 1.12;
        forms.extend([like_a_ball, nearly, more]);
        forms
    }

    /// A cloud of positions of the family: for any two balls, one angle on a fine grid, the other by
    /// sign changes and bisection where what is left to hold is just as long as the third ball's mass.
    fn cloud(form: &RestForm) -> Vec<[f64; 3]> {
        let mut cloud = Vec::new();
        for first in 0..3 {
            let [first, second, third] = [first, (first + 1) % 3, (first + 2) % 3];
            let left = |a: f64, b: f64| {
                let others = direction(a) * form.mass[first] + direction(b) * form.mass[second];
                -(nalgebra::Complex::from(form.imbalance) + others)
            };
            let excess = |a: f64, b: f64| left(a, b).norm() - form.mass[third];
            for i in 0..1500 {
                let a = TAU * (f64::from(i) + 0.37) / 1500.0;
                for j in 0..360 {
                    let [mut low, mut high] = [j, j + 1].map(|j| TAU * f64::from(j) / 360.0);
                    if (excess(a, low) > 0.0) == (excess(a, high) > 0.0) {
                        continue;
                    }
                    for _ in 0..40 {
                        let middle = 0.5 * (low + high);
                        if (excess(a, middle) > 0.0) == (excess(a, low) > 0.0) {
                            low = middle;
                        } else {
                            high = middle;
                        }
                    }
                    let mut beta = [0.0; 3];
                    [beta[first], beta[second], beta[third]] = [a, low, left(a, low).arg()];
                    cloud.push(beta);
                }
            }
        }
        cloud
    }

    /// Of random positions: no position of a cloud of the family is nearer than the distance found, and
    /// one is as near but for the cloud's spacing.
    #[test]
    fn no_balanced_position_is_nearer() {
        let mut draws = Draws::new(3);
        for form in forms() {
            let cloud = cloud(&form);
            assert!(cloud.len() > 1000, "{}", cloud.len());
            for member in &cloud {
                assert!(form.imbalance_at(member).norm() < 1e-8 * form.imbalance);
            }
            for _ in 0..100 {
                let beta = [0; 3].map(|_| TAU * draws.uniform());
                let found = distance_to_balance(&form, &beta).unwrap();
                let square = |member: &[f64; 3]| -> f64 {
                    let ways = member.iter().zip(beta).map(|(a, b)| {
                        let way = (a - b).rem_euclid(TAU);
                        way.min(TAU - way).powi(2)
                    });
                    ways.sum()
                };
                let nearest = cloud.iter().map(square).fold(f64::INFINITY, f64::min);
                let nearest = (nearest / 3.0).sqrt();
                // The cloud's points are 0.0042 rad of a ball apart.
                assert!(found <= nearest + 1e-9 && found >= nearest - 0.005, "{found} {nearest}");
            }
        }
    }

    /// A small way straight off a smooth family is the distance to it.
    #[test]
    fn a_small_way_off_is_the_distance() {
        let form = &forms()[1];
        let example = crate::analysis::Balance::of(form).position().unwrap().to_vec();
        assert!(distance_to_balance(form, &example).unwrap() < 1e-7);
        // The family is normal to the gradients of both parts of its equation.
        for along in 0..12 {
            let turn = PI * f64::from(along) / 6.0;
            let normal: Vec<f64> = example
                .iter()
                .zip(&form.mass)
                .map(|(beta, mass)| (direction(beta - turn) * mass).re)
                .collect();
            let length = (normal.iter().map(|part| part * part).sum::<f64>() / 3.0).sqrt();
            for step in [1e-4, 1e-2] {
                let beta: Vec<f64> = example
                    .iter()
                    .zip(&normal)
                    .map(|(beta, part)| beta + step * part / length)
                    .collect();
                let found = distance_to_balance(form, &beta).unwrap();
                assert!((found - step).abs() < 1e-7, "{found} {step}");
            }
        }
    }

    #[test]
    fn only_three_balls_and_only_where_they_balance() {
        let two = RestForm::new(&Machine::default()).unwrap();
        assert_eq!(distance_to_balance(&two, &[0.0, 1.0]), None);
        let mut heavy = forms().remove(0);
        heavy.imbalance = 10.0;
        assert_eq!(distance_to_balance(&heavy, &[0.0, 1.0, 2.0]), None);
    }
}
