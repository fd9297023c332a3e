//! The points and the designs of a study that stand for all others: an even selection of the points of a large sweep, the
//! design whose machine `check` describes, and the two designs at which a quantity is smallest and largest.

use crate::optimize::Space;
use crate::study::{DesignValue, Plan, Study, Values, Variable};

/// Returns the point to examine as number `index` out of `looked_at`. The sweep is divided into `looked_at` equal
/// parts with one point each, whose place within the part follows the golden ratio and so avoids the sweep's
/// own periods. If `looked_at` equals `points`, every point is examined.
fn spread(index: u64, looked_at: u64, points: u64) -> u64 {
    let mark = |k: u64| (u128::from(k) * u128::from(points) / u128::from(looked_at)) as u64;
    let (from, to) = (mark(index), mark(index + 1));
    let place = (index as f64 * 0.618_033_988_749_894_9).fract();
    from + (place * (to - from) as f64) as u64
}

/// Returns the numbers of at most `most` points, spread evenly over a sweep of `points` points.
pub fn points_to_examine(points: u64, most: u64) -> Vec<u64> {
    let looked_at = points.min(most);
    (0..looked_at).map(|index| spread(index, looked_at, points)).collect()
}

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
