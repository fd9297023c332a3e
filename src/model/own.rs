//! A model that is defined outside this crate: the values of its parameters, and their validation.

use std::fmt;

use serde::{Serialize, Serializer};

use super::invalid_parameter::{InvalidParameter, finite, invalid, not_negative, positive};
use super::{
    Bound, DerivedQuantity, FRICTION_COEFFICIENT, Field, Friction, FrictionLaw, ModelKind, OwnKind,
    OwnModel, ParameterDescriptor,
};

impl OwnModel {
    /// Creates a model of a kind with the default values and Coulomb friction.
    pub fn new(kind: &'static ModelKind, own_kind: &'static dyn OwnKind) -> Self {
        let own_values = kind.parameters.iter().filter(|parameter| !parameter.has_own_key());
        OwnModel {
            kind,
            own_kind,
            values: own_values.map(|parameter| parameter.field.default_number()).collect(),
            friction: FrictionLaw::COULOMB,
            speed_profile: None,
        }
    }

    /// Returns the values of the parameters, in their order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the kind.
    pub fn kind(&self) -> &'static ModelKind {
        self.kind
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.kind.parameters.iter().position(|parameter| parameter.name == name)
    }

    /// Returns the value of the parameter with this name.
    ///
    /// # Panics
    /// Panics if the kind has no such parameter, which is a programming error.
    pub fn number(&self, name: &str) -> f64 {
        match self.place(name) {
            Some(index) => self.values[index],
            None => panic!("the kind of model {} has no parameter `{name}`", self.kind.name),
        }
    }

    /// Returns the value of the whole number with this name.
    ///
    /// # Panics
    /// Panics if the kind has no such parameter, which is a programming error.
    pub fn count(&self, name: &str) -> usize {
        self.number(name) as usize
    }

    /// Returns the friction of a contact with the parameter `friction_coefficient`, without dimensions: the unit of
    /// sliding speed is `speed_unit` (SI), and that of the viscous coefficient `drag_unit` (N s/m).
    pub fn contact(&self, speed_unit: f64, drag_unit: f64) -> Friction {
        self.friction.contact(self.number(FRICTION_COEFFICIENT), speed_unit, drag_unit)
    }

    /// Returns the coefficient of friction that all contacts share; `None` for contacts with their own.
    pub(super) fn friction_coefficient(&self) -> Option<f64> {
        let place = self.place(FRICTION_COEFFICIENT)?;
        self.own_kind.has_law_of_study().then(|| self.values[place])
    }

    /// Returns the quantities that follow from the parameters alone.
    pub fn derived(&self) -> Vec<DerivedQuantity> {
        self.own_kind.derived(self)
    }

    /// Returns the number that a parameter sets.
    pub(super) fn number_mut(&mut self, parameter: &ParameterDescriptor) -> Option<&mut f64> {
        let place = self.place(parameter.name)?;
        self.values.get_mut(place)
    }

    /// Returns the law of friction of the study.
    pub fn friction(&self) -> &FrictionLaw {
        &self.friction
    }

    /// Checks that all values have a physical meaning.
    pub(super) fn validate(&self) -> Result<(), InvalidParameter> {
        self.validate_bounds()?;
        self.own_kind.validate(self)
    }

    /// Checks each value, and what the kind says about single values.
    pub(super) fn validate_values(&self) -> Result<(), InvalidParameter> {
        match self.own_kind.reports_parameters() {
            true => self.validate(),
            false => self.validate_bounds(),
        }
    }

    /// Checks the values of the speed profile.
    pub(super) fn validate_stages(&self) -> Result<(), InvalidParameter> {
        let Some(place) = self.own_kind.speed_place() else { return Ok(()) };
        let last @ (name, speed_rad_s) = (self.kind.parameters[place].name, self.values[place]);
        match &self.speed_profile {
            Some(profile) => profile.validate(last),
            None if speed_rad_s == 0.0 => Err(invalid(name, "0", "a speed that is not zero")),
            None => Ok(()),
        }
    }

    fn validate_bounds(&self) -> Result<(), InvalidParameter> {
        self.validate_stages()?;
        for (parameter, &value) in self.kind.parameters.iter().zip(&self.values) {
            let name = parameter.name;
            match parameter.field {
                Field::Own { bound: Bound::Positive, .. } => positive(name, value)?,
                Field::Own { bound: Bound::NotNegative, .. } => not_negative(name, value)?,
                _ => finite(name, value)?,
            }
        }
        match self.friction_coefficient() {
            Some(coefficient) => self.friction.validate(coefficient, self.kind.sliding_speed),
            None => Ok(()),
        }
    }
}

impl PartialEq for OwnModel {
    fn eq(&self, other: &Self) -> bool {
        (self.kind, &self.values, &self.friction) == (other.kind, &other.values, &other.friction)
            && self.speed_profile == other.speed_profile
    }
}

impl fmt::Debug for OwnModel {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = out.debug_struct(self.kind.name);
        for (parameter, value) in self.kind.parameters.iter().zip(&self.values) {
            shown.field(parameter.name, value);
        }
        shown.field("friction", &self.friction);
        shown.field("speed_profile", &self.speed_profile).finish()
    }
}

/// The name and the version of the kind and the values determine the stored results of a case.
impl Serialize for OwnModel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let version = self.own_kind.version();
        let identity = (self.kind.name, version, &self.values, &self.friction, &self.speed_profile);
        match self.own_kind.source() {
            Some(source) => (identity, source).serialize(serializer),
            None => identity.serialize(serializer),
        }
    }
}
