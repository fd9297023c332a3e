//! Checks the names in a system file: no two things have one name, and no column of tables has two meanings; and its sizes.

use super::definition::{SystemDefinition, WrittenParameter};
use super::formula::FormulaFault;
use super::instance::{FaultAt, with_index};
use super::names::RESERVED;
use crate::model::FRICTION_COEFFICIENT;

/// The largest numbers of coordinates and of contacts, of parameters, and of indices.
const MOST_MEMBERS: usize = 64;
const MOST_PARAMETERS: usize = 500;
const MOST_INDICES: usize = 8;
/// The largest number of formulas in all pictures, with each body counted.
const MOST_DRAWN: usize = 4000;

/// Columns of tables without a unit, which a parameter without a unit must not have as its name.
const COLUMNS: [&str; 30] = [
    "label",
    "evidence",
    "run_id",
    "point_id",
    "cell",
    "replicate",
    "steps",
    "switches",
    "error",
    "extended",
    "friction_margin",
    "cycle_class",
    "audit_label",
    "audit_evidence",
    "neutral_directions",
    "largest_multiplier",
    "rejected_steps",
    "lyapunov_blocks",
    "runs",
    "points",
    "equilibrium_runs",
    "ci_low",
    "ci_high",
    "class",
    "fraction",
    "multipliers",
    "audited_runs",
    "balls",
    "friction",
    "contact",
];
const PREFIXES: [&str; 11] = [
    "initial_",
    "end_",
    "min_",
    "max_",
    "mean_",
    "creep_",
    "stick_fraction_",
    "equilibrium_",
    "limit_cycle_",
    "undecided_",
    "failed_",
];

/// What a name consists of, in words.
const NAME: &str = "letters, digits and _, with a letter first";

/// The names of the parameters of speed profiles begin like this.
const OF_PROFILES: [&str; 4] = ["start_speed", "ramp_to_", "ramp_over_", "hold_"];

impl SystemDefinition {
    /// Checks that the equations stay small with the largest numbers of bodies.
    pub(super) fn check_sizes(&self) -> Result<(), FaultAt> {
        let most = |index: &Option<String>| {
            let count = self.repeat.iter().find(|(known, _)| Some(known) == index.as_ref());
            let limit = |(_, count): &(String, String)| {
                let parameter = self.parameters.iter().find(|known| known.name == *count)?;
                parameter.counts.map(|[_, most]| most)
            };
            count.and_then(limit).unwrap_or(1)
        };
        let coordinates: usize = self.coordinates.iter().map(|member| most(&member.index)).sum();
        let contacts: usize = self.contacts.iter().map(|member| most(&member.index)).sum();
        let outputs: usize = self.outputs.iter().map(|member| most(&member.index)).sum();
        let shapes = self.draw.iter().flat_map(|view| &view.shapes);
        let drawn: usize = shapes.map(|shape| most(&shape.index) * shape.values.len()).sum();
        let sizes = [
            ("coordinates", coordinates, MOST_MEMBERS),
            ("contacts", contacts, MOST_MEMBERS),
            ("outputs", outputs, MOST_MEMBERS),
            ("parameters", self.parameters.len(), MOST_PARAMETERS),
            ("derived", self.derived.len(), MOST_PARAMETERS),
            ("repeat", self.repeat.len(), MOST_INDICES),
            ("motions", self.motions.len(), MOST_MEMBERS),
            ("draw", drawn, MOST_DRAWN),
        ];
        match sizes.into_iter().find(|(_, count, most)| count > most) {
            Some((key, count, most)) => {
                let things = if key == "draw" { "formulas in pictures" } else { key };
                let found = format!("{count} {things}, with the largest numbers of bodies");
                let fault =
                    FormulaFault::new(0, "too large a system", found, format!("at most {most}"));
                Err((vec![key.to_owned()], fault))
            }
            None => Ok(()),
        }
    }

    /// Returns the coordinates and the outputs, each with its key, its name and its index.
    fn quantities(&self) -> impl Iterator<Item = (&str, &str, Option<&str>)> {
        let coordinates = self.coordinates.iter();
        let coordinates =
            coordinates.map(|given| ("coordinates", &*given.name, given.index.as_deref()));
        let outputs = self.outputs.iter();
        coordinates.chain(outputs.map(|given| ("outputs", &*given.name, given.index.as_deref())))
    }

    /// Checks that no two columns of tables have one name.
    fn check_columns(&self) -> Result<(), FaultAt> {
        let fault = |key: &str, name: &str, index: Option<&str>| {
            let path = vec![key.to_owned(), with_index(name, index)];
            let problem = "a name that another column of tables has";
            Err((path, FormulaFault::new(0, problem, name, "another name")))
        };
        for given in &self.parameters {
            let begins = |prefix: &&str| given.name.starts_with(*prefix);
            let with_end = format!("{}_", given.name);
            let of_profile =
                self.turning.is_some() && OF_PROFILES.iter().any(|name| with_end.starts_with(name));
            if COLUMNS.contains(&given.name.as_str()) || PREFIXES.iter().any(begins) || of_profile {
                return fault("parameters", &given.name, None);
            }
        }
        let contacts = self.contacts.iter();
        let contacts = contacts.map(|given| ("contacts", &*given.name, given.index.as_deref()));
        for members in [self.quantities().collect::<Vec<_>>(), contacts.collect()] {
            for (key, name, index) in &members {
                // `x_2` is the second body of `x`, and `x_rate` its rate of change.
                let Some((base, end)) = name.rsplit_once('_') else { continue };
                let is_number = end.bytes().all(|byte| byte.is_ascii_digit());
                if (is_number || end == "rate")
                    && members.iter().any(|(_, other, _)| *other == base)
                {
                    return fault(key, name, *index);
                }
            }
        }
        Ok(())
    }

    pub(super) fn check_names(&self) -> Result<(), FaultAt> {
        let mut known: Vec<&str> = RESERVED.to_vec();
        let parameters = self.parameters.iter().map(|given| ("parameters", &*given.name, None));
        let indices = self.repeat.iter().map(|(index, _)| ("repeat", &**index, None));
        let derived = self.derived.iter().map(|given| ("derived", &*given.quantity.name, None));
        let turning = self.turning.iter().map(|turning| ("turning", &*turning.angle, None));
        let motions = self.motions.iter().map(|motion| ("motions", &*motion.name, None));
        let names = parameters.chain(indices).chain(self.quantities());
        let names = names.chain(derived).chain(turning).chain(motions);
        for (key, name, index) in names {
            let fault = |problem: &str, allowed: &str| {
                let path = vec![key.to_owned(), with_index(name, index)];
                (path, FormulaFault::new(0, problem, name, allowed))
            };
            if !is_name(name) {
                return Err(fault("not a name", NAME));
            }
            if RESERVED.contains(&name) {
                return Err(fault("a name with another meaning in formulas", "a name of its own"));
            }
            if known.contains(&name) {
                return Err(fault("a name that is given twice", "one name for each thing"));
            }
            known.push(name);
        }
        for view in &self.draw {
            let of_view = vec!["draw".to_owned(), view.name.clone()];
            let shapes = view.shapes.iter().map(|shape| {
                let key = with_index(&shape.name, shape.index.as_deref());
                (&shape.name, [&of_view[..], &["shapes".to_owned(), key]].concat())
            });
            for (name, path) in [(&view.name, of_view.clone())].into_iter().chain(shapes) {
                if !is_name(name) {
                    return Err((path, FormulaFault::new(0, "not a name", name, NAME)));
                }
            }
        }
        self.check_columns()?;
        let is_it = |parameter: &WrittenParameter| {
            parameter.name == FRICTION_COEFFICIENT && parameter.unit.si == "1"
        };
        if self.has_law_of_study() && !self.parameters.iter().any(is_it) {
            let problem = "the law of the study without its coefficient";
            let found = format!("no parameter `{FRICTION_COEFFICIENT}`");
            let allowed = format!("`{FRICTION_COEFFICIENT}: 0.1` among the parameters");
            let fault = FormulaFault::new(0, problem, found, allowed);
            return Err((vec!["parameters".to_owned()], fault));
        }
        let mut contacts: Vec<&str> = Vec::new();
        for contact in &self.contacts {
            let name = contact.name.as_str();
            if !is_name(name) || contacts.contains(&name) {
                let path = vec!["contacts".to_owned(), with_index(name, contact.index.as_deref())];
                let allowed = "a name of its own, of letters, digits and _";
                return Err((path, FormulaFault::new(0, "not a name of a contact", name, allowed)));
            }
            contacts.push(name);
        }
        Ok(())
    }
}

fn is_name(name: &str) -> bool {
    let is_part = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    name.starts_with(|first: char| first.is_ascii_alphabetic()) && name.chars().all(is_part)
}
