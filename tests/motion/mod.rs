//! Integration of smooth phases, switches, and symmetries of motions.

mod conservation;
mod cut_steps;
mod decision;
mod event;
mod event_limit;
mod event_times;
mod inertial;
mod samples;
mod smooth;
mod symmetry;
mod variation;
mod work_of_friction;
