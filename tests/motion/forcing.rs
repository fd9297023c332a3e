//! A forcing that is a sine of the time, against the closed form of a block that it shakes.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use stickslip::model::{
    ContactEquations, ContactLayout, Expression, ForcingLayout, Friction, Number, Recorder,
    StateLayout, System, SystemEquations,
};
use stickslip::motion::{Direction, Motion, Phase};

use super::samples::EXACT;
use crate::support::{OwnSystem, shared};

const FRICTION: f64 = 0.5;

/// A block of mass 1 on the ground with Coulomb friction, which a harmonic force pulls. State: phase of the force,
/// position, speed.
fn shaken_block(recorder: &Recorder) -> SystemEquations<'_> {
    let [phase, _, speed] = [(); 3].map(|()| recorder.state());
    let [force, frequency] = ["force", "frequency"].map(|name| recorder.parameter(name));
    let (sine, _) = phase.sin_cos();
    let pull = force * sine;
    let [slips, direction] = ["slips", "direction"].map(|name| recorder.input(name));
    let friction = direction * Expression::constant(FRICTION);
    let acceleration = slips * (pull - friction);
    SystemEquations {
        derivative: vec![frequency, speed, acceleration],
        contacts: vec![ContactEquations {
            sliding_speed: speed,
            sliding_acceleration: acceleration,
            normal: Expression::constant(1.0),
            friction: slips * friction + (Expression::constant(1.0) - slips) * pull,
        }],
        layout: StateLayout {
            contacts: vec![ContactLayout { position: 1, angular: false }],
            velocities: vec![vec![2]],
            forcing: Some(ForcingLayout { component: 0, period: TAU }),
            ..StateLayout::default()
        },
        ..SystemEquations::default()
    }
}

/// The block breaks loose where the force `A sin(Ω t)` reaches the limit of friction. It slides with
/// `v = (A (cos φ₁ - cos φ) - μ (φ - φ₁)) / Ω` until it stops, and breaks loose again half a period after the first time.
#[test]
fn a_shaken_block_slides_as_in_closed_form() {
    let (force, frequency) = (0.8, 2.0);
    let system: Arc<dyn System> = shared(OwnSystem::new(
        shaken_block,
        vec![force, frequency],
        vec![Friction::coulomb(FRICTION)],
    ));
    let loose = (FRICTION / force).asin();
    let speed =
        |phase: f64| (force * (loose.cos() - phase.cos()) - FRICTION * (phase - loose)) / frequency;
    let (mut from, mut to) = (PI, 2.0 * PI);
    for _ in 0..60 {
        let middle = 0.5 * (from + to);
        *(if speed(middle) > 0.0 { &mut from } else { &mut to }) = middle;
    }
    let slid = from - loose;
    let moved =
        force * (slid * loose.cos() - from.sin() + loose.sin()) - FRICTION * slid * slid / 2.0;
    let mut motion = Motion::new(&system, EXACT, &[0.0, 0.0, 0.0]).expect("starts");
    for (phase, position, is_next) in [
        (loose, 0.0, Phase::Slip(Direction::Forward)),
        (from, moved / frequency.powi(2), Phase::Stick),
        (PI + loose, moved / frequency.powi(2), Phase::Slip(Direction::Backward)),
    ] {
        while !motion.advance(10.0).expect("continues") {}
        assert!((motion.time() - phase / frequency).abs() < 1e-11, "{}", motion.time());
        assert_eq!(motion.phases()[0], is_next);
        assert!((motion.state()[0] - phase).abs() < 1e-11);
        assert!((motion.state()[1] - position).abs() < 1e-11, "{} {position}", motion.state()[1]);
    }
}
