//! The Pareto front of a few designs.

use stickslip::optimize::pareto_front;

#[test]
fn front_of_a_few() {
    let costs: Vec<Option<Vec<f64>>> = [
        Some([1.0, 5.0]),
        Some([2.0, 2.0]),
        None,
        Some([3.0, 2.0]),
        Some([2.0, 2.0]),
        Some([5.0, 1.0]),
        Some([5.0, 5.0]),
    ]
    .map(|costs| costs.map(Vec::from))
    .into();
    assert_eq!(pareto_front(&costs), [0, 1, 5]);
    assert!(pareto_front(&[None]).is_empty());
}
