//! The units in which the motion of a system without units is computed.
//!
//! The formulas of a system with units are computed in units of mass, length and time near its sizes ([`Scales`]). Formulas
//! without units have numbers such as 9810 mm/s² whose dimensions nobody knows, so they are computed as they are. The components
//! of the state have units of their own instead: each position and each velocity, the sliding speed of each contact, the time,
//! and the power. The equations of motion are multiplied by the units of their velocities, over that of the power:
//!
//! ```text
//! v = u ν,  t = s τ:   (u_i M_ij u_j / (s P)) dν_j/dτ = (u_i / P) h_i
//! ```
//!
//! All units are powers of two, so that conversion is exact.

use super::definition::WrittenNormal;
use super::formula::{Valued, WHOLE};
use super::instance::Instance;
use super::numeric::{NamedValues, Scalar, Scales};
use super::sizes::Sizes;
use super::velocities::{ROUNDING, Rates, SpeedOf};

/// Numbers between 1 / 16 and 16 are left as they are: tolerances are relative to 1.
const FAR_FROM_ONE: f64 = 16.0;
/// With an acceleration above this, a system keeps the units of its numbers: the value is a mistake, and its run fails soon.
const IMPLAUSIBLE: f64 = 1e15;

/// The units of the state over those of the formulas. All are 1 for a system with units.
#[derive(Clone, Debug)]
pub(super) struct StateUnits {
    pub time: f64,
    pub power: f64,
    pub positions: Vec<f64>,
    pub velocities: Vec<f64>,
    /// The unit of the sliding speed of each contact without its multiple of a velocity.
    pub contacts: Vec<f64>,
}

impl StateUnits {
    /// Returns the units of a system from its sizes. `moving` has the rates of change as functions of the velocities that `speeds`
    /// choose, and `integrals` those whose integrals are positions.
    ///
    /// Small start ranges alone are no reason for other units: a motion may also begin near an equilibrium.
    pub fn new(
        (instance, values, sizes): (&Instance<'_>, &[f64], &Sizes),
        (moving, speeds, integrals): (&Rates<f64>, &[SpeedOf], &[SpeedOf]),
    ) -> Valued<Self> {
        let n = instance.coordinates.len();
        let same = StateUnits {
            time: 1.0,
            power: 1.0,
            positions: vec![1.0; n],
            velocities: vec![1.0; n],
            contacts: vec![1.0; speeds.len()],
        };
        if instance.definition.has_units() || !sizes.is_finite || sizes.without_energy.is_some() {
            return Ok(same);
        }
        let (mass, _) = instance.mass_at(values, &sizes.middle, 0.0)?;
        let inertia: Vec<f64> = mass.iter().zip(0..).map(|(row, place)| row[place]).collect();
        let largest =
            |all: &[f64]| all.iter().copied().filter(|size| size.is_finite()).fold(0.0, f64::max);
        let is_far = |size: f64| size > FAR_FROM_ONE || size > 0.0 && size < 1.0 / FAR_FROM_ONE;
        let starts = largest(sizes.reach.as_flattened());
        let accelerations =
            largest(&sizes.accelerations.iter().map(|of| of.abs()).collect::<Vec<_>>());
        let is_large = starts > FAR_FROM_ONE || accelerations > FAR_FROM_ONE * FAR_FROM_ONE;
        let is_implausible = accelerations > IMPLAUSIBLE;
        if is_implausible || !(is_large || is_far(sizes.rate) || is_far(largest(&inertia))) {
            return Ok(same);
        }
        let near = |size: f64| Scales::near([1.0, size, 1.0]).unit([0, WHOLE, 0]);
        let parameters = instance.parameters(values, Scales::default(), 0.0);
        let names = |lengths: &[f64], part: f64| {
            instance.named(|number| {
                let [position, rate] = sizes.middle[number];
                [position + part * lengths[number], rate]
            })
        };
        let numeric = NamedValues {
            scales: Scales::default(),
            parameters: &parameters,
            coordinates: &names(&sizes.amplitudes, 0.0),
            time: 0.0,
        };
        let mut amplitudes = sizes.amplitudes.clone();
        for contact in 0..speeds.len() {
            instance.drag_along(contact, numeric, (sizes.rate, &inertia), &mut amplitudes)?;
        }
        let lengths = lengths(&amplitudes, &inertia);
        let time = near(1.0 / sizes.rate);
        let own =
            |place: usize| if instance.is_periodic(place) { 1.0 } else { near(lengths[place]) };
        let mut units = StateUnits {
            time,
            power: 1.0,
            positions: (0..n).map(own).collect(),
            velocities: lengths.iter().map(|length| near(*length) / time).collect(),
            contacts: Vec::new(),
        };
        for (number, speed) in speeds.iter().enumerate() {
            // A factor may vanish in one state.
            let reaches = [0.0, 0.29, -0.37, 1.0, -1.0].map(|part| {
                let values = NamedValues { coordinates: &names(&lengths, part), ..numeric };
                instance.reach_of_contact(number, &lengths, values)
            });
            let reaches = reaches.into_iter().collect::<Result<Vec<_>, _>>()?;
            let reach = near(largest(&reaches));
            match speed {
                SpeedOf::Velocity(place) => units.velocities[*place] = reach / time,
                SpeedOf::Same(_) | SpeedOf::Multiple(_) | SpeedOf::Formula => {}
            }
            if let SpeedOf::Velocity(place) = integrals[number] {
                units.positions[place] = reach;
            }
            units.contacts.push(match speed {
                SpeedOf::Velocity(place) | SpeedOf::Same(place) | SpeedOf::Multiple(place) => {
                    units.velocities[*place]
                }
                SpeedOf::Formula => reach / time,
            });
        }
        let inertia = moving.between(&mass);
        let energies = (0..n).map(|place| inertia[place][place] * units.velocities[place].powi(2));
        units.power = near(energies.fold(0.0, f64::max)) / time;
        Ok(units)
    }

    /// Returns all units.
    pub fn all(&self) -> impl Iterator<Item = f64> + '_ {
        let components = self.positions.iter().chain(&self.velocities).chain(&self.contacts);
        [self.time, self.power].into_iter().chain(components.copied())
    }

    /// Returns positions in units of the formulas.
    pub fn positions_of<T: Scalar>(&self, positions: &[T]) -> Vec<T> {
        times(positions, &self.positions)
    }

    /// Returns velocities in units of the formulas.
    pub fn velocities_of<T: Scalar>(&self, velocities: &[T]) -> Vec<T> {
        times(velocities, &self.velocities)
    }

    /// Converts coordinates and their rates of change to units of the state.
    pub fn convert_coordinates<T: Scalar>(&self, [coordinates, rates]: &mut [Vec<T>; 2]) {
        for (number, (coordinate, rate)) in coordinates.iter_mut().zip(rates).enumerate() {
            let [unit, rate_unit] = self.of_coordinate(number);
            *coordinate = coordinate.in_unit(1.0 / unit);
            *rate = rate.in_unit(1.0 / rate_unit);
        }
    }

    /// Returns the units of a coordinate and of its rate of change: those of the components in its place.
    pub fn of_coordinate(&self, number: usize) -> [f64; 2] {
        [self.positions[number], self.velocities[number]]
    }

    /// Converts rates of change of positions to units of the state.
    pub fn convert_rates<T: Scalar>(&self, rates: &mut [T]) {
        for (rate, position) in rates.iter_mut().zip(&self.positions) {
            *rate = rate.in_unit(self.time / position);
        }
    }

    /// Converts forces on velocities to units of the state.
    pub fn convert_forces<T: Scalar>(&self, forces: &mut [T]) {
        for (force, velocity) in forces.iter_mut().zip(&self.velocities) {
            *force = force.in_unit(velocity / self.power);
        }
    }

    /// Converts the factors of accelerations.
    pub fn convert_accelerations<T: Scalar>(&self, factors: &mut [T]) {
        for (factor, velocity) in factors.iter_mut().zip(&self.velocities) {
            *factor = factor.in_unit(velocity / self.time);
        }
    }

    /// Converts a mass matrix of velocities to units of the state.
    pub fn convert_inertia<T: Scalar>(&self, mass: &mut [Vec<T>]) {
        for (row, velocity) in mass.iter_mut().zip(&self.velocities) {
            self.convert_accelerations(row);
            for entry in row {
                *entry = entry.in_unit(velocity / self.power);
            }
        }
    }

    /// Returns the factor that converts forces of a contact to units of the state.
    pub fn force_factor(&self, contact: usize) -> f64 {
        self.contacts[contact] / self.power
    }
}

/// Returns how far each coordinate moves. A coordinate without a known amplitude moves with as much energy as the others.
fn lengths(amplitudes: &[f64], inertia: &[f64]) -> Vec<f64> {
    let each = amplitudes.iter().zip(inertia);
    let energies = each.clone().map(|(amplitude, inertia)| inertia * amplitude.powi(2));
    let largest = energies.filter(|energy| energy.is_finite()).fold(0.0, f64::max);
    let lengths = each.map(|(&amplitude, inertia)| match amplitude {
        _ if amplitude.is_finite() && amplitude > 0.0 => amplitude,
        _ if largest > 0.0 => (largest / inertia).sqrt(),
        _ => 1.0,
    });
    lengths.collect()
}

/// Returns each value times its unit.
fn times<T: Scalar>(values: &[T], units: &[f64]) -> Vec<T> {
    values.iter().zip(units).map(|(value, unit)| value.in_unit(*unit)).collect()
}

impl Instance<'_> {
    /// Raises the amplitudes of the coordinates of a contact to how far a support at constant speed, or its normal force as friction,
    /// moves them at a rate.
    fn drag_along(
        &self,
        contact: usize,
        mut numeric: NamedValues<'_, f64>,
        (rate, inertia): (f64, &[f64]),
        amplitudes: &mut [f64],
    ) -> Valued<()> {
        let Some(form) = self.linear(contact, numeric)? else { return Ok(()) };
        let (contact, mut bodies) = self.contact(contact);
        let force = match &contact.normal {
            WrittenNormal::Given(force) => bodies.evaluate(force, &mut numeric)?,
            WrittenNormal::Gap(_) => 0.0,
        };
        for (of, factor) in form.factors {
            let by_force = (force * factor / (inertia[of] * rate * rate)).abs();
            let by_support = (form.constant / (factor * rate)).abs();
            // A factor that is only rounding takes it nowhere.
            let by_support = if factor.abs() > ROUNDING { by_support } else { 0.0 };
            amplitudes[of] = amplitudes[of].max(by_force).max(by_support);
        }
        Ok(())
    }

    /// Returns how far a contact slides, or opens if it has no friction, while its coordinates move by these lengths. A gap opens at
    /// least by its width.
    fn reach_of_contact(
        &self,
        contact: usize,
        lengths: &[f64],
        numeric: NamedValues<'_, f64>,
    ) -> Valued<f64> {
        if let Some(form) = self.linear(contact, numeric)? {
            return Ok(form.factors.iter().map(|(of, factor)| factor.abs() * lengths[*of]).sum());
        }
        let (contact, mut bodies) = self.contact(contact);
        let mut reach = 0.0;
        let width =
            bodies.evaluate(contact.normal.entry().1, &mut NamedValues { ..numeric })?.abs();
        for (number, length) in lengths.iter().enumerate() {
            let step = 1e-4 * length;
            let mut beside = |step: f64| {
                let mut coordinates = numeric.coordinates.to_vec();
                coordinates[number].2[0] += step;
                let mut values = NamedValues { coordinates: &coordinates, ..numeric };
                bodies.evaluate(contact.normal.entry().1, &mut values)
            };
            reach += (beside(step)? - beside(-step)?).abs() * length / (2.0 * step);
        }
        Ok(width.max(reach))
    }
}
