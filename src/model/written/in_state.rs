//! A system in one state: its formulas, such as its mass matrix, and whether stick and slip are decided in one way where normal
//! forces depend on accelerations.
//!
//! With the accelerations of the other velocities eliminated, friction `f = q - A a` and normal forces `n + B a` depend on the
//! accelerations `a` of the sliding speeds. There is exactly one solution if `A + diag(p) B` is a P-matrix for all friction
//! ratios `|p_i| ≤ μ_i` (`existence.rs`). A matrix whose diagonal is positive and larger than the sum of the other entries of its
//! row is one. Intervals bound the entries in all states at once.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use super::formula::Valued;
use super::numeric::NamedValues;
use super::sizes::smallest_pivot;
use super::system::WrittenSystem;
use super::velocities::{Rates, SpeedOf};
use crate::model::{Bounded, Interval, Number, System};

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
        let time = clock.first().map_or(self.lasting.unwrap_or(0.0), |clock| {
            clock * self.period.map_or(1.0, |period| period / TAU)
        });
        let time = time * self.units.time;
        let parameters = instance.parameters_in_stage(&self.values, &self.stage, time);
        let base =
            NamedValues { scales: self.scales, parameters: &parameters, coordinates: &[], time };
        let [shapes, rates] = &self.coordinates;
        let (shapes, moving) = (
            shapes.at(&self.units.positions_of(positions)),
            rates.at(&self.units.velocities_of(velocities)),
        );
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

/// Far more than any value of a coordinate, without dimensions.
const WIDEST: f64 = 1e30;

/// What rounding of an inverse matrix may change, over the entries on the diagonal.
const ROUNDING: f64 = 1e-9;

impl WrittenSystem {
    /// Returns whether stick and slip are surely decided in one way in all states.
    pub(super) fn always_decides_in_one_way(&self) -> bool {
        // Given normal forces and independent sliding speeds.
        if !self.instance.definition.uses_accelerations || !self.does_not_open() {
            return self.does_not_open();
        }
        // Sines and cosines of any angle are bounded.
        let any = Interval::around(0.0, WIDEST);
        self.is_dominant(|_| [any; 2], any).unwrap_or(false)
    }

    /// Returns whether stick and slip are surely decided in one way in a state.
    pub(super) fn decides_in_one_way(&self, state: &[f64]) -> Valued<bool> {
        let found = self.in_state(state, |values, _| {
            let at = |number: usize| {
                let (.., [position, rate, _]) = values.coordinates[number];
                [position, rate].map(Interval::exact)
            };
            self.is_dominant(at, Interval::exact(values.time))
        })?;
        Ok(found.unwrap_or(false))
    }

    fn is_dominant(&self, at: impl Fn(usize) -> [Interval; 2], time: Interval) -> Valued<bool> {
        let (instance, n) = (&self.instance, self.instance.coordinates.len());
        let place = |speed: &SpeedOf| match speed {
            SpeedOf::Velocity(place) => Some(*place),
            SpeedOf::Same(_) | SpeedOf::Multiple(_) | SpeedOf::Formula => None,
        };
        let places: Option<Vec<usize>> = self.speeds.iter().map(place).collect();
        let Some(places) = places else { return Ok(false) };
        let bounded = |value: Interval| Bounded { value, slope: Interval::exact(0.0) };
        let values: Vec<Bounded> = self.values.iter().map(|x| Bounded::constant(*x)).collect();
        let stage = self.stage.map(Bounded::constant);
        let (scales, time) = (self.scales, bounded(time));
        let parameters = instance.parameters_in_stage(&values, &stage, time);
        let mut coordinates = instance.named(|number| at(number).map(bounded));
        let mut numeric =
            NamedValues { scales, parameters: &parameters, coordinates: &coordinates, time };
        let constants = |all: &Vec<f64>| all.iter().map(|x| Bounded::constant(*x)).collect();
        let Rates { factors, constants: rest } = &self.coordinates[1];
        let rates =
            Rates { factors: factors.iter().map(constants).collect(), constants: constants(rest) };
        let mass = rates.between(&instance.mass_and_forces(&mut numeric)?.0);
        let mut reactions = vec![vec![Bounded::constant(0.0); n]; places.len()];
        for coordinate in 0..n {
            coordinates[coordinate].2[2].slope = Interval::exact(1.0);
            let mut numeric =
                NamedValues { scales, parameters: &parameters, coordinates: &coordinates, time };
            for (contact, factors) in reactions.iter_mut().enumerate() {
                let (written, mut bodies) = instance.contact(contact);
                let force = bodies.evaluate(written.normal.entry().1, &mut numeric)?;
                factors[coordinate] = bounded(force.slope);
            }
            coordinates[coordinate].2[2].slope = Interval::exact(0.0);
        }
        let reactions: Vec<Vec<Bounded>> = reactions.iter().map(|row| rates.across(row)).collect();
        let free: Vec<usize> = (0..n).filter(|place| !places.contains(place)).collect();
        let inertia = DMatrix::from_fn(free.len(), free.len(), |row, column| {
            let Interval { low, high } = mass[free[row]][free[column]].value;
            if high - low <= ROUNDING * (low.abs() + high.abs()) {
                0.5 * (low + high)
            } else {
                f64::NAN
            }
        });
        let Some(inverse) = inertia.try_inverse() else { return Ok(false) };
        // The accelerations of the free velocities are minus these times those of the sliding speeds.
        let sum = |terms: &mut dyn Iterator<Item = Interval>| {
            terms.fold(Interval::exact(0.0), |sum, term| sum + term)
        };
        let follow = |row: usize, column: usize| {
            let inverse = &inverse;
            sum(&mut free.iter().enumerate().map(|(k, place)| {
                Interval::exact(inverse[(row, k)]) * mass[*place][places[column]].value
            }))
        };
        let follows: Vec<Vec<Interval>> = (0..free.len())
            .map(|row| (0..places.len()).map(|column| follow(row, column)).collect())
            .collect();
        let reduced = |all: &[Bounded], column: usize| {
            let of_free = &mut free
                .iter()
                .zip(&follows)
                .map(|(place, follow)| all[*place].value * follow[column]);
            all[places[column]].value - sum(of_free)
        };
        let a = |row: usize, column: usize| reduced(&mass[places[row]], column);
        // Each acceleration is taken over the square root of its own inertia.
        let size = |row: usize| a(row, row).high.sqrt();
        let most = |bounds: Interval| bounds.farthest_from(0.0);
        let dominates = |row: usize| {
            let ratio = self.friction(row).largest_ratio();
            let shift = |column: usize| ratio * most(reduced(&reactions[row], column));
            let others = (0..places.len()).filter(|column| *column != row);
            let others = others.map(|column| (most(a(row, column)) + shift(column)) / size(column));
            let diagonal = (1.0 - ROUNDING) * a(row, row).low - shift(row);
            diagonal / size(row) > others.sum::<f64>()
        };
        Ok((0..places.len()).all(dominates))
    }
}
