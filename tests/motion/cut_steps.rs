//! Steps that an end time shortens, steps that it does not, and states within a step.

use stickslip::model::{Balancer, Machine, Method, Simulation, Start, State};
use stickslip::motion::{Motion, Settings};

const METHODS: [Method; 2] = [Method::Event, Method::Switch];

fn motion(balancer: &Balancer<2>, method: Method) -> Motion<'_, Balancer<2>, 2> {
    let simulation = Simulation { method, ..Simulation::default() };
    let start = Start::of_balancer([0.01, 0.0], &[1.0, 4.0], [0.0, 0.02], &[0.5, -0.3]);
    let state = start.of_balls().expect("two balls");
    Motion::new(balancer, Settings::new(&simulation, u64::MAX), state).expect("starts")
}

/// Returns the largest difference of two states, angles modulo 2π.
fn largest_difference(a: &State<2>, b: &State<2>) -> f64 {
    let flat = |s: &State<2>| {
        let [sines, cosines] = [s.beta.map(f64::sin), s.beta.map(f64::cos)];
        [s.position, s.velocity, sines, cosines, s.beta_dot].concat()
    };
    flat(a).iter().zip(flat(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Steps that do not reach an end time are bit for bit those to any later end time.
#[test]
fn steps_that_reach_no_end_do_not_depend_on_it() {
    let balancer = Balancer::<2>::new(&Machine::default()).expect("two balls");
    for method in METHODS {
        for index in 1..60 {
            let until = 0.37 * f64::from(index);
            let (mut cut, mut free) = (motion(&balancer, method), motion(&balancer, method));
            while !cut.reaches(until) {
                assert_eq!(cut.advance(until), free.advance(f64::MAX));
                assert_eq!(format!("{cut:?}"), format!("{free:?}"));
            }
            assert!(cut.time() < until);
            while cut.time() < until {
                cut.advance(until).expect("continues");
            }
            assert_eq!(cut.time(), until);
        }
    }
}

/// The state at a time within the latest step is that of a motion that stops there; there is none
/// outside of the step.
#[test]
fn states_within_a_step_are_those_of_a_stopped_motion() {
    let balancer = Balancer::<2>::new(&Machine::default()).expect("two balls");
    for method in METHODS {
        let mut steps = motion(&balancer, method);
        while steps.time() < 20.0 {
            let before = steps.clone();
            steps.advance(f64::MAX).expect("continues");
            let length = steps.time() - before.time();
            for part in [0.0, 0.3, 0.9, 1.0] {
                let time = if part < 1.0 { before.time() + part * length } else { steps.time() };
                let found = steps.within_last_step(time).expect("within");
                let mut stops = before.clone();
                while stops.time() < time {
                    stops.advance(time).expect("continues");
                }
                let difference = largest_difference(&found, stops.state());
                assert!(difference < 1e-7, "{time}: {difference}");
            }
            let outside = [before.time() - 1e-9, steps.time() + 1e-9];
            assert_eq!(outside.map(|time| steps.within_last_step(time)), [None, None]);
        }
    }
}
