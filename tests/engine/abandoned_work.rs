//! Work on a pool that a stop abandons.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::thread;
use std::time::{Duration, Instant};

use stickslip::engine::WorkerPool;

#[test]
fn a_stop_abandons_work_within_a_second() {
    let workers = WorkerPool::new(1).unwrap();
    let stop = AtomicBool::new(false);
    assert_eq!(workers.unless_stopped(&stop, || 6 * 7), Some(42));
    let (begin, begun) = channel();
    let (release, released) = channel::<()>();
    let elapsed = thread::scope(|scope| {
        let waiting = scope.spawn(|| {
            // Ends only when the test ends.
            let work = move || {
                begin.send(()).unwrap();
                released.recv()
            };
            let stopped = workers.unless_stopped(&stop, work).is_none();
            (stopped, Instant::now())
        });
        begun.recv().unwrap();
        let begin = Instant::now();
        stop.store(true, Ordering::Relaxed);
        let (stopped, end) = waiting.join().unwrap();
        assert!(stopped);
        end - begin
    });
    assert!(elapsed < Duration::from_secs(1), "{elapsed:?}");
    drop(release);
}

#[test]
fn a_panic_of_the_work_reaches_the_caller() {
    let workers = WorkerPool::new(1).unwrap();
    let work = || workers.unless_stopped(&AtomicBool::new(false), || panic!("expected"));
    let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(work));
    let payload = caught.err().unwrap();
    assert_eq!(payload.downcast_ref::<&str>(), Some(&"expected"));
}
