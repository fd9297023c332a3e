//! Order and groups of identical balls.

use stickslip::analysis::{groups_of_identical, sorted_where_identical};
use stickslip::model::Ball;

#[test]
fn only_identical_balls_change_places() {
    let light = Ball::default();
    let heavy = Ball { mass_kg: 1.0, ..light };
    assert_eq!(sorted_where_identical(&[3.0, 1.0], &[light, light]), [1.0, 3.0]);
    assert_eq!(sorted_where_identical(&[3.0, 1.0], &[light, heavy]), [3.0, 1.0]);
    let mixed = [light, heavy, light, heavy];
    assert_eq!(sorted_where_identical(&[3.0, 9.0, 1.0, 2.0], &mixed), [1.0, 2.0, 3.0, 9.0]);
    assert_eq!(groups_of_identical(&mixed), [[0, 2], [1, 3]]);
}
