//! Continued runs equal runs with the later end time from the start, bit for bit.

use super::METHODS;
use crate::support::{Block, Ground, cases_of, parse};
use stickslip::classification::{Label, Outcome, simulate};
use stickslip::model::{Case, Extend, ExtendedLabels, FrictionLaw, Machine, Simulation, Start};

/// With the first factor, the last tenth begins before the end time.
const FACTORS: [f64; 3] = [1.05, 2.0, 4.0];

/// The outcome of a continued case, and the outcomes with either end time alone.
struct Ways {
    extended: Outcome,
    short: Outcome,
    long: Outcome,
}

impl Ways {
    fn of(case: &Case, extend: Extend) -> Self {
        let run = |end_time_s: f64, extend: Option<Extend>| {
            let simulation = Simulation { end_time_s, extend, ..case.simulation };
            simulate(&Case { simulation, ..case.clone() })
        };
        let end = case.simulation.end_time_s;
        Ways {
            extended: run(end, Some(extend)),
            short: run(end, None),
            long: run(extend.factor * end, None),
        }
    }

    /// Returns whether the run was continued; it must equal the long run if so, and otherwise the
    /// short run.
    #[track_caller]
    fn continued(&self) -> bool {
        let continued = self.extended.extended;
        let goes_on = [Label::Undecided, Label::Irregular].contains(&self.short.label());
        assert_eq!(continued, goes_on);
        same(&self.extended, if continued { &self.long } else { &self.short });
        continued
    }
}

/// Asserts equality bit for bit, except for the mark of the continued run: numbers are printed so
/// that they parse to the same bits.
#[track_caller]
fn same(found: &Outcome, expected: &Outcome) {
    let found = Outcome { extended: false, ..found.clone() };
    assert_eq!(&found, expected);
    assert_eq!(format!("{found:?}"), format!("{expected:?}"));
}

fn still_moving(factor: f64) -> Extend {
    Extend { factor, labels: ExtendedLabels::default() }
}

fn cases(model: &str, samples: u32, simulation: Simulation) -> Vec<Case> {
    let text = format!(
        "schema: 1\nname: a\nseed: 11\nmodel: {model}\n\
         initial_conditions: {{design: {{monte_carlo: {{samples: {samples}}}}}}}\n"
    );
    let cases = cases_of(&parse(text));
    cases.into_iter().map(|case| Case { simulation, ..case }).collect()
}

/// Continued runs of balls equal the longer runs, below and above the natural frequency, where runs rest, are irregular, remain
/// undecided and find limit cycles; also if they settle or fail after the end time, with different or more balls and a disc that
/// starts.
#[test]
fn a_continued_run_of_balls_is_the_longer_run() {
    let (mut seen, mut ends) = (Vec::new(), [0; Label::ALL.len()]);
    let at = |speed: f64| format!("{{kind: ball_balancer, parameters: {{speed_rad_s: {speed}}}}}");
    let speeds = [-160.8, -191.6372, -216.3772, -247.3];
    let viscous = "{kind: ball_balancer, parameters: {speed_rad_s: -250}, \
                   friction: {viscous: {viscous_coefficient_n_s_m: 5.0e-4}}}";
    let light = "{kind: ball_balancer, parameters: {speed_rad_s: -216.3772, \
                 friction_coefficient: 2.75e-4}}";
    let three = "{kind: ball_balancer, parameters: {balls: 3}}";
    let newton = "{kind: ball_balancer, parameters: {speed_rad_s: -160.8}, normal_force: newton}";
    let starts = "{kind: ball_balancer, parameters: {speed_rad_s: -150}, contact: {}, \
                  speed_profile: [{ramp: {from_rad_s: -31, over_s: 0.4}}]}";
    let others = [
        (viscous, 5.0, 8),
        (light, 4.0, 8),
        (three, 2.0, 8),
        (newton, 0.01, 100),
        (starts, 1.0, 8),
    ]
    .map(|(model, end_time_s, samples)| (model.to_owned(), end_time_s, samples, [4.0; 3]));
    for (model, end_time_s, samples, factors) in
        speeds.map(|speed| (at(speed), 1.5, 30, FACTORS)).into_iter().chain(others)
    {
        let mut continued = 0;
        for method in METHODS {
            let simulation = Simulation { method, end_time_s, ..Simulation::default() };
            for (index, case) in cases(&model, samples, simulation).iter().enumerate() {
                let ways = Ways::of(case, still_moving(factors[index % 3]));
                if ways.continued() {
                    continued += 1;
                    ends[ways.long.label() as usize] += 1;
                    seen.push(ways.long.evidence.name());
                }
            }
        }
        assert!(continued >= 20 || samples != 30, "{model}: {continued}");
    }
    // The sample must contain continued runs with different endings.
    assert!(ends[Label::Equilibrium as usize] >= 20 && ends[Label::Undecided as usize] >= 20);
    for evidence in ["rest_certified", "settled", "closed_orbit", "contact_lost", "end_time"] {
        assert!(seen.contains(&evidence), "{evidence} not among {seen:?}");
    }
}

/// Continued runs of blocks that stop late, find their cycle late, slide permanently, and settle
/// late equal the longer runs, for end times at any phase of a swing.
#[test]
fn a_continued_run_of_a_block_is_the_longer_run() {
    let drops = FrictionLaw::stribeck(0.2, 0.0);
    let damps = FrictionLaw::viscous(2.0);
    let mut seen = Vec::new();
    let frictionless = Block { friction_coefficient: 0.0, ..Block::on_spring() };
    for (block, start) in [
        (Block::on_spring(), [0.25, 0.0]),
        (frictionless.clone(), [0.1, 0.3]),
        (Block { mass_kg: 1e4, ..frictionless }, [0.1, 0.0]),
        (Block { friction: damps, ..Block::on_spring() }, [0.1, 0.0]),
        (Block::on_belt(), [0.016, 0.0]),
        (Block::on_belt(), [0.0, 0.1]),
        (Block { friction: drops, ..Block::on_belt() }, [0.3, 0.0]),
        (Block { friction: damps, ..Block::on_belt() }, [0.1, 0.0]),
        (Block { ground: Ground::Belt { speed_m_s: 0.003 }, ..Block::on_belt() }, [0.0, 0.0]),
    ] {
        for method in METHODS {
            for factor in FACTORS {
                for end in 0..40 {
                    let end_time_s = 0.05 + 0.113 * f64::from(end);
                    let simulation = Simulation { method, end_time_s, ..Simulation::default() };
                    let (model, start) = (block.clone().into(), Start(start.to_vec()));
                    let ways = Ways::of(&Case { model, start, simulation }, still_moving(factor));
                    if ways.continued() {
                        seen.push(ways.long.evidence.name());
                    }
                }
            }
        }
    }
    for evidence in ["rest_certified", "settled", "closed_orbit", "end_time"] {
        assert!(seen.contains(&evidence), "{evidence} not among {seen:?}");
    }
}

/// End times at all points of the first steps give the longer run.
#[test]
fn end_times_may_lie_on_steps() {
    let case = Case {
        model: Machine::default().into(),
        start: Start::of_balancer([0.01, 0.0], &[1.0, 4.0], [0.0, 0.02], &[0.5, -0.3]),
        simulation: Simulation::default(),
    };
    let mut steps = std::collections::BTreeSet::new();
    for end in 1..400 {
        let end_time_s = 1e-4 * f64::from(end);
        let simulation = Simulation { end_time_s, ..Simulation::default() };
        let ways = Ways::of(&Case { simulation, ..case.clone() }, still_moving(1.05));
        assert!(ways.continued());
        steps.insert(ways.short.effort.steps);
    }
    assert!(steps.len() >= 10, "{steps:?}");
}

/// Only the requested labels are continued.
#[test]
fn other_labels_are_not_continued() {
    let model = "{kind: ball_balancer}";
    let simulation = Simulation { end_time_s: 2.0, ..Simulation::default() };
    let mut undecided = 0;
    for case in cases(model, 20, simulation) {
        let none =
            Extend { factor: 2.0, labels: ExtendedLabels { undecided: false, irregular: true } };
        let ways = Ways::of(&case, none);
        same(&ways.extended, &ways.short);
        assert!(!ways.extended.extended);
        undecided += usize::from(ways.short.evidence.name() == "end_time");
    }
    assert!(undecided >= 5, "{undecided}");
}

/// The longer run is given up within a second, because it cannot reach its end; a run to be
/// continued is given up at the same step, even though it could reach its own end time.
#[test]
fn the_limit_of_effort_is_that_of_the_longer_run() {
    let slippery = FrictionLaw::smooth(1e200);
    let case = |end_time_s: f64, extend: Option<Extend>| Case {
        model: Machine { friction: slippery, ..Machine::default() }.into(),
        start: Start::of_balancer([0.01, 0.0], &[1.0, 4.0], [0.0; 2], &[0.5, -0.3]),
        simulation: Simulation { end_time_s, extend, ..Simulation::default() },
    };
    let extended = simulate(&case(1e7, Some(still_moving(1000.0))));
    assert_eq!(extended.evidence.name(), "step_limit");
    assert!(!extended.extended);
    same(&extended, &simulate(&case(1e10, None)));
}
