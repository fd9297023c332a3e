//! Forces that nothing announces: pulses, brakes that are applied, walls in a potential, and friction near rest. They are far below
//! rounding before they begin, and a step must not jump over them. Also sliding speeds that vanish while the machine moves.

use stickslip::classification::{Outcome, simulate};
use stickslip::model::Method;

use super::outputs::cases;

/// Returns the outcomes of the only run of a system, by both methods.
fn by_both(system: &str, end_time_s: f64) -> [Outcome; 2] {
    [Method::Switch, Method::Event].map(|method| {
        let [case] = &mut cases(system, 1, end_time_s)[..] else { panic!("one run") };
        case.simulation.method = method;
        simulate(case)
    })
}

#[track_caller]
fn assert_near(found: f64, expected: f64, accuracy: f64) {
    let near = (found - expected).abs() <= accuracy * (1.0 + expected.abs());
    assert!(near, "{found} is not {expected}");
}

/// A pulse `exp(-((t - t_0) / w)²)` far after the start gives a cart the speed `p w sqrt(π) / m`.
#[test]
fn a_pulse_pushes_a_cart() {
    for (begins, width) in [(1.0, 0.05), (1.0, 0.02), (2.0, 0.1), (5.0, 0.1), (7.0, 0.002)] {
        let system = format!(
            "parameters: {{m: 2 kg, p: 10 N, begins: {begins} s, width: {width} s}}
coordinates: {{x: {{unit: m}}}}
mass: {{x: {{x: m}}}}
force: {{x: p * exp(-((t - begins) / width)^2)}}"
        );
        for outcome in by_both(&system, 10.0) {
            let speed = 5.0 * width * std::f64::consts::PI.sqrt();
            assert_near(outcome.outputs[1].end, speed, 1e-7);
            // Nothing changes the speed after the pulse, and the run may end.
            let end = outcome.end_time_s.expect("it ends");
            assert_near(outcome.outputs[0].end, speed * (end - begins), 1e-7);
        }
    }
}

/// A force `p (1 + tanh((t - t_0) / w)) / 2` moves a block that friction holds: it breaks away where the force exceeds friction.
#[test]
fn a_force_that_is_switched_on_breaks_a_block_away() {
    // The exponential function of the width in the distance overflows.
    let [m, g, mu, p, begins, width] = [1.5_f64, 9.81, 0.2, 20.0, 3.0, 0.001];
    let system = format!(
        "parameters: {{m: {m} kg, p: {p} N, begins: {begins} s, width: {width} s, g: {g} m/s^2, mu: {mu}}}
coordinates: {{x: {{unit: m}}}}
mass: {{x: {{x: m}}}}
force: {{x: p * (1 + tanh((t - begins) / width)) / 2}}
contacts: {{ground: {{normal: m * g, sliding: x', friction: {{coulomb: {{coefficient: mu}}}}}}}}"
    );
    let breaks_away = (2.0 * mu * m * g / p - 1.0).atanh();
    let end = (5.0 - begins) / width;
    // The integral of (1 + tanh u) / 2.
    let integral = |u: f64| 0.5 * (u + u.abs() + (0.5 + 0.5 * (-2.0 * u.abs()).exp()).ln());
    let force = p / m * width * (integral(end) - integral(breaks_away));
    let speed = force - mu * g * width * (end - breaks_away);
    for outcome in by_both(&system, 5.0) {
        assert_near(outcome.outputs[1].end, speed, 1e-7);
    }
}

/// A force without a period that grows and turns about: a block that sticks has no speed that would show it.
#[test]
fn a_force_over_time_breaks_a_block_away() {
    let system = "parameters: {m: 1 kg, p: 1 N/s, w: 40 rad/s, load: 10 N, mu: 0.5}
coordinates: {x: {unit: m}}
mass: {x: {x: m}}
force: {x: p * t * sin(w * t)}
contacts: {ground: {normal: load, sliding: x', friction: {coulomb: {coefficient: mu}}}}";
    let force = |t: f64| t * (40.0 * t).sin();
    let first = (0..).map(|step| f64::from(step) * 1e-6).find(|t| force(*t).abs() > 5.0);
    let first = first.expect("the force grows");
    for (end, moves) in [(first - 1e-5, false), (first + 1e-3, true)] {
        for outcome in by_both(system, end) {
            assert_eq!(outcome.outputs[1].end.abs() > 1e-8, moves, "at {end} s: {outcome:?}");
        }
    }
}

/// A brake that is applied after a while: the normal force, which no velocity shows before, stops a rotor.
#[test]
fn a_brake_is_applied() {
    let system = "parameters: {j: 0.1 kg m^2, r: 0.1 m, load: 50 N, mu: 0.4, begins: 1 s, width: 30 ms}
coordinates: {phi: {unit: rad, start_rate: 50 rad/s}}
mass: {phi: {phi: j}}
contacts: {brake: {normal: load * (1.0001 + tanh((t - begins) / width)) / 2, sliding: r * phi', friction: {coulomb: {coefficient: mu}}}}";
    let [load, width] = [50.0, 0.03];
    let integral = |u: f64| 0.5 * (u + u.abs() + (0.5 + 0.5 * (-2.0 * u.abs()).exp()).ln());
    let impulse = load * (0.00005 * 3.0 + width * (integral(2.0 / width) - integral(-1.0 / width)));
    for outcome in by_both(system, 3.0) {
        assert_near(outcome.outputs[1].end, 50.0 - 0.4 * 0.1 / 0.1 * impulse, 1e-7);
    }
}

/// A narrow hill in a potential reflects a cart with too little energy for it.
#[test]
fn a_hill_reflects_a_cart() {
    let system = "parameters: {m: 1 kg, e: 2 J, at: 3 m, width: 0.1 m}
coordinates: {x: {unit: m, start_rate: 1 m/s}}
mass: {x: {x: m}}
force: {x: 2 * e * (x - at) / width^2 * exp(-((x - at) / width)^2)}";
    for outcome in by_both(system, 10.0) {
        assert_near(outcome.outputs[1].end, -1.0, 1e-7);
    }
}

/// A block with Stribeck friction over a speed far below its own stops after `v_s / (μ g) ln((μ exp(v / v_s) + μ_s - μ) / μ_s)`.
#[test]
fn stribeck_friction_acts_near_rest() {
    for (start, over) in [(10.0_f64, 0.1), (5.0, 0.01), (1.0, 0.001)] {
        let system = format!(
            "parameters: {{m: 1 kg, g: 10 m/s^2, mu: 0.2, more: 0.4, over: {over} m/s}}
coordinates: {{x: {{unit: m, start_rate: {start} m/s}}}}
mass: {{x: {{x: m}}}}
contacts: {{ground: {{normal: m * g, sliding: x', friction: {{stribeck: {{coefficient: mu, static_coefficient: more, stribeck_speed: over}}}}}}}}"
        );
        let time = (start + over * f64::ln(0.5 * (1.0 + (-start / over).exp()))) / 2.0;
        for outcome in by_both(&system, 8.0) {
            assert_near(outcome.time_to_rest_s().expect("it stops"), time, 1e-6);
        }
    }
}

/// A Scotch yoke with friction `μ F r |sin φ|` passes its dead centres, where its sliding speed is zero, until its energy is used up;
/// with a given force and with one that a gap needs.
#[test]
fn a_yoke_passes_its_dead_centres() {
    let [start, energy, work] = [0.5_f64, 5.0, 0.5];
    let left = energy / work - (1.0 + start.cos());
    let halves = (left / 2.0).floor();
    let expected = std::f64::consts::PI * (1.0 + halves) + (1.0 - (left - 2.0 * halves)).acos();
    for (more, mass, contact) in
        [("", "", "normal: load"), (", y: {unit: m}", ", y: {y: m}", "gap: y")]
    {
        let force = if more.is_empty() { "" } else { "force: {y: -load}\n" };
        let system = format!(
            "parameters: {{j: 0.1 kg m^2, r: 0.1 m, load: 10 N, mu: 0.5, m: 1 kg}}
coordinates: {{phi: {{unit: rad, start: {start}, start_rate: 10 rad/s}}{more}}}
mass: {{phi: {{phi: j}}{mass}}}
{force}contacts: {{slide: {{{contact}, sliding: r * sin(phi) * phi', friction: {{coulomb: {{coefficient: mu}}}}}}}}"
        );
        for outcome in by_both(&system, 30.0) {
            assert_near(outcome.outputs[0].end, expected, 1e-6);
            assert_eq!(outcome.evidence.name(), "rest_certified", "{outcome:?}");
        }
    }
}

/// A force that decays moves a block, which friction stops, and friction holds a block against half of it: both are certainly at rest,
/// although the equations contain the time.
#[test]
fn a_block_rests_after_a_force_that_decays() {
    let [m, p, tau, friction] = [2.0_f64, 20.0, 0.7, 8.0];
    let system = |p: f64| {
        format!(
            "parameters: {{m: {m} kg, p: {p} N, tau: {tau} s, load: {friction} N}}
coordinates: {{x: {{unit: m}}}}
mass: {{x: {{x: m}}}}
force: {{x: p * exp(-t / tau)}}
contacts: {{ground: {{normal: load, sliding: x', friction: {{coulomb: {{coefficient: 1}}}}}}}}"
        )
    };
    // m x' = p tau (1 - exp(-t / tau)) - friction t vanishes.
    let impulse = |t: f64| p * tau * (1.0 - (-t / tau).exp()) - friction * t;
    let (mut low, mut high) = (0.5, 10.0);
    while high - low > 1e-14 {
        let middle = 0.5 * (low + high);
        if impulse(middle) > 0.0 { low = middle } else { high = middle }
    }
    let place = p * tau * (low - tau * (1.0 - (-low / tau).exp())) - 0.5 * friction * low * low;
    for outcome in by_both(&system(p), 100.0) {
        assert_eq!(outcome.evidence.name(), "rest_certified", "{outcome:?}");
        assert_near(outcome.outputs[0].end, place / m, 1e-6);
        assert_near(outcome.time_to_rest_s().unwrap_or(f64::NAN), low, 1e-6);
        // From its last stage on no force acts.
        assert_near(outcome.evidence.friction_margin().unwrap_or(f64::NAN), 1.0, 1e-12);
    }
    for outcome in by_both(&system(0.5 * friction), 100.0) {
        assert_eq!(outcome.evidence.name(), "rest_certified", "{outcome:?}");
        assert_eq!((outcome.outputs[0].end, outcome.effort.switches), (0.0, 0));
    }
    // A ramp never ends, and a force that alternates has no period without the key.
    for force in ["p * t / tau", "p * sin(t / tau)"] {
        for outcome in by_both(&system(1.0).replace("p * exp(-t / tau)", force), 5.0) {
            assert_eq!(outcome.evidence.name(), "end_time", "{outcome:?}");
        }
    }
}
