//! Finds what formulas depend on, so that a mass does not depend on rates of change, and a sliding speed only linearly.

use std::iter::Sum;

use super::names::Meaning;

/// What a term depends on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Dependence {
    pub time: bool,
    /// On a motion that a table gives over time.
    pub given: bool,
    /// On the speed or the acceleration of such a motion.
    pub given_rate: bool,
    pub positions: bool,
    /// The degree in the rates of change: 0, 1, or 2 for any other dependence.
    pub rates: u8,
    /// The degree in the accelerations.
    pub accelerations: u8,
}

impl Dependence {
    /// Returns what a name depends on.
    pub fn of(meaning: Meaning) -> Dependence {
        let none = Dependence::default();
        match meaning {
            Meaning::Time => Dependence { time: true, ..none },
            Meaning::Given => Dependence { given: true, ..none },
            Meaning::GivenRate => Dependence { given: true, given_rate: true, ..none },
            Meaning::Position => Dependence { positions: true, ..none },
            Meaning::Rate => Dependence { rates: 1, ..none },
            Meaning::Acceleration => Dependence { accelerations: 1, ..none },
            Meaning::Constant => none,
        }
    }

    pub fn with(self, other: Dependence) -> Dependence {
        Dependence {
            time: self.time || other.time,
            given: self.given || other.given,
            given_rate: self.given_rate || other.given_rate,
            positions: self.positions || other.positions,
            rates: self.rates.max(other.rates),
            accelerations: self.accelerations.max(other.accelerations),
        }
    }

    /// Returns what a product depends on; `over` for a quotient.
    pub fn times(self, over: bool, factor: Dependence) -> Dependence {
        let degree = |of: u8| if over { 2 * of.min(1) } else { of };
        Dependence {
            rates: (self.rates + degree(factor.rates)).min(2),
            accelerations: (self.accelerations + degree(factor.accelerations)).min(2),
            ..self.with(factor)
        }
    }

    /// Returns what a function of the term depends on.
    pub fn curved(self) -> Dependence {
        let (rates, accelerations) = (2 * self.rates.min(1), 2 * self.accelerations.min(1));
        Dependence { rates, accelerations, ..self }
    }

    /// Returns whether the term is the same in all states at all times.
    pub fn is_constant(self) -> bool {
        self == Dependence::default()
    }
}

impl Sum for Dependence {
    fn sum<I: Iterator<Item = Dependence>>(terms: I) -> Dependence {
        terms.fold(Dependence::default(), Dependence::with)
    }
}
