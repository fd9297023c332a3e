//! What is known of a limit cycle beside the numbers that every outcome has.

use serde::{Deserialize, Serialize};

use crate::motion::Phase;

/// What a contact does at one time in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum CyclePhase {
    /// It rests on what it lies on.
    Stick,
    /// It moves in its coordinate's positive direction.
    Forward,
    /// It moves in its coordinate's negative direction.
    Backward,
}

impl CyclePhase {
    /// What a contact in this phase does; `speed` decides where the phase has no direction.
    pub fn of(phase: Phase, speed: f64) -> Self {
        match phase {
            Phase::Stick => CyclePhase::Stick,
            Phase::Slip(direction) | Phase::Transition(direction) if direction > 0.0 => {
                CyclePhase::Forward
            }
            Phase::Slip(_) | Phase::Transition(_) => CyclePhase::Backward,
            Phase::Free if speed >= 0.0 => CyclePhase::Forward,
            Phase::Free => CyclePhase::Backward,
        }
    }
}

/// A limit cycle that a run has been shown to be on. Contacts are in their own order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// Whole turns of each ball relative to the ring in one period, with sign; 0 of a block.
    pub turns: Vec<i32>,
    /// What the contacts do over one period, one after another; it begins where the period was
    /// begun, which says nothing, and neighbours differ.
    pub configurations: Vec<Vec<CyclePhase>>,
    /// Least and greatest speed of each contact relative to what it lies on: rad/s of a ball, m/s
    /// of a block.
    pub speed_extremes: Vec<[f64; 2]>,
    /// Least and greatest angle of each ball that does not go round, rad, each within a turn of
    /// [0, 2π); none of one that does, and of a block.
    pub angle_extremes: Vec<Option<[f64; 2]>>,
    /// Greatest displacement of the table, or of a block from the middle of its cycle, m.
    pub peak_amplitude_m: f64,
    /// Moduli of the Floquet multipliers off the neutral directions, descending.
    pub multipliers: Vec<f64>,
    /// In how many directions the cycle belongs to a continuous family: balls that rest may rest
    /// elsewhere.
    pub neutral_directions: u8,
}

impl Cycle {
    /// Whether it is of a system with so many contacts.
    pub fn is_of(&self, contacts: usize) -> bool {
        let lengths = [self.turns.len(), self.speed_extremes.len(), self.angle_extremes.len()];
        lengths == [contacts; 3]
            && self.configurations.iter().all(|configuration| configuration.len() == contacts)
    }

    /// Whether a contact rests all along the cycle.
    pub fn rests(&self, contact: usize) -> bool {
        self.configurations.iter().all(|configuration| configuration[contact] == CyclePhase::Stick)
    }
}
