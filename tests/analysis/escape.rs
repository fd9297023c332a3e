//! Escape rates of simulated runs, and exact intervals of rates.

use crate::support::TestRng;
use stickslip::analysis::{ValueCounts, escape_rate, rate_interval};

/// Returns runs with these times to rest, stopped at an end time.
fn groups(times: impl Iterator<Item = f64>, end: f64) -> Vec<(f64, [u64; 2])> {
    let mut counts = ValueCounts::default();
    times.for_each(|time| counts.add(time.min(end), usize::from(time >= end)));
    counts.groups().collect()
}

/// The limits agree with closed forms (one event: lower end `-ln 0.975`; none: upper end `-ln
/// 0.025`) and with Garwood's table for 10 events (4.795 and 18.39).
#[test]
fn limits_agree_with_garwoods_table() {
    let near = |found: f64, expected: f64, within: f64| {
        assert!((found / expected - 1.0).abs() < within, "{found} {expected}");
    };
    near(rate_interval(1, 1.0).0, -0.975_f64.ln(), 1e-9);
    assert_eq!(rate_interval(0, 1.0).0, 0.0);
    near(rate_interval(0, 2.0).1, -0.025_f64.ln() / 2.0, 1e-9);
    near(rate_interval(10, 1.0).0, 4.795, 1e-4);
    near(rate_interval(10, 1.0).1, 18.39, 1e-3);
    // For a million events the interval is that of the normal distribution.
    let (low, high) = rate_interval(1_000_000, 1e6);
    near(low, 1.0 - 1.96e-3, 1e-5);
    near(high, 1.0 + 1.96e-3, 1e-5);
}

/// The test rejects one in ten exponential samples, whether all runs come to rest, half of them
/// or few: the tail of a sample that is not rejected starts at time 0.
#[test]
fn the_test_rejects_one_in_ten_exponential_samples() {
    let mut draws = TestRng::new(1);
    for (runs, end) in [(12, f64::MAX), (100, f64::MAX), (100, 0.7), (400, 0.1)] {
        let repetitions = 4000;
        let rejected = (0..repetitions).filter(|_| {
            let sample = groups((0..runs).map(|_| draws.exponential(1.0)), end);
            escape_rate(&sample).is_none_or(|escape| escape.from_s > 0.0)
        });
        let fraction = rejected.count() as f64 / f64::from(repetitions);
        // Five standard deviations of the count.
        assert!((fraction - 0.1).abs() < 0.024, "{runs} runs to {end}: {fraction}");
    }
}

/// The interval contains the rate of the tail: if the tail starts at 0, if nothing rests before
/// 1.5 s, and if half of the runs rest within 2 s by another law. The nominal level is 95 %;
/// the search for the start of the tail reduces the coverage, because deviations below the
/// power of the test remain in the tail.
#[test]
fn the_interval_covers_the_rate_of_the_tail() {
    let mut draws = TestRng::new(2);
    for (name, runs, end, soon, late, least) in [
        ("all tail", 200, 16.5, 0.0, 0.0, 0.92),
        ("few", 60, 5.0, 0.0, 0.0, 0.92),
        ("late", 768, 16.5, 0.0, 1.5, 0.92),
        ("mixed", 768, 16.5, 0.5, 0.0, 0.88),
        ("mixed, all at rest", 768, f64::MAX, 0.5, 0.0, 0.88),
        ("mixed, many", 20_000, 16.5, 0.5, 0.0, 0.88),
    ] {
        let repetitions = 500;
        let (mut held, mut found, mut from) = (0.0, 0.0, 0.0);
        for _ in 0..repetitions {
            let times: Vec<f64> = (0..runs)
                .map(|_| match draws.uniform() < soon {
                    true => 2.0 * draws.uniform().max(draws.uniform()),
                    false => late + draws.exponential(0.2),
                })
                .collect();
            if let Some(escape) = escape_rate(&groups(times.into_iter(), end)) {
                let (low, high) = escape.interval_per_s;
                assert!(low < escape.rate_per_s && escape.rate_per_s < high);
                found += 1.0;
                from += escape.from_s;
                held += f64::from(u8::from(low <= 0.2 && 0.2 <= high));
            }
        }
        let (fraction, from) = (held / found, from / found);
        println!("{name}: found {found} of {repetitions}, held {fraction}, from {from:.3} s");
        assert!(found > 0.98 * f64::from(repetitions) && fraction > least, "{name}");
        let start = if soon > 0.0 { 2.0 } else { late };
        assert!((start - 0.1..start + 1.0).contains(&from), "{name}: {from}");
    }
}

/// There is no tail if the rate of rests increases, or with too few rests, rests at a single
/// time, no rests, or no runs.
#[test]
fn without_exponential_tail_there_is_no_rate() {
    let ever_faster = |i: u32| (f64::from(i) / 2000.0).powf(0.2);
    assert_eq!(escape_rate(&groups((1..=2000).map(ever_faster), f64::MAX)), None);
    assert_eq!(escape_rate(&groups((1..=9).map(f64::from), f64::MAX)), None);
    assert_eq!(escape_rate(&[(3.0, [1000, 0])]), None);
    assert_eq!(escape_rate(&[(0.0, [1000, 0])]), None);
    assert_eq!(escape_rate(&[(16.5, [0, 1000])]), None);
    assert_eq!(escape_rate(&[]), None);
}

/// A million runs are counted in groups; the grouping alone does not reject a constant rate.
#[test]
fn a_million_grouped_runs_keep_their_rate() {
    let runs = 1_000_000;
    let time = |i: u32| -(1.0 - (f64::from(i) + 0.5) / f64::from(runs)).ln() / 0.2;
    let escape = escape_rate(&groups((0..runs).map(time), 16.5)).expect("a tail");
    assert_eq!(escape.from_s, 0.0);
    assert!((escape.rate_per_s / 0.2 - 1.0).abs() < 2e-4, "{escape:?}");
    assert!((escape.interval_per_s.1 / escape.interval_per_s.0 - 1.0).abs() < 5e-3);
}
