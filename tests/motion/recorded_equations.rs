//! The recorded equations of the systems against their equations written by hand, for every law of friction.

use crate::support::{Block, Ground};
use stickslip::model::{
    Balancer, Ball, Contact, Dual, FRICTION_LAWS, Friction, FrictionLaw, Machine, Number, State,
};
use stickslip::motion::{Direction, Evaluator, Phase};

use crate::support::{TestRng, example_law, reference, shared};

fn between(rng: &mut TestRng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.uniform()
}

fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance * expected.abs().max(1.0), "{found} {expected}");
}

fn state_of<const N: usize>(components: &[f64]) -> State<N> {
    State::of_components(components).expect("as many components")
}

fn contact_along(phase: Phase, friction: &Friction, speed: Dual) -> Contact<Dual> {
    match phase {
        Phase::Stick | Phase::Apart | Phase::Open | Phase::Closed => Contact::STICK.lifted(),
        Phase::Slip(direction) => friction.slip_along(direction.sign(), speed),
        Phase::Transition(direction) => friction.slip_along(direction.sign(), Dual::constant(0.0)),
        Phase::Free => friction.slip_along(0.0, speed),
    }
}

/// Compares rates, and forces along a direction, in a random state.
fn compare_balls<const N: usize>(law: FrictionLaw, rng: &mut TestRng) {
    let machine = Machine {
        balls: vec![Ball::default(); N],
        friction: law,
        speed_rad_s: between(rng, -400.0, 400.0),
        ..Machine::default()
    };
    let balancer = Balancer::<N>::new(&machine).expect("this number of balls");
    let phases: [Phase; N] = std::array::from_fn(|_| match rng.below(4) {
        _ if !law.can_stick() => Phase::Free,
        0 => Phase::Stick,
        1 => Phase::Transition(Direction::Backward),
        direction => {
            Phase::Slip(if direction == 2 { Direction::Forward } else { Direction::Backward })
        }
    });
    let mut components: Vec<f64> = (0..4).map(|_| between(rng, -0.05, 0.05)).collect();
    components.extend((0..N).map(|_| between(rng, 0.0, 6.0)));
    components.extend(phases.map(|phase| match phase {
        Phase::Stick | Phase::Apart | Phase::Open | Phase::Closed => 0.0,
        Phase::Slip(direction) => direction * between(rng, 0.01, 1.0),
        Phase::Transition(_) => between(rng, -1e-3, 1e-3),
        Phase::Free => between(rng, -1.0, 1.0),
    }));
    let evaluator = Evaluator::new(shared(balancer));
    let state = state_of::<N>(&components);
    let expected = reference::derivative(&balancer, &phases, &state).components();
    let found = evaluator.rates(&phases, &components);
    found
        .iter()
        .zip(&expected)
        .for_each(|(found, expected)| assert_close(*found, *expected, 1e-13));

    let direction: Vec<f64> = components.iter().map(|_| between(rng, -1.0, 1.0)).collect();
    let moving = state.along(&state_of(&direction));
    let contacts = std::array::from_fn(|i| {
        contact_along(phases[i], &balancer.balls[i].friction, moving.beta_dot[i])
    });
    let expected = balancer.lifted().forces(&moving, &contacts);
    let found = evaluator.forces_along(&phases, &components, &direction);
    for (ball, found) in found.iter().enumerate() {
        assert_close(found.normal.slope, expected.normal[ball].slope, 1e-12);
        assert_close(found.friction.slope, expected.friction[ball].slope, 1e-12);
        assert_close(found.acceleration.slope, expected.beta_ddot[ball].slope, 1e-12);
    }
}

/// `ẋ = v + belt speed`, `v̇ = -x - friction`.
fn compare_block(law: FrictionLaw, rng: &mut TestRng) {
    let ground = Ground::Belt { speed_m_s: 0.1 };
    let slider = Block { ground, ..Block::without_units(law) }.system();
    let friction = *slider.friction(0);
    let (x, v) = (between(rng, -2.0, 2.0), between(rng, 0.01, 1.0));
    let phase = if law.can_stick() { Phase::Slip(Direction::Forward) } else { Phase::Free };
    let evaluator = Evaluator::new(slider);
    let found = evaluator.rates(&[phase], &[x, v]);
    let contact = friction.slip(1.0, v);
    assert_close(found[0], v + 0.1, 1e-15);
    assert_close(found[1], -x - (contact.signed_friction + contact.drag), 1e-13);
    let along = friction.slip_along(1.0, Dual { value: v, slope: 0.5 });
    let found = evaluator.forces_along(&[phase], &[x, v], &[0.25, 0.5])[0];
    let expected = -0.25 - (along.signed_friction + along.drag).slope;
    assert_close(found.acceleration.slope, expected, 1e-12);
}

#[test]
fn recorded_equations_are_the_written_ones() {
    let mut rng = TestRng::new(22);
    // The examples are for balls and for blocks.
    let examples = FRICTION_LAWS.iter().flat_map(|law| [0, 1].map(|unit| example_law(*law, unit)));
    // Stribeck friction with a slope of 0 at rest.
    for law in examples.chain([FrictionLaw::stribeck(4e-3, 0.0)]) {
        for _ in 0..8 {
            compare_balls::<1>(law, &mut rng);
            compare_balls::<2>(law, &mut rng);
            compare_balls::<3>(law, &mut rng);
            compare_balls::<8>(law, &mut rng);
            compare_block(law, &mut rng);
        }
    }
}
