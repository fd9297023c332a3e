//! Means over the last tenth of a run, against the recorded motion at 40,001 instants.

use stickslip::classification::{Instants, simulate};

use super::recorder::{cases, recorded};

/// Number of intervals between instants in the last tenth.
const TIMES: u32 = 40_000;

/// The means of runs that still move agree with Simpson's rule for the mean square and the distance
/// between the two ends for mean speeds.
#[test]
fn means_are_of_the_whole_last_tenth() {
    let kinds = [
        "{kind: ball_balancer, parameters: {speed_rad_s: -216.3772}}",
        "{kind: ball_balancer, parameters: {speed_rad_s: -191.6372}}",
        "{kind: ball_balancer, parameters: {speed_rad_s: -309.15, balls: 3}}",
        "{kind: ball_balancer, parameters: {speed_rad_s: -247.3, balls: 1}}",
        "{kind: ball_balancer, friction: {stribeck: {static_friction_coefficient: 4.0e-3, \
         stribeck_speed_rad_s: 1.0}}}",
        "{kind: ball_balancer, friction: {viscous: {viscous_coefficient_n_s_m: 2.0e-5}}}",
    ];
    let mut compared = 0;
    for kind in kinds {
        let before = compared;
        for case in cases(kind, 4, "{end_time_s: 1.3, endings: rest}") {
            let natural = case.model.natural_frequency_rad_s();
            let end = case.simulation.end_time_s * natural;
            let part = |k: u32| 0.9 + 0.1 * f64::from(k) / f64::from(TIMES);
            let time = |k: u32| if k == TIMES { end } else { end * part(k) };
            let instants = Instants::At((0..=TIMES).map(time).collect());
            let (outcome, recording) = recorded(&case, instants);
            if outcome.evidence.name() != "end_time" {
                continue;
            }
            let samples = &recording.samples;
            assert_eq!(samples.len(), TIMES as usize + 1);
            let radius = case.model.ball_balancer().unwrap().ring_radius_m;
            let simpson: f64 = samples
                .iter()
                .enumerate()
                .map(|(k, sample)| {
                    let [x, y, ..] = sample.table.unwrap();
                    let weight = match k {
                        _ if k == 0 || k == TIMES as usize => 1.0,
                        _ if k % 2 == 1 => 4.0,
                        _ => 2.0,
                    };
                    weight * (x * x + y * y)
                })
                .sum();
            let amplitude = radius * (simpson / (3.0 * f64::from(TIMES))).sqrt();
            let found = outcome.amplitude_m.unwrap();
            assert!((found / amplitude - 1.0).abs() < 2e-6, "{kind}: {found} {amplitude}");
            let [first, last] = [&samples[0], &samples[TIMES as usize]];
            for (ball, speed) in outcome.mean_speed.as_ref().unwrap().iter().enumerate() {
                let turned = last.contacts[ball].position - first.contacts[ball].position;
                let expected = turned / (last.time - first.time) * natural;
                assert!((speed - expected).abs() < 1e-7 * natural, "{kind}: {speed} {expected}");
            }
            assert_eq!(simulate(&case), outcome);
            compared += 1;
        }
        // Both kernels: Stribeck friction needs the general one.
        assert!(compared > before, "{kind}");
    }
    assert!(compared > 12, "{compared}");
}
