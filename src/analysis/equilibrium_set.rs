//! How much of all ball positions the equilibrium set covers (thesis section 5.2).

use crate::model::{Balancer, Machine};

/// Points per axis for two balls.
const GRID: usize = 128;
/// Points for one ball, and for more than two.
const POINTS: u32 = 16_384;

/// The share of all ball positions that are equilibria, from the closed form: on a grid of 16384
/// points for one ball, of 128 × 128 for two, at 16384 Sobol' points for more. Good to about
/// 0.01. `None` for a machine without a number of balls that the model knows.
pub fn set_fraction(machine: &Machine) -> Option<f64> {
    match machine.balls.len() {
        1 => share::<1>(machine, (0..POINTS).map(|i| [angle(f64::from(i), f64::from(POINTS))])),
        2 => {
            let at = |i: usize| angle(i as f64, GRID as f64);
            share::<2>(machine, (0..GRID * GRID).map(|i| [at(i / GRID), at(i % GRID)]))
        }
        3 => quasi_random::<3>(machine),
        4 => quasi_random::<4>(machine),
        5 => quasi_random::<5>(machine),
        6 => quasi_random::<6>(machine),
        7 => quasi_random::<7>(machine),
        8 => quasi_random::<8>(machine),
        _ => None,
    }
}

/// The middle of cell `index` of `count` on the circle.
fn angle(index: f64, count: f64) -> f64 {
    (index + 0.5) / count * std::f64::consts::TAU
}

fn quasi_random<const N: usize>(machine: &Machine) -> Option<f64> {
    let point = |i: u32| {
        std::array::from_fn(|axis| {
            f64::from(sobol_burley::sample(i, axis as u32, 0)) * std::f64::consts::TAU
        })
    };
    share::<N>(machine, (0..POINTS).map(point))
}

fn share<const N: usize>(
    machine: &Machine,
    positions: impl Iterator<Item = [f64; N]>,
) -> Option<f64> {
    let balancer = Balancer::<N>::new(machine)?;
    let (mut inside, mut all) = (0_u32, 0_u32);
    for beta in positions {
        inside += u32::from(balancer.friction_use(&balancer.rest_point(&beta), 0.0) <= 1.0);
        all += 1;
    }
    Some(f64::from(inside) / f64::from(all))
}

#[cfg(test)]
mod tests {
    use super::set_fraction;
    use crate::model::Machine;

    fn with_friction(friction_coefficient: f64, balls: usize) -> Machine {
        let mut machine = Machine::default();
        machine.balls.resize(balls, machine.balls[0]);
        for ball in &mut machine.balls {
            ball.friction_coefficient = friction_coefficient;
        }
        machine
    }

    /// Thesis section 5.2.1: at -216 rad/s everything is an equilibrium with 3.5e-3.
    #[test]
    fn grows_with_friction_to_the_whole() {
        let shares = [2.75e-4, 2.75e-3, 3.5e-3].map(|mu| set_fraction(&with_friction(mu, 2)));
        assert_eq!(shares[2], Some(1.0));
        assert!(shares[0] > Some(0.0) && shares[0] < Some(0.1), "{shares:?}");
        assert!(shares[1] > Some(0.5) && shares[1] < Some(1.0), "{shares:?}");
    }

    /// One ball: the edge of the set in closed form, from the sign changes of the condition on a
    /// fine scan of the circle.
    #[test]
    fn one_ball_against_a_fine_scan() {
        let machine = with_friction(1e-3, 1);
        let balancer = crate::model::Balancer::<1>::new(&machine).unwrap();
        let inside = (0..1_000_000)
            .filter(|&i| {
                let beta = f64::from(i) * std::f64::consts::TAU / 1e6;
                balancer.required_friction(&[beta]) <= 1e-3
            })
            .count();
        let share = set_fraction(&machine).unwrap();
        assert!((share - inside as f64 / 1e6).abs() < 4.0 / 16_384.0, "{share} {inside}");
    }

    /// More balls: a third ball without mass and with more friction than ever needed changes
    /// nothing in what the first two do, so that the share by Sobol' points is that of the grid.
    #[test]
    fn quasi_random_agrees_with_the_grid() {
        let mut three = with_friction(2.0e-3, 3);
        three.balls[2].mass_kg = 1e-15;
        three.balls[2].friction_coefficient = 1.0;
        let grid = set_fraction(&with_friction(2.0e-3, 2)).unwrap();
        assert!((set_fraction(&three).unwrap() - grid).abs() < 0.01);
    }
}
