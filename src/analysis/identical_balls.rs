//! Groups of identical balls, and ball angles in an order that does not depend on their labels.

use crate::model::Ball;

/// Returns the indices of identical balls, group by group, each in ascending order.
pub fn groups_of_identical(balls: &[Ball]) -> Vec<Vec<usize>> {
    let firsts = (0..balls.len()).filter(|&first| !balls[..first].contains(&balls[first]));
    firsts
        .map(|first| (first..balls.len()).filter(|&i| balls[i] == balls[first]).collect())
        .collect()
}

/// Returns the angles with those of identical balls sorted in ascending order among the places of
/// those balls. `beta` has one angle per ball.
pub fn sorted_where_identical(beta: &[f64], balls: &[Ball]) -> Vec<f64> {
    let mut sorted = beta.to_vec();
    for (place, later) in (0..balls.len()).flat_map(|i| (i + 1..balls.len()).map(move |j| (i, j))) {
        if balls[place] == balls[later] && sorted[later].total_cmp(&sorted[place]).is_lt() {
            sorted.swap(place, later);
        }
    }
    sorted
}
