//! Intervals of stratified samples: definition and simulated coverage.

use crate::support::TestRng;
use stickslip::analysis::{StratifiedCells, Z_95, wilson};

/// Returns cells with these runs, equilibria and failures.
fn cells(counts: &[[u64; 3]]) -> StratifiedCells {
    let mut cells = StratifiedCells::new(counts.len() as u64);
    for (cell, &[runs, equilibria, failures]) in counts.iter().enumerate() {
        for run in 0..runs {
            let failed = run >= runs - failures;
            cells.add(cell as u64, run < equilibria, failed);
        }
    }
    cells
}

#[test]
fn cells_with_too_few_runs_have_no_interval() {
    assert_eq!(cells(&[[2, 1, 0], [1, 1, 0]]).interval(), None);
    assert_eq!(cells(&[[2, 1, 0], [1, 1, 0]]).fraction(), None);
    assert_eq!(cells(&[[50, 20, 0]]).interval(), None);
    // Above 65,536 cells the design counts as not stratified.
    assert_ne!(StratifiedCells::new(65_536), StratifiedCells::default());
    assert_eq!(StratifiedCells::new(65_537), StratifiedCells::default());
    assert_eq!(StratifiedCells::new(u64::MAX), StratifiedCells::default());
}

/// The variance agrees with Cochran's equation 5.53 for `k_h` of `n` in each cell, and the
/// interval's ends are the roots of `|x - p| = z sqrt(x (1 - x) / n_eff)`.
#[test]
fn ends_solve_the_score_equation() {
    let counts = [[4, 0, 0], [4, 1, 0], [4, 4, 0], [4, 3, 0], [4, 4, 0], [4, 4, 0]];
    let squares = |equilibria: u64| {
        let fraction = equilibria as f64 / 4.0;
        let deviations = (0..4).map(|run| f64::from(u8::from(run < equilibria)) - fraction);
        deviations.map(|deviation| deviation * deviation).sum::<f64>() / 3.0
    };
    let within: f64 = counts.iter().map(|[_, equilibria, _]| squares(*equilibria) / 4.0).sum();
    let variance = within / 36.0 + 0.5 * Z_95 * Z_95 / (24.0 * 24.0);
    let fraction = 16.0 / 24.0;
    let trials = fraction * (1.0 - fraction) / variance;
    assert!(trials > 24.0 * 1.2, "more than without cells: {trials}");
    let cells = cells(&counts);
    assert_eq!(cells.fraction(), Some(fraction));
    let (low, high) = cells.interval().unwrap();
    for end in [low, high] {
        let score = (end - fraction).abs() - Z_95 * (end * (1.0 - end) / trials).sqrt();
        assert!(score.abs() < 1e-12, "{end}");
    }
}

/// Pure cells, the clearest possible observation, still leave an interval of positive width;
/// without any or with only successes the interval is Wilson's.
#[test]
fn pure_cells_have_an_interval_of_positive_width() {
    let (low, high) = cells(&[[3, 3, 0], [3, 0, 0]].repeat(128)).interval().unwrap();
    let wilson_width = wilson(384, 768, Z_95).1 - wilson(384, 768, Z_95).0;
    assert!(low < 0.4965 && 0.5035 < high && high - low < 0.11 * wilson_width, "{low} {high}");
    for equilibria in [0, 3] {
        let all = cells(&[[3, equilibria, 0]; 256]).interval();
        assert_eq!(all, Some(wilson(equilibria * 256, 768, Z_95)));
    }
}

#[test]
fn failures_widen_the_interval_and_cells_have_equal_weights() {
    let with = cells(&[[3, 2, 1], [3, 0, 0], [3, 3, 0], [3, 1, 1]]).interval().unwrap();
    let low = cells(&[[3, 2, 0], [3, 0, 0], [3, 3, 0], [3, 1, 0]]).interval().unwrap();
    let high = cells(&[[3, 3, 0], [3, 0, 0], [3, 3, 0], [3, 2, 0]]).interval().unwrap();
    assert_eq!(with, (low.0, high.1));
    // Six of eight runs, but half of the box.
    let uneven = cells(&[[6, 6, 0], [2, 0, 0]]);
    assert_eq!(uneven.fraction(), Some(0.5));
    let (low, high) = uneven.interval().unwrap();
    assert!((low + high - 1.0).abs() < 1e-12);
}

/// Returns the fractions of the cells, for a family of populations.
fn populations(cells: usize, draws: &mut TestRng) -> Vec<Vec<f64>> {
    let mut all = Vec::new();
    let half = |cell: usize| (cell % 2) as f64;
    for mean in [0.004, 0.1, 0.5, 0.9, 0.996] {
        all.push(vec![mean; cells]);
        for weight in [0.1, 1.0, 5.0] {
            let [a, b] = [2.0 * weight * mean, 2.0 * weight * (1.0 - mean)];
            all.push((0..cells).map(|_| draws.beta(a, b)).collect());
        }
    }
    for fraction in [0.0, 0.02, 0.1, 0.25, 0.5] {
        let mixed = (fraction * cells as f64).round() as usize;
        for level in [0.5, 0.1] {
            let of = |cell| if cell < mixed { level } else { half(cell) };
            all.push((0..cells).map(of).collect());
        }
    }
    for nearly in [0.005, 0.02, 0.05] {
        all.push((0..cells).map(|cell| half(cell).max(nearly)).collect());
    }
    all
}

fn binomial(runs: u64, fraction: f64, draws: &mut TestRng) -> u64 {
    if fraction <= 0.0 || fraction >= 1.0 {
        return if fraction > 0.5 { runs } else { 0 };
    }
    let mut left = draws.uniform();
    let mut probability = (1.0 - fraction).powi(runs as i32);
    for k in 0..runs {
        left -= probability;
        if left < 0.0 {
            return k;
        }
        probability *= fraction / (1.0 - fraction) * (runs - k) as f64 / (k + 1) as f64;
    }
    runs
}

struct Measured {
    /// Least coverage, and the least with an expected number of successes or failures below
    /// one.
    least: [f64; 2],
    mean: f64,
    width: f64,
    least_width: f64,
}

/// Measures the coverage over seeded samples with `runs` in every cell and `runs_late` in the
/// second half of the cells.
fn measure(count: usize, runs: u64, runs_late: u64, draws: &mut TestRng) -> Measured {
    let mut measured = Measured { least: [1.0; 2], mean: 0.0, width: 0.0, least_width: 1.0 };
    let populations = populations(count, draws);
    let repetitions = 1000;
    for population in &populations {
        let exact = population.iter().sum::<f64>() / count as f64;
        let (mut held, mut width, mut wilson_width) = (0, 0.0, 0.0);
        for _ in 0..repetitions {
            let counts: Vec<[u64; 3]> = (0..count)
                .zip(population)
                .map(|(cell, &fraction)| {
                    let runs = if 2 * cell < count { runs } else { runs_late };
                    [runs, binomial(runs, fraction, draws), 0]
                })
                .collect();
            let total = |which: usize| counts.iter().map(|cell| cell[which]).sum::<u64>();
            let (low, high) = cells(&counts).interval().unwrap();
            held += u32::from(low <= exact && exact <= high);
            width += high - low;
            let (low, high) = wilson(total(1), total(0), Z_95);
            wilson_width += high - low;
        }
        let (held, ratio) = (f64::from(held) / f64::from(repetitions), width / wilson_width);
        let expected = exact.min(1.0 - exact) * (count as u64 * runs_late) as f64;
        let least = &mut measured.least[usize::from(expected < 1.0)];
        *least = least.min(held);
        measured.mean += held / populations.len() as f64;
        measured.width += ratio / populations.len() as f64;
        measured.least_width = measured.least_width.min(ratio);
    }
    measured
}

/// The coverage is at least 0.93 in every population, up to the error of 1000 samples (0.008).
/// With an expected number of successes or failures below one it is no less than the minimum of
/// Wilson's interval (0.838 for 0.18 expected, Brown, Cai and DasGupta, Stat. Sci. 16 (2001)
/// 101). Its mean is 0.95 or slightly more, and many cells make the interval narrower.
#[test]
fn simulated_coverage_and_width_are_as_documented() {
    let mut draws = TestRng::new(65);
    for count in [16, 256] {
        for (runs, runs_late) in [(2, 2), (3, 3), (5, 5), (10, 10), (3, 2)] {
            let found = measure(count, runs, runs_late, &mut draws);
            let samples =
                if runs == runs_late { runs.to_string() } else { format!("{runs}, {runs_late}") };
            println!(
                "{count:5}  {samples:>7}  {:14.3} ({:.3})  {:5.3}  {:.2}, {:.2}",
                found.least[0], found.least[1], found.mean, found.width, found.least_width
            );
            assert!(found.least[0] >= 0.922 && found.least[1] >= 0.83, "{:?}", found.least);
            assert!((0.95..0.99).contains(&found.mean), "{}", found.mean);
            let widest = if count == 16 { 0.95 } else { 0.8 };
            assert!(found.width < widest, "{}", found.width);
        }
    }
}
