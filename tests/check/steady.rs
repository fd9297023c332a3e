//! Steady states of systems in files against their closed forms.

use stickslip::check::{SteadyStates, SteadyValues};
use stickslip::study::Study;

use crate::support::{parse, shipped_study};

/// Returns the steady states at the points of a study.
fn states_of(study: &Study) -> Vec<Option<SteadyStates>> {
    let points = (0..study.point_count()).map(|point| study.point(point));
    points.map(|point| SteadyStates::of(point.model(), &point.start_ranges)).collect()
}

/// Returns the steady states at the points of a study of this repository.
fn states(name: &str) -> Vec<Option<SteadyStates>> {
    states_of(&shipped_study(name))
}

#[track_caller]
fn only(states: &Option<SteadyStates>) -> SteadyValues {
    let states = states.as_ref().expect("they are sought");
    assert_eq!(states.held_fraction, None, "all contacts slide");
    let [state] = &states.sliding[..] else { panic!("state state: {states:?}") };
    state.clone()
}

/// A block on a spring is held up to the friction limit over the stiffness, and starts at up to the normal force over it.
#[test]
fn a_block_on_the_ground_is_held_up_to_its_friction_limit() {
    let held = states("block-on-spring.yaml").into_iter().map(|states| states.expect("a block"));
    let held: Vec<f64> = held.map(|states| states.held_fraction.expect("it may stick")).collect();
    for (held, coefficient) in held.iter().zip([0.0, 0.02, 0.05, 0.1, 0.2]) {
        assert!((held - coefficient).abs() < 0.01, "{held} at {coefficient}");
    }
}

/// A block slides on a belt where its spring pulls with the kinetic friction. Small motions neither grow nor decay with a constant
/// coefficient. With one that falls with the sliding speed, they decay at half of the rate of damping and of the slope.
#[test]
fn blocks_slide_on_belts_where_springs_pull_with_the_friction() {
    for block in states("block-on-belt.yaml") {
        let SteadyValues { coordinates, stability, .. } = only(&block);
        assert!((coordinates["position_m"] - 0.01).abs() < 1e-12, "{coordinates:?}");
        assert_eq!(stability.name(), "marginal");
    }
    let oscillator = only(&states("belt-oscillator.yaml")[0]);
    let decay = (-1.5_f64 / 0.5).exp();
    assert!((oscillator.coordinates["x"] - (0.5 + 0.5 * decay)).abs() < 1e-9, "{oscillator:?}");
    let rate = -0.5 * (2.0 * 0.05 - decay);
    assert!((oscillator.largest_real_part_1_s - rate).abs() < 1e-9, "{oscillator:?} {rate}");
    assert_eq!(oscillator.stability.name(), "stable");
    assert_eq!(states("woodpecker.yaml"), [None], "its contacts open");
}

/// A system that changes with time has no steady states, and `check` says nothing about them.
#[test]
fn equations_with_the_time_have_no_steady_states() {
    let text = "schema: 1\nname: a\nseed: 1\nmodel:\n  system:\n    system: a\n    parameters: {s: 1, v: 1}\n    \
                coordinates: {x: {start: [0, 1]}}\n    mass: {x: {x: 1}}\n    force: {x: -x + exp(-t / s)}\n    \
                contacts: {belt: {normal: 1, sliding: x' - v, friction: {coulomb: {coefficient: 0.1}}}}\n\
                initial_conditions: {design: {monte_carlo: {samples: 2}}}\n";
    for text in [text.to_owned(), text.replace("exp(-t / s)", "log(x - 0.2)")] {
        let states = states_of(&parse(text.clone())).remove(0);
        let sliding = states.map_or(0, |states| states.sliding.len());
        assert_eq!(sliding, 0, "{text}");
    }
}

/// A pendulum that a belt carries has one stable and one unstable place in a turn: `sin phi = 0.5`.
#[test]
fn angles_are_within_one_turn() {
    let text = "schema: 1\nname: a\nseed: 1\nmodel:\n  system:\n    system: a\n    parameters: {v: 10}\n    \
                coordinates: {phi: {unit: rad, start: [0, 2 * pi], periodic: true}}\n    mass: {phi: {phi: 1}}\n    \
                force: {phi: -sin(phi) - 0.1 * phi'}\n    \
                contacts: {belt: {normal: 1, sliding: phi' - v, friction: {coulomb: {coefficient: 0.5}}}}\n\
                initial_conditions: {design: {monte_carlo: {samples: 2}}}\n";
    let states = states_of(&parse(text)).remove(0).expect("they are sought");
    let mut found: Vec<_> = states
        .sliding
        .iter()
        .map(|states| (states.stability.name(), states.coordinates[0]))
        .collect();
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    let [(low, first), (high, second)] = found[..] else { panic!("{found:?}") };
    assert_eq!([low, high], ["stable", "unstable"]);
    let sixth = std::f64::consts::PI / 6.0;
    assert!((first - sixth).abs() < 1e-9 && (second - 5.0 * sixth).abs() < 1e-9, "{found:?}");
}

/// A spring pulls a block at a constant speed, from rest. Steady sliding is stable above the speed at which the slope of the friction law equals
/// the damping; small motions grow at half of the difference.
#[test]
fn a_pulled_block_slides_steadily_above_its_critical_speed() {
    let text = "schema: 1\nname: a\nseed: 1\nmodel:\n  system:\n    system: a\n    parameters: {m: 1 kg, k: 100 N/m, c: 1 N s/m, v: 1 m/s, load: 10 N}\n    \
                coordinates: {x: {unit: m, start: [-0.1, 0.1]}}\n    mass: {x: {x: m}}\n    force: {x: \"k * (v * t - x) + c * (v - x')\"}\n    \
                contacts: {table: {normal: load, sliding: x', friction: {stribeck: {coefficient: 0.2, static_coefficient: 0.4, stribeck_speed: 0.1 m/s}}}}\n\
                sweep: [{grid: {v_m_s: [0.02, 0.1, 0.29, 0.31, 2]}}]\ninitial_conditions: {design: {monte_carlo: {samples: 2}}}\n";
    let found = states_of(&parse(text));
    for (states, speed) in found.iter().zip([0.02_f64, 0.1, 0.29, 0.31, 2.0]) {
        let [sliding] = &states.as_ref().expect("they are sought").sliding[..] else {
            panic!("{states:?}")
        };
        assert!((sliding.coordinates["x_rate_m_s"] - speed).abs() < 1e-9, "{sliding:?}");
        assert!(sliding.coordinates.len() == 1, "{sliding:?}");
        assert_eq!(
            sliding.stability.name(),
            if speed < 0.1 * 20_f64.ln() { "unstable" } else { "stable" }
        );
        let rate = 0.5 * (20.0 * (-speed / 0.1).exp() - 1.0);
        // Above 10 rad/s, small motions do not oscillate.
        if rate < 10.0 {
            assert!((sliding.largest_real_part_1_s - rate).abs() < 1e-9, "{sliding:?} {rate}");
        }
    }
}
