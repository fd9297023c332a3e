//! The sizes of a system in the middle of its start ranges: its frequencies, and the units in which its motion is computed.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, Schur};

use super::formula::{Valued, WHOLE};
use super::instance::Instance;
use super::numeric::{NamedValues, Scales};

/// The rounding of a sum, over the sum of the sizes of its terms.
const ROUNDING: f64 = 1e-14;

/// The sizes of a system with values of its parameters, in SI units.
pub(super) struct Sizes {
    /// Each coordinate and its rate of change in the middle of its start ranges.
    pub middle: Vec<[f64; 2]>,
    /// The largest start value and start rate of each coordinate.
    pub reach: Vec<[f64; 2]>,
    /// Whether masses and forces are finite in the middle.
    pub is_finite: bool,
    /// The coordinate that has no kinetic energy there, if the mass matrix is not positive definite.
    pub without_energy: Option<usize>,
    /// The highest frequency and the largest rate of damping without contacts, 1/s.
    pub rates: [f64; 2],
    pub scales: Scales,
    /// The rate at which it moves, 1/s.
    pub rate: f64,
    /// The acceleration of each coordinate in the middle, without contacts.
    pub accelerations: Vec<f64>,
    /// How far each coordinate moves about the middle; 0 if nothing says so.
    pub amplitudes: Vec<f64>,
}

/// Returns the range of start values and that of start rates of each coordinate, in SI units.
pub(super) fn ranges(instance: &Instance<'_>, values: &[f64]) -> Valued<Vec<[[f64; 2]; 2]>> {
    let parameters = instance.parameters(values, Scales::default(), 0.0);
    let mut numeric = NamedValues {
        scales: Scales::default(),
        parameters: &parameters,
        coordinates: &[],
        time: 0.0,
    };
    let mut all = Vec::new();
    for member in &instance.coordinates {
        let coordinate = &instance.definition.coordinates[member.of];
        let mut bodies = instance.bound(coordinate.index.as_deref(), member.body);
        let mut ranges = [[0.0; 2]; 2];
        for (range, formulas) in ranges.iter_mut().zip(&coordinate.start) {
            for (end, formula) in range.iter_mut().zip(formulas) {
                *end = bodies.evaluate(formula, &mut numeric)?;
            }
        }
        all.push(ranges);
    }
    Ok(all)
}

impl Instance<'_> {
    /// Returns the sizes for these values of the parameters; `period` is that of the equations.
    pub fn sizes(&self, values: &[f64], period: Option<f64>) -> Valued<Sizes> {
        let (instance, n) = (self, self.coordinates.len());
        let ranges = ranges(self, values)?;
        let [middle, reach] = middle_and_reach(&ranges);
        let all: Vec<usize> = (0..n).collect();
        let at_middle = self.accelerations(values, &middle, 0.0, &all)?;
        let slopes = self.slopes(values, &ranges, 0.0, &all)?;
        let definition = instance.definition;
        // The largest speed at which an angle turns at the start.
        let turns = |i: &usize| instance.is_periodic(*i);
        let turning = (0..n).filter(turns).map(|i| reach[i][1]).fold(0.0, f64::max);
        let is_ignorable = |number: &usize| {
            let acts = slopes[0].column(*number).iter().any(|slope| *slope != 0.0);
            Ok(!acts && self.is_ignorable(values, &middle, *number)?)
        };
        let ignorable = all.iter().map(is_ignorable).collect::<Valued<Vec<bool>>>()?;
        // What rounding leaves of forces that cancel each other, such as those of two springs, tells nothing.
        let rounding = |row: usize| -> f64 {
            let terms = (0..n).map(|column| slopes[0][(row, column)].abs() * reach[column][0]);
            ROUNDING * terms.sum::<f64>()
        };
        let rounding: Vec<f64> = (0..n).map(rounding).collect();
        let [stiffness, damping] = slopes.map(|slopes| largest_eigenvalue(&slopes));
        let forcing = period.map_or(0.0, |period| TAU / period.abs());
        let frequency = stiffness.sqrt().max(forcing);
        let [mut acceleration, mass] =
            at_middle.clone().unwrap_or_else(|| [vec![0.0; n], vec![0.0; n]]);
        for (value, rounding) in acceleration.iter_mut().zip(rounding) {
            *value = if value.abs() <= rounding { 0.0 } else { *value };
        }
        let largest = |of: &dyn Fn(usize) -> f64| {
            (0..n).map(of).filter(|value| value.is_finite()).fold(0.0, f64::max)
        };
        // How far a coordinate moves. Without units, a start value other than 0 does not tell: it may be any small number.
        let size = |i: usize| match definition.has_units() {
            _ if ignorable[i] => 0.0,
            true => reach[i][0],
            false => 0.5 * (ranges[i][0][1] - ranges[i][0][0]).abs(),
        };
        // Differences leave a stiffness of this size where there is none.
        let noise = 1e-9 * largest(&|i| acceleration[i].abs() / reach[i][0]);
        let oscillates = definition.has_units() || frequency * frequency > noise;
        let rate = [
            if oscillates { frequency } else { 0.0 },
            if definition.has_units() { 0.0 } else { turning },
            largest(&|i| reach[i][1] / size(i)),
            largest(&|i| (acceleration[i].abs() / size(i)).sqrt()),
            largest(&|i| acceleration[i].abs() / reach[i][1]),
            damping,
            1.0,
        ];
        let rate = rate.into_iter().find(|rate| rate.is_finite() && *rate > 0.0).unwrap_or(1.0);
        let is_length = |i: &usize| instance.coordinate(*i).unit.dimension == [0, WHOLE, 0];
        let amplitude =
            |i: usize| size(i).max(reach[i][1] / rate).max(acceleration[i].abs() / (rate * rate));
        let amplitudes: Vec<f64> = (0..n).map(amplitude).collect();
        let lengths = (0..n).filter(is_length).map(|i| amplitudes[i]);
        let length = lengths.filter(|value| value.is_finite()).fold(0.0, f64::max);
        let length = if length > 0.0 { length } else { 1.0 };
        let masses =
            (0..n).map(|i| if is_length(&i) { mass[i] } else { mass[i] / (length * length) });
        let mass = masses.filter(|value| value.is_finite()).fold(0.0, f64::max);
        let scales = match definition.has_units() {
            true => Scales::near([mass, length, 1.0 / rate]),
            false => Scales::default(),
        };
        let without_energy = match at_middle.is_some() {
            true => None,
            false => Some(smallest_pivot(self.mass_at(values, &middle, 0.0)?.0).1),
        };
        let is_finite =
            self.all_at(values, &middle, (0.0, 0.0))?.iter().all(|value| value.is_finite());
        Ok(Sizes {
            middle,
            reach,
            is_finite,
            without_energy,
            // A step is at most half a turn at this speed.
            rates: [frequency.max(0.5 * turning), damping],
            scales,
            rate,
            accelerations: acceleration,
            amplitudes,
        })
    }

    /// Returns whether no formula contains a coordinate but for its rates of change, such as the position of a car. Where it starts
    /// tells nothing of the motion.
    fn is_ignorable(&self, values: &[f64], state: &[[f64; 2]], number: usize) -> Valued<bool> {
        let mut state = state.to_vec();
        // What is computed from it is not a number either, also where its factor vanishes.
        state[number][0] = f64::NAN;
        Ok(self.all_at(values, &state, (0.0, 0.0))?.iter().all(|value| !value.is_nan()))
    }

    /// Returns the slopes of the accelerations of some coordinates without contacts over their values, and over their rates of
    /// change, in the middle of the start ranges. The other coordinates do not move.
    pub fn slopes(
        &self,
        values: &[f64],
        ranges: &[[[f64; 2]; 2]],
        time: f64,
        moving: &[usize],
    ) -> Valued<[DMatrix<f64>; 2]> {
        let [middle, reach] = middle_and_reach(ranges);
        let mut slopes = [0, 1].map(|_| DMatrix::zeros(moving.len(), moving.len()));
        // Central differences; the equations are smooth.
        for (column, &number) in moving.iter().enumerate() {
            for (which, slopes) in slopes.iter_mut().enumerate() {
                let reach = reach[number][which];
                let step = if reach > 0.0 { 1e-4 * reach } else { 1e-6 };
                let beside = |step: f64| {
                    let mut state = middle.clone();
                    state[number][which] += step;
                    self.accelerations(values, &state, time, moving)
                };
                if let (Some([ahead, _]), Some([behind, _])) = (beside(step)?, beside(-step)?) {
                    for row in 0..moving.len() {
                        slopes[(row, column)] = (ahead[row] - behind[row]) / (2.0 * step);
                    }
                }
            }
        }
        Ok(slopes)
    }

    /// Returns the mass matrix and the forces in a state.
    pub fn mass_at(
        &self,
        values: &[f64],
        state: &[[f64; 2]],
        time: f64,
    ) -> Valued<(Vec<Vec<f64>>, Vec<f64>)> {
        let (parameters, coordinates) =
            (self.parameters(values, Scales::default(), time), self.named(|number| state[number]));
        let scales = Scales::default();
        let mut numeric =
            NamedValues { scales, parameters: &parameters, coordinates: &coordinates, time };
        self.mass_and_forces(&mut numeric)
    }

    /// Returns the accelerations of some coordinates without contacts while the others do not move, and their diagonal of the
    /// mass matrix; `None` if this is not positive definite.
    fn accelerations(
        &self,
        values: &[f64],
        state: &[[f64; 2]],
        time: f64,
        moving: &[usize],
    ) -> Valued<Option<[Vec<f64>; 2]>> {
        let (mass, forces) = self.mass_at(values, state, time)?;
        let n = moving.len();
        let matrix = DMatrix::from_fn(n, n, |row, column| mass[moving[row]][moving[column]]);
        let forces = nalgebra::DVector::from_fn(n, |row, _| forces[moving[row]]);
        if !matrix.iter().chain(&forces).all(|entry| entry.is_finite()) {
            return Ok(None);
        }
        let diagonal = matrix.diagonal().iter().copied().collect();
        let Some(factors) = matrix.cholesky() else { return Ok(None) };
        Ok(Some([factors.solve(&forces).iter().copied().collect(), diagonal]))
    }
}

/// Returns the middle of the start ranges, and the largest start values.
fn middle_and_reach(ranges: &[[[f64; 2]; 2]]) -> [Vec<[f64; 2]>; 2] {
    let of = |value: fn([f64; 2]) -> f64| ranges.iter().map(|both| both.map(value)).collect();
    [of(|[low, high]| 0.5 * (low + high)), of(|[low, high]| low.abs().max(high.abs()))]
}

/// Returns the largest modulus of an eigenvalue; 0 for a matrix that is not finite.
fn largest_eigenvalue(matrix: &DMatrix<f64>) -> f64 {
    if matrix.is_empty() || !matrix.iter().all(|entry| entry.is_finite()) {
        return 0.0;
    }
    let schur = Schur::try_new(matrix.clone(), f64::EPSILON, 10_000);
    let eigenvalues = schur.map(|schur| schur.complex_eigenvalues());
    eigenvalues.map_or(0.0, |all| all.iter().map(|value| value.norm()).fold(0.0, f64::max))
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
