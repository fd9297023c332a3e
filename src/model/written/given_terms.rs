//! How the part that turns and the given motions of a system move in a stage: polynomials of the time since its begin.

use super::definition::{SystemDefinition, WrittenMotion};
use super::numeric::{Scalar, Scales};

/// The coefficients of the motions in a stage.
#[derive(Clone, Debug, Default)]
pub(super) struct GivenTerms<T> {
    /// How far the part that turns has turned at the begin, and the coefficients of its speed without the last ones that are zero;
    /// empty for the speed of the parameters.
    pub turned: Vec<T>,
    /// The coefficients of each given motion: one if it rests.
    pub given: Vec<Vec<T>>,
}

impl GivenTerms<f64> {
    /// Returns those of a system whose given motions rest at their last values.
    pub fn at_rest(definition: &SystemDefinition, scales: Scales) -> Self {
        let given = definition.motions.iter().map(|WrittenMotion { motion, unit, .. }| {
            vec![motion.last() / scales.unit(unit.dimension)]
        });
        GivenTerms { turned: Vec::new(), given: given.collect() }
    }
}

impl<T> GivenTerms<T> {
    /// Returns all coefficients, converted in their order.
    pub fn map<U>(&self, mut convert: impl FnMut(T) -> U) -> GivenTerms<U>
    where
        T: Copy,
    {
        let turned = self.turned.iter().map(|term| convert(*term)).collect();
        let given = self.given.iter();
        let given = given.map(|terms| terms.iter().map(|term| convert(*term)).collect());
        GivenTerms { turned, given: given.collect() }
    }

    /// Returns all coefficients in their order.
    pub fn all(&self) -> impl Iterator<Item = &T> {
        self.turned.iter().chain(self.given.iter().flatten())
    }

    /// Returns whether a given motion moves.
    pub fn given_moves(&self) -> bool {
        self.given.iter().any(|terms| terms.len() > 1)
    }
}

impl<T: Scalar> GivenTerms<T> {
    /// Returns the angle of the part that turns with its rates of change at a time since the begin of the stage; `speed` is that of
    /// the parameters, if there is such a part.
    pub fn turned_at(&self, speed: Option<T>, time: T) -> Option<[T; 3]> {
        let speed = speed?;
        let Some((before, terms)) = self.turned.split_first() else {
            return Some([speed * time, speed, T::constant(0.0)]);
        };
        let angle = *before + sum(terms, time, |power| 1.0 / power, 0) * time;
        Some([angle, sum(terms, time, |_| 1.0, 0), sum(terms, time, |power| power - 1.0, 1)])
    }

    /// Returns each given motion with its rates of change at a time since the begin of the stage.
    pub fn given_at(&self, time: T) -> impl Iterator<Item = [T; 3]> + '_ {
        self.given.iter().map(move |terms| {
            [
                sum(terms, time, |_| 1.0, 0),
                sum(terms, time, |power| power - 1.0, 1),
                sum(terms, time, |power| (power - 1.0) * (power - 2.0), 2),
            ]
        })
    }
}

/// Returns the sum of the terms from one on, each with a factor that depends on its number from 1 on, by Horner's rule.
fn sum<T: Scalar>(terms: &[T], time: T, factor: fn(f64) -> f64, from: usize) -> T {
    let later = terms.iter().zip([1.0, 2.0, 3.0, 4.0]).skip(from).rev();
    later.fold(T::constant(0.0), |sum, (term, power)| {
        sum * time + T::constant(factor(power)) * *term
    })
}
