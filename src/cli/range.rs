//! Equally spaced values on the command line: `FROM:TO:COUNT`.

use std::ops::RangeInclusive;
use std::str::FromStr;

/// Speeds in rad/s, in ascending or descending order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speeds(Range);

/// Times in s, in ascending order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times(Range);

/// The largest number of times, and of rows of a replay.
pub const MOST_TIMES: u32 = 1_000_000;
/// The largest number of speeds.
const MOST_SPEEDS: u32 = 100_000;

/// Two ends and the number of values.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range {
    from: f64,
    to: f64,
    count: u32,
}

/// The limits of a range, and the words of its error messages.
struct Limits {
    /// The values, as `speeds`.
    name: &'static str,
    ends: RangeInclusive<f64>,
    /// The allowed ends in words.
    allowed_ends: &'static str,
    most: u32,
    ascending: bool,
    example: &'static str,
}

impl Range {
    /// Parses `FROM:TO:COUNT`.
    fn parse(text: &str, limits: &Limits) -> Result<Self, String> {
        let Limits { name, ends, allowed_ends, most, ascending, example } = limits;
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
        Ok(Range { from, to, count })
    }

    /// Returns the numbers of the values, from 0, and the last number; 1 if there is only one value.
    fn places(self) -> (impl Iterator<Item = f64> + use<>, f64) {
        ((0..self.count).map(f64::from), f64::from(self.count.max(2) - 1))
    }
}

impl Speeds {
    /// Returns the number of speeds.
    pub fn count(&self) -> u32 {
        self.0.count
    }

    /// Returns all speeds, rad/s; the ends are exactly the given numbers.
    pub fn values(&self) -> impl Iterator<Item = f64> + use<> {
        let Range { from, to, .. } = self.0;
        let (places, last) = self.0.places();
        places.map(move |place| (from * (last - place) + to * place) / last)
    }
}

impl FromStr for Speeds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let limits = Limits {
            name: "speeds",
            ends: -1e9..=1e9,
            allowed_ends: "numbers up to 1e9",
            most: MOST_SPEEDS,
            ascending: false,
            example: "-150:-300:151 (FROM:TO:COUNT in rad/s)",
        };
        Range::parse(text, &limits).map(Speeds)
    }
}

impl Times {
    /// Returns all times, s; the ends are exactly the given numbers.
    pub fn values(&self) -> impl Iterator<Item = f64> + use<> {
        let Range { from, to, .. } = self.0;
        let (places, last) = self.0.places();
        places.map(move |place| match place {
            0.0 => from,
            place if place == last => to,
            place => from + (to - from) * (place / last),
        })
    }
}

impl FromStr for Times {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let limits = Limits {
            name: "times",
            ends: 0.0..=1e12,
            allowed_ends: "numbers from 0 to 1e12",
            most: MOST_TIMES,
            ascending: true,
            example: "0:5:2001 (FROM:TO:N in s)",
        };
        Range::parse(text, &limits).map(Times)
    }
}

#[cfg(test)]
mod tests {
    use super::{Speeds, Times};

    #[test]
    fn the_ends_are_exact_in_either_order() {
        let values = |text: &str| text.parse::<Speeds>().unwrap().values().collect::<Vec<f64>>();
        assert_eq!(values("-150:-300:4"), [-150.0, -200.0, -250.0, -300.0]);
        assert_eq!(values("-300:-150:2"), [-300.0, -150.0]);
        assert_eq!(values("0.1:0.1:1"), [0.1]);
        assert_eq!(values("-1:1:3"), [-1.0, 0.0, 1.0]);
        let third = values("0.1:0.7:11");
        assert_eq!((third[0], third[10]), (0.1, 0.7));
    }

    #[test]
    fn times_ascend() {
        let values = |text: &str| text.parse::<Times>().unwrap().values().collect::<Vec<f64>>();
        assert_eq!(values("0:2:5"), [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(values("0.1:0.1:1"), [0.1]);
        let times = values("0.1:0.7:12345");
        assert_eq!((times[0], times[12344], times.len()), (0.1, 0.7, 12345));
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
