//! Equally spaced values on the command line: `FROM:TO:COUNT`.

use std::ops::RangeInclusive;

/// The largest number of times, and of rows of a replay.
pub const MOST_TIMES: u32 = 1_000_000;
/// The largest number of speeds.
const MOST_SPEEDS: u32 = 100_000;

/// Two ends and the number of values: speeds in rad/s in either order, or times in s in ascending order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvenRange {
    from: f64,
    to: f64,
    /// The number of values.
    pub count: u32,
    is_time: bool,
}

/// The limits of a range, and the words of its error messages.
struct RangeLimits {
    /// The values, as `speeds`.
    name: &'static str,
    ends: RangeInclusive<f64>,
    /// The allowed ends in words.
    allowed_ends: &'static str,
    most: u32,
    ascending: bool,
    example: &'static str,
}

impl EvenRange {
    /// Parses `FROM:TO:COUNT`.
    fn parse(text: &str, limits: &RangeLimits) -> Result<Self, String> {
        let RangeLimits { name, ends, allowed_ends, most, ascending, example } = limits;
        let refused = |found: String, allowed: &str| {
            Err(format!("found {found}, allowed: {allowed}, as in {example}"))
        };
        let parts: Vec<&str> = text.split(':').collect();
        let [from, to, count] = parts.as_slice() else {
            let allowed = format!("two {name} and their number with colons between");
            return refused(format!("{text:?}"), &allowed);
        };
        let end = |text: &str| text.trim().parse().ok().filter(|end| ends.contains(end));
        let (Some(from), Some(to)) = (end(from), end(to)) else {
            return refused(format!("the {name} {from:?} and {to:?}"), allowed_ends);
        };
        let number = count.trim().parse().ok().filter(|count| (1..=*most).contains(count));
        let Some(count) = number else {
            let allowed = format!("a whole number from 1 to {most}");
            return refused(format!("the number of {name} {count:?}"), &allowed);
        };
        if (*ascending && from > to) || (from == to) != (count == 1) {
            let order = if *ascending { "FROM below TO" } else { "different FROM and TO" };
            let allowed = format!("two or more {name} with {order}, or one with equal FROM and TO");
            let unit = if *ascending { " s" } else { "" };
            return refused(format!("{count} {name} from {from} to {to}{unit}"), &allowed);
        }
        Ok(EvenRange { from, to, count, is_time: *ascending })
    }

    /// Returns all values; the ends are exactly the given numbers.
    pub fn values(&self) -> impl Iterator<Item = f64> + use<> {
        let EvenRange { from, to, count, is_time } = *self;
        // 1 if there is only one value.
        let last = f64::from(count.max(2) - 1);
        (0..count).map(f64::from).map(move |place| match place {
            place if !is_time => (from * (last - place) + to * place) / last,
            0.0 => from,
            place if place == last => to,
            place => from + (to - from) * (place / last),
        })
    }
}

/// Parses speeds in rad/s.
pub fn speeds(text: &str) -> Result<EvenRange, String> {
    let limits = RangeLimits {
        name: "speeds",
        ends: -1e9..=1e9,
        allowed_ends: "numbers up to 1e9",
        most: MOST_SPEEDS,
        ascending: false,
        example: "-150:-300:151 (FROM:TO:COUNT in rad/s)",
    };
    EvenRange::parse(text, &limits)
}

/// Parses times in s.
pub fn times(text: &str) -> Result<EvenRange, String> {
    let limits = RangeLimits {
        name: "times",
        ends: 0.0..=1e12,
        allowed_ends: "numbers from 0 to 1e12",
        most: MOST_TIMES,
        ascending: true,
        example: "0:5:2001 (FROM:TO:N in s)",
    };
    EvenRange::parse(text, &limits)
}

#[cfg(test)]
mod tests {
    use super::{EvenRange, speeds, times};

    fn values(range: Result<EvenRange, String>) -> Vec<f64> {
        range.expect("a range").values().collect()
    }

    #[test]
    fn the_ends_are_exact() {
        assert_eq!(values(speeds("-150:-300:4")), [-150.0, -200.0, -250.0, -300.0]);
        assert_eq!(values(speeds("-300:-150:2")), [-300.0, -150.0]);
        assert_eq!(values(times("0:2:5")), [0.0, 0.5, 1.0, 1.5, 2.0]);
        for only in [speeds("0.1:0.1:1"), times("0.1:0.1:1")] {
            assert_eq!(values(only), [0.1]);
        }
        for many in [speeds("0.1:0.7:12345"), times("0.1:0.7:12345")].map(values) {
            assert_eq!((many[0], many[12344], many.len()), (0.1, 0.7, 12345));
            assert!(many.windows(2).all(|pair| pair[0] < pair[1]));
        }
    }
}
