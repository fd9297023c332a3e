//! Counts by value, in memory that does not grow with the number of values.

use std::collections::BTreeMap;

use super::interval::interval_ranks;

/// Counts of each value, in two kinds.
///
/// Exact for at most 65,536 different values. Above that, values that agree in 11 binary digits are
/// counted together at their midpoint (within a relative distance of 2.5e-4). The result does not
/// depend on the order of the values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ValueCounts {
    groups: BTreeMap<u64, [u64; 2]>,
    coarse: bool,
}

/// Largest number of different values that are counted separately.
const MOST_VALUES: usize = 1 << 16;
/// Number of binary digits that a coarse value drops: 52 are stored, 11 remain.
const DROPPED: u32 = 41;

impl ValueCounts {
    /// Counts a value of a kind, 0 or 1. The value must be zero, positive or infinite; others are
    /// ignored.
    pub fn add(&mut self, value: f64, kind: usize) {
        // The bits of such numbers have the same order as the numbers; adding 0 turns -0 into 0.
        let value = value + 0.0;
        if value.is_nan() || value < 0.0 {
            return;
        }
        let key = if self.coarse { coarse(value.to_bits()) } else { value.to_bits() };
        self.groups.entry(key).or_default()[kind] += 1;
        if !self.coarse && self.groups.len() > MOST_VALUES {
            self.coarse = true;
            for (key, counts) in std::mem::take(&mut self.groups) {
                let group = self.groups.entry(coarse(key)).or_default();
                group[0] += counts[0];
                group[1] += counts[1];
            }
        }
    }

    /// Returns the values in ascending order, each with its counts.
    pub fn groups(&self) -> impl Iterator<Item = (f64, [u64; 2])> + Clone {
        self.groups.iter().map(|(key, counts)| (f64::from_bits(*key), *counts))
    }

    /// Returns the quantile of the values of both kinds, linear between order statistics (type 7 of
    /// Hyndman and Fan), or `None` if there are no values.
    pub fn quantile(&self, fraction: f64) -> Option<f64> {
        interpolated_quantile(self.count(), fraction, |rank| self.order_statistic(rank))
    }

    /// Returns the 95 % interval of the quantile, between two of the values; an end is `None` if the values do not bound
    /// it.
    pub fn quantile_interval(&self, fraction: f64) -> [Option<f64>; 2] {
        let ranks = interval_ranks(self.count(), fraction);
        ranks.map(|rank| rank.and_then(|rank| self.order_statistic(rank)))
    }

    fn count(&self) -> u64 {
        self.groups.values().flatten().sum()
    }

    /// Returns the value of a rank, counted from 0.
    fn order_statistic(&self, rank: u64) -> Option<f64> {
        let mut up_to = 0;
        let mut values = self.groups();
        let at_rank = values.find(|(_, counts)| {
            up_to += counts[0] + counts[1];
            up_to > rank
        });
        at_rank.map(|(value, _)| value)
    }
}

/// Returns a quantile of a number of values by linear interpolation between order statistics (type
/// 7 of Hyndman and Fan, Am. Stat. 50 (1996) 361, doi:10.1080/00031305.1996.10473566), or `None` if
/// there are no values. `order_statistic` returns the value of a rank, counted from 0.
pub(crate) fn interpolated_quantile(
    count: u64,
    fraction: f64,
    order_statistic: impl Fn(u64) -> Option<f64>,
) -> Option<f64> {
    let position = fraction * count.checked_sub(1)? as f64;
    let low = order_statistic(position.floor() as u64)?;
    let high = order_statistic(position.ceil() as u64)?;
    let part = position - position.floor();
    Some(if part == 0.0 { low } else { low + part * (high - low) })
}

/// Returns the bits of the midpoint of the values that agree with this one in the remaining digits.
fn coarse(bits: u64) -> u64 {
    if f64::from_bits(bits).is_infinite() {
        return bits;
    }
    (bits >> DROPPED << DROPPED) | (1 << (DROPPED - 1))
}
