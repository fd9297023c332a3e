//! The formulas of a system in one state, such as its mass matrix.

use std::f64::consts::TAU;

use super::formula::Valued;
use super::numeric::NamedValues;
use super::system::WrittenSystem;
use super::velocities::Rates;

impl WrittenSystem {
    /// Computes with the values of all names in a state, and with the rates of change as functions of the velocities; `None` if the
    /// state has another number of components.
    pub(super) fn in_state<R>(
        &self,
        state: &[f64],
        compute: impl FnOnce(NamedValues<'_, f64>, &Rates<f64>) -> Valued<R>,
    ) -> Valued<Option<R>> {
        let (instance, n) = (&self.instance, self.instance.coordinates.len());
        let parts = state
            .split_at_checked(n)
            .map(|(positions, rest)| (positions, rest.split_at_checked(n)));
        let Some((positions, Some((velocities, clock)))) = parts else { return Ok(None) };
        let time = clock
            .first()
            .map_or(0.0, |clock| clock * self.period.map_or(1.0, |period| period / TAU));
        let parameters = self.parameters_at(&self.values, &self.stage, time);
        let base =
            NamedValues { scales: self.scales, parameters: &parameters, coordinates: &[], time };
        let [shapes, rates] = &self.coordinates;
        let (shapes, moving) = (shapes.at(positions), rates.at(velocities));
        let coordinates = instance.named(|number| [shapes[number], moving[number]]);
        compute(NamedValues { coordinates: &coordinates, ..base }, rates).map(Some)
    }

    /// Returns the smallest pivot of the mass matrix over the entry on its diagonal.
    pub(super) fn inertia_in(&self, state: &[f64]) -> Valued<f64> {
        let mass = self
            .in_state(state, |mut values, _| Ok(self.instance.mass_and_forces(&mut values)?.0))?;
        Ok(mass.map_or(1.0, |mass| smallest_pivot(mass).0))
    }
}

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
