//! Sliding speeds as linear functions of the rates of change.

use super::evaluate::FormulaValues;
use super::formula::{Dimension, FormulaFunction, Name, Valued};
use super::instance::Instance;
use super::numeric::{NamedValues, Scalar};

/// A constant and the factors of rates of change, by the numbers of their coordinates.
#[derive(Clone, Debug)]
pub(super) struct LinearForm<T> {
    pub constant: T,
    pub factors: Vec<(usize, T)>,
}

impl<T: Scalar> LinearForm<T> {
    fn constant(constant: T) -> Self {
        LinearForm { constant, factors: Vec::new() }
    }

    fn map(self, change: impl Fn(T) -> T) -> Self {
        let factors = self.factors.into_iter().map(|(of, factor)| (of, change(factor)));
        LinearForm { constant: change(self.constant), factors: factors.collect() }
    }

    fn plus(mut self, other: Self) -> Self {
        self.constant = self.constant + other.constant;
        for (of, factor) in other.factors {
            match self.factors.iter_mut().find(|(known, _)| *known == of) {
                Some((_, sum)) => *sum = *sum + factor,
                None => self.factors.push((of, factor)),
            }
        }
        self
    }
}

/// Evaluates a formula that is linear in the rates of change.
pub(super) struct Linearised<'a, 'd, T> {
    pub instance: &'a Instance<'d>,
    pub numeric: NamedValues<'a, T>,
}

impl<T: Scalar> FormulaValues for Linearised<'_, '_, T> {
    type Value = LinearForm<T>;

    fn number(&mut self, value: f64, dimension: Dimension, place: usize) -> LinearForm<T> {
        LinearForm::constant(self.numeric.number(value, dimension, place))
    }

    fn named(&mut self, at: usize, name: &Name, body: Option<i64>) -> Valued<LinearForm<T>> {
        match self.instance.number_of(&name.name, body).filter(|_| name.primes == 1) {
            Some(number) => Ok(LinearForm {
                constant: T::constant(0.0),
                factors: vec![(number, T::constant(1.0))],
            }),
            None => self.numeric.named(at, name, body).map(LinearForm::constant),
        }
    }

    fn sum(&mut self, _: usize, terms: Vec<(bool, LinearForm<T>)>) -> Valued<LinearForm<T>> {
        let signed =
            |(minus, term): (bool, LinearForm<T>)| if minus { term.map(|c| -c) } else { term };
        let sum = terms.into_iter().map(signed).reduce(LinearForm::plus);
        Ok(sum.unwrap_or_else(|| LinearForm::constant(T::constant(0.0))))
    }

    fn product(&mut self, _: usize, factors: Vec<(bool, LinearForm<T>)>) -> Valued<LinearForm<T>> {
        let one = LinearForm::constant(T::constant(1.0));
        let times = |product: LinearForm<T>, (over, factor): (bool, LinearForm<T>)| match over {
            true => product.map(|c| c / factor.constant),
            false if product.factors.is_empty() => factor.map(|c| product.constant * c),
            false => product.map(|c| c * factor.constant),
        };
        Ok(factors.into_iter().fold(one, times))
    }

    fn power(&mut self, at: usize, base: LinearForm<T>, exponent: f64) -> Valued<LinearForm<T>> {
        match exponent == 1.0 {
            true => Ok(base),
            false => self.numeric.power(at, base.constant, exponent).map(LinearForm::constant),
        }
    }

    fn call(
        &mut self,
        at: usize,
        function: FormulaFunction,
        of: LinearForm<T>,
    ) -> Valued<LinearForm<T>> {
        self.numeric.call(at, function, of.constant).map(LinearForm::constant)
    }
}
