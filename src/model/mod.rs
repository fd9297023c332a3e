//! The mechanical system: parameters, equations of motion, closed forms.

mod case;
mod machine;

pub use case::{Case, Method, Simulation, Start};
pub use machine::{Ball, InvalidParameter, MAX_BALLS, Machine, NormalForce, ball_parameter_name};
