//! Outputs of systems in files against closed forms, rests of relative motion, and masses that are not positive.

use stickslip::classification::{Label, Outcome, simulate};
use stickslip::model::{Case, OutputValue};

use crate::support::{METHODS, cases_of, parse};

/// Returns the outcomes of the runs of a system.
pub(super) fn outcomes(system: &str, samples: usize, end_time_s: f64) -> Vec<Outcome> {
    cases(system, samples, end_time_s).iter().map(simulate).collect()
}

/// Returns the runs of a system.
pub fn cases(system: &str, samples: usize, end_time_s: f64) -> Vec<Case> {
    cases_of(&parse(format!(
        "schema: 1\nname: a\nseed: 7\nmodel:\n  system:\n    system: a\n    {}\n\
         initial_conditions: {{design: {{monte_carlo: {{samples: {samples}}}}}}}\n\
         simulation: {{end_time_s: {end_time_s}}}\n",
        system.trim().replace('\n', "\n    ")
    )))
}

#[track_caller]
fn assert_values(outcome: &Outcome, output: usize, expected: &[(OutputValue, f64)]) {
    for (value, expected) in expected {
        let found = outcome.outputs[output].value(*value).unwrap_or(f64::NAN);
        let near = (found - expected).abs() <= 1e-6 * (1.0 + expected.abs());
        assert!(near, "output {output}, {value:?}: {found} is not {expected}\n{outcome:?}");
    }
}

/// A mass on a spring and a damper that a force shakes: the force on the ground, the power of the damper, and a coordinate
/// without a contact that a constant load holds.
#[test]
fn outputs_of_a_forced_vibration_have_their_closed_forms() {
    let [m, c, k, p, omega] = [1.5_f64, 0.4, 6.0, 3.0, 2.5];
    let with = |contacts: &str| {
        format!(
        "parameters: {{m: {m} kg, c: {c} N s/m, k: {k} N/m, p: {p} N, omega: {omega} rad/s, load: 6 N}}
coordinates: {{x: {{unit: m, start: [-1, 1]}}, y: {{unit: m, start: [-1, 1]}}}}
mass: {{x: {{x: m}}, y: {{y: m}}}}
force: {{x: -k * x - c * x' + p * cos(omega * t), y: load - k * y - 4 * c * y'}}
{contacts}outputs:
  ground_force: k * x + c * x'
  power: {{value: \"c * x'^2\", meaning: power of the damper}}
period: 2 * pi / omega"
    )
    };
    let x = p / ((k - m * omega * omega).powi(2) + (c * omega).powi(2)).sqrt();
    let force = x * (k * k + (c * omega).powi(2)).sqrt();
    let power = c * (omega * x).powi(2);
    use OutputValue::{Amplitude, Greatest, Least, Mean};
    // A contact without friction has no effect.
    let both = ["contacts: {ground: {normal: load, sliding: x'}}\n", ""];
    for outcome in both.into_iter().flat_map(|contacts| outcomes(&with(contacts), 3, 400.0)) {
        assert_eq!(outcome.evidence.name(), "closed_orbit", "{outcome:?}");
        let period = std::f64::consts::TAU / omega;
        assert!(
            (outcome.evidence.period_s().unwrap_or_default() - period).abs() < 1e-9,
            "{outcome:?}"
        );
        assert_values(&outcome, 0, &[(Amplitude, x), (Mean, 0.0)]);
        assert_values(&outcome, 1, &[(Least, 1.0), (Greatest, 1.0), (Mean, 1.0)]);
        assert_values(&outcome, 2, &[(Amplitude, omega * x), (Mean, 0.0)]);
        assert_values(&outcome, 4, &[(Least, -force), (Greatest, force), (Mean, 0.0)]);
        assert_values(&outcome, 5, &[(Least, 0.0), (Greatest, power), (Mean, 0.5 * power)]);
        assert!((outcome.amplitude_m.expect("a length") - x).abs() < 1e-6 * x);
    }
}

/// Two carts rest on each other while their springs still swing: the contact sticks on a relative coordinate. At rest, outputs
/// are those of the rest point, not of the instant at which the rest was certified.
#[test]
fn carts_that_stick_to_each_other_come_to_rest() {
    let system = "parameters: {m: 1 kg, k: 100 N/m, c: 4 N s/m, load: 10 N, mu: 0.3}
coordinates:
  a: {unit: m, start: [-0.1, 0.1], start_rate: [-1, 1]}
  b: {unit: m, start: [-0.1, 0.1], start_rate: [-1, 1]}
mass: {a: {a: m}, b: {b: 2 * m}}
force: {a: -k * a - c * a'}
contacts: {between: {normal: load, sliding: b' - a', friction: {coulomb: {coefficient: mu}}}}
outputs: {apart: b - a}";
    for outcome in outcomes(system, 16, 30.0) {
        assert_eq!(outcome.evidence.name(), "rest_certified", "{outcome:?}");
        let apart = outcome.outputs[4].end;
        assert_values(&outcome, 0, &[(OutputValue::Mean, 0.0)]);
        assert_values(&outcome, 1, &[(OutputValue::Mean, apart)]);
        assert!(outcome.outputs[0].end.abs() > 1e-6, "certified before it has decayed");
        assert_eq!(outcome.amplitude_m, Some(0.0));
    }
}

/// A wheel rolls on without slip: its angle and its place drift at the speed of rolling, which momentum gives.
#[test]
fn a_wheel_that_rolls_on_drifts() {
    let system = "parameters: {m: 1 kg, j: 0.005 kg m^2, g: 9.81 m/s^2, mu: 0.3, r: 0.1 m}
coordinates:
  x: {unit: m, start_rate: [1, 2]}
  phi: {unit: rad, start_rate: [-1, 1]}
mass: {x: {x: m}, phi: {phi: j}}
contacts: {ground: {normal: m * g, sliding: x' - r * phi', friction: {coulomb: {coefficient: mu}}}}
outputs: {momentum: m * r * x' + j * phi'}";
    for outcome in outcomes(system, 4, 20.0) {
        // Friction acts at the distance r: r m x' + j phi' is conserved, and x' = r phi' in the end.
        let momentum = outcome.outputs[4].end;
        let speed = momentum / (0.1 + 0.005 / 0.1);
        assert_values(&outcome, 2, &[(OutputValue::Mean, speed)]);
        assert_values(&outcome, 3, &[(OutputValue::Mean, speed / 0.1)]);
        assert_values(&outcome, 4, &[(OutputValue::Greatest, momentum)]);
    }
}

/// A mass that is not positive in the state of a run is a failure with this reason, also where it would stick for ever.
#[test]
fn a_mass_that_is_not_positive_is_a_failure() {
    let system = "coordinates: {x: {start: [-2, 2], start_rate: [-1, 1]}}
mass: {x: {x: 1 - x^2}}
force: {x: -x - 0.1 * x'}
contacts: {ground: {normal: 1, sliding: x', friction: {coulomb: {coefficient: 0.2}}}}";
    let (mut failed, mut rests) = (0, 0);
    for outcome in outcomes(system, 60, 50.0) {
        let x = outcome.position.as_ref().map(|position| position[0]);
        match outcome.label() {
            Label::Failed => {
                assert_eq!(outcome.evidence.name(), "indefinite_mass", "{outcome:?}");
                failed += 1;
            }
            label => {
                assert_eq!(label, Label::Equilibrium, "{outcome:?}");
                assert!(x.is_some_and(|x| x.abs() < 1.0), "{outcome:?}");
                rests += 1;
            }
        }
    }
    assert!(failed > 20 && rests > 20, "{failed} {rests}");
}

/// Neighbours of a motion that grows without bound separate, which is no irregular motion.
#[test]
fn a_motion_that_grows_is_not_irregular() {
    let system = "coordinates: {x: {start: [-1, 1]}, y: {start: [-1, 1]}}
mass: {x: {x: 1}, y: {y: 1}}
force: {x: -2 * x - 0.8 * y + 0.02 * x', y: 0.8 * x - 2.1 * y}
contacts: {ground: {normal: 0.01, sliding: x', friction: {coulomb: {coefficient: 0.1}}}}";
    for outcome in outcomes(system, 3, 300.0) {
        assert_eq!(outcome.evidence.name(), "end_time", "{outcome:?}");
        assert!(outcome.lyapunov.expect("it moves").exponent_1_s > 0.1, "{outcome:?}");
    }
}

/// A ball bounces ever lower, and comes to rest when the geometric series of its flights ends.
#[test]
fn a_ball_comes_to_rest_after_infinitely_many_impacts() {
    let (g, e) = (9.81_f64, 0.8);
    let system = "parameters: {m: 0.1 kg, g: 9.81 m/s^2, e: 0.8}
coordinates: {h: {unit: m, start: [0.1, 1], start_rate: 0.5}}
mass: {h: {h: m}}
force: {h: -m * g}
contacts: {floor: {gap: h, restitution: e}}
outputs: {height: h}";
    for case in cases(system, 12, 30.0) {
        let (outcome, height) = (simulate(&case), case.start.0[0]);
        assert_eq!(outcome.evidence.name(), "settled", "{outcome:?}");
        assert_values(&outcome, 2, &[(OutputValue::Greatest, 0.0)]);
        let impact = (0.25 + 2.0 * g * height).sqrt();
        let time_s = (0.5 + impact) / g + 2.0 * impact * e / (g * (1.0 - e));
        let found = outcome.time_to_rest_s().expect("at rest");
        // Contact lasts when the ball hits the ground at less than 1e-5 of the unit of speed.
        assert!((found - time_s).abs() < 1e-4, "{found} {time_s}");
    }
}

/// A bead falls into a bowl and slides on it until friction holds it, where the slope is at most the coefficient. The normal force is
/// that on the gap, which is the vertical distance.
#[test]
fn a_bead_stops_where_the_slope_of_a_bowl_is_small() {
    let system = "parameters: {m: 1 kg, g: 9.81 m/s^2, mu: 0.2, a: 1.0 1/m}
coordinates:
  x: {unit: m, start: [-0.5, 0.5]}
  y: {unit: m, start: [0.3, 0.4]}
mass: {x: {x: m}, y: {y: m}}
force: {y: -m * g}
contacts:
  bowl:
    gap: y - a * x^2
    sliding: (x' + 2 * a * x * y') / sqrt(1 + 4 * a^2 * x^2)
    friction: {coulomb: {coefficient: mu}}";
    for outcome in outcomes(system, 12, 10.0) {
        assert_eq!(outcome.evidence.name(), "rest_certified", "{outcome:?}");
        let x = outcome.outputs[0].end;
        let margin = 1.0 - (2.0 * x).abs() * (2.0 * x).hypot(1.0) / 0.2;
        let found = outcome.evidence.friction_margin().expect("the bead sticks");
        assert!((found - margin).abs() < 1e-9, "{found} {margin} {x}");
        assert_values(&outcome, 1, &[(OutputValue::Mean, x * x)]);
        assert_values(&outcome, 2, &[(OutputValue::Least, 0.0), (OutputValue::Greatest, 0.0)]);
    }
}

/// The extremes of a speed contain that just before an impact: a hammer leaves its anvil with `e` times the speed at which it hits it.
#[test]
fn a_hammer_is_fastest_where_it_hits() {
    let system = "parameters: {m: 2, k: 800, p: 100, w: 25, e: 0.6}
coordinates: {x: {start: [-0.02, 0.015], start_rate: [-1, 1]}}
mass: {x: {x: m}}
force: {x: -k * x - 2 * x' + p * sin(w * t)}
contacts:
  guide: {normal: 10, sliding: x', friction: {coulomb: {coefficient: 0.3}}}
  anvil: {gap: 0.02 - x, restitution: e}
period: 2 * pi / w";
    for method in METHODS {
        for mut case in cases(system, 3, 60.0) {
            case.simulation.method = method;
            let outcome = simulate(&case);
            let [least, greatest] = [OutputValue::Least, OutputValue::Greatest]
                .map(|value| outcome.outputs[1].value(value).expect("a cycle has extremes"));
            assert!((least + 0.6 * greatest).abs() < 1e-4 * greatest, "{least}, {greatest}");
        }
    }
}
