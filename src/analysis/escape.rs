//! Escape from irregular motion: the constant rate at which runs come to rest in an exponential
//! tail.
//!
//! Transient chaos loses the memory of its start, so that the number of moving runs finally decays
//! exponentially (Y.-C. Lai, T. Tél, Transient Chaos, Springer 2011,
//! doi:10.1007/978-1-4419-6987-3). The tail starts at the earliest time after which a test does not
//! reject an exponential distribution, and the rate is estimated from the runs in the tail.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Runs that came to rest, and runs that were stopped, at a time in s.
pub type Group = (f64, [u64; 2]);

/// The rate of an exponential tail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EscapeRate {
    /// Number of runs that come to rest over the total time that runs have moved, 1/s.
    pub rate_per_s: f64,
    /// 95 % interval of the rate, 1/s.
    pub interval_1_s: (f64, f64),
    /// Start of the tail, s.
    pub from_s: f64,
}

/// Smallest number of runs that come to rest in a tail.
pub const FEWEST: u64 = 10;
/// A tail contains at least one in this many of the runs that come to rest: the last few of any
/// distribution look exponential.
pub const FRACTION: u64 = 10;
/// The 90 % quantile of the test statistic (Kolmogorov's) for exponential samples.
const CRITICAL: f64 = 1.224;

/// Returns the escape rate of groups at ascending times; `None` if no tail is exponential or too
/// few runs come to rest.
///
/// The first tail starts at time 0; each further one starts after a tenth of the rests of the tail
/// before. Runs at rest at the start of a tail do not count in it.
pub fn escape_rate(groups: &[Group]) -> Option<EscapeRate> {
    let rests = |groups: &[Group]| groups.iter().map(|(_, [rests, _])| rests).sum::<u64>();
    let mut tail = &groups[groups.partition_point(|(time, _)| *time <= 0.0)..];
    let mut left = rests(tail);
    let fewest = FEWEST.max(left.div_ceil(FRACTION));
    let mut from_s = 0.0;
    while left >= fewest {
        let tried = Tail::new(tail, from_s);
        if tried.is_exponential() {
            return Some(EscapeRate {
                rate_per_s: left as f64 / tried.exposure_s,
                interval_1_s: rate_interval(left, tried.exposure_s),
                from_s,
            });
        }
        let enough = left - left.div_ceil(10);
        while left > enough {
            let ((time, [rests, _]), others) = tail.split_first()?;
            (from_s, left, tail) = (*time, left - rests, others);
        }
    }
    None
}

/// Returns the exact 95 % interval of a rate from a number of events in an exposure, as for a
/// Poisson count. If the events end the exposure, the interval is also valid, but wider by one
/// event.
///
/// Source: F. Garwood, Biometrika 28 (1936) 437, doi:10.1093/biomet/28.3-4.437.
pub fn rate_interval(events: u64, exposure: f64) -> (f64, f64) {
    let end = |fraction: f64, count: u64| {
        let half = |law: ChiSquared| law.inverse_cdf(fraction) / 2.0;
        // A count of 0 has no chi-square distribution; its lower end is 0.
        ChiSquared::new(2.0 * count as f64).map_or(0.0, half) / exposure
    };
    (end(0.025, events), end(0.975, events + 1))
}

/// The runs that still move after a time.
struct Tail<'a> {
    groups: &'a [Group],
    from_s: f64,
    runs: u64,
    rests: u64,
    exposure_s: f64,
}

impl<'a> Tail<'a> {
    fn new(groups: &'a [Group], from_s: f64) -> Self {
        let mut tail = Tail { groups, from_s, runs: 0, rests: 0, exposure_s: 0.0 };
        for (time, [rests, stopped]) in groups {
            tail.runs += rests + stopped;
            tail.rests += rests;
            tail.exposure_s += (rests + stopped) as f64 * (time - from_s);
        }
        tail
    }

    /// Returns whether Kolmogorov's test does not reject a constant rate. On the scale of the total
    /// time that all runs have moved, rests at a constant rate are uniformly distributed (total
    /// time on test: R. E. Barlow, R. Campo, in Reliability and Fault Tree Analysis, SIAM 1975, p.
    /// 451). The critical value holds for any number of rests (M. A. Stephens, J. Am. Stat. Assoc.
    /// 69 (1974) 730, doi:10.1080/01621459.1974.10480196).
    fn is_exponential(&self) -> bool {
        // A rest that ends the exposure lies at its end by definition and carries no information.
        let ends =
            self.groups.last().is_some_and(|(_, [rests, stopped])| *rests > 0 && *stopped == 0);
        let count = (self.rests - u64::from(ends)) as f64;
        let (mut moving, mut clock, mut before, mut rested) = (self.runs, 0.0, self.from_s, 0);
        let mut farthest = 0.0_f64;
        for (index, (time, [rests, stopped])) in self.groups.iter().enumerate() {
            clock += moving as f64 * (time - before);
            if *rests > 0 {
                // Values that were counted together scatter around the middle of their group.
                let after = self.groups.get(index + 1).map_or(*time, |(time, _)| *time);
                let near = |gap: f64| if *rests == 1 { 0.0 } else { gap.min(COARSE * time) };
                let early = clock - moving as f64 * near((time - before) / 2.0);
                let late = clock + (moving - rests) as f64 * near((after - time) / 2.0);
                farthest = farthest.max((early / self.exposure_s - rested as f64 / count).abs());
                rested += rests;
                let fraction = (rested as f64 / count).min(1.0);
                farthest = farthest.max((late / self.exposure_s - fraction).abs());
            }
            moving -= rests + stopped;
            before = *time;
        }
        let root = count.sqrt();
        farthest * (root + 0.12 + 0.11 / root) <= CRITICAL
    }
}

/// Largest relative distance of a value from the middle of its group.
const COARSE: f64 = 2.5e-4;

#[cfg(test)]
mod tests {
    use super::{Group, Tail, escape_rate, rate_interval};
    use crate::analysis::ValueCounts;
    use crate::analysis::test_rng::TestRng;

    /// Returns runs with these times to rest, stopped at an end time.
    fn groups(times: impl Iterator<Item = f64>, end: f64) -> Vec<Group> {
        let mut tally = ValueCounts::default();
        times.for_each(|time| tally.add(time.min(end), usize::from(time >= end)));
        tally.groups().collect()
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
    /// or few.
    #[test]
    fn the_test_rejects_one_in_ten_exponential_samples() {
        let mut draws = TestRng::new(1);
        for (runs, end) in [(12, f64::MAX), (100, f64::MAX), (100, 0.7), (400, 0.1)] {
            let repetitions = 4000;
            let refused = (0..repetitions).filter(|_| {
                let sample = groups((0..runs).map(|_| draws.exponential(1.0)), end);
                !Tail::new(&sample, 0.0).is_exponential()
            });
            let fraction = refused.count() as f64 / f64::from(repetitions);
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
                    let (low, high) = escape.interval_1_s;
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
        assert!((escape.interval_1_s.1 / escape.interval_1_s.0 - 1.0).abs() < 5e-3);
    }
}
