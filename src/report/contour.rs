//! Contour lines of values on a regular grid, and the regions between them.
//!
//! Marching squares (W. E. Lorensen and H. E. Cline, Computer Graphics 21 (1987) 163, in the plane) with
//! linear interpolation along the grid's lines; where two corners across from each other are above a
//! level and the other two below, the value at the saddle of the bilinear interpolant decides (G. M.
//! Nielson and B. Hamann, Visualization '91, 83). A region's border is made of pieces of contour lines,
//! inside to the left, and of the rectangle's edge; as each end of a piece is the beginning of just one
//! other, all borders close.

use std::collections::BTreeMap;

use super::course;

/// Values on a regular grid over a rectangle, the rectangle's edges included.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    x: [f64; 2],
    y: [f64; 2],
    columns: usize,
    rows: usize,
    values: Vec<f64>,
}

impl Grid {
    /// The values of a function at so many columns and rows, at least two of each, the first and the last
    /// on the edges of the rectangle.
    pub fn of(
        [x, y]: [[f64; 2]; 2],
        [columns, rows]: [usize; 2],
        value: impl Fn(usize, usize) -> f64,
    ) -> Self {
        let [columns, rows] = [columns.max(2), rows.max(2)];
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        // Whatever is not a number is below every level.
        let value = |(column, row)| {
            let value = value(column, row);
            if value.is_nan() { f64::MIN } else { value.clamp(f64::MIN, f64::MAX) }
        };
        Grid { x, y, columns, rows, values: places.map(value).collect() }
    }

    fn value(&self, [column, row]: [usize; 2]) -> f64 {
        self.values[row * self.columns + column]
    }

    /// A place between grid points, in their numbers, as coordinates.
    fn place(&self, [column, row]: [f64; 2]) -> [f64; 2] {
        let along = |[from, to]: [f64; 2], part: f64, cells: usize| {
            let place = from + (to - from) * (part / cells as f64);
            rounded(place, to - from).clamp(from.min(to), from.max(to))
        };
        [along(self.x, column, self.columns - 1), along(self.y, row, self.rows - 1)]
    }

    /// How far lines may be from where they are computed, a ten-thousandth of the rectangle, in units in
    /// which it is a square.
    fn nearly(&self, ring: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let extent = [self.x[1] - self.x[0], self.y[1] - self.y[0]];
        simplified(ring, extent)
    }
}

/// A number with as many decimals as tell a ten-thousandth of a range apart.
fn rounded(value: f64, range: f64) -> f64 {
    let decimals = 4.0 - range.abs().log10().floor();
    if !(-300.0..=300.0).contains(&decimals) {
        return value;
    }
    // A power of ten and its inverse: dividing by a whole one gives the number nearest to the decimals.
    let scale = 10.0_f64.powi(decimals.abs() as i32);
    if decimals >= 0.0 { (value * scale).round() / scale } else { (value / scale).round() * scale }
}

/// An end of a piece of a border.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum End {
    /// A point of the grid.
    Node([usize; 2]),
    /// Where a contour line crosses the grid's line from a point to the next one to the right, or above.
    Crossing { node: [usize; 2], upwards: bool, above: bool },
}

/// A band of values: from the first level, up to but without the second one.
struct Band<'a> {
    grid: &'a Grid,
    levels: [f64; 2],
}

impl Band<'_> {
    fn holds(&self, node: [usize; 2]) -> bool {
        let value = self.grid.value(node);
        self.levels[0] <= value && value < self.levels[1]
    }

    /// The crossing of the grid's line between two neighbours by the lower or the upper level.
    fn crossing(&self, one: [usize; 2], other: [usize; 2], above: bool) -> End {
        End::Crossing { node: one.min(other), upwards: one[0] == other[0], above }
    }

    fn place(&self, end: End) -> [f64; 2] {
        let (node, step, part) = match end {
            End::Node(node) => (node, [0, 0], 0.0),
            End::Crossing { node, upwards, above } => {
                let step = if upwards { [0, 1] } else { [1, 0] };
                let from = self.grid.value(node);
                let to = self.grid.value([node[0] + step[0], node[1] + step[1]]);
                // Halves, so that the difference of huge numbers is a number.
                let level = self.levels[usize::from(above)];
                let part = (0.5 * level - 0.5 * from) / (0.5 * to - 0.5 * from);
                (node, step, if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.5 })
            }
        };
        self.grid.place([0, 1].map(|axis| node[axis] as f64 + part * step[axis] as f64))
    }

    /// The pieces of the lower level's contour line, or of the upper one's, with the band to the left.
    fn contour(&self, above: bool) -> BTreeMap<End, End> {
        let mut pieces = BTreeMap::new();
        let level = self.levels[usize::from(above)];
        let over = |node: [usize; 2]| self.grid.value(node) >= level;
        for row in 0..self.grid.rows - 1 {
            for column in 0..self.grid.columns - 1 {
                // Counter-clockwise.
                let corners =
                    [[column, row], [column + 1, row], [column + 1, row + 1], [column, row + 1]];
                let side = |k: usize| (corners[k % 4], corners[(k + 1) % 4]);
                let at = |k: usize| self.crossing(side(k).0, side(k).1, above);
                // Sides on which one comes down from above the level, and up to it.
                let down = (0..4).filter(|&k| over(side(k).0) && !over(side(k).1));
                for down in down {
                    let next = (1..4).find(|k| !over(side(down + k).0) && over(side(down + k).1));
                    let before =
                        (1..4).rev().find(|k| !over(side(down + k).0) && over(side(down + k).1));
                    // With two ways up, the one that leaves what is above in one piece or in two.
                    let joined = self.saddle(corners) >= level;
                    let Some(up) = (if joined { next } else { before }) else { continue };
                    let (from, to) = (at(down), at(down + up));
                    // What is above the level lies to the left from down to up.
                    let (from, to) = if above { (to, from) } else { (from, to) };
                    pieces.insert(from, to);
                }
            }
        }
        pieces
    }

    /// The value at the saddle of the bilinear interpolant.
    fn saddle(&self, corners: [[usize; 2]; 4]) -> f64 {
        let [a, b, c, d] = corners.map(|corner| self.grid.value(corner));
        let value = (a * c - b * d) / (a + c - b - d);
        if value.is_finite() { value } else { 0.25 * a + 0.25 * b + 0.25 * c + 0.25 * d }
    }

    /// The pieces of the rectangle's edge that are in the band, counter-clockwise.
    fn edge(&self) -> BTreeMap<End, End> {
        let [right, top] = [self.grid.columns - 1, self.grid.rows - 1];
        let nodes: Vec<[usize; 2]> = (0..right)
            .map(|column| [column, 0])
            .chain((0..top).map(|row| [right, row]))
            .chain((1..=right).rev().map(|column| [column, top]))
            .chain((1..=top).rev().map(|row| [0, row]))
            .collect();
        let mut pieces = BTreeMap::new();
        for (place, &one) in nodes.iter().enumerate() {
            let other = nodes[(place + 1) % nodes.len()];
            let [from, to] = [one, other].map(|node| self.grid.value(node));
            let mut crossed: Vec<bool> = [false, true]
                .into_iter()
                .filter(|above| {
                    let level = self.levels[usize::from(*above)];
                    (from >= level) != (to >= level)
                })
                .collect();
            if to < from {
                crossed.reverse();
            }
            let mut last = self.holds(one).then_some(End::Node(one));
            for above in crossed {
                let here = self.crossing(one, other, above);
                match last.take() {
                    Some(begin) => drop(pieces.insert(begin, here)),
                    None => last = Some(here),
                }
            }
            if let Some(begin) = last {
                pieces.insert(begin, End::Node(other));
            }
        }
        pieces
    }

    /// Follows pieces from end to beginning: closed rings, and lines that begin and end somewhere.
    fn linked(&self, mut pieces: BTreeMap<End, End>) -> Vec<Vec<[f64; 2]>> {
        let mut entered: std::collections::BTreeSet<End> = pieces.values().copied().collect();
        let mut open: Vec<End> =
            pieces.keys().copied().filter(|begin| !entered.remove(begin)).collect();
        open.reverse();
        let mut found = Vec::new();
        while let Some(first) = open.pop().or_else(|| pieces.keys().next().copied()) {
            let mut line = vec![self.place(first)];
            let mut here = first;
            while let Some(next) = pieces.remove(&here) {
                line.push(self.place(next));
                here = next;
            }
            line.dedup();
            found.push(line);
        }
        found
    }
}

/// The regions between neighbouring levels, which ascend: a value is in a region from its lower level up to
/// but without the upper one. Every region is one ring of points, the last one not the first again; holes
/// are joined to it by a cut, there and back. With each ring comes the middle of its band.
pub fn regions(grid: &Grid, levels: &[f64]) -> (Vec<Vec<[f64; 2]>>, Vec<f64>) {
    let (mut rings, mut values) = (Vec::new(), Vec::new());
    for pair in levels.windows(2) {
        let band = Band { grid, levels: [pair[0], pair[1]] };
        let mut pieces = band.contour(false);
        pieces.append(&mut band.contour(true));
        pieces.append(&mut band.edge());
        let closed = band.linked(pieces).into_iter().map(|ring| grid.nearly(&ring));
        let (outer, holes): (Vec<_>, Vec<_>) = closed
            .filter(|ring| ring.len() > 3 && area(ring) != 0.0)
            .partition(|ring| area(ring) > 0.0);
        let joined = with_holes(outer, holes);
        values.extend(joined.iter().map(|_| 0.5 * pair[0] + 0.5 * pair[1]));
        rings.extend(joined);
    }
    (rings, values)
}

/// The contour lines of a level, inside the rectangle; a closed one ends where it began.
pub fn lines(grid: &Grid, level: f64) -> Vec<Vec<[f64; 2]>> {
    let band = Band { grid, levels: [level, f64::INFINITY] };
    let linked = band.linked(band.contour(false)).into_iter();
    linked.map(|line| grid.nearly(&line)).filter(|line| line.len() > 1).collect()
}

/// The area of a ring, negative where it goes round clockwise.
pub fn area(ring: &[[f64; 2]]) -> f64 {
    let Some(&[x, y]) = ring.first() else { return 0.0 };
    let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
    pairs.map(|(a, b)| (a[0] - x) * (b[1] - y) - (b[0] - x) * (a[1] - y)).sum::<f64>() / 2.0
}

/// Whether a point is inside of a ring: how often a ray to the right crosses it.
fn encloses(ring: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
    let crossed = pairs.filter(|(a, b)| {
        (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    });
    crossed.count() % 2 == 1
}

/// Joins every hole to the smallest ring round it, at their points that are nearest to each other.
fn with_holes(outer: Vec<Vec<[f64; 2]>>, holes: Vec<Vec<[f64; 2]>>) -> Vec<Vec<[f64; 2]>> {
    let open = |mut ring: Vec<[f64; 2]>| {
        if ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        ring
    };
    let outer: Vec<Vec<[f64; 2]>> = outer.into_iter().map(open).collect();
    let mut inside: Vec<Vec<Vec<[f64; 2]>>> = vec![Vec::new(); outer.len()];
    for hole in holes.into_iter().map(open) {
        let round = (0..outer.len()).filter(|&ring| encloses(&outer[ring], middle(&hole)));
        let size = |ring: &usize| area(&outer[*ring]);
        if let Some(ring) = round.min_by(|a, b| size(a).total_cmp(&size(b))) {
            inside[ring].push(hole);
        }
    }
    let joined = |(mut ring, mut holes): (Vec<[f64; 2]>, Vec<Vec<[f64; 2]>>)| {
        // The nearest one first, so that no cut leads through another hole.
        while let Some((hole, from, to)) = nearest(&ring, &holes) {
            let hole = holes.swap_remove(hole);
            let there = hole.iter().cycle().skip(to).take(hole.len() + 1).copied();
            let there: Vec<[f64; 2]> = there.chain([ring[from]]).collect();
            ring.splice(from + 1..from + 1, there);
        }
        ring
    };
    outer.into_iter().zip(inside).map(joined).collect()
}

/// A point of a ring's first side: inside of a hole's surroundings, whatever its shape.
fn middle(ring: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|axis| 0.5 * (ring[0][axis] + ring[1][axis]))
}

/// The hole nearest to a ring, with the places of the nearest points in both.
fn nearest(ring: &[[f64; 2]], holes: &[Vec<[f64; 2]>]) -> Option<(usize, usize, usize)> {
    let mut best: Option<(f64, (usize, usize, usize))> = None;
    for (number, hole) in holes.iter().enumerate() {
        for (from, a) in ring.iter().enumerate() {
            for (to, b) in hole.iter().enumerate() {
                let distance = (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
                if best.is_none_or(|(least, _)| distance < least) {
                    best = Some((distance, (number, from, to)));
                }
            }
        }
    }
    best.map(|(_, place)| place)
}

/// A line with those points only that it needs to stay within a twenty-thousandth of the extent of where it
/// was (D. H. Douglas and T. K. Peucker, Cartographica 10 (1973) 112). The ends stay; of a closed line
/// also the point farthest from where it begins.
fn simplified(line: &[[f64; 2]], extent: [f64; 2]) -> Vec<[f64; 2]> {
    let points: Vec<(f64, f64)> = line.iter().map(|[x, y]| (*x, *y)).collect();
    let scale = (1.0 / extent[0], 1.0 / extent[1]);
    course::simplified(&points, scale, 5e-5).into_iter().map(|(x, y)| [x, y]).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::{Grid, area, encloses, lines, regions};

    fn grid(points: usize, value: impl Fn(f64, f64) -> f64) -> Grid {
        let at = |k: usize| 2.0 * k as f64 / (points - 1) as f64 - 1.0;
        Grid::of([[-1.0, 1.0]; 2], [points; 2], |column, row| value(at(column), at(row)))
    }

    #[test]
    fn a_cone_has_circles() {
        let grid = grid(193, |x, y| x.hypot(y));
        for radius in [0.1, 0.5, 0.93] {
            let found = lines(&grid, radius);
            assert_eq!(found.len(), 1);
            assert_eq!(found[0].first(), found[0].last());
            // What is above the level lies to the left: the circle goes round clockwise.
            let relative = -area(&found[0]) / (PI * radius * radius);
            assert!((relative - 1.0).abs() < 4e-3, "{relative}");
            for [x, y] in &found[0] {
                assert!((x.hypot(*y) - radius).abs() < 3e-4, "{x} {y}");
            }
            // Fewer points than cells that the line goes through.
            assert!(found[0].len() < (8.0 * radius * 96.0) as usize, "{}", found[0].len());
        }
        // Beyond the rectangle's edge, four arcs in its corners.
        assert_eq!(lines(&grid, 1.2).len(), 4);
        assert!(lines(&grid, 1.5).is_empty() && lines(&grid, -1.0).is_empty());
    }

    #[test]
    fn an_annulus_is_one_ring_with_a_cut() {
        let grid = grid(193, |x, y| x.hypot(y));
        let (rings, values) = regions(&grid, &[-1.0, 0.25, 0.5, 0.75, 2.0]);
        assert_eq!(values, [-0.375, 0.375, 0.625, 1.375]);
        let radii = [0.0, 0.25, 0.5, 0.75];
        for (ring, pair) in rings.iter().zip(radii.windows(2)) {
            let exact = PI * (pair[1] * pair[1] - pair[0] * pair[0]);
            assert!((area(ring) / exact - 1.0).abs() < 1e-3, "{} {exact}", area(ring));
            let inside = [0.5 * (pair[0] + pair[1]), 0.01];
            assert!(encloses(ring, inside) && !encloses(ring, [pair[1] + 0.01, 0.01]));
            assert!(pair[0] == 0.0 || !encloses(ring, [pair[0] - 0.01, 0.01]));
        }
        // The rest of the square has the last circle as its hole, and the corners of the rectangle.
        assert!((area(&rings[3]) - (4.0 - PI * 0.75 * 0.75)).abs() < 2e-3);
        for corner in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            assert!(rings[3].contains(&corner));
        }
    }

    #[test]
    fn a_plane_is_cut_into_stripes_of_four_points() {
        let grid = grid(65, |x, y| x + 0.5 * y);
        let (rings, _) = regions(&grid, &[-0.25, 0.25]);
        assert_eq!(rings.len(), 1);
        assert_eq!(rings[0].len(), 4, "{:?}", rings[0]);
        assert!((area(&rings[0]) - 1.0).abs() < 1e-12);
        let found = lines(&grid, 0.25);
        assert_eq!((found.len(), found[0].len()), (1, 2));
        // The whole rectangle is one band of its four corners.
        let (rings, _) = regions(&grid, &[-2.0, 2.0]);
        assert_eq!((rings.len(), rings[0].len(), area(&rings[0])), (1, 4, 4.0));
    }

    #[test]
    fn bands_fill_the_rectangle_without_overlap() {
        // Saddles, plateaus exactly on levels, and several holes.
        let waves = grid(101, |x, y| (7.0 * x).sin() * (9.0 * y).cos() + 0.3 * x);
        let steps = grid(40, |x, y| (3.0 * x).round() + (2.0 * y).round());
        let checks = grid(7, |x, y| f64::from(((3.0 * x + 3.0 * y).round() as i32).rem_euclid(2)));
        for grid in [waves, steps, checks] {
            let levels: Vec<f64> = (-20..=20).map(|k| f64::from(k) / 3.0).collect();
            let (rings, values) = regions(&grid, &levels);
            assert_eq!(rings.len(), values.len());
            let whole: f64 = rings.iter().map(|ring| area(ring)).sum();
            assert!((whole - 4.0).abs() < 4e-3, "{whole}");
            assert!(rings.iter().all(|ring| area(ring) > 0.0));
            for k in 0..400 {
                let point = [f64::from(k % 20), f64::from(k / 20)].map(|k| k / 10.05 - 0.9479);
                let within = rings.iter().filter(|ring| encloses(ring, point)).count();
                assert_eq!(within, 1, "{point:?}");
            }
        }
    }

    #[test]
    fn what_is_not_a_number_is_below_every_level() {
        let holed = grid(33, |x, _| if x < 0.0 { f64::NAN } else { 1.0 });
        let (rings, _) = regions(&holed, &[0.0, 2.0]);
        assert!((area(&rings[0]) - 2.0).abs() < 0.07, "{}", area(&rings[0]));
        assert!(lines(&grid(5, |_, _| f64::INFINITY), 0.0).is_empty());
    }
}
