//! When the runs of a point end, and since when they are observed: from the begin of the last stage on.

use super::{PointFacts, ReportData};

impl ReportData<'_> {
    /// Returns since when the runs of a point are observed (from the begin of the last stage, 0 for a run with one stage), and when
    /// they end at the latest unless they are continued, in s, with uncertain parameters at their medians.
    fn observation(&self, point: &PointFacts) -> [f64; 2] {
        let end_s = self.study.simulation().end_time_s;
        if !self.study.has_stages() {
            return [0.0, end_s];
        }
        let point = self.study.point(point.point_id);
        let model = point.model();
        [model.last_stage_begins_s(), model.end_time_s().map_or(end_s, rounded)]
    }

    /// Returns how long the runs of a point are observed, which is what times to rest are compared with, s.
    pub fn observed_s(&self, point: &PointFacts) -> f64 {
        let [begin_s, end_s] = self.observation(point);
        end_s - begin_s
    }

    /// Returns the end of the runs in words, as `33` or `16 to 20`, in s.
    pub fn ends_in_words(&self) -> String {
        let ends = self.points.iter().map(|point| self.observation(point)[1]);
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
