//! The run-up of the disc for `check`: which accelerations the balls follow.

use serde_json::{Value, json};

use crate::analysis::{RunUp, run_ups};
use crate::check::short;
use crate::model::Model;

/// Returns one row for each change of speed.
pub(super) fn run_up_rows(model: &Model) -> Vec<(&'static str, String)> {
    let machine = model.ball_balancer();
    let all = machine.map(run_ups).unwrap_or_default();
    all.iter().map(|one| ("run-up", words(one))).collect()
}

fn words(run_up: &RunUp) -> String {
    let RunUp { time_s, speed_rad_s, acceleration_rad_s2, followed_rad_s2, slipping_fraction } =
        run_up;
    let [from, to] = speed_rad_s.map(short);
    let [begin, end] = time_s.map(short);
    let [slow, fast] = followed_rad_s2.map(short);
    let change = format!(
        "{from} to {to} rad/s from {begin} to {end} s, at most {} rad/s²",
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

/// Returns the changes of speed as JSON.
pub(super) fn run_up_json(model: &Model) -> Value {
    let machine = model.ball_balancer();
    let object = |one: &RunUp| {
        json!({
            "time_s": one.time_s,
            "speed_rad_s": one.speed_rad_s,
            "acceleration_rad_s2": one.acceleration_rad_s2,
            "followed_rad_s2": one.followed_rad_s2,
            "slipping_fraction": one.slipping_fraction,
        })
    };
    machine.map(run_ups).unwrap_or_default().iter().map(object).collect()
}
