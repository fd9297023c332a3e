//! Angles that balls occupy, densities, and overlapping positions, against geometry and probability.

use std::f64::consts::{PI, TAU};

use stickslip::check::{BallPositions, density_kg_m3, occupied_angle};
use stickslip::model::{Ball, Machine};

fn ball(diameter_m: f64) -> Ball {
    Ball { diameter_m, ..Ball::default() }
}

fn machine(balls: usize, diameter_m: f64) -> Machine {
    Machine { balls: vec![ball(diameter_m); balls], speed_rad_s: -247.3, ..Machine::default() }
}

/// Balls whose centres are the corners of a regular polygon with touching neighbours fill the ring.
#[test]
fn balls_at_the_corners_of_a_polygon_fill_the_ring() {
    for corners in 2..=8_usize {
        let side_m = 2.0 * 0.0115 * (PI / corners as f64).sin();
        let filled = occupied_angle(&machine(corners, side_m));
        assert!((filled - TAU).abs() < 1e-7, "{corners} corners: {filled}");
        assert!(occupied_angle(&machine(corners, 0.99 * side_m)) < TAU);
    }
}

/// A steel ball of 1 inch (25.4 mm) has 67 g.
#[test]
fn density_of_a_steel_ball() {
    let steel = Ball { mass_kg: 0.0670, diameter_m: 0.0254, ..Ball::default() };
    assert!((density_kg_m3(&steel) - 7809.0).abs() < 5.0, "{}", density_kg_m3(&steel));
}

/// Where friction holds the balls anywhere, overlaps are as frequent as among random points on a circle: no two of
/// `N` points are nearer than an angle `c` with the probability `(1 - N c / 2π)^(N - 1)`.
#[test]
fn overlaps_are_as_frequent_as_among_random_points() {
    for balls in 2..=5_usize {
        let mut machine = machine(balls, 0.002);
        machine.balls.iter_mut().for_each(|ball| ball.friction_coefficient = 0.5);
        let found = BallPositions::new([balls]).overlapping_fraction(&machine).unwrap();
        let contact = machine.contact_angle_rad(&machine.balls[0], &machine.balls[0]);
        let apart = (1.0 - balls as f64 * contact / TAU).powi(balls as i32 - 1);
        assert!((found - (1.0 - apart)).abs() < 0.02, "{balls} balls: {found}, {}", 1.0 - apart);
    }
}

#[test]
fn one_ball_and_small_sets_have_no_overlapping_fraction() {
    assert_eq!(BallPositions::new([1]).overlapping_fraction(&machine(1, 0.003)), None);
    assert_eq!(BallPositions::new([3]).overlapping_fraction(&machine(2, 0.003)), None);
    let mut smooth = machine(2, 0.003);
    smooth.balls.iter_mut().for_each(|ball| ball.friction_coefficient = 1e-6);
    assert_eq!(BallPositions::new([2]).overlapping_fraction(&smooth), None);
}
