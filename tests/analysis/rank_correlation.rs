//! Spearman's rank correlation against its closed forms, and the coverage of its interval.

use std::f64::consts::PI;

use stickslip::analysis::rank_correlation;

use crate::support::TestRng;

/// Without equal values, the coefficient is `1 - 6 Σ d² / (n (n² - 1))`, where `d` are the differences of the ranks.
#[test]
fn the_coefficient_of_permutations() {
    let x: Vec<f64> = (1..=7).map(f64::from).collect();
    for ranks in [[1, 2, 3, 4, 5, 6, 7], [7, 6, 5, 4, 3, 2, 1], [3, 1, 4, 7, 5, 2, 6]] {
        // Any increasing function of the ranks has the same coefficient.
        let y: Vec<f64> = ranks.iter().map(|rank| f64::from(*rank).exp()).collect();
        let squares: f64 = x.iter().zip(ranks).map(|(x, y)| (x - f64::from(y)).powi(2)).sum();
        let expected = 1.0 - 6.0 * squares / (7.0 * 48.0);
        let found = rank_correlation(&x, &y).expect("five values or more that differ").value;
        assert!((found - expected).abs() < 1e-12, "{ranks:?}: {found} {expected}");
    }
}

/// Ranks 1, 2.5, 2.5, 4, 5 and 2, 1, 3.5, 3.5, 5: the products of the deviations from 3 sum up to 7.25, the squares
/// to 9.5 each.
#[test]
fn equal_values_have_the_mean_rank() {
    let found = rank_correlation(&[1.0, 2.0, 2.0, 4.0, 5.0], &[3.0, 1.0, 4.0, 4.0, 6.0])
        .expect("five values or more that differ");
    assert!((found.value - 7.25 / 9.5).abs() < 1e-12, "{found:?}");
    // Infinite values rank last.
    let largest = [3.0, 1.0, 4.0, 4.0, f64::INFINITY];
    assert_eq!(
        rank_correlation(&[1.0, 2.0, 2.0, 4.0, 5.0], &largest)
            .expect("five values or more that differ"),
        found
    );
}

#[test]
fn some_values_have_no_correlation() {
    let x = [1.0, 2.0, 3.0, 4.0, 5.0];
    assert_eq!(rank_correlation(&x, &[2.0; 5]), None);
    assert_eq!(rank_correlation(&x[..4], &x[..4]), None);
    assert_eq!(rank_correlation(&x, &x[..4]), None);
    assert_eq!(rank_correlation(&x, &[1.0, 2.0, f64::NAN, 4.0, 5.0]), None);
    let perfect = rank_correlation(&x, &x).expect("five values or more that differ");
    assert_eq!([perfect.value, perfect.low, perfect.high], [1.0; 3]);
}

/// The coefficient of a bivariate normal distribution with correlation ρ is `6/π asin(ρ/2)`. Its interval covers it in
/// about 95 % of 2000 samples: a standard deviation is 0.5 %.
#[test]
fn intervals_cover_the_coefficient_of_a_normal_distribution() {
    let mut random = TestRng::new(21);
    for rho in [0.0_f64, 0.4, -0.7] {
        let expected = 6.0 / PI * (rho / 2.0).asin();
        let (mut covered, mut sum) = (0, 0.0);
        for _ in 0..2000 {
            let mut pair = || {
                let (x, y) = (random.normal(), random.normal());
                (x, rho * x + (1.0 - rho * rho).sqrt() * y)
            };
            let (x, y): (Vec<f64>, Vec<f64>) = (0..60).map(|_| pair()).unzip();
            let found = rank_correlation(&x, &y).expect("five values or more that differ");
            covered += u32::from((found.low..=found.high).contains(&expected));
            sum += found.value;
        }
        let part = f64::from(covered) / 2000.0;
        assert!((0.93..0.975).contains(&part), "{rho}: {part}");
        // The bias is below 1/n.
        assert!((sum / 2000.0 - expected).abs() < 0.02, "{rho}: {} {expected}", sum / 2000.0);
    }
}
