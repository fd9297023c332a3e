//! Power series of recorded systems against functions, the hand-written equations, and the equations themselves along
//! the series.

use stickslip::model::{
    Balancer, Ball, Block, Contact, ContactMode, Dual, Elementary, Expression, FRICTION_LAWS,
    Friction, FrictionLaw, Graph, Law, Layout, Machine, Number, Recorder, Slider, State, System,
    SystemEquations,
};
use stickslip::motion::Expansion;

use crate::support::TestRng;

/// Returns the value of a series with these coefficients.
fn at(series: &[f64], time: f64) -> f64 {
    series.iter().rev().fold(0.0, |sum, coefficient| sum * time + coefficient)
}

/// Returns the slope of a series with these coefficients.
fn slope_at(series: &[f64], time: f64) -> f64 {
    let slopes: Vec<f64> = (0..).zip(series).skip(1).map(|(k, one)| f64::from(k) * one).collect();
    at(&slopes, time)
}

fn between(rng: &mut TestRng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.uniform()
}

/// Records an expression of time.
fn record(expression: impl for<'r> Fn(Expression<'r>) -> Vec<Expression<'r>>) -> Graph {
    let recorder = Recorder::default();
    let derivative = expression(recorder.time());
    recorder.finish(&SystemEquations {
        derivative,
        contacts: Vec::new(),
        layout: Layout::default(),
    })
}

#[test]
fn series_of_functions() {
    let one = || Expression::constant(1.0);
    let graph = record(|t| {
        let (sine, cosine) = t.sin_cos();
        vec![
            sine.exp(),
            (one() + t * t).sqrt(),
            (t * Expression::constant(3.0)).atan(),
            cosine / (one() + t),
            (-t - one()).exp().reciprocal(),
        ]
    });
    let functions: [fn(f64) -> f64; 5] = [
        |t| t.sin().exp(),
        |t| (1.0 + t * t).sqrt(),
        |t| (3.0 * t).atan(),
        |t| t.cos() / (1.0 + t),
        |t| (t + 1.0).exp(),
    ];
    for start in [0.0, 0.4, 1.3] {
        let expansion = Expansion::new(&graph, 24, &[], &[], start).expect("no linear system");
        for (index, (node, function)) in graph.derivative.iter().zip(functions).enumerate() {
            for step in [-0.05, 0.02, 0.06] {
                let (found, expected) = (at(expansion.series(*node), step), function(start + step));
                assert!((found - expected).abs() < 1e-13, "{index} at {start}: {found} {expected}");
            }
        }
    }
}

/// The series of the solution solves the linear system at other times, also where rows are exchanged.
#[test]
fn series_of_the_solution_of_a_linear_system() {
    let rows = |t: f64| {
        let matrix = [[0.0, 1.0 + t, t * t], [2.0, t.sin(), 1.0], [t.exp(), 1.0, 3.0 - t]];
        (matrix, [t.cos(), 1.0, t])
    };
    let recorder = Recorder::default();
    let t = recorder.time();
    let number = Expression::constant;
    let (sine, cosine) = t.sin_cos();
    let matrix = [
        vec![number(0.0), number(1.0) + t, t * t],
        vec![number(2.0), sine, number(1.0)],
        vec![t.exp(), number(1.0), number(3.0) - t],
    ];
    let derivative = recorder.solve(&matrix, &[cosine, number(1.0), t]);
    let graph = recorder.finish(&SystemEquations {
        derivative,
        contacts: Vec::new(),
        layout: Layout::default(),
    });
    let expansion = Expansion::new(&graph, 20, &[], &[], 0.3).expect("regular");
    let (matrix, right) = rows(0.3 + 0.04);
    let solution: Vec<f64> =
        graph.derivative.iter().map(|node| at(expansion.series(*node), 0.04)).collect();
    for (row, right) in matrix.iter().zip(right) {
        let left: f64 = row.iter().zip(&solution).map(|(one, other)| one * other).sum();
        assert!((left - right).abs() < 1e-13, "{left} {right}");
    }
}

#[test]
fn a_singular_system_has_no_expansion() {
    let recorder = Recorder::default();
    let t = recorder.time();
    let derivative = recorder.solve(&[vec![t, t], vec![t, t]], &[t, t]);
    let graph = recorder.finish(&SystemEquations {
        derivative,
        contacts: Vec::new(),
        layout: Layout::default(),
    });
    assert!(Expansion::new(&graph, 3, &[], &[], 1.0).is_none());
}

/// Equal expressions are one node, and neutral elements leave none.
#[test]
fn equal_expressions_are_one_node() {
    let once = record(|t| vec![t * t.exp() + t]);
    let twice = record(|t| vec![t * t.exp() + t, t + t.exp() * t]);
    assert_eq!(once.nodes, twice.nodes);
    assert_eq!(twice.derivative[0], twice.derivative[1]);
    let neutral = record(|t| {
        let [zero, one] = [0.0, 1.0].map(Expression::constant);
        vec![(t + zero) * one - zero, zero * t + t / one]
    });
    assert_eq!(neutral.nodes.len(), 1);
}

/// The derivative in a state.
type Derivative = dyn Fn(&[f64]) -> Vec<f64>;
/// The derivative of a displacement in a state.
type Linearised = dyn Fn(&[f64], &[f64]) -> Vec<f64>;

/// A system with modes of its contacts, and its derivative by the hand-written equations.
struct Example {
    graph: Graph,
    inputs: Vec<f64>,
    state: Vec<f64>,
    derivative: Box<Derivative>,
    along: Box<Linearised>,
}

fn graph_of(system: &impl System) -> Graph {
    let recorder = Recorder::default();
    recorder.finish(&system.record(&recorder))
}

fn state<const N: usize>(components: &[f64]) -> State<N> {
    State::of_components(components).expect("as many components")
}

fn contact(mode: ContactMode, friction: &Friction, speed: f64) -> Contact {
    match mode {
        ContactMode::Stick => Contact::STICK,
        ContactMode::Slip(direction) => friction.slip(direction, speed),
        ContactMode::SetOff(direction) => friction.slip(direction, 0.0),
    }
}

fn contact_along(mode: ContactMode, friction: &Friction, speed: Dual) -> Contact<Dual> {
    match mode {
        ContactMode::Stick => Contact::STICK.lifted(),
        ContactMode::Slip(direction) => friction.slip_along(direction, speed),
        ContactMode::SetOff(direction) => friction.slip_along(direction, Dual::constant(0.0)),
    }
}

/// Returns the rates of the hand-written equations of a balancer.
fn rates_of_balls<const N: usize, T: Number>(
    balancer: &Balancer<N, T>,
    state: &State<N, T>,
    contacts: &[Contact<T>; N],
) -> State<N, T> {
    balancer.derivative(state, contacts, &balancer.forces(state, contacts))
}

/// Returns the rates of position and speed of a slipping block: ẋ = v + belt speed, v̇ = -x - friction.
fn rates_of_block<T: Number>(belt_speed: f64, [x, v]: [T; 2], contact: Contact<T>) -> [T; 2] {
    [T::constant(belt_speed) + v, -x - (contact.signed_friction + contact.drag)]
}

const LAWS: [FrictionLaw; 5] = [
    FrictionLaw::COULOMB,
    FrictionLaw::stribeck(4e-3, 30.0),
    FrictionLaw::stribeck(4e-3, 0.0),
    FrictionLaw::smooth(40.0),
    FrictionLaw::viscous(2e-4),
];

fn of_balls<const N: usize>(law: FrictionLaw, rng: &mut TestRng) -> Example {
    let machine = Machine {
        balls: vec![Ball::default(); N],
        friction: law,
        speed_rad_s: between(rng, -400.0, 400.0),
        ..Machine::default()
    };
    let mut components: Vec<f64> = (0..4).map(|_| between(rng, -0.05, 0.05)).collect();
    components.extend((0..N).map(|_| between(rng, 0.0, 6.0)));
    let modes: [_; N] = std::array::from_fn(|_| match rng.below(4) {
        0 if law.can_stick() => ContactMode::Stick,
        3 if law.can_stick() => ContactMode::SetOff(-1.0),
        direction => ContactMode::Slip(if direction == 1 { 1.0 } else { -1.0 }),
    });
    components.extend(modes.map(|mode| match mode {
        ContactMode::Stick => 0.0,
        ContactMode::Slip(direction) => direction * between(rng, 0.01, 1.0),
        ContactMode::SetOff(direction) => direction * between(rng, -1e-3, 1e-3),
    }));
    let balancer = Balancer::<N>::new(&machine).expect("this number of balls");
    let friction = balancer.balls.map(|ball| ball.friction);
    Example {
        graph: graph_of(&balancer),
        inputs: balancer.inputs(&modes),
        state: components,
        derivative: Box::new(move |components| {
            let state = state::<N>(components);
            let of = |i: usize| contact(modes[i], &friction[i], state.beta_dot[i]);
            rates_of_balls(&balancer, &state, &std::array::from_fn(of)).components().to_vec()
        }),
        along: Box::new(move |components, direction| {
            let moving = state::<N>(components).along(&state(direction));
            let of = |i: usize| contact_along(modes[i], &friction[i], moving.beta_dot[i]);
            let rates = rates_of_balls(&balancer.lifted(), &moving, &std::array::from_fn(of));
            rates.slope().components().to_vec()
        }),
    }
}

fn of_block(law: FrictionLaw, rng: &mut TestRng) -> Example {
    let slider: Slider = Block { friction: law, ..Block::on_belt() }.slider();
    let mode = ContactMode::Slip(1.0);
    Example {
        graph: graph_of(&slider),
        inputs: slider.inputs(&[mode]),
        state: vec![between(rng, -2.0, 2.0), between(rng, 0.01, 1.0)],
        derivative: Box::new(move |components| {
            let &[x, v] = components else { panic!("two components") };
            let contact = contact(mode, &slider.friction, v);
            rates_of_block(slider.belt_speed, [x, v], contact).to_vec()
        }),
        along: Box::new(move |components, direction| {
            let [x, v] = [0, 1].map(|i| Dual { value: components[i], slope: direction[i] });
            let contact = contact_along(mode, &slider.friction, v);
            let rates = rates_of_block(slider.belt_speed, [x, v], contact);
            rates.map(|rate| rate.slope).to_vec()
        }),
    }
}

/// Returns the examples of all laws, for balls and for blocks.
fn laws_with_their_examples() -> Vec<FrictionLaw> {
    let with = |law: &'static dyn Law, unit: usize| {
        let values: Vec<f64> = law.parameters().iter().map(|one| one.examples[unit]).collect();
        FrictionLaw::new(law, &values)
    };
    FRICTION_LAWS.iter().flat_map(|law| [with(*law, 0), with(*law, 1)]).collect()
}

fn examples(laws: &[FrictionLaw]) -> Vec<Example> {
    let mut rng = TestRng::new(22);
    let mut all = Vec::new();
    for &law in laws {
        for _ in 0..8 {
            all.push(of_balls::<1>(law, &mut rng));
            all.push(of_balls::<2>(law, &mut rng));
            all.push(of_balls::<3>(law, &mut rng));
            all.push(of_balls::<8>(law, &mut rng));
            all.push(of_block(law, &mut rng));
        }
    }
    all
}

/// The first order of the series is the hand-written derivative.
#[test]
fn recorded_equations_are_the_written_ones() {
    let laws = [laws_with_their_examples(), LAWS.to_vec()].concat();
    for Example { graph, inputs, state, derivative, .. } in examples(&laws) {
        let expansion = Expansion::new(&graph, 1, &inputs, &state, 0.0).expect("regular");
        for (component, expected) in derivative(&state).into_iter().enumerate() {
            let found = expansion.state(component)[1];
            let error = (found - expected).abs();
            assert!(error < 1e-13 * expected.abs().max(1.0), "{component}: {found} {expected}");
        }
    }
}

/// The state that the series gives after a step moves as the hand-written equations say: the series of a sticking ball,
/// a slipping one and every law are solutions.
#[test]
fn series_solve_the_equations_of_motion() {
    let time = 0.03;
    for Example { graph, inputs, state, derivative, .. } in examples(&LAWS) {
        let expansion = Expansion::new(&graph, 24, &inputs, &state, 0.0).expect("regular");
        let components = 0..state.len();
        let later: Vec<f64> =
            components.clone().map(|one| at(expansion.state(one), time)).collect();
        let expected = derivative(&later);
        for (component, expected) in components.zip(expected) {
            let found = slope_at(expansion.state(component), time);
            let error = (found - expected).abs();
            assert!(error < 1e-11 * expected.abs().max(1.0), "{component}: {found} {expected}");
        }
    }
}

/// Dual numbers give the linearised equations, and the series of the displacement.
#[test]
fn displacements_follow_the_linearised_equations() {
    let mut rng = TestRng::new(23);
    for Example { graph, inputs, state, along, .. } in examples(&LAWS) {
        let direction: Vec<f64> = state.iter().map(|_| between(&mut rng, -1.0, 1.0)).collect();
        let constants: Vec<Dual> = inputs.iter().map(|&value| Dual::constant(value)).collect();
        let dual = |(&value, &slope): (&f64, &f64)| Dual { value, slope };
        let moving: Vec<Dual> = state.iter().zip(&direction).map(dual).collect();
        let time = Dual::constant(0.0);
        let expansion = Expansion::new(&graph, 20, &constants, &moving, time).expect("regular");
        for (component, expected) in along(&state, &direction).into_iter().enumerate() {
            let found = expansion.state(component)[1].slope;
            let error = (found - expected).abs();
            assert!(error < 1e-12 * expected.abs().max(1.0), "{component}: {found} {expected}");
        }
        // A small displacement after a step, by differences.
        let step = 1e-6;
        let shifted = |sign: f64| -> Vec<f64> {
            let state: Vec<f64> =
                state.iter().zip(&direction).map(|(one, by)| one + sign * step * by).collect();
            let expansion = Expansion::new(&graph, 20, &inputs, &state, 0.0).expect("regular");
            (0..state.len()).map(|one| at(expansion.state(one), 0.02)).collect()
        };
        let (low, high) = (shifted(-1.0), shifted(1.0));
        for (component, (low, high)) in low.into_iter().zip(high).enumerate() {
            let slopes: Vec<f64> = expansion.state(component).iter().map(|one| one.slope).collect();
            let (found, expected) = (at(&slopes, 0.02), (high - low) / (2.0 * step));
            let error = (found - expected).abs();
            assert!(error < 1e-7 * expected.abs().max(1.0), "{component}: {found} {expected}");
        }
    }
}

/// The functions of dual numbers have the slopes of differences.
#[test]
fn slopes_of_elementary_functions() {
    let functions: [fn(Dual) -> Dual; 3] = [Dual::sqrt, Dual::exp, Dual::atan];
    for function in functions {
        for x in [0.2, 0.9, 2.5] {
            let value = |value: f64| function(Dual { value, slope: 0.0 }).value();
            let expected = (value(x + 1e-6) - value(x - 1e-6)) / 2e-6;
            let found = function(Dual { value: x, slope: 1.0 }).slope;
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }
}
