//! Units of the non-dimensional values of a model.

use super::OutputUnits;

/// Conversion of non-dimensional values of a model to SI units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Units {
    /// Natural frequency, rad/s: the reciprocal of the unit of time.
    pub natural_rad_s: f64,
    /// Unit of length, m.
    pub length_m: f64,
    /// The units of each contact.
    pub contacts: Vec<ContactUnits>,
    /// Speed of the disc, rad/s; 0 without a disc.
    pub disc_rad_s: f64,
    /// The units of each output.
    pub outputs: Vec<OutputUnits>,
}

/// The units of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactUnits {
    /// Unit of its position: 1 rad for a ball, the unit of length for a block.
    pub position: f64,
    /// Unit of its sliding speed, rad/s or m/s.
    pub sliding_speed: f64,
    /// Unit of its forces, N.
    pub force_n: f64,
}

impl ContactUnits {
    /// Returns the units of a contact whose sliding speed is the rate of change of its position, for a unit of time of
    /// `1 / natural_rad_s`.
    pub fn new(position: f64, natural_rad_s: f64, force_n: f64) -> Self {
        let sliding_speed = position * natural_rad_s;
        ContactUnits { position, sliding_speed, force_n }
    }
}

impl Units {
    /// Returns values of all contacts, each times a unit of the contact.
    pub fn of_contacts<'a>(
        &self,
        values: impl IntoIterator<Item = &'a f64>,
        unit: fn(&ContactUnits) -> f64,
    ) -> Vec<f64> {
        values.into_iter().zip(&self.contacts).map(|(value, units)| value * unit(units)).collect()
    }
}
