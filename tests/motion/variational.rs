//! The linearised flow against finite differences of whole motions, through stick and slip.

use stickslip::model::{Balancer, FrictionLaw, Machine, Method, Model, State};
use stickslip::motion::{Motion, Phase, Settings, Tolerance, Variational};

use super::samples::Sampler;

fn fine(method: Method) -> Settings {
    Settings {
        method,
        band: 1e-3,
        tolerance: Tolerance { relative: 1e-12, absolute: 1e-13 },
        effort_limit: 1_000_000,
    }
}

fn values<const N: usize>(state: &State<N>) -> Vec<f64> {
    [&state.position[..], &state.velocity, &state.beta, &state.beta_dot].concat()
}

fn state_of<const N: usize>(values: &[f64]) -> State<N> {
    State {
        position: [values[0], values[1]],
        velocity: [values[2], values[3]],
        beta: std::array::from_fn(|ball| values[4 + ball]),
        beta_dot: std::array::from_fn(|ball| values[4 + N + ball]),
    }
}

/// Returns the state at `end`, with whole turns, and the phases on the way.
fn flow<const N: usize>(
    balancer: &Balancer<N>,
    settings: Settings,
    start: State<N>,
    end: f64,
    mut watch: impl FnMut(&Motion<Balancer<N>, N>),
) -> (State<N>, Vec<[Phase; N]>) {
    let mut motion = Motion::new(balancer, settings, start).expect("starts");
    let mut phases = vec![*motion.phases()];
    while motion.time() < end {
        motion.advance(end).expect("continues");
        watch(&motion);
        if phases.last() != Some(motion.phases()) {
            phases.push(*motion.phases());
        }
    }
    let mut state = *motion.state();
    state.beta = std::array::from_fn(|ball| motion.unwrapped_angle(ball));
    (state, phases)
}

fn compare<const N: usize>(
    balancer: &Balancer<N>,
    settings: Settings,
    start: State<N>,
    end: f64,
    direction: State<N>,
) -> Option<(f64, usize)> {
    let mut variation = Variational::new(vec![direction]);
    let (_, phases) = flow(balancer, settings, start, end, |motion| variation.follow(motion));
    let shifted = |step: f64| {
        let mut from = start;
        from.add_scaled(step, &direction);
        flow(balancer, settings, from, end, |_| {})
    };
    // Both neighbours must have the same sequence of stick and slip for a comparison.
    let step = 1e-6;
    let (low, high) = (shifted(-step), shifted(step));
    if low.1 != phases || high.1 != phases || variation.grazed {
        return None;
    }
    let carried = values(&variation.directions[0]);
    let size = carried.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let difference = values(&low.0)
        .iter()
        .zip(values(&high.0))
        .zip(&carried)
        .map(|((low, high), carried)| ((high - low) / (2.0 * step) - carried).abs())
        .fold(0.0, f64::max);
    Some((difference / size.max(1.0), phases.len() - 1))
}

/// For random machines, laws and starts, displacements of the linearised flow are those of
/// neighbouring motions.
#[test]
fn carried_displacements_are_those_of_neighbours() {
    let mut sampler = Sampler::new(4);
    for method in [Method::Event, Method::Switch] {
        let (mut compared, mut switches) = (0, 0);
        for _ in 0..60 {
            let mut machine = Machine {
                speed_rad_s: sampler.one_of(&[-160.8, -191.6, -216.4, -247.3, 216.4]),
                ..Machine::default()
            };
            machine.friction = sampler.one_of(&[
                FrictionLaw::COULOMB,
                FrictionLaw::COULOMB,
                FrictionLaw::stribeck(4e-3, 20.0),
                FrictionLaw::smooth(30.0),
                FrictionLaw::viscous(1e-4),
            ]);
            machine.balls[1].mass_kg *= 1.5;
            Model::from(machine.clone()).validate().expect("a valid machine");
            let balancer = Balancer::<2>::new(&machine).expect("two balls");
            let between = |sampler: &mut Sampler, half: f64| sampler.between(-half, half);
            let mut numbers =
                |half: f64| -> Vec<f64> { (0..8).map(|_| between(&mut sampler, half)).collect() };
            let (mut start, direction) = (numbers(0.05), numbers(1.0));
            start[4..6].iter_mut().for_each(|beta| *beta = 60.0 * *beta + 3.0);
            start[6..].iter_mut().for_each(|speed| *speed *= 8.0);
            let (start, mut direction) = (state_of(&start), state_of(&direction));
            if method == Method::Event {
                // A resting ball has no neighbours with arbitrarily small speed.
                direction.beta_dot = [0, 1].map(|ball| {
                    if start.beta_dot[ball] == 0.0 { 0.0 } else { direction.beta_dot[ball] }
                });
            }
            if let Some((error, met)) = compare(&balancer, fine(method), start, 40.0, direction) {
                compared += 1;
                switches += met;
                assert!(error < 3e-5, "{method:?} {machine:?}: {error} after {met} switches");
            }
        }
        println!("{method:?}: {compared} compared, {switches} switches met");
        assert!(compared >= 40 && switches >= 100, "{method:?}: {compared}, {switches}");
    }
}
