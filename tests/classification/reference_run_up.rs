//! Runs of a disc that starts, run by run, against an independent integration: another language, the equations in a fixed
//! frame, another integrator and the exact motion (`scripts/reference/run_up.py`).

use stickslip::classification::Label;
use stickslip::model::{
    Case, Machine, Method, ProfilePart, Ramp, RampShape, Simulation, SpeedProfile, Start,
};

use super::simulate_all::simulate_all;
use crate::support::angular_distance;

/// A run of the independent program.
struct Recorded {
    start_beta: [f64; 2],
    /// Angles and speeds of the balls at the end of the last ramp.
    reached_beta: [f64; 2],
    reached_speed_rad_s: [f64; 2],
    end_beta: [f64; 2],
    label: String,
    time_to_rest_s: f64,
}

fn recorded(speed: &str) -> Vec<Recorded> {
    let path = format!("{}/tests/data/reference_run_up_{speed}.csv", env!("CARGO_MANIFEST_DIR"));
    let mut reader = csv::Reader::from_path(path).expect("the reference data are there");
    let header = reader.headers().expect("a header").clone();
    let rows = reader.records().map(|record| {
        let record = record.expect("a row");
        let text = |name: &str| {
            let column = header.iter().position(|column| column == name).expect("the column");
            record[column].to_owned()
        };
        let number = |name: &str| text(name).parse::<f64>().expect("a number");
        Recorded {
            start_beta: ["beta_1_rad", "beta_2_rad"].map(number),
            reached_beta: ["reached_beta_1_rad", "reached_beta_2_rad"].map(number),
            reached_speed_rad_s: ["reached_ball_speed_1_rad_s", "reached_ball_speed_2_rad_s"]
                .map(number),
            end_beta: ["end_beta_1_rad", "end_beta_2_rad"].map(number),
            label: text("label"),
            time_to_rest_s: number("time_to_rest_s"),
        }
    });
    rows.collect()
}

fn ramp(to_rad_s: Option<f64>, over_s: f64) -> ProfilePart {
    ProfilePart::Ramp(Ramp { shape: RampShape::Linear, to_rad_s, over_s })
}

/// The largest differences of all runs.
#[derive(Debug, Default)]
struct Differences {
    reached_beta: f64,
    reached_speed_rad_s: f64,
    end_beta: f64,
    time_to_rest_s: f64,
}

/// All labels agree. The angles at the end of the ramp and at rest agree to 1e-6 rad, in a ramp in which all balls slip and
/// in a profile with a plateau, on which balls come to rest, and a second ramp, which lets some of them break away.
#[test]
fn balls_follow_a_disc_that_starts() {
    let plateau = vec![ramp(Some(-140.0), 2.0), ProfilePart::Hold(Some(4.0)), ramp(None, 1.5)];
    for (speed, parts, over_s) in
        [("160.8103", vec![ramp(None, 3.0)], 3.0), ("173.1803", plateau, 7.5)]
    {
        let recorded = recorded(speed);
        assert_eq!(recorded.len(), 64);
        let speed_profile = Some(SpeedProfile { start_speed_rad_s: -10.0, parts });
        let speed_rad_s = -speed.parse::<f64>().expect("a speed");
        let machine = Machine { speed_rad_s, speed_profile, ..Machine::default() };
        for method in [Method::Switch, Method::Event] {
            let case = |run: &Recorded| Case {
                model: machine.clone().into(),
                start: Start::of_balancer([0.0; 2], &run.start_beta, [0.0; 2], &[0.0; 2]),
                simulation: Simulation {
                    method,
                    end_time_s: over_s + 8.0,
                    ..Simulation::default()
                },
            };
            let outcomes = simulate_all(&recorded.iter().map(case).collect::<Vec<_>>());
            let mut largest = Differences::default();
            let (mut slip, mut followed) = (0, 0);
            for (run, outcome) in recorded.iter().zip(&outcomes) {
                assert_eq!(run.label, "equilibrium");
                assert_eq!(outcome.label(), Label::Equilibrium, "{method:?} {:?}", run.start_beta);
                let [.., reached, _] = outcome.stages.as_slice() else { panic!("two stages") };
                assert!((reached.time_s[1] - over_s).abs() < 1e-12);
                let end = outcome.position.as_deref().expect("angles at rest");
                for ball in 0..2 {
                    let speed = run.reached_speed_rad_s[ball];
                    slip += u32::from(speed != 0.0);
                    followed += u32::from(speed == 0.0);
                    let found = reached.ball_speed_rad_s[ball];
                    let differences = Differences {
                        reached_beta: angular_distance(
                            reached.position[ball],
                            run.reached_beta[ball],
                        ),
                        reached_speed_rad_s: (found - speed).abs(),
                        end_beta: angular_distance(end[ball], run.end_beta[ball]),
                        time_to_rest_s: (outcome.time_to_rest_s.expect("rests")
                            - run.time_to_rest_s)
                            .abs(),
                    };
                    largest.include(&differences);
                }
            }
            println!(
                "-{speed} rad/s, {method:?}: {slip} balls slip at the end of the ramp, {followed} rest; {largest:?}"
            );
            assert!(slip >= 32 && (speed != "173.1803" || followed >= 32));
            assert!(largest.reached_beta < 1e-6 && largest.reached_speed_rad_s < 1e-4);
            assert!(largest.end_beta < 1e-6 && largest.time_to_rest_s < 1e-4);
        }
    }
}

impl Differences {
    fn include(&mut self, other: &Differences) {
        self.reached_beta = self.reached_beta.max(other.reached_beta);
        self.reached_speed_rad_s = self.reached_speed_rad_s.max(other.reached_speed_rad_s);
        self.end_beta = self.end_beta.max(other.end_beta);
        self.time_to_rest_s = self.time_to_rest_s.max(other.time_to_rest_s);
    }
}
