//! The units in the names of SI keys, such as `speed_rad_s`, and the names that a file may write in place of them.

use std::sync::LazyLock;

use super::quantity::SI_UNITS;
use crate::model::unit_ending;
use crate::study::error::list_names;

/// The endings of SI keys with their units; a longer ending stands before the shorter one that it contains.
static ENDINGS: LazyLock<Vec<(String, &str)>> = LazyLock::new(|| {
    let mut endings: Vec<_> =
        SI_UNITS.iter().map(|(unit, ..)| (unit_ending(unit), *unit)).collect();
    endings.sort_by_key(|(ending, _)| std::cmp::Reverse(ending.len()));
    endings
});

/// The key that takes names of materials in place of densities.
pub(in crate::study) const MATERIAL: &str = "ball_material";
/// The parameter that a material gives.
pub(in crate::study) const DENSITY: &str = "ball_density_kg_m3";

/// Keys below a parameter whose values do not have its unit.
pub(crate) const WITHOUT_UNIT: [&str; 4] = ["count", "spacing", "times", "weights"];

/// Returns the key without its unit and the unit, if this is an SI key with a unit.
pub(crate) fn split_unit(key: &str) -> Option<(&str, &'static str)> {
    ENDINGS.iter().find_map(|(ending, unit)| Some((key.strip_suffix(&**ending)?, *unit)))
}

/// Returns the names that a file may write in place of an SI key.
pub(in crate::study) fn without_unit(si: &str) -> [&str; 2] {
    let short = split_unit(si).map_or(si, |(short, _)| short);
    [short, if si == DENSITY { MATERIAL } else { short }]
}

/// Lists the allowed keys. The key most similar to `found` comes first, possibly without its unit.
pub(crate) fn list_keys<S: AsRef<str>>(found: &str, keys: &[S]) -> String {
    let short: Vec<&str> =
        keys.iter().filter_map(|key| Some(split_unit(key.as_ref())?.0)).collect();
    let with = list_names(found, keys);
    let both: Vec<&str> = keys.iter().map(AsRef::as_ref).chain(short.iter().copied()).collect();
    let nearest = list_names(found, &both);
    // The list of both begins with the nearest name if any name is near.
    match nearest.split_once(" (did you mean this?)") {
        Some((name, _)) if short.contains(&name) => {
            let rest = with.replace(" (did you mean this?)", "");
            format!("{name} (did you mean this?), {rest}")
        }
        _ => with,
    }
}
