//! Bodies that contacts hold more than once, whose forces rigid bodies do not determine: they move as if each motion had the forces
//! it needs, and rest where some forces within friction hold them.

use rayon::prelude::*;
use stickslip::classification::{Label, Outcome, simulate};
use stickslip::model::{Method, OutputValue};

use super::outputs::{cases, outcomes};
use crate::support::{cases_of, parse, shipped_study};

/// Returns the outcomes of a box on feet at these places, which a spring pulls; by both methods.
fn boxes(feet: &[&str]) -> [Vec<Outcome>; 2] {
    let foot = |(number, place): (usize, &&str)| {
        format!(
            "  foot_{number}: {{gap: \"y + {place} * sin(phi) + h * (cos(phi) - 1)\", \
             sliding: \"x' + phi' * (h * cos(phi) + {place} * sin(phi))\", friction: {{coulomb: {{coefficient: mu}}}}}}\n"
        )
    };
    let feet: String = feet.iter().enumerate().map(foot).collect();
    let system = format!(
        "parameters: {{m: 1 kg, j: 0.1 kg m^2, b: 0.5 m, h: 0.4 m, k: 100 N/m, c: 1 N s/m, g: 9.81 m/s^2, mu: 0.3}}\n\
         coordinates:\n  x: {{unit: m, start: [-0.2, 0.2], start_rate: [-0.5, 0.5]}}\n  y: {{unit: m}}\n  phi: {{unit: rad}}\n\
         mass: {{x: {{x: m}}, y: {{y: m}}, phi: {{phi: j}}}}\nforce: {{x: -k * x - c * x', y: -m * g}}\ncontacts:\n{feet}"
    );
    [Method::Switch, Method::Event].map(|method| {
        let simulated = |mut case: stickslip::model::Case| {
            case.simulation.method = method;
            simulate(&case)
        };
        cases(&system, 24, 20.0).into_iter().map(simulated).collect()
    })
}

/// A box on two or three feet slides, stops and rests as a block on one contact with the weight as its normal force, although three feet
/// do not determine their normal forces either. Its margin is that of the sum of all feet.
#[test]
fn a_box_on_feet_moves_as_a_block() {
    let block = outcomes(
        "parameters: {m: 1 kg, k: 100 N/m, c: 1 N s/m, w: 9.81 N, mu: 0.3}\n\
         coordinates: {x: {unit: m, start: [-0.2, 0.2], start_rate: [-0.5, 0.5]}}\n\
         mass: {x: {x: m}}\nforce: {x: -k * x - c * x'}\n\
         contacts: {ground: {normal: w, sliding: x', friction: {coulomb: {coefficient: mu}}}}",
        24,
        20.0,
    );
    for boxes in [boxes(&["b", "(-b)"]), boxes(&["b", "(-b)", "(0.3 * b)"])].as_flattened() {
        for (block, found) in block.iter().zip(boxes) {
            assert_eq!(found.evidence.name(), "rest_certified", "{found:?}");
            let [x, expected] = [found, block].map(|outcome| outcome.outputs[0].end);
            assert!((x - expected).abs() < 1e-7, "{x} {expected}");
            let margin = 1.0 - 100.0 * x.abs() / (0.3 * 9.81);
            let found = found.evidence.friction_margin().expect("the feet stick");
            assert!((found - margin).abs() < 1e-9, "{found} {margin} at {x}");
        }
    }
}

/// A ladder between a floor and a wall holds up to `tan φ = 2 μ / (1 - μ μ')` with the coefficients of floor and wall. Its margin is
/// that of friction that is weaker at both ends.
#[test]
fn a_ladder_holds_up_to_its_angle() {
    let [floor, wall] = [0.4_f64, 0.3];
    let most = (2.0 * floor / (1.0 - floor * wall)).atan();
    for (angle, rests) in [(0.6, true), (most - 1e-3, true), (most + 1e-3, false)] {
        let system = format!(
            "parameters: {{m: 10 kg, l: 4 m, g: 9.81 m/s^2}}\n\
             coordinates:\n  x: {{unit: m, start: {}}}\n  y: {{unit: m, start: {}}}\n  phi: {{unit: rad, start: {angle}}}\n\
             mass: {{x: {{x: m}}, y: {{y: m}}, phi: {{phi: m * l^2 / 12}}}}\nforce: {{y: -m * g}}\ncontacts:\n  \
             floor: {{gap: y - l / 2 * cos(phi), sliding: \"x' + l / 2 * cos(phi) * phi'\", friction: {{coulomb: {{coefficient: {floor}}}}}}}\n  \
             wall: {{gap: x - l / 2 * sin(phi), sliding: \"y' - l / 2 * sin(phi) * phi'\", friction: {{coulomb: {{coefficient: {wall}}}}}}}",
            2.0 * f64::sin(angle),
            2.0 * f64::cos(angle),
        );
        let [outcome] = &outcomes(&system, 1, 5.0)[..] else { panic!("one run") };
        if !rests {
            let fell = outcome.outputs[2].end;
            assert!(
                fell > angle + 0.01 && outcome.evidence.name() != "rest_certified",
                "{outcome:?}"
            );
            continue;
        }
        assert_eq!(outcome.evidence.name(), "rest_certified", "{angle} {outcome:?}");
        // `s² μ μ' tan φ + 2 s μ - tan φ = 0` for the least factor `s` on both coefficients.
        let slope = f64::tan(angle);
        let least = ((floor * floor + floor * wall * slope * slope).sqrt() - floor)
            / (floor * wall * slope);
        let margin = outcome.evidence.friction_margin().expect("the ends stick");
        assert!((margin - (1.0 - least)).abs() < 1e-9, "{margin} {least}");
    }
}

/// Two blocks on a floor rub on each other: the friction between them is not determined while all stick. They rest where some
/// friction between them helps both.
#[test]
fn blocks_that_rub_on_each_other_rest() {
    let all = outcomes(
        "parameters: {m: 1 kg, k: 50 N/m, c: 1 N s/m, n: 10 N, mu: 0.2}\n\
         coordinates:\n  x: {unit: m, start: [-0.3, 0.3], start_rate: [-2, 2]}\n  z: {unit: m, start: [-0.3, 0.3], start_rate: [-2, 2]}\n\
         mass: {x: {x: m}, z: {z: m}}\nforce: {x: -k * x - c * x', z: -k * z - c * z'}\ncontacts:\n  \
         floor_x: {normal: n, sliding: x', friction: {coulomb: {coefficient: mu}}}\n  \
         floor_z: {normal: n, sliding: z', friction: {coulomb: {coefficient: mu}}}\n  \
         between: {normal: n, sliding: \"x' - z'\", friction: {coulomb: {coefficient: mu}}}",
        32,
        30.0,
    );
    for outcome in &all {
        assert_eq!(outcome.evidence.name(), "rest_certified", "{outcome:?}");
        let [x, z] = [0, 1].map(|output| 50.0 * outcome.outputs[output].end);
        // Of three contacts that share two loads, each pair carries its load.
        let needed = 0.5 * x.abs().max(z.abs()).max((x + z).abs());
        let margin = outcome.evidence.friction_margin().expect("contacts stick");
        assert!((margin - (1.0 - needed / 2.0)).abs() < 1e-9, "{margin} {outcome:?}");
    }
}

/// Three blocks that rub on each other round and round, on a frictionless floor with springs: the equations of three contacts that
/// stick are dependent, although they contain three velocities. The blocks stop against each other, and move on together.
#[test]
fn blocks_that_rub_round_and_round_move_together() {
    let all = outcomes(
        "parameters: {m: 1 kg, k: 10 N/m, c: 0.5 N s/m, n: 10 N, mu: 0.3}\n\
         coordinates:\n  x: {unit: m, start: [-0.1, 0.1], start_rate: [-1, 1]}\n  z: {unit: m, start: [-0.1, 0.1], start_rate: [-1, 1]}\n  \
         w: {unit: m, start: [-0.1, 0.1], start_rate: [-1, 1]}\n\
         mass: {x: {x: m}, z: {z: m}, w: {w: m}}\nforce: {x: -k * x - c * x', z: 0, w: 0}\ncontacts:\n  \
         xz: {normal: n, sliding: \"x' - z'\", friction: {coulomb: {coefficient: mu}}}\n  \
         zw: {normal: n, sliding: \"z' - w'\", friction: {coulomb: {coefficient: mu}}}\n  \
         wx: {normal: n, sliding: \"w' - x'\", friction: {coulomb: {coefficient: mu}}}",
        16,
        100.0,
    );
    for outcome in &all {
        assert_ne!(outcome.evidence.name(), "not_finite", "{outcome:?}");
        assert_ne!(outcome.evidence.name(), "no_solution", "{outcome:?}");
        let rate = |output: usize| outcome.outputs[output].end;
        assert!(
            (rate(3) - rate(4)).abs() < 1e-9 && (rate(4) - rate(5)).abs() < 1e-9,
            "{outcome:?}"
        );
        // One block of 3 kg on the spring: its motion decays within the time.
        assert!(outcome.outputs[0].end.abs() < 0.01, "{outcome:?}");
    }
}

/// A body between two walls that close in on it has no motion: the equations of both contacts contradict each other.
#[test]
fn walls_that_close_in_on_a_body_have_no_solution() {
    for method in ["switch", "event"] {
        let study = parse(format!(
            "schema: 1\nname: a\nseed: 7\nmodel:\n  system:\n    system: a\n    parameters: {{m: 1 kg, d: 1 m}}\n    \
             motions: {{wall: {{unit: m, table: {{columns: ['time [s]', 'wall [m]'], rows: [[0, 0], [1, 0.5], [2, 0.5]]}}}}}}\n    \
             coordinates: {{x: {{unit: m, start: 0.5, start_rate: 0}}}}\n    mass: {{x: {{x: m}}}}\n    contacts:\n      \
             left: {{gap: x - d / 4 - wall}}\n      right: {{gap: 3 / 4 * d - wall - x}}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 1}}}}}}\nsimulation: {{end_time_s: 3, method: {method}}}\n"
        ));
        let outcome = simulate(&cases_of(&study)[0]);
        assert_eq!(outcome.label(), Label::Failed, "{outcome:?}");
    }
}

/// Two blocks that touch, with friction between them, are pressed together, and a third one slides beside them until it stops: friction
/// that slides is determined, whatever holds other bodies more than once.
#[test]
fn blocks_in_a_corner_leave_others_their_friction() {
    for [corner, block] in [[1.0, 2.0], [2.0, 5.0], [2.0, 5.5], [0.3, 4.0]] {
        let system = format!(
            "parameters: {{m: {corner:?}, n: {block:?}, g: 9.81}}\n\
             coordinates: {{u: {{}}, w: {{}}, x: {{start: 0.3, start_rate: 1}}, y: {{}}}}\n\
             mass: {{u: {{u: m}}, w: {{w: m}}, x: {{x: n}}, y: {{y: n}}}}\nforce: {{w: -m * g, y: -n * g}}\ncontacts:\n  \
             wall: {{gap: u, sliding: w', friction: {{coulomb: {{coefficient: 0.4}}}}}}\n  \
             floor: {{gap: w, sliding: u', friction: {{coulomb: {{coefficient: 0.3}}}}}}\n  \
             top: {{gap: y, sliding: x', friction: {{coulomb: {{coefficient: 0.2}}}}}}\n  \
             side: {{gap: x - u - 0.2, sliding: \"y' - w'\", friction: {{coulomb: {{coefficient: 0.2}}}}}}"
        );
        let [outcome] = &outcomes(&system, 1, 6.0)[..] else { panic!("one run") };
        let x = 0.3 + 1.0 / (2.0 * 0.2 * 9.81);
        assert!((outcome.outputs[2].end - x).abs() < 1e-8, "{x} {outcome:?}");
    }
}

/// Two blocks that a force presses together share its load with their friction on the floor.
#[test]
fn blocks_that_touch_share_a_load() {
    for push in [1.0, 3.0] {
        let system = format!(
            "parameters: {{g: 9.81}}\ncoordinates: {{u: {{}}, w: {{}}, x: {{start: 0.1}}, y: {{}}}}\n\
             mass: {{u: {{u: 1}}, w: {{w: 1}}, x: {{x: 1}}, y: {{y: 1}}}}\nforce: {{w: -g, y: -g, x: -{push:?}}}\ncontacts:\n  \
             left: {{gap: w, sliding: u', friction: {{coulomb: {{coefficient: 0.2}}}}}}\n  \
             right: {{gap: y, sliding: x', friction: {{coulomb: {{coefficient: 0.2}}}}}}\n  \
             between: {{gap: x - u - 0.1, sliding: \"y' - w'\", friction: {{coulomb: {{coefficient: 0.3}}}}}}"
        );
        let [outcome] = &outcomes(&system, 1, 5.0)[..] else { panic!("one run") };
        assert_eq!(outcome.evidence.name(), "rest_certified", "{outcome:?}");
        // Friction between the blocks moves load from one floor contact to the other, and their sum stays.
        let margin = 1.0 - 0.5 * push / (0.2 * 9.81);
        let found = outcome.evidence.friction_margin().expect("contacts stick");
        assert!((found - margin).abs() < 1e-9, "{found} {margin}");
    }
}

/// A force that grows pushes a block against a second one, which it touches: both set off when the force exceeds the friction of
/// both, and the force between them was not determined until then.
#[test]
fn blocks_that_touch_set_off_together() {
    let system = "parameters: {m: 1 kg, n: 10 N, mu: 0.2, p: 5 N, omega: 1 rad/s}\n\
         coordinates:\n  x: {unit: m}\n  z: {unit: m}\n\
         mass: {x: {x: m}, z: {z: m}}\nforce: {x: p * sin(omega * t)}\nperiod: 2 * pi / omega\ncontacts:\n  \
         floor_x: {normal: n, sliding: x', friction: {coulomb: {coefficient: mu}}}\n  \
         floor_z: {normal: n, sliding: z', friction: {coulomb: {coefficient: mu}}}\n  \
         between: {gap: z - x, restitution: 0}";
    let sets_off = (4.0_f64 / 5.0).asin();
    for (end, moved) in [(sets_off - 1e-4, false), (sets_off + 0.1, true)] {
        for method in ["switch", "event"] {
            let study = parse(format!(
                "schema: 1\nname: a\nseed: 7\nmodel:\n  system:\n    system: a\n    {}\n\
                 initial_conditions: {{design: {{monte_carlo: {{samples: 1}}}}}}\n\
                 simulation: {{end_time_s: {end}, method: {method}}}\n",
                system.replace('\n', "\n    ")
            ));
            let [case] = &cases_of(&study)[..] else { panic!("one run") };
            let outcome = simulate(case);
            let [x, z] = [0, 1].map(|output| outcome.outputs[output].value(OutputValue::End));
            let [x, z] = [x, z].map(|end| end.expect("an end"));
            // While both move, their acceleration is `(p sin t - 4 N) / 2 kg`.
            let after = end - sets_off;
            let expected = 0.5
                * (5.0 * (sets_off.sin() - end.sin() + after * sets_off.cos())
                    - 2.0 * after * after);
            let expected = if moved { expected } else { 0.0 };
            for found in [x, z] {
                assert!((found - expected).abs() < 1e-9, "{method} {end}: {found} {expected}");
            }
        }
    }
}

/// Balls of a rotor that speeds up touch, rest in touch and set off again, one of them towards another at which it lies. Of these
/// runs, none fails.
#[test]
fn balls_of_a_rotor_rest_in_touch_and_set_off() {
    for (balls, runs) in [(3, [11, 27]), (4, [20, 36])] {
        let study = parse(format!(
            "schema: 1\nname: a\nseed: 385\nmodel:\n  kind: rotor_balancer\n  parameters: {{number_of_balls: {balls}, \
             number_of_pairs: {balls}, speed: 4500 rpm, runout: 6 µm, gravity: 0 m/s^2}}\n  speed_profile:\n  \
             - ramp: {{from: 600 rpm, over: 20 s}}\n  - hold: 5 s\n\
             initial_conditions: {{design: {{latin_hypercube: {{samples: 40}}}}}}\nsimulation: {{method: event}}\n"
        ));
        for run in runs {
            let outcome = simulate(&cases_of(&study)[run]);
            assert_eq!(outcome.evidence.name(), "periodic_rest", "{balls} {run}: {outcome:?}");
        }
    }
}

/// A block that stands tilted on one corner falls onto the other one and rocks on with the part `1 - 3/2 sin² α` of its speed (G. W.
/// Housner, Bull. Seismol. Soc. Am. 53 (1963) 403), where `α` is the angle of its diagonal from the vertical. Its energy above that of
/// rest is the square of this part.
#[test]
fn a_block_rocks_as_housner_says() {
    let [b, h, g, tilt] = [0.2_f64, 0.6, 9.81, 0.1];
    let system = format!(
        "parameters: {{m: 3 kg, b: {b} m, h: {h} m, g: {g} m/s^2, mu: 2}}\n\
         coordinates:\n  x: {{unit: m}}\n  y: {{unit: m, start: {:?}}}\n  phi: {{unit: rad, start: {tilt}}}\n\
         mass: {{x: {{x: m}}, y: {{y: m}}, phi: {{phi: m * (b^2 + h^2) / 3}}}}\nforce: {{y: -m * g}}\ncontacts:\n  \
         left: {{gap: y - b * sin(phi) - h * cos(phi), sliding: \"x' + phi' * (b * sin(phi) + h * cos(phi))\", friction: {{coulomb: {{coefficient: mu}}}}}}\n  \
         right: {{gap: y + b * sin(phi) - h * cos(phi), sliding: \"x' - phi' * (b * sin(phi) - h * cos(phi))\", friction: {{coulomb: {{coefficient: mu}}}}}}\n\
         outputs: {{energy: m * (x'^2 + y'^2 + (b^2 + h^2) / 3 * phi'^2) / 2 + m * g * (y - h)}}",
        b * tilt.sin() + h * tilt.cos(),
    );
    let diagonal = b.hypot(h);
    let slope = (b / h).atan();
    let pace = (0.75 * g / diagonal).sqrt();
    // The time until the first impact of a slender block, and half of it again.
    let end = 1.5 * (1.0 / (1.0 - tilt / slope)).acosh() / pace;
    let energy = 3.0 * g * diagonal * ((slope - tilt).cos() - slope.cos());
    for outcome in outcomes(&system, 1, end).iter().chain(&outcomes(&system, 1, 60.0)) {
        let found = outcome.outputs.last().expect("the energy").end;
        let part = 1.0 - 1.5 * slope.sin().powi(2);
        let is_at_rest = outcome.evidence.name() == "rest_certified";
        let expected = if is_at_rest { 0.0 } else { part * part * energy };
        assert!((found - expected).abs() < 1e-9 * energy, "{found} {expected} {outcome:?}");
        assert_eq!(
            is_at_rest,
            outcome.end_time_s.is_some_and(|time_s| time_s > end),
            "{outcome:?}"
        );
    }
}

/// Blocks that the ground shakes slide, rock and come to rest. The page of system files says how many of them lie on a side then; both
/// methods agree on each of those compared.
#[test]
fn blocks_topple_as_often_as_the_page_says() {
    let page = include_str!("../../docs/system-files.md");
    let cases = cases_of(&shipped_study("rocking-block.yaml"));
    let topples = |method, step: usize| -> Vec<bool> {
        let topples = |case: &stickslip::model::Case| {
            let mut case = case.clone();
            case.simulation.method = method;
            let outcome = simulate(&case);
            assert_eq!(outcome.evidence.name(), "rest_certified", "{outcome:?}");
            let lies = outcome.outputs.last().expect("whether it lies").end;
            assert!(lies.min((1.0 - lies).abs()) < 1e-9, "{lies}");
            lies > 0.5
        };
        cases.par_iter().step_by(step).map(topples).collect()
    };
    let toppled = topples(Method::Event, 1);
    assert!(toppled.iter().step_by(4).eq(&topples(Method::Switch, 4)));
    let shares: Vec<String> = toppled
        .chunks(40)
        .map(|runs| runs.iter().filter(|lies| **lies).count() as f64 / 0.4)
        .map(|percent| percent.to_string())
        .collect();
    let [first @ .., last] = &shares[..] else { panic!("no points") };
    let sentence = format!("and friction {} and {last} % for", first.join(", "));
    assert!(page.contains(&sentence), "{sentence}");
}

/// A stack of two bricks, on the ground or on a belt, with the contacts and coordinates in any order.
fn stack(contacts: [&str; 2], coordinates: [&str; 4], force: &str) -> String {
    let contact = |name: &str| match name {
        "floor" => {
            "floor: {gap: yb, sliding: xb' - vb, friction: {stribeck: {coefficient: 0.3, static_coefficient: 0.45, stribeck_speed: 0.1 m/s}}}"
        }
        _ => "top: {gap: ya - yb, sliding: xa' - xb', friction: {coulomb: {coefficient: 0.3}}}",
    };
    let coordinate = |name: &str| match name {
        "xa" => "xa: {unit: m, start: 0, start_rate: push}",
        "xb" => "xb: {unit: m, start: 0}",
        "ya" => "ya: {unit: m, start: 0}",
        _ => "yb: {unit: m, start: 0}",
    };
    format!(
        "parameters: {{m: 1 kg, g: 9.81 m/s^2, {force}}}
coordinates: {{{}}}
mass: {{xa: {{xa: m}}, xb: {{xb: m}}, ya: {{ya: m}}, yb: {{yb: m}}}}
force: {{ya: -m * g, yb: -m * g, xb: -k * xb}}
contacts: {{{}}}",
        coordinates.map(coordinate).join(", "),
        contacts.map(contact).join(", ")
    )
}

/// Labels do not depend on the order in which a file names contacts and coordinates.
#[test]
fn the_order_of_contacts_and_coordinates_does_not_matter() {
    let orders = [["floor", "top"], ["top", "floor"]];
    let coordinates =
        [["xa", "xb", "ya", "yb"], ["yb", "ya", "xb", "xa"], ["xb", "yb", "xa", "ya"]];
    let mut periods = Vec::new();
    for (contacts, coordinates) in
        orders.into_iter().flat_map(|order| coordinates.map(|coordinates| (order, coordinates)))
    {
        let rest = stack(contacts, coordinates, "vb: 0 m/s, k: 30 N/m, push: 0.5 m/s");
        let found = &outcomes(&rest, 1, 20.0)[0];
        assert_eq!(found.evidence.name(), "rest_certified", "{contacts:?} {coordinates:?}");
        // The upper brick stops after 0.5 m/s / (mu g).
        let time = found.time_to_rest_s().expect("it rests");
        assert!((time - 0.5 / (0.3 * 9.81)).abs() < 1e-6, "{time}");

        let belt = stack(contacts, coordinates, "vb: 0.2 m/s, k: 30 N/m, push: 0 m/s");
        let found = &outcomes(&belt, 1, 60.0)[0];
        assert_eq!(found.evidence.name(), "closed_orbit", "{contacts:?} {coordinates:?}");
        periods.push(found.evidence.period_s().expect("a cycle"));
    }
    assert!(periods.iter().all(|period| (period - periods[0]).abs() < 1e-7), "{periods:?}");
}
