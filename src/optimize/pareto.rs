//! The Pareto front: designs that no other design dominates.

/// Returns the indices of the designs on the Pareto front, in ascending order: the designs with known costs that no
/// other such design dominates. A design dominates another one if it is not worse in any objective, and better in at
/// least one. The first of several equal designs dominates the others.
pub fn pareto_front(costs: &[Option<Vec<f64>>]) -> Vec<usize> {
    let dominates = |(index, costs): (usize, &[f64]), (other, others): (usize, &[f64])| {
        let pairs = || costs.iter().zip(others);
        let better = pairs().any(|(cost, other)| cost < other);
        pairs().all(|(cost, other)| cost <= other) && (better || index < other)
    };
    let known: Vec<(usize, &[f64])> = costs
        .iter()
        .enumerate()
        .filter_map(|(design, costs)| Some((design, costs.as_deref()?)))
        .collect();
    let on_front = known.iter().filter(|(design, costs)| {
        !known.iter().any(|other| other.0 != *design && dominates(*other, (*design, costs)))
    });
    on_front.map(|(design, _)| *design).collect()
}
