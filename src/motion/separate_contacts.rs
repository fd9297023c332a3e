//! This file decides contacts at rest that touch no other, where all other phases are assumed.
//!
//! Let `a` be the accelerations of these contacts, `T` the friction forces with which they have these accelerations, and `N`
//! their normal forces. `T = T₀ - K a` and `N = N₀ + G a` are affine. At rest `|T| ≤ μ N`, and a contact that accelerates has
//! the friction `±μ N` against its acceleration. At most one motion with normal forces that press is possible if
//! `K_ii > Σ_{j≠i} |K_ij| + μ_i Σ_j |G_ij|` for each contact `i`, for the following reason. Let the accelerations of two motions
//! differ most at contact `i`, by `δ`, and let the acceleration of this contact be larger in the first motion. The friction of
//! a contact does not fall with its acceleration, except as its normal force changes: the friction of contact `i` is smaller
//! in the first motion by at most `μ_i Σ_j |G_ij| δ`. The equations, however, make it smaller by at least
//! `(K_ii - Σ_{j≠i} |K_ij|) δ`.

use smallvec::SmallVec;

use super::evaluator::Forces;
use super::incremental_forces::TOGETHER;
use super::linear_system::{Entries, Unknowns, solve_for_each};
use super::{Direction, IncrementalForces, Phase, Phases};

/// A contact that sets off has its static friction if its friction differs from that by at most this fraction.
const SAME_FRICTION: f64 = 1e-9;
/// The diagonal exceeds the sum of the other entries at least by this factor, so that rounding errors do not grow.
const SURPLUS: f64 = 1.01;

/// Contacts at rest that touch no other.
pub(super) struct SeparateContacts {
    pub(super) contacts: SmallVec<[usize; 8]>,
    /// The static coefficient of friction of each.
    pub(super) limits: SmallVec<[f64; 8]>,
    /// The phase of a contact that sets off in a direction.
    pub(super) sets_off: fn(Direction) -> Phase,
    pub(super) slack: f64,
}

impl SeparateContacts {
    /// Returns all phases of the only motion in which the other contacts and the gaps have the assumed phases; `None` if
    /// several motions may be possible. Whether the assumed phases meet their own conditions remains to be examined. The
    /// assumed phases of these contacts are preferred.
    pub(super) fn decide(
        &self,
        equations: &mut IncrementalForces,
        assumed: &Phases,
    ) -> Option<Phases> {
        let count = self.contacts.len();
        if count == 0 {
            return Some(assumed.clone());
        }
        let mut held = assumed.clone();
        self.contacts.iter().for_each(|contact| held[*contact] = Phase::Stick);
        let (at_rest, _) = equations.forces_and_gaps(&held);
        let setting_off = |contact: &usize| {
            let mut phases = held.clone();
            // The contact accelerates in the direction of the friction that held it, which reverses: the acceleration is large.
            phases[*contact] = (self.sets_off)(Direction::of(-at_rest[*contact].friction));
            phases
        };
        let each: Vec<Phases> = self.contacts.iter().map(setting_off).collect();
        let moved: Vec<Forces> = each
            .chunks(TOGETHER)
            .flat_map(|some| equations.forces_of_several(some))
            .map(|(forces, _)| forces)
            .collect();
        // A unit of the acceleration of each contact lowers the friction and raises the normal force of each by these numbers.
        let by = |row: usize, column: usize| {
            let (contact, forces) = (self.contacts[row], &moved[column]);
            let acceleration = forces[self.contacts[column]].acceleration;
            let friction = at_rest[contact].friction - forces[contact].friction;
            let normal = forces[contact].normal - at_rest[contact].normal;
            [friction / acceleration, normal / acceleration]
        };
        let all: Vec<[f64; 2]> =
            (0..count).flat_map(|row| (0..count).map(move |column| by(row, column))).collect();
        let is_dominant = |row: usize| {
            let of_row = &all[row * count..][..count];
            let limit = self.limits[row];
            let sum: f64 =
                of_row.iter().map(|[friction, normal]| friction.abs() + limit * normal.abs()).sum();
            let forces = &moved[row][self.contacts[row]];
            let full = limit * forces.normal;
            // The sum contains the entry on the diagonal.
            of_row[row][0] > SURPLUS * (sum - of_row[row][0])
                && (forces.friction.abs() - full).abs() <= SAME_FRICTION * full
        };
        if !(0..count).all(is_dominant) {
            return None;
        }
        self.exchanged(assumed, &at_rest, &all)
    }

    /// Exchanges the phases of all contacts whose conditions fail, until all conditions hold.
    fn exchanged(&self, assumed: &Phases, at_rest: &Forces, by: &[[f64; 2]]) -> Option<Phases> {
        let count = self.contacts.len();
        let mut phases = assumed.clone();
        for _ in 0..count + 3 {
            let direction = |place: usize| phases[self.contacts[place]].mode().direction();
            let moving: SmallVec<[usize; 8]> =
                (0..count).filter(|place| direction(*place) != 0.0).collect();
            let full = |row: usize| direction(row) * self.limits[row];
            let entry = |row: usize, column: usize| {
                let [friction, normal] = by[row * count + column];
                friction + full(row) * normal
            };
            let right = |row: &usize| {
                let forces = &at_rest[self.contacts[*row]];
                forces.friction - full(*row) * forces.normal
            };
            let entries: Entries<f64> = moving
                .iter()
                .flat_map(|row| moving.iter().map(|column| entry(*row, *column)))
                .collect();
            let mut accelerations: Unknowns<f64> = moving.iter().map(right).collect();
            solve_for_each(entries, [&mut accelerations].into(), moving.len());
            let mut next = phases.clone();
            for row in 0..count {
                let contact = self.contacts[row];
                let forces = &at_rest[contact];
                let (mut friction, mut normal) = (forces.friction, forces.normal);
                for (column, acceleration) in moving.iter().zip(&accelerations) {
                    let [by_friction, by_normal] = by[row * count + column];
                    friction -= by_friction * acceleration;
                    normal += by_normal * acceleration;
                }
                if normal <= 0.0 {
                    return None;
                }
                match moving.iter().position(|place| *place == row) {
                    Some(place) if direction(row) * accelerations[place] < -0.5 * self.slack => {
                        next[contact] = Phase::Stick;
                    }
                    None if self.limits[row] * normal - friction.abs() < -0.5 * self.slack => {
                        next[contact] = (self.sets_off)(Direction::of(friction));
                    }
                    _ => {}
                }
            }
            if next == phases {
                return Some(phases);
            }
            phases = next;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rand::{RngExt, SeedableRng};
    use smallvec::smallvec;

    use super::SeparateContacts;
    use crate::model::{Ball, BallContact, BallsInContact, Machine};
    use crate::motion::event_driven::tie;
    use crate::motion::{Direction, Evaluator, Phase, Phases};

    /// In random states with two balls in touch, and for each motion of these, the two other balls get the only phases that
    /// meet all conditions. Several combinations may meet them if the balls are heavy; no phases are then returned.
    #[test]
    fn contacts_alone_have_the_only_phases_that_hold() {
        let contact = BallContact { restitution: 0.4, friction_coefficient: 0.1 };
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let [mut decided, mut moving] = [0, 0];
        for _ in 0..300 {
            let mass_kg = 1e-4 * 10_f64.powf(random.random_range(0.0..5.0));
            let friction_coefficient = 10_f64.powf(random.random_range(-3.0..1.0));
            let ball = Ball { mass_kg, friction_coefficient, ..Ball::default() };
            let balls = vec![Ball::default(), Ball::default(), ball, ball];
            let machine = Machine { balls, ..Machine::default() };
            let mut state = [0.0; 12];
            state[..4].fill_with(|| random.random_range(-0.3..0.3));
            let first: f64 = random.random_range(0.0..1.0);
            state[4..8].copy_from_slice(&[first, first + 0.3, first + 2.0, first + 2.6]);
            let system = BallsInContact::<4>::new(&machine, &contact, &[0.1, 0.9, 2.0, 2.6])
                .expect("four balls");
            let evaluator = Evaluator::new(Arc::new(system));
            let slack = tie(evaluator.system().force_scale());
            let limit = |ball: usize| evaluator.system().friction(ball).limit;
            let alone = SeparateContacts {
                contacts: smallvec![2, 3],
                limits: smallvec![limit(2), limit(3)],
                sets_off: Phase::Slip,
                slack,
            };
            let choices =
                [Phase::Stick, Phase::Slip(Direction::Forward), Phase::Slip(Direction::Backward)];
            for of_two in choices {
                let assumed: Phases = smallvec![
                    of_two,
                    of_two,
                    Phase::Stick,
                    Phase::Stick,
                    Phase::Closed,
                    Phase::Open,
                    Phase::Open,
                    Phase::Open
                ];
                let mut equations = evaluator.incremental_forces(&state);
                let Some(found) = alone.decide(&mut equations, &assumed) else { continue };
                decided += 1;
                moving += found[2..4].iter().filter(|phase| **phase != Phase::Stick).count();
                for (two, three) in
                    choices.iter().flat_map(|two| choices.map(|three| (*two, three)))
                {
                    let mut phases = assumed.clone();
                    (phases[2], phases[3]) = (two, three);
                    let forces = equations.forces_and_gaps(&phases).0;
                    let holds = |ball: usize| match phases[ball] {
                        Phase::Slip(direction) => direction * forces[ball].acceleration >= -slack,
                        _ => {
                            limit(ball) * forces[ball].normal - forces[ball].friction.abs()
                                >= -slack
                        }
                    };
                    assert_eq!(holds(2) && holds(3), phases == found, "{phases:?} {found:?}");
                }
            }
        }
        assert!(decided > 300 && moving > 100 && decided < 900, "{decided} {moving}");
    }
}
