//! What every motion has: exchange of balls, mirror image, whole turns of a ball.

use stickslip::ending::{Outcome, simulate};
use stickslip::model::{Case, Machine, Simulation, Start};

fn case(speed_rad_s: f64, start: Start) -> Case {
    let machine = Machine { speed_rad_s, ..Machine::default() };
    let simulation = Simulation { end_time_s: 4.0, ..Simulation::default() };
    Case { machine, start, simulation }
}

fn starts() -> Vec<Start> {
    (0..12)
        .map(|k| {
            let spread = |factor: f64| (f64::from(k) * factor + 0.3).sin();
            Start {
                x: 0.05 * spread(1.1),
                y: 0.05 * spread(2.3),
                beta: vec![3.0 + 3.0 * spread(3.1), 3.0 + 3.0 * spread(4.7)],
                x_dot: 0.05 * spread(5.9),
                y_dot: 0.05 * spread(7.3),
                beta_dot: vec![spread(8.9), spread(10.7)],
            }
        })
        .collect()
}

fn swapped(mut values: Vec<f64>) -> Vec<f64> {
    values.swap(0, 1);
    values
}

/// Two balls exchanged in machine and start give the exchanged result, to the last bit, with the
/// same effort.
#[test]
fn exchanged_balls_give_the_exchanged_result() {
    for alike in [true, false] {
        for start in starts() {
            let mut original = case(-216.3772, start.clone());
            if !alike {
                original.machine.balls[1].mass_kg *= 1.5;
                original.machine.balls[1].friction_coefficient *= 0.5;
            }
            let mut exchanged = original.clone();
            exchanged.machine.balls.swap(0, 1);
            exchanged.start.beta.swap(0, 1);
            exchanged.start.beta_dot.swap(0, 1);
            let (first, second) = (simulate(&original), simulate(&exchanged));
            let undone = Outcome {
                beta_rad: second.beta_rad.clone().map(swapped),
                ball_speed_rad_s: second.ball_speed_rad_s.clone().map(swapped),
                ..second
            };
            assert_eq!(first, undone);
        }
    }
}

/// The mirror image: speed, y and all angles with the other sign. Signs are exact, so that the
/// mirrored run differs only where an angle is wrapped into [0, 2π).
#[test]
fn mirror_image_gives_the_mirrored_result() {
    for start in starts() {
        let original = simulate(&case(-179.2671, start.clone()));
        let negative = |values: &[f64]| values.iter().map(|value| -value).collect::<Vec<_>>();
        let mirrored = simulate(&case(
            179.2671,
            Start {
                y: -start.y,
                y_dot: -start.y_dot,
                beta: negative(&start.beta),
                beta_dot: negative(&start.beta_dot),
                ..start
            },
        ));
        assert_eq!(original.label(), mirrored.label());
        let angles = original.beta_rad.iter().flatten().zip(mirrored.beta_rad.iter().flatten());
        for (a, b) in angles {
            let sum = (a + b).rem_euclid(std::f64::consts::TAU);
            assert!(sum.min(std::f64::consts::TAU - sum) < 1e-6, "{a} {b}");
        }
    }
}

/// A whole turn of a ball more or less changes nothing but rounding.
#[test]
fn whole_turns_change_nothing() {
    for start in starts() {
        let original = simulate(&case(-173.1803, start.clone()));
        let mut turned = start;
        turned.beta[0] += std::f64::consts::TAU;
        turned.beta[1] -= 2.0 * std::f64::consts::TAU;
        let turned = simulate(&case(-173.1803, turned));
        assert_eq!(original.label(), turned.label());
        for (a, b) in original.beta_rad.iter().flatten().zip(turned.beta_rad.iter().flatten()) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }
}
