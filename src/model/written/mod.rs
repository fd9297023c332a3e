//! Mechanical systems that a file describes by formulas.
//!
//! Read [`definition`] first: what a file contains. [`formula`] and [`parser`] turn texts into trees, which [`evaluate`] computes
//! with numbers, expressions ([`numeric`]), dimensions ([`dimensions`]) or dependences ([`dependence`]). [`check`] (and `check_names`) refuses a
//! definition that contradicts itself, [`instance`] has certain numbers of bodies, [`examined`] certain values of the
//! parameters, whose [`sizes`] give the units of the motion, [`velocities`] makes sliding speeds components of the state, and
//! [`system`] records the equations, whose formulas [`in_state`] computes in one state. [`kind`] makes all this a kind of model.

mod check;
mod check_names;
mod definition;
mod dependence;
mod dimensions;
mod evaluate;
mod examined;
mod formula;
mod in_state;
mod instance;
mod kind;
mod linear;
mod measured;
mod names;
mod numeric;
mod parser;
mod scales;
mod sizes;
mod small_motions;
mod system;
mod uniqueness;
mod velocities;

pub use definition::{
    COEFFICIENT, Definition, Place, Unit, WrittenContact, WrittenCoordinate, WrittenDerived,
    WrittenFriction, WrittenNormal, WrittenOutput, WrittenParameter, WrittenTurning, law_key,
};
pub use formula::{Formula, FormulaFault, LONGEST_FORMULA, WHOLE};
pub use instance::FaultAt;
pub use kind::{WRITTEN, written_kind, written_kind_named};
