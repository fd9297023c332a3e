//! A model that is defined outside this crate: the values of its parameters, and what its kind computes from them.

use std::fmt;
use std::sync::Arc;

use serde::{Serialize, Serializer};
use serde_json::Value;

use super::invalid_parameter::{invalid, not_negative, positive};
use super::kind::{Bound, FRICTION_COEFFICIENT, Field, ModelKind, ParameterDescriptor};
use super::{
    Components, Coordinate, DerivedQuantity, Friction, FrictionLaw, InvalidParameter, OutputName,
    SmallMotionEquations, SpeedProfile, SpeedSegment, System, Units,
};

/// What a kind of models outside this crate computes from the parameters of a model. Equal models must give equal
/// values.
pub trait OwnKind: Sync {
    /// Returns the version of the equations. Raise it with each change that alters a motion, so that the program does
    /// not reuse finished runs on disk.
    fn version(&self) -> u32 {
        1
    }

    /// Returns the system file, as plain values, of a kind that a file defines. It tells stored results of different systems
    /// with the same name apart.
    fn source(&self) -> Option<&Value> {
        None
    }

    /// Returns whether contacts have the law of friction of the study.
    fn has_law_of_study(&self) -> bool {
        true
    }

    /// Returns what results call each contact.
    fn contact_names(&self, model: &OwnModel) -> Vec<ContactNames>;

    /// Returns the names of the outputs, in the order of [`Units::outputs`].
    fn output_names(&self, _model: &OwnModel) -> Vec<OutputName> {
        Vec::new()
    }

    /// Returns quantities that follow from the parameters alone.
    fn derived(&self, _model: &OwnModel) -> Vec<DerivedQuantity> {
        Vec::new()
    }

    /// Checks the parameters against each other. Each value alone is already within its bound.
    fn validate(&self, _model: &OwnModel) -> Result<(), InvalidParameter> {
        Ok(())
    }

    /// Returns whether [`OwnKind::validate`] reports parameters of the model.
    fn reports_parameters(&self) -> bool {
        true
    }

    /// Returns the coordinates of a start state, in order. Their names and number may depend on whole numbers only.
    fn coordinates(&self, model: &OwnModel) -> Vec<Coordinate>;

    /// Returns the number of coordinates.
    fn coordinate_count(&self, model: &OwnModel) -> usize {
        self.coordinates(model).len()
    }

    /// Returns the units of the model, with a unit of force for each contact.
    fn units(&self, model: &OwnModel) -> Units;

    /// Returns the equations of small motions; by default, none.
    fn small_motions(&self, _model: &OwnModel) -> SmallMotionEquations {
        SmallMotionEquations::default()
    }

    /// Returns the system without dimensions.
    fn system(&self, model: &OwnModel) -> Arc<dyn System>;

    /// Returns the place of the parameter that is the speed of a part that turns; `None` for a model without such a part.
    fn speed_place(&self) -> Option<usize> {
        None
    }

    /// Returns the system in a stage in which the part that turns has this speed, after this angle. The last component of its state
    /// is the time since the begin of the stage.
    fn system_in_stage(
        &self,
        model: &OwnModel,
        _speed: &SpeedSegment,
        _before_rad: f64,
    ) -> Arc<dyn System> {
        self.system(model)
    }

    /// Returns a start state in the components of the system; `start` has one value for each coordinate.
    fn start_state(&self, model: &OwnModel, start: &[f64]) -> Components;
}

/// What results call a contact.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactNames {
    /// The name of the contact.
    pub contact: String,
    /// The name and the unit of the output that is its position.
    pub position: (String, &'static str),
    /// The unit of the sliding speed.
    pub speed_unit: String,
    /// The unit of the friction force.
    pub force_unit: String,
}

/// A model that is defined outside this crate, in SI units.
#[derive(Clone)]
pub struct OwnModel {
    kind: &'static ModelKind,
    own: &'static dyn OwnKind,
    /// One value for each parameter of the kind that is not part of a speed profile.
    values: Vec<f64>,
    friction: FrictionLaw,
    /// How the speed of the part that turns changes.
    pub(super) speed_profile: Option<SpeedProfile>,
}

impl OwnModel {
    /// Creates a model of a kind with the default values and Coulomb friction.
    pub fn new(kind: &'static ModelKind, own: &'static dyn OwnKind) -> Self {
        let own_values = kind.parameters.iter().filter(|parameter| !parameter.has_own_key());
        OwnModel {
            kind,
            own,
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

    /// Returns the value of the parameter with this name.
    ///
    /// # Panics
    /// Panics if the kind has no such parameter, which is a programming error.
    pub fn number(&self, name: &str) -> f64 {
        let index = self.kind.parameters.iter().position(|parameter| parameter.name == name);
        match index {
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
        let mut parameters = self.kind.parameters.iter();
        let place = parameters.position(|one| one.name == FRICTION_COEFFICIENT)?;
        self.own.has_law_of_study().then(|| self.values[place])
    }

    /// Returns the quantities that follow from the parameters alone.
    pub fn derived(&self) -> Vec<DerivedQuantity> {
        self.own.derived(self)
    }

    /// Returns what the kind computes.
    pub(super) fn own(&self) -> &'static dyn OwnKind {
        self.own
    }

    /// Returns the number that a parameter sets.
    pub(super) fn number_mut(&mut self, parameter: &ParameterDescriptor) -> Option<&mut f64> {
        let is_it = |own: &ParameterDescriptor| own.name == parameter.name;
        self.values.get_mut(self.kind.parameters.iter().position(is_it)?)
    }

    /// Returns the law of friction of the study.
    pub fn friction(&self) -> &FrictionLaw {
        &self.friction
    }

    pub(super) fn friction_mut(&mut self) -> &mut FrictionLaw {
        &mut self.friction
    }

    /// Checks that all values have a physical meaning.
    pub(super) fn validate(&self) -> Result<(), InvalidParameter> {
        self.validate_bounds()?;
        self.own.validate(self)
    }

    /// Checks each value, and what the kind says about single values.
    pub(super) fn validate_values(&self) -> Result<(), InvalidParameter> {
        match self.own.reports_parameters() {
            true => self.validate(),
            false => self.validate_bounds(),
        }
    }

    /// Checks the values of the speed profile.
    pub(super) fn validate_stages(&self) -> Result<(), InvalidParameter> {
        let Some(place) = self.own.speed_place() else { return Ok(()) };
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
                _ if !value.is_finite() => {
                    return Err(invalid(name, &value.to_string(), "a finite number"));
                }
                _ => {}
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
        let version = self.own.version();
        let own = (self.kind.name, version, &self.values, &self.friction, &self.speed_profile);
        match self.own.source() {
            Some(source) => (own, source).serialize(serializer),
            None => own.serialize(serializer),
        }
    }
}
