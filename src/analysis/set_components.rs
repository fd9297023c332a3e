//! Connected components of a set on the torus, from the runs of set points in the rows of a grid.
//!
//! Two grid points are connected if they are among each other's eight neighbours, with periodic
//! ends of both axes. The sets have sharp tips that run across the grid; with four neighbours,
//! single points of these tips are disconnected on any grid. With eight, the number of components
//! of the thesis's sets is the same from 128 to 2048 points per axis. The cost is that gaps and
//! parts narrower than the grid spacing are not resolved.
//!
//! Neighbours are joined run by run, so that time and memory are proportional to the length of the
//! set's edge, not to its area.

/// Points `start..end` of a row that belong to the set.
pub type Run = (u32, u32);

/// The set on a grid with periodic rows and columns.
#[derive(Clone, Debug, Default)]
pub struct SetRuns {
    /// Number of points in a row.
    pub columns: u32,
    /// The runs of each row, ascending, with a gap between one and the next.
    pub rows: Vec<Vec<Run>>,
}

/// A union-find structure over numbers (R. E. Tarjan, J. ACM 22 (1975) 215).
struct UnionFind {
    parents: Vec<u32>,
    sets: u64,
}

impl UnionFind {
    fn new(count: usize) -> Self {
        UnionFind { parents: (0..count as u32).collect(), sets: count as u64 }
    }

    fn root(&mut self, mut item: u32) -> u32 {
        while self.parents[item as usize] != item {
            let grandparent = self.parents[self.parents[item as usize] as usize];
            self.parents[item as usize] = grandparent;
            item = grandparent;
        }
        item
    }

    fn join(&mut self, first: u32, second: u32) {
        let (first, second) = (self.root(first), self.root(second));
        if first != second {
            self.parents[first.max(second) as usize] = first.min(second);
            self.sets -= 1;
        }
    }
}

impl SetRuns {
    /// Returns the runs of a row.
    pub fn of_row(inside: impl Iterator<Item = bool>) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        for (place, inside) in (0..).zip(inside) {
            match runs.last_mut() {
                Some((_, end)) if inside && *end == place => *end = place + 1,
                _ if inside => runs.push((place, place + 1)),
                _ => {}
            }
        }
        runs
    }

    /// Returns the number of connected components, and the number of components if a point and its
    /// mirror image with rows and columns exchanged count as one. The second is `None` on a grid
    /// that is not square.
    pub fn components(&self) -> (u64, Option<u64>) {
        let mut first = Vec::with_capacity(self.rows.len() + 1); // index of each row's first run
        let mut count = 0;
        for runs in &self.rows {
            first.push(count as u32);
            count += runs.len();
        }
        let mut components = UnionFind::new(count);
        for (row, runs) in self.rows.iter().enumerate() {
            if let (Some(&(0, _)), Some(&(_, end))) = (runs.first(), runs.last())
                && end == self.columns
            {
                components.join(first[row], first[row] + runs.len() as u32 - 1);
            }
            let next = (row + 1) % self.rows.len();
            self.join_touching(row, next, &first, &mut components);
        }
        let on_the_torus = components.sets;
        if self.rows.len() != self.columns as usize {
            return (on_the_torus, None);
        }
        for (row, runs) in self.rows.iter().enumerate() {
            for (index, (start, end)) in (0..).zip(runs) {
                // The middle point of each run: rounding at the set's edge cannot have moved it.
                let mirrored = start + (end - start) / 2;
                let others = &self.rows[mirrored as usize];
                let other = others.partition_point(|&(_, end)| end as usize <= row);
                if others.get(other).is_some_and(|&(start, _)| start as usize <= row) {
                    components.join(first[row] + index, first[mirrored as usize] + other as u32);
                }
            }
        }
        (on_the_torus, Some(components.sets))
    }

    /// Joins touching runs of two adjacent rows, including runs that touch only at corners.
    fn join_touching(&self, row: usize, next: usize, first: &[u32], components: &mut UnionFind) {
        let (upper, lower) = (&self.rows[row], &self.rows[next]);
        let (mut i, mut j) = (0, 0);
        while let (Some(above), Some(below)) = (upper.get(i), lower.get(j)) {
            if above.0 <= below.1 && below.0 <= above.1 {
                components.join(first[row] + i as u32, first[next] + j as u32);
            }
            if above.1 < below.1 {
                i += 1;
            } else {
                j += 1;
            }
        }
        // Corners that touch across the rows' ends.
        for (ending, ending_row, starting, starting_row) in
            [(upper, row, lower, next), (lower, next, upper, row)]
        {
            if let (Some(&(_, end)), Some(&(0, _))) = (ending.last(), starting.first())
                && end == self.columns
            {
                components.join(first[ending_row] + ending.len() as u32 - 1, first[starting_row]);
            }
        }
    }
}
