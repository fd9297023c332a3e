//! The median time to rest with runs that never rest.

use stickslip::analysis::{RunResult, Sample, median_time_to_rest};
use stickslip::classification::Label;

fn sample(rests: u32, cycles: u32) -> Sample {
    let rest = |time: u32| RunResult {
        cell: 0,
        label: Label::Equilibrium,
        amplitude: None,
        time_to_rest_s: Some(f64::from(time)),
        end_time_s: None,
    };
    let cycle = RunResult { label: Label::LimitCycle, time_to_rest_s: None, ..rest(0) };
    let runs = (1..=rests).map(rest).chain((0..cycles).map(|_| cycle)).collect();
    Sample { cells: None, runs }
}

#[test]
fn by_hand() {
    let found = median_time_to_rest(&sample(100, 0));
    assert_eq!(found.value, Some(50.0));
    assert!(found.low < Some(45.0) && found.high > Some(55.0) && found.reason.is_none());
    // 60 of 100 at rest: the median is the 50th of all; cycles never rest.
    assert_eq!(median_time_to_rest(&sample(60, 40)).value, Some(50.0));
    let few = median_time_to_rest(&sample(20, 80));
    assert_eq!(
        (few.value, few.reason.as_deref()),
        (None, Some("less than half of the runs come to rest"))
    );
    let none = median_time_to_rest(&sample(0, 5));
    assert_eq!((none.value, none.reason.as_deref()), (None, Some("no run came to rest")));
}
