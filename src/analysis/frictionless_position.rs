//! The positions of equilibria without friction: their kinds, and their angles.

use serde::{Deserialize, Serialize};

use crate::named::named;

/// The kind of an equilibrium without friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum FrictionlessKind {
    /// All balls together, on the branch `θ - γ = arcsin(...)`: below the natural frequency the
    /// branch with the larger amplitude. Balls with contact are in a row, each touching the next.
    A1Plus,
    /// All balls together, on the branch `θ - γ = π - arcsin(...)`.
    A1Minus,
    /// Two balls opposite each other.
    A2,
    /// Balanced: the table rests at the centre. Three or more balls have a family of positions; one
    /// of them is given.
    B1,
    /// Three balls or more on one line, some opposite the others.
    Other,
    /// The disc stands still: no force acts, and every position is an equilibrium.
    Everywhere,
}

named!(FrictionlessKind {
    A1Plus: "a1_plus",
    A1Minus: "a1_minus",
    A2: "a2",
    B1: "b1",
    Other: "other",
    Everywhere: "everywhere",
});

/// The position of an equilibrium without friction.
pub(super) struct FrictionlessPosition {
    /// The kind.
    pub kind: FrictionlessKind,
    /// Angle of each ball, in [0, 2π).
    pub beta: Vec<f64>,
    /// Dimension of the family that contains it.
    pub family_dimension: usize,
}
