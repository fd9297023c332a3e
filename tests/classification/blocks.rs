//! Blocks on springs: place and time of rest, cycles, and motions without a claim.

use super::{METHODS, near, position};
use crate::support::{Block, Ground};
use stickslip::classification::{CyclePhase, Label, Outcome, simulate};
use stickslip::model::{Case, FrictionLaw, Method, Simulation, Start, Tolerance};

fn run(block: &Block, start: [f64; 2], method: Method, end_time_s: f64) -> Outcome {
    let simulation = Simulation {
        method,
        end_time_s,
        tolerance: Tolerance { relative: 1e-11, absolute: 1e-13 },
        ..Simulation::default()
    };
    simulate(&Case { model: block.clone().into(), start: Start(start.to_vec()), simulation })
}

fn drop_at_once(static_friction_coefficient: f64) -> FrictionLaw {
    FrictionLaw::stribeck(static_friction_coefficient, 0.0)
}

/// A block stops at the place and time of the closed form (thesis figure 4.2), a damped oscillation in each half swing, up to a
/// third of critical damping (20 N s/m), with one switch for each turning point; the switch model passes through a transition at
/// all but the last, and at a start from rest.
#[test]
fn a_block_stops_where_and_when_the_closed_form_says() {
    let damped = FrictionLaw::coulomb_viscous;
    let mut longest = 0;
    for (block, most) in [
        (Block::on_spring(), [0.12, 1.1]),
        (Block { mass_kg: 0.2, normal_force_n: 3.0, ..Block::on_spring() }, [0.12, 1.1]),
        (Block { friction: drop_at_once(0.25), ..Block::on_spring() }, [0.12, 1.1]),
        (Block { friction: damped(0.0), ..Block::on_spring() }, [0.2, 2.1]),
        (Block { friction: damped(0.3), ..Block::on_spring() }, [0.2, 2.1]),
        (Block { friction: damped(2.0), ..Block::on_spring() }, [0.2, 2.1]),
        (Block { friction: damped(7.0), ..Block::on_spring() }, [0.2, 2.1]),
    ] {
        for k in 0..60 {
            let spread = |factor: f64| (f64::from(k) * factor + 0.3).sin();
            let velocity = if k % 3 == 0 { 0.0 } else { most[1] * spread(2.3) };
            let start = [most[0] * spread(1.1), velocity];
            let exact = block.stopping(start[0], start[1]).expect("dry friction");
            let turning_points = exact.turning_points_m.len();
            let end = exact.turning_points_m[turning_points - 1];
            longest = longest.max(turning_points);
            for method in METHODS {
                let outcome = run(&block, start, method, 100.0);
                assert_eq!(outcome.evidence.name(), "rest_certified", "{start:?}");
                near(position(&outcome), end, 1e-10);
                // The band is an error in speed; its error in time grows as the block turns more
                // slowly.
                let late = match (method, block.friction.name()) {
                    (Method::Event, _) => 1e-9,
                    (Method::Switch, "coulomb_viscous") => 1e-5,
                    (Method::Switch, _) => 1e-6,
                };
                near(outcome.time_to_rest_s(), exact.time_s, late);
                near(outcome.amplitude_m, 0.0, 0.0);
                let hold = block.friction.largest_ratio(block.friction_coefficient)
                    * block.unit_length_m();
                near(outcome.evidence.friction_margin(), 1.0 - end.abs() / hold, 1e-8);
                let (moving, swings) = (u64::from(velocity != 0.0), turning_points as u64 - 1);
                let switches = match method {
                    Method::Event => swings + moving,
                    Method::Switch => 2 * swings + moving,
                };
                assert_eq!(outcome.effort.switches, switches, "{start:?} {method:?}");
            }
        }
    }
    assert!(longest >= 9, "{longest}");
}

/// A block at rest inside the rest set, or on its edge, stays there from the first instant.
#[test]
fn blocks_in_the_rest_set_stay_at_rest() {
    for method in METHODS {
        for place in [-0.01, -0.005, 0.0, 0.009_999, 0.01] {
            let outcome = run(&Block::on_spring(), [place, 0.0], method, 10.0);
            assert_eq!(outcome.evidence.name(), "rest_certified", "{place}");
            near(position(&outcome), place, 0.0);
            near(outcome.time_to_rest_s(), 0.0, 0.0);
        }
        let outcome = run(&Block::on_spring(), [0.0101, 0.0], method, 10.0);
        near(outcome.time_to_rest_s(), std::f64::consts::PI / 10.0, 1e-6);
    }
}

/// At a turning point exactly on the edge, rounding may add a half swing of zero width, but does
/// not change the position.
#[test]
fn turning_points_on_the_edge_are_final() {
    for (start, swings, end) in
        [(0.03, 1.0, -0.01), (-0.05, 2.0, -0.01), (0.13, 6.0, 0.01), (0.25, 12.0, 0.01)]
    {
        for method in METHODS {
            let outcome = run(&Block::on_spring(), [start, 0.0], method, 100.0);
            assert_eq!(outcome.evidence.name(), "rest_certified", "{start}");
            near(position(&outcome), end, 1e-9);
            assert!(
                outcome.evidence.friction_margin() >= Some(0.0),
                "{:?}",
                outcome.evidence.friction_margin()
            );
            let counted = outcome.time_to_rest_s().expect("at rest") * 10.0 / std::f64::consts::PI;
            let over = counted - swings;
            assert!(over.abs() < 1e-6 || (over - 1.0).abs() < 1e-6, "{start}: {counted}");
        }
    }
}

/// The cycle is Leine's closed-form stick-slip cycle, from starts on either side of it.
#[test]
fn a_block_on_a_belt_has_the_cycle_of_the_closed_form() {
    for (fixed, speed_m_s) in [(0.2, 0.1), (0.11, 0.02), (0.5, 1.0), (0.4, 0.003)] {
        let ground = Ground::Belt { speed_m_s };
        let block = Block { friction: drop_at_once(fixed), ground, ..Block::on_belt() };
        let exact = block.stick_slip_cycle().expect("static above kinetic friction");
        for start in [[0.0, speed_m_s], [0.3, 0.0], [-0.2, -1.0], [0.0, 3.0]] {
            for method in METHODS {
                let outcome = run(&block, start, method, 1000.0);
                assert_eq!(outcome.evidence.name(), "closed_orbit", "{fixed} {start:?}");
                // The band of 1e-8 m/s, over the smallest acceleration where the block is captured, 0.1 m/s², is 1e-7 s.
                near(outcome.evidence.period_s(), exact.period_s, 1e-7 * exact.period_s.max(1.0));
                near(outcome.amplitude_m, exact.amplitude_m, 1e-9);
                assert_eq!(outcome.time_to_rest_s(), None);
                let cycle = outcome.evidence.cycle().expect("known");
                assert_eq!(cycle.configurations, [[CyclePhase::Backward], [CyclePhase::Stick]]);
                // It swings back through the position where the spring balances kinetic friction.
                let natural = block.natural_frequency_rad_s();
                let [[least, greatest]] = cycle.speed_extremes[..] else { panic!("one contact") };
                near(Some(least), -speed_m_s - natural * exact.amplitude_m, 1e-7);
                near(Some(greatest), 0.0, 1e-7);
                near(Some(cycle.peak_amplitude_m), exact.amplitude_m, 1e-9);
                assert_eq!((&cycle.turns, cycle.multipliers.len()), (&vec![0], 1));
                assert!(cycle.multipliers[0] < 1e-6, "{cycle:?}");
                assert_eq!(cycle.neutral_directions, 0);
                // The cycle is known after some break-aways, long before the end time.
                assert!(outcome.end_time_s.expect("known") < 6.0 * exact.period_s + 10.0);
            }
        }
    }
}

/// Inside the cycle, and alone for equal coefficients, are orbits on which the block slides
/// permanently, with the amplitude of its start. No such orbit attracts: its multiplier is 1. The outermost one touches
/// the belt's speed, where the multiplier depends on the side.
#[test]
fn a_block_that_slides_permanently_repeats() {
    let dropping = Block { friction: drop_at_once(0.2), ..Block::on_belt() };
    for (block, start, radius) in [
        (&dropping, [0.016, 0.0], 0.006),
        (&dropping, [0.01, 0.05], 0.005),
        (&Block::on_belt(), [0.016, 0.0], 0.006),
        // From stick, and from far outside: onto the orbit that touches the belt's speed.
        (&Block::on_belt(), [0.0, 0.1], 0.01),
        (&Block::on_belt(), [0.3, -0.4], 0.01),
    ] {
        for method in METHODS {
            let outcome = run(block, start, method, 100.0);
            assert_eq!(outcome.evidence.name(), "repeats", "{start:?} {method:?} {outcome:?}");
            assert_eq!((outcome.label(), outcome.time_to_rest_s()), (Label::Periodic, None));
            near(outcome.amplitude_m, radius, 1e-6);
            near(outcome.evidence.period_s(), 0.2 * std::f64::consts::PI, 1e-9);
            let cycle = outcome.evidence.cycle().expect("a cycle");
            assert!(cycle.multipliers.iter().all(|one| (one - 1.0).abs() < 1e-6), "{cycle:?}");
        }
    }
}

/// Returns period, least and greatest position of a cycle under the Stribeck law with a positive
/// speed, by an independent program: the classical Runge-Kutta method with tiny steps, and
/// bisection.
fn stribeck_cycle(fixed: f64, kinetic: f64, speed: f64, belt: f64) -> (f64, f64, f64) {
    let acceleration = |x: f64, v: f64| {
        let ratio = kinetic + (fixed - kinetic) * (-(belt - v).max(0.0) / speed).exp();
        10.0 * ratio - 100.0 * x
    };
    let step = |[x, v]: [f64; 2], h: f64| {
        let k1 = [v, acceleration(x, v)];
        let k2 = [v + 0.5 * h * k1[1], acceleration(x + 0.5 * h * k1[0], v + 0.5 * h * k1[1])];
        let k3 = [v + 0.5 * h * k2[1], acceleration(x + 0.5 * h * k2[0], v + 0.5 * h * k2[1])];
        let k4 = [v + h * k3[1], acceleration(x + h * k3[0], v + h * k3[1])];
        let mean = |i: usize| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0;
        [x + h * mean(0), v + h * mean(1)]
    };
    let h = 2e-5;
    let bisect = |from: [f64; 2], over: &dyn Fn([f64; 2]) -> bool| {
        let (mut low, mut high) = (0.0, h);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if over(step(from, middle)) { high = middle } else { low = middle }
        }
        (high, step(from, high))
    };
    let break_away = 0.1 * fixed;
    let (mut state, mut time) = ([break_away, belt], 0.0);
    let (mut least, mut most) = (f64::MAX, f64::MIN);
    loop {
        let next = step(state, h);
        if state[1] > 0.0 && next[1] <= 0.0 {
            most = most.max(bisect(state, &|s| s[1] <= 0.0).1[0]);
        }
        if state[1] < 0.0 && next[1] >= 0.0 {
            least = least.min(bisect(state, &|s| s[1] >= 0.0).1[0]);
        }
        if time > 0.1 && next[1] >= belt {
            let (part, [x, _]) = bisect(state, &|s| s[1] >= belt);
            return (time + part + (break_away - x) / belt, least, most);
        }
        (state, time) = (next, time + h);
        assert!(time < 100.0);
    }
}

#[test]
fn stribeck_cycles_agree_with_an_independent_integration() {
    for (fixed, stribeck_speed, speed_m_s) in
        [(0.2, 0.05, 0.1), (0.3, 0.5, 0.1), (0.15, 0.02, 0.05)]
    {
        let (period, least, most) = stribeck_cycle(fixed, 0.1, stribeck_speed, speed_m_s);
        let friction = FrictionLaw::stribeck(fixed, stribeck_speed);
        let block = Block { friction, ground: Ground::Belt { speed_m_s }, ..Block::on_belt() };
        for method in METHODS {
            let outcome = run(&block, [0.0, 0.0], method, 100.0);
            assert_eq!(outcome.evidence.name(), "closed_orbit", "{fixed} {stribeck_speed}");
            near(outcome.evidence.period_s(), period, 1e-6);
            near(outcome.amplitude_m, 0.5 * (most - least), 1e-7);
        }
    }
}

/// With viscous friction the motion is the damped oscillation of the closed form, on rigid ground
/// and on a belt.
#[test]
fn viscous_friction_gives_the_damped_oscillation() {
    for ground in [Ground::Fixed, Ground::Belt { speed_m_s: 0.1 }] {
        for drag in [0.0, 0.3, 2.0, 20.0, 100.0] {
            let friction = FrictionLaw::viscous(drag);
            let block = Block { friction, ground, ..Block::on_spring() };
            let start = [0.03, -0.2];
            let exact = block.damped_oscillation(start[0], start[1], 0.7).expect("viscous");
            for method in METHODS {
                let outcome = run(&block, start, method, 0.7);
                assert_eq!(outcome.effort.switches, 0);
                near(position(&outcome), exact[0], 1e-10);
            }
        }
    }
}

/// A smooth law cannot hold a block (thesis section 3.3.1): a block that Coulomb friction holds
/// creeps to the position of the relaxed spring, as in the closed form without inertia.
#[test]
fn smooth_friction_does_not_hold() {
    for (smoothing_speed, end_time_s) in [(1e-4, 5.0), (1e-4, 20.0), (1e-4, 80.0), (2e-6, 10.0)] {
        let friction = FrictionLaw::smooth(smoothing_speed);
        let block = Block { friction, ..Block::on_spring() };
        let held = run(&Block::on_spring(), [0.008, 0.0], Method::Switch, end_time_s);
        near(position(&held), 0.008, 0.0);
        let exact = block.creep_position_m(0.008, end_time_s).expect("inside");
        for method in METHODS {
            let outcome = run(&block, [0.008, 0.0], method, end_time_s);
            assert_ne!(outcome.evidence.name(), "rest_certified");
            assert_eq!(outcome.evidence.error(), None);
            near(position(&outcome), exact, 0.1 * smoothing_speed);
        }
        assert!(exact < 0.008 - 0.5 * smoothing_speed * end_time_s.min(20.0), "{exact}");
    }
}

/// Parameter values of any size, as in a sweep or a sample, give an outcome.
#[test]
fn extreme_values_end_in_an_outcome() {
    let laws = [
        FrictionLaw::COULOMB,
        FrictionLaw::stribeck(1e300, 1e-300),
        FrictionLaw::smooth(1e-300),
        FrictionLaw::viscous(1e300),
        FrictionLaw::coulomb_viscous(1e300),
    ];
    for friction in laws {
        for (mass_kg, stiffness_n_m, normal_force_n, speed_m_s) in [
            (1e300, 1e-300, 10.0, 0.1),
            (1.0, 100.0, 1e-300, 0.1),
            (1.0, 100.0, 1e300, 0.1),
            (1.0, 100.0, 10.0, 1e300),
            (1.0, 100.0, 10.0, 1e-300),
        ] {
            for ground in [Ground::Fixed, Ground::Belt { speed_m_s }] {
                let friction_coefficient = 0.1;
                let block = Block {
                    mass_kg,
                    stiffness_n_m,
                    normal_force_n,
                    friction_coefficient,
                    friction,
                    ground,
                };
                for method in METHODS {
                    let outcome = run(&block, [0.03, 0.1], method, 1.0);
                    assert_eq!(
                        outcome.evidence.error().is_some(),
                        outcome.label() == Label::Failed
                    );
                }
            }
        }
    }
}

/// The extremes of the last tenth of the time are correct for a block that hardly moves in it: half
/// of the range of `0.1 cos(ω t)` from 14.85 s to 16.5 s.
#[test]
fn extremes_of_slow_swings() {
    for mass_kg in [0.5, 100.0, 1e4, 1e6] {
        let block = Block { mass_kg, friction_coefficient: 0.0, ..Block::on_spring() };
        let natural = block.natural_frequency_rad_s();
        let at = |step: u32| 0.1 * (natural * (14.85 + 1.65e-5 * f64::from(step))).cos();
        let range = (0..=100_000).map(at).fold((f64::MAX, f64::MIN), |(low, high), position| {
            (low.min(position), high.max(position))
        });
        let outcome = run(&block, [0.1, 0.0], Method::Event, 16.5);
        near(outcome.amplitude_m, 0.5 * (range.1 - range.0), 1e-8);
    }
}
