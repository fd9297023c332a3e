//! The amplitude without balls against closed forms.

use stickslip::analysis::reference_amplitude;
use stickslip::model::{Balancer, Ball, Machine};

fn relative_error(found: f64, expected: f64) -> f64 {
    (found / expected - 1.0).abs()
}

/// The thesis's machine has 2.1651e-5 m, computed by hand from its table 3.2.
#[test]
fn the_thesis_machine_has_the_amplitude_of_its_parameters() {
    let found = reference_amplitude(&Machine::default()).unwrap();
    assert!(relative_error(found, 2.165_104_571_8e-5) < 1e-10, "{found:e}");
}

/// As the balls get lighter, the amplitude with balls tends to the reference amplitude. Six
/// heavy balls that only cancel each other differ from it by 6 %.
#[test]
fn the_reference_excludes_the_mass_of_the_balls() {
    let of_mass = |mass_kg: f64| {
        let ball = Ball { mass_kg, ..Ball::default() };
        Machine { balls: vec![ball; 6], ..Machine::default() }
    };
    let opposite = |machine: &Machine| {
        let beta = std::array::from_fn(|ball| std::f64::consts::PI * ball as f64);
        let balancer = Balancer::<6>::new(machine).unwrap();
        balancer.rest_amplitude(&beta) * machine.ring_radius_m
    };
    let heavy = of_mass(1e-3);
    let found = reference_amplitude(&heavy).unwrap();
    assert_eq!(Some(found), reference_amplitude(&of_mass(1e-12)));
    assert!(relative_error(opposite(&of_mass(1e-12)), found) < 1e-9);
    let difference = relative_error(opposite(&heavy), found);
    assert!((0.04..0.1).contains(&difference), "{difference}");
}

/// Returns an undamped machine at its resonance.
pub fn at_resonance() -> Machine {
    Machine {
        table_mass_kg: 0.75,
        imbalance_mass_kg: 0.25,
        stiffness_n_m: 1e4,
        damping_n_s_m: 0.0,
        speed_rad_s: -100.0,
        ..Machine::default()
    }
}

#[test]
fn amplitude_is_zero_at_standstill_and_unbounded_at_resonance() {
    let still = Machine { speed_rad_s: 0.0, ..Machine::default() };
    assert_eq!(reference_amplitude(&still), Some(0.0));
    assert_eq!(reference_amplitude(&at_resonance()), None);
}
