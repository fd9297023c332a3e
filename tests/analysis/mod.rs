//! Equilibrium sets and equilibria without friction against closed forms and the thesis.

mod frictionless;
mod linearised;
mod sets;
