//! Cancellation: computations that can be stopped from outside between two integration steps.
//!
//! Integrations are nested: a run whose orbit appears to close integrates its return map, and a run
//! that is slow at its end time is followed for a while. A cancelled computation therefore unwinds
//! through all of them to its outermost caller, so that no level in between can mistake a partial
//! computation for a result. Without a cancellation, computations are unaffected.

use std::any::Any;
use std::cell::RefCell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

thread_local! {
    /// The cancellation of the computation on this thread.
    static CURRENT: RefCell<Option<Cancellation>> = const { RefCell::new(None) };
}

/// Cancels computations, on any thread.
#[derive(Clone, Debug, Default)]
pub struct Cancellation(Arc<AtomicBool>);

/// The payload with which a cancelled computation unwinds.
struct Cancelled;

impl Cancellation {
    /// Cancels all current and future computations under this cancellation.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Runs `work` on this thread and returns its result, or `None` if it was cancelled. Changes
    /// that `work` made before remain: it is cancelled only between two steps of an integration.
    pub fn unless_cancelled<T>(&self, work: impl FnOnce() -> T) -> Option<T> {
        let before = CURRENT.replace(Some(self.clone()));
        let done = panic::catch_unwind(AssertUnwindSafe(work));
        CURRENT.set(before);
        match done {
            Ok(done) => Some(done),
            Err(payload) if is_cancelled(payload.as_ref()) => None,
            Err(payload) => panic::resume_unwind(payload),
        }
    }
}

/// Returns whether a panic payload is that of a cancelled computation, which must unwind further.
pub fn is_cancelled(payload: &(dyn Any + Send)) -> bool {
    payload.is::<Cancelled>()
}

/// Must be called between steps: unwinds if the computation of this thread has been cancelled. This
/// is not a panic, and no panic hook is called.
#[inline]
pub(crate) fn unwind_if_cancelled() {
    let is_set = |current: &Cancellation| current.0.load(Ordering::Relaxed);
    if CURRENT.with_borrow(|current| current.as_ref().is_some_and(is_set)) {
        unwind();
    }
}

#[cold]
fn unwind() -> ! {
    panic::resume_unwind(Box::new(Cancelled))
}

#[cfg(test)]
mod tests {
    use super::{Cancellation, unwind_if_cancelled};

    #[test]
    fn only_what_goes_on_under_a_cancellation_is_cancelled() {
        let [outer, inner] = [Cancellation::default(), Cancellation::default()];
        unwind_if_cancelled();
        let mut steps = 0;
        let outcome = outer.unless_cancelled(|| {
            let nested = inner.unless_cancelled(|| {
                inner.cancel();
                unwind_if_cancelled();
                unreachable!("it has been cancelled")
            });
            assert!(nested.is_none());
            unwind_if_cancelled();
            steps += 1;
            outer.cancel();
            unwind_if_cancelled();
            steps += 1;
        });
        assert_eq!((outcome, steps), (None, 1));
        unwind_if_cancelled();
        assert_eq!(Cancellation::default().unless_cancelled(|| 7), Some(7));
    }
}
