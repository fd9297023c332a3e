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

/// Leaves out points that lie so near to the line between those that are kept that it makes no
/// difference: nearer than `tolerance`, with coordinates in units of `scale`. (D. H. Douglas and
/// T. K. Peucker, Cartographica 10 (1973) 112, doi:10.3138/FM57-6770-U75U-7727.)
pub(super) fn simplified(
    points: &[(f64, f64)],
    scale: (f64, f64),
    tolerance: f64,
) -> Vec<(f64, f64)> {
    let in_units = |index: usize| (points[index].0 * scale.0, points[index].1 * scale.1);
    let mut kept = vec![false; points.len()];
    let mut parts = Vec::new();
    if let Some(last) = points.len().checked_sub(1) {
        (kept[0], kept[last]) = (true, true);
        parts.push((0, last));
    }
    while let Some((first, last)) = parts.pop() {
        let (a, b) = (in_units(first), in_units(last));
        let along = (b.0 - a.0, b.1 - a.1);
        let square = along.0 * along.0 + along.1 * along.1;
        let away = |index: usize| {
            let to = in_units(index);
            let to = (to.0 - a.0, to.1 - a.1);
            let part = ((to.0 * along.0 + to.1 * along.1) / square).clamp(0.0, 1.0);
            // Ends at the same place: there is no way along.
            let part = if square > 0.0 { part } else { 0.0 };
            let off = (to.0 - part * along.0, to.1 - part * along.1);
            (off.0 * off.0 + off.1 * off.1).sqrt()
        };
        let distances = (first + 1..last).map(|index| (index, away(index)));
        let farthest = distances.max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((index, _)) = farthest.filter(|(_, distance)| *distance > tolerance) {
            kept[index] = true;
            parts.extend([(first, index), (index, last)]);
        }
    }
    points.iter().zip(kept).filter(|(_, kept)| *kept).map(|(point, _)| *point).collect()
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
    let edge = |bin: usize| from + width * bin as f64;
    let bin = |time: f64| (((time - from) / width) as usize).min(bins.max(1) - 1);
    for pair in course.windows(2) {
        let ((begin, lasts), (end, _)) = (pair[0], pair[1]);
        if lasts {
            for (number, time) in (bin(begin)..).zip(&mut lasting[bin(begin)..=bin(end)]) {
                *time += (end.min(edge(number + 1)) - begin.max(edge(number))).max(0.0);
            }
        }
    }
    let mut found: Vec<(f64, f64)> = Vec::new();
    for (bin, _) in lasting.iter().enumerate().filter(|(_, time)| **time > 0.5 * width) {
        let [begin, end] = [edge(bin), edge(bin + 1)];
        match found.last_mut() {
            Some((_, last)) if *last == begin => *last = end,
            _ => found.push((begin, end)),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{simplified, stretches, thinned};

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

    /// Whatever the edges of bins round to.
    #[test]
    fn a_state_that_lasts_is_one_stretch() {
        for bins in 1..2000 {
            let course = [(0.0, false), (0.1, true), (0.9, false), (1.158_844_815_240_681, false)];
            let found = stretches(&course, (0.0, 1.158_844_815_240_681), bins);
            assert!(bins < 3 || found.len() == 1, "{bins}: {found:?}");
            let [(begin, end)] = found[..] else { continue };
            let off = 0.5001 * 1.158_844_815_240_681 / bins as f64;
            assert!((begin - 0.1).abs() <= off && (end - 0.9).abs() <= off, "{bins}: {found:?}");
        }
    }

    #[test]
    fn what_no_eye_sees_is_left_out() {
        let curve: Vec<(f64, f64)> =
            (0..=1000).map(|k| (f64::from(k), 50.0 * (f64::from(k) * 0.01).sin())).collect();
        let few = simplified(&curve, (1.0, 1.0), 0.1);
        assert!(few.len() < 120 && few[0] == curve[0] && few[few.len() - 1] == curve[1000]);
        let mut next = 0;
        for (x, y) in &curve {
            while few[next + 1].0 < *x {
                next += 1;
            }
            let ((x0, y0), (x1, y1)) = (few[next], few[next + 1]);
            assert!((y0 + (y1 - y0) * (x - x0) / (x1 - x0) - y).abs() < 0.15);
        }
        assert_eq!(simplified(&[(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)], (1.0, 1.0), 0.1).len(), 2);
        let loop_and_back = [(0.0, 0.0), (0.0, 5.0), (0.0, 0.0)];
        assert_eq!(simplified(&loop_and_back, (1.0, 1.0), 0.1), loop_and_back);
        assert_eq!(simplified(&[], (1.0, 1.0), 0.1), []);
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
