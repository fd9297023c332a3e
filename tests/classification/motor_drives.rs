//! Machines that a motor turns: their angle grows by a turn from period to period. In a period of a limit cycle, the work of the motor is
//! that of all losses.

use std::f64::consts::TAU;

use stickslip::classification::{Evidence, Label, Outcome, simulate};
use stickslip::model::{Method, OutputValue};

use super::outputs::cases;

/// Returns the outcomes of all runs of a system, by both methods.
fn by_both(system: &str, samples: usize, end_time_s: f64) -> Vec<Outcome> {
    let by = |method| {
        cases(system, samples, end_time_s).into_iter().map(move |mut case| {
            case.simulation.method = method;
            simulate(&case)
        })
    };
    [Method::Switch, Method::Event].into_iter().flat_map(by).collect()
}

/// Asserts that a run is on a limit cycle in which the first output `number`, a power, does this work over the period.
#[track_caller]
fn assert_work(outcome: &Outcome, number: usize, work: f64) {
    assert_eq!(outcome.evidence.label(), Label::LimitCycle, "{:?}", outcome.evidence);
    let Evidence::ClosedOrbit(orbit) = &outcome.evidence else { panic!("{outcome:?}") };
    let mean = outcome.outputs[number].value(OutputValue::Mean).expect("a cycle has means");
    let found = mean * orbit.period_s;
    assert!((found - work).abs() <= 1e-5 * work, "{found} is not {work}");
}

/// A slider-crank mechanism: the sliding speed of the piston vanishes at the dead centres, one of them at the angle 0. Friction takes
/// `4 μ F r` from the work of the motor in each turn, viscous friction the rest.
#[test]
fn a_crank_runs_round() {
    let [torque, load, mu, radius] = [20.0, 60.0, 0.3, 0.05];
    let root = "sqrt(l^2 - r^2 * sin(p)^2)";
    let lever = format!("(r * sin(p) + r^2 * sin(p) * cos(p) / {root})");
    let slope = format!(
        "(r * cos(p) + r^2 * (cos(p)^2 - sin(p)^2) / {root} + r^4 * sin(p)^2 * cos(p)^2 / {root}^3)"
    );
    for turns in [1.0, -1.0] {
        let system = format!(
            "parameters: {{J: 0.02 kg m^2, m: 1.5 kg, r: {radius} m, l: 15 cm, T: {} N m, c: 0.45 N m s, load: {load} N, mu: {mu}}}
coordinates: {{p: {{unit: rad, start: [0, 6], start_rate: [-30, 30], periodic: true}}}}
mass: {{p: {{p: J + m * {lever}^2}}}}
force: {{p: T - c * p' - m * {lever} * {slope} * p'^2}}
contacts: {{guide: {{normal: load, sliding: {lever} * p', friction: {{coulomb: {{coefficient: mu}}}}}}}}
outputs: {{loss: c * p'^2}}",
            turns * torque
        );
        for outcome in by_both(&system, 4, 60.0) {
            assert_work(&outcome, 2, TAU * torque - 4.0 * mu * load * radius);
        }
    }
}

/// A motor drives a sled through a crank and a spring: the angle belongs to no contact. The sled sticks at each end of its way, or not.
#[test]
fn a_sled_behind_a_spring_follows_its_motor() {
    for (mu, sticks) in [(0.3, false), (3.0, true)] {
        let system = format!(
            "parameters: {{J: 0.2 kg m^2, m: 1.5 kg, r: 5 cm, k: 3000 N/m, T: 4 N m, c: 0.3 N m s, d: 20 N s/m, load: 20 N, mu: {mu}}}
coordinates: {{p: {{unit: rad, start: 0.3, start_rate: [0, 30], periodic: true}}, x: {{unit: m}}}}
mass: {{p: {{p: J}}, x: {{x: m}}}}
force: {{p: T - c*p' + k*(x - r*sin(p))*r*cos(p), x: -k*(x - r*sin(p)) - d*x'}}
contacts: {{ground: {{normal: load, sliding: x', friction: {{coulomb: {{coefficient: mu}}}}}}}}
outputs: {{loss: c * p'^2 + d * x'^2, work: T * p'}}"
        );
        for outcome in by_both(&system, 3, 60.0) {
            let Evidence::ClosedOrbit(orbit) = &outcome.evidence else { panic!("{outcome:?}") };
            let cycle = orbit.cycle.as_ref().expect("a cycle");
            assert_eq!(cycle.stick_fraction[0] > 0.0, sticks);
            assert_work(&outcome, 5, TAU * 4.0);
            // The sled goes to and fro once per turn.
            let amplitude = outcome.outputs[1].value(OutputValue::Amplitude);
            let friction = 4.0 * mu * 20.0 * amplitude.expect("a cycle has an amplitude");
            assert_work(&outcome, 4, TAU * 4.0 - friction);
        }
    }
}

/// Two guides a quarter of a turn apart, as of a double slider: while one of them is at a dead centre, the other one slides.
#[test]
fn a_double_slider_runs_round() {
    let system = "parameters: {J: 0.02, r: 0.05, T: 20, c: 0.45, load: 60}
coordinates: {p: {unit: rad, start: [0, 6], start_rate: [0, 30], periodic: true}}
mass: {p: {p: J}}
force: {p: T - c * p'}
contacts:
  g: {normal: load, sliding: r * sin(p) * p', friction: {coulomb: {coefficient: 0.3}}}
  h: {normal: load, sliding: r * cos(p) * p', friction: {coulomb: {coefficient: 0.3}}}
outputs: {loss: c * p'^2}";
    for outcome in by_both(system, 4, 60.0) {
        let Evidence::ClosedOrbit(orbit) = &outcome.evidence else { panic!("{outcome:?}") };
        assert_eq!(orbit.cycle.as_ref().expect("a cycle").turns, [1, 1]);
        assert_work(&outcome, 2, TAU * 20.0 - 8.0 * 0.3 * 60.0 * 0.05);
    }
}

/// A van der Pol oscillator with `μ = 1`, whose period is known, pushes a cart that drifts on. Nothing depends on where the cart is.
#[test]
fn a_position_that_occurs_in_no_equation_need_not_return() {
    let system = "coordinates: {x: {start: [0.5, 1]}, y: {start: 0}}
mass: {x: {x: 1}, y: {y: 1}}
force: {x: (1 - x^2) * x' - x, y: 0.5 * (0.3 - y') + x}";
    for outcome in by_both(system, 2, 200.0) {
        let Evidence::ClosedOrbit(orbit) = &outcome.evidence else { panic!("{outcome:?}") };
        assert_eq!(orbit.cycle.as_ref().expect("a cycle").neutral_directions, 1);
        assert!((orbit.period_s - 6.663_286_859_323).abs() < 1e-6, "{}", orbit.period_s);
        let creep = outcome.outputs[1].value(OutputValue::Creep).expect("a displacement");
        assert!((creep - 0.3 * orbit.period_s).abs() < 1e-5, "{creep}");
    }
}

/// A rotor with a brake turns beside a pendulum that may go round, but hangs.
#[test]
fn a_braked_rotor_turns_beside_a_pendulum() {
    let system = "coordinates: {p: {start: 0.3, start_rate: 2, periodic: true}, q: {start: 0.5, periodic: true}}
mass: {p: {p: 1}, q: {q: 1}}
force: {p: 1.5 - 0.5 * p' + 0.3 * sin(p), q: -sin(q) - 0.3 * q'}
contacts: {brake: {normal: 1, sliding: p', friction: {coulomb: {coefficient: 0.2}}}}
outputs: {loss: 0.5 * p'^2}";
    for outcome in by_both(system, 1, 600.0) {
        assert_work(&outcome, 4, TAU * (1.5 - 0.2));
    }
}
