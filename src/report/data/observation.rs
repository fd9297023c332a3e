//! When the runs of a point end, and since when they are observed: from the begin of the last stage on.

use super::{PointFacts, ReportData};

/// When the runs of a point end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// The begin of the last stage, s; 0 for a run with one stage.
    pub begin_s: f64,
    /// The time at which a run ends at the latest, unless it is continued, s.
    pub end_s: f64,
}

impl Observation {
    /// Returns how long the runs are observed, which is what times to rest are compared with, s.
    pub fn observed_s(self) -> f64 {
        self.end_s - self.begin_s
    }
}

impl ReportData<'_> {
    /// Returns when the runs of a point end, with uncertain parameters at their medians.
    pub fn observation(&self, point: &PointFacts) -> Observation {
        let end_s = self.study.simulation().end_time_s;
        if !self.study.has_stages() || point.point_id >= self.study.point_count() {
            return Observation { begin_s: 0.0, end_s };
        }
        let point = self.study.point(point.point_id);
        Observation {
            begin_s: point.model().last_stage_begins_s(),
            end_s: point.model().end_time_s().map_or(end_s, rounded),
        }
    }

    /// Returns the end of the runs in words, as `33` or `16 to 20`, in s.
    pub fn ends_in_words(&self) -> String {
        let ends = self.points.iter().map(|point| self.observation(point).end_s);
        let (least, most) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), end| {
            (least.min(end), most.max(end))
        });
        match least < most {
            true => format!("{least} to {most}"),
            false if most.is_finite() => most.to_string(),
            false => self.study.simulation().end_time_s.to_string(),
        }
    }
}

/// Returns a sum of durations without the digits that rounding adds.
fn rounded(time_s: f64) -> f64 {
    (time_s * 1e9).round() / 1e9
}
