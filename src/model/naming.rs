//! What the contacts of a model are called in tables, texts and figures.

use super::{Graph, Model, SlidingSpeed};

impl Model {
    /// Returns the ending that tells the contacts apart in the names of columns: `_1` for the first one, counted from 0
    /// here; nothing for the only contact of a block.
    pub fn contact_suffix(&self, contact: usize) -> String {
        match self {
            Model::Block(_) => String::new(),
            Model::BallBalancer(_) | Model::Own(_) => format!("_{}", contact + 1),
        }
    }

    /// Returns the name and the unit of the column with the position of a contact, counted from 0.
    pub fn position_column(&self, contact: usize) -> (String, &'static str) {
        let suffix = self.contact_suffix(contact);
        match (self, self.kind().sliding_speed) {
            (Model::BallBalancer(_), _) => (format!("beta{suffix}_rad"), "rad"),
            (_, SlidingSpeed::MS) => (format!("position{suffix}_m"), "m"),
            (_, SlidingSpeed::RadS) => (format!("angle{suffix}_rad"), "rad"),
        }
    }
    /// Returns the contacts of a system of one's own that may creep, because no equation contains their positions, each with the
    /// name and the unit of the column with its mean speed.
    pub fn mean_speed_columns(&self) -> Vec<(usize, String, &'static str)> {
        let Some(system) = self.system().filter(|_| matches!(self, Model::Own(_))) else {
            return Vec::new();
        };
        let graph = Graph::of(system.as_ref());
        let contacts = graph.layout.contacts.iter().enumerate();
        let creeping = contacts.filter(|(_, contact)| graph.may_creep(contact));
        creeping
            .map(|(contact, _)| {
                let suffix = self.contact_suffix(contact);
                let (ending, unit) = match self.kind().sliding_speed {
                    SlidingSpeed::MS => ("m_s", "m/s"),
                    SlidingSpeed::RadS => ("rad_s", "rad/s"),
                };
                (contact, format!("mean_speed{suffix}_{ending}"), unit)
            })
            .collect()
    }
}
