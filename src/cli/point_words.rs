//! Numbers of a point as people read them, and sentences on the points of a study: whether the runs
//! vibrate less than without balls, and whether balls overlap.

use super::point_keys::swept_text;
use crate::classification::Label;
use crate::report::{Fraction, PointFacts};

/// The largest number of points that a sentence names.
const MOST_NAMED: usize = 10;

/// Returns a positive number with three significant digits and at most three decimals.
pub fn three_digits(value: f64) -> String {
    let digits = if value > 0.0 { 2 - value.log10().floor() as i32 } else { 0 };
    format!("{value:.0$}", digits.clamp(0, 3) as usize)
}

/// Returns a length in µm.
pub fn micrometres(metres: f64) -> String {
    three_digits(1e6 * metres)
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

/// Returns a point as one line of text.
pub fn point_line(names: &[String], point: &PointFacts) -> String {
    let mut line =
        format!("point {}{}: {} runs", point.point_id, swept_text(names, &point.swept), point.runs);
    if let Some([worse, ..]) = point.residual.worse_than_without_balls {
        let [_, median, p95] = point.amplitude_m.map(|metres| metres.map(micrometres));
        if let (Some(median), Some(p95)) = (median, p95) {
            line += &format!(", vibration {median} µm (95 % of the runs: {p95} µm)");
        }
        if let Some(without) = point.without_balls_m {
            line += &format!(", without balls {} µm", micrometres(without));
        }
        line += &format!("; {} % of the runs vibrate more than without balls", percent(worse));
    }
    let Fraction { fraction, low, high, .. } = point.equilibrium;
    let [fraction, low, high] = [fraction, low, high].map(percent);
    line += &format!("; {fraction} % at rest ({low} .. {high} %)");
    match point.label(Label::Failed).runs {
        0 => line,
        failed => format!("{line}, {failed} failed"),
    }
}

/// Counts over all points, and what they say in words.
#[derive(Clone, Debug, Default)]
pub struct InWords {
    /// Points at which runs are compared with the machine without balls.
    compared: u64,
    /// Points at which more than half of the runs vibrate more, and the numbers of the first ones.
    mostly_more: u64,
    named: Vec<u64>,
    /// Points at which more than half of the runs do not vibrate more.
    mostly_less: u64,
    /// The fraction of runs that vibrate more at the last point.
    more: f64,
    rests: u64,
    overlapping: u64,
}

impl InWords {
    /// Adds a point.
    pub fn add(&mut self, point: &PointFacts) {
        self.rests = self.rests.saturating_add(point.equilibrium.runs);
        self.overlapping = self.overlapping.saturating_add(point.overlapping_rests());
        let Some([more, ..]) = point.residual.worse_than_without_balls else { return };
        self.compared += 1;
        self.more = more;
        self.mostly_less += u64::from(more < 0.5);
        if more > 0.5 {
            self.mostly_more += 1;
            if self.named.len() < MOST_NAMED {
                self.named.push(point.point_id);
            }
        }
    }

    /// Returns the sentences, one per line; empty for a block.
    pub fn text(&self) -> String {
        let lines = [self.vibration(), self.overlaps()];
        lines.into_iter().flatten().map(|line| line + "\n").collect()
    }

    fn vibration(&self) -> Option<String> {
        let points = self.compared;
        Some(match (points, self.mostly_more) {
            (0, _) => return None,
            (1, _) => {
                let less = percent(1.0 - self.more);
                format!("{less} % of the runs vibrate less than without balls.")
            }
            (_, 0) if self.mostly_less == points => format!(
                "At all {points} points most runs vibrate less than the machine without balls."
            ),
            (_, 0) => format!(
                "At none of the {points} points do most runs vibrate more than the machine without \
                 balls."
            ),
            (_, more) => {
                let named: Vec<String> = self.named.iter().map(u64::to_string).collect();
                let plural = if more == 1 { "" } else { "s" };
                let others = match more - self.named.len() as u64 {
                    0 => String::new(),
                    others => format!(" and {others} more"),
                };
                format!(
                    "At {more} of {points} points most runs vibrate more than the machine without \
                     balls (point{plural} {}{others}).",
                    named.join(", ")
                )
            }
        })
    }

    fn overlaps(&self) -> Option<String> {
        let (overlapping, rests) = (self.overlapping, self.rests);
        (overlapping > 0).then(|| {
            format!(
                "warning: balls overlap at {overlapping} of {rests} rests: the model has no contact \
                 between balls."
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{InWords, percent, three_digits};

    #[test]
    fn numbers_have_three_digits() {
        let found = [0.0, 0.0124, 0.5302, 28.31, 99.96, 1234.5].map(three_digits);
        assert_eq!(found, ["0", "0.012", "0.530", "28.3", "100.0", "1234"]);
        let found = [0.0, 1e-4, 0.875, 0.9999, 1.0].map(percent);
        assert_eq!(found, ["0.0", "<0.1", "87.5", ">99.9", "100.0"]);
    }

    #[test]
    fn sentences_say_what_is_counted() {
        let one = InWords { compared: 1, more: 0.125, ..InWords::default() };
        assert_eq!(one.text(), "87.5 % of the runs vibrate less than without balls.\n");
        let all = InWords { compared: 6, mostly_less: 6, ..InWords::default() };
        assert!(all.text().starts_with("At all 6 points most runs vibrate less than "));
        // Exactly half of the runs of one point vibrate more.
        let half = InWords { mostly_less: 5, ..all };
        assert!(half.text().starts_with("At none of the 6 points do most runs vibrate more than "));
        let some = InWords { mostly_more: 2, named: vec![1, 4], ..half };
        assert!(some.text().ends_with("without balls (points 1, 4).\n"), "{}", some.text());
        let many = InWords { mostly_more: 12, named: (0..10).collect(), compared: 20, ..some };
        assert!(many.text().contains(", 9 and 2 more)."), "{}", many.text());
        let overlapping = InWords { rests: 9, overlapping: 2, ..InWords::default() };
        assert!(overlapping.text().starts_with("warning: balls overlap at 2 of 9 rests: "));
        assert_eq!(InWords::default().text(), "");
    }
}
