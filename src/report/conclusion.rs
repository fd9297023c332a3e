//! Sentences on the points of a study: whether the runs vibrate less than without balls, whether balls overlap, and what to
//! change where most runs vibrate more than without balls, and where many runs are undecided, as far as closed
//! forms and counts tell.

use super::data::{NamedPoints, PointFacts};
use crate::analysis::reference_amplitude;
use crate::check::Obstacle;
use crate::classification::Label;
use crate::model::Endings;
use crate::numbers::percent;
use crate::study::Study;

/// Counts over all points, and what they say in words.
#[derive(Clone, Debug, Default)]
pub struct Conclusion {
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
    /// The points with each obstacle where most runs vibrate more than without balls, in the order of [`Obstacle::ALL`].
    obstacles: [NamedPoints; 3],
    /// Runs of a study that detects all endings, and how many of them are undecided.
    runs: u64,
    undecided: u64,
}

impl Conclusion {
    /// Creates the counts of no points.
    pub fn new(study: &Study) -> Self {
        let without_balls = |fraction: f64| {
            let model = study.model_at_quantiles(0, |_| fraction).ok()?;
            model.ball_balancer().and_then(reference_amplitude)
        };
        let own_machines = without_balls(0.025) != without_balls(0.975);
        Conclusion { own_machines, ..Conclusion::default() }
    }

    /// Adds a point of the study.
    pub fn add(&mut self, study: &Study, point: &PointFacts) {
        if study.simulation().endings == Endings::All {
            self.runs = self.runs.saturating_add(point.runs);
            let undecided = point.label(Label::Undecided).runs;
            self.undecided = self.undecided.saturating_add(undecided);
        }
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
            self.add_obstacle(study, point);
        }
    }

    /// Returns the sentences below the table of points, one per line: first what its columns mean.
    pub fn text(&self) -> String {
        let notes = [self.about_draws(), self.about_grades()].into_iter().flatten();
        notes.chain(self.sentences()).map(|line| line + "\n").collect()
    }

    /// Returns the sentences on the answer of the study.
    pub fn sentences(&self) -> Vec<String> {
        let lines = [self.vibration(), self.remedy(), self.about_undecided(), self.overlaps()];
        lines.into_iter().flatten().collect()
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

    /// Notes the obstacle at a point at which most runs vibrate more than without balls.
    fn add_obstacle(&mut self, study: &Study, point: &PointFacts) {
        if point.point_id >= study.point_count() {
            return;
        }
        let Ok(model) = study.median_model(point.point_id) else { return };
        let Some(machine) = model.ball_balancer() else { return };
        let found = Obstacle::of(machine, point.set_fraction);
        for (obstacle, points) in Obstacle::ALL.iter().zip(&mut self.obstacles) {
            if found == Some(*obstacle) {
                points.add(point.point_id);
            }
        }
    }

    /// Returns the sentence on the obstacles; `None` if closed forms show none. The points are named if there are several.
    fn remedy(&self) -> Option<String> {
        let each = Obstacle::ALL.iter().zip(&self.obstacles).filter(|(_, at)| at.count > 0);
        let parts: Vec<String> = each
            .map(|(obstacle, at)| match self.compared {
                1 => in_words(*obstacle).to_owned(),
                _ => format!("{} ({})", in_words(*obstacle), at.text()),
            })
            .collect();
        (!parts.is_empty()).then(|| format!("Remedy: {}; see `stickslip check`.", parts.join("; ")))
    }

    /// Returns the sentence on undecided runs; `None` if there are few.
    fn about_undecided(&self) -> Option<String> {
        let Conclusion { undecided, runs, .. } = *self;
        (undecided > 0 && undecided as f64 >= MANY_UNDECIDED * runs as f64).then(|| {
            format!(
                "{undecided} of {runs} runs are undecided; a larger simulation.end_time_s or simulation.extend decides more."
            )
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

/// The fraction of undecided runs from which a longer simulation is proposed.
const MANY_UNDECIDED: f64 = 0.1;

fn in_words(obstacle: Obstacle) -> &'static str {
    match obstacle {
        Obstacle::SlowDisc => "a speed above the natural frequency",
        Obstacle::LightBalls => "heavier balls or a larger ring, to balance the imbalance",
        Obstacle::HeldBalls => "less friction, which holds the balls in every position",
    }
}

#[cfg(test)]
mod tests {
    use super::{Conclusion, NamedPoints};

    #[test]
    fn sentences_say_what_is_counted() {
        let single = Conclusion { compared: 1, more: 0.125, ..Conclusion::default() };
        assert_eq!(single.text(), "87.5 % of the runs vibrate less than without balls.\n");
        let all = Conclusion { compared: 6, mostly_less: 6, ..Conclusion::default() };
        assert!(all.text().starts_with("At all 6 points most runs vibrate less than "));
        // Exactly half of the runs of one point vibrate more.
        let half = Conclusion { mostly_less: 5, ..all };
        assert!(half.text().starts_with("At none of the 6 points do most runs vibrate more than "));
        let mut named = NamedPoints::default();
        [1, 4].into_iter().for_each(|point| named.add(point));
        let some = Conclusion { mostly_more: named, ..half };
        assert!(some.text().ends_with("without balls (points 1, 4).\n"), "{}", some.text());
        let mut named = NamedPoints::default();
        (0..12).for_each(|point| named.add(point));
        let many = Conclusion { mostly_more: named, compared: 20, ..some };
        assert!(many.text().contains(", 9 and 2 more)."), "{}", many.text());
        let overlapping = Conclusion { rests: 9, overlapping: 2, ..Conclusion::default() };
        assert!(overlapping.text().starts_with("warning: balls overlap at 2 of 9 rests; "));
        let mut few = NamedPoints::default();
        few.add(3);
        let text = Conclusion { few_rests: few, compared: 2, ..Conclusion::default() }.text();
        assert!(text.starts_with(
            "G is the median of the rests alone, which are less than half of the runs (point 3).\n"
        ));
        assert_eq!(Conclusion::default().text(), "");
    }
}
