//! `stickslip check --existence`: finds the points at which stick and slip always have exactly one solution.

use serde_json::{Value, json};

use super::point_words::swept_text;
use crate::check::spread;
use crate::model::{ExistenceVerdict, SAFE_FRICTION};
use crate::responses::{merged, point_keys};
use crate::study::{ParameterValue, Point, Study, VariedParameter};

/// The largest product of the number of points and `3^N` for `N` balls; of larger sweeps, evenly spread points are
/// examined.
const MOST_WORK: u64 = 65_610_000;
/// The largest number of points for any number of balls.
const MOST_POINTS: u64 = 1_000_000;
/// The largest number of points that are listed.
const MOST_NAMED: usize = 20;

/// A point at which stick and slip do not always have exactly one solution.
struct Failing {
    point_id: u64,
    columns: Vec<VariedParameter>,
    swept: Vec<ParameterValue>,
    shown: Vec<String>,
    least_minor: f64,
    position: Vec<(usize, f64)>,
    friction_fraction: f64,
}

/// The verdicts over the sweep.
pub(super) struct Existence {
    points: u64,
    examined: u64,
    /// The smallest principal minor, and the point that has it.
    least: (f64, u64),
    not_unique: u64,
    /// The first points that are not unique.
    named: Vec<Failing>,
    /// Whether the parameters of the runs differ from those of their point.
    uncertain: bool,
}

impl Existence {
    /// Checks the points of a study.
    pub(super) fn of(study: &Study) -> Self {
        let points = study.point_count();
        let work = 3_u64.saturating_pow(study.model().balls() as u32);
        let examined = points.min(MOST_POINTS).min(MOST_WORK / work).max(1);
        let mut found = Existence {
            points,
            examined,
            least: (f64::INFINITY, 0),
            not_unique: 0,
            named: Vec::new(),
            uncertain: !study.uncertain().is_empty(),
        };
        for index in 0..examined {
            found.add(study, &study.point(spread(index, examined, points)));
        }
        found
    }

    fn add(&mut self, study: &Study, point: &Point) {
        let Some(machine) = point.model().ball_balancer() else {
            // A single contact with a given normal force is uncoupled.
            self.least = if self.least.0 > 1.0 { (1.0, point.point_id) } else { self.least };
            return;
        };
        let verdict = machine.existence();
        let least_minor = verdict.least_minor();
        if least_minor < self.least.0 {
            self.least = (least_minor, point.point_id);
        }
        let ExistenceVerdict::NotUnique { position, .. } = verdict else { return };
        self.not_unique += 1;
        if self.named.len() < MOST_NAMED {
            self.named.push(Failing {
                point_id: point.point_id,
                columns: study.swept().to_vec(),
                shown: study.shown(&point.swept),
                swept: point.swept.clone(),
                least_minor,
                position,
                friction_fraction: machine.unambiguous_friction_fraction(),
            });
        }
    }

    /// Returns the verdict as rows of a table: a key and its text.
    pub(super) fn rows(&self) -> Vec<(&'static str, String)> {
        let (examined, points) = (self.examined, self.points);
        if self.not_unique > 0 {
            let verdict = format!(
                "at {} of {examined} points stick and slip do not always have exactly one solution; \
                 runs at these points can fail with no_solution",
                self.not_unique
            );
            return vec![("existence", verdict)];
        }
        let place = match (examined == points, points) {
            (true, 1) => "at the only point".to_owned(),
            (true, points) => format!("at all {points} points"),
            (false, points) => format!("at {examined} of {points} points, spread over the sweep,"),
        };
        let nominal =
            if self.uncertain { " with uncertain parameters at their medians" } else { "" };
        let verdict = format!(
            "{place}{nominal} stick and slip have exactly one solution, proven for all positions and \
             forces;"
        );
        let (minor, at) = self.least;
        let least = format!(
            "smallest principal minor {minor:.8} at point {at} (1: decoupled balls, 0 or less: not \
             unique)"
        );
        vec![("existence", verdict), ("", least)]
    }

    /// Returns lines of text on the points that are not unique, and on what is not checked.
    pub(super) fn details(&self) -> String {
        let mut text = String::new();
        for failing in &self.named {
            text += &failing.text();
        }
        let more = self.not_unique - self.named.len() as u64;
        if more > 0 {
            text += &format!("  ... and {more} more points\n");
        }
        if self.not_unique > 0 && self.examined < self.points {
            text += &format!(
                "  checked {} of {} points, evenly spread over the sweep\n",
                self.examined, self.points
            );
        }
        if self.uncertain {
            text += "  the random draws of uncertain parameters are not checked; their results can \
                     differ\n";
        }
        text
    }

    /// Returns the verdicts as JSON.
    pub(super) fn json(&self) -> Value {
        json!({
            "points": self.points,
            "points_examined": self.examined,
            "not_unique_points": self.not_unique,
            "min_principal_minor": self.least.0,
            "min_at_point": self.least.1,
            "uncertain_at_medians": self.uncertain,
            "not_unique": self.named.iter().map(Failing::json).collect::<Vec<_>>(),
        })
    }
}

impl Failing {
    fn text(&self) -> String {
        let swept = swept_text(&self.columns, &self.shown);
        let position: Vec<String> = self
            .position
            .iter()
            .map(|(ball, angle)| format!("ball {ball} at {angle:.4}"))
            .collect();
        format!(
            "  point {}{swept}: smallest principal minor {:.4}, with {} rad (relative angles; each \
             angle may also be larger or smaller by π)\n    remedy: {}\n",
            self.point_id,
            self.least_minor,
            position.join(", "),
            self.remedy(),
        )
    }

    fn remedy(&self) -> String {
        format!(
            "multiply all friction coefficients by at most {:.4} (the solution is always unique for \
             coefficients below {SAFE_FRICTION}), or use balls that are lighter relative to the table",
            self.friction_fraction,
        )
    }

    fn json(&self) -> Value {
        let keys = point_keys(self.point_id, &self.columns, &self.swept);
        let position = self.position.iter();
        let position = position.map(|(ball, angle)| json!({"ball": ball, "beta_rad": angle}));
        let facts = json!({
            "min_principal_minor": self.least_minor,
            "worst_position": position.collect::<Vec<Value>>(),
            "unambiguous_friction_fraction": self.friction_fraction,
            "remedy": self.remedy(),
        });
        merged(keys, facts)
    }
}
