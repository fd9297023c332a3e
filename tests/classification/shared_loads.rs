//! Contacts with one sliding speed or multiples of one, such as two pads on a disc or the two feet of a box: they hold together what
//! one contact with the sum of their friction limits holds. Contacts with the ground and with a belt hold one after the other.

use stickslip::classification::{Outcome, simulate};
use stickslip::model::{Method, OutputValue};

use super::outputs::{cases, outcomes};

/// Returns the outcomes of a block of 2 kg on a spring and a belt, with these contacts.
fn pads(belt_speed: &str, contacts: &[&str]) -> Vec<Outcome> {
    let contacts: Vec<String> =
        contacts.iter().enumerate().map(|(place, pad)| format!("  pad_{place}: {pad}\n")).collect();
    let system = format!(
        "parameters: {{m: 2 kg, k: 200 N/m, n: 20 N, v: {belt_speed}}}\n\
         coordinates: {{x: {{unit: m, start: [-0.1, 0.1], start_rate: [-0.5, 0.5]}}}}\n\
         mass: {{x: {{x: m}}}}\nforce: {{x: -k * x}}\ncontacts:\n{}",
        contacts.concat()
    );
    outcomes(&system, 24, 10.0)
}

/// Three pads with a third of the load each, or with other shares, move as one pad, at rest and in a limit cycle.
#[test]
fn pads_share_the_load() {
    pads_move_as_one("0.5 m/s");
    // Between both sums of friction limits, a pad that has slid stops, and one that rests stays.
    pads_move_as_one("0 m/s");
}

fn pads_move_as_one(stribeck_speed: &str) {
    let friction = format!(
        "{{stribeck: {{coefficient: 0.2, static_coefficient: 0.3, stribeck_speed: {stribeck_speed}}}}}"
    );
    let pad = |share: &str| format!("{{normal: {share}, sliding: x' - v, friction: {friction}}}");
    for (belt_speed, evidence) in [("0 m/s", "rest_certified"), ("0.1 m/s", "closed_orbit")] {
        let alone = pads(belt_speed, &[&pad("n")]);
        let three = pads(belt_speed, &[&pad("n / 2"), &pad("n / 3"), &pad("n / 6")]);
        for (alone, three) in alone.iter().zip(&three) {
            assert_eq!(
                (alone.evidence.name(), three.evidence.name()),
                (evidence, evidence),
                "{three:?}"
            );
            let values = |outcome: &Outcome| {
                let output = outcome.outputs[0];
                let values = [OutputValue::End, OutputValue::Least, OutputValue::Greatest];
                let values = values.map(|value| output.value(value).expect("x does not drift"));
                let margin = outcome.evidence.friction_margin().unwrap_or_default();
                let [least, end, most] = values;
                [least, end, most, margin, outcome.evidence.period_s().unwrap_or_default()]
            };
            for (alone, three) in values(alone).into_iter().zip(values(three)) {
                assert!((alone - three).abs() < 1e-7, "{alone} {three}");
            }
        }
    }
}

/// A box on two feet comes to rest where its spring pulls with less than the friction of both feet, whatever each of them carries.
#[test]
fn a_box_rests_on_two_feet() {
    let foot = |side: &str, limit: &str| {
        format!(
            "  {side}: {{gap: \"y + h * (cos(phi) - 1) {} l * sin(phi)\", sliding: x' - h * phi', \
             friction: {{stribeck: {{coefficient: 0.4, static_coefficient: {limit}, \
             stribeck_speed: 0.01 m/s}}}}}}\n",
            if side == "left" { '-' } else { '+' }
        )
    };
    for limit in ["0.4", "0.6"] {
        let system = format!(
            "parameters: {{m: 2 kg, j: 0.05 kg m^2, h: 0.2 m, l: 0.3 m, k: 200 N/m, g: 9.81 m/s^2}}\n\
             coordinates:\n  x: {{unit: m, start: [-0.1, 0.1], start_rate: [-0.5, 0.5]}}\n  \
             y: {{unit: m}}\n  phi: {{unit: rad}}\n\
             mass: {{x: {{x: m}}, y: {{y: m}}, phi: {{phi: j}}}}\n\
             force: {{x: -k * x, y: -m * g}}\ncontacts:\n{}{}",
            foot("left", limit),
            foot("right", limit),
        );
        let limit: f64 = limit.parse().expect("a number");
        for outcome in outcomes(&system, 32, 10.0) {
            assert_eq!(outcome.evidence.name(), "rest_certified", "{outcome:?}");
            let x = outcome.outputs[0].end;
            let margin = 1.0 - 200.0 * x.abs() / (limit * 2.0 * 9.81);
            let found = outcome.evidence.friction_margin().expect("contacts stick");
            assert!((found - margin).abs() < 1e-9, "{found} {margin} at {x}");
        }
    }
}

/// Pads at two radii of a disc equal pads with a speed in rad/s and a torque as normal force, whatever unit their speeds have.
#[test]
fn pads_at_two_radii_share_the_load() {
    let disc = |pads: [[&str; 3]; 2]| {
        let pad = |number: usize, [sliding, normal, stribeck_speed]: [&str; 3]| {
            format!(
                "  pad_{number}: {{normal: {normal}, sliding: {sliding}, friction: {{stribeck: {{coefficient: 0.2, \
                 static_coefficient: 0.5, stribeck_speed: {stribeck_speed}}}}}}}\n"
            )
        };
        let system = format!(
            "parameters: {{j: 0.01 kg m^2, c: 2 N m, r: 0.1 m, n: 5 N, vs: 0.02 m/s}}\n\
             coordinates: {{phi: {{unit: rad, periodic: true, start: [-3, 3], start_rate: [-40, 40]}}}}\n\
             mass: {{phi: {{phi: j}}}}\nforce: {{phi: -c * sin(phi)}}\ncontacts:\n{}{}",
            pad(1, pads[0]),
            pad(2, pads[1]),
        );
        outcomes(&system, 24, 10.0)
    };
    let speeds = disc([["r * phi'", "n", "vs"], ["r / 2 * phi'", "n", "vs"]]);
    let turned = disc([["phi'", "n * r", "vs / r"], ["phi'", "n * r / 2", "2 * vs / r"]]);
    for (slid, turned) in speeds.iter().zip(&turned) {
        let names = [slid, turned].map(|outcome| outcome.evidence.name());
        assert_eq!(names, ["rest_certified"; 2], "{slid:?}");
        let values = |outcome: &Outcome| {
            [outcome.outputs[0].end, outcome.evidence.friction_margin().expect("sticks")]
        };
        for (slid, turned) in values(slid).into_iter().zip(values(turned)) {
            assert!((slid - turned).abs() < 1e-7, "{slid} {turned}");
        }
        let load = 2.0 * slid.outputs[0].end.sin().abs();
        let margin = 1.0 - load / (0.5 * 5.0 * (0.1 + 0.05));
        assert!((values(slid)[1] - margin).abs() < 1e-9, "{margin} {slid:?}");
    }
}

/// A block on the ground that a belt drags, too, rests where the ground holds what spring and belt leave; if the belt is stronger,
/// the block sticks on it and slips, for ever.
#[test]
fn a_block_between_ground_and_belt() {
    let block = |ground: &str, contacts: [&str; 2]| {
        let contact = |name: &str| match name {
            "ground" => format!(
                "  ground: {{normal: n, sliding: x', friction: {{coulomb: {{coefficient: {ground}}}}}}}\n"
            ),
            _ => {
                "  belt: {normal: n / 2, sliding: x' - v, friction: {stribeck: {coefficient: 0.2, \
                  static_coefficient: 0.4, stribeck_speed: 0.05 m/s}}}\n"
                    .to_owned()
            }
        };
        let system = format!(
            "parameters: {{m: 2 kg, k: 200 N/m, n: 10 N, v: 0.1 m/s}}\n\
             coordinates: {{x: {{unit: m, start: [-0.03, -0.015]}}}}\n\
             mass: {{x: {{x: m}}}}\nforce: {{x: -k * x}}\ncontacts:\n{}",
            contacts.map(contact).concat(),
        );
        outcomes(&system, 24, 20.0)
    };
    let drag = 5.0 * (0.2 + 0.2 * (-2.0_f64).exp());
    for contacts in [["ground", "belt"], ["belt", "ground"]] {
        for outcome in block("0.3", contacts) {
            assert_eq!(outcome.evidence.name(), "settled", "{outcome:?}");
            let margin = 1.0 - (drag - 200.0 * outcome.outputs[0].end).abs() / 3.0;
            let found = outcome.evidence.friction_margin().expect("the ground holds the block");
            assert!((found - margin).abs() < 1e-9, "{found} {margin}");
        }
        let outcomes = block("0.01", contacts);
        for outcome in &outcomes {
            assert_eq!(outcome.evidence.name(), "closed_orbit", "{outcome:?}");
            let [period, first] = [outcome, &outcomes[0]]
                .map(|outcome| outcome.evidence.period_s().expect("a period"));
            assert!((period - first).abs() < 1e-6, "{period} {first}");
        }
    }
}

/// A driven disc between two pads turns steadily at the speed at which viscous drag is left.
#[test]
fn a_disc_turns_between_two_pads() {
    let friction =
        "{stribeck: {coefficient: 0.2, static_coefficient: 0.5, stribeck_speed: 0.02 m/s}}";
    let system = format!(
        "parameters: {{j: 0.01 kg m^2, r: 0.1 m, n: 5 N, d: 0.01 N m s, drive: 0.5 N m}}\n\
         coordinates: {{phi: {{unit: rad, periodic: true, start_rate: [5, 40]}}}}\n\
         mass: {{phi: {{phi: j}}}}\nforce: {{phi: drive - d * phi'}}\ncontacts:\n  \
         one: {{normal: 2 * n, sliding: r * phi', friction: {friction}}}\n  \
         other: {{normal: 2 * n, sliding: r / 2 * phi', friction: {friction}}}\n"
    );
    for outcome in outcomes(&system, 16, 20.0) {
        assert_eq!(outcome.evidence.name(), "settled", "{outcome:?}");
        let speed = outcome.outputs[1].value(OutputValue::Mean).expect("it turns");
        assert!((speed - (0.5 - 0.2 - 0.1) / 0.01).abs() < 1e-4, "{speed}");
        assert_eq!(outcome.balls_running, Some(2), "both contacts go round");
    }
}

/// A block on two belts, one of them with another unit of its speed, sticks on one of them and slips; both methods find the cycle.
#[test]
fn a_block_on_two_belts_sticks_and_slips() {
    let system = "coordinates: {x: {start: [-2, 2], start_rate: [-1, 1]}}\n\
                  mass: {x: {x: 1}}\nforce: {x: -x}\ncontacts:\n  \
                  slow: {normal: 0.5, sliding: \"2 * (x' - 0.2)\", friction: {coulomb: {coefficient: 0.1}}}\n  \
                  fast: {normal: 1, sliding: x' - 0.5, friction: {stribeck: {coefficient: 0.5, \
                  static_coefficient: 1, stribeck_speed: 0.3}}}\n";
    let mut periods = Vec::new();
    for mut case in cases(system, 16, 60.0) {
        for method in [Method::Event, Method::Switch] {
            case.simulation.method = method;
            let outcome = simulate(&case);
            assert_eq!(outcome.evidence.name(), "closed_orbit", "{outcome:?}");
            periods.push(outcome.evidence.period_s().expect("a period"));
        }
    }
    assert!(periods.iter().all(|period| (period - periods[0]).abs() < 1e-4), "{periods:?}");
}

/// A motion that spirals slowly into steady sliding is no cycle, however small it has become.
#[test]
fn a_spiral_is_no_cycle() {
    let system = "coordinates: {x: {start: [-2, 2], start_rate: [-1, 1]}, y: {start: [-2, 2], start_rate: [-1, 1]}}\n\
                  mass: {x: {x: 1}, y: {y: 1}}\nforce: {x: -x + 1.1 * (y - x), y: -y + 1.1 * (x - y)}\ncontacts:\n  \
                  belt: {normal: 1.68, sliding: x' - 0.5, friction: {coulomb: {coefficient: 0.57}}}\n  \
                  other: {normal: 1.47, sliding: y' - 0.2, friction: {smooth: {coefficient: 0.21, smoothing_speed: 1}}}\n  \
                  drag: {normal: 1, sliding: x' + 0.2, friction: {viscous: {viscous_coefficient: 0.17}}}\n";
    for end_time_s in [60.0, 400.0] {
        let expected = if end_time_s > 100.0 { "settled" } else { "end_time" };
        for outcome in outcomes(system, 12, end_time_s) {
            assert_eq!(outcome.evidence.name(), expected, "{outcome:?}");
        }
    }
}

/// A spring tips a high box onto one foot. The box rests where the moments of spring and weight about this foot balance,
/// `k x h = m g a`, while the other foot stays open.
#[test]
fn a_box_rests_on_one_foot() {
    let foot = |sign: char| {
        format!(
            "{{gap: y {sign} a * phi, sliding: x' + h * phi', friction: {{coulomb: {{coefficient: 0.3}}}}}}"
        )
    };
    let system = format!(
        "parameters: {{m: 3 kg, j: 0.05 kg m^2, g: 9.81 m/s^2, k: 400 N/m, c: 20 N s/m, a: 0.2 m, h: 0.9 m}}\n\
         coordinates: {{x: {{unit: m, start: [0.03, 0.05]}}, y: {{unit: m, start: 0 m}}, phi: {{unit: rad}}}}\n\
         mass: {{x: {{x: m}}, y: {{y: m}}, phi: {{phi: j}}}}\n\
         force: {{x: -k * x - c * x', y: -m * g}}\ncontacts: {{left: {}, right: {}}}\n",
        foot('-'),
        foot('+'),
    );
    for outcome in outcomes(&system, 12, 20.0) {
        assert_eq!(outcome.evidence.name(), "settled", "{outcome:?}");
        let x = outcome.outputs[0].end.abs();
        assert!((x - 3.0 * 9.81 * 0.2 / 0.9 / 400.0).abs() < 1e-5, "{x}");
        let margin = outcome.evidence.friction_margin().expect("one foot sticks");
        assert!((margin - (1.0 - 0.2 / 0.9 / 0.3)).abs() < 1e-5, "{margin}");
    }
}
