//! How a run ends: from a case to a label, with the evidence for it.
//!
//! Every ending is claimed on evidence and named with it:
//!
//! | label | evidence | what has been shown |
//! |---|---|---|
//! | `equilibrium` | `rest_certified` | all balls stick and, by the closed form, can never break loose |
//! | `equilibrium` | `creep` | all balls are slow and drift, ever slower, at the edge of the equilibrium set |
//! | `equilibrium` | `settled` | without dry friction: an equilibrium is near, and it is stable by its eigenvalues |
//! | `limit_cycle` | `closed_orbit` | the orbit closes modulo 2π, its multipliers lie inside the unit circle, resting balls keep a margin |
//! | `undecided` | `unstable_orbit` | the orbit closes, but a multiplier lies outside the unit circle |
//! | `undecided` | `end_time` | none of the above until the end time |
//! | `failed` | the failure's kind | the motion could not be continued |
//!
//! `irregular` (evidence `lyapunov`) is part of the vocabulary but not yet given: what shows no
//! closed orbit stays `undecided`.

mod balancer;
mod block;
mod block_cycle;
mod certificate;
mod creep;
mod cycle;
mod orbit;
mod outcome;
mod return_map;
mod settled;
mod simulate;

pub use certificate::{certified, certified_by_closed_form};
pub use cycle::{Cycle, Doing};
pub use orbit::OrbitWatch;
pub use outcome::{Evidence, Label, LyapunovExponent, Outcome};
pub use return_map::Orbit;
pub use simulate::simulate;
