//! Texts of the animation of a replayed run.

use stickslip::report::time_text;

#[test]
fn times_have_a_unit_that_fits() {
    assert_eq!(
        [2.18754, 0.1, 0.00386, 1e-5, 1e-9, 0.0].map(time_text),
        ["2.1875 s", "0.1000 s", "3.8600 ms", "10.0000 µs", "1.0000 ns", "0.0000 s"]
    );
}
