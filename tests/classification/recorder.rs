//! Recorded motions equal the run's motion bit for bit, and satisfy the laws of friction.

use stickslip::classification::{
    Instants, Label, Outcome, RecordedRun, RunRecorder, simulate, simulate_recorded,
};
use stickslip::model::{Balancer, Case, Simulation, State, Tolerance};
use stickslip::motion::{Phase, SLACK, Settings};

use crate::support::{cases_of, for_each_kernel, go_on, parse, start_of, started, state_of};

/// Returns the cases of a study with a model, a design and a simulation.
pub fn cases(model: &str, samples: u32, simulation: &str) -> Vec<Case> {
    cases_of(&parse(format!(
        "schema: 1\nname: a\nseed: 7\nmodel: {model}\ninitial_conditions: {{design: {{monte_carlo: \
         {{samples: {samples}}}}}}}\nsimulation: {simulation}\n"
    )))
}

/// Runs of all kinds.
fn all_kinds() -> Vec<Case> {
    let balls = |parameters: &str| format!("{{kind: ball_balancer, parameters: {{{parameters}}}}}");
    let smooth = "{kind: ball_balancer, friction: {smooth: {smoothing_speed_rad_s: 2}}}";
    let viscous = "{kind: ball_balancer, friction: {viscous: {viscous_coefficient_n_s_m: 2.0e-4}}}";
    let no_solution = "table_mass_kg: 2.0e-2, ball_mass_kg: 1.5e-1, speed_rad_s: -60, \
                       friction_coefficient: 3";
    let belt = "{kind: block_on_belt, friction: {stribeck: {static_friction_coefficient: 0.2, \
                stribeck_speed_m_s: 0}}}";
    let extend = "{end_time_s: 1.5, extend: {factor: 3, labels: [undecided, irregular]}}";
    [
        cases(&balls("speed_rad_s: -179.2671"), 4, "{end_time_s: 6}"),
        cases(&balls("speed_rad_s: -216.3772"), 4, "{end_time_s: 3, method: event}"),
        cases(&balls("speed_rad_s: -216.3772"), 6, extend),
        cases(&balls("balls: 1"), 3, "{end_time_s: 2}"),
        cases(&balls("balls: 3"), 3, "{end_time_s: 2, method: event}"),
        cases(&balls(no_solution), 12, "{end_time_s: 1}"),
        cases(smooth, 2, "{end_time_s: 0.3}"),
        cases(smooth, 1, "{end_time_s: 0.2, extend: {factor: 2, labels: [undecided]}}"),
        cases(viscous, 2, "{end_time_s: 0.5, method: event}"),
        cases("{kind: block_on_spring}", 4, "{end_time_s: 5}"),
        cases(belt, 4, "{end_time_s: 5, method: event}"),
    ]
    .concat()
}

/// Returns the outcome of a case and its record.
pub fn recorded(case: &Case, instants: Instants) -> (Outcome, RecordedRun) {
    let mut recorder = RunRecorder::new(instants, 10_000_000);
    let outcome = simulate_recorded(case, &mut recorder);
    (outcome, recorder.finish())
}

/// Recording does not change the outcome. Every step is recorded once, from the start to the end of the run, with every switch.
#[test]
fn a_record_is_whole_and_changes_nothing() {
    let (mut extended, mut failures, mut equilibria, mut switches) = (0, 0, 0, 0);
    for case in all_kinds() {
        let outcome = simulate(&case);
        let [_, latest] = case.simulation.end_times_s();
        let natural = case.model.natural_frequency_rad_s();
        let times = (0..=500).map(|k| latest * natural * f64::from(k) / 500.0).collect();
        let instants = [
            Instants::EveryStep { inside: 3 },
            Instants::At(times),
            Instants::EveryStep { inside: 0 },
        ];
        let [dense, at_times, steps] = instants.map(|instants| {
            let (same, recording) = recorded(&case, instants);
            assert_eq!(same, outcome, "{case:?}");
            recording
        });
        let RecordedRun { samples, switches: log, cut_off, .. } = steps;
        assert_eq!((&dense.switches, &at_times.switches, cut_off), (&log, &log, false));
        let failed = outcome.label() == Label::Failed;
        extended += u32::from(outcome.extended);
        failures += u32::from(failed);
        equilibria += u32::from(outcome.label() == Label::Equilibrium);
        assert_eq!(log.len() as u64, outcome.effort.switches, "{case:?}");
        switches += log.len();
        let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
            assert!(failed, "{case:?}");
            continue;
        };
        assert_eq!((first.time, first.step), (0.0, 0));
        assert_eq!(Some(last.time / natural), outcome.end_time_s.or(Some(last.time / natural)));
        let mut steps: Vec<u64> = samples.iter().map(|sample| sample.step).collect();
        steps.dedup();
        assert!(steps.iter().copied().eq(0..steps.len() as u64), "{case:?}");
        let taken = outcome.effort.steps + 1 - steps.len() as u64;
        assert!(taken == 0 || failed && taken == 1, "{case:?}: {taken}");
        assert!(samples.windows(2).all(|pair| pair[0].time <= pair[1].time));
        let unit = case.model.units().contacts[0].position;
        for (contact, position) in outcome.position.iter().flatten().enumerate() {
            let apart = last.contacts[contact].position * unit - position;
            let turn = std::f64::consts::TAU;
            let apart =
                if case.model.balls() > 0 { apart - (apart / turn).round() * turn } else { apart };
            assert!(apart.abs() < 1e-9 || failed, "{apart} {case:?}");
        }
    }
    assert!(extended > 2 && failures > 3 && equilibria > 8, "{extended} {failures} {equilibria}");
    assert!(switches > 1000, "{switches}");
}

/// Successive switches of every contact are consistent; friction in stick is within its limit, and
/// friction in slip follows the law.
#[test]
fn friction_obeys_its_law() {
    let (mut held, mut slipping) = (0, 0);
    for case in all_kinds() {
        let (_, recording) = recorded(&case, Instants::EveryStep { inside: 2 });
        let contacts = case.model.contacts();
        for contact in 0..contacts {
            let of_contact = recording.switches.iter().filter(|switch| switch.contact == contact);
            let switches: Vec<_> = of_contact.collect();
            assert!(switches.windows(2).all(|pair| pair[0].after.phase == pair[1].before.phase));
            assert!(switches.iter().all(|switch| switch.before.phase != switch.after.phase));
        }
        let of_balls = case.model.ball_balancer().into_iter().flat_map(|machine| &machine.balls);
        let of_balls = of_balls.map(|ball| ball.friction_coefficient);
        let kinetic: Vec<f64> =
            case.model.friction_coefficient().into_iter().chain(of_balls).collect();
        for contact in
            recording.samples.iter().flat_map(|sample| sample.contacts.iter().enumerate())
        {
            let (number, contact) = contact;
            match contact.phase {
                Phase::Stick => {
                    held += 1;
                    assert!(contact.friction.abs() <= contact.limit + 2.0 * SLACK, "{contact:?}");
                }
                Phase::Slip(direction) | Phase::Transition(direction) => {
                    slipping += 1;
                    let law = direction * kinetic[number] * contact.normal;
                    assert!((contact.friction - law).abs() < 1e-12 * (1.0 + contact.normal.abs()));
                    assert!(direction * contact.speed >= -1.01 * case.simulation.band);
                }
                Phase::Free | Phase::Apart | Phase::Open | Phase::Closed => {}
            }
        }
    }
    assert!(held > 10_000 && slipping > 10_000, "{held} {slipping}");
}

/// The states inside steps agree with motions of both kernels at tighter tolerances.
#[test]
fn times_agree_with_motions_at_tighter_tolerances() {
    for case in cases("{kind: ball_balancer}", 6, "{end_time_s: 0.3}") {
        let machine = case.model.ball_balancer().unwrap();
        let natural = machine.natural_frequency_rad_s();
        let balancer = Balancer::<2>::new(machine).unwrap();
        let times: Vec<f64> = (0..=400).map(|k| 0.25 * natural * f64::from(k) / 400.0).collect();
        let (_, recording) = recorded(&case, Instants::At(times.clone()));
        let tight = Simulation {
            tolerance: Tolerance { relative: 1e-11, absolute: 1e-13 },
            ..case.simulation
        };
        let settings = Settings::new(&tight, 1_000_000);
        let start: State<2> = start_of(&case.start);
        assert_eq!(recording.samples.len(), times.len());
        let kernels = for_each_kernel(balancer);
        let mut motions = kernels.each_ref().map(|system| started(system, settings, &start));
        let samples = recording.samples.iter().zip(times);
        for (motion, (sample, time)) in
            samples.flat_map(|sample| [0, 1].map(|kernel| (kernel, sample)))
        {
            let motion = &mut motions[motion];
            assert_eq!(sample.time, time);
            go_on(motion, time);
            let state: State<2> = state_of(motion);
            let [x, y, x_dot, y_dot] = sample.table.unwrap();
            let table = [
                x - state.position[0],
                y - state.position[1],
                x_dot - state.velocity[0],
                y_dot - state.velocity[1],
            ];
            assert!(table.iter().all(|apart| apart.abs() < 1e-6), "{table:?} at {time}");
            for (ball, contact) in sample.contacts.iter().enumerate() {
                let apart = [
                    contact.position - motion.unwrapped()[ball],
                    contact.speed - state.beta_dot[ball],
                    contact.normal - motion.now().forces[ball].normal,
                ];
                assert!(apart.iter().all(|apart| apart.abs() < 1e-5), "{apart:?} at {time}");
            }
        }
    }
}

#[test]
fn too_long_a_motion_is_cut_off_and_says_so() {
    let case = &cases("{kind: ball_balancer}", 1, "{end_time_s: 0.2}")[0];
    let mut recorder = RunRecorder::new(Instants::EveryStep { inside: 0 }, 10);
    let outcome = simulate_recorded(case, &mut recorder);
    let recording = recorder.finish();
    assert_eq!(outcome, simulate(case));
    assert_eq!((recording.samples.len(), recording.cut_off), (10, true));
}
