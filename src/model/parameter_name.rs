//! The names of parameters and coordinates, which end with their units.

/// Returns the ending of names with this unit: `_n_m` for `N/m`; nothing for dimensionless numbers.
pub fn unit_ending(unit: &str) -> String {
    match unit {
        "" | "1" => String::new(),
        // `_n_m` is that of N/m.
        "N m" => "_nm".to_owned(),
        unit => format!("_{}", unit.replace([' ', '/'], "_").to_lowercase()),
    }
}

/// Returns the name of one member's own value of a parameter with a unit.
pub(super) fn member_name(general: &str, unit: &str, number: usize) -> String {
    let ending = unit_ending(unit);
    match general.strip_suffix(&*ending) {
        Some(stem) => format!("{stem}_{number}{ending}"),
        None => format!("{general}_{number}"),
    }
}
