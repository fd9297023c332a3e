//! Integration of smooth phases, switches, and symmetries of motions.

mod changing_speed;
mod conservation;
mod contact;
mod contact_energy;
mod cut_steps;
mod event;
mod event_limit;
mod event_times;
mod forcing;
mod impacts;
mod inertial;
mod kernels;
mod mode_selection;
mod momentum;
mod opening_contact;
mod operations;
mod recorded_equations;
mod resets;
mod run_down;
mod samples;
mod smooth;
mod symmetry;
mod touching_selection;
mod variational;
