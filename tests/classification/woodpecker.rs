//! The woodpecker toy: a sleeve with play on a pole, with a bird on a spring, slides down by impacts and stick (C. Glocker,
//! *Dynamik von Starrkörpersystemen mit Reibung und Stößen*, VDI 1995; R. I. Leine, C. Glocker, D. H. van Campen, *Nonlinear
//! dynamics of the woodpecker toy*, Proc. ASME DETC 2001, VIB-21608). Three contacts with friction: the beak, the lower and the
//! upper edge of the sleeve.

use stickslip::classification::simulate;
use stickslip::model::{Case, Method, Simulation};
use stickslip::motion::{Motion, Phase, Settings, Tolerance};

use crate::support::{cases_of, go_on, parse};

/// Returns the bird with this angle at the start. With -0.2788 rad, it is in the slide before the sleeve sticks, as the example of
/// Siconos starts (V. Acary, O. Bonnefon, M. Brémond, O. Huber, F. Pérignon, S. Sinclair, *An introduction to Siconos*, INRIA
/// TR-0340, 2019): the lower edge touches.
fn case(bird: f64) -> Case {
    let text = format!(
        "schema: 1\nname: a\nseed: 7\nmodel: {{system: systems/woodpecker.yaml}}\n\
         initial_conditions:\n  box: {{phi_bird_rad: [{bird}, {bird}]}}\n  design: {{monte_carlo: {{samples: 1}}}}\n"
    );
    cases_of(&parse(text)).remove(0)
}

fn motion(case: &Case, relative: f64) -> Motion {
    let tolerance = Tolerance { relative, absolute: 1e-2 * relative };
    let settings =
        Settings { method: Method::Event, band: 0.0, tolerance, effort_limit: 1_000_000 };
    let start = case.model.start_state(&case.start).expect("a state");
    Motion::new(&case.model.system().expect("a system"), settings, &start).expect("starts")
}

/// The motion of Siconos by time stepping (Moreau and Jean, steps of 2e-5 s), whose impacts are up to a step late.
#[test]
fn the_motion_is_that_of_time_stepping() {
    let case = case(-0.2788);
    let (units, system) = (case.model.units(), case.model.system().expect("a system"));
    let mut motion = motion(&case, 1e-11);
    // Height, angles of the sleeve and of the bird, and their speeds, in SI units.
    for (time_s, phases, published) in [
        (
            0.03,
            Some([Phase::Apart, Phase::Stick, Phase::Apart]),
            [-4.40745e-3, 0.0, -0.526191, 0.0, 0.0, -2.83141],
        ),
        (0.29998, None, [-41.348e-3, -0.103448, -0.340934, -0.260137, 0.0, -8.32756_f64]),
    ] {
        go_on(&mut motion, time_s * units.natural_rad_s);
        assert!(phases.is_none_or(|phases| motion.phases() == phases), "{:?}", motion.phases());
        for place in [0, 2, 3, 5] {
            let found = system.outputs(&motion.state())[place] * units.outputs[place].size;
            let off = (found - published[place]) / published[place].abs().max(0.05);
            assert!(off.abs() < 0.01, "{place}: {found} {}", published[place]);
        }
    }
}

/// Returns the slope of the return map from successive returns: the ratio of the changes of the bird's least angle, which it
/// reaches while the sleeve sticks.
fn slope_of_returns() -> f64 {
    let mut motion = motion(&case(-0.2788), 1e-12);
    let mut least = Vec::new();
    while least.len() < 40 {
        motion.advance(1e4).expect("continues");
        if motion.phases_during_step()[1] == Phase::Stick {
            least.extend(motion.falls_through_zero(|state| -state[5]).map(|(_, state)| state[2]));
        }
    }
    (least[39] - least[38]) / (least[38] - least[37])
}

/// The bird comes down on a limit cycle, by either method and from two starts. The period and the mean speed are those of an
/// independent time stepping (steps of 1e-5 s) to its accuracy, and the multiplier is the slope of successive returns.
#[test]
fn the_bird_comes_down_on_a_limit_cycle() {
    let slope = slope_of_returns();
    assert!(slope < 0.0, "it swings from side to side: {slope}");
    for (method, band) in [(Method::Event, 0.0), (Method::Switch, 1e-8)] {
        for bird in [-0.2788, -0.30] {
            let tolerance = Tolerance { relative: 1e-10, absolute: 1e-12 };
            let simulation =
                Simulation { method, band, end_time_s: 20.0, tolerance, ..Simulation::default() };
            let outcome = simulate(&Case { simulation, ..case(bird) });
            assert_eq!(outcome.evidence.name(), "closed_orbit", "{method:?} {bird}: {outcome:?}");
            let period_s = outcome.evidence.period_s().expect("a cycle has a period");
            assert!((period_s - 0.14600).abs() < 5e-5, "{period_s}");
            let cycle = outcome.evidence.cycle().expect("known");
            assert!((cycle.multipliers[0] + slope).abs() < 1e-4, "{slope} {cycle:?}");
            assert!(
                cycle.multipliers[1..].iter().all(|multiplier| *multiplier < 1e-6),
                "{cycle:?}"
            );
            assert_eq!(cycle.neutral_directions, 1, "the height");
            // The height is the coordinate of the lower edge of the sleeve.
            let mean = outcome.mean_speed.expect("the bird moves on")[1];
            assert!((mean + 0.1332).abs() < 1e-4, "{mean}");
        }
    }
}
