//! Numbers of a point as people read them, and sentences on the points of a study: whether the runs
//! vibrate less than without balls, and whether balls overlap.

use super::point_keys::swept_text;
use super::remedies::Remedies;
use crate::analysis::reference_amplitude;
use crate::classification::Label;
use crate::report::{Fraction, PointFacts};
use crate::study::Study;

/// The largest number of points that a sentence names.
const MOST_NAMED: usize = 10;

/// Returns a positive number with three significant digits and at most three decimals.
pub fn three_digits(value: f64) -> String {
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

/// Returns a point as one line of text. With `own_machines` the amplitude without balls is a median over the runs.
pub fn point_line(study: &Study, point: &PointFacts, own_machines: bool) -> String {
    let swept = swept_text(study.swept(), &study.shown(&point.swept));
    let mut line = format!("point {}{swept}: {} runs", point.point_id, point.runs);
    let unit = study.units().vibration();
    let (vibration, unit) = (|metres: f64| three_digits(unit.of(metres)), &unit.symbol);
    if let Some([worse, ..]) = point.residual.worse_than_without_balls {
        let [_, median, p95] = point.amplitude_m.map(|metres| metres.map(vibration));
        if let (Some(median), Some(p95)) = (median, p95) {
            line += &format!(", vibration {median} {unit} (95 % of the runs: {p95} {unit})");
        }
        if let Some(without) = point.residual.amplitude_without_balls_m {
            let median = if own_machines { " (median)" } else { "" };
            line += &format!(", without balls {} {unit}{median}", vibration(without));
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

/// Counts over all points, and what they say in words.
#[derive(Clone, Debug, Default)]
pub struct InWords {
    /// Points at which runs are compared with the machine without balls.
    compared: u64,
    /// Points at which more than half of the runs vibrate more.
    mostly_more: NamedPoints,
    /// Points at which more than half of the runs do not vibrate more.
    mostly_less: u64,
    /// The fraction of runs that vibrate more at the last point.
    more: f64,
    rests: u64,
    overlapping: u64,
    /// Points at which less than half of the runs rest, although some do.
    few_rests: NamedPoints,
    /// Whether each run has its own machine without balls.
    pub own_machines: bool,
    remedies: Remedies,
}

impl InWords {
    /// Creates the counts of no points.
    pub fn new(study: &Study) -> Self {
        let without_balls = |fraction: f64| {
            let model = study.model_at_quantiles(0, |_| fraction).ok()?;
            model.ball_balancer().and_then(reference_amplitude)
        };
        let own_machines = without_balls(0.025) != without_balls(0.975);
        InWords { own_machines, ..InWords::default() }
    }

    /// Adds a point of the study.
    pub fn add(&mut self, study: &Study, point: &PointFacts) {
        self.remedies.count(study, point);
        let [grade, _] = point.residual.balance_quality_grade_mm_s;
        if grade.is_some() && 2 * point.equilibrium.runs < point.runs {
            self.few_rests.add(point.point_id);
        }
        self.rests = self.rests.saturating_add(point.equilibrium.runs);
        self.overlapping = self.overlapping.saturating_add(point.overlapping_rests());
        let Some([more, ..]) = point.residual.worse_than_without_balls else { return };
        self.compared += 1;
        self.more = more;
        self.mostly_less += u64::from(more < 0.5);
        if more > 0.5 {
            self.mostly_more.add(point.point_id);
            self.remedies.add(study, point);
        }
    }

    /// Returns the sentences, one per line.
    pub fn text(&self) -> String {
        let lines = [
            self.about_draws(),
            self.about_grades(),
            self.vibration(),
            self.remedies.of_vibration(self.compared),
            self.remedies.of_undecided(),
            self.overlaps(),
        ];
        lines.into_iter().flatten().map(|line| line + "\n").collect()
    }

    fn about_draws(&self) -> Option<String> {
        (self.own_machines && self.compared > 0).then(|| {
            "The amplitude without balls is the median over the runs; `worse` compares each run with its own machine \
             without balls."
                .to_owned()
        })
    }

    fn about_grades(&self) -> Option<String> {
        let few = &self.few_rests;
        let at = match (few.count, self.compared) {
            (0, _) => return None,
            (_, 1) => String::new(),
            _ => format!(" ({})", few.text()),
        };
        Some(format!(
            "G is the median of the rests alone, which are less than half of the runs{at}."
        ))
    }

    fn vibration(&self) -> Option<String> {
        let points = self.compared;
        Some(match (points, self.mostly_more.count) {
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
                let named = self.mostly_more.text();
                format!(
                    "At {more} of {points} points most runs vibrate more than the machine without \
                     balls ({named})."
                )
            }
        })
    }

    fn overlaps(&self) -> Option<String> {
        let (overlapping, rests) = (self.overlapping, self.rests);
        (overlapping > 0).then(|| {
            format!(
                "warning: balls overlap at {overlapping} of {rests} rests; model.contact keeps them apart."
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{InWords, NamedPoints, percent, three_digits};

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
        let mut named = NamedPoints::default();
        [1, 4].into_iter().for_each(|point| named.add(point));
        let some = InWords { mostly_more: named, ..half };
        assert!(some.text().ends_with("without balls (points 1, 4).\n"), "{}", some.text());
        let mut named = NamedPoints::default();
        (0..12).for_each(|point| named.add(point));
        let many = InWords { mostly_more: named, compared: 20, ..some };
        assert!(many.text().contains(", 9 and 2 more)."), "{}", many.text());
        let overlapping = InWords { rests: 9, overlapping: 2, ..InWords::default() };
        assert!(overlapping.text().starts_with("warning: balls overlap at 2 of 9 rests; "));
        let mut few = NamedPoints::default();
        few.add(3);
        let text = InWords { few_rests: few, compared: 2, ..InWords::default() }.text();
        assert!(text.starts_with(
            "G is the median of the rests alone, which are less than half of the runs (point 3).\n"
        ));
        assert_eq!(InWords::default().text(), "");
    }
}
