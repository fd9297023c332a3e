//! How far apart two positions of the balls are, on the torus of their angles, when balls that are
//! alike have no names.

use std::f64::consts::{PI, TAU};

use crate::model::MAX_BALLS;

/// An angle in [0, 2π): what `rem_euclid` gives, without a division where there is nothing to divide.
fn wrapped(angle: f64) -> f64 {
    if angle.abs() < TAU {
        if angle < 0.0 { angle + TAU } else { angle }
    } else {
        angle.rem_euclid(TAU)
    }
}

/// The way from one angle to another, in (-π, π].
pub(super) fn turn(from: f64, to: f64) -> f64 {
    let way = wrapped(to - from);
    if way > PI { way - TAU } else { way }
}

/// The root mean square over the balls of the angles between two positions, the least over all
/// exchanges of balls within the groups of those that are alike, rad. The groups have every ball once.
///
/// Of a group only the cyclic shifts of both orders round the ring need be looked at: the cost
/// of a way is convex, so that ways which cross are never shorter than those which do not (J. Delon,
/// J. Salomon, A. Sobolevski, SIAM J. Appl. Math. 70 (2010) 2239, doi:10.1137/090772708).
///
/// # Panics
/// For a group of more than [`MAX_BALLS`].
pub fn torus_distance(beta: &[f64], other: &[f64], groups: &[Vec<usize>]) -> f64 {
    let squares: f64 = groups.iter().map(|group| least_squares(beta, other, group)).sum();
    (squares / beta.len() as f64).sqrt()
}

fn least_squares(beta: &[f64], other: &[f64], group: &[usize]) -> f64 {
    if let [ball] = *group {
        return turn(wrapped(beta[ball]), wrapped(other[ball])).powi(2);
    }
    let balls = group.len();
    let in_order = |angles: &[f64]| {
        let mut sorted = [0.0; MAX_BALLS];
        sorted.iter_mut().zip(group).for_each(|(angle, &ball)| *angle = wrapped(angles[ball]));
        sorted[..balls].sort_unstable_by(f64::total_cmp);
        sorted
    };
    let (ours, theirs) = (in_order(beta), in_order(other));
    let shifted = |shift: usize| -> f64 {
        let pairs = (0..balls).map(|i| (ours[i], theirs[(i + shift) % balls]));
        pairs.map(|(a, b)| turn(a, b).powi(2)).sum()
    };
    (0..balls).map(shifted).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::torus_distance;
    use crate::analysis::draws::Draws;

    /// All orders of these places.
    fn permutations(places: &[usize]) -> Vec<Vec<usize>> {
        if places.is_empty() {
            return vec![Vec::new()];
        }
        let with_first = |first: usize| {
            let rest: Vec<usize> = places.iter().copied().filter(|&place| place != first).collect();
            permutations(&rest).into_iter().map(move |rest| [vec![first], rest].concat())
        };
        places.iter().flat_map(|&first| with_first(first)).collect()
    }

    /// The least over all exchanges and over whole turns of every ball.
    fn by_brute_force(beta: &[f64], other: &[f64], groups: &[Vec<usize>]) -> f64 {
        let of_group = |group: &Vec<usize>| {
            let cost = |order: &Vec<usize>| -> f64 {
                let pairs = group.iter().zip(order);
                let square = |(&ball, &place): (&usize, &usize)| {
                    let ways =
                        [-TAU, 0.0, TAU].map(|turn| (beta[ball] - other[place] + turn).abs());
                    ways.into_iter().fold(f64::INFINITY, f64::min).powi(2)
                };
                pairs.map(square).sum()
            };
            permutations(group).iter().map(cost).fold(f64::INFINITY, f64::min)
        };
        (groups.iter().map(of_group).sum::<f64>() / beta.len() as f64).sqrt()
    }

    #[test]
    fn least_over_all_exchanges_and_turns() {
        let mut draws = Draws::new(36);
        let groups: [&[&[usize]]; 7] = [
            &[&[0]],
            &[&[0, 1]],
            &[&[0], &[1]],
            &[&[0, 2], &[1]],
            &[&[0, 1, 2, 3]],
            &[&[0, 1, 4], &[2, 3]],
            &[&[0, 1, 2, 3, 4, 5]],
        ];
        for groups in groups {
            let groups: Vec<Vec<usize>> = groups.iter().map(|group| group.to_vec()).collect();
            let balls = groups.iter().map(Vec::len).sum();
            for _ in 0..300 {
                let mut place = || (0..balls).map(|_| TAU * draws.uniform()).collect::<Vec<f64>>();
                let (beta, other) = (place(), place());
                let found = torus_distance(&beta, &other, &groups);
                let expected = by_brute_force(&beta, &other, &groups);
                assert!((found - expected).abs() < 1e-12, "{groups:?}: {found} {expected}");
                assert!((torus_distance(&other, &beta, &groups) - found).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn known_distances() {
        let alike = [vec![0, 1]];
        assert!((torus_distance(&[0.1, TAU - 0.1], &[0.0, 0.0], &alike) - 0.1).abs() < 1e-12);
        assert!(
            (torus_distance(&[0.0, 0.0], &[PI, 0.0], &alike) - PI / 2.0_f64.sqrt()).abs() < 1e-12
        );
        assert_eq!(torus_distance(&[1.0, 4.0], &[4.0, 1.0], &alike), 0.0);
        assert!(
            (torus_distance(&[1.0, 4.0], &[4.0, 1.0], &[vec![0], vec![1]]) - 3.0).abs() < 1e-12
        );
    }
}
