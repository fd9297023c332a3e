//! What is computed once for all systems with equal equations.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, PoisonError, RwLock};

use crate::model::Structure;

/// The values of systems, by their structure.
pub struct PerStructure<T>(LazyLock<RwLock<HashMap<Structure, Arc<T>>>>);

impl<T> PerStructure<T> {
    /// Returns a collection without values.
    pub const fn new() -> Self {
        PerStructure(LazyLock::new(RwLock::default))
    }

    /// Returns the value of systems with this structure, which is computed unless it is known; for a system without a
    /// structure, a value of its own. Nothing is locked while a value is computed; of several threads that compute the same
    /// one, the first determines it.
    pub fn get(&self, structure: Option<Structure>, compute: impl FnOnce() -> T) -> Arc<T> {
        let Some(structure) = structure else { return Arc::new(compute()) };
        // A panic while the values are locked leaves them complete.
        let known = self.0.read().unwrap_or_else(PoisonError::into_inner).get(&structure).cloned();
        known.unwrap_or_else(|| {
            let computed = Arc::new(compute());
            let mut all = self.0.write().unwrap_or_else(PoisonError::into_inner);
            Arc::clone(all.entry(structure).or_insert(computed))
        })
    }
}
