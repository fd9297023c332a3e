//! Connected components of small sets on the torus.

use stickslip::analysis::SetRuns;

fn set(picture: &[&str]) -> SetRuns {
    let row = |line: &&str| SetRuns::of_row(line.bytes().map(|sign| sign == b'#'));
    SetRuns { columns: picture[0].len() as u32, rows: picture.iter().map(row).collect() }
}

#[test]
fn rows_fall_into_runs() {
    assert_eq!(set(&["##..#.##"]).rows, [[(0, 2), (4, 5), (6, 8)]]);
    assert!(set(&["...."]).rows[0].is_empty());
}

#[test]
fn neighbours_are_joined_across_corners_and_the_ends_of_both_axes() {
    assert_eq!(set(&["#..#", "....", "....", "#..#"]).components().0, 1);
    assert_eq!(set(&["#....", "....#", ".....", ".....", "....."]).components().0, 1);
    assert_eq!(set(&["....#", "#....", ".....", ".....", "....."]).components().0, 1);
    assert_eq!(set(&["#....", ".#...", "..#..", ".....", "....."]).components().0, 1);
    assert_eq!(set(&["..#..", ".#...", "#....", ".....", "....."]).components().0, 1);
    assert_eq!(set(&["#....", "..#..", ".....", ".....", "....."]).components().0, 2);
    assert_eq!(set(&["....", "....", "....", "...."]).components(), (0, Some(0)));
    assert_eq!(set(&["####"; 4]).components(), (1, Some(1)));
    assert_eq!(set(&["#.#.", "#.#."]).components(), (2, None));
    // A ring of one row: one arc across its end, one in its middle.
    assert_eq!(set(&["##..#..#"]).components(), (2, None));
    // A comb, joined by its last row only.
    assert_eq!(set(&["#.#.#...", "#.#.#...", "#####..."]).components().0, 1);
}

#[test]
fn exchange_joins_mirror_images() {
    let three = [
        "........", "...#....", "........", ".#......", "........", "......#.", "........",
        "........",
    ];
    assert_eq!(set(&three).components(), (3, Some(2)));
    let two = [".....", "...#.", ".....", ".#...", "....."];
    assert_eq!(set(&two).components(), (2, Some(1)));
}
