//! What the contacts of a model are called in tables, texts and figures.

use super::coordinate::unit_ending;
use super::{ContactNames, Graph, Model, OutputName, SlidingSpeed};

impl Model {
    /// Returns the names that a system of one's own gives to a contact, counted from 0.
    fn own_names(&self, contact: usize) -> Option<ContactNames> {
        let Model::Own(own) = self else { return None };
        own.own().contact_names(own)?.into_iter().nth(contact)
    }

    /// Returns the names of the outputs; none for a model that shows its contacts alone.
    pub fn output_names(&self) -> Vec<OutputName> {
        match self {
            Model::Own(own) => own.own().output_names(own),
            Model::BallBalancer(_) => Vec::new(),
        }
    }

    /// Returns the ending that tells the contacts apart in the names of columns: `_1` for the first one, counted from 0
    /// here, or `_NAME` for a contact with a name; nothing for the only contact of a block.
    pub fn contact_suffix(&self, contact: usize) -> String {
        match (self, self.own_names(contact)) {
            (_, Some(own)) => format!("_{}", own.contact),
            (_, None) => format!("_{}", contact + 1),
        }
    }

    /// Returns what a contact is called in a sentence.
    pub fn contact_in_words(&self, contact: usize) -> String {
        match self.own_names(contact) {
            Some(own) => format!("{} `{}`", self.kind().body, own.contact),
            None => format!("{} {}", self.kind().body, contact + 1),
        }
    }

    /// Returns the name and the unit of the column with the position of a contact, counted from 0.
    pub fn position_column(&self, contact: usize) -> (String, &'static str) {
        if let Some(ContactNames { position: (name, unit), .. }) = self.own_names(contact) {
            return (format!("end_{name}"), unit);
        }
        let suffix = self.contact_suffix(contact);
        match (self, self.kind().sliding_speed) {
            (Model::BallBalancer(_), _) => (format!("beta{suffix}_rad"), "rad"),
            (_, SlidingSpeed::MS) => (format!("position{suffix}_m"), "m"),
            (_, SlidingSpeed::RadS) => (format!("angle{suffix}_rad"), "rad"),
        }
    }

    /// Returns whether an earlier contact has the same position, and with it the same column.
    pub fn repeats_position(&self, contact: usize) -> bool {
        let own = self.position_column(contact);
        (0..contact).any(|earlier| self.position_column(earlier) == own)
    }

    /// Returns the ending of the columns with sliding speeds of a contact, and their unit.
    pub fn sliding_speed_unit(&self, contact: usize) -> (String, String) {
        let unit = match (self.own_names(contact), self.kind().sliding_speed) {
            (Some(own), _) => own.speed_unit,
            (None, SlidingSpeed::MS) => "m/s".to_owned(),
            (None, SlidingSpeed::RadS) => "rad/s".to_owned(),
        };
        (format!("{}{}", self.contact_suffix(contact), unit_ending(&unit)), unit)
    }

    /// Returns the unit of the forces of a contact.
    pub fn force_unit(&self, contact: usize) -> String {
        self.own_names(contact).map_or_else(|| "N".to_owned(), |own| own.force_unit)
    }

    /// Returns the contacts of a system of one's own that may creep, because no equation contains their positions, each with the
    /// name and the unit of the column with its mean speed.
    pub fn mean_speed_columns(&self) -> Vec<(usize, String, String)> {
        let Some(system) = self.system().filter(|_| matches!(self, Model::Own(_))) else {
            return Vec::new();
        };
        let graph = Graph::of(system.as_ref());
        let contacts = graph.layout.contacts.iter().enumerate();
        let creeping = contacts.filter(|(contact, layout)| {
            graph.may_creep(layout) && !self.repeats_position(*contact)
        });
        let named = creeping.map(|(contact, _)| match self.own_names(contact) {
            Some(ContactNames { rate: (name, unit), .. }) => {
                (contact, format!("mean_{name}"), unit.to_owned())
            }
            None => {
                let (ending, unit) = self.sliding_speed_unit(contact);
                (contact, format!("mean_speed{ending}"), unit)
            }
        });
        named.collect()
    }
}
