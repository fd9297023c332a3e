//! Formulas with numbers or with expressions of a record, in units that are powers of two, so that conversion is exact.

use std::f64::consts::PI;
use std::ops::Div;

use super::evaluate::FormulaValues;
use super::formula::{Dimension, FormulaFault, FormulaFunction, Name, Valued, WHOLE};
use crate::model::{Bounded, Elementary, Expression, Function, Number};

/// The exponents of two of the units of mass, length and time, in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Scales(pub [i32; 3]);

impl Scales {
    /// Returns the units nearest to these sizes in SI units.
    pub fn near(sizes: [f64; 3]) -> Scales {
        let exponent = |size: f64| match size.is_finite() && size > 0.0 {
            true => libm::round(libm::log2(size)).clamp(-200.0, 200.0) as i32,
            false => 0,
        };
        Scales(sizes.map(exponent))
    }

    /// Returns the unit of a dimension in SI units.
    pub fn unit(&self, dimension: Dimension) -> f64 {
        let exponents = self.0.iter().zip(dimension);
        let sum: i32 = exponents.map(|(unit, exponent)| unit * exponent).sum();
        match sum % WHOLE {
            0 => libm::ldexp(1.0, sum / WHOLE),
            _ => libm::exp2(f64::from(sum) / f64::from(WHOLE)),
        }
    }
}

/// A number or an expression.
pub(super) trait Scalar: Number + Div<Output = Self> {
    fn root(self) -> Self;
    fn function(self, function: Function) -> Self;

    /// Returns this times a power of two.
    fn in_unit(self, unit: f64) -> Self {
        Self::constant(unit) * self
    }
}

impl Scalar for f64 {
    fn root(self) -> Self {
        Elementary::sqrt(self)
    }

    fn function(self, function: Function) -> Self {
        match function {
            // A number of a file may be larger than what a motion computes with.
            Function::Exponential => libm::exp(self),
            _ => function.of(self),
        }
    }
}

impl Scalar for Bounded {
    fn root(self) -> Self {
        Elementary::sqrt(self)
    }

    fn function(self, function: Function) -> Self {
        Elementary::function(self, function)
    }
}

impl Scalar for Expression<'_> {
    fn root(self) -> Self {
        self.sqrt()
    }

    fn function(self, function: Function) -> Self {
        match function {
            Function::Exponential => self.exp(),
            Function::ArcTangent => self.atan(),
            Function::Logarithm => self.log(),
        }
    }

    fn in_unit(self, unit: f64) -> Self {
        self.times_power_of_two(unit)
    }
}

/// The values of names.
#[derive(Clone, Copy)]
pub(super) struct NamedValues<'a, T> {
    /// The units of numbers.
    pub scales: Scales,
    /// The parameters and the angle that turns, each by its name and its number of primes, with its value.
    pub parameters: &'a [(&'a str, usize, T)],
    /// Each coordinate by its name and its body, with its value, its rate of change and its acceleration.
    pub coordinates: &'a [(&'a str, Option<i64>, [T; 3])],
    /// The time.
    pub time: T,
}

impl<T: Scalar> FormulaValues for NamedValues<'_, T> {
    type Value = T;

    fn number(&mut self, value: f64, dimension: Dimension, _: usize) -> T {
        T::constant(value / self.scales.unit(dimension))
    }

    fn named(&mut self, at: usize, name: &Name, body: Option<i64>) -> Valued<T> {
        let coordinate =
            self.coordinates.iter().find(|(known, of, _)| *known == name.name && *of == body);
        if let (Some((.., values)), Some(which @ 0..=2)) = (coordinate, Some(name.primes)) {
            return Ok(values[which]);
        }
        let is_it =
            |(known, primes, _): &&(&str, usize, T)| *known == name.name && *primes == name.primes;
        let parameter = self.parameters.iter().find(is_it);
        match (parameter, name.name.as_str()) {
            (Some((.., value)), _) => Ok(*value),
            (None, "pi") => Ok(T::constant(PI)),
            (None, "t") => Ok(self.time),
            // A check has found all names before.
            _ => Err(FormulaFault::new(at, "unknown name", name.name.as_str(), "a known name")),
        }
    }

    fn sum(&mut self, _: usize, terms: Vec<(bool, T)>) -> Valued<T> {
        // Sums of many bodies are added in halves, so that the expression stays shallow.
        if terms.len() > 16 {
            let later = terms.len() / 2;
            let halves = [terms[..later].to_vec(), terms[later..].to_vec()];
            let [left, right] = halves.map(|half| self.sum(0, half));
            return Ok(left? + right?);
        }
        let mut terms = terms.into_iter();
        let first = terms.next().map_or(T::constant(0.0), |(minus, value)| match minus {
            true => -value,
            false => value,
        });
        Ok(terms.fold(first, |sum, (minus, value)| if minus { sum - value } else { sum + value }))
    }

    fn product(&mut self, _: usize, factors: Vec<(bool, T)>) -> Valued<T> {
        let times = |product: T, (over, value): (bool, T)| match over {
            true => product / value,
            false => product * value,
        };
        Ok(factors.into_iter().fold(T::constant(1.0), times))
    }

    fn power(&mut self, _: usize, base: T, exponent: f64) -> Valued<T> {
        // Whole powers by repeated squares, and half powers with a root.
        let (base, mut left) = match exponent.fract() == 0.0 {
            true => (base, exponent.abs() as u64),
            false => (base.root(), (2.0 * exponent).abs() as u64),
        };
        let (mut power, mut square) = (None::<T>, base);
        while left > 0 {
            if left % 2 == 1 {
                power = Some(power.map_or(square, |power| power * square));
            }
            left /= 2;
            if left > 0 {
                square = square * square;
            }
        }
        let power = power.unwrap_or(T::constant(1.0));
        Ok(if exponent < 0.0 { T::constant(1.0) / power } else { power })
    }

    fn call(&mut self, _: usize, function: FormulaFunction, of: T) -> Valued<T> {
        let one = T::constant(1.0);
        Ok(match function {
            FormulaFunction::Sine => of.sin_cos().0,
            FormulaFunction::Cosine => of.sin_cos().1,
            FormulaFunction::Tangent => {
                let (sine, cosine) = of.sin_cos();
                sine / cosine
            }
            FormulaFunction::Exponential => of.function(Function::Exponential),
            FormulaFunction::SquareRoot => of.root(),
            // A large exponential gives 1 without an overflow of a product.
            FormulaFunction::HyperbolicTangent => {
                one - T::constant(2.0) / ((of + of).function(Function::Exponential) + one)
            }
            FormulaFunction::ArcTangent => of.function(Function::ArcTangent),
            FormulaFunction::Logarithm => of.function(Function::Logarithm),
        })
    }
}
