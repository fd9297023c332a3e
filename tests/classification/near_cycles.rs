//! Motions that nearly repeat and are no limit cycles: decaying oscillations, and creep towards the edge of the positions in which friction
//! holds.

use crate::support::METHODS;
use stickslip::classification::{Label, simulate};

use super::outputs::cases;

/// Damped masses on springs, one of them with a cubic term, come to rest from everywhere: nothing drives them. Successive turning points of
/// small oscillations differ by less than the closing error of a limit cycle.
#[test]
fn a_decaying_oscillation_is_no_limit_cycle() {
    // The second is fast: its accelerations are much larger than its velocities.
    for force in [
        "{x: -11 * x + 5 * y - 0.03 * x' - x^3, y: 5 * x - 20 * y - 0.03 * y' - 10}",
        "{x: -220 * x + 5 * y - 0.03 * x' - x^3, y: 5 * x - 180 * y - 0.1 * y' - 10}",
    ] {
        let system = format!(
            "coordinates: {{x: {{start: [-1, 1], start_rate: [0, 1]}}, y: {{start: [-0.2, 0.2]}}}}
mass: {{x: {{x: 1}}, y: {{y: 1}}}}
force: {force}"
        );
        for method in METHODS {
            for mut case in cases(&system, 16, 1500.0) {
                case.simulation.method = method;
                let outcome = simulate(&case);
                assert_eq!(outcome.evidence.label(), Label::Equilibrium, "{outcome:?}");
            }
        }
    }
}

/// A mass in a dish that a periodic force shakes slips a little in each period, always downwards: the nearer the edge, the less.
#[test]
fn a_creeping_mass_is_not_on_a_limit_cycle() {
    let system = "coordinates: {x: {start: [0.0389, 0.042]}}
mass: {x: {x: 1}}
force: {x: -9.81 * x / 2 - 0.3 * sin(3 * t)}
contacts: {dish: {normal: 9.81, sliding: x', friction: {coulomb: {coefficient: 0.05}}}}
period: 2 * pi / 3";
    for (method, end_time_s) in
        METHODS.into_iter().flat_map(|method| [(method, 60.0), (method, 900.0)])
    {
        for mut case in cases(system, 6, end_time_s) {
            case.simulation.method = method;
            let label = simulate(&case).evidence.label();
            assert!([Label::Creep, Label::Undecided].contains(&label), "{label:?}");
        }
    }
}
