//! A gap between two contacts that move along one circle, such as two balls in a ring, and the forces in it.
//!
//! The centres of two balls that touch lie on the ring's circle of radius `L`, at the angle
//! `Δ = 2 asin((d_1 + d_2) / (4 L))`. The force between them acts along their chord. Its tangential part `λ` pushes them
//! apart, and its normal part `tan(Δ/2) λ` presses both to the ring. Both balls roll in the same sense, so that their
//! surfaces slide on each other; friction `q` between them, at most `μ_b λ`, acts across the chord.

use super::ContactMode;
use super::angle::wrap_to_two_pi;

/// A gap between two contacts that move along one circle. It closes when the contact behind meets the contact
/// ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// The contact behind and the contact ahead, counted from 0.
    pub contacts: [usize; 2],
    /// The difference of their angles where they touch, modulo one turn.
    pub distance: f64,
    /// The masses of the two bodies.
    pub masses: [f64; 2],
    /// Normal force on each support over the contact force `λ`: `tan(Δ/2)`.
    pub tangent: f64,
    /// Retarding force on each rolling body over the friction `q` between them: `κ = 1/cos(Δ/2) + tan(Δ/2)`.
    pub lever: f64,
    /// The coefficient of friction between the bodies.
    pub friction_coefficient: f64,
}

impl Gap {
    /// Creates the gap between two balls with their contact angle.
    pub fn between_balls(
        contacts: [usize; 2],
        angle: f64,
        masses: [f64; 2],
        friction_coefficient: f64,
    ) -> Self {
        let (sine, cosine) = libm::sincos(0.5 * angle);
        let tangent = sine / cosine;
        let lever = 1.0 / cosine + tangent;
        Gap { contacts, distance: angle, masses, tangent, lever, friction_coefficient }
    }

    /// Returns the tangential and the normal force on the contact behind and on the contact ahead, each over the mass
    /// of its body, by a contact force `λ = 1`, and the same by a friction `q = 1`.
    pub fn pushes(&self) -> [[[f64; 2]; 2]; 2] {
        let [behind, ahead] = self.masses.map(|mass| 1.0 / mass);
        let Gap { tangent, lever, .. } = *self;
        [
            [[-behind, tangent * behind], [ahead, tangent * ahead]],
            [[-lever * behind, -behind], [-lever * ahead, ahead]],
        ]
    }

    /// Returns the tangential and the normal force on the contact behind and on the contact ahead, each over the mass of
    /// its body, by a contact force `λ = 1` with full friction of two bodies that roll in the direction `rolling`: 1, -1, or
    /// 0 without friction.
    pub fn rolling_pushes(&self, rolling: f64) -> [[f64; 2]; 2] {
        let [by_force, by_friction] = self.pushes();
        let friction = rolling * self.friction_coefficient;
        let with =
            |side: usize, way: usize| by_force[side][way] + friction * by_friction[side][way];
        [0, 1].map(|side| [0, 1].map(|way| with(side, way)))
    }

    /// Returns the width of the gap between a contact behind and a contact ahead at these positions.
    pub fn width(&self, [behind, ahead]: [f64; 2]) -> f64 {
        wrap_to_two_pi(ahead - behind) - self.distance
    }

    /// Returns the mass that the relative acceleration of the two bodies meets.
    pub fn reduced_mass(&self) -> f64 {
        1.0 / (1.0 / self.masses[0] + 1.0 / self.masses[1])
    }
}

/// Returns the pushes of a unit of force in each gap on the contact behind and on the contact ahead
/// ([`Gap::rolling_pushes`]); `None` for a gap without a force in the equations: an open one, or one between two contacts
/// that stick. The modes of the gaps follow those of the contacts.
pub(crate) fn pushes<'a>(
    gaps: &'a [Gap],
    modes: &'a [ContactMode],
) -> impl Iterator<Item = Option<[[f64; 2]; 2]>> + 'a {
    let (of_contacts, of_gaps) = modes.split_at(modes.len() - gaps.len());
    gaps.iter().zip(of_gaps).map(|(gap, mode)| {
        let [behind, ahead] = gap.contacts.map(|contact| of_contacts[contact]);
        let sticks = behind == ContactMode::Stick && ahead == ContactMode::Stick;
        let closed = *mode == ContactMode::Closed && !sticks;
        // Both roll in the same direction.
        let [behind, ahead] = [behind, ahead].map(ContactMode::direction);
        closed.then(|| gap.rolling_pushes(if behind == 0.0 { ahead } else { behind }))
    })
}
