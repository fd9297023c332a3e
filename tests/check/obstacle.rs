//! Why balls cannot balance.

use stickslip::check::Obstacle;
use stickslip::model::Machine;

#[test]
fn the_first_obstacle_is_named() {
    let machine = Machine { speed_rad_s: -216.4, ..Machine::default() };
    let slow = Machine { speed_rad_s: 180.0, ..machine.clone() };
    let light = Machine { imbalance_mass_kg: 1.0e-4, ..machine.clone() };
    for (machine, set_fraction, expected) in [
        (&machine, Some(0.7), None),
        (&machine, None, None),
        (&machine, Some(1.0), Some(Obstacle::HeldBalls)),
        (&light, Some(1.0), Some(Obstacle::LightBalls)),
        (&slow, Some(1.0), Some(Obstacle::SlowDisc)),
    ] {
        assert_eq!(Obstacle::of(machine, set_fraction), expected);
    }
}
