//! What the parameters of a system of one's own say without simulation.

use serde::{Serialize, Serializer};

use super::SteadyStates;
use crate::model::{CampbellDiagram, DerivedQuantity, Model, NaturalFrequencies};

/// The facts of a system of one's own.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct OwnFacts {
    /// The natural frequencies.
    pub natural_frequencies: NaturalFrequencies,
    /// The speeds of the part that turns that equal a natural frequency, rad/s.
    pub critical_speeds_rad_s: Vec<f64>,
    /// The quantities that follow from the parameters alone.
    #[serde(serialize_with = "by_name")]
    pub derived: Vec<DerivedQuantity>,
    /// The steady states, if they are sought.
    pub steady_states: Option<SteadyStates>,
}

impl OwnFacts {
    /// Computes the facts of a model with these ranges of start states; `None` for a ball balancer.
    pub fn of(model: &Model, ranges: &[[f64; 2]]) -> Option<Self> {
        let Model::Own(own_model) = model else { return None };
        Some(OwnFacts {
            natural_frequencies: model.natural_frequencies(),
            critical_speeds_rad_s: CampbellDiagram::of(model)
                .map_or_else(Vec::new, |diagram| diagram.critical_rad_s),
            derived: own_model.derived(),
            steady_states: SteadyStates::of(model, ranges),
        })
    }
}

/// Writes values by name; a value that is not finite is null.
fn by_name<S: Serializer>(all: &[DerivedQuantity], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(all.iter().map(|quantity| (&quantity.name.name, quantity.value)))
}
