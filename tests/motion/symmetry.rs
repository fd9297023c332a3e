//! Symmetries of every motion: mirror image, whole turns of a ball.

use stickslip::classification::simulate;
use stickslip::model::{Case, Machine, Method, Simulation, Start};

use crate::support::{METHODS, angular_distance, spread_start};

fn case(speed_rad_s: f64, start: Start, method: Method) -> Case {
    let machine = Machine { speed_rad_s, ..Machine::default() };
    let simulation = Simulation { method, end_time_s: 4.0, ..Simulation::default() };
    Case { model: machine.into(), start, simulation }
}

fn starts() -> impl Iterator<Item = (Method, Start)> {
    METHODS.into_iter().flat_map(|method| (0..12).map(move |k| (method, spread_start(k))))
}

/// The mirror image (speed, y and all angles with the opposite sign) gives the mirrored motion.
/// Signs are exact, so that the mirrored run differs only where an angle is reduced to [0, 2π).
#[test]
fn mirror_image_gives_the_mirrored_result() {
    for (method, start) in starts() {
        let original = simulate(&case(-179.2671, start.clone(), method));
        let signs = [1.0, -1.0, -1.0, -1.0, 1.0, -1.0, -1.0, -1.0];
        let mirrored = start.0.iter().zip(signs).map(|(value, sign)| sign * value).collect();
        let mirrored = simulate(&case(179.2671, Start(mirrored), method));
        assert_eq!(original.label(), mirrored.label());
        let angles = original.position.iter().flatten().zip(mirrored.position.iter().flatten());
        for (a, b) in angles {
            assert!(angular_distance(*a, -b) < 1e-6, "{a} {b}");
        }
    }
}

/// Adding or subtracting a whole turn of a ball changes the motion only by rounding.
#[test]
fn whole_turns_change_nothing() {
    for (method, start) in starts() {
        let original = simulate(&case(-173.1803, start.clone(), method));
        let mut turned = start;
        turned.0[2] += std::f64::consts::TAU;
        turned.0[3] -= 2.0 * std::f64::consts::TAU;
        let turned = simulate(&case(-173.1803, turned, method));
        assert_eq!(original.label(), turned.label());
        for (a, b) in original.position.iter().flatten().zip(turned.position.iter().flatten()) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }
}
