//! Median, mean and range of values that lie close together, in memory that does not grow with
//! their number.

use std::collections::BTreeMap;

/// Largest number of values that are counted separately.
const MOST_VALUES: usize = 512;

/// Counts by value. Medians and means are exact for up to 512 different values; above that they are
/// accurate to a hundredth of the range, unless the range spans many octaves. Range and count are
/// always exact, and nothing depends on the order of the values.
///
/// Values are counted together if they differ only in the last binary digits; the number of ignored
/// digits is the smallest that leaves at most 512 counts. Subsets never need more ignored digits,
/// so that the order of the values does not matter. (`ValueCounts` rounds relative to the value, this
/// type relative to the range.)
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SummaryStatistics {
    counts: BTreeMap<u64, u64>,
    dropped: u32,
    /// The least and the greatest value, or `None` if there are no values.
    pub ends: Option<[f64; 2]>,
}

impl SummaryStatistics {
    /// Adds a value. A non-finite value is ignored.
    pub fn add(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        // Adding 0 turns -0 into 0.
        let value = value + 0.0;
        let [least, greatest] = self.ends.get_or_insert([value; 2]);
        *least = least.min(value);
        *greatest = greatest.max(value);
        *self.counts.entry(ordered_bits(value) >> self.dropped).or_default() += 1;
        // Without 55 of the 64 digits, at most 512 different values remain.
        while self.counts.len() > MOST_VALUES {
            self.dropped += 1;
            for (key, count) in std::mem::take(&mut self.counts) {
                *self.counts.entry(key >> 1).or_default() += count;
            }
        }
    }

    /// Returns the median; the mean of the two middle values for an even count.
    pub fn median(&self) -> Option<f64> {
        let last = self.counts.values().sum::<u64>().checked_sub(1)?;
        let at = |rank: u64| {
            let mut before = 0;
            self.values().find(|(_, count)| {
                before += count;
                before > rank
            })
        };
        let ((low, _), (high, _)) = (at(last / 2)?, at(last.div_ceil(2))?);
        Some(low + 0.5 * (high - low))
    }

    /// Returns the mean.
    pub fn mean(&self) -> Option<f64> {
        let [least, greatest] = self.ends?;
        let (mut weighted, mut all) = (0.0, 0.0);
        for (value, count) in self.values() {
            // Sums of differences from the least value lose less precision.
            weighted += count as f64 * (value - least);
            all += count as f64;
        }
        Some((least + weighted / all).clamp(least, greatest))
    }

    /// Returns the values in ascending order with their counts; the middle of values counted
    /// together.
    fn values(&self) -> impl Iterator<Item = (f64, u64)> {
        let [least, greatest] = self.ends.unwrap_or([0.0; 2]);
        let middle = if self.dropped == 0 { 0 } else { 1 << (self.dropped - 1) };
        self.counts.iter().map(move |(key, &count)| {
            let value = from_ordered_bits((key << self.dropped) | middle);
            (value.clamp(least, greatest), count)
        })
    }
}

const SIGN: u64 = 1 << 63;

/// Returns bits that have the same order as the numbers.
fn ordered_bits(value: f64) -> u64 {
    let bits = value.to_bits();
    if bits & SIGN == 0 { bits | SIGN } else { !bits }
}

fn from_ordered_bits(bits: u64) -> f64 {
    f64::from_bits(if bits & SIGN == 0 { !bits } else { bits & !SIGN })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{MOST_VALUES, SummaryStatistics};

    fn statistics(values: impl IntoIterator<Item = f64>) -> SummaryStatistics {
        let mut statistics = SummaryStatistics::default();
        values.into_iter().for_each(|value| statistics.add(value));
        statistics
    }

    #[test]
    fn statistics_of_few_values_are_exact() {
        let few = statistics([4.0, -2.0, 1.0, 3.0, f64::NAN, f64::INFINITY]);
        assert_eq!((few.median(), few.mean(), few.ends), (Some(2.0), Some(1.5), Some([-2.0, 4.0])));
        let same = statistics([0.1; 7]);
        assert_eq!((same.median(), same.mean(), same.ends), (Some(0.1), Some(0.1), Some([0.1; 2])));
        let none = statistics([]);
        assert_eq!((none.median(), none.mean(), none.ends), (None, None, None));
    }

    proptest! {
        /// For thousands of values in ranges of all widths and in any order, the results agree with
        /// sorting to the stated accuracy.
        #[test]
        fn many_values_are_accurate_to_a_part_of_their_range(
            middle in 1.0..4.0_f64,
            negative: bool,
            digits in 0.3..14.0_f64,
            fractions in prop::collection::vec(-1.0..1.0_f64, 600..3000),
        ) {
            let middle = if negative { -middle } else { middle };
            let width = 10_f64.powf(-digits);
            let mut values: Vec<f64> = fractions.iter().map(|fraction| middle + width * fraction).collect();
            let found = statistics(values.iter().copied());
            prop_assert!(found.counts.len() <= MOST_VALUES);
            prop_assert_eq!(&found, &statistics(values.iter().rev().copied()));
            values.sort_by(f64::total_cmp);
            let count = values.len();
            let median = 0.5 * (values[(count - 1) / 2] + values[count / 2]);
            let mean = values.iter().map(|value| value - middle).sum::<f64>() / count as f64 + middle;
            prop_assert_eq!(found.ends, Some([values[0], values[count - 1]]));
            let allowed = 0.01 * (values[count - 1] - values[0]) + 1e-15;
            prop_assert!((found.median().unwrap() - median).abs() < allowed);
            prop_assert!((found.mean().unwrap() - mean).abs() < allowed);
        }
    }
}
