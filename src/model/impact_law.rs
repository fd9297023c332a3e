//! How bodies separate after an impact.

/// The speed of approach below which contact lasts: a ten-thousandth of a typical speed of running balls.
pub const LASTING_APPROACH: f64 = 1e-6;

/// How the bodies of a contact separate after an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpactLaw {
    /// The speed of separation over the speed of approach, 0 to 1 (Newton).
    pub restitution: f64,
    /// The sliding speed after an impact without slip over that before it, with the opposite sign, 0 to 1.
    pub tangential_restitution: f64,
    /// The speed of approach, non-dimensional, below which contact lasts unless impacts lose no energy: infinitely many
    /// impacts would follow within a time that is proportional to the speed.
    pub lasting_approach: f64,
}

impl Default for ImpactLaw {
    /// The bodies stay together.
    fn default() -> Self {
        let lasting_approach = LASTING_APPROACH;
        ImpactLaw { restitution: 0.0, tangential_restitution: 0.0, lasting_approach }
    }
}
