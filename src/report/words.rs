//! Numbers and lists of points as people read them.

/// The largest number of points that a sentence names.
const MOST_NAMED: usize = 10;

/// Returns a positive number with three significant digits and at most three decimals, or with an exponent below 0.001.
pub fn three_digits(value: f64) -> String {
    if value > 0.0 && value < 1e-3 {
        return format!("{value:.2e}");
    }
    let digits = if value > 0.0 { 2 - value.log10().floor() as i32 } else { 0 };
    format!("{value:.0$}", digits.clamp(0, 3) as usize)
}

/// Returns a fraction in %, which is rounded to 0 or 100 only if it has that value.
pub fn percent(fraction: f64) -> String {
    let rounded = format!("{:.1}", 100.0 * fraction);
    match rounded.as_str() {
        "0.0" if fraction > 0.0 => "<0.1".to_owned(),
        "100.0" if fraction < 1.0 => ">99.9".to_owned(),
        _ => rounded,
    }
}

/// A list of points that counts all of them and names only the first ones.
#[derive(Clone, Debug, Default)]
pub struct NamedPoints {
    /// The number of the points.
    pub count: u64,
    first: Vec<u64>,
}

impl NamedPoints {
    /// Adds a point.
    pub fn add(&mut self, point_id: u64) {
        self.count += 1;
        if self.first.len() < MOST_NAMED {
            self.first.push(point_id);
        }
    }

    /// Returns the points in words, as `points 1, 4 and 2 more`.
    pub fn text(&self) -> String {
        let named: Vec<String> = self.first.iter().map(u64::to_string).collect();
        let plural = if self.count == 1 { "" } else { "s" };
        let others = match self.count - self.first.len() as u64 {
            0 => String::new(),
            others => format!(" and {others} more"),
        };
        format!("point{plural} {}{others}", named.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::{percent, three_digits};

    #[test]
    fn numbers_have_three_digits() {
        let found = [0.0, 0.0124, 0.5302, 28.31, 99.96, 1234.5].map(three_digits);
        assert_eq!(found, ["0", "0.012", "0.530", "28.3", "100.0", "1234"]);
        let found = [0.0, 1e-4, 0.875, 0.9999, 1.0].map(percent);
        assert_eq!(found, ["0.0", "<0.1", "87.5", ">99.9", "100.0"]);
    }
}
