//! Equilibrium sets and frictionless equilibria against closed forms and the thesis; classes of
//! limit cycles.

mod cycle_classes;
mod cycle_groups;
mod frictionless;
mod linearised;
mod sets;
