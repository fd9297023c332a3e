//! The closed forms of blocks on springs against their defining equations.

use super::closed_forms::ClosedForms;
use crate::support::{Block, Ground};
use stickslip::model::FrictionLaw;

fn close(found: f64, exact: f64) {
    assert!((found - exact).abs() <= 1e-12 * exact.abs().max(1.0), "{found} {exact}");
}

fn drop_at_once(static_friction_coefficient: f64) -> FrictionLaw {
    FrictionLaw::stribeck(static_friction_coefficient, 0.0)
}

/// From 0.0865 m each half swing is 0.02 m shorter than the last, until friction holds.
#[test]
fn turning_points_shrink_by_a_constant() {
    let stopping = Block::on_spring().stopping(0.0865, 0.0).expect("dry friction");
    let found: Vec<f64> = stopping.turning_points_m().collect();
    let exact = [0.0865, -0.0665, 0.0465, -0.0265, 0.0065];
    assert_eq!(found.len(), exact.len());
    found.iter().zip(exact).for_each(|(found, exact)| close(*found, exact));
    assert_eq!(stopping.half_swings, 4);
    close(stopping.time_s, 4.0 * std::f64::consts::PI / 10.0);
    close(stopping.position_m, 0.0065);
}

/// Friction dissipates `μ F_n` times the distance on the way to the first turning point and after
/// it: `½ m v² + ½ k x²` decreases by that amount from any start.
#[test]
fn energy_decreases_by_force_times_distance() {
    for mass_kg in [0.7, 1.0] {
        let block = Block { mass_kg, ..Block::on_spring() };
        for (x, v) in [(0.03, 0.9), (0.03, -0.9), (-0.2, 0.1), (0.0, 2.0), (0.09, -0.01)] {
            let stopping = block.stopping(x, v).expect("dry friction");
            let mut way = 0.0;
            let mut place = x;
            for turn in stopping.turning_points_m() {
                way += (turn - place).abs();
                place = turn;
            }
            let energy =
                |x: f64, v: f64| 0.5 * (block.mass_kg * v * v + block.stiffness_n_m * x * x);
            close(energy(x, v) - energy(stopping.position_m, 0.0), 1.0 * way);
            assert!(stopping.position_m.abs() <= 0.01);
            assert!(v * (stopping.first_turning_point_m - x) > 0.0);
        }
    }
}

/// Exactly on the edge of the rest set the block stays, at the start and after half swings.
#[test]
fn the_edge_belongs_to_the_rest_set() {
    let block = Block::on_spring();
    for (start, swings, end) in [
        (0.01, 0, 0.01),
        (-0.01, 0, -0.01),
        (0.0, 0, 0.0),
        (0.03, 1, -0.01),
        (0.05, 2, 0.01),
        (-0.07, 3, 0.01),
        (0.010_001, 1, 0.009_999),
    ] {
        let stopping = block.stopping(start, 0.0).expect("dry friction");
        assert_eq!(stopping.half_swings, swings, "{start}");
        close(stopping.position_m, end);
    }
}

/// A static coefficient above the kinetic one stops the block earlier.
#[test]
fn static_friction_stops_earlier() {
    let block = Block { friction: drop_at_once(0.3), ..Block::on_spring() };
    let stopping = block.stopping(0.065, 0.0).expect("dry friction");
    assert_eq!(stopping.half_swings, 2);
    close(stopping.position_m, 0.025);
}

/// Break-away, slip and stick of the cycle are consistent: both ends of the slip lie on its circle
/// at the belt's speed, the belt carries the block from one to the other, and over the period the
/// work of the belt equals the dissipation: `∮ f dx = 0`.
#[test]
fn the_cycle_closes() {
    for (fixed, speed_m_s) in [(0.2, 0.1), (0.11, 0.02), (0.5, 1.0), (0.4, 0.001)] {
        let ground = Ground::Belt { speed_m_s };
        let block = Block { friction: drop_at_once(fixed), ground, ..Block::on_belt() };
        let cycle = block.stick_slip_cycle().expect("static above kinetic");
        let centre = 0.01;
        for place in [cycle.break_away_m, cycle.stick_again_m] {
            close((place - centre).hypot(speed_m_s / 10.0), cycle.amplitude_m);
        }
        close(cycle.break_away_m, fixed * 0.1);
        close(cycle.break_away_m - cycle.stick_again_m, speed_m_s * cycle.stick_s);
        close(cycle.period_s, cycle.stick_s + cycle.slip_s);
        // Slip, step by step: at its end the sine from break-away has the belt's speed again.
        let x = |t: f64| {
            let (sine, cosine) = (10.0 * t).sin_cos();
            centre + (cycle.break_away_m - centre) * cosine + 0.1 * speed_m_s * sine
        };
        close(x(cycle.slip_s), cycle.stick_again_m);
        let places = (0..=100_000).map(|part| x(cycle.slip_s * f64::from(part) / 1e5));
        let [low, high] = places.fold([f64::MAX, f64::MIN], |[l, h], x| [l.min(x), h.max(x)]);
        assert!((low - cycle.extremes_m[0]).abs() < 1e-8 * cycle.amplitude_m);
        assert!((high - cycle.extremes_m[1]).abs() < 1e-8 * cycle.amplitude_m);
    }
}

/// The damped oscillation satisfies its equation of motion, below, at and above critical damping.
#[test]
fn damped_oscillation_meets_its_equation() {
    for (drag, ground) in [
        (1.0, Ground::Fixed),
        (20.0, Ground::Fixed),
        (75.0, Ground::Fixed),
        (3.0, Ground::Belt { speed_m_s: 0.1 }),
    ] {
        let friction = FrictionLaw::viscous(drag);
        let block = Block { friction, ground, ..Block::on_spring() };
        let belt = if let Ground::Belt { speed_m_s } = ground { speed_m_s } else { 0.0 };
        let at = |t: f64| block.damped_oscillation(0.02, -0.3, t).expect("viscous");
        close(at(0.0)[0], 0.02);
        close(at(0.0)[1], -0.3);
        let h = 1e-5;
        for t in [0.01, 0.1, 0.5] {
            let [[x0, v0], [x, v], [x1, v1]] = [at(t - h), at(t), at(t + h)];
            let residual = (v1 - v0) / (2.0 * h) + drag * (v - belt) + 100.0 * x;
            assert!(residual.abs() < 1e-5, "{drag} {t}: {residual}");
            assert!(((x1 - x0) / (2.0 * h) - v).abs() < 1e-7);
        }
    }
}

/// Creep under the smooth law satisfies `-k x = μ F_n (2/π) atan(x' / v_0)`.
#[test]
fn creep_meets_its_equation() {
    let friction = FrictionLaw::smooth(1e-3);
    let block = Block { friction, ..Block::on_spring() };
    let at = |t: f64| block.creep_position_m(0.008, t).expect("inside");
    close(at(0.0), 0.008);
    for t in [0.1, 3.0, 20.0] {
        let speed = (at(t + 1e-4) - at(t - 1e-4)) / 2e-4;
        let force = 1.0 * std::f64::consts::FRAC_2_PI * (speed / 1e-3).atan();
        assert!((force + 100.0 * at(t)).abs() < 1e-6, "{t}: {force}");
    }
}

#[test]
fn closed_forms_are_given_only_where_they_hold() {
    let smooth = FrictionLaw::smooth(1e-3);
    let gradual = FrictionLaw::stribeck(0.2, 0.1);
    let on_spring = |friction| Block { friction, ..Block::on_spring() };
    let on_belt = |friction| Block { friction, ..Block::on_belt() };
    assert!(on_spring(smooth).stopping(0.1, 0.0).is_none());
    assert!(on_spring(gradual).stopping(0.1, 0.0).is_none());
    assert!(Block::on_belt().stopping(0.1, 0.0).is_none());
    let slippery = Block { friction_coefficient: 0.0, ..Block::on_spring() };
    assert!(slippery.stopping(0.1, 0.0).is_none());
    assert!(Block::on_belt().stick_slip_cycle().is_none());
    assert!(on_belt(gradual).stick_slip_cycle().is_none());
    assert!(on_spring(drop_at_once(0.2)).stick_slip_cycle().is_none());
    assert!(Block::on_spring().damped_oscillation(0.0, 1.0, 1.0).is_none());
    assert!(on_spring(smooth).creep_position_m(0.011, 1.0).is_none());
    assert!(on_belt(smooth).creep_position_m(0.005, 1.0).is_none());
}
