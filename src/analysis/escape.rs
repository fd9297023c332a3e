//! Escape from irregular motion: the constant rate at which runs come to rest in an exponential
//! tail.
//!
//! Transient chaos loses the memory of its start, so that the number of moving runs finally decays
//! exponentially (Y.-C. Lai, T. Tél, Transient Chaos, Springer 2011,
//! doi:10.1007/978-1-4419-6987-3). The tail starts at the earliest time after which a test does not
//! reject an exponential distribution, and the rate is estimated from the runs in the tail.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Runs that came to rest, and runs that were stopped, at a time in s.
pub(super) type EndedRuns = (f64, [u64; 2]);

/// The rate of an exponential tail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EscapeRate {
    /// Number of runs that come to rest over the total time that runs have moved, 1/s.
    pub rate_per_s: f64,
    /// 95 % interval of the rate, 1/s.
    pub interval_per_s: (f64, f64),
    /// Start of the tail, s.
    pub from_s: f64,
}

/// Smallest number of runs that come to rest in a tail.
const FEWEST: u64 = 10;
/// A tail contains at least one in this many of the runs that come to rest: the last few of any
/// distribution look exponential.
const FRACTION: u64 = 10;
/// The 90 % quantile of the test statistic (Kolmogorov's) for exponential samples.
const CRITICAL: f64 = 1.224;

/// Returns the escape rate of groups at ascending times; `None` if no tail is exponential or too
/// few runs come to rest.
///
/// The first tail starts at time 0; each further one starts after a tenth of the rests of the tail
/// before. Runs at rest at the start of a tail do not count in it.
pub fn escape_rate(groups: &[EndedRuns]) -> Option<EscapeRate> {
    let rests = |groups: &[EndedRuns]| groups.iter().map(|(_, [rests, _])| rests).sum::<u64>();
    let mut tail = &groups[groups.partition_point(|(time, _)| *time <= 0.0)..];
    let mut remaining = rests(tail);
    let fewest = FEWEST.max(remaining.div_ceil(FRACTION));
    let mut from_s = 0.0;
    while remaining >= fewest {
        let candidate = ExponentialTail::new(tail, from_s);
        if candidate.is_exponential() {
            return Some(EscapeRate {
                rate_per_s: remaining as f64 / candidate.exposure_s,
                interval_per_s: rate_interval(remaining, candidate.exposure_s),
                from_s,
            });
        }
        let enough = remaining - remaining.div_ceil(10);
        while remaining > enough {
            let ((time, [rests, _]), others) = tail.split_first()?;
            (from_s, remaining, tail) = (*time, remaining - rests, others);
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
struct ExponentialTail<'a> {
    groups: &'a [EndedRuns],
    from_s: f64,
    runs: u64,
    rests: u64,
    exposure_s: f64,
}

impl<'a> ExponentialTail<'a> {
    fn new(groups: &'a [EndedRuns], from_s: f64) -> Self {
        let mut tail = ExponentialTail { groups, from_s, runs: 0, rests: 0, exposure_s: 0.0 };
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
