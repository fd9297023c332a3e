//! Lists of points as people read them.

/// The largest number of points that a sentence names.
const MOST_NAMED: usize = 10;

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
