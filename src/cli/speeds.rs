//! A range of speeds on the command line: `FROM:TO:COUNT`.

use std::str::FromStr;

/// Equally spaced speeds, in the given order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speeds {
    from_rad_s: f64,
    to_rad_s: f64,
    count: u32,
}

/// The largest number of speeds in a range.
const MOST_SPEEDS: u32 = 100_000;

impl Speeds {
    /// Returns the number of speeds.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Returns all speeds, rad/s.
    pub fn values(&self) -> impl Iterator<Item = f64> + use<> {
        let Speeds { from_rad_s, to_rad_s, count } = *self;
        let last = f64::from(count.max(2) - 1);
        // The ends are exactly the given numbers.
        (0..count)
            .map(f64::from)
            .map(move |index| (from_rad_s * (last - index) + to_rad_s * index) / last)
    }
}

impl FromStr for Speeds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let refused = |found: &str, allowed: &str| {
            Err(format!(
                "found {found}, allowed: {allowed}, as in -150:-300:151 (FROM:TO:COUNT in rad/s)"
            ))
        };
        let parts: Vec<&str> = text.split(':').collect();
        let [from, to, count] = parts.as_slice() else {
            return refused(
                &format!("{text:?}"),
                "two speeds and their number with colons between",
            );
        };
        let speed = |text: &str| text.trim().parse().ok().filter(|speed: &f64| speed.abs() <= 1e9);
        let (Some(from_rad_s), Some(to_rad_s)) = (speed(from), speed(to)) else {
            return refused(&format!("the speeds {from:?} and {to:?}"), "numbers up to 1e9");
        };
        let number = count.trim().parse().ok().filter(|count| (1..=MOST_SPEEDS).contains(count));
        let Some(count) = number else {
            let allowed = format!("a whole number from 1 to {MOST_SPEEDS}");
            return refused(&format!("the number of speeds {count:?}"), &allowed);
        };
        if (from_rad_s == to_rad_s) != (count == 1) {
            let found = format!("{count} speeds from {from_rad_s} to {to_rad_s}");
            return refused(
                &found,
                "two speeds or more between different ends, one where both are the same",
            );
        }
        Ok(Speeds { from_rad_s, to_rad_s, count })
    }
}

#[cfg(test)]
mod tests {
    use super::Speeds;

    #[test]
    fn ends_are_exact_and_either_order_is_kept() {
        let values = |text: &str| text.parse::<Speeds>().unwrap().values().collect::<Vec<f64>>();
        assert_eq!(values("-150:-300:4"), [-150.0, -200.0, -250.0, -300.0]);
        assert_eq!(values("-300:-150:2"), [-300.0, -150.0]);
        assert_eq!(values("0.1:0.1:1"), [0.1]);
        assert_eq!(values("-1:1:3"), [-1.0, 0.0, 1.0]);
        let third = values("0.1:0.7:11");
        assert_eq!((third[0], third[10]), (0.1, 0.7));
    }
}
