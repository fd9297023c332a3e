//! The lines below the closed forms of `check`: what the columns mean, and what the points have in common.

use crate::check::{BalancerFacts, is_held_everywhere};
use crate::numbers::short;
use crate::study::Unit;

/// Explains the columns, and states the worst rest, the points below the natural frequency or with
/// too much friction, and the direction of the axis, in words.
pub(super) fn legend(balancers: &[(u64, &BalancerFacts)], speed: &Unit) -> String {
    let mut text = "set: fraction of all ball positions at which friction holds the balls; worst rest: the largest \
                    amplitude there;\noverlap: fraction of these positions in which balls overlap; balance: stability \
                    of the balancing position without friction\n"
        .to_owned();
    let ratio = |(point_id, facts): &(u64, &BalancerFacts)| {
        let ratio = facts.rest?.max_amplitude_m? / facts.amplitude_without_balls_m?;
        ratio.is_finite().then_some((ratio, *point_id))
    };
    let worst = balancers.iter().filter_map(ratio).max_by(|left, right| left.0.total_cmp(&right.0));
    if let Some((ratio, point_id)) = worst {
        let place =
            if balancers.len() == 1 { String::new() } else { format!(" (point {point_id})") };
        text += &format!(
            "balls that rest in the worst position make the vibration {} times that without balls{place}; balls that \
             keep moving can make it larger\n",
            short(ratio)
        );
    }
    let mut at_some = |is_so: &dyn Fn(&BalancerFacts) -> bool, words: &str| {
        let count = balancers.iter().filter(|(_, facts)| is_so(facts)).count();
        if count > 0 {
            text += &format!("at {count} of {} points {words}\n", balancers.len());
        }
    };
    at_some(
        &|facts| facts.speed_ratio < 1.0,
        "the disc is slower than the natural frequency, where the balancing position is not stable",
    );
    at_some(
        &|facts| {
            let is_held = facts.rest.is_some_and(|rest| is_held_everywhere(rest.set_fraction));
            facts.speed_ratio > 0.0 && is_held
        },
        "friction holds the balls in every position, so that no force moves them to the balancing position",
    );
    text + &on_a_horizontal_axis(balancers, speed)
}

/// Says that the axis is vertical, and what gravity does on a horizontal one, at the point with the most gravity.
fn on_a_horizontal_axis(balancers: &[(u64, &BalancerFacts)], speed: &Unit) -> String {
    let ratio = |(point_id, facts): &(u64, &BalancerFacts)| {
        Some((facts.gravity_over_friction?, *point_id, facts.speed_rad_s()))
    };
    let most = balancers.iter().filter_map(ratio).max_by(|left, right| left.0.total_cmp(&right.0));
    let Some((ratio, point_id, speed_rad_s)) = most else {
        return "the axis is vertical: the model leaves gravity out\n".to_owned();
    };
    let point = if balancers.len() == 1 { String::new() } else { format!(" at point {point_id}") };
    format!(
        "the axis is vertical: the model leaves gravity out. On a horizontal axis, gravity is {} % of the friction\n\
         μ ω² R that holds a ball{point}, and no ball stays at rest below sqrt(g/(μ R)) = {} {}\n",
        short(100.0 * ratio),
        short(speed.of(speed_rad_s * ratio.sqrt())),
        speed.symbol,
    )
}
