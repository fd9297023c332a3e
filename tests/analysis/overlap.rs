//! Overlapping balls against the chord between two points of a circle.

use std::f64::consts::{PI, TAU};

use stickslip::analysis::overlaps;
use stickslip::model::{Ball, Machine};

fn machine(diameters_m: &[f64]) -> Machine {
    let ball = |&diameter_m: &f64| Ball { diameter_m, ..Ball::default() };
    let balls = diameters_m.iter().map(ball).collect();
    Machine { ring_radius_m: 0.01, balls, ..Machine::default() }
}

#[test]
fn balls_at_one_angle_overlap_and_opposite_balls_do_not() {
    let two = machine(&[3e-3, 3e-3]);
    assert!(overlaps(&two, &[1.0, 1.0]));
    assert!(overlaps(&two, &[0.01, TAU - 0.01]), "across the angle 0");
    assert!(!overlaps(&two, &[0.0, PI]));
    assert!(!overlaps(&machine(&[3e-3]), &[1.0]), "one ball has no neighbour");
}

/// Six balls of the diameter `L` fill the ring: the chord of 60 degrees is the radius.
#[test]
fn six_balls_of_the_radius_fill_the_ring() {
    let beta: [f64; 6] = std::array::from_fn(|ball| TAU * ball as f64 / 6.0);
    assert!(!overlaps(&machine(&[0.99999e-2; 6]), &beta));
    assert!(overlaps(&machine(&[1.00001e-2; 6]), &beta));
}

/// Balls of 2 mm and 4 mm on a circle of 10 mm touch at the angle `2 asin(3 / 20)`; the third ball
/// is elsewhere.
#[test]
fn balls_of_two_sizes_touch_at_the_sum_of_their_radii() {
    let touching = 2.0 * (3.0_f64 / 20.0).asin();
    let three = machine(&[2e-3, 2e-3, 4e-3]);
    for (angle, expected) in [(touching - 1e-9, true), (touching + 1e-9, false)] {
        assert_eq!(overlaps(&three, &[2.0, 5.0, 2.0 + angle]), expected);
        assert_eq!(overlaps(&three, &[2.0 + TAU, 5.0, 2.0 - angle]), expected);
    }
    // Balls that are larger than the ring touch at every angle.
    let [huge, _] = machine(&[1.0, 1.0]).balls[..] else { panic!("two balls") };
    assert_eq!(three.contact_angle_rad(&huge, &huge), PI);
}
