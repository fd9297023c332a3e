//! Positions in which two balls with contact touch, and how many of them are equilibria.

use std::f64::consts::TAU;

use super::rest_form::RestForm;
use super::set_samples::sample;
use crate::model::{Machine, wrap_to_two_pi};

/// Number of positions in which two balls touch.
const TOUCHING_POSITIONS: usize = 4096;

impl RestForm {
    /// Returns positions in which two balls touch and the others are apart, evenly distributed: both orders of two balls at
    /// 4096 places, or quasi-random samples for more balls. None without contact.
    pub(super) fn touching_positions(&self) -> Vec<Vec<f64>> {
        let balls = self.mass.len();
        if self.touching.is_none() {
            return Vec::new();
        }
        let pairs: Vec<[usize; 2]> = (0..balls)
            .flat_map(|behind| (0..balls).map(move |ahead| [behind, ahead]))
            .filter(|[behind, ahead]| behind != ahead)
            .collect();
        let position = |index: usize| {
            let [behind, ahead] = pairs[index % pairs.len()];
            let touching = self.touching_angle(behind, ahead);
            let number = index / pairs.len();
            let mut beta = match balls {
                2 => {
                    vec![number as f64 / (TOUCHING_POSITIONS / pairs.len()) as f64 * TAU; balls]
                }
                _ => sample(balls, 0, number as u32),
            };
            beta[ahead] = wrap_to_two_pi(beta[behind] + touching);
            beta
        };
        let all = (0..TOUCHING_POSITIONS).map(position);
        all.filter(|beta| self.is_possible(beta)).collect()
    }
}

/// Returns the fraction of the positions in which two balls touch that are equilibria, with the force between the balls: to
/// about 0.0005 for two balls, and to about 0.02 for more. `None` for balls without contact, and if the balls leave no room
/// for such a position.
pub fn touching_set_fraction(machine: &Machine) -> Option<f64> {
    let form = RestForm::new(machine)?;
    let positions = form.touching_positions();
    let rests = positions.iter().filter(|beta| form.holds_with_forces(beta)).count();
    (!positions.is_empty()).then(|| rests as f64 / positions.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::RestForm;
    use crate::model::{Ball, BallContact, BallsInContact, Machine};

    /// The forces that hold balls in contact are those of the simulated system.
    #[test]
    fn positions_are_held_as_in_simulations() {
        let contact = BallContact { restitution: 0.5, friction_coefficient: 0.2 };
        let small = Ball { diameter_m: 2e-3, mass_kg: 4e-5, ..Ball::default() };
        let balls = vec![Ball::default(), small, Ball::default()];
        let machine =
            Machine { speed_rad_s: -173.1803, balls, contact: Some(contact), ..Machine::default() };
        let form = RestForm::new(&machine).expect("three balls");
        let (mut held, mut all) = (0, 0);
        for beta in form.touching_positions() {
            let system = BallsInContact::<3>::new(&machine, &contact, &beta).expect("three balls");
            let beta = [beta[0], beta[1], beta[2]];
            let held_there = system.rest_margin(&beta) >= 0.0;
            assert_eq!(form.closed_gaps(&beta).len(), 1, "{beta:?}");
            assert_eq!(form.holds_with_forces(&beta), held_there, "{beta:?}");
            held += u32::from(held_there);
            all += 1;
        }
        assert!(all > 1000 && held > all / 100 && held < all - all / 100, "{held} of {all}");
    }
}
