//! Whether stick and slip are decided in one way where normal forces depend on accelerations.
//!
//! With the accelerations of the other velocities eliminated, friction `f = q - A a` and normal forces `n + B a` depend on the
//! accelerations `a` of the sliding speeds. There is exactly one solution if `A + diag(p) B` is a P-matrix for all friction
//! ratios `|p_i| ≤ μ_i` (`existence.rs`). A matrix whose diagonal is positive and larger than the sum of the other entries of its
//! row is one.

use nalgebra::DMatrix;

use super::formula::FormulaFault;
use super::numeric::Numeric;
use super::system::WrittenSystem;
use super::velocities::{Rates, SpeedOf};
use crate::model::System;

impl WrittenSystem {
    /// Returns whether stick and slip are surely decided in one way in a state.
    ///
    /// # Errors
    /// A fault that the check has found before.
    pub(super) fn has_one_solution(&self, state: &[f64]) -> Result<bool, FormulaFault> {
        let found = self.in_state(state, |values, rates| self.is_dominant(values, rates))?;
        Ok(found.unwrap_or(false))
    }

    fn is_dominant(
        &self,
        mut values: Numeric<'_, f64>,
        rates: &Rates<f64>,
    ) -> Result<bool, FormulaFault> {
        let (instance, n) = (&self.instance, self.instance.coordinates.len());
        let place = |speed: &SpeedOf| match speed {
            SpeedOf::Velocity(place) => Some(*place),
            SpeedOf::Same(_) | SpeedOf::Formula => None,
        };
        let places: Option<Vec<usize>> = self.speeds.iter().map(place).collect();
        let Some(places) = places else { return Ok(false) };
        let (mass, _) = instance.mass_and_forces(&mut values)?;
        let mass = rates.between(&mass);
        let mut coordinates = values.coordinates.to_vec();
        let mut normal = |contact: usize, accelerated: Option<usize>| {
            if let Some(place) = accelerated {
                coordinates[place].2[2] = 1.0;
            }
            let (own, mut bodies) = instance.contact(contact);
            let formula = own.normal.entry().1;
            let force =
                bodies.evaluate(formula, &mut Numeric { coordinates: &coordinates, ..values });
            if let Some(place) = accelerated {
                coordinates[place].2[2] = 0.0;
            }
            force
        };
        let mut reactions = Vec::new();
        for contact in 0..places.len() {
            let still = normal(contact, None)?;
            let factors = (0..n).map(|place| Ok(normal(contact, Some(place))? - still));
            reactions.push(rates.across(&factors.collect::<Result<Vec<f64>, FormulaFault>>()?));
        }
        let free: Vec<usize> = (0..n).filter(|place| !places.contains(place)).collect();
        let part = |rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |row, column| {
                mass[rows[row]][columns[column]]
            })
        };
        let reaction = |columns: &[usize]| {
            DMatrix::from_fn(places.len(), columns.len(), |row, column| {
                reactions[row][columns[column]]
            })
        };
        let follow = match free.is_empty() {
            true => Some(DMatrix::zeros(0, places.len())),
            false => part(&free, &free).lu().solve(&part(&free, &places)),
        };
        let Some(follow) = follow else { return Ok(false) };
        let a = part(&places, &places) - part(&places, &free) * &follow;
        let b = reaction(&places) - reaction(&free) * &follow;
        // Each acceleration is taken over the square root of its own inertia.
        let size = |place: usize| a[(place, place)].sqrt();
        let dominates = |row: usize| {
            let ratio = self.friction(row).largest_ratio();
            let entry = |column: usize| {
                let scale = size(row) * size(column);
                [a[(row, column)] / scale, ratio * b[(row, column)].abs() / scale]
            };
            let [own, shift] = entry(row);
            let others = (0..places.len()).filter(|column| *column != row).map(entry);
            own - shift > others.map(|[one, other]| one.abs() + other).sum::<f64>()
        };
        Ok((0..places.len()).all(dominates))
    }
}
