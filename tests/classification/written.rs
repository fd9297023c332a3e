//! Systems in files end as the systems of Rust programs, and as publications say.

use stickslip::classification::{Label, Outcome, found_endings, simulate};
use stickslip::model::{Case, Machine, Simulation};
use stickslip::study::Study;

use crate::support::{angular_distance, cases_of, parse, shipped};

/// Returns the outcomes of the runs of a study of this folder, with some texts replaced.
fn outcomes(name: &str, replaced: &[(&str, &str)]) -> Vec<Outcome> {
    let mut text = std::fs::read_to_string(shipped(name)).expect("a study");
    for (old, new) in replaced {
        assert!(text.contains(old), "{old}");
        text = text.replace(old, new);
    }
    cases_of(&parse(text)).iter().map(simulate).collect()
}

/// Steady sliding of the oscillator of Stender et al. (2020) in 0.312 of the start states; of 600 here, 4 standard errors.
#[test]
fn a_belt_oscillator_of_a_file_slides_as_often_as_published() {
    let all = outcomes("belt-oscillator.yaml", &[("samples: 4000", "samples: 600")]);
    let fraction =
        |label| all.iter().filter(|outcome| outcome.label() == label).count() as f64 / 600.0;
    let slides = fraction(Label::Equilibrium);
    assert!((slides - 0.312).abs() < 4.0 * (0.312_f64 * 0.688 / 600.0).sqrt(), "{slides}");
    assert_eq!(fraction(Label::Undecided) + fraction(Label::Failed), 0.0);
}

/// A pendulum without contacts comes to rest if it is damped: an amplitude of 1 rad decays as exp(-t / 10 s) to 1e-6 in 138 s.
/// Without damping it swings on, which no evidence decides.
#[test]
fn a_damped_pendulum_comes_to_rest() {
    let folder = tempfile::tempdir().expect("a folder");
    for (damping, label) in [("0.2", Label::Equilibrium), ("0", Label::Undecided)] {
        let system = format!(
            "system: pendulum\nmeaning: a pendulum\nparameters: {{l: 1 m, c: {damping} N m s, g: 9.81 m/s^2, m: 1 kg}}\n\
             coordinates:\n  phi: {{unit: rad, start: [0.1, 1], periodic: true}}\n\
             mass: {{phi: {{phi: m * l^2}}}}\nforce: {{phi: -m * g * l * sin(phi) - c * phi'}}\n"
        );
        std::fs::write(folder.path().join("pendulum.yaml"), system).expect("a file");
        let study = "schema: 1\nname: a\nseed: 1\nmodel: {system: pendulum.yaml}\n\
                     initial_conditions: {design: {latin_hypercube: {samples: 8}}}\nsimulation: {end_time_s: 200}\n";
        let study = Study::parse(&folder.path().join("a.yaml"), study.to_owned()).expect("valid");
        for case in cases_of(&study) {
            // A report says that a longer simulation finds more rests.
            assert!(found_endings(&case.model).rests);
            let outcome = simulate(&case);
            assert_eq!(outcome.label(), label, "{outcome:?}");
            if label == Label::Equilibrium {
                let time = outcome.time_to_rest_s().expect("a time");
                assert!((100.0..145.0).contains(&time), "{time}");
                let angle = outcome.outputs[0].end;
                assert!(angular_distance(angle, 0.0) < 1e-5, "{angle}");
            }
        }
    }
}

/// The balancer with two balls, written as a file, ends as the built-in one does: its normal forces are reactions that contain
/// accelerations.
#[test]
fn a_balancer_of_a_file_ends_as_the_built_one() {
    let mut rests = 0;
    for speed_rad_s in [-160.8103, -216.3772] {
        let machine = Machine { speed_rad_s, ..Machine::default() };
        let natural = machine.natural_frequency_rad_s();
        let ball = machine.balls[0];
        let mass = machine.table_mass_kg + machine.imbalance_mass_kg + 2.0 * ball.mass_kg;
        let radius = machine.ring_radius_m;
        let text = format!(
            "schema: 1\nname: a\nseed: 2003\nmodel:\n  system: systems/ball_balancer.yaml\n  parameters:\n    \
             omega: {}\n    m: {}\n    imbalance: {}\n    zeta: {}\n    d: {}\n    mu: {}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 48}}}}}}\n\
             simulation: {{end_time_s: {}}}\n",
            speed_rad_s / natural,
            ball.mass_kg / mass,
            machine.imbalance_mass_kg * machine.imbalance_radius_m / (mass * radius),
            machine.damping_n_s_m / (2.0 * mass * natural),
            ball.diameter_m / radius,
            ball.friction_coefficient,
            16.5 * natural,
        );
        for (run, written) in cases_of(&parse(text)).into_iter().enumerate() {
            let (model, start) = (machine.clone().into(), written.start.clone());
            let built = simulate(&Case { model, start, simulation: Simulation::default() });
            let written = simulate(&written);
            assert_eq!(
                built.evidence.name(),
                written.evidence.name(),
                "{speed_rad_s} {run}: {built:?} {written:?}"
            );
            if built.label() == Label::Equilibrium {
                let [built, written] =
                    [built, written].map(|outcome| outcome.position.expect("positions"));
                for (built, written) in built.iter().zip(written) {
                    assert!(angular_distance(*built, written) < 1e-5, "{run}: {built} {written}");
                }
                rests += 1;
            }
        }
    }
    assert!(rests > 60, "{rests}");
}

/// Stick and slip of light balls are decided in one way in all states, and those of balls as heavy as the machine are not.
#[test]
fn light_balls_have_one_solution_everywhere() {
    let sure = |kind: &str| {
        let text = format!(
            "schema: 1\nname: a\nseed: 1\nmodel: {kind}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 1}}}}}}\n"
        );
        parse(text).model().system().expect("a system").surely_one_solution()
    };
    let balancer = |values: &str| {
        sure(&format!("{{system: systems/ball_balancer.yaml, parameters: {{{values}}}}}"))
    };
    assert!(balancer("count: 2") && balancer("count: 8") && sure("{kind: rotor_balancer}"));
    assert!(!balancer("m: 0.4") && !balancer("m: 0.1, mu: 5"));
}
