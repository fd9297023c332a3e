//! Blocks that a periodic force shakes, against closed forms: Den Hartog's oscillator and the creep on a slope that vibrates.

use std::f64::consts::{PI, TAU};

use stickslip::classification::{CyclePhase, Outcome, simulate};
use stickslip::model::{Case, Method, Simulation};
use stickslip::motion::{Direction, Motion, Phase, Settings, Tolerance};

use super::outputs::cases;
use super::{METHODS, near};

/// A block of 1 kg with Coulomb friction under a normal force of 1 N, which the force `A cos φ - s` and maybe a spring of 1 N/m
/// pull: with these parameters, and from a start position and speed.
fn case(
    [frequency, amplitude, slope, stiffness, friction]: [f64; 5],
    [position, speed]: [f64; 2],
    method: Method,
) -> Case {
    let system = format!(
        "parameters: {{m: 1 kg, n: 1 N, w: {frequency:?} rad/s, a: {amplitude:?} N, s: {slope:?} N, k: {stiffness:?} N/m, mu: {friction:?}}}
coordinates: {{x: {{unit: m, start: {position:?}, start_rate: {speed:?}}}}}
mass: {{x: {{x: m}}}}
force: {{x: a * cos(w * t) - s - k * x}}
contacts: {{ground: {{normal: n, sliding: x', friction: {{coulomb: {{coefficient: mu}}}}}}}}
period: 2 * pi / w"
    );
    let case = cases(&system, 1, 400.0).remove(0);
    let tolerance = Tolerance { relative: 1e-11, absolute: 1e-13 };
    let simulation = Simulation { method, band: 1e-10, tolerance, ..case.simulation };
    Case { simulation, ..case }
}

fn run(parameters: [f64; 5], start: [f64; 2], method: Method) -> Outcome {
    simulate(&case(parameters, start, method))
}

/// The amplitude of the motion without stops, over the static deflection (J. P. Den Hartog, *Forced vibrations with combined
/// Coulomb and viscous friction*, Trans. ASME 53, 1931, 107-115): `A² = V² - (s U)²` with the friction `s` over the force, the
/// amplitude `V = 1 / (1 - r²)` without friction and `U = sin(π/r) / (r (1 + cos(π/r)))`.
fn den_hartog(ratio: f64, friction: f64) -> f64 {
    let [free, held] = terms(ratio);
    (free.powi(2) - (friction * held).powi(2)).sqrt()
}

/// The terms `V` and `U` of [`den_hartog`].
fn terms(ratio: f64) -> [f64; 2] {
    let (sine, cosine) = (PI / ratio).sin_cos();
    [1.0 / (1.0 - ratio * ratio), sine / (ratio * (1.0 + cosine))]
}

/// The program finds Den Hartog's motion without stops, at frequencies below and above the natural one.
#[test]
fn den_hartogs_oscillator_has_the_amplitude_of_the_closed_form() {
    for (ratio, friction) in [(0.8, 0.3), (0.6, 0.2), (1.3, 0.4), (1.6, 0.1)] {
        for method in METHODS {
            let outcome = run([ratio, 1.0, 0.0, 1.0, friction], [0.4, -0.1], method);
            assert_eq!(outcome.evidence.name(), "closed_orbit", "{ratio} {method:?}: {outcome:?}");
            near(outcome.amplitude_m, den_hartog(ratio, friction), 1e-9);
            near(outcome.evidence.period_s(), TAU / ratio, 1e-12);
            let cycle = outcome.evidence.cycle().expect("known");
            let mut phases = cycle.configurations.concat();
            phases.sort();
            assert_eq!(phases, [CyclePhase::Forward, CyclePhase::Backward], "{ratio}");
            assert!(cycle.multipliers.iter().all(|multiplier| *multiplier < 1.0));
        }
    }
}

/// The block begins to stop where its acceleration after a turning point would vanish: `s = r² A`, hence
/// `s = r² |V| / sqrt(1 + (r² U)²)` with the terms of [`den_hartog`].
#[test]
fn den_hartogs_oscillator_begins_to_stick_at_the_boundary_of_the_closed_form() {
    for ratio in [0.7, 0.9, 1.3] {
        let [free, held] = terms(ratio).map(|term| ratio * ratio * term);
        let boundary = free.abs() / (1.0 + held * held).sqrt();
        for (part, sticks) in [(0.99, false), (1.01, true)] {
            let friction = part * boundary;
            let outcome = run([ratio, 1.0, 0.0, 1.0, friction], [0.4, -0.1], Method::Event);
            assert_eq!(outcome.evidence.name(), "closed_orbit", "{ratio} {part}: {outcome:?}");
            let cycle = outcome.evidence.cycle().expect("known");
            let found = cycle.configurations.iter().any(|phases| phases[0] == CyclePhase::Stick);
            assert_eq!(found, sticks, "{ratio} {friction}: {:?}", cycle.configurations);
        }
    }
}

/// The force is ahead of the block: at the greatest deflection its phase has the cosine `A / V` and the sine `|s U / V|`
/// (Den Hartog 1931).
#[test]
fn den_hartogs_oscillator_lags_by_the_phase_of_the_closed_form() {
    for (ratio, friction) in [(0.8, 0.3), (1.3, 0.4)] {
        let case = case([ratio, 1.0, 0.0, 1.0, friction], [0.4, -0.1], Method::Event);
        let tolerance = Tolerance { relative: 1e-12, absolute: 1e-14 };
        let settings =
            Settings { method: Method::Event, band: 0.0, tolerance, effort_limit: 1_000_000 };
        let system = case.model.system().expect("a system");
        let state = case.model.start_state(&case.start).expect("a state");
        let natural = case.model.natural_frequency_rad_s();
        let mut motion = Motion::new(&system, settings, &state).expect("starts");
        let mut phase = f64::NAN;
        while motion.time() < 2000.0 * natural {
            let turns = motion.advance(2000.0 * natural).expect("continues");
            if turns && motion.phases()[0] == Phase::Slip(Direction::Backward) {
                phase = (ratio * motion.time() / natural).rem_euclid(TAU);
            }
        }
        let [free, held] = terms(ratio);
        let exact = (friction * held / free).abs().atan2(den_hartog(ratio, friction) / free);
        near(Some(phase), exact, 1e-9);
    }
}

/// With more friction the block stops twice or more often per period; the motion is still periodic.
#[test]
fn a_forced_oscillator_with_much_friction_stops() {
    for method in METHODS {
        let outcome = run([0.5, 1.0, 0.0, 1.0, 0.8], [0.1, 0.0], method);
        assert_eq!(outcome.evidence.name(), "closed_orbit", "{outcome:?}");
        let cycle = outcome.evidence.cycle().expect("known");
        let sticks = cycle.configurations.iter().filter(|phases| phases[0] == CyclePhase::Stick);
        assert!(sticks.count() >= 2, "{:?}", cycle.configurations);
    }
}

/// A block that friction holds against the force in every period is at rest, with the least margin of a period.
#[test]
fn a_block_that_friction_holds_against_the_force_is_at_rest() {
    for stiffness in [1.0, 0.0] {
        for method in METHODS {
            let outcome = run([0.8, 0.5, 0.1, stiffness, 0.8], [0.0, 0.0], method);
            assert_eq!(outcome.evidence.name(), "periodic_rest", "{outcome:?}");
            // The largest force is 0.6 of a limit of 0.8.
            near(outcome.evidence.friction_margin(), 0.25, 1e-7);
            near(outcome.time_to_rest_s(), 0.0, 0.0);
            assert!(outcome.evidence.cycle().is_none());
        }
    }
}

/// Returns the way that a block slides down a slope in one period: it breaks loose where `A cos φ - s = -μ`, and stops where
/// `A (sin φ - sin φ₁) = (s - μ) (φ - φ₁)`.
fn creep(frequency: f64, amplitude: f64, slope: f64, friction: f64) -> f64 {
    let loose = ((slope - friction) / amplitude).acos();
    let speed = |phase: f64| {
        (amplitude * (phase.sin() - loose.sin()) - (slope - friction) * (phase - loose)) / frequency
    };
    let (mut from, mut to) = (TAU - loose, TAU + loose);
    for _ in 0..100 {
        let middle = 0.5 * (from + to);
        *(if speed(middle) < 0.0 { &mut from } else { &mut to }) = middle;
    }
    let slid = from - loose;
    let moved = amplitude * (loose.cos() - from.cos() - slid * loose.sin())
        - 0.5 * (slope - friction) * slid * slid;
    moved / frequency.powi(2)
}

/// A block on a slope that vibrates sticks and creeps down in each period, by the way of the closed form.
#[test]
fn a_block_on_a_vibrating_slope_creeps_as_in_closed_form() {
    for (frequency, amplitude, slope, friction) in [(1.0, 0.5, 0.3, 0.6), (2.0, 0.9, 0.1, 0.95)] {
        let exact = creep(frequency, amplitude, slope, friction);
        assert!(exact < 0.0);
        for method in METHODS {
            let outcome = run([frequency, amplitude, slope, 0.0, friction], [0.3, 0.1], method);
            assert_eq!(outcome.evidence.name(), "closed_orbit", "{method:?}: {outcome:?}");
            let speed = outcome.mean_speed.as_ref().map(|speeds| speeds[0]);
            near(speed, exact * frequency / TAU, 1e-9);
            let cycle = outcome.evidence.cycle().expect("known");
            assert_eq!(cycle.configurations.len(), 2, "{:?}", cycle.configurations);
            assert_eq!(cycle.neutral_directions, 1);
        }
    }
}

/// A mass on a spring is held by friction to a base that shakes: it rests there, whether its coordinate is counted from the base or from
/// the ground.
#[test]
fn a_mass_rests_on_a_base_that_shakes() {
    for (sliding, force) in [
        ("x' - a * w * cos(w * t)", "-k * (x - a * sin(w * t))"),
        ("2 * (a * w * cos(w * t) - x')", "-k * (x - a * sin(w * t))"),
        ("x'", "-k * x + m * a * w^2 * sin(w * t)"),
    ] {
        let system = format!(
            "parameters: {{m: 5 kg, k: 2000 N/m, a: 4 mm, w: 10 rad/s, load: 30 N, mu: 0.25}}
coordinates: {{x: {{unit: m, start: [-2 mm, 2 mm]}}}}
mass: {{x: {{x: m}}}}
force: {{x: {force}}}
period: 2 * pi / w
contacts: {{damper: {{normal: load, sliding: {sliding}, friction: {{coulomb: {{coefficient: mu}}}}}}}}"
        );
        for (mut case, method) in
            cases(&system, 8, 60.0).into_iter().flat_map(|case| METHODS.map(|m| (case.clone(), m)))
        {
            case.simulation.method = method;
            let outcome = simulate(&case);
            assert_eq!(outcome.evidence.name(), "periodic_rest", "{sliding}: {outcome:?}");
            let margin = outcome.evidence.friction_margin().expect("it sticks");
            assert!((0.0..1.0).contains(&margin), "{outcome:?}");
        }
    }
}
