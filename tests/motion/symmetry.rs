//! Whole turns of a ball.

use stickslip::classification::simulate;
use stickslip::model::{Case, Machine, Method, Simulation, Start};

use crate::support::{METHODS, spread_start};

/// Adding or subtracting a whole turn of a ball changes the motion only by rounding.
#[test]
fn whole_turns_change_nothing() {
    let run = |start: Start, method: Method| {
        let machine = Machine { speed_rad_s: -173.1803, ..Machine::default() };
        let simulation = Simulation { method, end_time_s: 4.0, ..Simulation::default() };
        simulate(&Case { model: machine.into(), start, simulation })
    };
    for (method, k) in METHODS.into_iter().flat_map(|method| (0..12).map(move |k| (method, k))) {
        let mut turned = spread_start(k);
        let original = run(turned.clone(), method);
        turned.0[2] += std::f64::consts::TAU;
        turned.0[3] -= 2.0 * std::f64::consts::TAU;
        let turned = run(turned, method);
        assert_eq!(original.label(), turned.label());
        for (a, b) in original.position.iter().flatten().zip(turned.position.iter().flatten()) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }
}
