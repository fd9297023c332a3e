//! Displacements through impacts and lasting contact of balls, against differences.

use stickslip::model::{BallContact, Components, Machine, Method, Model, Start};
use stickslip::motion::{Motion, Phase, Settings, Tolerance};

/// Displacements of a motion with impacts, and of one that ends in lasting contact, against central differences.
#[test]
fn displacements_pass_through_impacts_and_lasting_contact() {
    let size = 1e-6;
    for (restitution, end, closes) in [(0.9, 12.0, false), (0.0, 6.0, true)] {
        let contact = Some(BallContact { restitution, friction_coefficient: 0.1 });
        let machine = Machine { contact, ..Machine::default() };
        let model = Model::from(machine);
        let beta = [1.0, 1.45];
        let start = Start::of_balancer([0.01, 0.02], &beta, [0.0; 2], &[0.35, 0.25]);
        let system = model.system_for(&start).expect("a system");
        let state = model.start_state(&start).expect("a state");
        let tolerance = Tolerance { relative: 1e-12, absolute: 1e-14 };
        let settings =
            Settings { method: Method::Event, band: 0.0, tolerance, effort_limit: 100_000 };
        let follow = |state: &Components, directions: &[Components]| {
            let mut motion =
                Motion::with_directions(&system, settings, state, directions).expect("starts");
            let mut events = 0;
            while motion.time() < end {
                events += i32::from(motion.advance(end).expect("continues"));
            }
            (motion, events)
        };
        let unit = |place: usize| -> Components {
            (0..8).map(|other| if other == place { 1.0 } else { 0.0 }).collect()
        };
        let directions: Vec<Components> = (0..8).map(unit).collect();
        let (motion, events) = follow(&state, &directions);
        assert!(events > 0 && !motion.grazed());
        assert_eq!(motion.phases()[2..].contains(&Phase::Closed), closes);
        for (direction, displaced) in directions.iter().zip(motion.displacements()) {
            let ends = [size, -size].map(|size| {
                let moved: Components =
                    state.iter().zip(direction).map(|(value, by)| value + size * by).collect();
                let (motion, same) = follow(&moved, &[]);
                assert_eq!(same, events);
                motion.state()
            });
            for place in 0..8 {
                let slope = (ends[0][place] - ends[1][place]) / (2.0 * size);
                let found = displaced[place];
                assert!((slope - found).abs() < 1e-4 * (1.0 + slope.abs()), "{found} {slope}");
            }
        }
    }
}
