//! Long-term endings of runs: rest, cycles, irregular motion.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::support::{Block, cases_of, parse, shipped_study};
use stickslip::analysis::CycleClass;
use stickslip::classification::{Label, Outcome, simulate};
use stickslip::model::{Case, Machine, Simulation, Start};

use crate::classification::simulate_all::simulate_all;
use crate::docs::generated::compare_or_write_part;

/// Returns one replicate of the thesis's start states: 256 runs.
fn replicate(parameters: &str, end_time_s: f64) -> Vec<(Case, Outcome)> {
    let text = format!(
        "schema: 1\nname: replicate\nseed: 2003\n\
         model: {{kind: ball_balancer, parameters: {{{parameters}}}}}\n\
         initial_conditions:\n\
         \x20 design: {{stratified: {{parts_per_axis: 2, samples_per_cell: 1}}}}\n\
         simulation: {{end_time_s: {end_time_s}}}\n"
    );
    let cases = cases_of(&parse(text));
    let outcomes = simulate_all(&cases);
    cases.into_iter().zip(outcomes).collect()
}

pub fn at_rest_over_time() -> String {
    let times = [16.5, 33.0, 66.0, 165.0];
    let mut text = "\
| speed [rad/s] | | 16.5 s | 33 s | 66 s | 165 s | irregular | limit cycle | undecided | Lyapunov exponents [1/s] |
|---|---|---|---|---|---|---|---|---|---|
"
    .to_owned();
    for (speed, elsewhere) in [(-216.3772, [140, 148, 174, 237]), (-191.6372, [24, 34, 45, 99])] {
        let runs = replicate(&format!("speed_rad_s: {speed}"), 165.0);
        let at_rest = times.map(|time| {
            let rests = |(_, outcome): &&(Case, Outcome)| {
                outcome.time_to_rest_s().is_some_and(|rest| rest <= time)
            };
            runs.iter().filter(rests).count()
        });
        let of = |label: Label| runs.iter().filter(|(_, outcome)| outcome.label() == label).count();
        let exponents: Vec<f64> = runs
            .iter()
            .filter(|(_, outcome)| outcome.label() == Label::Irregular)
            .map(|(_, outcome)| outcome.lyapunov.expect("measured").exponent_1_s)
            .collect();
        let least = exponents.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = exponents.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let [a, b, c, d] = at_rest;
        let (irregular, cycles) = (of(Label::Irregular), of(Label::LimitCycle));
        let undecided = of(Label::Undecided);
        let exponents = match exponents.is_empty() {
            true => String::new(),
            false => format!("{least:.2} .. {greatest:.2}"),
        };
        let _ = writeln!(
            text,
            "| {speed} | program | {a} | {b} | {c} | {d} | {irregular} | {cycles} | {undecided} | \
             {exponents} |",
        );
        let [a, b, c, d] = elsewhere;
        let _ = writeln!(text, "| | prototype | {a} | {b} | {c} | {d} | | | | |");
        // Counts of two samples of 256: within four standard deviations of their difference.
        for (found, expected) in at_rest.into_iter().zip(elsewhere) {
            let fraction = (found + expected) as f64 / 512.0;
            let deviation = (2.0 * 256.0 * fraction * (1.0 - fraction)).sqrt();
            let difference = (found as f64 - expected as f64).abs();
            assert!(difference <= 4.0 * deviation, "{speed}: {found}, elsewhere {expected}");
        }
        if speed == -216.3772 {
            let part = format!("{exponents}/s").replace(" .. ", " to ");
            compare_or_write_part("docs/methods.md", "slow-exponents", &part);
        }
        if speed == -191.6372 {
            let moving = runs.len() - at_rest[3];
            assert!(10 * irregular >= 9 * moving, "{irregular} of {moving} that move");
        }
    }
    text
}

pub fn thesis_orbits() -> String {
    let mut text = "\
| speed [rad/s] | mean ball speed, prototype [rad/s] | mean ball speed, program [rad/s] | label | evidence | moduli of the multipliers | time of rest with β₂ displaced by 1e-6 |
|---|---|---|---|---|---|---|
"
    .to_owned();
    let start = |x, y, beta: f64, shift: f64, x_dot, y_dot, beta_dot| {
        Start::of_balancer([x, y], &[beta, beta + shift], [x_dot, y_dot], &[beta_dot; 2])
    };
    for (speed, expected) in [(-247.3, 72.3), (-309.15, 133.5)] {
        let run = |shift: f64, end_time_s: f64| {
            simulate(&Case {
                model: Machine { speed_rad_s: speed, ..Machine::default() }.into(),
                start: if speed == -247.3 {
                    start(-0.0109, -0.0047, 3.3088, shift, 0.0020, -0.0041, 0.4224)
                } else {
                    start(-0.01, 0.01, 1.5, shift, -0.01, -0.01, 0.75)
                },
                simulation: Simulation { end_time_s, ..Simulation::default() },
            })
        };
        let (together, apart) = (run(0.0, 55.0), run(1e-6, 165.0));
        let cycle = together.evidence.cycle().expect("a closed orbit");
        let moduli: Vec<String> =
            cycle.multipliers.iter().map(|modulus| format!("{modulus:.4}")).collect();
        assert_eq!(together.evidence.name(), "unstable_orbit");
        assert_eq!((together.balls_running, cycle.turns.as_slice()), (Some(2), &[1, 1][..]));
        let speeds = together.mean_speed.as_ref().expect("they run");
        assert_eq!(speeds[0].to_bits(), speeds[1].to_bits(), "exactly side by side");
        assert!((speeds[0] / expected - 1.0).abs() < 0.01, "{speeds:?}");
        assert!((together.end_time_s.expect("ran") - 55.0).abs() < 1e-9);
        // A complex pair: the separation grows in a spiral. All other disturbances decay.
        let [first, second, third, ..] = cycle.multipliers[..] else { panic!("{cycle:?}") };
        assert!(second > 1.01 && (first - second).abs() < 1e-9 && third < 0.995, "{cycle:?}");
        assert_eq!(apart.evidence.name(), "rest_certified");
        assert!(apart.time_to_rest_s() > Some(50.0), "{apart:?}");
        let _ = writeln!(
            text,
            "| {speed} | {expected} | {:.2} | {} | {} | {} | {:.0} s |",
            speeds[0],
            together.label().name(),
            together.evidence.name(),
            moduli.join(", "),
            apart.time_to_rest_s().expect("at rest by 165 s"),
        );
    }
    text
}

/// Returns the cycles found from the thesis's start states, by class.
pub fn cycles() -> String {
    let mut text = "\
| speed [rad/s] | μ | class | runs | speed of the revolving ball [rad/s] | largest multiplier | neutral directions | angles of the other ball [rad] |
|---|---|---|---|---|---|---|---|
"
    .to_owned();
    let more = "balls: [{friction_coefficient: 1.0e-3}, {friction_coefficient: 2.0e-2}]";
    for (speed, friction, parameters) in [
        (-247.3, "2.75e-3", "friction_coefficient: 2.75e-3"),
        (-280.0, "2.75e-3", "friction_coefficient: 2.75e-3"),
        (-216.3772, "2.75e-4", "friction_coefficient: 2.75e-4"),
        (-247.3, "1e-3, 2e-2", more),
    ] {
        let runs = replicate(&format!("speed_rad_s: {speed}, {parameters}"), 66.0);
        let mut classes: BTreeMap<String, Vec<&Outcome>> = BTreeMap::new();
        for (case, outcome) in &runs {
            if let Some(class) = CycleClass::of(&case.model, outcome) {
                classes.entry(class.name).or_default().push(outcome);
            }
        }
        assert_eq!(classes.len(), 1, "{speed}: {:?}", classes.keys());
        for (class, outcomes) in &classes {
            let range =
                |values: &dyn Fn(&Outcome) -> [f64; 2]| {
                    outcomes.iter().map(|outcome| values(outcome)).fold(
                        [f64::INFINITY, f64::NEG_INFINITY],
                        |[low, high], [least, greatest]| [low.min(least), high.max(greatest)],
                    )
                };
            let cycle = |outcome: &Outcome| outcome.evidence.cycle().cloned().expect("a cycle");
            let running = |outcome: &Outcome| {
                let turns = cycle(outcome).turns;
                turns.iter().position(|&turns| turns != 0).expect("one runs")
            };
            let speeds = range(&|outcome| {
                [outcome.mean_speed.as_ref().expect("speeds")[running(outcome)]; 2]
            });
            let stays = range(&|outcome| {
                cycle(outcome).position_extremes[1 - running(outcome)]
                    .expect("it does not go round")
            });
            let largest = range(&|outcome| [cycle(outcome).multipliers[0]; 2])[1];
            let _ = writeln!(
                text,
                "| {speed} | {friction} | `{}` | {} | {:.4} .. {:.4} | {largest:.4} | {} | {:.3} .. \
                 {:.3} |",
                class.replace('|', "\\|"),
                outcomes.len(),
                speeds[0],
                speeds[1],
                cycle(outcomes[0]).neutral_directions,
                stays[0],
                stays[1],
            );
            assert!(largest < 1.0);
        }
    }
    text
}

/// Returns the cycles of the block on a belt: one class, with the period of the closed form.
pub fn block_on_belt() -> String {
    let study = shipped_study("block-on-belt.yaml");
    let mut text = "\
| belt speed [m/s] | runs | runs on the cycle | classes | largest relative error of the period |
|---|---|---|---|---|
"
    .to_owned();
    for point in (0..study.point_count()).map(|point| study.point(point)) {
        let runs = point.first_run..point.first_run + point.sampling.most;
        let ended: Vec<(Case, Outcome)> = runs
            .map(|run| {
                let case = study.planned_run(run).case.expect("a valid case");
                let outcome = simulate(&case);
                (case, outcome)
            })
            .collect();
        let block = Block::of(point.model()).expect("a block");
        let exact = block.stick_slip_cycle().expect("a stick-slip cycle").period_s;
        let cycles: Vec<_> =
            ended.iter().filter(|(_, outcome)| outcome.label() == Label::LimitCycle).collect();
        let classes: BTreeMap<String, usize> = cycles
            .iter()
            .map(|(case, outcome)| (CycleClass::of(&case.model, outcome).expect("a class").name, 1))
            .collect();
        let error = cycles
            .iter()
            .map(|(_, outcome)| {
                (outcome.evidence.period_s().expect("a period") / exact - 1.0).abs()
            })
            .fold(0.0, f64::max);
        assert!(error < 1e-6, "{error}");
        let names: Vec<&str> = classes.keys().map(String::as_str).collect();
        let _ = writeln!(
            text,
            "| {} | {} | {} | `{}` | {error:.0e} |",
            point.swept[0],
            ended.len(),
            cycles.len(),
            names.join("`, `"),
        );
    }
    text
}
