//! Equilibrium sets: the thesis's figures 5.2 to 5.5 in numbers, and the fast grid against the
//! model's own closed forms.

use std::f64::consts::{PI, TAU};

use stickslip::analysis::{
    Balance, EquilibriumSet, GridRow, Resolution, RestForm, SetGrid, set_fraction,
};
use stickslip::model::{Balancer, Ball, Machine};

fn machine(speed_rad_s: f64, friction_coefficient: f64) -> Machine {
    let ball = Ball { friction_coefficient, ..Ball::default() };
    Machine { speed_rad_s, balls: vec![ball; 2], ..Machine::default() }
}

fn set(machine: &Machine, points: usize) -> EquilibriumSet {
    EquilibriumSet::of(machine, Resolution::Grid(points)).unwrap()
}

/// Thesis section 5.2.1, figure 5.4 (four subsets "with the symmetry properties" at the lowest
/// friction, everything at the highest), and figure 5.5 at -191.6372 rad/s.
#[test]
fn shares_and_parts_of_the_thesis() {
    for (speed, friction, share, torus, exchanged) in [
        (-216.3772, 2.75e-4, 0.0174, 6, 4),
        (-216.3772, 2.75e-3, 0.770, 1, 1),
        (-216.3772, 3.5e-3, 1.000, 1, 1),
        (-191.6372, 2.75e-3, 0.214, 2, 2),
    ] {
        for points in [128, 512, 2048] {
            let set = set(&machine(speed, friction), points);
            assert!((set.share - share).abs() < 1e-3, "{} {share}", set.share);
            assert_eq!(set.parts, Some(torus), "{points}");
            assert_eq!(set.parts_modulo_exchange, Some(exchanged), "{points}");
        }
    }
}

#[test]
fn time_it() {
    for points in [256, 512, 2048, 2048, 2048] {
        let start = std::time::Instant::now();
        let s = set(&machine(-216.3772, 2.75e-3), points);
        println!("{points} {:?} {}", start.elapsed(), s.share);
        let start = std::time::Instant::now();
        let f = set_fraction(&machine(-216.3772, 2.75e-3));
        println!("fraction {:?} {f:?}", start.elapsed());
    }
}
