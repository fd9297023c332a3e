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
/// Largest number of rounds in which the balls are moved one at a time.
const ROUNDS: usize = 200;

/// Returns the smallest and the largest non-dimensional amplitude that the search finds in the set,
/// each with the angles of the balls.
///
/// `None` for an empty set, for balls that can balance (whose smallest amplitude is 0), and without
/// imbalance, where all directions are equivalent.
pub(super) fn amplitude_extremes(form: &RestForm) -> [Option<(f64, Vec<f64>)>; 2] {
    let most: f64 = form.transfer.norm() * (form.imbalance + form.mass.iter().sum::<f64>());
    if !(most > 0.0 && most.is_finite() && form.imbalance > 0.0) {
        return [None, None];
    }
    let above = most * (1.0 + 1e-9);
    let found = |from: f64, to: f64| {
        choices(form).into_iter().fold(None, |best: Option<(f64, Vec<f64>)>, far| {
            // Only displacements better than the best one so far matter.
            let to = best.as_ref().map_or(to, |(size, _)| *size);
            Choice { form, far }.first(from, to).or(best)
        })
    };
    [found(0.0, above), found(above, 0.0)]
}

/// Returns all choices of the balls opposite to the displacement that differ; among identical
/// balls, the first ones are opposite.
fn choices(form: &RestForm) -> Vec<Vec<bool>> {
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
struct Choice<'a> {
    form: &'a RestForm,
    far: Vec<bool>,
}

/// Comparison of `|r / g - Σ m e^{iφ}|` with the imbalance, over all positions of the balls in
/// their arcs.
#[derive(Clone, Copy, PartialEq)]
enum Left {
    /// Always greater.
    More,
    /// Always less.
    Less,
    /// Equality is possible.
    Any,
}

impl Choice<'_> {
    /// Returns the first displacement between `from` and `to` at which balls are held in these
    /// arcs, with their angles.
    fn first(&self, from: f64, to: f64) -> Option<(f64, Vec<f64>)> {
        let at = |step: usize| from + (to - from) * (step as f64 / STEPS as f64);
        let (mut before, mut left) = (from, self.left(from)?);
        if left == Left::Any {
            return Some((from, self.position(from)?));
        }
        for step in 1..=STEPS {
            let mut after = at(step);
            let Some(now) = self.left(after) else { continue };
            if now == left {
                before = after;
                continue;
            }
            // Between `More` and `Less` there is a displacement with equality.
            while (after - before).abs() > 1e-14 * from.max(to) {
                let middle = before.midpoint(after);
                if self.left(middle) == Some(left) { before = middle } else { after = middle }
            }
            for size in [after, before] {
                if let Some(beta) = self.position(size) {
                    return Some((size, beta));
                }
            }
            (before, left) = (at(step), now);
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

    fn left(&self, size: f64) -> Option<Left> {
        let (imbalance, arcs) = (self.form.imbalance, self.arcs(size)?);
        // The middles of the arcs usually decide: no ball is farther from there than the chord to
        // the end of its arc.
        let middles: Vec<f64> = arcs.iter().map(|[middle, _]| *middle).collect();
        let chords =
            self.form.mass.iter().zip(&arcs).map(|(m, [_, half])| 2.0 * m * libm::sin(0.5 * half));
        let (middle, reach) = (self.remainder(size, &middles).norm(), chords.sum::<f64>());
        if middle - reach > imbalance {
            return Some(Left::More);
        }
        if middle + reach < imbalance {
            return Some(Left::Less);
        }
        if self.extreme(size, &arcs, -1.0).0 > imbalance {
            Some(Left::More)
        } else if self.extreme(size, &arcs, 1.0).0 < imbalance {
            Some(Left::Less)
        } else {
            Some(Left::Any)
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
        let enough = |left: f64| sign * (left - self.form.imbalance) >= 0.0;
        let mut best: Option<(f64, Vec<f64>)> = None;
        for start in 0..=arcs.len() + 1 {
            let place = |(ball, [middle, half]): (usize, &[f64; 2])| match start {
                0 => *middle,
                _ if ball + 1 < start => middle - half,
                _ => middle + half,
            };
            let mut phi: Vec<f64> = arcs.iter().enumerate().map(place).collect();
            let mut left = self.remainder(size, &phi);
            for _ in 0..ROUNDS {
                let before = left.norm();
                for (ball, [middle, half]) in arcs.iter().enumerate() {
                    let mass = self.form.mass[ball];
                    let without = left + direction(phi[ball]) * mass;
                    let aim = (without * -sign).arg() - middle;
                    phi[ball] =
                        middle + (aim - (aim / (2.0 * PI)).round() * 2.0 * PI).clamp(-half, *half);
                    left = without - direction(phi[ball]) * mass;
                }
                if enough(left.norm())
                    || (left.norm() - before).abs() <= 1e-15 * self.form.imbalance
                {
                    break;
                }
            }
            let better = |best: &(f64, Vec<f64>)| sign * (left.norm() - best.0) > 0.0;
            if best.as_ref().is_none_or(better) {
                best = Some((left.norm(), phi));
            }
            if enough(left.norm()) {
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
        let imbalance = self.form.imbalance;
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
            let left = self.remainder(size, &between(middle)).norm();
            if left <= imbalance { less = middle } else { more = middle }
        }
        let phi = between(less);
        let turned = self.remainder(size, &phi).arg();
        Some(phi.into_iter().map(|phi| wrap_to_two_pi(phi - turned)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::amplitude_extremes;
    use crate::analysis::Balance;
    use crate::analysis::frictionless_equilibria;
    use crate::analysis::rest_form::RestForm;
    use crate::analysis::set_samples::held_positions;
    use crate::analysis::test_rng::TestRng;
    use crate::model::{Ball, Machine};

    fn form(speed_rad_s: f64, balls: &[(f64, f64)], imbalance: f64) -> RestForm {
        let ball = |&(mass_kg, friction_coefficient): &(f64, f64)| Ball {
            mass_kg,
            friction_coefficient,
            ..Ball::default()
        };
        let mut machine = Machine { speed_rad_s, ..Machine::default() };
        machine.balls = balls.iter().map(ball).collect();
        machine.imbalance_mass_kg *= imbalance;
        RestForm::new(&machine).unwrap()
    }

    /// Returns the largest (`sign` 1) or smallest (-1) amplitude, m, that small random moves within
    /// the set reach from samples of the set, the best ones and others.
    fn climbed(form: &RestForm, sign: f64) -> f64 {
        let amplitude = |beta: &[f64]| form.at_rest(beta).amplitude_m;
        let mut samples: Vec<&[f64]> = held_positions(form).collect();
        samples.sort_by(|a, b| (sign * amplitude(b)).total_cmp(&(sign * amplitude(a))));
        assert!(samples.len() > 20, "{}", samples.len());
        let others = samples.iter().step_by(samples.len() / 10);
        let mut draws = TestRng::new(3);
        let climb = |start: &&[f64]| {
            let (mut beta, mut best, mut reach) = (start.to_vec(), amplitude(start), 0.3);
            for _ in 0..20_000 {
                let near: Vec<f64> =
                    beta.iter().map(|beta| beta + reach * (draws.uniform() - 0.5)).collect();
                let rest = form.at_rest(&near);
                if rest.in_set() && sign * (rest.amplitude_m - best) > 0.0 {
                    (beta, best) = (near, rest.amplitude_m);
                } else {
                    reach = (reach * 0.999).max(1e-6);
                }
            }
            best
        };
        let ends: Vec<f64> = samples.iter().take(10).chain(others).map(climb).collect();
        sign * ends.into_iter().map(|end| sign * end).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Each extreme is attained at a position in the set, and no random search finds a more extreme
    /// one: for two to five balls, identical or not, on both sides of the natural frequency and
    /// near it, with an imbalance that they can balance and one that they cannot.
    #[test]
    fn extremes_are_in_the_set_and_no_search_exceeds_them() {
        let usual = (1.4e-4, 2.75e-3);
        let differ = [(1.4e-4, 2.75e-3), (2.5e-4, 1.0e-3), (0.8e-4, 4.0e-3)];
        let mut calmest_seen = 0;
        for (speed, balls, imbalance) in [
            (-179.2671, &[usual; 2][..], 1.0),
            (-179.2671, &[usual; 3][..], 1.0),
            (-216.3772, &[usual; 3][..], 1.0),
            (-216.3772, &[(1.4e-4, 1.0e-3); 3][..], 4.0),
            (-183.0, &[usual; 3][..], 1.0),
            (-160.8103, &differ[..], 1.0),
            (-191.6372, &differ[..], 4.0),
            (-216.3772, &[(1.4e-4, 1.0e-3); 5][..], 1.0),
        ] {
            let form = form(speed, balls, imbalance);
            let place = format!("{speed} {balls:?} {imbalance}");
            let [calmest, most] = amplitude_extremes(&form);
            for (found, sign) in [(&calmest, -1.0), (&most, 1.0)] {
                let (size, beta) = found.as_ref().unwrap();
                let rest = form.at_rest(beta);
                assert!(rest.friction_used <= 1.0 + 1e-9, "{place}: {}", rest.friction_used);
                let amplitude = size * form.ring_radius_m;
                assert!(
                    (rest.amplitude_m - amplitude).abs()
                        <= 1e-9 * form.ring_radius_m * most.as_ref().unwrap().0,
                    "{place}"
                );
                if sign < 0.0 && Balance::of(&form) != Balance::Nowhere {
                    assert_eq!(*size, 0.0, "{place}");
                    continue;
                }
                calmest_seen += u32::from(sign < 0.0);
                let climbed = climbed(&form, sign);
                let beyond = sign * (climbed - amplitude) / amplitude;
                assert!(beyond <= 1e-9, "{place}: {climbed:e} beyond {amplitude:e}");
            }
        }
        assert_eq!(calmest_seen, 2);
    }

    /// Without friction the set consists of the equilibria, which are known in closed form.
    #[test]
    fn extremes_without_friction_are_those_of_the_equilibria() {
        let ball = Ball { friction_coefficient: 0.0, ..Ball::default() };
        for count in [2, 3] {
            let mut machine = Machine { balls: vec![ball; count], ..Machine::default() };
            machine.imbalance_mass_kg *= 4.0;
            let known = frictionless_equilibria(&machine, 1.0).unwrap();
            let known = known.iter().map(|equilibrium| equilibrium.amplitude_m());
            let (low, high) = known.fold((f64::INFINITY, 0.0_f64), |(low, high), amplitude| {
                (low.min(amplitude), high.max(amplitude))
            });
            let form = RestForm::new(&machine).unwrap();
            let found =
                amplitude_extremes(&form).map(|found| found.unwrap().0 * form.ring_radius_m);
            let errors = [found[0] / low - 1.0, found[1] / high - 1.0];
            assert!(errors.iter().all(|error| error.abs() < 1e-9), "{found:?} {low} {high}");
        }
    }
}
