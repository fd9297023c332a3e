//! Systems whose formulas have no units: a machine moves as a similar one, whatever the sizes of its numbers are.

use stickslip::classification::{Outcome, simulate};

use super::METHODS;
use super::outputs::cases;

/// Returns a system with its numbers in other units of length, mass and time. A number `<9.81 m0 l1 t-2>` of the text has a
/// dimension.
fn in_units(system: &str, [length, mass, time]: [f64; 3]) -> String {
    let mut parts = system.split('<');
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| {
        let (number, rest) = part.split_once('>').expect("a number ends with >");
        let mut words = number.split(' ');
        let value: f64 = words.next().and_then(|word| word.parse().ok()).expect("a number");
        let scaled = words.fold(value, |value, word| {
            let power = word[1..].parse().expect("a power");
            let unit = [("l", length), ("m", mass), ("t", time)].into_iter();
            value
                / unit
                    .filter(|(name, _)| word.starts_with(name))
                    .map(|(_, unit)| f64::powi(unit, power))
                    .product::<f64>()
        });
        text + &format!("{scaled:e}") + rest
    })
}

/// Each machine with the number of its runs, their time, and the dimension of its first output.
const MACHINES: [(&str, &str, f64, &str); 13] = [
    (
        "a box that falls on two feet and slides",
        "parameters: {m: <2 m1>, g: <9.81 l1 t-2>, b: <0.1 l1>, h: <0.12 l1>, mu: 0.3, e: 0.2}
coordinates:
  x: {start: 0, start_rate: [<-1 l1 t-1>, <1 l1 t-1>]}
  y: {start: [<0.14 l1>, <0.16 l1>]}
  phi: {start: [-0.1, 0.1]}
mass: {x: {x: m}, y: {y: m}, phi: {phi: m * (b^2 + h^2) / 3}}
force: {y: -m * g}
contacts:
  left: {gap: y - b * sin(phi) - h * cos(phi), sliding: \"x' + phi' * (h * cos(phi) - b * sin(phi))\", friction: {coulomb: {coefficient: mu}}, restitution: e}
  right: {gap: y + b * sin(phi) - h * cos(phi), sliding: \"x' + phi' * (h * cos(phi) + b * sin(phi))\", friction: {coulomb: {coefficient: mu}}, restitution: e}",
        8.0,
        "l",
    ),
    (
        "a block on a belt that changes its speed, with a force that repeats",
        "parameters: {m: <2 m1>, k: <300 m1 t-2>, c: <4 m1 t-1>, p: <6 m1 l1 t-2>, w: <9 t-1>, mu: 0.3, more: 0.4, load: <15 m1 l1 t-2>, v: <0.2 l1 t-1>, over: <0.3 l1 t-1>}
coordinates: {x: {start: [<-0.1 l1>, <0.1 l1>]}}
mass: {x: {x: m}}
force: {x: -k * x - c * x' + p * cos(w * t)}
period: 2 * pi / w
contacts: {belt: {normal: load, sliding: \"x' - v\", friction: {stribeck: {coefficient: mu, static_coefficient: more, stribeck_speed: over}}}}",
        40.0,
        "l",
    ),
    (
        "a bead on a ring, pressed by its weight and its motion",
        "parameters: {m: <0.3 m1>, r: <0.2 l1>, g: <9.81 l1 t-2>, mu: 0.2, c: <0.01 m1 l2 t-1>}
coordinates: {phi: {start: [-0.9, 0.9]}}
mass: {phi: {phi: m * r^2}}
force: {phi: -m * g * r * sin(phi) - c * phi'}
contacts: {ring: {normal: m * r * (g * cos(phi) + r * phi'^2), sliding: phi', friction: {coulomb: {coefficient: mu}}}}",
        20.0,
        "",
    ),
    (
        "a cart that presses a block by its acceleration",
        "parameters: {m: <3 m1>, n: <1 m1>, k: <200 m1 t-2>, mu: 0.3, load: <20 m1 l1 t-2>, c: <5 m1 t-1>}
coordinates: {x: {start: [<-0.2 l1>, <0.2 l1>]}, y: {start: [<-0.2 l1>, <0.2 l1>]}}
mass: {x: {x: m}, y: {y: n}}
force: {x: -k * x - c * x', y: -k * y}
contacts: {shoe: {normal: load - 0.3 * m * x'', sliding: y', friction: {coulomb: {coefficient: mu}}}}",
        20.0,
        "l",
    ),
    (
        "two pads at different radii of a disc",
        "parameters: {j: <0.02 m1 l2>, k: <3 m1 l2 t-2>, r_1: <0.1 l1>, r_2: <0.15 l1>, n_1: <2 m1 l1 t-2>, n_2: <1 m1 l1 t-2>, mu: 0.3}
coordinates: {phi: {start: [-0.8, 0.8]}}
mass: {phi: {phi: j}}
force: {phi: -k * phi}
contacts:
  inner: {normal: n_1 * r_1, sliding: phi', friction: {coulomb: {coefficient: mu}}}
  outer: {normal: n_2, sliding: r_2 * phi', friction: {coulomb: {coefficient: mu}}}",
        20.0,
        "",
    ),
    (
        "a ball on a plate that vibrates",
        "parameters: {m: <0.1 m1>, g: <9.81 l1 t-2>, a: <0.004 l1>, w: <60 t-1>, e: 0.5}
coordinates: {y: {start: [<0.01 l1>, <0.012 l1>]}}
mass: {y: {y: m}}
force: {y: -m * g}
period: 2 * pi / w
contacts: {plate: {gap: y - a * sin(w * t), restitution: e}}",
        30.0,
        "l",
    ),
    (
        "a block beside a block that slides on a slope that turns",
        "parameters: {m: <1 m1>, n: <2 m1>, k: <80 m1 t-2>, mu: 0.2, g: <9.81 l1 t-2>, c: <1 m1 t-1>}
coordinates: {x: {start: [<-0.3 l1>, <0.3 l1>]}, y: {start: [<-0.3 l1>, <0.3 l1>]}}
mass: {x: {x: m}, y: {y: n}}
force: {x: k * (y - x) - k * x, y: -k * (y - x) - c * y'}
contacts:
  between: {normal: m * g, sliding: x' - y', friction: {coulomb: {coefficient: mu}}}
  ground: {normal: (m + n) * g, sliding: y', friction: {coulomb: {coefficient: mu / 4}}}",
        20.0,
        "l",
    ),
    (
        "a block on ground that a table moves, behind a shaft that turns",
        "parameters: {m: <2 m1>, g: <9.81 l1 t-2>, mu: 0.2, k: <100 m1 t-2>, e: <0.01 l1>, speed: <8 t-1>}
motions: {ground: {table: {columns: [\"time [s]\", ground], rows: [[0, 0], [<0.5 t1>, <0.2 l1>], [<1 t1>, <0.1 l1>]]}}}
turning: {theta: speed}
coordinates: {x: {start: [<-0.1 l1>, <0.1 l1>]}}
mass: {x: {x: m}}
force: {x: k * e * cos(theta) - k * x}
contacts: {ground: {normal: m * g, sliding: \"x' - ground'\", friction: {coulomb: {coefficient: mu}}}}",
        30.0,
        "l",
    ),
    (
        "a wheel with a brake at its rim",
        "parameters: {j: <0.1 m1 l2>, r: <0.15 l1>, k: <2 m1 l2 t-2>, load: <3 m1 l1 t-2>, mu: 0.3, c: <0.4 m1 t-1>}
coordinates: {phi: {start: [-0.9, 0.9]}}
mass: {phi: {phi: j}}
force: {phi: -k * phi}
contacts: {brake: {normal: load, sliding: r * phi', friction: {coulomb_viscous: {coefficient: mu, viscous_coefficient: c}}}}",
        20.0,
        "",
    ),
    (
        "a yoke that starts at its dead centre and goes round",
        "parameters: {j: <0.1 m1 l2>, r: <0.1 l1>, load: <10 m1 l1 t-2>, mu: 0.5}
coordinates: {phi: {start: 3.141592653589793, start_rate: [<9 t-1>, <11 t-1>], periodic: true}}
mass: {phi: {phi: j}}
contacts: {slide: {normal: load, sliding: r * sin(phi) * phi', friction: {coulomb: {coefficient: mu}}}}",
        20.0,
        "",
    ),
    (
        "a block that a force shakes once in two turns of a shaft",
        "parameters: {m: <2 m1>, k: <100 m1 t-2>, p: <8 m1 l1 t-2>, mu: 0.2, load: <10 m1 l1 t-2>, speed: <9 t-1>}
turning: {theta: speed}
period: 4 * pi / speed
coordinates: {x: {start: [<-0.1 l1>, <0.1 l1>]}}
mass: {x: {x: m}}
force: {x: p * cos(theta / 2) - k * x}
contacts: {ground: {normal: load, sliding: x', friction: {coulomb: {coefficient: mu}}}}",
        30.0,
        "l",
    ),
    (
        "a pendulum that starts upright and falls on a floor",
        "parameters: {m: <2 m1>, r: <0.5 l1>, g: <9.81 l1 t-2>, h: <0.1 l1>, e: 0.5, c: <0.05 m1 l2 t-1>}
coordinates: {phi: {start: 0, start_rate: [<0.2 t-1>, <0.4 t-1>]}}
mass: {phi: {phi: m * r^2}}
force: {phi: m * g * r * sin(phi) - c * phi'}
contacts: {floor: {gap: h + r * cos(phi), restitution: e}}",
        20.0,
        "",
    ),
    (
        "a block that starts beside its spring's rest on a belt",
        "parameters: {m: <1 m1>, k: <100 m1 t-2>, load: <10 m1 l1 t-2>, v: <0.1 l1 t-1>, mu: 0.2, more: 0.3}
coordinates: {x: {start: [<1e-9 l1>, <2e-9 l1>]}}
mass: {x: {x: m}}
force: {x: -k * x}
contacts: {belt: {normal: load, sliding: x' - v, friction: {stribeck: {coefficient: mu, static_coefficient: more, stribeck_speed: 0}}}}",
        20.0,
        "l",
    ),
];

/// Millimetres, tonnes and seconds; a machine of micrometres; kilometres and millions of tonnes.
const UNITS: [[f64; 3]; 3] = [[1e-3, 1e3, 1.0], [1e-6, 1e-9, 1e-4], [1e3, 1e9, 1e2]];

/// Returns the end of the first output of a run that comes to rest. A cycle may be found after another number of turns.
fn end_at_rest(outcome: &Outcome) -> Option<f64> {
    outcome.evidence.rest().map(|_| outcome.outputs[0].end)
}

/// Labels, evidence, ends, means, margins, periods and times of rest are those of the machine in metres, kilograms and seconds, by both
/// methods.
#[test]
fn similar_machines_move_alike() {
    for ((machine, system, end_time_s, dimension), method) in
        MACHINES.iter().flat_map(|machine| METHODS.map(|method| (machine, method)))
    {
        let of = |units: [f64; 3]| {
            let cases = cases(&in_units(system, units), 6, end_time_s / units[2]);
            cases.into_iter().map(move |mut case| {
                case.simulation.method = method;
                simulate(&case)
            })
        };
        let reference: Vec<Outcome> = of([1.0; 3]).collect();
        for units in UNITS {
            let length = if *dimension == "l" { units[0] } else { 1.0 };
            for (found, expected) in of(units).zip(&reference) {
                let same = |of: &dyn Fn(&Outcome) -> Option<f64>, unit: f64| {
                    let [found, expected] = [&found, expected].map(of);
                    let Some(expected) = expected else { return found.is_none() };
                    let off = |found: f64| (found * unit - expected).abs();
                    found.is_some_and(|found| off(found) <= 1e-6 * (1.0 + expected.abs()))
                };
                let is_same = found.evidence.name() == expected.evidence.name()
                    && same(&end_at_rest, length)
                    && same(&|outcome| Some(outcome.outputs[0].range?.extremes[1]), length)
                    && same(&|outcome| Some(outcome.outputs[0].range?.mean), length)
                    && same(&|outcome| outcome.evidence.friction_margin(), 1.0)
                    && same(&|outcome| outcome.evidence.period_s(), units[2])
                    && same(&|outcome| outcome.time_to_rest_s(), units[2]);
                assert!(is_same, "{machine} in {units:?} by {method:?}\n{found:?}\n{expected:?}");
            }
        }
    }
}
