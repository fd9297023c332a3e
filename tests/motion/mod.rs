//! Integration of smooth phases, switches, and the symmetries that every motion has.

mod decision;
mod smooth;
mod symmetry;
mod work_of_friction;
