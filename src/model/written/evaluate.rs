//! Evaluates formulas: with numbers, with expressions of a record, or with what a check needs to know of each term.

use super::formula::{
    Dimension, Formula, FormulaFault, FormulaFunction, FormulaTerm, NONE, Name, TermContent, Valued,
};

/// The largest number of terms of all formulas of a system together, with each body counted.
pub(super) const MOST_TERMS: usize = 200_000;

/// The values that a formula is evaluated with.
pub(super) trait FormulaValues {
    /// A value.
    type Value: Clone;

    /// Returns a number; `dimension` is that of the terms around it, and `place` its place among the numbers.
    fn number(&mut self, value: f64, dimension: Dimension, place: usize) -> Self::Value;

    /// Returns a number in the SI unit of a dimension.
    fn quantity(&mut self, value: f64, dimension: Dimension) -> Self::Value {
        self.number(value, dimension, 0)
    }

    /// Returns the value of a name; `body` is the number of the body, if the name has one.
    fn named(&mut self, at: usize, name: &Name, body: Option<i64>) -> Valued<Self::Value>;

    /// Returns a sum; the flag is set for what is subtracted.
    fn sum(&mut self, at: usize, terms: Vec<(bool, Self::Value)>) -> Valued<Self::Value>;

    /// Returns a product; the flag is set for what is divided by.
    fn product(&mut self, at: usize, factors: Vec<(bool, Self::Value)>) -> Valued<Self::Value>;

    /// Returns a power.
    fn power(&mut self, at: usize, base: Self::Value, exponent: f64) -> Valued<Self::Value>;

    /// Returns the value of a function.
    fn call(
        &mut self,
        at: usize,
        function: FormulaFunction,
        of: Self::Value,
    ) -> Valued<Self::Value>;
}

/// Whole numbers with their names.
pub(super) type NamedCounts = Vec<(String, i64)>;

/// The bodies of a system: how many each index counts, and the numbers that indices have now.
#[derive(Clone, Debug, Default)]
pub(super) struct Bodies {
    /// Each index, with the number of its bodies.
    pub indices: Vec<(String, i64)>,
    /// The whole numbers among the parameters.
    pub counts: NamedCounts,
    /// The present values of indices, innermost last.
    pub bound: Vec<(String, i64)>,
    /// How many terms have been evaluated.
    pub terms: usize,
}

impl Bodies {
    /// Returns the number of bodies that an index counts.
    pub fn of(&self, index: &str) -> Option<i64> {
        self.indices.iter().find(|(name, _)| name == index).map(|(_, count)| *count)
    }

    /// Evaluates a formula.
    pub fn evaluate<V: FormulaValues>(
        &mut self,
        formula: &Formula,
        values: &mut V,
    ) -> Valued<V::Value> {
        self.term(&formula.root, formula, values)
    }

    pub fn term<V: FormulaValues>(
        &mut self,
        term: &FormulaTerm,
        formula: &Formula,
        values: &mut V,
    ) -> Valued<V::Value> {
        let at = term.at;
        self.terms += 1;
        if self.terms > MOST_TERMS {
            let allowed = "fewer bodies, or shorter formulas";
            let found = format!("more than {MOST_TERMS} terms");
            return Err(FormulaFault::new(at, "too large a system", found, allowed));
        }
        match &term.content {
            TermContent::Number(value, place) => {
                Ok(values.number(*value, formula.dimension_of(*place), *place))
            }
            TermContent::Quantity(value, dimension) => Ok(values.quantity(*value, *dimension)),
            TermContent::Name(name) => match self.whole(term) {
                Some(whole) => Ok(values.quantity(whole as f64, NONE)),
                None => {
                    let body = name.body.as_ref().map(|body| self.index(body)).transpose()?;
                    values.named(at, name, body)
                }
            },
            TermContent::Sum(terms) => {
                let each = self.parts(terms, formula, values)?;
                values.sum(at, each)
            }
            TermContent::Product(factors) => {
                let each = self.parts(factors, formula, values)?;
                values.product(at, each)
            }
            TermContent::Power(base, exponent) => {
                let base = self.term(base, formula, values)?;
                values.power(at, base, *exponent)
            }
            TermContent::Call(function, of) => {
                let value = self.term(of, formula, values)?;
                values.call(at, *function, value)
            }
            TermContent::SumOver(index, of) => {
                let Some(count) = self.of(index) else {
                    return Err(self.unknown_index(at, index));
                };
                let mut terms = Vec::new();
                for body in 1..=count {
                    self.bound.push((index.clone(), body));
                    let value = self.term(of, formula, values);
                    self.bound.pop();
                    terms.push((false, value?));
                }
                values.sum(at, terms)
            }
            TermContent::If(compared, comparison, branches) => {
                let [left, right] = [&compared[0], &compared[1]].map(|term| self.index(term));
                let branch =
                    if comparison.holds(left?, right?) { &branches[0] } else { &branches[1] };
                self.term(branch, formula, values)
            }
        }
    }

    fn parts<V: FormulaValues>(
        &mut self,
        terms: &[(bool, FormulaTerm)],
        formula: &Formula,
        values: &mut V,
    ) -> Valued<Vec<(bool, V::Value)>> {
        terms.iter().map(|(flag, term)| Ok((*flag, self.term(term, formula, values)?))).collect()
    }

    /// Returns the whole number that a name is: an index, or a whole number among the parameters.
    fn whole(&self, term: &FormulaTerm) -> Option<i64> {
        let TermContent::Name(Name { name, primes: 0, body: None }) = &term.content else {
            return None;
        };
        let known = self.bound.iter().rev().chain(&self.counts);
        known.clone().find(|(known, _)| known == name).map(|(_, value)| *value)
    }

    /// Returns the value of a term of whole numbers.
    pub fn index(&self, term: &FormulaTerm) -> Valued<i64> {
        let total = |parts: &[(bool, FormulaTerm)]| {
            parts.iter().try_fold(0_i64, |sum, (minus, part)| {
                let value = self.index(part)?;
                let sum = if *minus { sum.checked_sub(value) } else { sum.checked_add(value) };
                sum.ok_or_else(|| not_whole(part, "a number beyond all bodies"))
            })
        };
        match &term.content {
            TermContent::Number(value, _) if value.fract() == 0.0 && value.abs() < 1e6 => {
                Ok(*value as i64)
            }
            TermContent::Sum(parts) => total(parts),
            TermContent::Name(name) => {
                self.whole(term).ok_or_else(|| not_whole(term, &format!("`{}`", name.name)))
            }
            _ => Err(not_whole(term, "something else")),
        }
    }

    fn unknown_index(&self, at: usize, index: &str) -> FormulaFault {
        let names: Vec<&str> = self.indices.iter().map(|(name, _)| name.as_str()).collect();
        let allowed = match names[..] {
            [] => "a key of `repeat`; the system has none".to_owned(),
            _ => format!("a key of `repeat`: {}", names.join(", ")),
        };
        FormulaFault::new(at, "unknown index", format!("`{index}`"), allowed)
    }
}

fn not_whole(term: &FormulaTerm, found: &str) -> FormulaFault {
    let allowed = "whole numbers, indices of `repeat` and numbers of bodies, with + and -; what depends on the state \
                   has no kinks: it is a contact with a gap or with friction";
    FormulaFault::new(term.at, "not a whole number", found, allowed)
}
