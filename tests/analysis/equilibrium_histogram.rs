//! Histograms of rest angles against known distributions.

use std::f64::consts::TAU;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::support::TestRng;
use stickslip::analysis::{BINS, EquilibriumHistogram, HistogramBin, bin, bin_edges};

fn identical(balls: usize) -> Vec<Vec<usize>> {
    vec![(0..balls).collect()]
}

fn differing(balls: usize) -> Vec<Vec<usize>> {
    (0..balls).map(|ball| vec![ball]).collect()
}

fn sorted(mut beta: Vec<f64>) -> Vec<f64> {
    beta.sort_by(f64::total_cmp);
    beta
}

#[test]
fn bins_have_their_angles() {
    for angle in [0.0, 1e-300, 0.17453, 1.0, 3.0, TAU - 1e-9, TAU.next_down()] {
        let [from, to] = bin_edges(bin(angle));
        assert!(from <= angle && angle <= to, "{angle}");
    }
    assert_eq!((bin(0.0), bin(TAU.next_down()), bin(-0.1)), (0, 35, 35));
    assert_eq!(bin_edges(35)[1], TAU);
}

/// The counts add up to all equilibria, and the fractions lie in their intervals.
#[test]
fn every_equilibrium_is_counted() {
    let mut draws = TestRng::new(10);
    for balls in [1, 2, 3, 5] {
        for groups in [identical(balls), differing(balls)] {
            let mut histogram = EquilibriumHistogram::default();
            for _ in 0..500 {
                let beta = (0..balls).map(|_| draws.von_mises(2.0, 3.0)).collect();
                histogram.add(&if groups.len() == 1 { sorted(beta) } else { beta }, &groups);
            }
            let rows = histogram.bins();
            let runs: u64 = rows.iter().map(|row| row.runs).sum();
            match balls {
                1 | 2 => assert_eq!(runs, 500),
                // More than one ball may lie in a bin.
                _ => assert!(runs <= 500 * balls as u64 && runs >= 500 * groups.len() as u64),
            }
            let inside = |row: &HistogramBin| {
                row.interval.0 < row.fraction && row.fraction <= row.interval.1
            };
            assert!(rows.iter().all(inside));
            assert!(
                groups.len() > 1 || balls != 2 || rows.iter().all(|row| row.bins[0] <= row.bins[1])
            );
        }
    }
}

/// For two independent von Mises angles, the counts of the bins pass a chi-square test at a
/// level of 0.001.
#[test]
fn bins_count_a_known_distribution() {
    let mut draws = TestRng::new(12);
    let (centres, concentrations) = ([2.0, 5.0], [2.0, 4.0]);
    let runs = 20_000;
    let mut histogram = EquilibriumHistogram::default();
    for _ in 0..runs {
        let beta = [0, 1].map(|i| draws.von_mises(centres[i], concentrations[i])).to_vec();
        histogram.add(&beta, &differing(2));
    }
    // The distribution of each angle on 7200 points.
    let points = 7200;
    let at = |point: usize| (point as f64 + 0.5) * TAU / points as f64;
    let exact = [0, 1].map(|i| {
        let weight = |angle: f64| (concentrations[i] * ((angle - centres[i]).cos() - 1.0)).exp();
        let all: f64 = (0..points).map(|point| weight(at(point))).sum();
        (0..points).map(|point| weight(at(point)) / all).collect::<Vec<f64>>()
    });
    let of_bin = |i: usize, bin: usize| -> f64 {
        exact[i][bin * points / BINS..(bin + 1) * points / BINS].iter().sum()
    };
    let rows = histogram.bins();
    let (mut chi_square, mut kinds, mut rest) = (0.0, 0, [0.0, runs as f64]);
    for (a, b) in (0..BINS).flat_map(|a| (0..BINS).map(move |b| (a, b))) {
        let expected = of_bin(0, a) * of_bin(1, b) * f64::from(runs);
        if expected >= 5.0 {
            let found = rows.iter().find(|row| row.bins == [a, b]).map_or(0, |row| row.runs);
            chi_square += (found as f64 - expected).powi(2) / expected;
            kinds += 1;
            rest = [rest[0] + expected, rest[1] - found as f64];
        }
    }
    let left = f64::from(runs) - rest[0];
    chi_square += (rest[1] - left).powi(2) / left;
    let limit = ChiSquared::new(f64::from(kinds)).unwrap().inverse_cdf(0.999);
    println!("chi-square {chi_square} of {kinds}, limit {limit}");
    assert!(kinds > 300 && chi_square < limit);
}
