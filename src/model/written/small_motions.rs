//! Small motions of a system of a file about the middle of its start ranges.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use super::definition::WrittenNormal;
use super::formula::Valued;
use super::instance::Instance;
use super::sizes::ranges;
use crate::model::SmallMotionEquations;

/// Further instants within a period at which the equations of small motions must be equal.
const INSTANTS: [f64; 2] = [0.37, 0.71];
/// How much they may differ by rounding, over their size.
const ROUNDING: f64 = 1e-6;

impl Instance<'_> {
    /// Returns the time after which the equations repeat, s; `None` if they do not change with time.
    pub fn period_s(&self, values: &[f64]) -> Valued<Option<f64>> {
        let definition = self.definition;
        let period = definition.period.as_ref().map(|formula| self.constant(formula, values));
        let of_a_turn = definition.speed_place().map(|place| TAU / values[place].abs());
        Ok(period.transpose()?.or(of_a_turn.filter(|_| definition.uses_time)))
    }

    /// Returns the equations of small motions for these values of the parameters.
    pub fn small_motions(&self, values: &[f64]) -> Valued<SmallMotionEquations> {
        let all: Vec<usize> = (0..self.coordinates.len()).collect();
        let moved = self.moved_by_contacts()?;
        let held: Vec<usize> = all.iter().copied().filter(|place| !moved.contains(place)).collect();
        let of = |moving: &[usize]| self.state_matrix(values, moving);
        Ok(SmallMotionEquations {
            held: if held.is_empty() { None } else { of(&held)? },
            free: if moved.is_empty() { None } else { of(&all)? },
        })
    }

    /// Returns the coordinates in sliding speeds and gaps.
    fn moved_by_contacts(&self) -> Valued<Vec<usize>> {
        let mut moved = Vec::new();
        for number in 0..self.contacts.len() {
            let (contact, bodies) = self.contact(number);
            let gap = match &contact.normal {
                WrittenNormal::Gap(gap) => Some(gap),
                WrittenNormal::Given(_) => None,
            };
            for formula in contact.sliding.iter().chain(gap) {
                let (_, named) = self.analysed(formula, &mut bodies.clone())?;
                let numbers = named.appearing.iter();
                moved.extend(numbers.filter_map(|(name, body)| self.number_of(name, *body)));
            }
        }
        Ok(moved)
    }

    /// Returns the matrix of the equations of first order in which some coordinates move and the others do not, in SI units;
    /// `None` if it changes with time.
    fn state_matrix(&self, values: &[f64], moving: &[usize]) -> Valued<Option<DMatrix<f64>>> {
        let (ranges, period_s) = (ranges(self, values)?, self.period_s(values)?);
        let n = moving.len();
        let matrix_at = |time: f64| {
            let [stiffness, damping] = self.slopes(values, &ranges, time, moving)?;
            let mut matrix = DMatrix::zeros(2 * n, 2 * n);
            matrix.view_mut((0, n), (n, n)).fill_with_identity();
            matrix.view_mut((n, 0), (n, n)).copy_from(&stiffness);
            matrix.view_mut((n, n), (n, n)).copy_from(&damping);
            Ok(matrix)
        };
        let matrix: DMatrix<f64> = matrix_at(0.0)?;
        for part in period_s.iter().flat_map(|period| INSTANTS.map(|part| part * period)) {
            if (matrix_at(part)? - &matrix).norm() > ROUNDING * matrix.norm() {
                return Ok(None);
            }
        }
        Ok(matrix.iter().all(|entry| entry.is_finite()).then_some(matrix))
    }
}
