//! The units in which people read results. Files of results and JSON stay in SI units.

use indexmap::IndexMap;

use crate::study::file::key_units::split_unit;

/// The quantities with a unit of their own: the key under `units`, and the SI unit.
pub(crate) const QUANTITIES: [(&str, &str); 10] = [
    ("speed", "rad/s"),
    ("velocity", "m/s"),
    ("length", "m"),
    ("mass", "kg"),
    ("density", "kg/m3"),
    ("imbalance", "kg m"),
    ("force", "N"),
    ("stiffness", "N/m"),
    ("damping", "N s/m"),
    (VIBRATION, "m"),
];

/// The quantity of amplitudes.
const VIBRATION: &str = "vibration";

/// A unit in which a value is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Symbol, such as `rpm`.
    pub symbol: String,
    /// The value of one unit in SI units.
    pub si: f64,
}

impl Unit {
    /// Returns a value in SI units in this unit.
    pub fn of(&self, value_si: f64) -> f64 {
        // If 1/si is a whole number, the product has one rounding error; the quotient would have two, because 1e-6 is rounded.
        let per_si = self.si.recip();
        if per_si.fract() == 0.0 { per_si * value_si } else { value_si / self.si }
    }
}

/// The units of a study, by quantity or by parameter without the unit in its name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShownUnits(pub(in crate::study) IndexMap<String, Unit>);

impl ShownUnits {
    /// Returns the unit of a parameter; `None` if it is shown in SI units.
    pub fn of_parameter(&self, name: &str) -> Option<&Unit> {
        let (short, si) = split_unit(name)?;
        let of_all = || short.trim_end_matches(|end: char| end.is_ascii_digit()).strip_suffix('_');
        let unit = self.0.get(short).or_else(|| self.0.get(of_all()?));
        unit.or_else(|| self.0.get(quantity(si)?))
    }

    /// Returns the unit in which a parameter is shown.
    pub fn shown(&self, name: &str) -> Unit {
        let si = || split_unit(name).map_or("", |(_, si)| si);
        let default = || Unit { symbol: si().to_owned(), si: 1.0 };
        self.of_parameter(name).cloned().unwrap_or_else(default)
    }

    /// Returns the unit of the amplitudes of vibration: µm unless the study chooses another one.
    pub fn vibration(&self) -> Unit {
        let default = || Unit { symbol: "µm".to_owned(), si: 1e-6 };
        self.0.get(VIBRATION).cloned().unwrap_or_else(default)
    }

    /// Returns whether the study chooses the unit of the amplitudes of vibration.
    pub fn chooses_vibration(&self) -> bool {
        self.0.contains_key(VIBRATION)
    }

    /// Returns the unit of imbalances.
    pub fn imbalance(&self) -> Unit {
        let default = || Unit { symbol: "g mm".to_owned(), si: 1e-6 };
        self.0.get("imbalance").cloned().unwrap_or_else(default)
    }

    /// Returns the unit of a response with this SI unit; without a symbol for pure numbers.
    pub fn of_response(&self, si: &str) -> Unit {
        match si {
            "m" => self.vibration(),
            "1" => Unit { symbol: String::new(), si: 1.0 },
            other => Unit { symbol: other.to_owned(), si: 1.0 },
        }
    }

    /// Returns the unit of speeds of rotation.
    pub fn speed(&self) -> Unit {
        let default = || Unit { symbol: "rad/s".to_owned(), si: 1.0 };
        self.0.get("speed").cloned().unwrap_or_else(default)
    }
}

/// Returns the name of a parameter without its unit, such as `ball_mass_1` for `ball_mass_1_kg`.
pub(crate) fn short_name(name: &str, unit: &str) -> String {
    split_unit(name).filter(|(_, si)| *si == unit).map_or(name, |(short, _)| short).to_owned()
}

/// Returns the quantity with this SI unit; a length, not a vibration, for `m`.
pub(in crate::study) fn quantity(si: &str) -> Option<&'static str> {
    QUANTITIES.iter().find(|(_, unit)| *unit == si).map(|(name, _)| *name)
}
