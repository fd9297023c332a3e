//! Runs in lockstep: equal bits in any lane, beside any neighbours and with any vectors, and the
//! endings of both kernels.

use stickslip::classification::{Label, simulate, simulate_by_recorded_equations};
use stickslip::model::Case;
use stickslip::motion::SimdLevel;

use super::simulate_all::{in_lockstep, simulate_all, simulate_all_by_recorded_equations};
use crate::support::{METHODS, angular_distance, cases_of, parse, shipped_study};

fn cases(samples: u32, simulation: &str, balls: u32, rest: &str) -> Vec<Case> {
    cases_of(&parse(format!(
        "schema: 1\nname: lockstep\nseed: 5\n\
         model: {{kind: ball_balancer, parameters: {{balls: {balls}}}}}\n\
         initial_conditions: {{design: {{monte_carlo: {{samples: {samples}}}}}}}\n\
         simulation: {simulation}\n{rest}"
    )))
}

/// Cases of all kinds side by side: one to eight balls, both methods, several speeds and
/// coefficients, viscous drag, uncertain masses, some continued, and a disc that starts before a kick.
fn mixed() -> Vec<Case> {
    let rest = "sweep: [{grid: {speed_rad_s: [-179.2671, -247.3], \
                friction_coefficient: [2.75e-3, 2.75e-4]}}]\n\
                uncertain: {stiffness_n_m: {uniform: {min: 1.05e4, max: 1.1e4}}}\n";
    let extended = "{end_time_s: 3.0, extend: {factor: 2, labels: [undecided, irregular]}, \
                    tolerance: {relative: 1.0e-6, absolute: 1.0e-8}}";
    let mut all = cases(5, extended, 2, rest);
    all.extend(cases(4, "{end_time_s: 4.0, method: event}", 2, rest));
    all.extend(cases(2, "{end_time_s: 2.0, method: event}", 3, rest));
    all.extend(cases(3, "{end_time_s: 4.0, endings: rest}", 2, rest));
    for balls in [1, 4, 5, 6, 7, 8] {
        all.extend(cases(1, "{end_time_s: 1.0}", balls, rest));
    }
    for case in all.iter_mut().skip(3).step_by(7) {
        let machine = case.model.ball_balancer_mut().expect("a balancer");
        machine.friction = stickslip::model::FrictionLaw::viscous(2e-4);
    }
    for contact in ["contact: {restitution: 0.5}, ", ""] {
        let protocol = "protocol: {startup_and_hammer: {over_s: 0.5, wait_s: 1}}";
        all.extend(cases_of(&parse(format!(
            "schema: 1\nname: a\nseed: 5\nmodel: {{kind: ball_balancer, {contact}{protocol}}}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 6}}}}}}\n"
        ))));
    }
    all
}

#[test]
fn bits_depend_neither_on_lanes_nor_on_neighbours_nor_on_vectors() {
    let cases = mixed();
    let best = in_lockstep(SimdLevel::best(), &cases, 0..cases.len());
    for level in SimdLevel::all() {
        assert_eq!(in_lockstep(level, &cases, 0..cases.len()), best, "{}", level.name());
    }
    // Another order gives other neighbours.
    let shuffled = (0..cases.len()).map(|k| (k * 31 + 7) % cases.len()).collect::<Vec<_>>();
    let mut sorted = shuffled.clone();
    sorted.sort_unstable();
    assert!(sorted.into_iter().eq(0..cases.len()), "the shuffle takes every run once");
    assert_eq!(in_lockstep(SimdLevel::best(), &cases, shuffled), best);
    for (case, outcome) in cases.iter().zip(&best).step_by(5) {
        assert_eq!(simulate(case), *outcome);
    }
    assert!(best.iter().step_by(5).any(|outcome| outcome.stages.len() > 2), "a start and a kick");
}

/// The thesis's study below the natural frequency gets the same labels and places of rest by the general kernel, which uses different
/// code, steps and event location; and so do one and three balls, in both directions and by both methods.
#[test]
fn endings_are_those_of_the_general_kernel() {
    let mut cases = cases_of(&shipped_study("preferred-equilibria.yaml"));
    cases.retain(|case| {
        let machine = case.model.ball_balancer().expect("a balancer");
        machine.speed_rad_s.abs() < machine.natural_frequency_rad_s()
    });
    assert_eq!(cases.len(), 2304);
    let sweep = "sweep: [{grid: {speed_rad_s: [-160.8103, -173.0, 150.0]}}]\n";
    for (balls, method) in [1, 2, 3].into_iter().flat_map(|balls| METHODS.map(|by| (balls, by))) {
        let mut of_balls = self::cases(6, "{end_time_s: 16.5}", balls, sweep);
        of_balls.iter_mut().for_each(|case| case.simulation.method = method);
        cases.extend(of_balls);
    }
    let [tuned, general] = [simulate_all(&cases), simulate_all_by_recorded_equations(&cases)];
    let mut at_rest = 0;
    for ((tuned, general), case) in tuned.iter().zip(&general).zip(&cases) {
        assert_eq!(tuned.label(), general.label(), "{case:?}");
        if tuned.label() == Label::Equilibrium {
            at_rest += 1;
            let places = tuned.position.iter().flatten().zip(general.position.iter().flatten());
            let apart = places.map(|(tuned, general)| angular_distance(*tuned, *general));
            assert!(apart.fold(0.0, f64::max) < 1e-3, "{case:?}");
        }
    }
    assert!(at_rest > 2304 + 80, "{at_rest}");
}

/// Without dry friction no condition detects that a ball turns back. Orbits in which each ball turns back are found, with the
/// same period by either kernel.
#[test]
fn reversals_without_a_switch_are_detected() {
    let mut cases = cases(24, "{end_time_s: 16.5, method: event}", 1, "");
    let (mut cycles, mut all_turn_back) = (0, 0);
    for case in &mut cases {
        let machine = case.model.ball_balancer_mut().unwrap();
        machine.speed_rad_s = -191.6372;
        machine.friction = stickslip::model::FrictionLaw::viscous(2e-4);
        let (tuned, general) = (simulate(case), simulate_by_recorded_equations(case));
        assert_eq!(tuned.evidence.name(), general.evidence.name(), "{case:?}");
        let (Some(cycle), Some(period_s)) = (tuned.evidence.cycle(), tuned.evidence.period_s())
        else {
            continue;
        };
        let other = general.evidence.period_s().expect("a cycle by the same evidence");
        assert!((period_s - other).abs() <= 1e-6 * period_s, "{period_s} {other}");
        cycles += 1;
        let turns_back = |[least, greatest]: &[f64; 2]| *least < 0.0 && *greatest > 0.0;
        all_turn_back += usize::from(cycle.speed_extremes.iter().all(turns_back));
    }
    assert!(cycles > 0 && all_turn_back > 0, "{cycles} {all_turn_back}: the runs show too little");
}
