//! Surrogates of noisy and of constant values.

use stickslip::optimize::Surrogate;

/// The fit recovers a smooth function and the noise from noisy values.
#[test]
fn noise_is_separated_from_the_function() {
    let function = |x: f64| (4.0 * x).sin();
    let noise = |index: usize| 0.1 * ((index * 7919 % 101) as f64 / 101.0 - 0.5) * 3.46;
    let places: Vec<Vec<f64>> = (0..40).map(|index| vec![f64::from(index) / 39.0]).collect();
    let values: Vec<f64> = places
        .iter()
        .enumerate()
        .map(|(index, place)| 5.0 + function(place[0]) + noise(index))
        .collect();
    let surrogate = Surrogate::fit(&places, &values, 0.04, 1).unwrap();
    let found = surrogate.predict(&places).unwrap();
    let mean_error = places
        .iter()
        .zip(&found)
        .map(|(place, found)| (found - 5.0 - function(place[0])).abs())
        .sum::<f64>()
        / 40.0;
    assert!(mean_error < 0.05, "{mean_error}");
    assert!((0.05..0.2).contains(&surrogate.noise()), "{}", surrogate.noise());
}

#[test]
fn equal_values_have_no_surrogate() {
    let places = vec![vec![0.0], vec![0.5], vec![1.0]];
    let refused = Surrogate::fit(&places, &[2.0; 3], 0.1, 1).err();
    assert_eq!(refused.as_deref(), Some("all values are equal"));
}
