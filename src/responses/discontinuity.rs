//! Detects abrupt changes of label fractions between neighbouring designs, in a table of designs or in a sequence of
//! requests.
//!
//! Neighbours of a design are the designs nearest to it in scaled variables (a range has length 1; different choices
//! have distance 1). Fisher's exact test compares each label's fraction in the two designs (R. A. Fisher, J. R. Stat.
//! Soc. 85 (1922) 87, doi:10.2307/2340521); the tests of labels and of pairs divide the level evenly (Bonferroni). Runs
//! of neighbouring designs share their start states, so their labels differ less by chance than the test assumes. With
//! many runs, small changes are also significant.

use std::collections::VecDeque;

use statrs::function::factorial::ln_binomial;

use crate::analysis::LabelCounts;
use crate::classification::Label;

/// The probability that any design of a table is flagged although no label's fraction changes.
const LEVEL: f64 = 0.01;

/// The largest number of designs of a table for a comparison of all pairs.
pub const MOST_DESIGNS: usize = 10_000;

/// Returns whether each design differs from one of its nearest neighbours; `scaled` holds the variables, with ranges of
/// length 1. `None` if there is no other design, or if there are more than [`MOST_DESIGNS`].
pub fn discontinuous(scaled: &[Vec<f64>], counts: &[LabelCounts]) -> Vec<Option<bool>> {
    let designs = scaled.len().min(counts.len());
    if !(2..=MOST_DESIGNS).contains(&designs) {
        return vec![None; designs];
    }
    let pairs = pairs(scaled);
    let level = LEVEL / (pairs.len() * Label::ALL.len()) as f64;
    let mut flags = vec![Some(false); designs];
    for (first, second) in pairs {
        if labels_differ(&counts[first], &counts[second], level) {
            flags[first] = Some(true);
            flags[second] = Some(true);
        }
    }
    flags
}

/// Returns the pairs of each design and its nearest neighbours, each pair once.
fn pairs(scaled: &[Vec<f64>]) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for (index, point) in scaled.iter().enumerate() {
        let others = || scaled.iter().enumerate().filter(|(other, _)| *other != index);
        let least = others().map(|(_, other)| distance(point, other)).fold(f64::INFINITY, f64::min);
        let nearest = others().filter(|(_, other)| is_nearest(distance(point, other), least));
        pairs.extend(nearest.map(|(other, _)| (index.min(other), index.max(other))));
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Returns the squared distance between two designs.
fn distance(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(left, right)| (left - right) * (left - right)).sum()
}

/// Returns whether a distance equals the least one. Rounding errors are tolerated, so that the order of designs does
/// not matter.
fn is_nearest(distance: f64, least: f64) -> bool {
    distance <= least * (1.0 + 1e-9)
}

/// Returns whether any label's fraction differs in a test at this level.
fn labels_differ(left: &LabelCounts, right: &LabelCounts, level: f64) -> bool {
    Label::ALL.iter().any(|label| p_value(left, right, *label) <= level)
}

/// Returns the p-value of Fisher's exact test, two-sided: the probability of all tables with the same margins that
/// are no more likely than this one.
fn p_value(left: &LabelCounts, right: &LabelCounts, label: Label) -> f64 {
    let [a, b] = [left, right].map(|counts| counts.of(label));
    let [n, m] = [left, right].map(LabelCounts::total);
    let all = ln_binomial(n + m, a + b);
    let log = |k: u64| ln_binomial(n, k) + ln_binomial(m, a + b - k) - all;
    let here = log(a);
    let range = (a + b).saturating_sub(m)..=n.min(a + b);
    range.map(log).filter(|log| *log <= here + 1e-9).map(libm::exp).sum()
}

/// The largest number of stored counts, one per design and point: about 50 MB.
const MOST_COUNTS: u64 = 1_000_000;

/// A design with its label counts at each point.
struct EarlierDesign {
    scaled: Vec<f64>,
    counts: Vec<LabelCounts>,
}

/// The designs of the last requests: at most [`MOST_DESIGNS`], fewer for studies with many points. The oldest design
/// is dropped first.
pub struct Neighbours {
    designs: VecDeque<EarlierDesign>,
    capacity: usize,
}

impl Neighbours {
    /// Creates an empty list for designs with this many points.
    pub fn new(points: u64) -> Self {
        let capacity = (MOST_COUNTS / points.max(1)).clamp(1, MOST_DESIGNS as u64);
        Neighbours { designs: VecDeque::new(), capacity: usize::try_from(capacity).unwrap_or(1) }
    }

    /// Returns, point by point, whether the labels of a design differ from those of a nearest earlier design; `None` if
    /// there is none. `scaled` holds the variables, with ranges of length 1. All tests of a point together have a
    /// level of 1 %. A repeated design is not its own neighbour.
    pub fn compare(&mut self, scaled: Vec<f64>, counts: Vec<LabelCounts>) -> Vec<Option<bool>> {
        let others = || self.designs.iter().filter(|other| other.scaled != scaled);
        let distance_to = |other: &EarlierDesign| distance(&scaled, &other.scaled);
        let least = others().map(distance_to).fold(f64::INFINITY, f64::min);
        let nearest: Vec<&EarlierDesign> =
            others().filter(|other| is_nearest(distance_to(other), least)).collect();
        let level = LEVEL / (nearest.len() * Label::ALL.len()) as f64;
        let differs = |(point, labels): (usize, &LabelCounts)| {
            let mut at_point = nearest.iter().filter_map(|other| other.counts.get(point));
            (!nearest.is_empty()).then(|| at_point.any(|other| labels_differ(labels, other, level)))
        };
        let flags = counts.iter().enumerate().map(differs).collect();
        if self.designs.iter().all(|other| other.scaled != scaled) {
            if self.designs.len() == self.capacity {
                self.designs.pop_front();
            }
            self.designs.push_back(EarlierDesign { scaled, counts });
        }
        flags
    }
}

#[cfg(test)]
mod tests {
    use super::p_value;
    use crate::analysis::LabelCounts;
    use crate::classification::Label;

    /// Fisher's lady tasting tea: three of four cups right is 0.486, four of four 0.029.
    #[test]
    fn the_lady_tasting_tea() {
        let counts = |equilibria: u64| {
            let mut counts = LabelCounts::default();
            counts.add_many(Label::Equilibrium, equilibria);
            counts.add_many(Label::Undecided, 4 - equilibria);
            counts
        };
        let p = |right: u64| p_value(&counts(right), &counts(4 - right), Label::Equilibrium);
        assert!((p(3) - 34.0 / 70.0).abs() < 1e-12 && (p(4) - 2.0 / 70.0).abs() < 1e-12);
    }
}
