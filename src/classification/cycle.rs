//! Data of a limit cycle in addition to the numbers that every outcome has.

use serde::{Deserialize, Serialize};

use crate::motion::{Direction, Phase};

/// The phase of a contact in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum CyclePhase {
    /// It rests on its support.
    Stick,
    /// It moves in its coordinate's positive direction.
    Forward,
    /// It moves in its coordinate's negative direction.
    Backward,
    /// Its bodies do not touch.
    Apart,
}

impl CyclePhase {
    /// Returns the phase of a contact; `speed` decides if the phase has no direction.
    pub fn of(phase: Phase, speed: f64) -> Self {
        match phase {
            Phase::Stick | Phase::Open | Phase::Closed => CyclePhase::Stick,
            Phase::Slip(Direction::Forward) | Phase::Transition(Direction::Forward) => {
                CyclePhase::Forward
            }
            Phase::Slip(_) | Phase::Transition(_) => CyclePhase::Backward,
            Phase::Free if speed >= 0.0 => CyclePhase::Forward,
            Phase::Free => CyclePhase::Backward,
            Phase::Apart => CyclePhase::Apart,
        }
    }
}

/// Two contacts that touch in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct TouchingPair {
    /// The contacts, counted from 0, in ascending order.
    pub contacts: [usize; 2],
    /// Whether they touch throughout; otherwise they meet and separate.
    pub throughout: bool,
}

/// A limit cycle that a run has been shown to be on. Contacts are in the order of the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cycle {
    /// Net number of turns of each ball relative to the ring in one period, with sign; 0 for a
    /// block.
    pub turns: Vec<i32>,
    /// The sequence of phases of all contacts over one period, from an arbitrary start; neighbours
    /// differ.
    pub configurations: Vec<Vec<CyclePhase>>,
    /// The contacts that touch each other, in ascending order.
    pub touching: Vec<TouchingPair>,
    /// Least and greatest speed of each contact relative to its support: rad/s for a ball, m/s for
    /// a block.
    pub speed_extremes: Vec<[f64; 2]>,
    /// Least and greatest position of each contact: rad, each within a turn of [0, 2π), or m; `None` for a contact that
    /// revolves or moves on.
    pub position_extremes: Vec<Option<[f64; 2]>>,
    /// Share of the period for which each contact sticks.
    pub stick_fraction: Vec<f64>,
    /// Greatest displacement of the table, or of a block from the middle of its cycle, m.
    pub peak_amplitude_m: f64,
    /// Moduli of the Floquet multipliers, without those of neutral directions, descending.
    pub multipliers: Vec<f64>,
    /// Number of directions in which the cycle belongs to a continuous family: each resting ball
    /// can rest elsewhere.
    pub neutral_directions: u8,
}

impl Cycle {
    /// Returns whether the cycle belongs to a system with this number of contacts.
    pub fn is_of(&self, contacts: usize) -> bool {
        let Cycle { turns, speed_extremes, position_extremes, stick_fraction, .. } = self;
        let lengths = [turns.len(), speed_extremes.len(), position_extremes.len()];
        lengths == [contacts; 3]
            && stick_fraction.len() == contacts
            && self.configurations.iter().all(|configuration| configuration.len() == contacts)
            && self.touching.iter().all(|pair| pair.contacts[1] < contacts)
    }

    /// Returns whether a contact rests throughout the cycle.
    pub fn rests(&self, contact: usize) -> bool {
        self.configurations.iter().all(|configuration| configuration[contact] == CyclePhase::Stick)
    }
}
