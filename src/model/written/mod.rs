//! Mechanical systems that a file describes by formulas.
//!
//! Read [`formula`] and [`parser`] first, which turn texts into trees, and [`definition`]: what a file contains. [`evaluate`]
//! computes trees with numbers or expressions ([`numeric`]), [`dependence`] or [`dimensions`]. [`instance`] gives a
//! definition certain numbers of bodies, and [`check`] and [`check_names`] refuse one that contradicts itself. [`linear`]
//! forms are used by [`velocities`], which makes sliding speeds components of the state. [`measured`] evaluates the outputs
//! of a [`system`], which records its equations, and [`in_state`] and [`uniqueness`] examine it in one state. [`sizes`] gives
//! the units of the motion, from which [`examined`] makes a system of values of the parameters; [`small_motions`] are its
//! equations of small motions. [`kind`] makes all this a kind of model.

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
mod instance_values;
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
    COEFFICIENT, IndexedName, SystemDefinition, WrittenContact, WrittenCoordinate, WrittenDerived,
    WrittenFriction, WrittenNormal, WrittenOutput, WrittenParameter, WrittenTurning, WrittenUnit,
    law_key,
};
pub use formula::{Formula, FormulaFault, LONGEST_FORMULA, WHOLE};
pub use instance::FaultAt;
pub use kind::{WRITTEN, written_kind, written_kind_named};
