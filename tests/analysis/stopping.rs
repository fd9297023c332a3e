//! The stopping rule: number of runs, and coverage after stopping.

use crate::support::TestRng;
use stickslip::analysis::{HalfWidths, ObservedRun, PointAccumulator, StoppingRule, Z_95, wilson};
use stickslip::classification::{Evidence, Outcome, Rest};

const CELLS: u64 = 16;

fn half_width((low, high): (f64, f64)) -> f64 {
    0.5 * (high - low)
}

/// Samples a point whose fraction of equilibria is `fraction` by the rule and returns the
/// number of runs and the interval. Half of the 16 cells have a fraction larger by `spread`,
/// the other half a smaller one; with `stratified` the interval uses the cells.
fn sampled(
    draws: &mut TestRng,
    rule: StoppingRule,
    fraction: f64,
    spread: f64,
    stratified: bool,
) -> (u64, (f64, f64)) {
    let (rest, moving) =
        (Outcome::of(Evidence::RestCertified(Rest::default())), Outcome::default());
    let mut point = PointAccumulator::new(stratified.then_some(CELLS));
    let (mut runs, mut more) = (0, Some(rule.replicate));
    while let Some(round) = more {
        for run in runs..runs + round {
            let cell = run % CELLS;
            let fraction = if cell < CELLS / 2 { fraction + spread } else { fraction - spread };
            let outcome = if draws.uniform() < fraction { &rest } else { &moving };
            point.add(ObservedRun { cell, case: None, outcome, audit: None });
        }
        runs += round;
        more = rule.more(runs, point.equilibrium_interval().ends());
    }
    (runs, point.equilibrium_interval().ends())
}

/// Runs are added in whole replicates, at most doubling the runs and never exceeding the
/// maximum; none are added once the interval is narrow enough.
#[test]
fn rounds_are_whole_replicates_within_bounds() {
    let mut draws = TestRng::new(7);
    for _ in 0..10_000 {
        let replicate = 1 + draws.below(300);
        let most = replicate * (1 + draws.below(200));
        let rule = StoppingRule { half_width: 0.5 * draws.uniform(), replicate, most };
        let runs = replicate * (1 + draws.below(most / replicate));
        let low = draws.uniform();
        let interval = (low, low + (1.0 - low) * draws.uniform());
        match rule.more(runs, interval) {
            None => assert!(half_width(interval) <= rule.half_width || runs >= most),
            Some(more) => {
                assert!(half_width(interval) > rule.half_width);
                assert!(more > 0 && more % replicate == 0, "{more} {replicate}");
                assert!(more <= runs && runs + more <= most, "{runs} {more} {most}");
                // No more runs than needed if widths shrink with the square root of the number
                // of runs.
                let needed = (half_width(interval) / rule.half_width).powi(2) * runs as f64;
                let before = (runs + more - replicate) as f64;
                assert!(before <= needed * (1.0 + 1e-12), "{before} {needed}");
            }
        }
    }
}

/// Rounds grow, so that thousands of runs take few decisions.
#[test]
fn rounds_grow() {
    let rule = StoppingRule { half_width: 0.02, replicate: 10, most: 100_000 };
    let (mut runs, mut rounds) = (10, 1);
    while let Some(more) = rule.more(runs, wilson(runs / 2, runs, Z_95)) {
        (runs, rounds) = (runs + more, rounds + 1);
    }
    assert!((2390..2410).contains(&runs), "{runs}");
    assert!(rounds < 12, "{rounds}");
}

/// The intervals at which sampling stops cover the fraction in at least 94 % of 10,000 points
/// each, at a level of 1e-5 for each of the sixteen settings (4.3 standard deviations).
#[test]
fn intervals_keep_their_coverage_after_stopping() {
    let rule = StoppingRule { half_width: 0.05, replicate: 16, most: 1 << 20 };
    let (points, claimed) = (10_000, 0.94);
    let least = claimed - 4.3 * (claimed * (1.0 - claimed) / f64::from(points)).sqrt();
    let mut draws = TestRng::new(11);
    for fraction in [0.02, 0.1, 0.5, 0.9] {
        let apart = 0.9 * f64::min(fraction, 1.0 - fraction);
        for (spread, stratified) in [(0.0, false), (apart, false), (0.0, true), (apart, true)] {
            let mut covered = 0;
            for _ in 0..points {
                let (_, (low, high)) = sampled(&mut draws, rule, fraction, spread, stratified);
                assert!(half_width((low, high)) <= rule.half_width);
                covered += u32::from(low <= fraction && fraction <= high);
            }
            let coverage = f64::from(covered) / f64::from(points);
            println!("fraction {fraction}, spread {spread}, stratified {stratified}: {coverage}");
            assert!(
                coverage > least,
                "fraction {fraction}, spread {spread}, {stratified}: {coverage}"
            );
        }
    }
}

/// Samples the amplitude of a point by the rule and returns its number of runs and the interval of the quantile with this
/// index among 5, 50 and 95 %.
fn sampled_amplitude(
    draws: &mut TestRng,
    index: usize,
    half_width: f64,
    quantile: impl Fn(f64) -> f64,
) -> (u64, [f64; 2]) {
    let mut half_widths = HalfWidths::default();
    half_widths.amplitude_m[index] = Some(half_width);
    let mut point = PointAccumulator::new(None);
    let (mut runs, mut more) = (0, Some(16));
    while let Some(round) = more {
        for _ in 0..round {
            let amplitude_m = Some(quantile(draws.uniform()));
            let outcome = &Outcome { amplitude_m, ..Outcome::default() };
            point.add(ObservedRun { cell: 0, case: None, outcome, audit: None });
        }
        runs += round;
        more = half_widths.more(16, 1 << 20, runs, &point);
    }
    let interval = point.amplitude_interval([0.05, 0.5, 0.95][index]);
    (runs, interval.map(|end| end.expect("a bound")))
}

/// The quantile of a fraction in a distribution of amplitudes.
type Quantile<'a> = &'a dyn Fn(f64) -> f64;

/// The intervals of quantiles at which sampling stops cover the quantile in at least 93 % of 2000 points each, at a level
/// of 1e-5 for each of the six settings (4.3 standard deviations). The amplitudes are uniform, exponential, and of two
/// kinds with a gap that no quantile is in.
#[test]
fn intervals_of_amplitudes_keep_their_coverage_after_stopping() {
    let (points, claimed) = (2000_u32, 0.93);
    let least = claimed - 4.3 * (claimed * (1.0 - claimed) / f64::from(points)).sqrt();
    let mut draws = TestRng::new(13);
    let uniform = |u: f64| u;
    let exponential = |u: f64| -f64::ln_1p(-u);
    let two_kinds = |u: f64| if u < 0.3 { u } else { u + 5.0 };
    let all: [(&str, Quantile<'_>, [f64; 2]); 3] = [
        ("uniform", &uniform, [0.08, 0.03]),
        ("exponential", &exponential, [0.16, 0.6]),
        ("two kinds", &two_kinds, [0.08, 0.03]),
    ];
    for (name, quantile, half_widths) in all {
        for (index, half_width) in [(1, half_widths[0]), (2, half_widths[1])] {
            let exact = quantile([0.05, 0.5, 0.95][index]);
            let (mut covered, mut total) = (0, 0);
            for _ in 0..points {
                let (runs, [low, high]) =
                    sampled_amplitude(&mut draws, index, half_width, quantile);
                assert!(0.5 * (high - low) <= half_width);
                covered += u32::from(low <= exact && exact <= high);
                total += runs;
            }
            let coverage = f64::from(covered) / f64::from(points);
            let runs = total / u64::from(points);
            println!("{name}, quantile {index}, half width {half_width}: {coverage}, {runs} runs");
            assert!(coverage > least, "{name}, {index}, {half_width}: {coverage}");
        }
    }
}

/// Of several intervals, the one that needs the most runs decides; too few runs bound no interval, and are doubled.
#[test]
fn the_interval_that_needs_the_most_runs_decides() {
    let mut draws = TestRng::new(17);
    let mut point = PointAccumulator::new(None);
    let add = |point: &mut PointAccumulator, draws: &mut TestRng, runs: u64| {
        for _ in 0..runs {
            let outcome = &Outcome { amplitude_m: Some(draws.uniform()), ..Outcome::default() };
            point.add(ObservedRun { cell: 0, case: None, outcome, audit: None });
        }
    };
    add(&mut point, &mut draws, 32);
    let tail = HalfWidths { amplitude_m: [None, None, Some(1.0)], ..HalfWidths::default() };
    // 0.95^32 = 0.19 exceeds the tail: nothing bounds the quantile from above.
    assert_eq!(tail.more(8, 1000, 32, &point), Some(32));
    assert_eq!(tail.more(8, 40, 32, &point), Some(8));
    assert_eq!(tail.more(8, 32, 32, &point), None);
    add(&mut point, &mut draws, 968);
    assert_eq!(tail.more(8, 10_000, 1000, &point), None);
    // No run is at rest: the fraction is precise, and the median is not.
    let fraction = HalfWidths { equilibrium_fraction: Some(0.01), ..HalfWidths::default() };
    let median = HalfWidths { amplitude_m: [None, Some(0.02), None], ..HalfWidths::default() };
    let both = HalfWidths { equilibrium_fraction: Some(0.01), ..median };
    assert_eq!(fraction.more(8, 10_000, 1000, &point), None);
    let more = median.more(8, 10_000, 1000, &point);
    assert!(more.is_some_and(|more| more > 0 && more < 1000), "{more:?}");
    assert_eq!(both.more(8, 10_000, 1000, &point), more);
    assert!(fraction.reached(&point.clone().summary()) && !both.reached(&point.summary()));
}
