//! The components of a state of any system in all lanes.

use smallvec::SmallVec;

use crate::motion::lockstep::Lanes;
use crate::motion::lockstep::vector::Vector;

/// The components of a state in all lanes, with the sliding speeds.
pub(in crate::motion::lockstep) struct RecordedLaneStates<S: Vector> {
    pub(super) components: SmallVec<[Lanes<S>; 12]>,
    /// Those of all contacts, unless each speed is a component.
    pub(super) speeds: SmallVec<[Lanes<S>; 2]>,
}

impl<S: Vector> Clone for RecordedLaneStates<S> {
    fn clone(&self) -> Self {
        RecordedLaneStates { components: self.components.clone(), speeds: self.speeds.clone() }
    }

    /// Copies a state of the same system.
    fn clone_from(&mut self, source: &Self) {
        self.components.copy_from_slice(&source.components);
        self.speeds.copy_from_slice(&source.speeds);
    }
}
