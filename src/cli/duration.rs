//! Durations in words, from seconds to years.

use super::cost::Cost;

const HUNDRED_YEARS_S: f64 = 100.0 * 365.25 * 86_400.0;

/// Returns an estimate and an upper bound in words.
pub(super) fn cost_in_words(cost: &Cost) -> String {
    let (estimate, bound) = (about(cost.core_seconds), at_most(cost.most_core_seconds));
    format!("{estimate} on one core, if every run lasts to its end (usually much less); {bound}")
}

fn about(seconds: f64) -> String {
    let duration = duration(seconds);
    duration
        .map_or_else(|| "more than 100 years".to_owned(), |duration| format!("about {duration}"))
}

fn at_most(seconds: f64) -> String {
    let words = |duration| format!("at most {duration}, if every run reaches its step limit");
    duration(seconds).map_or_else(|| "no bound below 100 years".to_owned(), words)
}

/// Returns a duration in words; `None` above a hundred years.
fn duration(seconds: f64) -> Option<String> {
    Some(match seconds {
        s if s < 1.0 => "a second".to_owned(),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.0} h", s / 3600.0),
        s if s < 2.0 * 365.25 * 86_400.0 => format!("{:.0} days", s / 86_400.0),
        s if s < HUNDRED_YEARS_S => format!("{:.0} years", s / (365.25 * 86_400.0)),
        _ => return None,
    })
}
