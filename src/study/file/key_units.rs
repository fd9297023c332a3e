//! The units in the names of SI keys, such as `speed_rad_s`, and the names that a file may write in place of them.

use crate::study::error::list_names;

/// The endings of SI keys with their units; a longer ending stands before the shorter one that it contains.
const ENDINGS: [(&str, &str); 19] = [
    ("_n_m_s_rad", "N m s/rad"),
    ("_n_m_rad", "N m/rad"),
    ("_n_m_s", "N m s"),
    ("_n_s_m", "N s/m"),
    ("_rad_s2", "rad/s2"),
    ("_rad_s", "rad/s"),
    ("_n_m", "N/m"),
    ("_m_s2", "m/s2"),
    ("_m_s", "m/s"),
    ("_kg_m2", "kg m2"),
    ("_nm", "N m"),
    ("_1_s", "1/s"),
    ("_rad", "rad"),
    ("_kg_m3", "kg/m3"),
    ("_kg_m", "kg m"),
    ("_kg", "kg"),
    ("_m", "m"),
    ("_n", "N"),
    ("_s", "s"),
];

/// The key that takes names of materials in place of densities.
pub(in crate::study) const MATERIAL: &str = "ball_material";
/// The parameter that a material gives.
pub(in crate::study) const DENSITY: &str = "ball_density_kg_m3";

/// Keys below a parameter whose values do not have its unit.
pub(crate) const WITHOUT_UNIT: [&str; 4] = ["count", "spacing", "times", "weights"];

/// Returns the key without its unit and the unit, if this is an SI key with a unit.
pub(crate) fn split_unit(key: &str) -> Option<(&str, &'static str)> {
    ENDINGS.iter().find_map(|(ending, unit)| Some((key.strip_suffix(ending)?, *unit)))
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
