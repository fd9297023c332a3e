//! Why a motion could not be continued.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A pivot of the mass matrix over the entry on its diagonal, below which the matrix counts as singular.
pub(crate) const SINGULAR: f64 = 1e-12;

/// The reason why a motion could not be continued.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error, Serialize, Deserialize)]
pub enum Failure {
    /// A state or force is infinite or not a number.
    #[error("the state is no longer finite")]
    NotFinite,
    /// The mass matrix is singular or not positive definite.
    #[error("the mass matrix is not positive definite: a motion would have no kinetic energy")]
    IndefiniteMass,
    /// A normal force is no longer positive: a ball would leave the ring, or a body its support, which the model has no
    /// equations for.
    #[error("the normal force of contact {ball} is not positive: its bodies would separate")]
    ContactLost {
        /// The contact, from 1.
        ball: usize,
    },
    /// Bodies are inside each other at the start.
    #[error("the bodies of contact {contact} overlap at the start: their gap is negative")]
    Overlap {
        /// The contact, from 1.
        contact: usize,
    },
    /// The limit of steps and switches was reached, or the step length fell below the minimum.
    #[error("more steps than the limit, or a step length below the smallest possible one")]
    StepLimit,
    /// Stick and slip cannot be decided: no combination meets all conditions, or several do.
    #[error("{} all conditions", combinations_meet("stick and slip", *.solutions))]
    NoSolution {
        /// Number of combinations with different accelerations that meet all conditions.
        solutions: usize,
    },
    /// The impulses of an impact cannot be decided: none meet all conditions, or several do.
    #[error("{} all conditions of an impact", combinations_meet("impulses", *.solutions))]
    UndecidedImpact {
        /// Number of motions after the impact that meet all conditions.
        solutions: usize,
    },
    /// So many contacts or gaps are open to decision at once that not all combinations can be tried.
    #[error("stick, slip or impulses have more combinations than can be tried")]
    TooManyCombinations,
}

/// Returns the number of combinations that meet the conditions as the start of a message.
fn combinations_meet(of: &str, solutions: usize) -> String {
    match solutions {
        0 => format!("no combination of {of} meets"),
        1 => format!("one combination of {of} meets"),
        _ => format!("{solutions} different combinations of {of} meet"),
    }
}
