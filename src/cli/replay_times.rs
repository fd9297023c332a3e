//! Times on the command line: `FROM:TO:N`, in s.

use std::str::FromStr;

/// Equally spaced times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    from_s: f64,
    to_s: f64,
    count: u32,
}

/// The largest number of times, and of rows of a replay.
pub const MOST_TIMES: u32 = 1_000_000;

impl Times {
    /// Returns the first and the last time, s.
    pub fn ends(&self) -> [f64; 2] {
        [self.from_s, self.to_s]
    }

    /// Returns all times, s, ascending.
    pub fn values(&self) -> impl Iterator<Item = f64> + use<> {
        let Times { from_s, to_s, count } = *self;
        let last = f64::from(count.max(2) - 1);
        // The ends are exactly the given numbers.
        (0..count).map(f64::from).map(move |index| match index {
            0.0 => from_s,
            index if index == last => to_s,
            index => from_s + (to_s - from_s) * (index / last),
        })
    }
}

impl FromStr for Times {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let refused = |found: &str, allowed: &str| {
            Err(format!("found {found}, allowed: {allowed}, as in 0:5:2001 (FROM:TO:N in s)"))
        };
        let parts: Vec<&str> = text.split(':').collect();
        let [from, to, count] = parts.as_slice() else {
            let found = format!("{text:?}");
            return refused(&found, "two times and their number with colons between");
        };
        let time = |text: &str| text.trim().parse().ok().filter(|time| (0.0..=1e12).contains(time));
        let (Some(from_s), Some(to_s)) = (time(from), time(to)) else {
            let found = format!("the times {from:?} and {to:?}");
            return refused(&found, "numbers from 0 to 1e12");
        };
        let number = count.trim().parse().ok().filter(|count| (1..=MOST_TIMES).contains(count));
        let Some(count) = number else {
            let allowed = format!("a whole number from 1 to {MOST_TIMES}");
            return refused(&format!("the number of times {count:?}"), &allowed);
        };
        if from_s > to_s || (from_s == to_s) != (count == 1) {
            let found = format!("{count} times from {from_s} to {to_s} s");
            return refused(
                &found,
                "two times or more with the later one last, one where both are the same",
            );
        }
        Ok(Times { from_s, to_s, count })
    }
}

#[cfg(test)]
mod tests {
    use super::Times;

    #[test]
    fn ends_are_exact_and_times_ascend() {
        let values = |text: &str| text.parse::<Times>().unwrap().values().collect::<Vec<f64>>();
        assert_eq!(values("0:2:5"), [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(values("0.1:0.1:1"), [0.1]);
        let times = values("0.1:0.7:12345");
        assert_eq!((times[0], times[12344], times.len()), (0.1, 0.7, 12345));
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
