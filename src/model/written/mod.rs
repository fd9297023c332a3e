//! Mechanical systems that a file describes by formulas.
//!
//! Read [`formula`] and [`parser`] first, which turn texts into trees, and [`definition`], which has the content of a
//! file. [`evaluate`] walks through a tree: [`numeric`] gives its value, [`dependence`] finds what it depends on, and
//! [`dimensions`] finds its dimension. [`instance`] fixes the numbers of bodies. [`check`] and [`check_names`] refuse a
//! definition that contradicts itself. [`velocities`] uses the [`linear`] forms of sliding speeds as components of the
//! state.
//!
//! Then read [`system`], which records the equations, and [`measured`], which evaluates the outputs. [`in_state`]
//! examines a system in one state. [`sizes`] gives the units of the motion, [`examined`] checks a system with values of
//! its parameters, [`small_motions`] has its equations of small motions, [`drawn`] has its pictures, and
//! [`latex`] its equations in print. Read [`kind`] last: it unites all this.

mod check;
mod check_names;
mod definition;
mod dependence;
mod dimensions;
mod drawn;
mod evaluate;
mod examined;
mod formula;
mod given_terms;
mod in_state;
mod instance;
mod instance_values;
mod kind;
mod latex;
mod linear;
mod measured;
mod names;
mod numeric;
mod parser;
mod sizes;
mod small_motions;
mod state_units;
mod system;
mod velocities;

pub use definition::{
    COEFFICIENT, IndexedName, SystemDefinition, WrittenContact, WrittenCoordinate, WrittenDerived,
    WrittenFriction, WrittenMotion, WrittenNormal, WrittenOutput, WrittenParameter, WrittenShape,
    WrittenTurning, WrittenUnit, WrittenView, law_key,
};
pub use formula::{Formula, FormulaFault, LONGEST_FORMULA, WHOLE};
pub use instance::FaultAt;
pub use kind::{WRITTEN, written_kind, written_kind_named};
