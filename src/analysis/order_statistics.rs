//! Median, mean and range of values that lie close together, in memory that does not grow with
//! their number.

use std::collections::BTreeMap;

/// Most values that are kept apart.
const MOST_VALUES: usize = 512;

/// Counts by value: exact up to 512 different values, beyond that to a hundredth of their range or
/// less, unless that spans many octaves. Range and count are always exact, and everything depends
/// on the values alone, not on their order.
///
/// Values are counted together that agree but for some of the last binary digits: as few as bring
/// the counts down to 512. Fewer values would never take more, so that the order in which they came
/// does not matter. (`Tally` rounds to a part of the values, this one to a part of their range.)
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OrderStatistics {
    counts: BTreeMap<u64, u64>,
    dropped: u32,
    ends: Option<[f64; 2]>,
}

impl OrderStatistics {
    /// Takes a value in; one that is not finite is left out.
    pub fn add(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        // Adding 0 makes -0 to 0.
        let value = value + 0.0;
        let [least, greatest] = self.ends.get_or_insert([value; 2]);
        *least = least.min(value);
        *greatest = greatest.max(value);
        *self.counts.entry(ordered_bits(value) >> self.dropped).or_default() += 1;
        // Without 55 of 64 digits, no more than 512 values are left to differ.
        while self.counts.len() > MOST_VALUES {
            self.dropped += 1;
            for (key, count) in std::mem::take(&mut self.counts) {
                *self.counts.entry(key >> 1).or_default() += count;
            }
        }
    }

    /// The least and the greatest value; none of nothing.
    pub fn ends(&self) -> Option<[f64; 2]> {
        self.ends
    }

    /// The value in the middle, or the mean of the two there.
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

    /// The mean.
    pub fn mean(&self) -> Option<f64> {
        let [least, greatest] = self.ends?;
        let (mut weighted, mut all) = (0.0, 0.0);
        for (value, count) in self.values() {
            // From the least value on, sums lose less.
            weighted += count as f64 * (value - least);
            all += count as f64;
        }
        Some((least + weighted / all).clamp(least, greatest))
    }

    /// Values in ascending order with their counts: the middle of those counted together.
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

/// Bits that are ordered as the numbers are.
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

    use super::{MOST_VALUES, OrderStatistics};

    fn spread(values: impl IntoIterator<Item = f64>) -> OrderStatistics {
        let mut spread = OrderStatistics::default();
        values.into_iter().for_each(|value| spread.add(value));
        spread
    }

    #[test]
    fn few_values_are_exact() {
        let few = spread([4.0, -2.0, 1.0, 3.0, f64::NAN, f64::INFINITY]);
        assert_eq!(
            (few.median(), few.mean(), few.ends()),
            (Some(2.0), Some(1.5), Some([-2.0, 4.0]))
        );
        let same = spread([0.1; 7]);
        assert_eq!(
            (same.median(), same.mean(), same.ends()),
            (Some(0.1), Some(0.1), Some([0.1; 2]))
        );
        let none = spread([]);
        assert_eq!((none.median(), none.mean(), none.ends()), (None, None, None));
    }

    proptest! {
        /// Against sorting, for thousands of values in ranges of all widths, and in another order.
        #[test]
        fn many_values_to_a_part_of_their_range(
            middle in 1.0..4.0_f64,
            negative: bool,
            digits in 0.3..14.0_f64,
            fractions in prop::collection::vec(-1.0..1.0_f64, 600..3000),
        ) {
            let middle = if negative { -middle } else { middle };
            let width = 10_f64.powf(-digits);
            let mut values: Vec<f64> = fractions.iter().map(|fraction| middle + width * fraction).collect();
            let found = spread(values.iter().copied());
            prop_assert!(found.counts.len() <= MOST_VALUES);
            prop_assert_eq!(&found, &spread(values.iter().rev().copied()));
            values.sort_by(f64::total_cmp);
            let count = values.len();
            let median = 0.5 * (values[(count - 1) / 2] + values[count / 2]);
            let mean = values.iter().map(|value| value - middle).sum::<f64>() / count as f64 + middle;
            prop_assert_eq!(found.ends(), Some([values[0], values[count - 1]]));
            let allowed = 0.01 * (values[count - 1] - values[0]) + 1e-15;
            prop_assert!((found.median().unwrap() - median).abs() < allowed);
            prop_assert!((found.mean().unwrap() - mean).abs() < allowed);
        }
    }
}
