//! Closed forms of a machine, against numbers of the thesis and against positions one by one.

use std::f64::consts::TAU;

use stickslip::analysis::{RestForm, Stability, sample};
use stickslip::check::{BalancerFacts, BallPositions, BlockFacts};
use stickslip::model::{Ball, BallContact, Block, FrictionLaw, Machine, wrap_to_pi};

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
    assert!((facts.capacity_ratio() - 1.554).abs() < 1e-3);
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
    assert!(light.capacity_ratio() < 1.0);
    assert_eq!((light.balance.name(), light.balance_stability), ("nowhere", None));
    let still = facts(&Machine { speed_rad_s: 0.0, ..Machine::default() });
    assert_eq!(still.balance_stability, Some(Stability::Marginal));
}

/// The largest amplitude is at least that of each position of rest, and some position nearly reaches it.
#[test]
fn the_worst_rest_is_the_worst_of_many_positions() {
    for balls in 1..=3_usize {
        let machine = Machine { balls: vec![Ball::default(); balls], ..Machine::default() };
        let form = RestForm::new(&machine).unwrap();
        let rests = (0..16).flat_map(|scramble| (0..1024).map(move |index| (scramble, index)));
        let rests = rests.map(|(scramble, index)| form.at_rest(&sample(balls, scramble, index)));
        let most = rests.filter(|one| one.in_set()).map(|one| one.amplitude_m).fold(0.0, f64::max);
        let worst = facts(&machine).rest.unwrap().max_amplitude_m.unwrap();
        assert!(most <= worst * (1.0 + 1e-12) && most > 0.95 * worst, "{balls}: {most} {worst}");
    }
}

/// Balls with contact rest apart or side by side. With little friction, the worst position of the machine without contact is
/// one of balls that overlap.
#[test]
fn the_worst_rest_with_contact_has_no_overlap() {
    let ball = Ball { friction_coefficient: 2.75e-4, ..Ball::default() };
    let ghosts = Machine { balls: vec![ball; 2], ..Machine::default() };
    let contact = Some(BallContact { restitution: 0.36, friction_coefficient: 0.1 });
    let machine = Machine { contact, ..ghosts.clone() };
    let worst = |machine: &Machine| facts(machine).rest.unwrap().max_amplitude_m.unwrap();
    let form = RestForm::new(&machine).unwrap();
    let touching = machine.contact_angle_rad(&ball, &ball);
    let angles = || (0..2000).map(|place| f64::from(place) / 2000.0 * TAU);
    let side_by_side = angles().map(|angle| vec![angle, angle + touching]);
    let side_by_side = side_by_side.filter(|beta| form.holds_with_forces(beta));
    let apart =
        angles().step_by(4).flat_map(|one| angles().step_by(4).map(move |other| [one, other]));
    let apart = apart.filter(|[one, other]| wrap_to_pi(one - other).abs() > touching);
    let apart = apart.map(Vec::from).filter(|beta| form.at_rest(beta).in_set());
    let amplitudes = side_by_side.chain(apart).map(|beta| form.at_rest(&beta).amplitude_m);
    let most = amplitudes.fold(0.0, f64::max);
    let found = worst(&machine);
    assert!((most / found - 1.0).abs() < 0.05, "{most} {found}");
    assert!((found - 21.8e-6).abs() < 0.1e-6 && worst(&ghosts) > 55e-6, "{found}");
}

#[test]
fn friction_that_cannot_hold_a_ball_has_no_positions_of_rest() {
    let friction = FrictionLaw::smooth(0.1);
    assert_eq!(facts(&Machine { friction, ..Machine::default() }).rest, None);
}

#[test]
fn a_block_is_held_where_the_spring_is_weaker_than_friction() {
    let spring = BlockFacts::of(&Block::on_spring());
    assert_eq!((spring.natural_frequency_rad_s, spring.belt_speed_m_s), (10.0, None));
    assert!((spring.static_reach_m - 0.01).abs() < 1e-15);
    let friction = FrictionLaw::stribeck(0.2, 0.0);
    let belt = BlockFacts::of(&Block { friction, ..Block::on_belt() });
    assert!((belt.static_reach_m - 0.02).abs() < 1e-15);
    assert_eq!(belt.belt_speed_m_s, Some(0.1));
    let viscous = FrictionLaw::viscous(1.0);
    assert_eq!(
        BlockFacts::of(&Block { friction: viscous, ..Block::on_spring() }).static_reach_m,
        0.0
    );
}
