//! The solution of the linear systems in recorded equations.

use smallvec::SmallVec;

use crate::model::{Bounded, Dual, Elementary, NodeId, Solve};

/// The entries of a matrix, row by row, without an allocation for up to eight unknowns.
pub(crate) type Entries<T> = SmallVec<[T; 64]>;

/// The unknowns of a linear system, or its right side.
pub type Unknowns<T> = SmallVec<[T; 8]>;

/// A pivot is small, and another row takes its place, if its share of the largest entry of its row is below this fraction of
/// the other row's share. The order of well-posed equations then remains, and rounding errors grow little.
pub(super) const SMALL_PIVOT: f64 = 0.1;

/// Numbers for which linear systems are solved.
pub trait Solved: Elementary {
    /// Computes the unknowns of a linear system from the values of nodes.
    fn solve(system: &Solve, at: impl Fn(NodeId) -> Self, unknowns: &mut Unknowns<Self>) {
        let matrix = system.matrix.iter().map(|node| at(*node)).collect();
        *unknowns = system.right.iter().map(|node| at(*node)).collect();
        solve_for_each(matrix, [unknowns].into(), system.determined);
    }
}

impl Solved for f64 {}
impl Solved for Dual {}
impl Solved for Bounded {}

/// A pivot below this part of the largest entry of its row shows that equations are dependent.
pub(super) const DEPENDENT_PIVOT: f64 = 1e-9;

/// Returns the solution of a linear system by elimination in the order of its unknowns, as in lanes. Rows with small pivots
/// are exchanged: threshold pivoting with rows scaled by their largest entries (I. S. Duff, A. M. Erisman, J. K. Reid,
/// *Direct Methods for Sparse Matrices*, 2nd ed., Oxford 2017, chapter 5, doi:10.1093/acprof:oso/9780198508380.001.0001).
pub(super) fn solved<T: Elementary>(matrix: Entries<T>, mut right: Unknowns<T>) -> Unknowns<T> {
    let size = right.len();
    solve_for_each(matrix, [&mut right].into(), size);
    right
}

/// Replaces each right side by the solution that [`solved`] returns for it. The equations determine the first unknowns; of the others,
/// those are 0 whose pivots are negligible.
pub(super) fn solve_for_each<T: Elementary>(
    mut matrix: Entries<T>,
    mut rights: SmallVec<[&mut Unknowns<T>; 1]>,
    determined: usize,
) {
    let size = rights.first().map_or(0, |right| right.len());
    let largest = |row: &[T]| row.iter().fold(0.0_f64, |most, entry| most.max(entry.value().abs()));
    let inverse_of = |pivot: T, unknown: usize, scale: f64| {
        let is_negligible = unknown >= determined && pivot.value().abs() < DEPENDENT_PIVOT * scale;
        if is_negligible { T::constant(0.0) } else { pivot.reciprocal() }
    };
    let mut scales: SmallVec<[f64; 4]> = matrix.chunks(size.max(1)).map(largest).collect();
    for column in 0..size {
        for row in column + 1..size {
            let entry = |row: usize| matrix[row * size + column].value().abs();
            if entry(column) * scales[row] < SMALL_PIVOT * entry(row) * scales[column] {
                (0..size).for_each(|j| matrix.swap(row * size + j, column * size + j));
                rights.iter_mut().for_each(|right| right.swap(row, column));
                scales.swap(row, column);
            }
        }
        let (above, below) = matrix.split_at_mut((column + 1) * size);
        let (pivot, others) = (above[column * size + column], &above[column * size + column + 1..]);
        let inverse = inverse_of(pivot, column, scales[column]);
        for (row, entries) in (column + 1..).zip(below.chunks_exact_mut(size)) {
            // Most entries of the equations of several bodies are zero.
            if entries[column].is_zero() {
                continue;
            }
            let factor = entries[column] * inverse;
            for (entry, other) in entries[column + 1..].iter_mut().zip(others) {
                *entry = *entry - factor * *other;
            }
            rights.iter_mut().for_each(|right| right[row] = right[row] - factor * right[column]);
        }
    }
    for row in (0..size).rev() {
        let inverse = inverse_of(matrix[row * size + row], row, scales[row]);
        for right in &mut rights {
            for column in row + 1..size {
                let entry = matrix[row * size + column];
                if !entry.is_zero() {
                    right[row] = right[row] - entry * right[column];
                }
            }
            right[row] = right[row] * inverse;
        }
    }
}
