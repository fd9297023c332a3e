//! The mechanical system: parameters, equations of motion, closed forms.
//!
//! [`Machine`] is what a study names, in SI units; [`Balancer`] the same without dimensions, with
//! the equations of motion. Nothing here knows how motion is integrated or how a run ends.

mod balancer;
mod case;
mod equations;
mod existence;
pub mod extended_lagrange;
mod machine;
mod number;
mod rest;

pub use balancer::{Balancer, BalancerBall, State};
pub use case::{Case, Method, Simulation, Start};
pub use equations::{Contact, Forces};
pub use existence::{ExistenceVerdict, SAFE_FRICTION};
pub use machine::{Ball, InvalidParameter, MAX_BALLS, Machine, NormalForce, ball_parameter_name};
pub use number::Number;
pub use rest::RestPoint;
