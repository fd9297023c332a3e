//! The pairs of balls of a machine with contact, and the angles at which they touch.

use crate::model::Machine;

/// The contact between the balls of a machine.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ContactPairs {
    /// The coefficient of friction between two balls.
    pub friction_coefficient: f64,
    /// The angle at which each pair of balls touches, rad, with its cosine.
    pub pairs: Vec<([usize; 2], f64, f64)>,
}

impl ContactPairs {
    /// Returns the contact of a machine with several balls, if it has any.
    pub(super) fn of(machine: &Machine) -> Option<Self> {
        let contact = machine.contact?;
        let balls = machine.balls.len();
        let pairs = (0..balls).flat_map(|ball| (0..ball).map(move |other| [other, ball]));
        let pairs = pairs.map(|pair| {
            let [first, second] = pair.map(|ball| &machine.balls[ball]);
            let angle = machine.contact_angle_rad(first, second);
            (pair, angle, libm::cos(angle))
        });
        let friction_coefficient = contact.friction_coefficient;
        (balls > 1).then(|| ContactPairs { friction_coefficient, pairs: pairs.collect() })
    }
}
