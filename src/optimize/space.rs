//! The space of designs: ranges and choices of a study's variables as a unit cube.

use egobox_ego::XType;

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

    /// Returns the variables as the optimiser defines them: numbers on a scale from 0 to 1.
    pub fn types(&self) -> Vec<XType> {
        let of = |variable: &Variable| match variable.values() {
            Values::Numbers(..) => XType::Float(0.0, 1.0),
            Values::Whole(from, to) => XType::Int(whole(from), whole(to)),
            Values::Choices(choices) => XType::Enum(choices),
        };
        self.varied().map(|(_, variable)| of(variable)).collect()
    }

    /// Returns a design as a row of the optimiser.
    pub fn row(&self, design: &[DesignValue]) -> Vec<f64> {
        let of =
            |(index, variable): (usize, &Variable)| match (design.get(index), variable.values()) {
                (Some(DesignValue::Number(number)), Values::Numbers(from, to)) => {
                    (number - from) / (to - from)
                }
                (Some(DesignValue::Number(number)), _) => *number,
                (Some(DesignValue::Choice(choice)), _) => *choice as f64,
                (None, _) => 0.0,
            };
        self.varied().map(of).collect()
    }

    /// Returns the design of a row of the optimiser.
    pub fn design(&self, row: &[f64]) -> Vec<DesignValue> {
        let mut design = self.design_at(&vec![0.0; self.dimensions()]);
        for ((index, variable), number) in self.varied().zip(row) {
            design[index] = match variable.values() {
                values @ Values::Numbers(..) => value_at(values, *number),
                Values::Whole(from, to) => {
                    DesignValue::Number(number.round().clamp(from as f64, to as f64))
                }
                Values::Choices(choices) => {
                    DesignValue::Choice((number.round().max(0.0) as usize).min(choices - 1))
                }
            };
        }
        design
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

/// Converts a number; numbers of balls are far below the limit of `i32`.
fn whole(number: u64) -> i32 {
    i32::try_from(number).unwrap_or(i32::MAX)
}

fn value_at(values: Values, fraction: f64) -> DesignValue {
    let fraction = fraction.clamp(0.0, 1.0);
    let part = |parts: u64| ((fraction * parts as f64) as u64).min(parts - 1);
    match values {
        Values::Numbers(from, to) => {
            DesignValue::Number(rounded(from + fraction * (to - from)).clamp(from, to))
        }
        Values::Whole(from, to) => DesignValue::Number((from + part(to - from + 1)) as f64),
        Values::Choices(choices) => DesignValue::Choice(part(choices as u64) as usize),
    }
}

/// Rounds a number to `DIGITS` significant digits.
fn rounded(number: f64) -> f64 {
    // A formatted number can always be parsed.
    format!("{number:.*e}", DIGITS - 1).parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{Space, rounded};
    use crate::study::{DesignValue, Study};

    #[test]
    fn numbers_have_six_digits() {
        assert_eq!(rounded(123.456789), 123.457);
        assert_eq!(rounded(-0.000123456789), -0.000123457);
        assert_eq!(rounded(0.0), 0.0);
    }

    #[test]
    fn rows_of_the_optimiser_give_their_designs() {
        let text = "schema: 1\nname: one\nseed: 7\nmodel: {kind: ball_balancer}\n\
            initial_conditions: {design: {monte_carlo: {samples: 2}}}\n\
            design:\n  speed_rad_s: {from: -260, to: -140}\n  balls: {from: 1, to: 3}\n  \
            stiffness_n_m: {from: 900, to: 900}\n  \
            material: {choices: {a: {ball_mass_kg: 1e-4}, b: {ball_mass_kg: 2e-4}}}\n";
        let study = Study::parse(Path::new("a.yaml"), text.to_owned()).unwrap();
        let space = Space::new(&study);
        assert_eq!((space.dimensions(), space.types().len()), (4, 3));
        let mut found = [0; 3];
        for index in 0..96 {
            let design = space.space_filling(index, 5);
            assert_eq!(space.design(&space.row(&design)), design, "{design:?}");
            assert_eq!(design[2], DesignValue::Number(900.0));
            let DesignValue::Number(balls) = design[1] else { panic!("{design:?}") };
            found[balls as usize - 1] += 1;
        }
        assert_eq!(found, [32; 3]);
    }
}
