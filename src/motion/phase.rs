//! The phase of a contact.

use std::ops::Mul;

use smallvec::SmallVec;

use crate::model::ContactMode;

/// The direction in which a contact slides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// That of positive speed.
    Forward,
    /// That of negative speed.
    Backward,
}

impl Direction {
    /// Returns the direction of a speed or a force; that of zero is the direction of its sign.
    pub fn of(value: f64) -> Self {
        if value.is_sign_negative() { Direction::Backward } else { Direction::Forward }
    }

    /// Returns 1 or -1.
    pub fn sign(self) -> f64 {
        match self {
            Direction::Forward => 1.0,
            Direction::Backward => -1.0,
        }
    }
}

impl Mul<f64> for Direction {
    type Output = f64;

    fn mul(self, value: f64) -> f64 {
        self.sign() * value
    }
}

/// The phase of a ball (thesis table 4.2) or a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// It moves, faster than the band. In the exact motion, which has no
    /// band, this phase starts when the contact breaks away.
    Slip(Direction),
    /// It rests on its support: friction holds it.
    Stick,
    /// It is in the band but friction does not hold it: it accelerates in this direction.
    Transition(Direction),
    /// Its law has no stick: it moves in either direction.
    Free,
    /// Its bodies do not touch.
    Apart,
    /// It is a gap that may close.
    Open,
    /// It is a gap, and its two contacts touch.
    Closed,
}

/// The phases of all contacts, and after these of all gaps.
pub type Phases = SmallVec<[Phase; 16]>;

/// A number for each contact.
pub type PerContact = SmallVec<[f64; 8]>;

/// Returns whether all contacts stick, whatever the gaps do.
pub fn all_stick(phases: &[Phase]) -> bool {
    phases.iter().all(|phase| matches!(phase, Phase::Stick | Phase::Open | Phase::Closed))
}

/// Returns whether any gap is closed.
pub(crate) fn any_closed(phases: &[Phase]) -> bool {
    phases.iter().rev().take_while(|phase| phase.is_gap()).any(|phase| *phase == Phase::Closed)
}

impl Phase {
    /// Returns whether it is that of a gap.
    pub fn is_gap(self) -> bool {
        matches!(self, Phase::Open | Phase::Closed)
    }

    /// Returns how the contact moves in the equations of motion.
    pub fn mode(self) -> ContactMode {
        match self {
            Phase::Stick => ContactMode::Stick,
            Phase::Slip(direction) => ContactMode::Slip(direction.sign()),
            Phase::Transition(direction) => ContactMode::BreakingAway(direction.sign()),
            Phase::Free => ContactMode::Slip(0.0),
            Phase::Apart => ContactMode::Apart,
            Phase::Open => ContactMode::Open,
            Phase::Closed => ContactMode::Closed,
        }
    }

    /// Returns whether it sticks, or may stick at any moment.
    pub fn in_band(self) -> bool {
        matches!(self, Phase::Stick | Phase::Transition(_))
    }
}
