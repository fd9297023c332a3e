//! A design of a search with its responses.

use crate::responses::Answer;
use crate::study::DesignValue;

/// Why a design was looked at.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Origin {
    /// It is the one that the best is compared with.
    CompareWith,
    /// It is one of those spread over all ranges and choices.
    OrderStatistics,
    /// Surrogates chose it.
    Surrogates,
    /// Surrogates chose none, or one that had been looked at: the next of those spread.
    Instead,
}

impl Origin {
    const ALL: [Origin; 4] =
        [Origin::CompareWith, Origin::OrderStatistics, Origin::Surrogates, Origin::Instead];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Origin::CompareWith => "compare_with",
            Origin::OrderStatistics => "spread",
            Origin::Surrogates => "surrogates",
            Origin::Instead => "spread_instead",
        }
    }

    /// The one of this name.
    pub fn named(name: &str) -> Option<Origin> {
        Origin::ALL.into_iter().find(|origin| origin.name() == name)
    }
}

/// A design with its responses at every point of the sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// Why it was looked at.
    pub origin: Origin,
    /// One value per variable of the study.
    pub values: Vec<DesignValue>,
    /// One answer per point.
    pub answers: Vec<Answer>,
}
