//! Whether a mass matrix is positive definite, and how nearly it is not.

/// Returns the smallest pivot of a symmetric matrix over the entry on its diagonal, and its row. A pivot that is not positive is
/// the last one, and counts as 0; what is not finite fails as such.
pub(super) fn smallest_pivot(mut matrix: Vec<Vec<f64>>) -> (f64, usize) {
    let diagonal: Vec<f64> = matrix.iter().enumerate().map(|(place, row)| row[place]).collect();
    let mut smallest = (1.0_f64, 0);
    for (column, original) in diagonal.into_iter().enumerate() {
        let pivot = matrix[column].clone();
        if original <= 0.0 || pivot[column] <= 0.0 {
            return (0.0, column);
        }
        if pivot[column] / original < smallest.0 {
            smallest = (pivot[column] / original, column);
        }
        for row in &mut matrix[column + 1..] {
            let factor = row[column] / pivot[column];
            row.iter_mut().zip(&pivot).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    smallest
}
