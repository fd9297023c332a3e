//! The selection of points of a large sweep.

use stickslip::check::points_to_examine;

#[test]
fn small_sweeps_are_examined_whole() {
    assert_eq!(points_to_examine(5, 20), [0, 1, 2, 3, 4]);
    assert_eq!(points_to_examine(1, 1), [0]);
}

/// Each of the parts of a large sweep has one point, and the last points are not left out.
#[test]
fn large_sweeps_are_examined_evenly() {
    for (points, most) in [(1000, 20), (1_000_000_000_000_000, 50), (21, 20)] {
        let chosen = points_to_examine(points, most);
        assert_eq!(chosen.len() as u64, most);
        for (index, point) in (0_u128..).zip(&chosen) {
            let [from, to] = [index, index + 1].map(|k| k * u128::from(points) / u128::from(most));
            assert!((from..to).contains(&u128::from(*point)), "{point} of {points}");
        }
    }
}
