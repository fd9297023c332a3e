//! The units of a model, which convert its values to SI units, and its outputs: quantities that results show besides the
//! contacts.

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

/// What results call an output.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputName {
    /// The name with the unit, as columns show it.
    pub name: String,
    /// The unit.
    pub unit: String,
    /// What it is, in a few words.
    pub meaning: String,
}

/// A quantity that follows from the parameters of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct DerivedQuantity {
    /// What results call it.
    pub name: OutputName,
    /// Its value, in SI units.
    pub value: f64,
    /// The range of usual machines.
    pub usual: Option<[f64; 2]>,
    /// Whether it has no range: people want to read it, and not whether it is in order.
    pub is_shown: bool,
}

/// The unit of an output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputUnits {
    /// Its size in SI units.
    pub size: f64,
    /// Whether the output is an angle, with a period of one turn.
    pub angular: bool,
    /// Whether its amplitude counts for `amplitude_m`: it is a coordinate in m or without a unit.
    pub has_amplitude: bool,
}

/// A value of an output in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputValue {
    /// The value at the end.
    End,
    /// The mean over time.
    Mean,
    /// The least value.
    Least,
    /// The greatest value.
    Greatest,
    /// Half of the distance between the extremes.
    Amplitude,
    /// The displacement in a period, with its sign.
    Creep,
}

impl OutputValue {
    /// The values that are columns, each with what precedes the name of the output.
    pub const COLUMNS: [(&'static str, OutputValue); 4] = [
        ("end_", Self::End),
        ("mean_", Self::Mean),
        ("min_", Self::Least),
        ("max_", Self::Greatest),
    ];

    /// What precedes the name of the output in columns with its displacement in a period.
    pub const CREEP: (&'static str, OutputValue) = ("creep_", Self::Creep);

    /// Returns what the value is, after the name of the output.
    pub fn in_words(self) -> &'static str {
        match self {
            OutputValue::End => "at the end",
            OutputValue::Mean => {
                "mean over the limit cycle or the last tenth of the time, or value at rest"
            }
            OutputValue::Least => "least value in that time",
            OutputValue::Greatest => "greatest value in that time",
            OutputValue::Creep => {
                "displacement in each period of the limit cycle or of the forcing; positive for growing values"
            }
            OutputValue::Amplitude => "half of the distance between the extremes in that time",
        }
    }
}
