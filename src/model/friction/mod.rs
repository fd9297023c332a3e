//! Friction laws: the friction force as a function of sliding speed and normal force.
//!
//! A law is one file here, with a line in [`FRICTION_LAWS`]. The study file, the JSON Schema, sweeps,
//! distributions, design variables, columns and the motion take everything else from its [`Law`].
//!
//! Read `law` first: what a law defines. [`FrictionLaw`] has the values of its parameters in SI units,
//! and [`Friction`] is the friction of one contact without dimensions, as the motion uses it. The laws follow in the order
//! of [`FRICTION_LAWS`]; `viscous` shares its parameter with `coulomb_viscous`.

mod coulomb;
mod coulomb_viscous;
mod friction_law;
mod law;
mod non_dimensional;
mod smooth;
mod stribeck;
mod viscous;

pub use friction_law::FrictionLaw;
use law::about;
pub use law::{
    Law, LawDimension, LawInputs, LawNumbers, LawParameter, Lowest, MAX_LAW_PARAMETERS, Sliding,
    SlidingForce, SlidingSpeed,
};
pub use non_dimensional::{Contact, Friction};

/// All friction laws, in the order of the documentation.
pub static FRICTION_LAWS: [&dyn Law; 5] = [
    &coulomb::Coulomb,
    &stribeck::Stribeck,
    &smooth::Smooth,
    &viscous::Viscous,
    &coulomb_viscous::CoulombViscous,
];
