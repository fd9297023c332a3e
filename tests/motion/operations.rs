//! The operations on power series against functions: integrals of functions of time, and their derivatives along a
//! displacement of time.

use stickslip::model::{
    Components, Expression, Graph, Layout, Method, Number, Recorder, SystemEquations,
};
use stickslip::motion::{Failure, Motion, Settings, Tolerance};

use crate::support::{OwnSystem, shared};

const SETTINGS: Settings = Settings {
    method: Method::Event,
    band: 0.0,
    tolerance: Tolerance { relative: 1e-13, absolute: 1e-14 },
    effort_limit: 10_000,
};

/// The rates of change of components that follow the component that is the time.
fn with_time<'r>(rates: Vec<Expression<'r>>) -> SystemEquations<'r> {
    let time = Expression::constant(1.0);
    let velocities = (1..=rates.len()).map(|component| vec![component]).collect();
    SystemEquations {
        derivative: std::iter::once(time).chain(rates).collect(),
        layout: Layout { velocities, ..Layout::default() },
        ..SystemEquations::default()
    }
}

fn functions(recorder: &Recorder) -> SystemEquations<'_> {
    let t = recorder.state();
    for _ in 0..6 {
        recorder.state();
    }
    let number = Expression::constant;
    let (sine, cosine) = t.sin_cos();
    let square = number(1.0) + t * t;
    // x + t y = cos t, sin t x + 3 y = t
    let solution = recorder.solve(&[vec![number(1.0), t], vec![sine, number(3.0)]], &[cosine, t]);
    with_time(vec![
        cosine * sine.exp(),
        t / square.sqrt(),
        (t * number(3.0)).atan(),
        (-sine * (number(1.0) + t) - cosine) / (square + number(2.0) * t),
        -(-t - number(1.0)).exp(),
        solution[1],
    ])
}

/// Returns the rates of [`functions`].
fn rates(t: f64) -> [f64; 6] {
    [
        t.cos() * t.sin().exp(),
        t / (1.0 + t * t).sqrt(),
        (3.0 * t).atan(),
        (-t.sin() * (1.0 + t) - t.cos()) / (1.0 + t).powi(2),
        -(-t - 1.0).exp(),
        (t - t.sin() * t.cos()) / (3.0 - t * t.sin()),
    ]
}

/// Returns antiderivatives of the first five rates.
fn integrals(t: f64) -> [f64; 5] {
    [
        t.sin().exp(),
        (1.0 + t * t).sqrt(),
        t * (3.0 * t).atan() - (1.0 + 9.0 * t * t).ln() / 6.0,
        t.cos() / (1.0 + t),
        (-t - 1.0).exp(),
    ]
}

#[test]
fn series_and_displacements_of_functions() {
    let system = shared(OwnSystem {
        record: functions,
        parameters: vec![],
        friction: vec![],
        longest_step: 0.5,
        unique: true,
    });
    for start in [0.0, 0.4, 1.3] {
        let mut state = Components::from_elem(0.0, 7);
        state[0] = start;
        let mut direction = Components::from_elem(0.0, 7);
        direction[0] = 1.0;
        let mut motion =
            Motion::with_directions(&system, SETTINGS, &state, &[direction]).expect("starts");
        while motion.time() < 1.0 {
            motion.advance(1.0).expect("continues");
            let end = start + motion.time();
            let state = motion.state();
            let changes = motion.displacements().remove(0);
            for (index, (from, to)) in integrals(start).iter().zip(integrals(end)).enumerate() {
                let found = state[1 + index];
                assert!((found - (to - from)).abs() < 1e-13, "{index} at {end}: {found}");
            }
            for (index, (from, to)) in rates(start).iter().zip(rates(end)).enumerate() {
                let found = changes[1 + index];
                assert!((found - (to - from)).abs() < 1e-11, "{index} at {end}: {found}");
            }
        }
    }
}

/// `(t - 0.5) y' = 1` has no solution at 0.5.
#[test]
fn a_singular_linear_system_ends_the_motion() {
    fn singular(recorder: &Recorder) -> SystemEquations<'_> {
        let t = recorder.state();
        recorder.state();
        let half = Expression::constant(0.5);
        with_time(recorder.solve(&[vec![t - half]], &[Expression::constant(1.0)]))
    }
    let system = shared(OwnSystem {
        record: singular,
        parameters: vec![],
        friction: vec![],
        longest_step: 0.5,
        unique: true,
    });
    let at_once = Motion::new(&system, SETTINGS, &[0.5, 0.0]).expect("starts").advance(1.0);
    assert_eq!(at_once, Err(Failure::NotFinite));
    let mut motion = Motion::new(&system, SETTINGS, &[0.0, 0.0]).expect("starts");
    let ending = (0..).find_map(|_| motion.advance(1.0).err());
    assert_eq!(ending, Some(Failure::StepLimit), "at {}", motion.time());
    assert!(motion.time() < 0.5);
}

/// Equal expressions are one node, and neutral elements leave none.
#[test]
fn equal_expressions_are_one_node() {
    fn record(expressions: impl for<'r> Fn(Expression<'r>) -> Vec<Expression<'r>>) -> Graph {
        let recorder = Recorder::default();
        recorder.finish(&with_time(expressions(recorder.state())))
    }
    let once = record(|t| vec![t * t.exp() + t]);
    let twice = record(|t| vec![t * t.exp() + t, t + t.exp() * t]);
    assert_eq!(once.nodes, twice.nodes);
    assert_eq!(twice.derivative[1], twice.derivative[2]);
    let neutral = record(|t| {
        let [zero, one] = [0.0, 1.0].map(Expression::constant);
        vec![(t + zero) * one - zero, t / one]
    });
    // The component, and its rate of change.
    assert_eq!(neutral.nodes.len(), 2);
}
