//! The designs of a study that stand for all others: the one whose machine `check` describes, and the two at which a
//! quantity is smallest and largest.

use crate::optimize::Space;
use crate::study::{DesignValue, Plan, Study, Values, Variable};

/// Passes over the variables in the search for an extreme design; a second one finds what depends on a choice.
const PASSES: usize = 2;
/// The number of space-filling designs that are tried if the middle of the ranges is impossible.
const TRIED: u32 = 64;

/// The design whose machine stands for all designs of a study.
#[derive(Clone, Debug)]
pub struct ExaminedDesign {
    /// The study with the values of the design.
    pub study: Study,
    /// The value of each variable.
    pub values: Vec<DesignValue>,
    /// What the design is, such as `optimize.compare_with`.
    pub name: &'static str,
}

impl ExaminedDesign {
    /// Returns the reference design if the study has one, and otherwise the middle of all ranges with the first of all
    /// choices. `None` if the study has no variables, or if no possible design is found.
    pub fn of(study: &Study) -> Option<Self> {
        let variables = study.variables();
        if variables.is_empty() {
            return None;
        }
        let space = Space::new(study);
        let reference = study.optimization().and_then(|search| search.compare_with.clone());
        let middle: Vec<f64> = variables
            .iter()
            .map(|variable| if variable.choices().is_some() { 0.0 } else { 0.5 })
            .collect();
        let reference = reference.map(|values| (values, "optimize.compare_with"));
        let middle = (space.design_at(&middle), "the middle of the ranges");
        let others = (0..TRIED).map(|index| (space.space_filling(index, 0), "one of the designs"));
        reference.into_iter().chain([middle]).chain(others).find_map(|(values, name)| {
            Some(ExaminedDesign { study: study.of_design(&values).ok()?, values, name })
        })
    }

    /// Returns the name and the values of the design in words.
    pub fn words(&self) -> String {
        format!("{} ({})", self.name, described(&self.study, &self.values))
    }
}

/// Returns the values of a design in words, as `stiffness_n_m 9500, ring steel`.
pub(super) fn described(study: &Study, values: &[DesignValue]) -> String {
    let each = study.variables().iter().zip(values);
    let text = |(variable, value): (&Variable, &DesignValue)| variable.in_words(*value);
    each.map(text).collect::<Vec<_>>().join(", ")
}

/// A design at an end of the ranges.
#[derive(Clone, Debug)]
pub(super) struct ExtremeDesign {
    /// The quantity there.
    pub value: f64,
    /// The values of the variables on which the quantity depends, in words; empty if it depends on none.
    pub words: String,
}

/// Returns the designs with the smallest and the largest value of a quantity that rises or falls with each variable.
/// The ends of all ranges and all choices are tried, one variable at a time.
pub(super) fn extreme_designs(
    study: &Study,
    start: &[DesignValue],
    quantity: impl Fn(&Plan) -> Option<f64>,
) -> Option<[ExtremeDesign; 2]> {
    let of = |values: &[DesignValue]| study.set(values).ok().and_then(|design| quantity(&design));
    let first = of(start)?;
    let extreme = |sign: f64| {
        let (mut values, mut best) = (start.to_vec(), first);
        let mut matters = vec![false; values.len()];
        for _ in 0..PASSES {
            for (index, variable) in study.variables().iter().enumerate() {
                for candidate in candidates(variable.values()) {
                    let mut other = values.clone();
                    other[index] = candidate;
                    let Some(value) = of(&other) else { continue };
                    // Rounding is no effect of a variable.
                    matters[index] |= (value - best).abs() > 1e-9 * best.abs();
                    if sign * (value - best) > 1e-9 * best.abs() {
                        (values, best) = (other, value);
                    }
                }
            }
        }
        let each = study.variables().iter().zip(&values).zip(&matters);
        let words = each.filter(|(_, matters)| **matters);
        let words = words.map(|((variable, value), _)| variable.in_words(*value));
        ExtremeDesign { value: best, words: words.collect::<Vec<_>>().join(", ") }
    };
    Some([extreme(-1.0), extreme(1.0)])
}

fn candidates(values: Values) -> Vec<DesignValue> {
    match values {
        Values::Numbers(from, to) => [from, to].map(DesignValue::Number).into(),
        Values::Whole(from, to) => [from as f64, to as f64].map(DesignValue::Number).into(),
        Values::Choices(choices) => (0..choices).map(DesignValue::Choice).collect(),
    }
}
