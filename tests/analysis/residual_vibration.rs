//! What the balls leave at a point: runs worse than their own machine without balls, grades and
//! overlaps of rests.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::support::Block;
use stickslip::analysis::{
    Observed, PointAccumulator, ResidualVibration, Z_95, reference_amplitude, wilson_with_failures,
};
use stickslip::classification::{ClosedOrbit, Evidence, Outcome, Rest};
use stickslip::model::{Case, Machine, Model, Simulation, Start};

use super::reference_amplitude::at_resonance;

fn add(
    point: &mut PointAccumulator,
    model: impl Into<Model>,
    evidence: Evidence,
    amplitude_m: Option<f64>,
    position: &[f64],
) {
    let start = Start(Vec::new());
    let case = Case { model: model.into(), start, simulation: Simulation::default() };
    let outcome =
        Outcome { amplitude_m, position: Some(position.to_vec()), ..Outcome::of(evidence) };
    point.add(Observed { cell: 0, case: Some(&case), outcome: &outcome, audit: None });
}

#[test]
fn each_run_is_compared_with_its_own_machine() {
    let light = Machine::default();
    let heavy = Machine { imbalance_mass_kg: 2.0 * light.imbalance_mass_kg, ..light.clone() };
    let without = reference_amplitude(&light).unwrap();
    let cycle = || Evidence::ClosedOrbit(ClosedOrbit::default());
    let mut point = PointAccumulator::default();
    add(&mut point, light.clone(), cycle(), Some(1.1 * without), &[0.0; 2]);
    add(&mut point, light.clone(), cycle(), Some(without), &[0.0; 2]);
    add(&mut point, light.clone(), cycle(), Some(0.9 * without), &[0.0; 2]);
    add(&mut point, heavy, cycle(), Some(1.1 * without), &[0.0; 2]);
    add(&mut point, light, Evidence::Panic(String::new()), None, &[0.0; 2]);
    let (low, high) = wilson_with_failures(1, 1, 5, Z_95);
    let found = point.summary().residual;
    let [_, median, p95] = found.relative_amplitude.map(Option::unwrap);
    // The relative amplitudes are 1.1 / 2, 0.9, 1 and 1.1, up to the small influence of the mass.
    assert!((median - 0.95).abs() < 1e-12 && (p95 - 1.085).abs() < 1e-12, "{median} {p95}");
    let expected = ResidualVibration {
        // The median of three light machines and a heavy one.
        amplitude_without_balls_m: Some(without),
        relative_amplitude: found.relative_amplitude,
        worse_than_without_balls: Some([0.25, low, high]),
        ..ResidualVibration::default()
    };
    assert_eq!(found, expected);
}

/// No run is worse than an undamped machine at its resonance.
#[test]
fn an_unbounded_amplitude_is_not_exceeded() {
    let mut point = PointAccumulator::default();
    add(&mut point, at_resonance(), Evidence::EndTime, Some(1e6), &[0.0; 2]);
    assert_eq!(
        point.summary().residual.worse_than_without_balls.map(|[worse, ..]| worse),
        Some(0.0)
    );
}

/// Only rests have a grade: here one with the imbalance alone, and one with both balls opposite the
/// imbalance, which also overlap.
#[test]
fn grades_and_overlaps_are_those_of_rests() {
    let machine = Machine::default();
    let unbalance = |balls: f64| {
        (machine.imbalance_mass_kg * machine.imbalance_radius_m
            - balls * machine.balls[0].mass_kg * machine.ring_radius_m)
            .abs()
    };
    let grade = |balls: f64| 216_377.2 * unbalance(balls) / 0.324_336;
    let mut point = PointAccumulator::default();
    for (evidence, beta) in [
        (Evidence::RestCertified(Rest::default()), [FRAC_PI_2, 3.0 * FRAC_PI_2]),
        (Evidence::Creep(Rest::default()), [PI, PI]),
        (Evidence::ClosedOrbit(ClosedOrbit::default()), [0.0, 0.0]),
    ] {
        add(&mut point, machine.clone(), evidence, Some(1e-5), &beta);
    }
    let found = point.summary().residual;
    assert_eq!(found.overlapping_rest_fraction, Some(0.5));
    let [alone, opposite] = [grade(0.0), grade(2.0)];
    let [least, most] = [alone.min(opposite), alone.max(opposite)];
    let [median, p95] = found.balance_quality_grade_mm_s.map(Option::unwrap);
    assert!((median - 0.5 * (least + most)).abs() < 1e-9 * most, "{median}");
    assert!((p95 - (least + 0.95 * (most - least))).abs() < 1e-9 * most, "{p95}");
}

#[test]
fn a_block_has_none_of_it() {
    let mut point = PointAccumulator::default();
    add(
        &mut point,
        Block::on_spring(),
        Evidence::RestCertified(Rest::default()),
        Some(0.0),
        &[0.0],
    );
    assert_eq!(point.summary().residual, ResidualVibration::default());
}
