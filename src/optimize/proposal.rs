//! Searches the space of designs for the one that maximises a criterion: space-filling candidates, then steps from the
//! best of them and from the best designs so far.

use super::space::Space;
use crate::study::DesignValue;

/// A value for each variable.
pub(super) type DesignValues = Vec<DesignValue>;

/// Number of space-filling candidates.
const CANDIDATES: u32 = 1024;
/// Number of designs from which steps begin.
const STARTS: usize = 6;
/// Length of the first steps of numbers, as a fraction of their range.
const FIRST_STEP: f64 = 0.1;
/// Number of steps from each start. A step that finds nothing better halves the length of the next ones.
const STEPS: u32 = 12;

/// Returns designs by decreasing criterion, the best one first. `criterion` returns one value per design, and
/// `best_so_far` are designs near which to search, too. The result is a function of the arguments.
pub(super) fn by_criterion(
    space: &Space,
    best_so_far: &[DesignValues],
    seed: u32,
    criterion: impl Fn(&[DesignValues]) -> Vec<f64>,
) -> Vec<DesignValues> {
    let mut candidates: Vec<DesignValues> =
        (0..CANDIDATES).map(|index| space.space_filling(index, seed)).collect();
    for design in best_so_far {
        for length in [FIRST_STEP, 0.3 * FIRST_STEP, 0.1 * FIRST_STEP] {
            candidates.extend(space.neighbours(design, length));
        }
    }
    let mut all = sorted(&criterion(&candidates), candidates);
    all.dedup_by(|left, right| left.1 == right.1);
    // A value, a design and the length of its next step.
    let mut places: Vec<(f64, DesignValues, f64)> = all
        .iter()
        .take(STARTS)
        .map(|(value, design)| (*value, design.clone(), FIRST_STEP))
        .collect();
    for _ in 0..STEPS {
        let neighbours: Vec<Vec<DesignValues>> =
            places.iter().map(|(_, design, length)| space.neighbours(design, *length)).collect();
        let mut values = criterion(&neighbours.concat()).into_iter();
        for ((value, design, length), neighbours) in places.iter_mut().zip(neighbours) {
            let found = neighbours.into_iter().zip(values.by_ref());
            // The first one of equal values.
            let better = found.fold(None, |best: Option<(DesignValues, f64)>, candidate| {
                let most = best.as_ref().map_or(*value, |best| best.1);
                if candidate.1 > most { Some(candidate) } else { best }
            });
            match better {
                Some((other, its_value)) => {
                    *design = other;
                    *value = its_value;
                }
                None => *length *= 0.5,
            }
        }
    }
    all.extend(places.into_iter().map(|(value, design, _)| (value, design)));
    let (values, designs): (Vec<f64>, Vec<DesignValues>) = all.into_iter().unzip();
    sorted(&values, designs).into_iter().map(|(_, design)| design).collect()
}

/// Returns the designs with finite or infinitely small values, by decreasing value.
fn sorted(values: &[f64], designs: Vec<DesignValues>) -> Vec<(f64, DesignValues)> {
    let mut all: Vec<(f64, DesignValues)> = values.iter().copied().zip(designs).collect();
    all.sort_by(|left, right| right.0.total_cmp(&left.0));
    all
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{DesignValues, by_criterion};
    use crate::optimize::space::Space;
    use crate::study::{DesignValue, Study};

    /// The maximum of a paraboloid on numbers, with a bonus for one choice of many, is found to the last step.
    #[test]
    fn the_maximum_of_a_known_function() {
        let choices: Vec<String> =
            (0..9).map(|index| format!("c{index}: {{ball_mass_kg: {}e-4}}", index + 1)).collect();
        let text = format!(
            "schema: 1\nname: one\nseed: 7\nmodel: {{kind: ball_balancer}}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 2}}}}}}\n\
             design:\n  speed_rad_s: {{from: -200, to: -100}}\n  stiffness_n_m: {{from: 900, to: 1900}}\n  \
             balls: {{from: 1, to: 6}}\n  mass: {{choices: {{{}}}}}\n",
            choices.join(", ")
        );
        let study = Study::parse(Path::new("a.yaml"), text).expect("a valid study");
        let value = |design: &DesignValues| match design[..] {
            [
                DesignValue::Number(speed),
                DesignValue::Number(stiffness),
                DesignValue::Number(balls),
                DesignValue::Choice(choice),
            ] => {
                let near = (speed + 137.0) / 100.0 + 0.5 * (stiffness - 1312.0) / 1000.0;
                let far = (stiffness - 1312.0) / 1000.0;
                let bonus = if choice == 7 { 0.5 } else { 0.0 };
                bonus - near * near - far * far - 0.1 * (balls - 4.0).powi(2)
            }
            _ => panic!("{design:?}"),
        };
        let criterion = |designs: &[DesignValues]| designs.iter().map(value).collect();
        let found = by_criterion(&Space::new(&study), &[], 3, criterion);
        assert_eq!(found[0][2..], [DesignValue::Number(4.0), DesignValue::Choice(7)]);
        assert!(value(&found[0]) > 0.5 - 1e-3, "{:?}", found[0]);
    }
}
