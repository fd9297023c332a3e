//! Closed forms of a machine, against numbers of the thesis and against positions one by one.

use std::f64::consts::TAU;

use stickslip::analysis::{RestForm, Stability};
use stickslip::check::{BalancerFacts, BallPositions};
use stickslip::model::{Ball, BallContact, FrictionLaw, Machine, wrap_to_pi};

fn facts(machine: &Machine) -> BalancerFacts {
    BalancerFacts::of(machine, &BallPositions::new([machine.balls.len()])).unwrap()
}

#[test]
fn the_thesis_machine() {
    let facts = facts(&Machine::default());
    assert!((facts.natural_frequency_rad_s - 181.6).abs() < 0.05);
    assert!((facts.speed_ratio - 216.3772 / 181.63).abs() < 1e-4);
    assert!((facts.capacity_kg_m - 3.22e-6).abs() < 1e-15);
    assert!((facts.imbalance_kg_m - 2.072e-6).abs() < 1e-15);
    assert!((facts.capacity_ratio - 1.554).abs() < 1e-3);
    assert_eq!(facts.balance_stability, Some(Stability::Stable));
    let without = facts.amplitude_without_balls_m.unwrap();
    assert!((without - 21.65e-6).abs() < 0.01e-6, "{without}");
    // 77 % of all positions (docs/equilibria.md).
    assert!((facts.rest.unwrap().set_fraction - 0.77).abs() < 0.01);
}

#[test]
fn balls_do_not_balance_below_the_natural_frequency() {
    let below = facts(&Machine { speed_rad_s: -160.8103, ..Machine::default() });
    assert_eq!(below.balance_stability, Some(Stability::Unstable));
    let light = Ball { mass_kg: 1e-5, ..Ball::default() };
    let light = facts(&Machine { balls: vec![light; 3], ..Machine::default() });
    assert!(light.capacity_ratio < 1.0);
    assert_eq!((light.balance.name(), light.balance_stability), ("nowhere", None));
    let still = facts(&Machine { speed_rad_s: 0.0, ..Machine::default() });
    assert_eq!(still.balance_stability, Some(Stability::Marginal));
}

/// Two balls with contact rest apart or side by side. With little friction, the worst position of the machine without
/// contact is one of balls that overlap; near the natural frequency, the force between the balls holds them in a worse one.
#[test]
fn the_worst_rest_with_contact_is_the_worst_of_many_positions() {
    let worst = |machine: &Machine| facts(machine).rest.unwrap().max_amplitude_m.unwrap();
    for (speed_rad_s, friction_coefficient, micrometres) in
        [(-216.3772, 2.75e-4, [55.1, 21.8]), (-179.2671, 2.75e-3, [330.2, 338.0])]
    {
        let ball = Ball { friction_coefficient, ..Ball::default() };
        let ghosts = Machine { speed_rad_s, balls: vec![ball; 2], ..Machine::default() };
        let contact = Some(BallContact { restitution: 0.36, friction_coefficient: 0.1 });
        let machine = Machine { contact, ..ghosts.clone() };
        let form = RestForm::new(&machine).unwrap();
        let touching = machine.contact_angle_rad(&ball, &ball);
        let angles =
            |count: u32| (0..count).map(move |place| f64::from(place) / f64::from(count) * TAU);
        let side_by_side = angles(40_000).map(|angle| vec![angle, angle + touching]);
        let side_by_side = side_by_side.filter(|beta| form.holds_with_forces(beta));
        let apart = angles(500).flat_map(|first| angles(500).map(move |second| [first, second]));
        let apart = apart.filter(|[first, second]| wrap_to_pi(first - second).abs() > touching);
        let apart = apart.map(Vec::from).filter(|beta| form.at_rest(beta).in_set());
        let amplitude = |beta: Vec<f64>| form.amplitude_m(&beta);
        let [touching, apart] = [
            side_by_side.map(amplitude).fold(0.0, f64::max),
            apart.map(amplitude).fold(0.0, f64::max),
        ];
        let found = [worst(&ghosts), worst(&machine)];
        // Where the balls are apart, both are grids.
        assert!(touching <= found[1] * (1.0 + 1e-9), "{touching} {found:?}");
        assert!(
            apart <= 1.01 * found[1] && touching.max(apart) > 0.99 * found[1],
            "{apart} {found:?}"
        );
        for (found, expected) in found.map(|metres| 1e6 * metres).iter().zip(micrometres) {
            assert!((found - expected).abs() < 0.06, "{found} {expected}");
        }
    }
}

#[test]
fn friction_that_cannot_hold_a_ball_has_no_positions_of_rest() {
    let friction = FrictionLaw::smooth(0.1);
    assert_eq!(facts(&Machine { friction, ..Machine::default() }).rest, None);
}
