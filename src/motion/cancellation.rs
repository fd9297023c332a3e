//! Cancellation: computations that can be given up from outside, between any two integration steps.
//!
//! Integrations are nested: a run whose orbit seems to close integrates its return map, and a run that is slow at
//! its end time is followed on for a while. A cancelled computation therefore unwinds through all of them to the
//! place where it was begun, so that no level in between can take what was cut short for a result. A computation
//! that is not cancelled is the same as without this.

use std::any::Any;
use std::cell::RefCell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

thread_local! {
    /// What cancels the computation of this thread.
    static CURRENT: RefCell<Option<Cancellation>> = const { RefCell::new(None) };
}

/// Cancels computations, on any thread.
#[derive(Clone, Debug, Default)]
pub struct Cancellation(Arc<AtomicBool>);

/// What a cancelled computation unwinds with.
struct Cancelled;

impl Cancellation {
    /// Cancels the computations that have been begun under this, and those that will be.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Does `work` on this thread, and gives none where it was cancelled meanwhile. What `work` has changed up to
    /// then stays changed: it is cancelled between two steps of an integration and nowhere else.
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

/// Whether what a computation unwinds with says that it was cancelled; it must then unwind further.
pub fn is_cancelled(payload: &(dyn Any + Send)) -> bool {
    payload.is::<Cancelled>()
}

/// To be called between steps: unwinds where the computation of this thread has been cancelled. This is no panic,
/// and no panic hook sees it.
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
