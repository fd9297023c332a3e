//! The exact equilibrium set of one ball: arcs of the circle with their ends in closed form.
//!
//! With `ψ` the ball's angle relative to the table displacement caused by the imbalance, the
//! tangential and the normal force are each a constant plus a sine of `ψ`. The two limits `T = ±μ
//! N` are therefore reached at `sin(ψ ± δ) = s`, `δ = atan μ`: at two angles each, or at no angle.

use std::f64::consts::{PI, TAU};

use super::rest_form::{RestForm, direction};
use crate::model::wrap_to_two_pi;

/// Arcs of the circle in which one ball can rest.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RestArcs {
    /// Start, in [0, 2π), and end of each arc, in the positive sense, without overlap. An arc of
    /// length 0 is an isolated rest position; the whole circle is one arc of 2π.
    arcs: Vec<[f64; 2]>,
    /// The direction of the imbalance of the table without the ball.
    imbalance_direction: f64,
}

impl RestArcs {
    /// Returns the arcs of a machine with one ball.
    pub(super) fn of(form: &RestForm) -> Self {
        let holds = |beta: f64| form.holds(&[direction(beta)]);
        let imbalance_direction = form.imbalance_of_table().arg();
        let mut ends = ends(form);
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        let (Some(first), Some(last)) = (ends.first(), ends.last()) else {
            let arcs = if holds(0.0) { vec![[0.0, TAU]] } else { Vec::new() };
            return RestArcs { arcs, imbalance_direction };
        };
        // Piece `k` extends from end `k` to the next end round the circle.
        let piece = |k: usize| [ends[k], ends.get(k + 1).copied().unwrap_or(*first + TAU)];
        let inside: Vec<bool> = (0..ends.len())
            .map(|k| {
                let [begin, end] = piece(k);
                holds(begin + 0.5 * (end - begin))
            })
            .collect();
        if !inside.contains(&false) {
            return RestArcs { arcs: vec![[*last, *last + TAU]], imbalance_direction };
        }
        let mut arcs = Vec::new();
        for k in 0..ends.len() {
            let before = inside[(k + ends.len() - 1) % ends.len()];
            if before {
                continue;
            }
            let along = (0..ends.len()).take_while(|step| inside[(k + step) % ends.len()]).count();
            if along > 0 {
                let to = ends[(k + along) % ends.len()];
                arcs.push([ends[k], if to > ends[k] { to } else { to + TAU }]);
            } else if normal_force(form, ends[k]) >= 0.0 {
                // The limit is touched but not crossed, or there is no friction.
                arcs.push([ends[k]; 2]);
            }
        }
        RestArcs { arcs, imbalance_direction }
    }

    /// Returns the number of arcs.
    pub(super) fn count(&self) -> u64 {
        self.arcs.len() as u64
    }

    /// Returns the fraction of the circle that the arcs cover.
    pub(super) fn fraction(&self) -> f64 {
        self.arcs.iter().map(|[begin, end]| (end - begin) / TAU).sum()
    }

    /// Returns the angles at which the smallest and the largest amplitude can lie: the ends, and,
    /// if the ball can rest there, the direction of the imbalance and the opposite one.
    pub(super) fn candidates(&self) -> impl Iterator<Item = f64> {
        self.arcs.iter().flat_map(|&arc| {
            let special = [0.0, PI].map(|turn| wrap_to_two_pi(self.imbalance_direction + turn));
            let special = special.into_iter().filter(move |angle| within(arc, *angle));
            special.chain(arc.map(wrap_to_two_pi))
        })
    }
}

/// Returns whether an angle in [0, 2π) lies in an arc.
fn within([begin, end]: [f64; 2], angle: f64) -> bool {
    (begin <= angle && angle <= end) || (begin <= angle + TAU && angle + TAU <= end)
}

/// Returns the angles in [0, 2π) at which a limit is reached.
fn ends(form: &RestForm) -> Vec<f64> {
    let (ball, imbalance) = (form.transfer * form.mass[0], form.transfer * form.imbalance);
    let coefficient = form.friction_coefficient[0];
    let slant = libm::atan(coefficient);
    let limit = coefficient * (1.0 + ball.re);
    let range = imbalance.norm() * coefficient.hypot(1.0);
    let forward = (ball.im - limit) / range;
    let backward = (ball.im + limit) / range;
    let places = |sine: f64, turned: f64| {
        let angle = libm::asin(sine);
        [angle + turned, PI - angle + turned].map(|psi| wrap_to_two_pi(psi + imbalance.arg()))
    };
    let mut ends = Vec::new();
    if forward.abs() <= 1.0 {
        ends.extend(places(forward, -slant));
    }
    // Without friction the two limits coincide.
    if coefficient > 0.0 && backward.abs() <= 1.0 {
        ends.extend(places(backward, slant));
    }
    ends
}

/// Returns the ratio of the normal force on the ball to that without vibration.
fn normal_force(form: &RestForm, beta: f64) -> f64 {
    let (z, e) = (form.ring_centre(&[beta]), direction(beta));
    1.0 + (z.re * e.re + z.im * e.im)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::{RestArcs, within};
    use crate::analysis::rest_form::{RestForm, direction};
    use crate::model::{Ball, Machine};

    fn form(speed_rad_s: f64, friction_coefficient: f64, mass_kg: f64) -> RestForm {
        let ball = Ball { friction_coefficient, mass_kg, ..Ball::default() };
        RestForm::new(&Machine { speed_rad_s, balls: vec![ball], ..Machine::default() }).unwrap()
    }

    /// A position lies in an arc if and only if the ball is held there, for random machines with
    /// extreme forces, balls that lift off, and sets of zero, one and two arcs.
    #[test]
    fn arcs_are_where_the_ball_is_held() {
        let mut draws = ChaCha8Rng::seed_from_u64(5);
        let mut counts = [0_u32; 3];
        for _ in 0..2_000 {
            let power = |low: f64, high: f64, draw: f64| 10.0_f64.powf(low + (high - low) * draw);
            let speed = -120.0 - 180.0 * draws.random::<f64>();
            let friction = power(-5.0, 0.5, draws.random::<f64>());
            let form = form(speed, friction, power(-5.0, 0.0, draws.random::<f64>()));
            let arcs = RestArcs::of(&form);
            counts[arcs.count() as usize] += 1;
            assert!(arcs.fraction() <= 1.0 + 1e-12);
            for _ in 0..50 {
                let beta = TAU * draws.random::<f64>();
                let near = |angle: f64| (angle - beta).abs() < 1e-9;
                if arcs.arcs.iter().flatten().any(|&end| near(end) || near(end - TAU)) {
                    continue;
                }
                let found = arcs.arcs.iter().any(|&arc| within(arc, beta));
                assert_eq!(found, form.holds(&[direction(beta)]), "{form:?} {beta}");
            }
        }
        assert!(counts.iter().all(|count| *count > 20), "{counts:?}");
    }

    /// Without friction the set consists of the two equilibria, each an arc of length 0.
    #[test]
    fn without_friction_the_set_is_two_points() {
        let arcs = RestArcs::of(&form(-216.3772, 0.0, 1.4e-4));
        assert_eq!((arcs.count(), arcs.fraction()), (2, 0.0));
        assert!(arcs.candidates().all(|beta| {
            let required = form(-216.3772, 0.0, 1.4e-4).at_rest(&[beta]).required_friction;
            required < 1e-15
        }));
    }

    /// At standstill no force acts, and the set is the whole circle.
    #[test]
    fn at_standstill_the_set_is_the_whole_circle() {
        let arcs = RestArcs::of(&form(0.0, 0.0, 1.4e-4));
        assert_eq!((arcs.count(), arcs.fraction()), (1, 1.0));
    }
}
