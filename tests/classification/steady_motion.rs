//! Systems whose equations contain only differences of positions, or of a position and the time: they turn or slide on and on, steadily
//! or in stick and slip.

use stickslip::classification::{ClosedOrbit, Evidence, Outcome, simulate};
use stickslip::model::{Method, OutputValue};

use super::outputs::cases;

/// Returns the outcomes of all runs of a system.
fn runs(system: &str, samples: usize, end_time_s: f64, method: Method) -> Vec<Outcome> {
    let with = |mut case: stickslip::model::Case| {
        case.simulation.method = method;
        simulate(&case)
    };
    cases(system, samples, end_time_s).into_iter().map(with).collect()
}

/// Returns period and multipliers of a limit cycle.
#[track_caller]
fn cycle(outcome: &Outcome) -> (f64, Vec<f64>) {
    let Evidence::ClosedOrbit(ClosedOrbit { period_s, cycle: Some(cycle), .. }) = &outcome.evidence
    else {
        panic!("{outcome:?}")
    };
    (*period_s, cycle.multipliers.clone())
}

/// Asserts that a run has settled on a motion in which all coordinates drift at these rates.
#[track_caller]
fn assert_steady(outcome: &Outcome, rates: &[f64]) {
    assert!(matches!(outcome.evidence, Evidence::Settled(_)), "{outcome:?}");
    let mean = |number: usize| outcome.outputs[number].value(OutputValue::Mean);
    for (number, rate) in rates.iter().enumerate() {
        assert_eq!(mean(number), None, "it drifts");
        let found = mean(rates.len() + number).expect("it has a rate");
        assert!((found - rate).abs() < 1e-7 * rate.abs(), "{found} is not {rate}");
    }
}

const PULLED: &str = "parameters: {m: 1 kg, k: 100 N/m, c: 1 N s/m, v: 0.1 m/s, load: 10 N, mu: 0.2, mu_stick: 0.4, v_fall: 0.1 m/s}";
const LAW: &str =
    "{stribeck: {coefficient: mu, static_coefficient: mu_stick, stribeck_speed: v_fall}}";

/// A block that a spring pulls over a table at a constant speed, in its position and in the extension of the spring, which contains no
/// time. Both have the same periods and multipliers. At a high speed, the block slides steadily.
#[test]
fn a_spring_pulls_a_block() {
    for (speed, slips) in [(0.02, true), (0.1, true), (2.0, false)] {
        let parameters = PULLED.replace("v: 0.1", &format!("v: {speed}"));
        let in_position = format!(
            "{parameters}
coordinates: {{x: {{unit: m, start: 0, start_rate: [0, 0.2]}}}}
mass: {{x: {{x: m}}}}
force: {{x: \"k * (v * t - x) + c * (v - x')\"}}
contacts: {{table: {{normal: load, sliding: x', friction: {LAW}}}}}"
        );
        let in_extension = format!(
            "{parameters}
coordinates: {{e: {{unit: m, start: 0, start_rate: [{}, {speed}]}}}}
mass: {{e: {{e: m}}}}
force: {{e: -k * e - c * e'}}
contacts: {{table: {{normal: load, sliding: e' - v, friction: {LAW}}}}}",
            speed - 0.2
        );
        for method in [Method::Switch, Method::Event] {
            let found = runs(&in_position, 3, 100.0, method);
            for (outcome, expected) in found.iter().zip(runs(&in_extension, 3, 100.0, method)) {
                if !slips {
                    assert_steady(outcome, &[speed]);
                    assert!(matches!(expected.evidence, Evidence::Settled(_)), "{expected:?}");
                    continue;
                }
                let [(period, multipliers), (known, _)] = [outcome, &expected].map(cycle);
                assert!((period - known).abs() < 1e-8 * known, "{period} is not {known}");
                assert!(multipliers.iter().all(|multiplier| *multiplier < 1e-4), "{multipliers:?}");
                let mean = outcome.outputs[1].value(OutputValue::Mean).expect("it moves on");
                assert!((mean - speed).abs() < 1e-8 * speed, "{mean} is not {speed}");
            }
        }
    }
}

/// A spring whose end hardly moves loads a block, which does not move yet: this is no equilibrium.
#[test]
fn a_block_that_is_loaded_slowly_is_not_at_rest() {
    for speed in ["1e-5", "1e-8", "1e-12"] {
        let system = format!(
            "{}
coordinates: {{x: {{unit: m, start: 0, start_rate: [0.1, 0.2]}}}}
mass: {{x: {{x: m}}}}
force: {{x: k * (v * t - x) - c * x'}}
contacts: {{table: {{normal: load, sliding: x', friction: {LAW}}}}}",
            PULLED.replace("v: 0.1 ", &format!("v: {speed} "))
        );
        for method in [Method::Switch, Method::Event] {
            for outcome in runs(&system, 2, 1000.0, method) {
                assert_eq!(outcome.evidence, Evidence::EndTime, "{outcome:?}");
            }
        }
    }
}

/// A block that is loaded slowly sets off one day, also beside another block that sticks and slips on a belt.
#[test]
fn a_block_that_is_loaded_slowly_does_not_return() {
    let system = format!(
        "{}
coordinates: {{x: {{unit: m, start: 0}}, y: {{unit: m, start: [0, 0.05]}}}}
mass: {{x: {{x: m}}, y: {{y: m}}}}
force: {{x: k * (v * t - x), y: -k * y - c * y'}}
contacts: {{table: {{normal: load, sliding: x', friction: {LAW}}}, belt: {{normal: load, sliding: y' - 0.2, friction: {LAW}}}}}",
        PULLED.replace("v: 0.1 ", "v: 1e-4 ")
    )
    .replace("y' - 0.2", "y' - u")
    .replace("mu: 0.2", "u: 0.2 m/s, mu: 0.2");
    for outcome in runs(&system, 2, 60.0, Method::Event) {
        assert_eq!(outcome.evidence, Evidence::EndTime, "{outcome:?}");
    }
}

/// A block rests on the ground; a spring, which contains the distance alone, connects it with a mass on a belt or with one that a force
/// shakes. The ground fixes the place of both, in any order of the file.
#[test]
fn a_block_that_rests_holds_what_hangs_on_it() {
    let parameters = "parameters: {m: 1 kg, k: 100 N/m, c: 2 N s/m, v: 1 m/s, held: 1000 N, load: 10 N, mu: 0.2, p: 3 N, omega: 6 rad/s}";
    let [a, b] = ["a: {unit: m, start: 0}", "b: {unit: m, start: [0.03, 0.05]}"];
    for coordinates in [[a, b], [b, a]] {
        let coordinates = coordinates.join(", ");
        let on_belt = format!(
            "{parameters}
coordinates: {{{coordinates}}}
mass: {{a: {{a: m}}, b: {{b: m}}}}
force: {{a: k * (b - a), b: -k * (b - a)}}
contacts: {{ground: {{normal: held, sliding: a', friction: {{coulomb: {{coefficient: mu}}}}}}, belt: {{normal: load, sliding: b' - v, friction: {{coulomb: {{coefficient: mu}}}}}}}}"
        );
        // Without damping, the oscillation of `b` keeps its size.
        for outcome in runs(&on_belt, 2, 60.0, Method::Event) {
            assert_eq!(outcome.evidence.name(), "repeats", "{outcome:?}");
        }
        let shaken = format!(
            "{parameters}
coordinates: {{{coordinates}}}
mass: {{a: {{a: m}}, b: {{b: m}}}}
force: {{a: k * (b - a) + c * (b' - a'), b: -k * (b - a) - c * (b' - a') + p * cos(omega * t)}}
contacts: {{ground: {{normal: held, sliding: a', friction: {{coulomb: {{coefficient: mu}}}}}}}}
period: 2 * pi / omega"
        );
        for outcome in runs(&shaken, 2, 60.0, Method::Event) {
            assert_eq!(outcome.evidence.name(), "periodic_rest", "{outcome:?}");
        }
    }
}

/// A ring carries a disc by a magnetic force, which is periodic in the angle between them, against friction and drag; the damping contains
/// `sqrt(1 - d^2)`, which is a number for the parameters of the file alone.
#[test]
fn a_magnet_carries_a_disc() {
    for periodic in ["", ", periodic: true"] {
        let system = format!(
            "parameters: {{j: 1 kg m^2, k: 30 N m, torque: 10 N m, drag: 1 N m s, load: 20 N m, mu: 0.3, d: 0.6}}
coordinates: {{theta: {{unit: rad, start: 0, start_rate: 2{periodic}}}, phi: {{unit: rad, start: 0, start_rate: 2{periodic}}}}}
mass: {{theta: {{theta: j}}, phi: {{phi: j}}}}
force: {{theta: torque - k * sin(theta - phi) - d * sqrt(1 - d^2) * drag * theta', phi: k * sin(theta - phi) - drag * phi'}}
contacts: {{pads: {{normal: load, sliding: phi', friction: {{coulomb: {{coefficient: mu}}}}}}}}"
        );
        for outcome in runs(&system, 2, 200.0, Method::Event) {
            let speed = (10.0 - 6.0) / (1.0 + 0.48);
            if periodic.is_empty() {
                assert_steady(&outcome, &[speed, speed]);
            } else {
                let mean = outcome.outputs[3].value(OutputValue::Mean).expect("a mean");
                assert!((mean - speed).abs() < 1e-5, "{outcome:?}");
            }
        }
    }
}

/// A drill string with a motor at its top, in the angles of both discs, and in the angle of the bit and the twist. Both have the same
/// limit cycle; the steady speed follows from the balance of the motor's torque with damping and friction.
#[test]
fn a_drill_string_turns_on() {
    let parameters = |torque: f64| {
        format!(
            "parameters: {{j_1: 2100 kg m^2, j_2: 370 kg m^2, k: 470 N m/rad, c: 20 N m s, c_1: 425 N m s, torque: {torque} N m, load: 3000 N m, mu: 0.4, mu_stick: 0.8, w_fall: 1 rad/s}}"
        )
    };
    let law = LAW.replace("v_fall", "w_fall");
    let in_angles = |torque: f64| {
        format!(
            "{}
coordinates: {{top: {{unit: rad, start: [0, 100], start_rate: 3}}, bit: {{unit: rad, start: [0, 100], start_rate: 1}}}}
mass: {{top: {{top: j_1}}, bit: {{bit: j_2}}}}
force: {{top: torque - c_1 * top' - k * (top - bit) - c * (top' - bit'), bit: k * (top - bit) + c * (top' - bit')}}
contacts: {{rock: {{normal: load, sliding: bit', friction: {law}}}}}",
            parameters(torque)
        )
    };
    let with_twist = |torque: f64| {
        format!(
            "{}
coordinates: {{bit: {{unit: rad, start: 0, start_rate: 1}}, twist: {{unit: rad, start: [0, 5], start_rate: 2}}}}
mass: {{bit: {{bit: j_1 + j_2, twist: j_1}}, twist: {{twist: j_1}}}}
force: {{bit: torque - c_1 * (bit' + twist'), twist: torque - c_1 * (bit' + twist') - k * twist - c * twist'}}
contacts: {{rock: {{normal: load, sliding: bit', friction: {law}}}}}",
            parameters(torque)
        )
    };
    let expected = runs(&with_twist(2800.0), 2, 400.0, Method::Event);
    let (known, _) = cycle(&expected[0]);
    for method in [Method::Switch, Method::Event] {
        for outcome in runs(&in_angles(2800.0), 2, 400.0, method) {
            let (period, multipliers) = cycle(&outcome);
            let tolerance = if method == Method::Event { 1e-7 } else { 1e-4 };
            assert!((period - known).abs() < tolerance * known, "{period} is not {known}");
            // Angle and speed of the top and the twist are free on the section, but for one of them.
            assert!(multipliers.iter().all(|multiplier| *multiplier < 1.0), "{multipliers:?}");
        }
    }
    for torque in [6000.0, 10_000.0] {
        let balance = |speed: f64| {
            let coefficient = 0.4 + 0.4 * f64::exp(-speed);
            torque - 425.0 * speed - 3000.0 * coefficient
        };
        let (mut low, mut high) = (5.0, 50.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if balance(middle) > 0.0 { low = middle } else { high = middle }
        }
        for outcome in runs(&in_angles(torque), 2, 400.0, Method::Event) {
            assert_steady(&outcome, &[low, low]);
        }
    }
}

/// A motor drives a brake through an elastic gear: the motor turns three times as fast.
#[test]
fn a_gear_turns_on() {
    let system = "parameters: {j: 1 kg m^2, k: 200 N m, c: 2 N m s, torque: 10 N m, drag: 0.5 N m s, load: 20 N m, mu: 0.3, ratio: 3}
coordinates: {motor: {unit: rad, start: 0, start_rate: [0, 50]}, brake: {unit: rad, start: 0, start_rate: [1, 5]}}
mass: {motor: {motor: 0.1 * j}, brake: {brake: j}}
force: {motor: torque - drag * motor' - k / ratio * (motor / ratio - brake) - c / ratio * (motor' / ratio - brake'), brake: k * (motor / ratio - brake) + c * (motor' / ratio - brake')}
contacts: {pads: {normal: load, sliding: brake', friction: {coulomb: {coefficient: mu}}}}";
    for outcome in runs(system, 3, 200.0, Method::Switch) {
        // torque - drag * motor' = mu * load / ratio
        let speed = (10.0 - 6.0 / 3.0) / 0.5;
        assert_steady(&outcome, &[speed, speed / 3.0]);
    }
}

/// A motor drives, through a clutch that sticks and a spring, a tool that slides. The order of the coordinates does not matter.
#[test]
fn a_clutch_sticks_while_a_tool_slides() {
    let coordinate = |name: &str| match name {
        "mot" => "mot: {unit: rad, start: 0, start_rate: 5}".to_owned(),
        name => format!("{name}: {{unit: rad, start: 0}}"),
    };
    for order in [["mot", "cl", "tool"], ["cl", "mot", "tool"], ["tool", "cl", "mot"]] {
        let system = format!(
            "parameters: {{j1: 2 kg m^2, j2: 1 kg m^2, k: 400 N m, c: 2 N m s, torque: 30 N m, dm: 2 N m s, load: 100 N m, mu: 0.1, mc: 0.5}}
coordinates: {{{}}}
mass: {{mot: {{mot: j1}}, cl: {{cl: j2}}, tool: {{tool: j2}}}}
force: {{mot: torque - dm * mot', cl: k * (tool - cl) + c * (tool' - cl'), tool: k * (cl - tool) + c * (cl' - tool')}}
contacts: {{clutch: {{normal: load, sliding: mot' - cl', friction: {{coulomb: {{coefficient: mc}}}}}}, work: {{normal: load, sliding: tool', friction: {{coulomb: {{coefficient: mu}}}}}}}}",
            order.map(coordinate).join(", ")
        );
        for outcome in runs(&system, 1, 100.0, Method::Event) {
            assert_steady(&outcome, &[(30.0 - 10.0) / 2.0; 3]);
        }
    }
}

/// A clutch locks two discs, and nothing brakes them: their common speed follows from their angular momentum, and nothing changes it.
#[test]
fn locked_discs_turn_on_without_drag() {
    let system = "parameters: {j_1: 0.4, j_2: 0.1, torque: 2}
coordinates:
  first: {unit: rad, start: 0, start_rate: [5, 50], periodic: true}
  second: {unit: rad, start: 0, start_rate: [-20, 20], periodic: true}
mass: {first: {first: j_1}, second: {second: j_2}}
contacts: {clutch: {normal: torque, sliding: first' - second', friction: {coulomb: {coefficient: 1}}}}";
    for method in [Method::Switch, Method::Event] {
        for (outcome, case) in runs(system, 6, 100.0, method).iter().zip(cases(system, 6, 100.0)) {
            let [_, _, first, second] = case.start.0[..] else { panic!("two discs") };
            let common = (0.4 * first + 0.1 * second) / 0.5;
            assert!(matches!(outcome.evidence, Evidence::Settled(_)), "{outcome:?}");
            for number in [2, 3] {
                let found = outcome.outputs[number].end;
                assert!((found - common).abs() < 1e-7 * common.abs(), "{found} is not {common}");
            }
        }
    }
}

/// The stem of a valve, which a controller with an integral moves against friction that does not fall: it slides ever more slowly towards
/// the place at which the controller has no error, while its force approaches the friction.
#[test]
fn a_controller_pushes_a_stem_to_the_edge_of_sticking() {
    let system = "parameters: {ki: 0.1}
coordinates:
  x: {start: [0.2, 0.8]}
  yint: {start: 0, start_rate: [-0.5, 0.5], rate: y}
mass: {x: {x: 1}, yint: {yint: 1}}
force:
  x: 100 * (-yint' - ki * yint - x) - 5 * x'
  yint: (2 * x - yint' - 1) / 5
contacts: {packing: {normal: 4, sliding: x', friction: {coulomb: {coefficient: 1}}}}";
    for method in [Method::Switch, Method::Event] {
        for outcome in runs(system, 6, 600.0, method) {
            assert!(matches!(outcome.evidence, Evidence::Creep(_)), "{outcome:?}");
            assert!((outcome.outputs[0].end - 0.5).abs() < 1e-6, "{outcome:?}");
        }
    }
}

/// A block is pulled over a table for too short a time to decide anything: how far it drifts in this time is no amplitude.
#[test]
fn the_drift_of_an_undecided_run_is_no_amplitude() {
    let system = |more: &str| {
        format!(
            "{PULLED}
coordinates: {{x: {{unit: m, start: 0, start_rate: [0, 0.2]}}{more}}}
mass: {{x: {{x: m}}{}}}
force: {{x: \"k * (v * t - x) + c * (v - x')\"{}}}
contacts: {{table: {{normal: load, sliding: x', friction: {LAW}}}}}",
            if more.is_empty() { "" } else { ", y: {y: m}" },
            if more.is_empty() { "" } else { ", y: -k * y" },
        )
    };
    let amplitudes = |more: &str| -> Vec<Option<f64>> {
        let found = runs(&system(more), 3, 1.5, Method::Event);
        assert!(found.iter().all(|outcome| outcome.evidence == Evidence::EndTime), "{found:?}");
        found.iter().map(|outcome| outcome.amplitude_m).collect()
    };
    assert_eq!(amplitudes(""), [None; 3]);
    // A part that vibrates has one.
    for amplitude in amplitudes(", y: {unit: m, start: 0.5}") {
        let amplitude = amplitude.expect("it vibrates");
        assert!((0.05..=0.5).contains(&amplitude), "{amplitude}");
    }
}

/// A wheel that a torque drives against a drag slips and then rolls, its contact stuck, at the speed `torque / (r drag)`.
#[test]
fn a_wheel_rolls_on() {
    let system = "parameters: {m: 100 kg, j: 2 kg m^2, r: 0.3 m, load: 1000 N, torque: 100 N m, drag: 30 N s/m, mu: 0.7}
coordinates: {x: {unit: m, start: 0, start_rate: [0, 20]}, phi: {unit: rad, start: 0, start_rate: [0, 80]}}
mass: {x: {x: m}, phi: {phi: j}}
force: {x: -drag * x', phi: torque}
contacts: {road: {normal: load, sliding: x' - r * phi', friction: {coulomb: {coefficient: mu}}}}";
    for method in [Method::Switch, Method::Event] {
        for outcome in runs(system, 3, 200.0, method) {
            let speed = 100.0 / (0.3 * 30.0);
            assert_steady(&outcome, &[speed, speed / 0.3]);
            let margin = outcome.evidence.friction_margin().expect("the road holds the wheel");
            let expected = 1.0 - 100.0 / 0.3 / 700.0;
            assert!((margin - expected).abs() < 1e-5, "{margin} is not {expected}");
        }
    }
}

/// A box that falls on a conveyor slips, and then rides on it.
#[test]
fn a_box_rides_on_a_conveyor() {
    let system = "parameters: {m: 2 kg, load: 20 N, v: 0.5 m/s, mu: 0.3}
coordinates: {x: {unit: m, start: 0, start_rate: [-1, 2]}}
mass: {x: {x: m}}
contacts: {belt: {normal: load, sliding: x' - v, friction: {coulomb: {coefficient: mu}}}}";
    for method in [Method::Switch, Method::Event] {
        for outcome in runs(system, 3, 50.0, method) {
            assert_steady(&outcome, &[0.5]);
            assert_eq!(outcome.evidence.friction_margin(), Some(1.0), "{outcome:?}");
        }
    }
}

/// A body that a drag slows down comes to rest at `x + x' m / d`, whatever the range of its start position is.
#[test]
fn a_body_that_coasts_stops_in_its_place() {
    let mut times = Vec::new();
    for range in ["[0, 1e-3]", "[0, 10]", "[0, 1e6]"] {
        let system = format!(
            "parameters: {{m: 2 kg, d: 4 N s/m}}
coordinates: {{x: {{unit: m, start: {range}, start_rate: [1, 10]}}}}
mass: {{x: {{x: m}}}}
force: {{x: -d * x'}}"
        );
        for (case, outcome) in cases(&system, 3, 100.0).iter().map(|case| (case, simulate(case))) {
            assert!(matches!(outcome.evidence, Evidence::Settled(_)), "{outcome:?}");
            let [position, speed] = case.start.0[..] else { panic!("{:?}", case.start) };
            let mean = outcome.outputs[0].value(OutputValue::Mean).expect("it stops");
            assert!((mean - position - speed * 2.0 / 4.0).abs() < 1e-4, "{mean} {:?}", case.start);
            times.push(outcome.time_to_rest_s());
        }
    }
    // Where it starts has no influence on when it is slow.
    assert!(times[0].is_some());
    assert_eq!([&times[..3], &times[..3]], [&times[3..6], &times[6..]]);
}

/// Forces whose factors vanish in the middle of the start ranges depend on the positions all the same: a small machine is as accurate as
/// a large one of its shape.
#[test]
fn small_machines_with_forces_that_vanish_in_the_middle_are_accurate() {
    let at_end = |size: f64| -> Vec<[f64; 2]> {
        let range = format!("start: [-{size}, {size}], start_rate: 0");
        let system = format!(
            "parameters: {{m: 1e-9 kg, k: 1e-3 N/m, d: 1e-8 N s/m, l: {size} m}}
coordinates: {{x: {{unit: m, {range}}}, y: {{unit: m, {range}}}}}
mass: {{x: {{x: m}}, y: {{y: m}}}}
force: {{x: -k * x * y^2 / l^2 - d * x', y: -k * y * x^2 / l^2 - d * y'}}"
        );
        let all = cases(&system, 4, 0.02).into_iter().map(|case| simulate(&case));
        all.map(|outcome| [0, 1].map(|number| outcome.outputs[number].end / size)).collect()
    };
    let (large, small) = (at_end(1.0), at_end(1e-6));
    for (large, small) in large.iter().flatten().zip(small.iter().flatten()) {
        assert!((large - small).abs() < 1e-6, "{large} {small}");
    }
}
