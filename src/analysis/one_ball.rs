//! The equilibrium set of one ball, exactly: arcs of its circle with their ends in closed form.
//!
//! With `ψ` the ball's angle from the table's displacement by the imbalance, friction and normal force are
//! a constant and a sine of `ψ` each, so that the two limits `T = ±μ N` are reached at `sin(ψ ± δ) = s`,
//! `δ = atan μ`: at two angles each, or nowhere.

use std::f64::consts::{PI, TAU};

use super::balance::wrapped;
use super::rest_form::{RestForm, direction};

/// Arcs of the circle in which one ball can rest.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Arcs {
    /// Begin, in [0, 2π), and end of each, in the positive sense; without overlap. An arc of no length is a
    /// single place to rest; the whole circle is one arc of 2π.
    arcs: Vec<[f64; 2]>,
}

impl Arcs {
    /// Those of a machine with one ball.
    pub(super) fn of(form: &RestForm) -> Self {
        let holds = |beta: f64| form.holds(&[direction(beta)]);
        let mut ends = ends(form);
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        let (Some(first), Some(last)) = (ends.first(), ends.last()) else {
            return Arcs { arcs: if holds(0.0) { vec![[0.0, TAU]] } else { Vec::new() } };
        };
        // Piece `k` goes from end `k` to the next one round the circle.
        let piece = |k: usize| [ends[k], ends.get(k + 1).copied().unwrap_or(*first + TAU)];
        let inside: Vec<bool> = (0..ends.len())
            .map(|k| {
                let [begin, end] = piece(k);
                holds(begin + 0.5 * (end - begin))
            })
            .collect();
        if !inside.contains(&false) {
            return Arcs { arcs: vec![[*last, *last + TAU]] };
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
                // The limit is reached and not crossed: without friction, or where it only just touches.
                arcs.push([ends[k]; 2]);
            }
        }
        Arcs { arcs }
    }

    /// How many there are.
    pub(super) fn count(&self) -> u64 {
        self.arcs.len() as u64
    }

    /// The fraction of the circle that they make up.
    pub(super) fn fraction(&self) -> f64 {
        self.arcs.iter().map(|[begin, end]| (end - begin) / TAU).sum()
    }

    /// The angles at which the smallest and the largest amplitude may be: the ends, and the directions of the
    /// imbalance and opposite to it where the ball can rest there.
    pub(super) fn candidates(&self) -> impl Iterator<Item = f64> {
        self.arcs.iter().flat_map(|&arc| {
            let special = [0.0, PI].into_iter().filter(move |angle| within(arc, *angle));
            special.chain(arc.map(wrapped))
        })
    }
}

/// Whether an angle in [0, 2π) lies in an arc.
fn within([begin, end]: [f64; 2], angle: f64) -> bool {
    (begin <= angle && angle <= end) || (begin <= angle + TAU && angle + TAU <= end)
}

/// Where a limit is reached, in [0, 2π).
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
        [angle + turned, PI - angle + turned].map(|psi| wrapped(psi + imbalance.arg()))
    };
    let mut ends = Vec::new();
    if forward.abs() <= 1.0 {
        ends.extend(places(forward, -slant));
    }
    // Without friction both limits are reached at the same places.
    if coefficient > 0.0 && backward.abs() <= 1.0 {
        ends.extend(places(backward, slant));
    }
    ends
}

/// The normal force on the ball over that without vibration.
fn normal_force(form: &RestForm, beta: f64) -> f64 {
    let (z, e) = (form.rest_point(&[beta]), direction(beta));
    1.0 + (z.re * e.re + z.im * e.im)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::{Arcs, within};
    use crate::analysis::rest_form::{RestForm, direction};
    use crate::analysis::test_rng::TestRng;
    use crate::model::{Ball, Machine};

    fn form(speed_rad_s: f64, friction_coefficient: f64, mass_kg: f64) -> RestForm {
        let ball = Ball { friction_coefficient, mass_kg, ..Ball::default() };
        RestForm::new(&Machine { speed_rad_s, balls: vec![ball], ..Machine::default() }).unwrap()
    }

    /// A position is in an arc where the condition itself holds, and not where it does not, at random
    /// machines: forces beyond all measure, balls that lift off, sets of no, one and two arcs.
    #[test]
    fn arcs_are_where_the_ball_is_held() {
        let mut draws = TestRng::new(5);
        let mut counts = [0_u32; 3];
        for _ in 0..2_000 {
            let power = |low: f64, high: f64, draw: f64| 10.0_f64.powf(low + (high - low) * draw);
            let speed = -120.0 - 180.0 * draws.uniform();
            let friction = power(-5.0, 0.5, draws.uniform());
            let form = form(speed, friction, power(-5.0, 0.0, draws.uniform()));
            let arcs = Arcs::of(&form);
            counts[arcs.count() as usize] += 1;
            assert!(arcs.fraction() <= 1.0 + 1e-12);
            for _ in 0..50 {
                let beta = TAU * draws.uniform();
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

    /// Without friction the set is the equilibria themselves: two places, of no length.
    #[test]
    fn places_without_friction() {
        let arcs = Arcs::of(&form(-216.3772, 0.0, 1.4e-4));
        assert_eq!((arcs.count(), arcs.fraction()), (2, 0.0));
        assert!(arcs.candidates().all(|beta| {
            let required = form(-216.3772, 0.0, 1.4e-4).at_rest(&[beta]).required_friction;
            required < 1e-15
        }));
    }

    /// At standstill no force acts.
    #[test]
    fn the_whole_circle_at_standstill() {
        let arcs = Arcs::of(&form(0.0, 0.0, 1.4e-4));
        assert_eq!((arcs.count(), arcs.fraction()), (1, 1.0));
    }
}
