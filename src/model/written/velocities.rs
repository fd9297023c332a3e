//! The velocities of a system: sliding speeds where that is possible, so that a contact that sticks has a velocity of exactly 0.
//!
//! A sliding speed with constant factors of the rates of change, such as `x' - v_belt` or `y' + r phi'`, becomes the velocity
//! in place of the rate of change of one coordinate. The rates of change are then linear functions of the velocities. The integral
//! of such a sliding speed, such as `y + r phi`, becomes the position in place of the coordinate: it does not move while the
//! contact sticks, so that a rest can be certified.

use super::formula::{Valued, WHOLE};
use super::instance::Instance;
use super::linear::{LinearForm, Linearised};
use super::numeric::{NamedValues, Scalar};

/// What elimination leaves of a factor that is 0, in units of the motion.
pub(super) const ROUNDING: f64 = 1e-12;

/// How a contact's sliding speed is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SpeedOf {
    /// It is the velocity in place of the rate of change of this coordinate.
    Velocity(usize),
    /// It equals this velocity, which belongs to an earlier contact.
    Same(usize),
    /// It is a positive multiple of this velocity, which belongs to an earlier contact. The unit of this sliding speed contains the
    /// factor, so that both have the same value.
    Multiple(usize),
    /// It is a formula.
    Formula,
}

/// Rates of change as linear functions of velocities.
#[derive(Clone, Debug)]
pub(super) struct Rates<T> {
    /// The factors of the velocities in each rate of change.
    pub factors: Vec<Vec<T>>,
    pub constants: Vec<T>,
}

impl<T: Scalar> Rates<T> {
    fn identity(count: usize) -> Self {
        let [zero, one] = [0.0, 1.0].map(T::constant);
        let row =
            |row: usize| (0..count).map(|place| if place == row { one } else { zero }).collect();
        Rates { factors: (0..count).map(row).collect(), constants: vec![zero; count] }
    }

    /// Returns a linear function of rates as one of velocities: the factor of each velocity, and the constant.
    fn of_velocities(&self, speed: &LinearForm<T>) -> (Vec<T>, T) {
        let start = (vec![T::constant(0.0); self.constants.len()], speed.constant);
        speed.factors.iter().fold(start, |(mut factors, constant), (of, factor)| {
            for (sum, part) in factors.iter_mut().zip(&self.factors[*of]) {
                *sum = *sum + *factor * *part;
            }
            (factors, constant + *factor * self.constants[*of])
        })
    }

    /// Makes a linear function of velocities the velocity at a place.
    fn replace(&mut self, place: usize, (factors, constant): &(Vec<T>, T)) {
        for (row, rest) in self.factors.iter_mut().zip(&mut self.constants) {
            let share = row[place] / factors[place];
            for (which, (sum, factor)) in row.iter_mut().zip(factors).enumerate() {
                *sum = if which == place { share } else { *sum - share * *factor };
            }
            *rest = *rest - share * *constant;
        }
    }

    /// Returns forces, or other factors of rates of change, as factors of velocities.
    pub fn across(&self, forces: &[T]) -> Vec<T> {
        let of = |place: usize| {
            let each = self.factors.iter().zip(forces);
            each.fold(T::constant(0.0), |sum, (row, force)| sum + row[place] * *force)
        };
        (0..forces.len()).map(of).collect()
    }

    /// Returns a mass matrix of rates of change as one of velocities.
    pub fn between(&self, mass: &[Vec<T>]) -> Vec<Vec<T>> {
        let half: Vec<Vec<T>> = mass.iter().map(|row| self.across(row)).collect();
        let column = |place: usize| half.iter().map(|row| row[place]).collect::<Vec<_>>();
        (0..mass.len()).map(|place| self.across(&column(place))).collect()
    }

    /// Returns the rates without their constants.
    pub fn without_constants(self) -> Self {
        let constants = self.constants.iter().map(|_| T::constant(0.0)).collect();
        Rates { constants, ..self }
    }

    /// Returns the rates of change of these velocities.
    pub fn at(&self, velocities: &[T]) -> Vec<T> {
        (0..self.constants.len()).map(|row| self.row_at(row, velocities)).collect()
    }

    /// Returns one of the rates of change of these velocities.
    pub fn row_at(&self, row: usize, velocities: &[T]) -> T {
        let terms = self.factors[row].iter().zip(velocities);
        terms.fold(self.constants[row], |sum, (factor, velocity)| sum + *factor * *velocity)
    }
}

impl Instance<'_> {
    /// Returns the sliding speed of a contact as a linear function of the rates of change.
    pub fn linear<T: Scalar>(
        &self,
        contact: usize,
        numeric: NamedValues<'_, T>,
    ) -> Valued<Option<LinearForm<T>>> {
        let (contact, mut bodies) = self.contact(contact);
        let Some(sliding) = &contact.sliding else { return Ok(None) };
        bodies.evaluate(sliding, &mut Linearised { instance: self, numeric }).map(Some)
    }

    /// Chooses the velocities, for these values of the parameters.
    pub fn choose_velocities(&self, numeric: NamedValues<'_, f64>) -> Valued<Vec<SpeedOf>> {
        let mut rates = Rates::<f64>::identity(self.coordinates.len());
        let mut chosen: Vec<SpeedOf> = Vec::new();
        for contact in 0..self.contacts.len() {
            let speed = match self.has_constant_factors(contact)? {
                true => self.linear(contact, numeric)?,
                false => None,
            };
            let Some(speed) = speed else {
                chosen.push(SpeedOf::Formula);
                continue;
            };
            let all = rates.of_velocities(&speed);
            let taken = |place: &usize| chosen.contains(&SpeedOf::Velocity(*place));
            let size = |place: &usize| all.0[*place].abs();
            let free = (0..all.0.len()).filter(|place| !taken(place) && size(place) > ROUNDING);
            // Nothing may depend on a length of a body whose contacts open, such as the height of one that falls; its angles
            // say how large the gaps are.
            let opens = self.has_gap(contact);
            let length = |place: &usize| self.coordinate(*place).unit.dimension[1];
            let is_preferred = |place: &usize| opens && length(place) == WHOLE;
            let largest = free.max_by(|left, right| {
                let preferred = is_preferred(left).cmp(&is_preferred(right));
                preferred.then(size(left).total_cmp(&size(right))).then(right.cmp(left))
            });
            if let Some(place) = largest {
                rates.replace(place, &all);
                chosen.push(SpeedOf::Velocity(place));
                continue;
            }
            // Elimination rounds what is exactly 0 or 1.
            let mut moving = (0..all.0.len()).filter(|place| size(place) > ROUNDING);
            chosen.push(match (moving.next(), moving.next()) {
                (Some(place), None) if all.1.abs() <= ROUNDING => match all.0[place] {
                    factor if (factor - 1.0).abs() <= ROUNDING => SpeedOf::Same(place),
                    factor if factor > 0.0 && !opens => SpeedOf::Multiple(place),
                    _ => SpeedOf::Formula,
                },
                _ => SpeedOf::Formula,
            });
        }
        Ok(chosen)
    }

    /// Returns the velocities whose integrals are positions in place of coordinates. The integral of a sliding speed with an angle
    /// that goes round and round is no function of the state.
    pub fn choose_positions(
        &self,
        chosen: &[SpeedOf],
        numeric: NamedValues<'_, f64>,
    ) -> Valued<Vec<SpeedOf>> {
        let is_periodic = |(of, _): &(usize, f64)| self.is_periodic(*of);
        let mut rates = Rates::<f64>::identity(self.coordinates.len());
        let mut integrals = Vec::new();
        for (contact, speed_of) in chosen.iter().enumerate() {
            let speed = match speed_of {
                SpeedOf::Formula => None,
                _ => self.linear(contact, numeric)?,
            };
            let is_free = |speed: &LinearForm<f64>| !speed.factors.iter().any(is_periodic);
            let speed = match speed_of {
                SpeedOf::Same(place) | SpeedOf::Multiple(place) => {
                    speed.filter(|_| integrals.contains(&SpeedOf::Velocity(*place)))
                }
                _ => speed.filter(is_free),
            };
            integrals.push(match (*speed_of, speed.map(|speed| rates.of_velocities(&speed))) {
                (SpeedOf::Velocity(place), Some(all)) if all.0[place].abs() > ROUNDING => {
                    rates.replace(place, &all);
                    *speed_of
                }
                (SpeedOf::Same(place) | SpeedOf::Multiple(place), Some(_)) => SpeedOf::Same(place),
                _ => SpeedOf::Formula,
            });
        }
        Ok(integrals)
    }

    /// Returns the factor between a velocity and the sliding speed of a contact that is a multiple of it; `None` for other contacts.
    pub fn multiple<T: Scalar>(
        &self,
        (contact, speed): (usize, SpeedOf),
        rates: &Rates<T>,
        numeric: NamedValues<'_, T>,
    ) -> Valued<Option<T>> {
        let SpeedOf::Multiple(place) = speed else { return Ok(None) };
        let speed = self.linear(contact, numeric)?;
        Ok(speed.map(|speed| rates.of_velocities(&speed).0[place]))
    }

    /// Returns the rates of change for chosen velocities.
    pub fn rates<T: Scalar>(
        &self,
        chosen: &[SpeedOf],
        numeric: NamedValues<'_, T>,
    ) -> Valued<Rates<T>> {
        let mut rates = Rates::identity(self.coordinates.len());
        for (contact, speed_of) in chosen.iter().enumerate() {
            let SpeedOf::Velocity(place) = speed_of else { continue };
            if let Some(speed) = self.linear(contact, numeric)? {
                let all = rates.of_velocities(&speed);
                rates.replace(*place, &all);
            }
        }
        Ok(rates)
    }
}
