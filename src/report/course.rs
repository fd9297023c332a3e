//! Curves of many points made as small as a picture can show.

/// Keeps of a curve, in each of so many bins of equal width from `from` to `to`, the first and the last
/// point and the extremes: what a line drawn through all points would show.
pub(super) fn thinned(points: &[(f64, f64)], (from, to): (f64, f64), bins: u32) -> Vec<(f64, f64)> {
    let width = (to - from) / f64::from(bins.max(1));
    let bin = |time: f64| if width > 0.0 { ((time - from) / width).floor() } else { 0.0 };
    let same = |one: &(f64, f64), other: &(f64, f64)| bin(one.0) == bin(other.0);
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for chunk in points.chunk_by(same) {
        let by_value = |a: &usize, b: &usize| chunk[*a].1.total_cmp(&chunk[*b].1);
        let least = (0..chunk.len()).min_by(by_value).unwrap_or(0);
        let most = (0..chunk.len()).max_by(by_value).unwrap_or(0);
        let mut places = vec![0, least, most, chunk.len() - 1];
        places.sort_unstable();
        places.dedup();
        kept.extend(places.into_iter().map(|place| chunk[place]));
    }
    kept
}

/// Stretches of time that a state lasts, of `(time, whether it lasts until the next)`, as far as bins of
/// equal width can show them: a bin counts where more than half of it does.
pub(super) fn stretches(
    course: &[(f64, bool)],
    (from, to): (f64, f64),
    bins: usize,
) -> Vec<(f64, f64)> {
    let width = (to - from) / bins.max(1) as f64;
    if width <= 0.0 || width.is_nan() {
        return Vec::new();
    }
    let mut lasting = vec![0.0; bins.max(1)];
    for pair in course.windows(2) {
        let ((begin, lasts), (end, _)) = (pair[0], pair[1]);
        let mut begin = begin;
        while lasts && begin < end {
            let bin = (((begin - from) / width) as usize).min(lasting.len() - 1);
            let next = end.min(from + width * (bin + 1) as f64);
            lasting[bin] += (next - begin).max(0.0);
            begin = if next > begin { next } else { end };
        }
    }
    let mut found: Vec<(f64, f64)> = Vec::new();
    for (bin, _) in lasting.iter().enumerate().filter(|(_, time)| **time > 0.5 * width) {
        let [begin, end] = [bin, bin + 1].map(|edge| from + width * edge as f64);
        match found.last_mut() {
            Some((_, last)) if *last == begin => *last = end,
            _ => found.push((begin, end)),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{stretches, thinned};

    #[test]
    fn extremes_and_ends_are_kept() {
        let curve: Vec<(f64, f64)> =
            (0..=10_000).map(|k| (f64::from(k), (f64::from(k) * 0.7).sin())).collect();
        let few = thinned(&curve, (0.0, 10_000.0), 100);
        assert!(few.len() <= 404 && few[0] == curve[0] && few[few.len() - 1] == curve[10_000]);
        let most = |points: &[(f64, f64)]| points.iter().fold(0.0_f64, |most, (_, v)| most.max(*v));
        assert_eq!(most(&few), most(&curve));
        assert_eq!(thinned(&curve[..3], (0.0, 10_000.0), 10_000), curve[..3]);
        assert_eq!(thinned(&[], (0.0, 0.0), 5), []);
    }

    #[test]
    fn stretches_are_where_a_state_lasts() {
        let course =
            [(0.0, false), (2.0, true), (5.0, false), (7.2, true), (7.3, false), (10.0, true)];
        assert_eq!(stretches(&course, (0.0, 10.0), 10), [(2.0, 5.0)]);
        assert_eq!(stretches(&course, (0.0, 10.0), 100).len(), 2);
        assert_eq!(stretches(&course, (0.0, 0.0), 10), []);
    }
}
