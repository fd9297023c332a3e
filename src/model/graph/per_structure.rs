//! What is computed once for all systems with equal equations.

use std::any::TypeId;
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, PoisonError, RwLock};

/// The type of a system, and what its equations depend on besides the values of the inputs: names of laws, and numbers.
pub type Structure = (TypeId, Vec<&'static str>, Vec<usize>);

/// The most structures whose values are kept. There are more orders of eight balls along a ring than fit into memory.
const MOST: usize = 32;

/// The latest values of systems, by their structure.
pub struct PerStructure<T>(LazyLock<RwLock<Latest<T>>>);

/// Values with their numbers, in the order in which they were computed.
type Latest<T> = HashMap<Structure, (u64, Arc<T>)>;

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
        let known = known.map(|(_, value)| value);
        known.unwrap_or_else(|| {
            let computed = Arc::new(compute());
            let mut all = self.0.write().unwrap_or_else(PoisonError::into_inner);
            let latest = all.values().map(|(number, _)| *number).max().unwrap_or(0);
            if all.len() >= MOST {
                all.retain(|_, (number, _)| *number + MOST as u64 > latest + 1);
            }
            Arc::clone(&all.entry(structure).or_insert((latest + 1, computed)).1)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{MOST, PerStructure, TypeId};

    #[test]
    fn the_latest_values_are_kept() {
        let all = PerStructure::new();
        let get = |number: usize, value: usize| {
            *all.get(Some((TypeId::of::<u8>(), Vec::new(), vec![number])), || value)
        };
        for number in 0..3 * MOST {
            assert_eq!(get(number, number), number);
            assert_eq!(get(number, 0), number, "known");
        }
        assert_eq!(get(2 * MOST + 1, 0), 2 * MOST + 1, "one of the latest");
        assert_eq!(get(0, 7), 7, "forgotten");
        assert!(all.0.read().expect("nothing panics").len() <= MOST);
    }
}
