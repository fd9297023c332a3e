//! Closed forms for balls that touch, against the simulated system and against searches.

use std::f64::consts::TAU;
use std::sync::Arc;

use stickslip::analysis::{
    Balance, EquilibriumSet, FrictionlessKind as Kind, Resolution, RestForm, Stability,
    frictionless_equilibria, set_fraction, state_matrix, touching_set_fraction,
};
use stickslip::model::{Balancer, Ball, BallContact, BallsInContact, Machine, System};
use stickslip::motion::{Direction, Evaluator, Phase};

use crate::support::angular_distance;

const SLIDING: BallContact = BallContact { restitution: 0.5, friction_coefficient: 0.0 };

/// A machine whose balls have these masses over that of the thesis's, and sizes to match.
fn machine(speed_rad_s: f64, masses: &[f64]) -> Machine {
    let ball = |mass: &f64| Ball {
        mass_kg: 1.4e-4 * mass,
        diameter_m: 3e-3 * mass.cbrt(),
        ..Ball::default()
    };
    let balls = masses.iter().map(ball).collect();
    Machine { speed_rad_s, balls, contact: Some(SLIDING), ..Machine::default() }
}

/// Returns the force along the ring on each ball, times its mass.
fn pushes<const N: usize>(machine: &Machine, beta: &[f64; N]) -> [f64; N] {
    let balancer = Balancer::<N>::new(machine).unwrap();
    let rest = balancer.rest_point(beta);
    std::array::from_fn(|ball| balancer.balls[ball].mass * rest.friction[ball])
}

/// Two balls that touch are in equilibrium where the forces on them are opposite and press: on the way round the ring, in
/// both orders, a search finds exactly the closed forms.
#[test]
fn a_search_finds_the_equilibria_of_two_balls_that_touch() {
    let mut touching = 0;
    for speed in [-150.0, -173.1803, -181.0, -216.3772, 300.0] {
        for masses in [[1.0, 1.0], [1.0, 0.3], [0.5, 2.0]] {
            let machine = machine(speed, &masses);
            let angle = machine.contact_angle_rad(&machine.balls[0], &machine.balls[1]);
            let known = frictionless_equilibria(&machine, 1e4).expect("three balls");
            let known =
                known.iter().map(|equilibrium| equilibrium.beta_rad.clone().expect("angles"));
            let mut known: Vec<_> = known
                .filter(|beta| (angular_distance(beta[0], beta[1]) - angle).abs() < 1e-9)
                .collect();
            // Of two identical balls, both orders are the same position.
            let orders = if masses[0] == masses[1] { 1 } else { 2 };
            for ahead in [1.0, -1.0].into_iter().take(orders) {
                let at = |first: f64| [first, first + ahead * angle];
                let sum = |first: f64| pushes(&machine, &at(first)).iter().sum::<f64>();
                let steps = 5000;
                for step in 0..steps {
                    let place = |step: i32| (f64::from(step) + 0.31) / f64::from(steps) * TAU;
                    let (mut low, mut high) = (place(step), place(step + 1));
                    if sum(low) * sum(high) > 0.0 {
                        continue;
                    }
                    while high - low > 1e-13 {
                        let middle = low.midpoint(high);
                        if sum(low) * sum(middle) > 0.0 { low = middle } else { high = middle }
                    }
                    // The force between the balls pushes the first one back.
                    if ahead * pushes(&machine, &at(low))[0] <= 0.0 {
                        continue;
                    }
                    let found = known.iter().position(|beta| {
                        let both = [at(low), [at(low)[1], at(low)[0]]];
                        both.iter().take(3 - orders).any(|there| {
                            (0..2).all(|ball| angular_distance(beta[ball], there[ball]) < 1e-9)
                        })
                    });
                    let Some(found) = found else { panic!("{:?} of {machine:?}", at(low)) };
                    known.swap_remove(found);
                    touching += 1;
                }
            }
            assert_eq!(known, Vec::<Vec<f64>>::new(), "{machine:?}");
        }
    }
    assert!(touching >= 15, "{touching}");
}

/// No friction is needed in the closed forms, which the linear programme of the simulation confirms, and no balls overlap. In rows,
/// eigenvalues belong to the equations of motion of the simulated system, in which the balls of a row stay together.
#[test]
fn equilibria_of_rows_need_no_friction_and_move_as_linearised() {
    let (mut stable, mut unstable) = (0, 0);
    for speed in [-150.0, -173.1803, -216.3772] {
        for masses in [[1.0, 1.0, 1.0], [1.0, 0.5, 1.0], [0.4, 1.0, 1.7]] {
            let machine = machine(speed, &masses);
            let form = RestForm::new(&machine).expect("a sound machine");
            for equilibrium in frictionless_equilibria(&machine, 1e4).expect("three balls") {
                let beta: [f64; 3] =
                    equilibrium.beta_rad.clone().expect("angles").try_into().expect("three balls");
                let system = BallsInContact::<3>::new(&machine, &SLIDING, &beta).unwrap();
                for (ball, other) in [(0, 1), (1, 2), (0, 2)] {
                    let angle =
                        machine.contact_angle_rad(&machine.balls[ball], &machine.balls[other]);
                    let apart = angular_distance(beta[ball], beta[other]);
                    assert!(apart > angle - 1e-9, "{apart} {equilibrium:?}");
                }
                // Forces and friction that are zero only to rounding.
                assert!(system.rest_margin(&beta) > 1.0 - 1e-9, "{equilibrium:?}");
                if system.closed_gaps(&beta).len() != 2 {
                    continue;
                }
                *(if equilibrium.stability == Stability::Stable {
                    &mut stable
                } else {
                    &mut unstable
                }) += 1;
                let mut phases = vec![Phase::Slip(Direction::Forward); 3];
                let gaps = system.touching().expect("contact").gaps();
                phases.extend(gaps.iter().map(|gap| {
                    let width = gap.width(gap.contacts.map(|ball| beta[ball]));
                    if width < 1e-9 { Phase::Closed } else { Phase::Open }
                }));
                // Slip without friction: (x, y), velocities, angles, speeds of the simulation, from (x, y, φ) and its rate.
                let mut frictionless = machine.clone();
                frictionless.balls.iter_mut().for_each(|ball| ball.friction_coefficient = 0.0);
                let smooth = BallsInContact::<3>::new(&frictionless, &SLIDING, &beta).unwrap();
                let evaluator = Evaluator::new(Arc::new(smooth) as Arc<dyn System>);
                let z = form.ring_centre(&beta);
                let state = |q: &[f64; 6]| {
                    let mut state = vec![z.re + q[0], z.im + q[1], q[3], q[4]];
                    state.extend(beta.map(|beta| beta + q[2]));
                    state.extend([q[5]; 3]);
                    state
                };
                let rates = |q: &[f64; 6]| {
                    let rates = evaluator.rates(&phases, &state(q));
                    // All balls of the row have the same rates.
                    for ball in 1..3 {
                        assert!((rates[4 + ball] - rates[4]).abs() < 1e-14);
                        assert!((rates[7 + ball] - rates[7]).abs() < 1e-12);
                    }
                    [rates[0], rates[1], rates[4], rates[2], rates[3], rates[7]]
                };
                let matrix = state_matrix(&form, &beta, 0.0).unwrap();
                assert_eq!(matrix.nrows(), 6);
                for column in 0..6 {
                    let moved = |by: f64| {
                        let mut q = [0.0; 6];
                        q[column] = by;
                        rates(&q)
                    };
                    let (more, less) = (moved(1e-6), moved(-1e-6));
                    for row in 0..6 {
                        let slope = (more[row] - less[row]) / 2e-6;
                        let expected = matrix[(row, column)];
                        assert!(
                            (slope - expected).abs() < 1e-6,
                            "{slope} {expected} {equilibrium:?}"
                        );
                    }
                }
            }
        }
    }
    assert!(stable > 0 && unstable > 0 && stable + unstable > 10, "{stable} {unstable}");
}

/// Below the natural frequency the row on the heavy side is stable, and above it only balance (as without contact, thesis
/// figure 5.1).
#[test]
fn the_row_is_stable_below_the_natural_frequency() {
    for (speed, expected) in [(-160.8103, Kind::A1Plus), (-216.3772, Kind::B1)] {
        for balls in [2, 3, 5] {
            let machine = machine(speed, &vec![1.0; balls]);
            let found = frictionless_equilibria(&machine, 1e4).expect("three balls");
            let stable: Vec<Kind> = found
                .iter()
                .filter(|equilibrium| equilibrium.stability == Stability::Stable)
                .map(|equilibrium| equilibrium.kind)
                .collect();
            assert_eq!(stable, [expected], "{balls} balls at {speed}: {found:?}");
        }
    }
}

/// Of three or more balls that must be apart, a balanced position is found where there is room, and none where there is
/// none.
#[test]
fn balls_balance_apart() {
    for balls in 3..=8 {
        let machine = machine(-216.3772, &vec![1.0; balls]);
        let form = RestForm::new(&machine).expect("a sound machine");
        let Balance::Family { example, dimension } = Balance::of(&form) else {
            panic!("{balls} balls do not balance")
        };
        assert_eq!(dimension, balls - 2);
        assert!(form.imbalance_at(&example).norm() < 1e-12 * form.imbalance.norm());
        let angle = machine.contact_angle_rad(&machine.balls[0], &machine.balls[1]);
        for (ball, beta) in example.iter().enumerate() {
            let apart = example[..ball].iter().map(|other| angular_distance(*other, *beta));
            assert!(apart.fold(f64::INFINITY, f64::min) > angle - 1e-9, "{example:?}");
        }
    }
    // Balls that nearly fill the ring have their centre of mass near its centre.
    let mut full = machine(-216.3772, &[1.0; 8]);
    full.balls.iter_mut().for_each(|ball| ball.diameter_m = 8.7e-3);
    assert_eq!(Balance::of(&RestForm::new(&full).unwrap()), Balance::Nowhere);
}

/// The set on the grid and the quick estimates agree, and the force between balls adds equilibria: model.md has 0.3844 of the
/// touching positions at -173.1803 rad/s, and 0.2200 without the force.
#[test]
fn fractions_agree() {
    for speed in [-160.8103, -173.1803, -216.3772] {
        let machine = machine(speed, &[1.0, 1.0]);
        let set = EquilibriumSet::of(&machine, Resolution::Grid(512)).unwrap();
        let quick = set_fraction(&machine).unwrap();
        assert!((set.fraction - quick).abs() < 2e-3, "{} {quick}", set.fraction);
        assert_eq!(set.touching_fraction, touching_set_fraction(&machine));
        if speed == -173.1803 {
            let touching = set.touching_fraction.unwrap();
            assert!((touching - 0.3844).abs() < 1e-3, "{touching}");
        }
    }
    let three = machine(-173.1803, &[1.0; 3]);
    let set = EquilibriumSet::of(&three, Resolution::Samples(4096)).unwrap();
    let (low, high) = set.fraction_interval.unwrap();
    assert!(low <= set.fraction && set.fraction <= high);
    let quick = set_fraction(&three).unwrap();
    assert!((set.fraction - quick).abs() < 0.01, "{} {quick}", set.fraction);
    assert!(set.touching_fraction.unwrap() > set.fraction);
}

/// Parts of the set of two balls: what the force between the balls connects, or adds, on the edge counts.
#[test]
fn components_include_touching_positions() {
    for speed in [-160.8103, -173.1803, -179.2671, -216.3772] {
        let machine = machine(speed, &[1.0, 1.0]);
        let numbers: Vec<_> = [256, 512, 1024]
            .map(|points| {
                let set = EquilibriumSet::of(&machine, Resolution::Grid(points)).unwrap();
                assert_eq!(set.unseen, Some(0), "{speed} {points}");
                (set.components, set.components_modulo_exchange)
            })
            .to_vec();
        assert!(numbers.iter().all(|parts| *parts == numbers[0]), "{speed}: {numbers:?}");
    }
}
