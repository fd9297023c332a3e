//! The kinds of models, and what a kind outside this crate computes from the values of a model.

use std::fmt;
use std::sync::Arc;

use serde_json::Value;

use super::{
    Components, Coordinate, DerivedQuantity, Drawing, FrictionLaw, GivenMotion, InvalidParameter,
    Machine, OutputName, ParameterDescriptor, SlidingSpeed, SmallMotionEquations, SpeedProfile,
    SpeedSegment, System, Units,
};

/// A kind of model.
pub struct ModelKind {
    /// The name in a study file.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub meaning: &'static str,
    /// Its parameters without those of the friction law, in the order of the documentation.
    pub parameters: &'static [ParameterDescriptor],
    /// The word for the body at each contact, such as `block`.
    pub body: &'static str,
    /// The unit of its sliding speeds.
    pub sliding_speed: SlidingSpeed,
    /// What the program offers for it beside its motion.
    pub offers: Capabilities,
    /// The model with the default values.
    pub default: DefaultModel,
}

/// The model of a kind with the default values.
pub enum DefaultModel {
    /// A ball balancer, with one ball.
    BallBalancer(fn() -> Machine),
    /// An own model; the value computes its coordinates, units and system.
    Own(&'static dyn OwnKind),
}

/// What the program offers for a kind of model beside its motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities {
    /// Residual vibration, compared with that of the same machine without balls.
    pub vibration: bool,
    /// Equilibrium sets and equilibria without friction, by closed forms.
    pub equilibrium_set: bool,
}

impl Capabilities {
    /// Nothing beside the motion.
    pub const MOTION: Self = Capabilities { vibration: false, equilibrium_set: false };
}

impl ModelKind {
    /// Returns whether the study gives the law of friction of contacts.
    pub fn has_law_of_study(&self) -> bool {
        match self.default {
            DefaultModel::Own(kind) => kind.has_law_of_study(),
            DefaultModel::BallBalancer(_) => true,
        }
    }

    /// Returns the system file, as plain values, of a kind that a file defines.
    pub fn source(&self) -> Option<&'static serde_json::Value> {
        match self.default {
            DefaultModel::Own(kind) => kind.source(),
            DefaultModel::BallBalancer(_) => None,
        }
    }
}

impl PartialEq for ModelKind {
    fn eq(&self, other: &Self) -> bool {
        // Definitions are long.
        std::ptr::eq(self, other) || (self.name, self.source()) == (other.name, other.source())
    }
}

impl fmt::Debug for ModelKind {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name)
    }
}

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

    /// Returns the pictures of the machine for an animation; by default, none.
    fn drawing(&self, _model: &OwnModel) -> Option<Drawing> {
        None
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

    /// Returns the motions that tables give over time.
    fn motions(&self) -> Vec<&GivenMotion> {
        Vec::new()
    }

    /// Returns the system in a stage of its run, and whether the last component of its state is the time since the begin of the
    /// stage.
    fn system_in_stage(&self, model: &OwnModel, _stage: &StageMotion) -> (Arc<dyn System>, bool) {
        (self.system(model), false)
    }

    /// Returns the time, s, before the end of a run from which on the equations no longer depend on it, and the system from then on,
    /// without the time in its state; `None` if there is none, and for a system whose run has other stages. A run that is continued
    /// beyond its end keeps the stages that it has.
    fn lasting_system(&self, _model: &OwnModel, _end_s: f64) -> Option<(f64, Arc<dyn System>)> {
        None
    }

    /// Returns a start state in the components of the system; `start` has one value for each coordinate.
    fn start_state(&self, model: &OwnModel, start: &[f64]) -> Components;
}

/// How parts move in a stage of a run by themselves.
#[derive(Clone, Debug, PartialEq)]
pub struct StageMotion {
    /// The begin of the stage, s.
    pub begins_s: f64,
    /// For a model with a part that turns: how far it has turned before, rad, and its speed from the begin of the stage on.
    pub turning: Option<(f64, SpeedSegment)>,
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
    pub(super) kind: &'static ModelKind,
    pub(super) own_kind: &'static dyn OwnKind,
    /// One value for each parameter of the kind that is not part of a speed profile.
    pub(super) values: Vec<f64>,
    pub(super) friction: FrictionLaw,
    /// How the speed of the part that turns changes.
    pub(super) speed_profile: Option<SpeedProfile>,
}
