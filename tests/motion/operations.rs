//! The operations on power series against functions: integrals of functions of time, and their derivatives along a
//! displacement of time.

use stickslip::model::{
    Components, Expression, Graph, Number, Recorder, StateLayout, SystemEquations,
};
use stickslip::motion::{Failure, Motion, Settings};

use super::samples::EXACT;
use crate::support::{OwnSystem, shared};

const SETTINGS: Settings = Settings { effort_limit: 10_000, ..EXACT };

/// The rates of change of components that follow the component that is the time.
fn with_time<'r>(rates: Vec<Expression<'r>>) -> SystemEquations<'r> {
    let time = Expression::constant(1.0);
    let velocities = (1..=rates.len()).map(|component| vec![component]).collect();
    SystemEquations {
        derivative: std::iter::once(time).chain(rates).collect(),
        layout: StateLayout { velocities, ..StateLayout::default() },
        ..SystemEquations::default()
    }
}

fn functions(recorder: &Recorder) -> SystemEquations<'_> {
    let t = recorder.state();
    for _ in 0..7 {
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
        (t + number(1.0)).log(),
        solution[1],
    ])
}

/// Returns the rates of [`functions`].
fn rates(t: f64) -> [f64; 7] {
    [
        t.cos() * t.sin().exp(),
        t / (1.0 + t * t).sqrt(),
        (3.0 * t).atan(),
        (-t.sin() * (1.0 + t) - t.cos()) / (1.0 + t).powi(2),
        -(-t - 1.0).exp(),
        (t + 1.0).ln(),
        (t - t.sin() * t.cos()) / (3.0 - t * t.sin()),
    ]
}

/// Returns antiderivatives of the first six rates.
fn integrals(t: f64) -> [f64; 6] {
    [
        t.sin().exp(),
        (1.0 + t * t).sqrt(),
        t * (3.0 * t).atan() - (1.0 + 9.0 * t * t).ln() / 6.0,
        t.cos() / (1.0 + t),
        (-t - 1.0).exp(),
        (t + 1.0) * (t + 1.0).ln() - t,
    ]
}

#[test]
fn series_and_displacements_of_functions() {
    let system = shared(OwnSystem::new(functions, vec![], vec![]));
    for start in [0.0, 0.4, 1.3] {
        let mut state = Components::from_elem(0.0, 8);
        state[0] = start;
        let mut direction = Components::from_elem(0.0, 8);
        direction[0] = 1.0;
        let mut motion =
            Motion::with_directions(&system, SETTINGS, &state, &[direction]).expect("starts");
        while motion.time() < 1.0 {
            motion.advance(1.0).expect("continues");
            let end = start + motion.time();
            let state = motion.state();
            let changes = motion.perturbations().remove(0);
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
    let system = shared(OwnSystem::new(singular, vec![], vec![]));
    let at_once = Motion::new(&system, SETTINGS, &[0.5, 0.0]).expect("starts").advance(1.0);
    assert_eq!(at_once, Err(Failure::NotFinite));
    let mut motion = Motion::new(&system, SETTINGS, &[0.0, 0.0]).expect("starts");
    let ending = (0..).find_map(|_| motion.advance(1.0).err());
    assert_eq!(ending, Some(Failure::StepLimit), "at {}", motion.time());
    assert!(motion.time() < 0.5);
}

/// Returns a system of order three whose equations `A x' = A y` have the solution `y = (1, 2 t, cos t)`. The entries of `A`
/// are linear in the time: first all constants, then all slopes.
fn three_equations(recorder: &Recorder) -> SystemEquations<'_> {
    let t = recorder.state();
    for _ in 0..3 {
        recorder.state();
    }
    let entries: Vec<_> = (0..18).map(|_| recorder.input("entry")).collect();
    let of_row = |row: usize| -> Vec<Expression<'_>> {
        let places = 3 * row..3 * row + 3;
        places.map(|place| entries[place] + entries[9 + place] * t).collect()
    };
    let matrix = [0, 1, 2].map(of_row);
    let solution = [Expression::constant(1.0), t + t, t.sin_cos().1];
    let times = |row: &Vec<_>| {
        row.iter()
            .zip(solution)
            .fold(Expression::constant(0.0), move |sum, (entry, value)| sum + *entry * value)
    };
    let right: Vec<_> = matrix.iter().map(times).collect();
    with_time(recorder.solve(&matrix, &right))
}

/// Compares values, series and displacements of [`three_equations`] with the solution.
fn solves(parameters: Vec<f64>, end: f64) {
    let what = format!("{parameters:?}");
    let system = shared(OwnSystem::new(three_equations, parameters, vec![]));
    let rates = |t: f64| [1.0, 2.0 * t, t.cos()];
    let mut state = [0.0; 4];
    let mut motion = Motion::with_directions(
        &system,
        SETTINGS,
        &state,
        &[Components::from_slice(&[1.0, 0.0, 0.0, 0.0])],
    )
    .unwrap_or_else(|failure| panic!("{failure}: {what}"));
    while motion.time() < end {
        motion.advance(end).unwrap_or_else(|failure| panic!("{failure}: {what}"));
        let t = motion.time();
        state.copy_from_slice(&motion.state());
        let changes = motion.perturbations().remove(0);
        let found = motion.evaluator().rates(&[], &state);
        for (index, expected) in [t, t * t, t.sin()].into_iter().enumerate() {
            let place = 1 + index;
            assert!(
                (state[place] - expected).abs() < 1e-12,
                "{index} at {t}: {}, {what}",
                state[place]
            );
            let change = rates(t)[index] - rates(0.0)[index];
            assert!(
                (changes[place] - change).abs() < 1e-10,
                "{index} at {t}: {}, {what}",
                changes[place]
            );
            assert!(
                (found[place] - rates(t)[index]).abs() < 1e-12,
                "{index} at {t}: {found:?}, {what}"
            );
        }
    }
}

/// Neither the order of the equations nor their units matter, nor whether a pivot vanishes on the way.
#[test]
fn linear_systems_with_small_pivots() {
    let zero = [0.0; 9];
    for small in [0.0, 1e-12] {
        solves([[small, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0], zero].concat(), 1.0);
    }
    // Rows of unequal units: without scales, no pivot looks small.
    solves([[1.0, 1e12, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0], zero].concat(), 1.0);
    let regular = [[4.0, 1.0, -1.0], [0.0, 3.0, 1.0], [1.0, 0.0, -5.0]];
    let slopes = [[0.0, 0.3, 0.0], [0.2, 0.0, -0.3], [0.0, 0.4, 0.0]];
    for order in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for units in [[1.0, 1.0, 1.0], [1e9, 1.0, 1e-9], [1e-9, 1e9, 1.0]] {
            let rows = |rows: [[f64; 3]; 3]| -> Vec<f64> {
                let scaled =
                    order.iter().zip(units).map(|(&row, unit)| rows[row].map(|entry| unit * entry));
                scaled.flatten().collect()
            };
            solves([rows(regular), rows(slopes)].concat(), 1.0);
        }
    }
    // The first pivot is `1 - t`.
    let shear = [1.0, 1.0, 0.0, -2.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let slope = [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    solves([shear, slope].concat(), 2.0);
}

/// Nothing is locked while a system is recorded: recording may wait for that of another system.
#[test]
fn a_system_that_records_another_one() {
    fn without_inputs(record: for<'r> fn(&'r Recorder) -> SystemEquations<'r>) -> OwnSystem {
        OwnSystem::new(record, vec![], vec![])
    }
    fn inner(recorder: &Recorder) -> SystemEquations<'_> {
        recorder.state();
        with_time(vec![])
    }
    fn outer(recorder: &Recorder) -> SystemEquations<'_> {
        let t = recorder.state();
        recorder.state();
        let waits = std::thread::spawn(|| Graph::of(&without_inputs(inner)));
        assert_eq!(waits.join().expect("recorded").derivative.len(), 1);
        with_time(vec![t])
    }
    let (sender, receiver) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        sender.send([Graph::of(&without_inputs(outer)), Graph::of(&without_inputs(outer))])
    });
    let waits = std::time::Duration::from_secs(60);
    let [first, second] = receiver.recv_timeout(waits).expect("nothing is locked");
    assert!(std::sync::Arc::ptr_eq(&first, &second), "recorded once");
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
