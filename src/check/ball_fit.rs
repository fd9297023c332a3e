//! Whether balls have room in the ring: angles that balls occupy, their density, and how often positions of rest
//! overlap without contact between balls.

use crate::analysis::{REPLICATES, RestForm, sample};
use crate::model::{Ball, Machine, wrap_to_pi};

/// Returns the angle that all balls occupy side by side, rad. Balls have room in the ring if it is at most 2π.
///
/// Each ball occupies the angle at which it would touch a ball of its own size. The sum is exact for balls of one
/// size, and an upper bound for others.
pub fn occupied_angle(machine: &Machine) -> f64 {
    let angle = |ball: &Ball| machine.contact_angle_rad(ball, ball);
    machine.balls.iter().map(angle).sum()
}

/// Returns the density of a ball as a homogeneous sphere, kg/m³.
pub fn density_kg_m3(ball: &Ball) -> f64 {
    ball.mass_kg / ball.volume_m3()
}

/// Samples per scramble, which makes 4096 positions.
const SAMPLES: u32 = 256;
/// The fewest positions of rest from which a fraction is estimated.
const FEWEST: u32 = 100;

/// Quasi-random positions of balls, for many machines: for each number of balls one list.
pub struct BallPositions(Vec<Vec<Vec<f64>>>);

impl BallPositions {
    /// Returns 4096 positions of each of these numbers of balls.
    pub fn new(balls: impl IntoIterator<Item = usize>) -> Self {
        let all =
            (0..REPLICATES).flat_map(|scramble| (0..SAMPLES).map(move |index| (scramble, index)));
        let of =
            |balls| all.clone().map(|(scramble, index)| sample(balls, scramble, index)).collect();
        BallPositions(balls.into_iter().map(of).collect())
    }

    /// Returns the positions of a machine's number of balls, if they are known.
    fn of(&self, machine: &Machine) -> Option<&[Vec<f64>]> {
        let is_of = |list: &&Vec<Vec<f64>>| {
            list.first().is_some_and(|first| first.len() == machine.balls.len())
        };
        self.0.iter().find(is_of).map(Vec::as_slice)
    }

    /// Returns the fraction of the positions of rest in which at least two balls overlap. `None` for one ball, for balls
    /// with contact, for another number of balls than those of the positions, or if fewer than 100 positions are positions of rest.
    pub fn overlapping_fraction(&self, machine: &Machine) -> Option<f64> {
        let form = RestForm::new(machine)?;
        let balls = &machine.balls;
        let positions = self.of(machine)?;
        if machine.contact.is_some() || balls.len() < 2 {
            return None;
        }
        let pairs: Vec<(usize, usize, f64)> = (0..balls.len())
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| (i, j, machine.contact_angle_rad(&balls[i], &balls[j])))
            .collect();
        let (mut rests, mut overlapping) = (0, 0);
        for beta in positions.iter().filter(|beta| form.at_rest(beta).in_set()) {
            let overlap = |&(i, j, touching): &(usize, usize, f64)| {
                wrap_to_pi(beta[i] - beta[j]).abs() < touching
            };
            rests += 1;
            overlapping += u32::from(pairs.iter().any(overlap));
        }
        (rests >= FEWEST).then(|| f64::from(overlapping) / f64::from(rests))
    }
}
