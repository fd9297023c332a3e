//! Where the mix of labels changes between neighbouring designs.
//!
//! Neighbours are each design and those nearest to it in scaled variables (a range is 1 wide; another
//! choice is 1 away). Each label's fraction is compared between the two by Fisher's exact test (R. A.
//! Fisher, J. R. Stat. Soc. 85 (1922) 87, doi:10.2307/2340521); tests of labels and of pairs share the
//! level evenly (Bonferroni). Runs of neighbours start alike, so that chance makes their labels differ
//! less than the test allows for. Of many runs a small change is seen as well as an abrupt one.

use statrs::function::factorial::ln_binomial;

use crate::analysis::LabelCounts;
use crate::classification::Label;

/// The probability that any design of a table is flagged though no label's fraction changes.
pub(super) const LEVEL: f64 = 0.01;

/// The most designs of a table that are compared; each is compared with each.
pub const MOST_DESIGNS: usize = 10_000;

/// Whether each of these designs differs from a nearest other one; `scaled` are their variables, a range
/// being 1 wide. None where there is no other, or where there are more than [`MOST_DESIGNS`].
pub fn discontinuous(scaled: &[Vec<f64>], counts: &[LabelCounts]) -> Vec<Option<bool>> {
    let designs = scaled.len().min(counts.len());
    if !(2..=MOST_DESIGNS).contains(&designs) {
        return vec![None; designs];
    }
    let pairs = pairs(scaled);
    let level = LEVEL / (pairs.len() * Label::ALL.len()) as f64;
    let mut flags = vec![Some(false); designs];
    for (one, other) in pairs {
        if labels_differ(&counts[one], &counts[other], level) {
            flags[one] = Some(true);
            flags[other] = Some(true);
        }
    }
    flags
}

/// Every design with each of its nearest others, each pair once.
fn pairs(scaled: &[Vec<f64>]) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for (index, one) in scaled.iter().enumerate() {
        let others = || scaled.iter().enumerate().filter(|(other, _)| *other != index);
        let least = others().map(|(_, other)| distance(one, other)).fold(f64::INFINITY, f64::min);
        let nearest = others().filter(|(_, other)| near(distance(one, other), least));
        pairs.extend(nearest.map(|(other, _)| (index.min(other), index.max(other))));
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// The square of the distance between two designs.
pub(super) fn distance(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(one, other)| (one - other) * (one - other)).sum()
}

/// Whether a distance is the least: equal ones differ by rounding, and the order of designs must not decide.
pub(super) fn near(distance: f64, least: f64) -> bool {
    distance <= least * (1.0 + 1e-9)
}

/// Whether any label's fraction differs, where each test has this level.
pub(super) fn labels_differ(one: &LabelCounts, other: &LabelCounts, level: f64) -> bool {
    Label::ALL.iter().any(|label| p_value(one, other, *label) <= level)
}

/// Fisher's exact test, two-sided: the probability of all tables with the same margins that are no more
/// likely than this one.
fn p_value(one: &LabelCounts, other: &LabelCounts, label: Label) -> f64 {
    let [a, b] = [one, other].map(|counts| counts.of(label));
    let [n, m] = [one, other].map(LabelCounts::total);
    let all = ln_binomial(n + m, a + b);
    let log = |k: u64| ln_binomial(n, k) + ln_binomial(m, a + b - k) - all;
    let here = log(a);
    let range = (a + b).saturating_sub(m)..=n.min(a + b);
    range.map(log).filter(|log| *log <= here + 1e-9).map(libm::exp).sum()
}

#[cfg(test)]
mod tests {
    use super::{discontinuous, p_value};
    use crate::analysis::LabelCounts;
    use crate::analysis::test_rng::TestRng;
    use crate::classification::Label;

    fn counts(equilibria: u64, undecided: u64) -> LabelCounts {
        let mut counts = LabelCounts::default();
        (0..equilibria).for_each(|_| counts.add(Label::Equilibrium));
        (0..undecided).for_each(|_| counts.add(Label::Undecided));
        counts
    }

    /// Fisher's lady tasting tea: three of four cups right is 0.486, four of four 0.029.
    #[test]
    fn the_lady_tasting_tea() {
        let p = |right: u64| {
            p_value(&counts(right, 4 - right), &counts(4 - right, right), Label::Equilibrium)
        };
        assert!((p(3) - 34.0 / 70.0).abs() < 1e-12 && (p(4) - 2.0 / 70.0).abs() < 1e-12);
    }

    #[test]
    fn a_step_is_seen_from_both_sides() {
        let scaled: Vec<Vec<f64>> = [0.0, 0.1, 0.2, 0.3, 0.4].map(|x| vec![x]).to_vec();
        let fractions = [60, 62, 61, 20, 22].map(|equilibria| counts(equilibria, 64 - equilibria));
        let expected = [false, false, true, true, false].map(Some);
        assert_eq!(discontinuous(&scaled, &fractions), expected);
        assert_eq!(discontinuous(&scaled[..1], &fractions[..1]), [None]);
        // In another order they are flagged alike.
        let order = [3, 0, 4, 2, 1];
        let flags =
            discontinuous(&order.map(|at| scaled[at].clone()), &order.map(|at| fractions[at]));
        assert_eq!(flags, order.map(|at| expected[at]));
    }

    /// Where nothing changes, 1 % of tables at most have a flag: of 2000 seeded ones, more than 36 would
    /// have a probability below 0.001.
    #[test]
    fn level() {
        let mut draws = TestRng::new(5);
        let scaled: Vec<Vec<f64>> = (0..10).map(|x| vec![f64::from(x)]).collect();
        let mut flagged = 0;
        for _ in 0..2000 {
            let fractions: Vec<LabelCounts> = (0..10)
                .map(|_| {
                    let rests = (0..50).filter(|_| draws.uniform() < 0.4).count() as u64;
                    counts(rests, 50 - rests)
                })
                .collect();
            flagged += u32::from(discontinuous(&scaled, &fractions).contains(&Some(true)));
        }
        println!("{flagged} of 2000");
        assert!(flagged <= 36, "{flagged}");
    }
}
