//! Tests at each site whether the model explains the measured runs, for parameters of the posterior.
//!
//! The energy distance (Székely and Rizzo 2013, doi:10.1016/j.jspi.2013.03.018) between measured runs and runs of the posterior
//! predictive distribution is compared with that of random parts of both together. Two distances of positions
//! are used: of the angles on the torus, for the best assignment of balls, and of the angles between neighbouring balls alone,
//! which shows whether balls touch. Runs that move are at the largest distance from runs that rest.

use std::f64::consts::{PI, TAU};

use rand::RngExt;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::density::{Rests, permutations};
use super::sampler::{generator, normal};
use super::site::Site;
use crate::model::wrap_to_pi;
use crate::study::Study;
use crate::table::PointKey;

/// The number of runs of the predictive distribution.
const POOL: usize = 800;
/// The number of random exchanges that the measured runs are compared with.
const SAMPLES: u32 = 999;
/// The test at a site compares at most this many measured runs, drawn at random: its time and its memory grow with the square of
/// their number.
pub(super) const TESTED: usize = 800;

/// The test at a site.
#[derive(Clone, Debug, PartialEq)]
pub struct SiteFit {
    /// The point.
    pub point: PointKey,
    /// Number of the stage.
    pub stage: u64,
    /// Number of measured runs that rest, and that move.
    pub measured: [u64; 2],
    /// Number of measured runs that the test compares: all, or a random sample of them.
    pub tested: u64,
    /// The fraction of runs of the predictive distribution that rest.
    pub predicted_rest_fraction: f64,
    /// Probability of a distance of positions at least as large as that of the measured runs.
    pub p_positions: f64,
    /// Probability of a distance of the angles between neighbouring balls at least as large as that of the measured runs; `None`
    /// for one ball.
    pub p_neighbours: Option<f64>,
    /// The runs of the predictive distribution, with the error of the measurements.
    pub predicted: Vec<SeenRun>,
}

impl SiteFit {
    /// Returns the probability of a deviation at least as large as that of the measured runs, corrected for both tests
    /// (Bonferroni).
    pub fn p_value(&self) -> f64 {
        match self.p_neighbours {
            None => self.p_positions,
            Some(neighbours) => (2.0 * self.p_positions.min(neighbours)).min(1.0),
        }
    }
}

/// A run as measured: the angles, or `None` if it moves.
pub type SeenRun = Option<Vec<f64>>;

/// Returns the tests at all sites. `drawn` are the simulated ends of a parameter set next to each sample of the posterior, one entry
/// per site.
pub fn fit_tests(study: &Study, sites: &[Site], drawn: &[&[Rests]]) -> Vec<SiteFit> {
    let test = |(index, site): (usize, &Site)| {
        let mut random = generator(study, "identify fit", index as u64);
        let drawn: Vec<&Rests> = drawn.iter().filter_map(|of_set| of_set.get(index)).collect();
        let point = PointKey::of(&study.point(site.point_id));
        test_at(point, site, &drawn, &mut random)
    };
    sites.par_iter().enumerate().filter_map(test).collect()
}

fn test_at(
    point: PointKey,
    site: &Site,
    drawn: &[&Rests],
    random: &mut ChaCha8Rng,
) -> Option<SiteFit> {
    let deviations: Vec<f64> = site.rests.iter().map(|rest| rest.std_dev_rad).collect();
    let known: Vec<&Rests> = drawn.iter().copied().filter(|rests| rests.runs() > 0).collect();
    if known.is_empty() {
        return None;
    }
    let pool: Vec<SeenRun> = (0..POOL)
        .map(|_| {
            let rests = known[random.random_range(0..known.len())];
            let angles = rests.run(random.random_range(0..rests.runs()))?;
            let deviation = match deviations.len() {
                0 => 0.0,
                count => deviations[random.random_range(0..count)],
            };
            Some(angles.iter().map(|angle| angle + deviation * normal(random)).collect())
        })
        .collect();
    let rests = site.rests.iter().map(|rest| Some(rest.angles.clone()));
    let mut measured: Vec<SeenRun> = rests.chain((0..site.moving).map(|_| None)).collect();
    if measured.len() > TESTED {
        measured = measured.partial_shuffle(random, TESTED).0.to_vec();
    }
    let balls = measured.iter().chain(&pool).flatten().map(Vec::len).max().unwrap_or(0);
    let orders = permutations(balls);
    let positions =
        |left: &SeenRun, right: &SeenRun| distance(left, right, |x, y| torus(&orders, x, y));
    let p_positions = p_value(&measured, &pool, positions, random);
    let p_neighbours = (balls > 1).then(|| {
        let gaps = |all: &[SeenRun]| -> Vec<SeenRun> {
            all.iter().map(|seen| seen.as_deref().map(angles_between)).collect()
        };
        let apart = |left: &SeenRun, right: &SeenRun| distance(left, right, euclidean);
        p_value(&gaps(&measured), &gaps(&pool), apart, random)
    });
    let at_rest = pool.iter().flatten().count();
    Some(SiteFit {
        point,
        stage: site.stage,
        measured: [site.rests.len() as u64, site.moving],
        tested: measured.len() as u64,
        predicted_rest_fraction: at_rest as f64 / pool.len() as f64,
        p_positions,
        p_neighbours,
        predicted: pool,
    })
}

/// Returns the probability of an energy distance from the pool at least as large as that of the measured runs, if measured runs
/// and pool are exchanged at random (permutation test): the pool is a sample, too.
fn p_value(
    measured: &[SeenRun],
    pool: &[SeenRun],
    distance: impl Fn(&SeenRun, &SeenRun) -> f64,
    random: &mut ChaCha8Rng,
) -> f64 {
    let all: Vec<&SeenRun> = measured.iter().chain(pool).collect();
    let distances: Vec<Vec<f64>> =
        all.iter().map(|run| all.iter().map(|other| distance(run, other)).collect()).collect();
    let to_all: Vec<f64> = distances.iter().map(|row| row.iter().sum()).collect();
    let total: f64 = to_all.iter().sum();
    let [n, m] = [measured.len(), pool.len()].map(|count| count as f64);
    // The energy distance of the runs with these numbers from all other runs.
    let energy = |chosen: &[usize]| {
        let from = |(index, number): (usize, &usize)| -> f64 {
            chosen[..index].iter().map(|other| distances[*number][*other]).sum()
        };
        // Both orders of each pair; the distance of a run from itself is 0.
        let within = 2.0 * chosen.iter().enumerate().map(from).sum::<f64>();
        let between = chosen.iter().map(|number| to_all[*number]).sum::<f64>() - within;
        let rest = total - 2.0 * between - within;
        2.0 * between / (n * m) - within / (n * n) - rest / (m * m)
    };
    let mut numbers: Vec<usize> = (0..all.len()).collect();
    let of_measured = energy(&numbers[..measured.len()]);
    let mut as_large = 0;
    for _ in 0..SAMPLES {
        let (chosen, _) = numbers.partial_shuffle(random, measured.len());
        as_large += u32::from(energy(chosen) >= of_measured);
    }
    f64::from(as_large + 1) / f64::from(SAMPLES + 1)
}

/// Returns the distance of two runs; a run at rest and one that moves are half a turn of each ball apart.
fn distance(left: &SeenRun, right: &SeenRun, of_rests: impl Fn(&[f64], &[f64]) -> f64) -> f64 {
    match (left, right) {
        (Some(left), Some(right)) => of_rests(left, right),
        (None, None) => 0.0,
        (Some(rest), None) | (None, Some(rest)) => PI * (rest.len() as f64).sqrt(),
    }
}

/// Returns the distance of two positions on the torus for the best of these assignments of balls.
fn torus(orders: &[Vec<usize>], x: &[f64], y: &[f64]) -> f64 {
    let square = |order: &Vec<usize>| -> f64 {
        x.iter().zip(order).map(|(angle, place)| wrap_to_pi(angle - y[*place]).powi(2)).sum()
    };
    orders.iter().map(square).fold(f64::INFINITY, f64::min).sqrt()
}

fn euclidean(left: &[f64], right: &[f64]) -> f64 {
    left.iter().zip(right).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
}

/// Returns the angles from each ball to the next one around the ring, in ascending order; their sum is one turn.
fn angles_between(angles: &[f64]) -> Vec<f64> {
    let mut sorted: Vec<f64> = angles.iter().map(|angle| angle.rem_euclid(TAU)).collect();
    sorted.sort_by(f64::total_cmp);
    let next = sorted.iter().skip(1).copied().chain(sorted.first().map(|first| first + TAU));
    let mut between: Vec<f64> = sorted.iter().zip(next).map(|(angle, next)| next - angle).collect();
    between.sort_by(f64::total_cmp);
    between
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::{TESTED, angles_between, permutations, test_at, torus};
    use crate::identify::density::Rests;
    use crate::identify::site::{BallsEnd, MeasuredRest, Site};
    use crate::table::PointKey;

    fn point() -> PointKey {
        PointKey { point_id: 0, swept: Vec::new() }
    }

    #[test]
    fn distances_do_not_tell_balls_apart() {
        let orders = permutations(2);
        let turn = std::f64::consts::TAU;
        assert!(torus(&orders, &[0.1, 3.0], &[3.0, 0.1 + turn]) < 1e-15);
        assert!((torus(&orders, &[0.1, 3.0], &[turn - 0.1, 3.0]) - 0.2).abs() < 1e-12);
        let between = angles_between(&[6.2, 0.1, 3.0]);
        let expected = [0.1 + turn - 6.2, 2.9, 3.2];
        assert!(
            between.iter().zip(expected).all(|(left, right)| (left - right).abs() < 1e-12),
            "{between:?}"
        );
    }

    /// Balls that rest together somewhere on the ring, at this angle from each other.
    fn pairs(apart: f64, count: usize, seed: u64) -> Vec<Vec<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let pair = |_| {
            let first: f64 = random.random::<f64>() * 2.0;
            vec![first, first + apart]
        };
        (0..count).map(pair).collect()
    }

    fn site(positions: Vec<Vec<f64>>, moving: u64) -> Site {
        let measured = |angles| MeasuredRest { angles, std_dev_rad: 0.05 };
        Site { point_id: 0, stage: 1, rests: positions.into_iter().map(measured).collect(), moving }
    }

    /// The test rejects a true model in about 5 of 100 cases: at most 12 with a probability of 0.998. It finds pairs that do
    /// not touch where they do in the model, and a wrong fraction of moving runs.
    #[test]
    fn levels_and_powers() {
        let rest = |angles: Vec<f64>| BallsEnd::Rest { angles, groups: vec![0, 1] };
        let ends: Vec<BallsEnd> = pairs(0.26, 600, 1).into_iter().map(rest).collect();
        let model = Rests::new(2, &ends);
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut p_of =
            |site: &Site| test_at(point(), site, &[&model], &mut random).expect("a test").p_value();
        let rejected = |site: Site, p_of: &mut dyn FnMut(&Site) -> f64| p_of(&site) < 0.05;
        let blurred = |seed| {
            let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
            let mut all = pairs(0.26, 40, seed);
            all.iter_mut().flatten().for_each(|angle| *angle += 0.05 * super::normal(&mut random));
            all
        };
        let of_truth = (2..102).filter(|seed| rejected(site(blurred(*seed), 0), &mut p_of)).count();
        assert!(of_truth <= 12, "{of_truth}");
        assert!(p_of(&site(pairs(0.0, 40, 200), 0)) < 0.005);
        assert!(p_of(&site(blurred(300), 20)) < 0.005);
    }

    /// Of many measured runs a random sample is compared: it sees that pairs do not touch in all rows but the first ones.
    #[test]
    fn a_sample_of_many_runs() {
        let rest = |angles: Vec<f64>| BallsEnd::Rest { angles, groups: vec![0, 1] };
        let ends: Vec<BallsEnd> = pairs(0.26, 600, 1).into_iter().map(rest).collect();
        let model = Rests::new(2, &ends);
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut positions = pairs(0.26, TESTED, 2);
        positions.extend(pairs(0.0, 20_000, 3));
        let fit = test_at(point(), &site(positions, 1000), &[&model], &mut random).expect("a test");
        assert_eq!((fit.measured, fit.tested), ([20_800, 1000], 800));
        assert!(fit.p_neighbours.expect("two balls") < 0.005, "{fit:?}");
    }
}
