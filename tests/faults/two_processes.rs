//! Two processes with the same results directory.

use super::{finished, study};
use crate::cli::support::Scratch;

#[test]
fn the_second_process_is_refused() {
    let scratch = Scratch::new();
    let long = study().replace("samples: 3200", "samples: 2000000");
    scratch.write("a.yaml", long);
    let mut first = scratch.command("run a.yaml --out out --chunk 64").spawn().unwrap();
    while finished(&scratch.path("out")).len() < 2 {
        assert!(first.try_wait().unwrap().is_none());
        std::thread::yield_now();
    }
    for command in ["run a.yaml --out out", "resume out"] {
        let second = scratch.stickslip(command);
        assert_eq!((second.code, second.out.as_str()), (Some(1), ""), "{}", second.err);
        let busy = "out: another process is writing into this directory";
        assert!(
            second.err.contains(busy) && second.err.contains("allowed: wait"),
            "{}",
            second.err
        );
    }
    assert!(first.try_wait().unwrap().is_none());
    first.kill().unwrap();
    first.wait().unwrap();
    // The lock is released with the process, however it ended.
    scratch.ended("resume out --max-seconds 0", 130);
}
