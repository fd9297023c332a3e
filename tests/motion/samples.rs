//! Random machines and states, and motions from them, for several tests.

use std::f64::consts::TAU;
use std::sync::Arc;

use stickslip::model::{
    Balancer, Components, Machine, Method, NormalForce, RestPoint, State, System,
};
use stickslip::motion::{Motion, Settings, Tolerance};

use crate::support::{self, go_on, started};

/// Pseudo-random numbers (xorshift), the same in every run.
pub struct Sampler(u64);

impl Sampler {
    pub fn new(seed: u64) -> Self {
        let mut sampler = Sampler((2 * seed + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        (0..10).for_each(|_| _ = sampler.between(0.0, 1.0));
        sampler
    }

    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        for shift in [13_i32, -7, 17] {
            self.0 ^= if shift > 0 { self.0 << shift } else { self.0 >> -shift };
        }
        from + (to - from) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    pub fn one_of<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.between(0.0, values.len() as f64) as usize]
    }

    /// Returns a machine of varied kind: speeds below and above resonance, without speed, damping
    /// or friction, heavy balls, different balls, a ring with runout.
    pub fn machine(&mut self, balls: usize) -> Machine {
        let speeds = [-160.8, -179.2671, -185.55, -191.64, -216.3772, -309.15, 0.0, 100.0, 216.0];
        let mut machine = Machine {
            speed_rad_s: self.one_of(&speeds),
            damping_n_s_m: self.one_of(&[0.0, 0.1, 1.28, 1.28, 12.8]),
            normal_force: self.one_of(&[NormalForce::Lagrange, NormalForce::Newton]),
            ..Machine::default()
        };
        machine.balls.resize(balls, machine.balls[0]);
        let heavier = self.one_of(&[1.0, 1.0, 20.0, 100.0]);
        let friction = self.one_of(&[0.0, 2.75e-4, 2.75e-3, 2.75e-3, 0.05, 0.5]);
        let spread = self.one_of(&[1.0, 2.0]);
        for ball in &mut machine.balls {
            ball.mass_kg *= heavier * self.between(1.0 / spread, spread);
            ball.friction_coefficient = friction * self.between(1.0 / spread, spread);
            ball.diameter_m *= self.between(1.0 / spread, spread);
        }
        machine.ring_runout_m = self.one_of(&[0.0, 0.0, 0.0, 1e-5, 3e-4]);
        machine.ring_runout_angle_rad = self.between(0.0, TAU);
        machine
    }

    /// Returns a state of varied kind: near the rest point or far from it, balls at rest, hardly
    /// moving or moving, apart or side by side.
    pub fn state<const N: usize>(&mut self, balancer: &Balancer<N>) -> State<N> {
        let far = self.one_of(&[0.05, 0.05, 1e-3, 1e-6]);
        let mut beta: [f64; N] = std::array::from_fn(|_| self.between(0.0, TAU));
        if self.between(0.0, 1.0) < 0.2 {
            beta = [beta[0]; N];
        }
        let rest = balancer.rest_point(&beta).position;
        let centre = self.one_of(&[[0.0; 2], rest]);
        let fastest = self.one_of(&[0.0, 1.0, 1.0, 0.01, 1e-6, 1e-12, 1e-18, 1e-300]);
        let mut around = |centre: f64| centre + self.between(-far, far);
        let (position, velocity) = (centre.map(&mut around), [0.0; 2].map(&mut around));
        let beta_dot = std::array::from_fn(|_| {
            let speed = self.between(-fastest, fastest);
            self.one_of(&[0.0, speed, speed])
        });
        State { position, velocity, beta, beta_dot }
    }
}

/// Nodes and weights of Gauss's rule with four points on [0, 1].
pub const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_92),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_1),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_1),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_92),
];

/// Returns settings with few steps, which the motions of these tests do not exceed.
pub fn settings(method: Method, relative: f64) -> Settings {
    Settings { effort_limit: 200_000, ..support::settings(method, relative) }
}

/// Settings for closed forms, with located events.
pub const EXACT: Settings = Settings {
    method: Method::Event,
    band: 0.0,
    tolerance: Tolerance { relative: 1e-13, absolute: 1e-14 },
    effort_limit: 1_000_000,
};

/// Returns the thesis's machine at a speed.
pub fn two_balls(speed_rad_s: f64) -> Balancer<2> {
    Balancer::new(&Machine { speed_rad_s, ..Machine::default() }).expect("two balls")
}

/// Returns the motion from a state until a time.
pub fn moved<const N: usize>(
    system: &Arc<dyn System>,
    settings: Settings,
    state: State<N>,
    until: f64,
) -> Motion {
    let mut motion = started(system, settings, &state);
    go_on(&mut motion, until);
    motion
}

/// Compares the displacements of these components until a time with central differences of motions whose starts are displaced
/// by a size, to a tolerance. Returns the motion and the number of its steps that end with an event.
#[track_caller]
pub fn compare_displacements(
    system: &Arc<dyn System>,
    settings: Settings,
    start: &[f64],
    places: &[usize],
    until: f64,
    [size, tolerance]: [f64; 2],
) -> (Motion, u32) {
    let follow = |state: &[f64], directions: &[Components]| {
        let mut motion =
            Motion::with_directions(system, settings, state, directions).expect("starts");
        let mut events = 0;
        while motion.time() < until {
            events += u32::from(motion.advance(until).expect("continues"));
        }
        (motion, events)
    };
    let unit = |place: &usize| -> Components {
        (0..start.len()).map(|other| f64::from(other == *place)).collect()
    };
    let directions: Vec<Components> = places.iter().map(unit).collect();
    let (motion, events) = follow(start, &directions);
    assert!(!motion.grazed());
    for (direction, displaced) in directions.iter().zip(motion.perturbations()) {
        let ends = [size, -size].map(|size| {
            let moved = start.iter().zip(direction).map(|(value, by)| value + size * by);
            follow(&moved.collect::<Vec<f64>>(), &[]).0.state()
        });
        for (place, found) in displaced.iter().enumerate() {
            let slope = (ends[0][place] - ends[1][place]) / (2.0 * size);
            let near = (slope - found).abs() < tolerance * (1.0 + slope.abs());
            assert!(near, "{place} of {direction:?}: {found} {slope}");
        }
    }
    (motion, events)
}

/// Returns the components of a motion's state, with whole turns.
pub fn unwrapped(motion: &Motion) -> Components {
    let mut state = motion.state();
    let contacts = &motion.evaluator().graph().layout.contacts;
    for (contact, position) in contacts.iter().zip(motion.unwrapped()) {
        state[contact.position] = position;
    }
    state
}

/// Returns the largest difference between two motions' states, with whole turns.
pub fn difference(a: &Motion, b: &Motion) -> f64 {
    let pairs = unwrapped(a).into_iter().zip(unwrapped(b));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Returns the table's state after a time with all balls stuck: the damped oscillator in inertial
/// space about the rest point (thesis section 5.2), by complex numbers `[re, im]`.
pub fn stuck_table<const N: usize>(
    balancer: &Balancer<N>,
    rest: &RestPoint<N>,
    start: &State<N>,
    time: f64,
) -> State<N> {
    let (zeta, omega) = (balancer.damping_ratio, balancer.speed);
    let u: [f64; 2] = std::array::from_fn(|axis| start.position[axis] - rest.position[axis]);
    let v = [start.velocity[0] - omega * u[1], start.velocity[1] + omega * u[0]];
    let damped = (1.0 - zeta * zeta).sqrt();
    let (sine, cosine) = (damped * time).sin_cos();
    let decay = (-zeta * time).exp();
    let (turn_sine, turn_cosine) = (omega * time).sin_cos();
    let back = |w: [f64; 2]| {
        [turn_cosine * w[0] + turn_sine * w[1], turn_cosine * w[1] - turn_sine * w[0]]
    };
    let u_then = back(std::array::from_fn(|axis| {
        decay * (u[axis] * cosine + (v[axis] + zeta * u[axis]) / damped * sine)
    }));
    let v_then = back(std::array::from_fn(|axis| {
        decay * (v[axis] * cosine - (u[axis] + zeta * v[axis]) / damped * sine)
    }));
    State {
        position: std::array::from_fn(|axis| rest.position[axis] + u_then[axis]),
        velocity: [v_then[0] + omega * u_then[1], v_then[1] - omega * u_then[0]],
        ..*start
    }
}
