//! What the contacts of a model are called in tables, texts and figures.

use super::parameter_name::unit_ending;
use super::{ContactNames, Model, OutputName};

impl Model {
    /// Returns what results call a contact, counted from 0; a ball has its number.
    fn contact_names(&self, contact: usize) -> ContactNames {
        let names = match self {
            Model::Own(model) => model.own_kind.contact_names(model).into_iter().nth(contact),
            Model::BallBalancer(_) => None,
        };
        names.unwrap_or_else(|| ContactNames {
            contact: (contact + 1).to_string(),
            position: (format!("beta_{}_rad", contact + 1), "rad"),
            speed_unit: "rad/s".to_owned(),
            force_unit: "N".to_owned(),
        })
    }

    /// Returns the names of the outputs; none for a model that shows its contacts alone.
    pub fn output_names(&self) -> Vec<OutputName> {
        match self {
            Model::Own(model) => model.own_kind.output_names(model),
            Model::BallBalancer(_) => Vec::new(),
        }
    }

    /// Returns the ending that tells the contacts apart in the names of columns: `_1` for the first ball, counted from 0
    /// here, or `_NAME` for a contact with a name.
    pub fn contact_suffix(&self, contact: usize) -> String {
        format!("_{}", self.contact_names(contact).contact)
    }

    /// Returns what a contact is called in a sentence.
    pub fn contact_in_words(&self, contact: usize) -> String {
        let name = self.contact_names(contact).contact;
        match self {
            Model::Own(_) => format!("{} `{name}`", self.kind().body),
            Model::BallBalancer(_) => format!("{} {name}", self.kind().body),
        }
    }

    /// Returns the contacts, counted from 0, whose positions are the angles of like bodies, such as the balls of a balancer;
    /// none if a contact of another body has an angle.
    pub fn angle_contacts(&self) -> Vec<usize> {
        let Model::Own(_) = self else { return (0..self.balls()).collect() };
        let positions: Vec<_> =
            (0..self.contacts()).map(|contact| self.contact_names(contact).position).collect();
        let is_first = |contact: &usize| !positions[..*contact].contains(&positions[*contact]);
        let angles = (0..positions.len()).filter(|contact| positions[*contact].1 == "rad");
        let angles: Vec<usize> = angles.filter(is_first).collect();
        let body =
            |contact: &usize| positions[*contact].0.replace(|c: char| c.is_ascii_digit(), "");
        let are_alike = angles.windows(2).all(|two| body(&two[0]) == body(&two[1]));
        if are_alike { angles } else { Vec::new() }
    }

    /// Returns the name and the unit of the column with the position of a contact, counted from 0.
    pub fn position_column(&self, contact: usize) -> (String, &'static str) {
        let (name, unit) = self.contact_names(contact).position;
        match self {
            Model::Own(_) => (format!("end_{name}"), unit),
            Model::BallBalancer(_) => (name, unit),
        }
    }

    /// Returns the ending of the columns with sliding speeds of a contact, and their unit.
    pub fn sliding_speed_unit(&self, contact: usize) -> (String, String) {
        let unit = self.contact_names(contact).speed_unit;
        (format!("{}{}", self.contact_suffix(contact), unit_ending(&unit)), unit)
    }

    /// Returns the unit of the forces of a contact.
    pub fn force_unit(&self, contact: usize) -> String {
        self.contact_names(contact).force_unit
    }
}
