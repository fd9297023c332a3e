//! `stickslip check --existence`: finds the points at which stick and slip always have exactly one solution.

use serde::Serialize;
use serde_json::Value;

use super::result_lines::point_words;
use crate::check::points_to_examine;
use crate::model::{ExistenceVerdict, Machine, SAFE_FRICTION};
use crate::responses::point_keys;
use crate::study::{Point, Study};

/// The largest product of the number of points and `3^N` for `N` balls; of larger sweeps, evenly spread points are
/// examined.
const MOST_WORK: u64 = 65_610_000;
/// The largest number of points for any number of balls.
const MOST_POINTS: u64 = 1_000_000;
/// The largest number of points that are listed.
const MOST_NAMED: usize = 20;

/// A point at which stick and slip do not always have exactly one solution.
#[derive(Serialize)]
struct AmbiguousPoint {
    /// The number of the point and its swept parameters, as JSON and in words.
    #[serde(flatten)]
    keys: Value,
    #[serde(skip)]
    point: String,
    min_principal_minor: f64,
    worst_position: Vec<BallAngle>,
    unambiguous_friction_fraction: f64,
    remedy: String,
}

/// The angle of a ball, which has a number from 1, relative to the first ball of the worst position.
#[derive(Serialize)]
struct BallAngle {
    ball: usize,
    beta_rad: f64,
}

/// The verdicts over the sweep.
#[derive(Serialize)]
pub(super) struct Existence {
    points: u64,
    points_examined: u64,
    not_unique_points: u64,
    min_principal_minor: f64,
    /// The point with the smallest principal minor.
    min_at_point: u64,
    /// Whether the parameters of the runs differ from those of their point.
    uncertain_at_medians: bool,
    /// The first points that are not unique.
    not_unique: Vec<AmbiguousPoint>,
}

impl Existence {
    /// Checks the points of a study.
    pub(super) fn of(study: &Study) -> Self {
        let points = study.point_count();
        let work = 3_u64.saturating_pow(study.model().balls() as u32);
        let examined = points.min(MOST_POINTS).min(MOST_WORK / work).max(1);
        let mut found = Existence {
            points,
            points_examined: examined,
            not_unique_points: 0,
            min_principal_minor: f64::INFINITY,
            min_at_point: 0,
            uncertain_at_medians: !study.uncertain().is_empty(),
            not_unique: Vec::new(),
        };
        for point_id in points_to_examine(points, examined) {
            found.add(study, &study.point(point_id));
        }
        found
    }

    fn add(&mut self, study: &Study, point: &Point) {
        let machine = point.model().ball_balancer();
        let verdict = machine.map(Machine::existence);
        // A single contact with a given normal force is uncoupled.
        let minor = verdict.as_ref().map_or(1.0, ExistenceVerdict::least_minor);
        if minor < self.min_principal_minor {
            (self.min_principal_minor, self.min_at_point) = (minor, point.point_id);
        }
        let Some(ExistenceVerdict::NotUnique { position, .. }) = verdict else { return };
        self.not_unique_points += 1;
        if self.not_unique.len() >= MOST_NAMED {
            return;
        }
        let fraction = machine.map_or(1.0, Machine::unambiguous_friction_fraction);
        let angle = |(ball, beta_rad)| BallAngle { ball, beta_rad };
        self.not_unique.push(AmbiguousPoint {
            keys: point_keys(point.point_id, study.swept(), &point.swept),
            point: point_words(study, point.point_id, &point.swept),
            min_principal_minor: minor,
            worst_position: position.into_iter().map(angle).collect(),
            unambiguous_friction_fraction: fraction,
            remedy: format!(
                "multiply all friction coefficients by at most {fraction:.4} (the solution is always unique for \
                 coefficients below {SAFE_FRICTION}), or use balls that are lighter relative to the table"
            ),
        });
    }

    /// Returns the verdict as facts: a name and its value in words.
    pub(super) fn facts(&self) -> Vec<(&'static str, String)> {
        let (examined, points) = (self.points_examined, self.points);
        if self.not_unique_points > 0 {
            let verdict = format!(
                "at {} of {examined} points stick and slip do not always have exactly one solution; \
                 runs at these points can fail with no_solution",
                self.not_unique_points
            );
            return vec![("existence", verdict)];
        }
        let place = match (examined == points, points) {
            (true, 1) => "at the only point".to_owned(),
            (true, points) => format!("at all {points} points"),
            (false, points) => format!("at {examined} of {points} points, spread over the sweep,"),
        };
        let nominal = if self.uncertain_at_medians {
            " with uncertain parameters at their medians"
        } else {
            ""
        };
        let verdict = format!(
            "{place}{nominal} stick and slip have exactly one solution, proven for all positions and \
             forces;"
        );
        let (minor, at) = (self.min_principal_minor, self.min_at_point);
        let least = format!(
            "smallest principal minor {minor:.8} at point {at} (1: decoupled balls, 0 or less: not \
             unique)"
        );
        vec![("existence", verdict), ("", least)]
    }

    /// Returns lines of text on the points that are not unique, and on what is not checked.
    pub(super) fn details(&self) -> String {
        let mut text = String::new();
        for failing in &self.not_unique {
            text += &failing.text();
        }
        let more = self.not_unique_points - self.not_unique.len() as u64;
        if more > 0 {
            text += &format!("  ... and {more} more points\n");
        }
        let (examined, points) = (self.points_examined, self.points);
        if self.not_unique_points > 0 && examined < points {
            text +=
                &format!("  checked {examined} of {points} points, evenly spread over the sweep\n");
        }
        if self.uncertain_at_medians {
            text += "  the random draws of uncertain parameters are not checked; their results can \
                     differ\n";
        }
        text
    }
}

impl AmbiguousPoint {
    fn text(&self) -> String {
        let AmbiguousPoint { point, min_principal_minor: minor, remedy, .. } = self;
        let angle = |ball: &BallAngle| format!("ball {} at {:.4}", ball.ball, ball.beta_rad);
        let position: Vec<String> = self.worst_position.iter().map(angle).collect();
        format!(
            "  {point}: smallest principal minor {minor:.4}, with {} rad (relative angles; each \
             angle may also be larger or smaller by π)\n    remedy: {remedy}\n",
            position.join(", "),
        )
    }
}
