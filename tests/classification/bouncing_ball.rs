//! A ball that bounces on a plate that vibrates: its periodic motion against the closed form (P. J. Holmes, *The dynamics of
//! repeated impacts with a sinusoidally vibrating table*, J. Sound and Vibration 84, 1982, 173-189, without his assumption of
//! high bounces).
//!
//! With the acceleration of gravity and the frequency of the plate as units, the height above the plate obeys
//! `h'' = -1 + Γ cos φ`, and an impact turns the speed `w` into `-e w`. One impact per period of the plate requires
//! `Γ sin φ₀ = -π (1 - e) / (1 + e)` at the phase `φ₀` of the impacts. The Floquet multipliers are the roots of
//! `λ² - (1 + e² - (1 + e)² Γ cos φ₀) λ + e² = 0`.

use std::f64::consts::{PI, TAU};

use stickslip::classification::{Outcome, simulate};
use stickslip::model::{Case, Method, Simulation, Tolerance};

use super::outputs::cases;

const RESTITUTION: f64 = 0.5;

/// The sine and the cosine of the phase of the impacts, times the acceleration of the plate.
fn impact_phase(shaking: f64) -> [f64; 2] {
    let sine = -PI * (1.0 - RESTITUTION) / (1.0 + RESTITUTION);
    [sine, (shaking * shaking - sine * sine).sqrt()]
}

/// Runs balls that start alike near the motion with one impact per period.
fn run(shaking: f64, balls: usize) -> Outcome {
    let [sine, cosine] = impact_phase(shaking);
    let since = -sine.atan2(cosine);
    let after = PI + sine;
    let speed = after - since - sine;
    let height = after * since - 0.5 * since * since + cosine - shaking - sine * since;
    let system = format!(
        "parameters: {{w: 1, shaking: {shaking:?}, e: {RESTITUTION:?}, count: {{value: {balls}, most: 2}}}}
repeat: {{ball: count}}
coordinates: {{\"h[ball]\": {{start: {:?}, start_rate: {speed:?}}}}}
mass: {{\"h[ball]\": {{\"h[ball]\": 1}}}}
force: {{\"h[ball]\": shaking * cos(w * t) - 1}}
contacts: {{\"plate[ball]\": {{gap: \"h[ball]\", restitution: e}}}}
period: 2 * pi / w",
        height + 1e-3
    );
    let case = cases(&system, 1, 3000.0).remove(0);
    let tolerance = Tolerance { relative: 1e-11, absolute: 1e-13 };
    let simulation = Simulation { method: Method::Event, tolerance, ..case.simulation };
    simulate(&Case { simulation, ..case })
}

/// Of two balls that hit the plate at the same instant, neighbours hit it one after the other, and each has the multipliers of one ball.
#[test]
fn one_impact_per_period_has_the_multipliers_of_the_closed_form() {
    // It begins at 1.0472 and loses its stability at 1.52682.
    for (shaking, balls) in [(1.1, 1), (1.2, 1), (1.35, 1), (1.5, 1), (1.2, 2), (1.5, 2)] {
        let outcome = run(shaking, balls);
        assert_eq!(outcome.evidence.name(), "closed_orbit", "{shaking}: {outcome:?}");
        let period_s = outcome.evidence.period_s().expect("a cycle has a period");
        assert!((period_s - TAU).abs() < 1e-9, "{shaking}: {period_s}");
        let [_, cosine] = impact_phase(shaking);
        let half = 0.5 * (1.0 + RESTITUTION.powi(2) - (1.0 + RESTITUTION).powi(2) * cosine);
        let under_root = half * half - RESTITUTION.powi(2);
        let exact = if under_root < 0.0 {
            [RESTITUTION; 2]
        } else {
            let larger = half.abs() + under_root.sqrt();
            [larger, RESTITUTION.powi(2) / larger]
        };
        let found = &outcome.evidence.cycle().expect("known").multipliers;
        assert_eq!(found.len(), 2 * balls);
        for (found, exact) in found.iter().zip(exact.iter().flat_map(|one| vec![one; balls])) {
            assert!((found - exact).abs() < 1e-6, "{shaking}: {found} {exact}");
        }
    }
}

/// Above `sqrt((π (1 - e) / (1 + e))² + (2 (1 + e²) / (1 + e)²)²)`, impacts repeat after two periods.
#[test]
fn the_period_doubles_at_the_acceleration_of_the_closed_form() {
    let [sine, _] = impact_phase(2.0);
    let cosine = 2.0 * (1.0 + RESTITUTION.powi(2)) / (1.0 + RESTITUTION).powi(2);
    let doubling = sine.hypot(cosine);
    assert!((doubling - 1.52682).abs() < 1e-5, "{doubling}");
    for (shaking, periods) in [(doubling - 0.01, 1.0), (doubling + 0.01, 2.0)] {
        let outcome = run(shaking, 1);
        assert_eq!(outcome.evidence.name(), "closed_orbit", "{shaking}: {outcome:?}");
        let found = outcome.evidence.period_s().expect("a cycle has a period") / TAU;
        assert!((found - periods).abs() < 1e-6, "{shaking}: {found}");
    }
}
