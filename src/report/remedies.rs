//! What to change where most runs vibrate more than without balls, and where many runs are undecided, as far as closed
//! forms and counts tell.

use super::data::{NamedPoints, PointFacts};
use crate::check::Obstacle;
use crate::classification::{FoundEndings, Label, found_endings};
use crate::model::{Endings, Model};
use crate::study::Study;

/// The fraction of undecided runs from which a longer simulation is proposed.
const MANY_UNDECIDED: f64 = 0.1;

/// The obstacles at the points where most runs vibrate more than without balls, and the number of undecided runs.
#[derive(Clone, Debug, Default)]
pub struct Remedies {
    /// The points with each obstacle, in the order of [`Obstacle::ALL`].
    obstacles: [NamedPoints; 3],
    runs: u64,
    undecided: u64,
    /// What more time decides, if there are undecided runs.
    later: Option<String>,
}

impl Remedies {
    /// Adds a point at which most runs vibrate more than without balls.
    pub fn add(&mut self, study: &Study, point: &PointFacts) {
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

    /// Counts the undecided runs of any point of a study that detects all endings.
    pub fn count(&mut self, study: &Study, point: &PointFacts) {
        if study.simulation().endings == Endings::All {
            self.runs = self.runs.saturating_add(point.runs);
            let undecided = point.label(Label::Undecided).runs;
            self.undecided = self.undecided.saturating_add(undecided);
            if undecided > 0 && self.later.is_none() {
                self.later = Some(decided_later(study.model()));
            }
        }
    }

    /// Returns the sentence on the obstacles; `None` if closed forms show none. The points are named if the study has
    /// more than one.
    pub fn of_vibration(&self, points: u64) -> Option<String> {
        let each = Obstacle::ALL.iter().zip(&self.obstacles).filter(|(_, at)| at.count > 0);
        let parts: Vec<String> = each
            .map(|(obstacle, at)| match points {
                1 => in_words(*obstacle).to_owned(),
                _ => format!("{} ({})", in_words(*obstacle), at.text()),
            })
            .collect();
        (!parts.is_empty()).then(|| format!("Remedy: {}; see `stickslip check`.", parts.join("; ")))
    }

    /// Returns the sentence on undecided runs; `None` if there are few.
    pub fn of_undecided(&self) -> Option<String> {
        let Remedies { undecided, runs, .. } = *self;
        let later = self.later.as_ref()?;
        (undecided as f64 >= MANY_UNDECIDED * runs as f64)
            .then(|| format!("{undecided} of {runs} runs are undecided; {later}."))
    }
}

/// Returns which undecided runs of a model a longer simulation decides, in words.
fn decided_later(model: &Model) -> String {
    let longer = "a larger simulation.end_time_s or simulation.extend decides";
    let kind = model.kind().name;
    match found_endings(model) {
        FoundEndings { cycles: true, .. } => match model.ball_balancer() {
            Some(machine) if machine.contact.is_none() => format!("{longer} more"),
            Some(_) => format!("{longer} more, but no quasi-periodic motion"),
            None => format!(
                "{longer} more, but no run whose motion goes on with an amplitude that depends on its start"
            ),
        },
        FoundEndings { rests: true, .. } => format!(
            "the program finds no limit cycles of {kind} with this friction, so that {longer} only runs that come to rest \
             or are irregular"
        ),
        FoundEndings { .. } => format!(
            "the program finds neither limit cycles of {kind} nor rests in which a {} sticks, so that {longer} only runs \
             that are irregular or slide at constant speed",
            model.kind().body
        ),
    }
}

fn in_words(obstacle: Obstacle) -> &'static str {
    match obstacle {
        Obstacle::SlowDisc => "a speed above the natural frequency",
        Obstacle::LightBalls => "heavier balls or a larger ring, to balance the imbalance",
        Obstacle::HeldBalls => "less friction, which holds the balls in every position",
    }
}
