//! An evaluated design of a search.

use crate::named::named;
use crate::responses::Answer;
use crate::study::DesignValue;

/// Why a design was evaluated.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum DesignOrigin {
    /// The design that the best one is compared with.
    CompareWith,
    /// A space-filling design over all ranges and choices.
    SpaceFilling,
    /// A design that the surrogates proposed.
    Surrogates,
    /// The next space-filling design, because the surrogates proposed none or a repeated one.
    SpaceFillingInstead,
}

named!(DesignOrigin {
    CompareWith: "compare_with",
    SpaceFilling: "spread",
    Surrogates: "surrogates",
    SpaceFillingInstead: "spread_instead",
});

/// A design with its responses at every point of the sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// Why the design was evaluated.
    pub origin: DesignOrigin,
    /// One value per variable of the study.
    pub values: Vec<DesignValue>,
    /// One answer per point.
    pub answers: Vec<Answer>,
}
