//! The run-up of the disc for `check`: which accelerations the balls follow.

use serde_json::json;

use super::output::StudyFacts;
use crate::analysis::{RunUp, run_ups};
use crate::check::points_to_examine;
use crate::numbers::short;
use crate::responses::merged;
use crate::study::{Study, Unit};

/// The most points whose run-ups are compared.
const MOST_POINTS: u64 = 1000;

/// Returns the changes of speed at the point at which the balls slip longest, and the number of that point if the points
/// differ.
fn longest_slipping(study: &Study) -> (Option<u64>, Vec<RunUp>) {
    let of_point = |point_id: u64| {
        let point = study.point(point_id);
        (point_id, point.model().ball_balancer().map(run_ups).unwrap_or_default())
    };
    let slips = |all: &[RunUp]| {
        let each =
            all.iter().map(|ramp| ramp.slipping_fraction * (ramp.time_s[1] - ramp.time_s[0]));
        each.sum::<f64>()
    };
    let points = points_to_examine(study.point_count(), MOST_POINTS).into_iter();
    let all: Vec<(u64, Vec<RunUp>)> = points.map(of_point).collect();
    let differ = all.windows(2).any(|pair| pair[0].1 != pair[1].1);
    let longest = all
        .into_iter()
        .reduce(|longest, other| if slips(&other.1) > slips(&longest.1) { other } else { longest });
    longest.map_or_else(Default::default, |(point_id, all)| (differ.then_some(point_id), all))
}

/// Returns a fact for each change of speed.
pub(super) fn run_ups_of(study: &Study) -> StudyFacts {
    let (point_id, all) = longest_slipping(study);
    let at = point_id.map(|id| format!(" (point {id}, where they slip longest)"));
    let at = at.unwrap_or_default();
    let unit = study.units().speed();
    let row = |run_up| ("run-up", format!("{}{at}", words(run_up, &unit)));
    let json = |run_up: &RunUp| merged(json!(run_up), json!({"point_id": point_id}));
    StudyFacts { words: all.iter().map(row).collect(), json: all.iter().map(json).collect() }
}

fn words(run_up: &RunUp, unit: &Unit) -> String {
    let RunUp { time_s, speed_rad_s, acceleration_rad_s2, followed_rad_s2, slipping_fraction } =
        run_up;
    let [from, to] = speed_rad_s.map(|speed| short(unit.of(speed)));
    let symbol = &unit.symbol;
    let [begin, end] = time_s.map(short);
    let [slow, fast] = followed_rad_s2.map(short);
    let change = format!(
        "{from} to {to} {symbol} from {begin} to {end} s, at most {} rad/s²",
        short(*acceleration_rad_s2)
    );
    let followed =
        format!("sticking balls follow {slow} rad/s² at its begin and {fast} at its end");
    let slips = match slipping_fraction {
        0.0 => "they can follow all of it".to_owned(),
        fraction => format!("they slip in {} % of its time or more", short(100.0 * fraction)),
    };
    format!("{change}; {followed}: {slips}")
}
