//! The space of designs: ranges and choices of a study's variables as a unit cube.

use crate::numbers::to_digits;
use crate::study::{DesignValue, Study, Values, Variable};

/// Significant digits of the numbers that a search evaluates.
const DIGITS: usize = 6;

/// All designs of a study.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Space<'a> {
    variables: &'a [Variable],
}

impl<'a> Space<'a> {
    pub fn new(study: &'a Study) -> Self {
        Space { variables: study.variables() }
    }

    /// Returns the number of variables.
    pub fn dimensions(&self) -> usize {
        self.variables.len()
    }

    /// Returns the design at coordinates in the unit cube: each range from its first to its last value, whole numbers
    /// and choices with equal fractions. Numbers have six significant digits.
    pub fn design_at(&self, coordinates: &[f64]) -> Vec<DesignValue> {
        let value =
            |(variable, fraction): (&Variable, &f64)| value_at(variable.values(), *fraction);
        self.variables.iter().zip(coordinates).map(value).collect()
    }

    /// Returns space-filling design number `index`: a scrambled Sobol' point.
    pub fn space_filling(&self, index: u32, seed: u32) -> Vec<DesignValue> {
        let coordinate = |dimension| f64::from(sobol_burley::sample(index, dimension, seed));
        // One dimension per variable, fewer than Sobol' dimensions.
        let dimensions = u32::try_from(self.dimensions()).unwrap_or(u32::MAX);
        let coordinates: Vec<f64> = (0..dimensions).map(coordinate).collect();
        self.design_at(&coordinates)
    }

    /// Returns the designs that differ from a design in one variable: numbers by a fraction of their range up and down,
    /// whole numbers by one, choices by any other choice.
    pub fn neighbours(&self, design: &[DesignValue], fraction: f64) -> Vec<Vec<DesignValue>> {
        let with = |(index, variable): (usize, &'a Variable)| {
            let here = design.get(index).copied();
            let others: Vec<DesignValue> = match (variable.values(), here) {
                (values @ Values::Numbers(from, to), Some(DesignValue::Number(number))) => {
                    let place = (number - from) / (to - from);
                    [place - fraction, place + fraction].map(|place| value_at(values, place)).into()
                }
                (Values::Whole(from, to), Some(DesignValue::Number(number))) => [-1.0, 1.0]
                    .map(|step| (number + step).clamp(from as f64, to as f64))
                    .map(DesignValue::Number)
                    .into(),
                (Values::Choices(choices), _) => (0..choices).map(DesignValue::Choice).collect(),
                _ => Vec::new(),
            };
            let others = others.into_iter().filter(move |value| Some(*value) != here);
            others.map(move |value| {
                let mut other = design.to_vec();
                other[index] = value;
                other
            })
        };
        self.varied().flat_map(with).collect()
    }

    /// Returns whether two designs have the same choices and whole numbers, and all their numbers differ by less than a
    /// fraction of their ranges.
    pub fn are_near(&self, left: &[DesignValue], right: &[DesignValue], fraction: f64) -> bool {
        self.varied().all(|(index, variable)| {
            match (variable.values(), left.get(index), right.get(index)) {
                (
                    Values::Numbers(from, to),
                    Some(DesignValue::Number(left)),
                    Some(DesignValue::Number(right)),
                ) => (left - right).abs() < fraction * (to - from),
                (_, left, right) => left == right,
            }
        })
    }

    /// Returns a design in coordinates for a surrogate: ranges of length 1, and one coordinate per choice.
    pub fn coordinates(&self, design: &[DesignValue]) -> Vec<f64> {
        let of = |(index, variable): (usize, &Variable)| {
            design.get(index).map_or_else(Vec::new, |value| variable.scaled(*value))
        };
        self.varied().flat_map(of).collect()
    }

    /// Returns the variables with more than one value, with their indices.
    fn varied(&self) -> impl Iterator<Item = (usize, &'a Variable)> {
        let varied = |(_, variable): &(usize, &Variable)| match variable.values() {
            Values::Numbers(from, to) => from < to,
            Values::Whole(from, to) => from < to,
            Values::Choices(choices) => choices > 1,
        };
        self.variables.iter().enumerate().filter(varied)
    }
}

fn value_at(values: Values, fraction: f64) -> DesignValue {
    let fraction = fraction.clamp(0.0, 1.0);
    let part = |parts: u64| ((fraction * parts as f64) as u64).min(parts - 1);
    match values {
        Values::Numbers(from, to) => {
            let number = to_digits(from + fraction * (to - from), DIGITS);
            DesignValue::Number(number.clamp(from, to))
        }
        Values::Whole(from, to) => DesignValue::Number((from + part(to - from + 1)) as f64),
        Values::Choices(choices) => DesignValue::Choice(part(choices as u64) as usize),
    }
}

/// A study with a continuous variable, a number of balls, a variable with one value, and choices, for tests.
#[cfg(test)]
pub(super) fn study_with_four_variables() -> Study {
    let text = "schema: 1\nname: one\nseed: 7\nmodel: {kind: ball_balancer}\n\
        initial_conditions: {design: {monte_carlo: {samples: 2}}}\n\
        design:\n  speed_rad_s: {from: -260, to: -140}\n  balls: {from: 1, to: 3}\n  \
        stiffness_n_m: {from: 900, to: 900}\n  \
        material: {choices: {a: {ball_mass_kg: 1e-4}, b: {ball_mass_kg: 2e-4}}}\n";
    let file = std::path::Path::new("a.yaml");
    Study::parse(file, text.to_owned()).expect("a valid study")
}

#[cfg(test)]
mod tests {
    use super::{Space, study_with_four_variables};
    use crate::study::DesignValue;

    #[test]
    fn designs_and_their_neighbours() {
        let study = study_with_four_variables();
        let space = Space::new(&study);
        assert_eq!(space.dimensions(), 4);
        let mut found = [0; 3];
        for index in 0..96 {
            let design = space.space_filling(index, 5);
            assert_eq!(design[2], DesignValue::Number(900.0));
            let DesignValue::Number(balls) = design[1] else { panic!("{design:?}") };
            found[balls as usize - 1] += 1;
        }
        assert_eq!(found, [32; 3]);
        let [speed, balls, stiffness] = [-200.0, 1.0, 900.0].map(DesignValue::Number);
        let design = [speed, balls, stiffness, DesignValue::Choice(0)];
        let with = |index: usize, value| {
            let mut other = design.to_vec();
            other[index] = value;
            other
        };
        let expected = [
            with(0, DesignValue::Number(-212.0)),
            with(0, DesignValue::Number(-188.0)),
            with(1, DesignValue::Number(2.0)),
            with(3, DesignValue::Choice(1)),
        ];
        assert_eq!(space.neighbours(&design, 0.1), expected);
        let near =
            |fraction| expected.iter().map(move |other| space.are_near(&design, other, fraction));
        assert!(near(0.11).eq([true, true, false, false]));
        assert!(near(0.09).eq([false; 4]));
    }
}
