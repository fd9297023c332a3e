//! The mechanical system: parameters, equations of motion, closed forms.
//!
//! [`Model`] is the model of a study, in SI units: a [`Machine`] (the ball balancer), or an [`OwnModel`] of a kind that a
//! system file or a program outside this crate defines. [`Balancer`] is the machine without dimensions, with the equations
//! of motion; [`System`] is the interface of all systems. This module does not depend on how motion is integrated or how a
//! run ends.
//!
//! Read the base first: [`Number`], [`State`] and [`Dual`] are values and their arithmetics, `graph` records equations, and
//! `friction` has the laws. `contact_mode`, `gap` and [`SpeedProfile`] lead to `system`, the interface of all
//! systems. `mechanism` records a system from a mass matrix, forces and contacts.
//!
//! The balancer follows: [`BallContact`] and [`Kick`] are parts of a [`Machine`] in SI units, and [`Balancer`] has its
//! `equations` without dimensions. The closed forms are in `rest`, `certificate`, `existence` and `held`.
//! `recorded_balancer` and `balls_in_contact` are its systems, and `driven` chooses between them; `rest_in_contact` has the
//! closed forms of balls that touch.
//!
//! The models of studies come last: `parameter` and `kind` say what a kind of model is, `ball_balancer`, `own` and
//! `written` are the kinds, and `modelled` unites them as [`Model`]. What needs a whole model builds on it: [`Case`],
//! `naming`, `parameter_values`, [`CampbellDiagram`] and [`Stage`].

mod angle;
mod balancer;
mod ball_balancer;
mod ball_contact;
mod balls_in_contact;
mod campbell_diagram;
mod case;
mod certificate;
mod contact_mode;
mod coordinate;
mod disc_motion;
mod drawing;
mod driven;
mod dual;
mod equations;
mod existence;
mod friction;
mod gap;
mod given_motion;
mod graph;
mod held;
mod interval;
mod invalid_parameter;
mod kind;
mod machine;
mod material;
mod mechanism;
mod mechanism_contact;
mod modelled;
mod naming;
mod natural_frequencies;
mod number;
mod output;
mod own;
mod parameter;
mod parameter_name;
mod parameter_values;
mod recorded_balancer;
mod redundant_contacts;
mod rest;
mod rest_in_contact;
mod shared_loads;
mod speed_profile;
mod stage;
mod state;
mod system;
mod written;

pub use angle::{wrap_to_pi, wrap_to_two_pi};
pub use balancer::{Balancer, BalancerBall};
pub use ball_balancer::BALL_BALANCER;
pub use ball_contact::{BallContact, SPHERE_INERTIA, rolling_restitution};
pub use balls_in_contact::BallsInContact;
pub use campbell_diagram::CampbellDiagram;
pub use case::{Case, Endings, Extend, ExtendedLabels, Method, Simulation, Tolerance};
pub use certificate::{certified, certified_by_closed_form};
pub use contact_mode::{ContactMode, add_contact_inputs, add_mechanism_inputs, record_contact};
pub use coordinate::{Coordinate, Start};
pub use disc_motion::DiscMotion;
pub use drawing::{Drawing, DrawnForm, DrawnFrame, DrawnQuantity, DrawnShape, DrawnView};
pub use dual::Dual;
pub use equations::Forces;
pub use existence::{ExistenceVerdict, SAFE_FRICTION};
pub use friction::{
    Contact, FRICTION_LAWS, Friction, FrictionLaw, Law, LawDimension, LawInputs, LawNumbers,
    LawParameter, Lowest, MAX_LAW_PARAMETERS, Sliding, SlidingForce, SlidingSpeed,
};
pub use gap::Gap;
pub(crate) use gap::pushes;
pub use given_motion::GivenMotion;
pub use graph::{
    ContactEquations, ContactLayout, Degree, Event, EventEquations, Expression, ForcingLayout,
    GapEquations, Graph, Node, NodeId, Opening, OpeningEquations, Recorder, Solve, StateLayout,
    Structure, SystemEquations, Translation, Translations,
};
pub(crate) use graph::{GraphPart, PerStructure};
pub use held::{
    GapColumn, HeldContact, Holding, MOST_STRENGTH, gap_columns, held, largest_reserve,
    least_force, least_strength, strength_that_holds,
};
pub use interval::{Bounded, Interval};
pub use invalid_parameter::InvalidParameter;
pub use kind::{
    Capabilities, ContactNames, DefaultModel, ModelKind, OwnKind, OwnModel, StageMotion,
};
pub use machine::{Ball, Kick, MAX_BALLS, Machine, NormalForce};
pub use material::{MATERIALS, Material, STEEL_KG_M3};
pub use mechanism::Mechanism;
pub use mechanism_contact::{MechanismContact, MechanismNormal};
pub use modelled::{Model, OtherCoordinates};
pub use natural_frequencies::{NaturalFrequencies, SmallMotionEquations};
pub use number::{Elementary, Function, Number};
pub use output::{ContactUnits, DerivedQuantity, OutputName, OutputUnits, OutputValue, Units};
pub use parameter::{Bound, FRICTION_COEFFICIENT, Field, ParameterDescriptor};
pub use parameter_name::unit_ending;
pub use rest::RestPoint;
pub use rest_in_contact::TOUCHING;
pub use speed_profile::{ProfilePart, Ramp, RampShape, SPEED_TERMS, SpeedProfile, SpeedSegment};
pub use stage::Stage;
pub use state::{Components, State};
pub use system::{
    ImpactLaw, LASTING_APPROACH, Recorded, RestAmplitude, RestForms, System, Touching, stiff_rate,
};
pub use written::{
    COEFFICIENT, FaultAt, Formula, FormulaFault, IndexedName, LONGEST_FORMULA, SystemDefinition,
    WHOLE, WRITTEN, WrittenContact, WrittenCoordinate, WrittenDerived, WrittenFriction,
    WrittenMotion, WrittenNormal, WrittenOutput, WrittenParameter, WrittenShape, WrittenTurning,
    WrittenUnit, WrittenView, law_key, written_kind, written_kind_named,
};
