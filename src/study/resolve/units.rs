//! The key `units`: the units in which people read results; by default, the units that the study writes.

use indexmap::IndexMap;

use crate::model::ModelKind;
use crate::study::error::{Fault, StudyError, list_names, shorten};
use crate::study::file::key_units::split_unit;
use crate::study::file::kind_parameters::parameters_of;
use crate::study::file::quantity::convert;
use crate::study::file::source::Source;
use crate::study::plan::units::{QUANTITIES, ShownUnits, Unit, quantity};

/// Returns the units of a study of this kind of model.
///
/// # Errors
/// Returns an error if a key is neither a quantity nor a parameter with a unit, or if a unit is unknown or of another
/// quantity.
pub(crate) fn resolve_units(
    source: &Source,
    written: Option<&IndexMap<String, String>>,
    kind: &'static ModelKind,
) -> Result<ShownUnits, StudyError> {
    let path = source.path("units");
    let parameters = parameters_of(kind);
    let with_units: Vec<(&str, &str)> =
        parameters.iter().filter_map(|name| split_unit(name)).collect();
    let known = || QUANTITIES.iter().chain(&with_units);
    let mut units = ShownUnits::default();
    for (key, symbol) in written.into_iter().flatten() {
        let path = path.key(key);
        let Some((_, si)) = known().find(|(name, _)| name == key) else {
            let mut names: Vec<&str> = known().map(|(name, _)| *name).collect();
            names.dedup();
            // All names are compared, and only the nearest one and the quantities are listed.
            let all = list_names(key, &names);
            let nearest = all.split_once(" (did you mean this?)").map(|(name, _)| name);
            let listed: Vec<&str> = QUANTITIES.iter().map(|(name, _)| *name).collect();
            let allowed = match nearest.filter(|name| !listed.contains(name)) {
                Some(name) => format!("{name} (did you mean this?), {}", listed.join(", ")),
                None => format!("{}, or a parameter without its unit", list_names(key, &listed)),
            };
            let problem = "neither a quantity nor a parameter with a unit";
            return Err(path.wrong_key(problem, shorten(key), allowed));
        };
        let unit = unit(symbol, si).map_err(|fault| path.refuse_value(fault))?;
        units.0.insert(key.clone(), unit);
    }
    for (key, symbol, si) in &source.units {
        let is_chosen = |name: &str| written.is_some_and(|written| written.contains_key(name));
        // A parameter may have the name of another quantity, such as a stiffness in N m/rad.
        if QUANTITIES.iter().any(|(name, unit)| name == key && unit != si) {
            continue;
        }
        if units.0.contains_key(key) || quantity(si).is_some_and(is_chosen) {
            continue;
        }
        if let Ok(unit) = unit(symbol, si) {
            units.0.insert(key.clone(), unit);
        }
    }
    Ok(units)
}

/// Returns a unit with this SI unit.
fn unit(symbol: &str, si: &str) -> Result<Unit, Fault> {
    let symbol = symbol.trim();
    let si = convert(&format!("1 {symbol}"), si)
        .map_err(|fault| Fault { found: Some(format!("text {:?}", shorten(symbol))), ..fault })?;
    Ok(Unit { symbol: symbol.to_owned(), si })
}

/// Returns the units as a file writes them.
pub(crate) fn units_to_file(units: &ShownUnits) -> Option<IndexMap<String, String>> {
    let file: IndexMap<_, _> =
        units.0.iter().map(|(key, unit)| (key.clone(), unit.symbol.clone())).collect();
    (!file.is_empty()).then_some(file)
}
