//! Runs with rest as the only detected ending: runs that come to rest are unchanged, and all others
//! are undecided.

use stickslip::classification::{Label, Outcome, simulate, simulate_by_recorded_equations};
use stickslip::model::{
    Case, Endings, Extend, ExtendedLabels, Machine, Method, Model, Simulation, Start,
};

fn starts(balls: usize) -> impl Iterator<Item = Start> {
    (0..24).map(move |number| {
        let value = |k: usize| libm::sin((17 * number + 5 * k) as f64);
        let beta: Vec<f64> = (0..balls).map(|ball| 3.0 + 3.0 * value(ball)).collect();
        let beta_dot: Vec<f64> = (0..balls).map(|ball| value(10 + ball)).collect();
        let table = |k: usize| [0.05 * value(k), 0.05 * value(k + 1)];
        Start::of_balancer(table(20), &beta, table(22), &beta_dot)
    })
}

/// Returns the outcome of a case, and of the same case with rest as the only detected ending.
fn both(case: &Case, simulate: impl Fn(&Case) -> Outcome) -> [Outcome; 2] {
    [Endings::All, Endings::Rest].map(|endings| {
        let simulation = Simulation { endings, ..case.simulation };
        simulate(&Case { simulation, ..case.clone() })
    })
}

/// Asserts that the two agree, and returns the label of the first.
#[track_caller]
fn compare([all, rest]: [Outcome; 2]) -> Label {
    let label = all.label();
    match label {
        Label::Equilibrium | Label::Failed => {
            assert_eq!(format!("{all:?}"), format!("{rest:?}"));
        }
        Label::LimitCycle
        | Label::Periodic
        | Label::Creep
        | Label::QuasiPeriodic
        | Label::Irregular
        | Label::Undecided => {
            assert_eq!((rest.evidence.name(), rest.label()), ("end_time", Label::Undecided));
            assert!(rest.evidence.cycle().is_none() && rest.lyapunov.is_none());
            assert!(rest.amplitude_m.is_some(), "{rest:?}");
        }
    }
    label
}

#[test]
fn balls_come_to_rest_as_with_all_endings() {
    let mut seen = [0; Label::ALL.len()];
    let extend = Some(Extend { factor: 1.5, labels: ExtendedLabels::default() });
    for (speed_rad_s, balls, friction_coefficient, extend) in [
        (-160.8, 2, 2.75e-3, None),
        (-191.6372, 2, 2.75e-3, extend),
        (-216.3772, 2, 2.75e-4, None),
        (-247.3, 3, 2.75e-3, None),
    ] {
        let mut machine = Machine { speed_rad_s, ..Machine::default() };
        machine.balls[0].friction_coefficient = friction_coefficient;
        machine.balls.resize(balls, machine.balls[0]);
        for method in [Method::Event, Method::Switch] {
            for (number, start) in starts(balls).enumerate() {
                let model: Model = machine.clone().into();
                let simulation =
                    Simulation { method, end_time_s: 16.5, extend, ..Simulation::default() };
                let case = Case { model, start, simulation };
                seen[compare(both(&case, simulate)) as usize] += 1;
                if number < 2 {
                    compare(both(&case, simulate_by_recorded_equations));
                }
            }
        }
    }
    let [equilibria, cycles, _, _, _, irregular, undecided, _] = seen;
    assert!(equilibria > 20 && cycles > 5 && irregular + undecided > 5, "{seen:?}");
}
