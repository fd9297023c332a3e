//! A sliding speed that is the unknown of a linear system: the components of the state are momenta.

use stickslip::model::{
    ContactEquations, ContactLayout, Expression, Friction, Number, Recorder, StateLayout,
    SystemEquations,
};
use stickslip::motion::{Direction, Motion, Phase, Settings, Tolerance};

use crate::support::{METHODS, OwnSystem, shared};

/// A block on the ground. State: position, momentum.
fn block(recorder: &Recorder) -> SystemEquations<'_> {
    let [_, momentum] = [(); 2].map(|()| recorder.state());
    let [mass, limit, slips, direction] =
        ["mass", "limit", "slips", "direction"].map(|name| recorder.input(name));
    let friction = slips * direction * limit;
    let speed = recorder.solve(&[vec![mass]], &[momentum])[0];
    SystemEquations {
        derivative: vec![speed, -friction],
        contacts: vec![ContactEquations {
            sliding_speed: speed,
            sliding_acceleration: -friction / mass,
            normal: Expression::constant(1.0),
            friction,
        }],
        layout: StateLayout {
            contacts: vec![ContactLayout { position: 0, angular: false }],
            ..StateLayout::default()
        },
        ..SystemEquations::default()
    }
}

/// A block of mass 4 with the momentum 1 is stopped by the force 0.5 after the time 2.
#[test]
fn a_block_with_momentum_slides_until_it_stops() {
    let system = shared(OwnSystem::new(block, vec![4.0, 0.5], vec![Friction::coulomb(0.5)]));
    let tolerance = Tolerance { relative: 1e-12, absolute: 1e-14 };
    for method in METHODS {
        let settings = Settings { method, band: 1e-8, tolerance, effort_limit: 1000 };
        let mut motion = Motion::new(&system, settings, &[0.0, 1.0]).expect("starts");
        assert_eq!(motion.phases(), [Phase::Slip(Direction::Forward)], "{method:?}");
        while motion.phases() != [Phase::Stick] && motion.time() < 3.0 {
            motion.advance(3.0).expect("continues");
        }
        assert!((motion.time() - 2.0).abs() < 1e-6, "{method:?}: {}", motion.time());
        assert!((motion.state()[0] - 0.25).abs() < 1e-6, "{method:?}: {:?}", motion.state());
    }
}
