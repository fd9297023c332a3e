//! Further parameter sets: where the posterior is, and far from the sets so far.

use super::likelihood::Likelihood;
use super::sampler::{generator, sample_in_unit_cube};
use crate::study::Study;

/// The number of places among which the next ones are chosen.
const CANDIDATES: usize = 512;

/// Returns `count` places in the unit cube for the next parameter sets.
pub(super) fn next_places(study: &Study, likelihood: &Likelihood, count: usize) -> Vec<Vec<f64>> {
    let places = &likelihood.smoother.places;
    let dimensions = places.first().map_or(0, Vec::len);
    let mut random = generator(study, "identify next", places.len() as u64);
    let density = |place: &[f64]| likelihood.at(place, 0);
    let candidates = sample_in_unit_cube(dimensions, CANDIDATES, density, &mut random);
    let widths: Vec<f64> = (0..dimensions).map(|index| width(&candidates, index)).collect();
    let mut all = places.to_vec();
    for _ in 0..count {
        let distance = |place: &Vec<f64>| {
            let square = |other: &Vec<f64>| -> f64 {
                let parts = place.iter().zip(other).zip(&widths);
                parts.map(|((x, y), width)| ((x - y) / width).powi(2)).sum()
            };
            all.iter().map(square).fold(f64::INFINITY, f64::min)
        };
        let scored = candidates.iter().map(|place| (distance(place), place));
        let farthest = scored.max_by(|left, right| left.0.total_cmp(&right.0));
        let Some((_, farthest)) = farthest else { break };
        all.push(farthest.clone());
    }
    all.split_off(places.len())
}

/// Returns the standard deviation of a coordinate.
fn width(places: &[Vec<f64>], index: usize) -> f64 {
    let count = places.len() as f64;
    let mean = places.iter().map(|place| place[index]).sum::<f64>() / count;
    let square = |place: &Vec<f64>| (place[index] - mean).powi(2);
    (places.iter().map(square).sum::<f64>() / count).sqrt().max(1e-6)
}
