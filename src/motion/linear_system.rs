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

/// The least size of a row of dependent equations.
pub(super) const LEAST_SCALE: f64 = 1e-200;

/// Replaces each right side of a linear system by its solution, by elimination in the order of the unknowns, as in lanes. Rows
/// with small pivots are exchanged: threshold pivoting with rows scaled by their largest entries (I. S. Duff, A. M. Erisman,
/// J. K. Reid, *Direct Methods for Sparse Matrices*, 2nd ed., Oxford 2017, chapter 5,
/// doi:10.1093/acprof:oso/9780198508380.001.0001).
///
/// The equations determine the first unknowns. A later unknown whose pivot is negligible is 0, and its row serves the next
/// unknown. Rows that are left at the end are not examined.
pub(super) fn solve_for_each<T: Elementary>(
    mut matrix: Entries<T>,
    mut rights: SmallVec<[&mut Unknowns<T>; 1]>,
    determined: usize,
) {
    let size = rights.first().map_or(0, |right| right.len());
    let largest = |row: &[T]| row.iter().fold(0.0_f64, |most, entry| most.max(entry.value().abs()));
    // A row of zeros must not be compared with others by 0.
    let least = if determined < size { LEAST_SCALE } else { 0.0 };
    let mut scales: SmallVec<[f64; 4]> =
        matrix.chunks(size.max(1)).map(|row| largest(row).max(least)).collect();
    // The unknown that each row gives.
    let mut unknowns: SmallVec<[usize; 16]> = SmallVec::new();
    for column in 0..size {
        let first = unknowns.len();
        for row in first + 1..size {
            let entry = |row: usize| matrix[row * size + column].value().abs();
            if entry(first) * scales[row] < SMALL_PIVOT * entry(row) * scales[first] {
                (0..size).for_each(|j| matrix.swap(row * size + j, first * size + j));
                rights.iter_mut().for_each(|right| right.swap(row, first));
                scales.swap(row, first);
            }
        }
        let (above, below) = matrix.split_at_mut((first + 1) * size);
        let (pivot, others) = (above[first * size + column], &above[first * size + column + 1..]);
        if column >= determined && pivot.value().abs() < DEPENDENT_PIVOT * scales[first] {
            continue;
        }
        unknowns.push(column);
        let inverse = pivot.reciprocal();
        for (row, entries) in (first + 1..).zip(below.chunks_exact_mut(size)) {
            // Most entries of the equations of several bodies are zero.
            if entries[column].is_zero() {
                continue;
            }
            let factor = entries[column] * inverse;
            for (entry, other) in entries[column + 1..].iter_mut().zip(others) {
                *entry = *entry - factor * *other;
            }
            rights.iter_mut().for_each(|right| right[row] = right[row] - factor * right[first]);
        }
    }
    for right in &mut rights {
        right[unknowns.len()..].fill(T::constant(0.0));
    }
    for (row, &unknown) in unknowns.iter().enumerate().rev() {
        let inverse = matrix[row * size + unknown].reciprocal();
        for right in &mut rights {
            let mut value = right[row];
            for column in unknown + 1..size {
                let entry = matrix[row * size + column];
                if !entry.is_zero() {
                    value = value - entry * right[column];
                }
            }
            // Rows after this one have been used.
            right[row] = T::constant(0.0);
            right[unknown] = value * inverse;
        }
    }
}
