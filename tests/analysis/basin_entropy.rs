//! Basin entropy: hand-computed cells, its expectation in closed form, and the error of estimates from few runs.

use std::path::Path;

use proptest::prelude::*;
use stickslip::analysis::{Basins, Observed, PointAccumulator};
use stickslip::classification::{Evidence, Label, Outcome, Rest};

use super::cycle_groups::falls_back;
use crate::support::TestRng;

/// The outcomes of runs: the labels of runs that did not fail, with classes of limit cycles.
const OUTCOMES: [(Label, Option<&str>); 6] = [
    (Label::Equilibrium, None),
    (Label::LimitCycle, Some("-1|rest")),
    (Label::Irregular, None),
    (Label::LimitCycle, Some("-2|rest")),
    (Label::Undecided, None),
    (Label::LimitCycle, Some("unknown")),
];

/// Returns the entropy of cells with these outcomes, by their numbers in [`OUTCOMES`].
fn entropy(cells: &[Vec<usize>]) -> Option<f64> {
    let mut basins = Basins::new(cells.len() as u64);
    for (cell, outcomes) in cells.iter().enumerate() {
        for &outcome in outcomes {
            let (label, class) = OUTCOMES[outcome];
            basins.add(cell as u64, label, class);
        }
    }
    basins.entropy()
}

#[track_caller]
fn assert_near(found: Option<f64>, expected: f64) {
    let found = found.expect("cells with two runs");
    assert!((found - expected).abs() < 1e-14, "{found} {expected}");
}

/// The values follow from the sum of the inverses of the integers by hand: two of three runs give
/// `2/3 · 1/2 + 1/3 · (1 + 1/2)`.
#[test]
fn cells_by_hand() {
    let certain = vec![0, 0, 0];
    for (cell, of_cell) in [
        (vec![0, 2], 1.0),
        (vec![0, 0, 2], 5.0 / 6.0),
        (vec![0, 1, 2], 3.0 / 2.0),
        (vec![4, 0, 4, 0], 5.0 / 6.0),
        (vec![1, 3, 1, 1], 17.0 / 24.0),
        (vec![5, 5], 0.0),
    ] {
        assert_near(entropy(&[cell.clone(), certain.clone()]), of_cell / 2.0);
        assert_near(entropy(&[cell.clone(), cell.clone()]), of_cell);
        // Cells with fewer than two runs say nothing.
        assert_near(entropy(&[vec![], cell, vec![3]]), of_cell);
    }
    let pure = entropy(&[certain.clone(), certain]).expect("cells with two runs");
    assert!(pure == 0.0 && pure.is_sign_positive(), "{pure}");
}

#[test]
fn without_two_runs_in_a_cell_there_is_none() {
    assert_eq!(entropy(&[vec![0], vec![1]]), None);
    // A single cell or too many of them are not a stratified design.
    assert_eq!(entropy(&[vec![0, 2]]), None);
    let mut many = Basins::new(65_537);
    (0..2).for_each(|_| many.add(0, Label::Equilibrium, None));
    assert_eq!(many.entropy(), None);
    // Failed runs are left out.
    let mut basins = Basins::new(2);
    basins.add(0, Label::Equilibrium, None);
    basins.add(0, Label::Failed, None);
    assert_eq!(basins.entropy(), None);
    basins.add(0, Label::Undecided, None);
    assert_near(basins.entropy(), 1.0);
    // Runs of a design without cells.
    let rest = Outcome::of(Evidence::RestCertified(Rest::default()));
    let mut point = PointAccumulator::new(None);
    for _ in 0..3 {
        point.add(Observed { cell: 0, case: None, outcome: &rest, audit: None });
    }
    assert_eq!(point.summary().basin_entropy, None);
}

/// Limit cycles of one class are one outcome, also with exchanged balls or another period.
#[test]
fn classes_of_limit_cycles_are_outcomes() {
    let of = |turns: [i32; 2]| {
        let mut point = PointAccumulator::new(Some(2));
        let runs = [falls_back(turns[0], 0.25, 6.0, true), falls_back(turns[1], 0.75, 0.5, false)];
        for (case, outcome) in &runs {
            point.add(Observed { cell: 1, case: Some(case), outcome, audit: None });
        }
        point.summary().basin_entropy
    };
    assert_eq!((of([1, 1]), of([1, 2])), (Some(0.0), Some(1.0)));
}

/// The classes beyond a thousand are one outcome, whatever the order of the runs.
#[test]
fn a_thousand_classes_are_separate() {
    let names: Vec<String> = (0..1500).map(|turns| format!("-{turns}|rest")).collect();
    let of = |names: &mut dyn Iterator<Item = &String>| {
        let mut basins = Basins::new(2);
        names.for_each(|name| basins.add(0, Label::LimitCycle, Some(name)));
        basins.entropy()
    };
    let inverses = |from: u32| (from..1500).map(|j| 1.0 / f64::from(j)).sum::<f64>();
    let expected = (1000.0 * inverses(1) + 500.0 * inverses(500)) / 1500.0;
    for found in [of(&mut names.iter()), of(&mut names.iter().rev())] {
        assert!((found.expect("runs") - expected).abs() < 1e-12, "{found:?} {expected}");
    }
}

proptest! {
    /// Neither the order of the runs nor the names of the outcomes matter, to the last bit.
    #[test]
    fn order_and_names_do_not_matter(
        runs in prop::collection::vec((0..5_usize, 0..OUTCOMES.len()), 0..60),
        keys in prop::collection::vec(any::<u32>(), 60),
        names in Just([0, 1, 2, 3, 4, 5]).prop_shuffle(),
    ) {
        let of = |runs: &[(usize, usize)], names: [usize; 6]| {
            let mut cells = vec![Vec::new(); 5];
            runs.iter().for_each(|&(cell, outcome)| cells[cell].push(names[outcome]));
            entropy(&cells)
        };
        let found = of(&runs, [0, 1, 2, 3, 4, 5]);
        let mut shuffled = runs.clone();
        let mut keys = keys.into_iter();
        shuffled.sort_by_cached_key(|_| keys.next());
        prop_assert_eq!(found, of(&shuffled, names));
        prop_assert!(found.is_none_or(|found| found >= 0.0));
    }
}

/// Returns a cell for each sequence of outcomes, so that the mean over the cells is the expectation for uniform random
/// outcomes; `shared` outcomes have the same name.
fn all_sequences(outcomes: usize, shared: usize, runs: u32) -> Vec<Vec<usize>> {
    let digit = |sequence: usize, run: u32| sequence / outcomes.pow(run) % outcomes;
    let sequence = |number| (0..runs).map(|run| digit(number, run).max(shared - 1)).collect();
    (0..outcomes.pow(runs)).map(sequence).collect()
}

/// The expectation for uniform random outcomes is `Σ_{v<n} (1 - 1/C)^v / v`, a partial sum of the series of `ln C`.
#[test]
fn the_expectation_is_a_partial_sum_of_the_entropy() {
    let partial = |probabilities: &[f64], runs: i32| -> f64 {
        let term = |v: i32, p: f64| p * (1.0 - p).powi(v) / f64::from(v);
        (1..runs).flat_map(|v| probabilities.iter().map(move |&p| term(v, p))).sum()
    };
    for (outcomes, runs) in [(2, 2), (2, 3), (2, 12), (3, 5), (6, 4)] {
        let uniform = vec![1.0 / outcomes as f64; outcomes];
        let found = entropy(&all_sequences(outcomes, 1, runs)).expect("cells");
        assert!((found - partial(&uniform, runs as i32)).abs() < 1e-13, "{outcomes} {runs}");
        let missing = (outcomes as f64).ln() - found;
        assert!(missing > 0.0, "{missing}");
        let left: f64 =
            (runs as i32..2000).map(|v| (1.0 - uniform[0]).powi(v) / f64::from(v)).sum();
        assert!((missing - left).abs() < 1e-12, "{outcomes} {runs}: {missing} {left}");
    }
    // Outcomes with the probabilities 3/4 and 1/4, and 1/2, 1/4 and 1/4.
    for (shared, probabilities) in [(3, vec![0.75, 0.25]), (2, vec![0.5, 0.25, 0.25])] {
        let found = entropy(&all_sequences(4, shared, 6)).expect("cells");
        assert!((found - partial(&probabilities, 6)).abs() < 1e-13, "{found}");
    }
}

/// Mean and root mean square error of an estimate, over the true value.
#[derive(Clone, Copy, Debug)]
struct Measured {
    mean: f64,
    error: f64,
}

/// Returns the frequencies, Miller and Madow's and the program's estimate over simulated samples of 64 cells.
fn measure(probabilities: &[f64], pure: bool, runs: usize, draws: &mut TestRng) -> [Measured; 3] {
    const CELLS: usize = 64;
    const SAMPLES: usize = 400;
    let of_cell: f64 = probabilities.iter().map(|p| -p * p.ln()).sum();
    let exact = if pure { 0.5 * of_cell } else { of_cell };
    let mut sums = [[0.0; 2]; 3];
    for _ in 0..SAMPLES {
        let cells: Vec<Vec<usize>> = (0..CELLS)
            .map(|cell| {
                let mut outcome = || {
                    let mut left = draws.uniform();
                    let passed = |p: &&f64| {
                        left -= **p;
                        left > 0.0
                    };
                    let last = probabilities.len() - 1;
                    probabilities.iter().take_while(passed).count().min(last)
                };
                let certain = pure && cell % 2 == 0;
                (0..runs).map(|_| if certain { 0 } else { outcome() }).collect()
            })
            .collect();
        let (mut frequencies, mut corrected) = (0.0, 0.0);
        for cell in &cells {
            let count = |which| cell.iter().filter(|&&outcome| outcome == which).count() as f64;
            let counts = (0..probabilities.len()).map(count).filter(|&count| count > 0.0);
            let parts: Vec<f64> = counts.map(|count| count / runs as f64).collect();
            frequencies -= parts.iter().map(|p| p * p.ln()).sum::<f64>() / CELLS as f64;
            corrected += (parts.len() - 1) as f64 / (2 * runs * CELLS) as f64;
        }
        let found = [frequencies, frequencies + corrected, entropy(&cells).expect("cells")];
        for (sums, found) in sums.iter_mut().zip(found) {
            sums[0] += found / exact / SAMPLES as f64;
            sums[1] += (found / exact - 1.0).powi(2) / SAMPLES as f64;
        }
    }
    sums.map(|[mean, square]| Measured { mean, error: square.sqrt() })
}

/// Estimates from few runs are too small. Zhang's has a smaller bias and a smaller error than the frequencies and than Miller
/// and Madow's correction.
#[test]
fn the_bias_of_few_runs_is_as_documented() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/methods.md");
    let documented = std::fs::read_to_string(source).expect("the documentation");
    let mut lines = Vec::new();
    let mut draws = TestRng::new(31_416);
    for (outcomes, weight, pure) in
        [(2, 1.0, false), (2, 0.1, true), (2, 0.01, false), (4, 0.5, true)]
    {
        let weights: Vec<f64> = (0..outcomes).map(|power| f64::powi(weight, power)).collect();
        let sum: f64 = weights.iter().sum();
        let probabilities: Vec<f64> = weights.into_iter().map(|weight| weight / sum).collect();
        for runs in [2, 3, 5, 10, 25] {
            let all = measure(&probabilities, pure, runs, &mut draws);
            let columns = all.map(|Measured { mean, error }| format!("{mean:.2} ({error:.2})"));
            let pure_text = if pure { "yes" } else { "no" };
            let line = format!(
                "{outcomes:2}  {weight:4}  {pure_text:>4}  {runs:4}   {}        {}         {}",
                columns[0], columns[1], columns[2]
            );
            println!("{line}");
            lines.push(line);
            let [frequencies, corrected, found] = all;
            let noise = 3.0 * found.error / 20.0;
            assert!(found.mean < 1.0 + noise, "{found:?}");
            assert!(found.mean > corrected.mean && corrected.mean > frequencies.mean, "{all:?}");
            assert!(found.error < frequencies.error, "{all:?}");
        }
    }
    let missing: Vec<&String> = lines.iter().filter(|line| !documented.contains(*line)).collect();
    assert!(missing.is_empty(), "not documented: {missing:#?}");
}
