//! Runs of a disc that starts, run by run, against an independent integration: another language, the equations in a fixed
//! frame, another integrator and the exact motion (`scripts/reference/run_up.py`).

use stickslip::classification::{Label, Outcome, StageOutcome};
use stickslip::model::{
    Case, Machine, Method, ProfilePart, Ramp, RampShape, Simulation, SpeedProfile, Start,
};

use super::reference::{Row, rows};
use super::simulate_all::simulate_all;
use crate::support::angular_distance;

/// A run of the independent program.
struct Recorded {
    start_beta: [f64; 2],
    /// Angles and speeds of the balls at the end of the last ramp.
    reached_beta: [f64; 2],
    reached_speed_rad_s: [f64; 2],
    end_beta: [f64; 2],
    rests: bool,
    /// None for a run that does not rest.
    time_to_rest_s: Option<f64>,
}

fn recorded(speed: &str) -> Vec<Recorded> {
    let of = |row: Row| Recorded {
        start_beta: row.numbers(["beta_1_rad", "beta_2_rad"]),
        reached_beta: row.numbers(["reached_beta_1_rad", "reached_beta_2_rad"]),
        reached_speed_rad_s: row
            .numbers(["reached_ball_speed_1_rad_s", "reached_ball_speed_2_rad_s"]),
        end_beta: row.numbers(["end_beta_1_rad", "end_beta_2_rad"]),
        rests: row.text("label") == "equilibrium",
        time_to_rest_s: row.text("time_to_rest_s").parse().ok(),
    };
    rows(&format!("reference_run_up_{speed}")).map(of).collect()
}

fn ramp(to_rad_s: Option<f64>, over_s: f64) -> ProfilePart {
    ProfilePart::Ramp(Ramp { shape: RampShape::Linear, to_rad_s, over_s })
}

/// Returns the differences of angles and speeds in a stage, and of angles and the time to rest of a run that rests.
fn differences(run: &Recorded, outcome: &Outcome, reached: &StageOutcome) -> [f64; 4] {
    let apart = |found: &[f64], expected: [f64; 2]| {
        let pairs = found.iter().zip(expected);
        pairs.map(|(found, expected)| angular_distance(*found, expected)).fold(0.0, f64::max)
    };
    let speeds = reached.ball_speed_rad_s.iter().zip(run.reached_speed_rad_s);
    let faster = speeds.map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
    let end = run.rests.then(|| outcome.position.as_deref().expect("angles at rest"));
    let late = run
        .time_to_rest_s
        .map(|expected| (outcome.time_to_rest_s().expect("rests") - expected).abs());
    [
        apart(&reached.position, run.reached_beta),
        faster,
        end.map_or(0.0, |end| apart(end, run.end_beta)),
        late.unwrap_or(0.0),
    ]
}

/// Compares all runs at a speed: labels must agree. Returns the largest differences, with angles and speeds in the last stage before
/// the last corner of the speed.
fn compare(speed: &str, parts: &[ProfilePart], method: Method, band: f64) -> [f64; 4] {
    let recorded = recorded(speed);
    assert_eq!(recorded.len(), 64);
    let durations = parts.iter().map(|part| match part {
        ProfilePart::Ramp(ramp) => ramp.over_s,
        ProfilePart::Hold(hold_s) => hold_s.expect("a duration"),
        other => panic!("{other:?}"),
    });
    let over_s: f64 = durations.sum();
    let machine = Machine {
        speed_rad_s: -speed.parse::<f64>().expect("a speed"),
        speed_profile: Some(SpeedProfile { start_speed_rad_s: -10.0, parts: parts.to_vec() }),
        ..Machine::default()
    };
    let end_time_s = over_s + 8.0;
    let case = |run: &Recorded| Case {
        model: machine.clone().into(),
        start: Start::of_balancer([0.0; 2], &run.start_beta, [0.0; 2], &[0.0; 2]),
        simulation: Simulation { method, band, end_time_s, ..Simulation::default() },
    };
    let outcomes = simulate_all(&recorded.iter().map(case).collect::<Vec<_>>());
    let mut largest = [0.0_f64; 4];
    for (row, (run, outcome)) in recorded.iter().zip(&outcomes).enumerate() {
        let rests = outcome.label() == Label::Equilibrium;
        assert_eq!(rests, run.rests, "-{speed} rad/s, {method:?}, row {row}");
        let [.., reached, _] = outcome.stages.as_slice() else { panic!("two stages") };
        assert!((reached.time_s[1] - over_s).abs() < 1e-12);
        let found = differences(run, outcome, reached);
        largest = std::array::from_fn(|place| largest[place].max(found[place]));
    }
    println!("-{speed} rad/s, {method:?}: {largest:?}");
    largest
}

/// Below the natural frequency all labels agree. The angles at the end of the ramp and at rest agree to 1e-6 rad, in a ramp
/// in which all balls slip, and in a profile with a plateau, on which balls come to rest, and a second ramp, which lets
/// some of them break away.
#[test]
fn balls_follow_a_disc_that_starts() {
    let plateau = vec![ramp(Some(-140.0), 2.0), ProfilePart::Hold(Some(4.0)), ramp(None, 1.5)];
    for (speed, parts) in [("160.8103", vec![ramp(None, 3.0)]), ("173.1803", plateau)] {
        for method in [Method::Switch, Method::Event] {
            let largest = compare(speed, &parts, method, Simulation::default().band);
            let limits = [1e-6, 1e-5, 1e-6, 1e-5];
            assert!(largest.iter().zip(limits).all(|(found, limit)| *found < limit));
        }
    }
}

/// Balls that pass the natural frequency slip and stick 26 times on average, and small differences grow: those of the
/// switch model are proportional to its band, which is therefore narrow here. All labels agree, and all angles at the end
/// of the ramp and at rest agree to 1e-3 rad.
#[test]
fn balls_pass_the_natural_frequency() {
    let parts = [ramp(Some(-160.0), 2.0), ProfilePart::Hold(Some(3.0)), ramp(None, 4.0)];
    for (method, band) in [(Method::Event, Simulation::default().band), (Method::Switch, 1e-10)] {
        let largest = compare("216.3772", &parts, method, band);
        let limits = [1e-3, 1e-1, 1e-3, 1e-3];
        assert!(largest.iter().zip(limits).all(|(found, limit)| *found < limit));
    }
}
