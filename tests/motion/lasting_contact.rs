//! A bouncing mass that comes to rest on the ground, against the closed form; displacements through impacts and lasting
//! contact, against differences.

use std::any::Any;
use std::sync::Arc;

use stickslip::model::{
    BallContact, Block, Components, ContactEquations, ContactLayout, ContactMode, Expression,
    Friction, FrictionLaw, Gap, GapEquations, Layout, Machine, Method, Model, Number, Recorder,
    Start, System, SystemEquations, Touching,
};
use stickslip::motion::{Motion, Phase, Settings, Tolerance};

/// A mass above the ground, which is a body that does not move: heights, then speeds.
#[derive(Debug)]
struct FallingMass {
    gravity: f64,
    restitution: f64,
    gaps: [Gap; 1],
    friction: Friction,
}

impl FallingMass {
    fn new(gravity: f64, restitution: f64) -> Self {
        let gap = Gap {
            contacts: [0, 1],
            distance: 0.0,
            angular: false,
            masses: [1e30, 1.0],
            tangent: 0.0,
            lever: 0.0,
            friction_coefficient: 0.0,
        };
        let smooth = Block { friction: FrictionLaw::viscous(0.0), ..Block::on_spring() };
        let friction = smooth.slider().friction;
        FallingMass { gravity, restitution, gaps: [gap], friction }
    }
}

impl System for FallingMass {
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r> {
        let [ground, height, still, speed] = [(); 4].map(|()| recorder.state());
        let _ = (ground, height);
        let [gravity, closed] = ["gravity", "closed"].map(|name| recorder.input(name));
        let zero = Expression::constant(0.0);
        let one = Expression::constant(1.0);
        let force = recorder.accelerations(&[vec![one]], &[closed * gravity])[0];
        let contact = |sliding_speed, sliding_acceleration| ContactEquations {
            sliding_speed,
            sliding_acceleration,
            normal: one,
            friction: zero,
        };
        let place = |position| ContactLayout { position, angular: false };
        SystemEquations {
            derivative: vec![still, speed, zero, force - gravity],
            contacts: vec![contact(still, zero), contact(speed, force - gravity)],
            gaps: vec![GapEquations { opening_acceleration: force - gravity, force }],
            layout: Layout {
                contacts: vec![place(0), place(1)],
                velocities: vec![vec![2], vec![3]],
                vibration: None,
                forcing: None,
            },
            events: vec![],
        }
    }

    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64> {
        vec![self.gravity, if modes[2] == ContactMode::Closed { 1.0 } else { 0.0 }]
    }

    fn contacts(&self) -> usize {
        2
    }

    fn friction(&self, _contact: usize) -> &Friction {
        &self.friction
    }

    fn longest_step(&self) -> f64 {
        1.0
    }

    fn pace(&self) -> f64 {
        1.0
    }

    fn surely_one_solution(&self) -> bool {
        true
    }

    fn one_solution_at(&self, _state: &[f64]) -> bool {
        true
    }

    fn force_scale(&self) -> f64 {
        1.0
    }

    fn touching(&self) -> Option<&dyn Touching> {
        Some(self)
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}

impl Touching for FallingMass {
    fn gaps(&self) -> &[Gap] {
        &self.gaps
    }

    fn restitution(&self) -> f64 {
        self.restitution
    }

    fn lasting_approach(&self) -> f64 {
        1e-6
    }
}

/// Falls from `height`: impact `k` has the speed `v e^k` with `v = sqrt(2 g h)`, and follows the one before after
/// `2 v e^k / g`. Contact lasts from the first impact below the threshold on; infinitely many more impacts would take
/// `2 v e^(k+1) / (g (1 - e))`.
#[test]
fn a_bouncing_mass_comes_to_rest_at_the_time_of_the_closed_form() {
    let (gravity, restitution, height) = (9.81, 0.7, 0.4_f64);
    let system: Arc<dyn System> = Arc::new(FallingMass::new(gravity, restitution));
    let tolerance = Tolerance { relative: 1e-13, absolute: 1e-14 };
    let settings = Settings { method: Method::Event, band: 0.0, tolerance, effort_limit: 10_000 };
    let mut motion = Motion::new(&system, settings, &[0.0, height, 0.0, 0.0]).expect("starts");
    let mut speed = (2.0 * gravity * height).sqrt();
    let mut expected = speed / gravity;
    let all = expected * (1.0 + restitution) / (1.0 - restitution);
    while speed >= 1e-6 {
        while !motion.advance(10.0).expect("continues") {}
        // Heights are rounded to 1e-16, and the last impacts have speeds of 1e-6.
        assert!((motion.time() - expected).abs() < 1e-10, "{}", motion.time() - expected);
        speed *= restitution;
        assert!((motion.state()[3] / speed - 1.0).abs() < 1e-5, "{} {speed}", motion.state()[3]);
        expected += 2.0 * speed / gravity;
    }
    while motion.phases()[2] == Phase::Open {
        motion.advance(10.0).expect("continues");
    }
    assert!((motion.time() - expected).abs() < 1e-10);
    let left = 2.0 * speed * restitution / (gravity * (1.0 - restitution));
    assert!((all - motion.time() - left).abs() < 1e-10, "{:e}", all - motion.time());
    while motion.time() < 10.0 {
        motion.advance(10.0).expect("continues");
    }
    let rest = motion.state();
    assert!(rest.iter().all(|value| value.abs() < 1e-12), "{rest:?}");
    assert_eq!(motion.phases()[2], Phase::Closed);
}

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
