//! The points of a sweep that are examined: all of them, or an even selection of a large sweep.

/// Returns the point to examine as number `index` out of `looked_at`. The sweep is divided into `looked_at` equal
/// parts with one point each, whose place within the part follows the golden ratio and so avoids the sweep's
/// own periods. If `looked_at` equals `points`, every point is examined.
fn spread(index: u64, looked_at: u64, points: u64) -> u64 {
    let mark = |k: u64| (u128::from(k) * u128::from(points) / u128::from(looked_at)) as u64;
    let (from, to) = (mark(index), mark(index + 1));
    let place = (index as f64 * 0.618_033_988_749_894_9).fract();
    from + (place * (to - from) as f64) as u64
}

/// Returns the numbers of at most `most` points, spread evenly over a sweep of `points` points.
pub fn points_to_examine(points: u64, most: u64) -> Vec<u64> {
    let looked_at = points.min(most);
    (0..looked_at).map(|index| spread(index, looked_at, points)).collect()
}
