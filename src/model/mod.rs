//! The mechanical system: parameters, equations of motion, closed forms.
//!
//! [`Model`] is the model of a study, in SI units: a [`Machine`] (the ball balancer), or an [`OwnModel`] of a kind that a system
//! file or a program outside this crate defines. [`Balancer`] is the machine without dimensions, with the equations of motion;
//! [`System`] is the interface of all systems. This module does not depend on how motion is integrated or how a run ends.

mod angle;
mod balancer;
mod ball_balancer;
mod ball_contact;
mod balls_in_contact;
mod case;
mod certificate;
mod contact;
mod coordinate;
mod disc_motion;
mod driven;
mod dual;
mod equations;
mod existence;
mod friction;
mod graph;
mod held;
mod interval;
mod invalid_parameter;
mod kick;
mod kind;
mod machine;
mod material;
mod mechanism;
mod modelled;
mod naming;
mod natural_frequencies;
mod number;
mod output;
mod own;
mod recorded;
mod rest;
mod rest_in_contact;
mod shared_loads;
mod speed_profile;
mod stage;
mod system;
mod units;
mod written;

pub use angle::{wrap_to_pi, wrap_to_two_pi};
pub use balancer::{Balancer, BalancerBall, SPHERE_INERTIA, State};
pub use ball_balancer::BALL_BALANCER;
use ball_balancer::PROFILE_PARAMETERS;
pub(crate) use ball_contact::pushes;
pub use ball_contact::{BallContact, Gap, rolling_restitution};
pub use balls_in_contact::{BallsInContact, LASTING_APPROACH};
pub use case::{Case, Endings, Extend, ExtendedLabels, Method, Simulation, Start, Tolerance};
pub use certificate::{certified, certified_by_closed_form};
pub use contact::Contact;
pub use coordinate::{Coordinate, unit_ending};
pub use disc_motion::DiscMotion;
pub use driven::SPEED_TERMS;
pub use dual::Dual;
pub use equations::Forces;
pub use existence::{ExistenceVerdict, SAFE_FRICTION};
pub use friction::{
    Dimension, FRICTION_LAWS, Friction, FrictionLaw, Law, LawInputs, LawParameter, Lowest,
    MAX_LAW_PARAMETERS, Sliding, SlidingForce, SlidingSpeed,
};
pub(crate) use graph::PerStructure;
pub use graph::{
    ContactEquations, ContactLayout, Degree, Event, EventEquations, Expression, ForcingLayout,
    GapEquations, Graph, Layout, Node, NodeId, Opening, OpeningEquations, Recorder, Solve,
    SystemEquations,
};
pub use held::{Column, HeldContact, Holding, gap_columns, held, least_force, strength_that_holds};
pub use interval::{Bounded, Interval};
pub use invalid_parameter::InvalidParameter;
pub use kick::Kick;
pub use kind::{
    Bound, Capabilities, DefaultModel, FRICTION_COEFFICIENT, Field, ModelKind, ParameterDescriptor,
};
pub use machine::{Ball, MAX_BALLS, Machine, NormalForce};
pub use material::{MATERIALS, Material, STEEL_KG_M3};
pub use mechanism::{ImpactLaw, Mechanism, MechanismContact, MechanismNormal};
pub use modelled::{Model, OtherCoordinates};
pub use natural_frequencies::{CampbellDiagram, NaturalFrequencies, SmallMotionEquations};
pub use number::{Elementary, Function, Number};
pub use output::{DerivedQuantity, OutputName, OutputUnits, OutputValue};
pub use own::{ContactNames, OwnKind, OwnModel};
pub use recorded::{ContactMode, add_contact_inputs, add_mechanism_inputs, record_contact};
pub use rest::RestPoint;
pub use rest_in_contact::TOUCHING;
pub use speed_profile::{ProfilePart, Ramp, RampShape, SpeedProfile, SpeedSegment};
pub use stage::Stage;
pub use system::{
    Components, Recorded, RestAmplitude, RestForms, Structure, System, Touching, stiff_pace,
};
pub use units::{ContactUnits, Units};
pub use written::{
    COEFFICIENT, Definition, FaultAt, Formula, FormulaFault, LONGEST_FORMULA, Place, Unit, WHOLE,
    WRITTEN, WrittenContact, WrittenCoordinate, WrittenDerived, WrittenFriction, WrittenNormal,
    WrittenOutput, WrittenParameter, WrittenTurning, law_key, written_kind, written_kind_named,
};
