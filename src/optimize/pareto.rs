//! The Pareto front: designs that no other design dominates.

/// Returns the indices of the designs on the Pareto front, in ascending order: those whose costs are all known and that
/// no other such design dominates, that is, equals or beats in every objective and beats in one. Of equal designs
/// the first one is taken.
pub fn pareto_front(costs: &[Option<Vec<f64>>]) -> Vec<usize> {
    let beats = |(other, theirs): (usize, &Vec<f64>), (own, mine): (usize, &Vec<f64>)| {
        let pairs = || theirs.iter().zip(mine);
        let none_worse = pairs().all(|(theirs, mine)| theirs <= mine);
        none_worse && (pairs().any(|(theirs, mine)| theirs < mine) || other < own)
    };
    let known = || costs.iter().enumerate().filter_map(|(one, costs)| Some((one, costs.as_ref()?)));
    let alone = |mine: &(usize, &Vec<f64>)| {
        !known().any(|theirs| theirs.0 != mine.0 && beats(theirs, *mine))
    };
    known().filter(alone).map(|(one, _)| one).collect()
}
