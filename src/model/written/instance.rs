//! A system with certain numbers of bodies: its coordinates, contacts and equations, one by one.

use super::definition::{
    IndexedName, SystemDefinition, WrittenContact, WrittenCoordinate, WrittenNormal, WrittenOutput,
};
use super::dependence::Dependence;
use super::dimensions::{Dimensions, TermAnalysis, TermDimension};
use super::evaluate::Bodies;
use super::formula::{
    Dimension, Formula, FormulaFault, FormulaTerm, NONE, Name, TermContent, Valued,
};
use super::names::{SystemNames, place_of};

/// One of the coordinates or contacts of a definition, and the body that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Member {
    /// The place in the definition.
    pub of: usize,
    pub body: Option<i64>,
}

/// A system with its bodies.
#[derive(Clone, Debug)]
pub(super) struct Instance<'d> {
    pub definition: &'d SystemDefinition,
    pub bodies: Bodies,
    pub coordinates: Vec<Member>,
    pub contacts: Vec<Member>,
    pub outputs: Vec<Member>,
    /// The coordinate that results show as the position of each contact.
    pub positions: Vec<usize>,
}

/// The numbers of coordinates, with the bodies that they are meant for.
type Places<const N: usize> = Vec<([usize; N], Bodies)>;

/// The path of a key in a system file, and what is wrong there.
pub type FaultAt = (Vec<String>, FormulaFault);

impl<'d> Instance<'d> {
    /// Creates the system; `count` returns the value of a whole number among the parameters.
    pub fn new(
        definition: &'d SystemDefinition,
        count: impl Fn(&str) -> i64,
    ) -> Result<Self, FaultAt> {
        let counts = definition.parameters.iter().filter(|given| given.counts.is_some());
        let counts: Vec<_> = counts.map(|given| (given.name.clone(), count(&given.name))).collect();
        let indices = definition.repeat.iter().map(|(index, of)| (index.clone(), count(of)));
        let bodies = Bodies { indices: indices.collect(), counts, ..Bodies::default() };
        let members = |index: &Option<String>, of: usize| -> Vec<Member> {
            match index.as_ref().and_then(|index| bodies.of(index)) {
                Some(count) => (1..=count).map(|body| Member { of, body: Some(body) }).collect(),
                None => vec![Member { of, body: None }],
            }
        };
        let coordinates = definition.coordinates.iter().enumerate();
        let contacts = definition.contacts.iter().enumerate();
        let outputs = definition.outputs.iter().enumerate();
        let mut instance = Instance {
            coordinates: coordinates.flat_map(|(of, given)| members(&given.index, of)).collect(),
            contacts: contacts.flat_map(|(of, given)| members(&given.index, of)).collect(),
            outputs: outputs.flat_map(|(of, given)| members(&given.index, of)).collect(),
            positions: Vec::new(),
            definition,
            bodies,
        };
        // A contact that slides and has few coordinates chooses first, so that results show many of them.
        let mut candidates = Vec::new();
        for number in 0..instance.contacts.len() {
            let (contact, bodies) = instance.contact(number);
            let formulas = contact.sliding.iter().map(|formula| ("sliding", formula));
            let mut named = Vec::new();
            for (key, formula) in formulas.chain([contact.normal.entry()]) {
                let found = instance.analysed(formula, &mut bodies.clone());
                let fault = |fault| (instance.contact_path(number, key), fault);
                named.extend(found.map_err(fault)?.1.appearing);
            }
            let numbers = named.iter().filter_map(|(name, body)| instance.number_of(name, *body));
            let mut distinct = Vec::new();
            for coordinate in numbers {
                if !distinct.contains(&coordinate) {
                    distinct.push(coordinate);
                }
            }
            candidates.push((number, distinct));
        }
        let slides = |number: usize| instance.contact_definition(number).sliding.is_some();
        candidates.sort_by_key(|(number, numbers)| (!slides(*number), numbers.len()));
        let mut positions = vec![None; candidates.len()];
        for (number, numbers) in candidates {
            let is_new = |coordinate: &&usize| !positions.contains(&Some(**coordinate));
            positions[number] = numbers.iter().find(is_new).or(numbers.first()).copied();
        }
        instance.positions = positions.into_iter().map(|position| position.unwrap_or(0)).collect();
        Ok(instance)
    }

    fn names(&self) -> SystemNames<'_> {
        SystemNames { definition: self.definition, bodies: &self.bodies }
    }

    /// Returns the definition of a contact, with the body that it belongs to.
    pub fn contact(&self, number: usize) -> (&'d WrittenContact, Bodies) {
        let contact = self.contact_definition(number);
        (contact, self.bound(contact.index.as_deref(), self.contacts[number].body))
    }

    /// Returns the definition of a contact.
    pub fn contact_definition(&self, number: usize) -> &'d WrittenContact {
        &self.definition.contacts[self.contacts[number].of]
    }

    /// Returns whether a contact has a gap.
    pub fn has_gap(&self, number: usize) -> bool {
        matches!(self.contact_definition(number).normal, WrittenNormal::Gap(_))
    }

    /// Returns the definition of an output, with the body that it belongs to.
    pub fn output(&self, number: usize) -> (&'d WrittenOutput, Bodies) {
        let Member { of, body } = self.outputs[number];
        let output = &self.definition.outputs[of];
        (output, self.bound(output.index.as_deref(), body))
    }

    /// Returns the dimension of a formula.
    pub fn dimension(&self, formula: &Formula, mut bodies: Bodies) -> Valued<Dimension> {
        let (found, _) = self.analysed(formula, &mut bodies)?;
        Ok(match found.measured {
            TermDimension::Known(dimension) => dimension,
            TermDimension::Any(_) => NONE,
        })
    }

    /// Returns the path of a key of a contact in the file.
    pub fn contact_path(&self, number: usize, key: &str) -> Vec<String> {
        let contact = self.contact_definition(number);
        vec![
            "contacts".to_owned(),
            with_index(&contact.name, contact.index.as_deref()),
            key.to_owned(),
        ]
    }

    /// Returns the bodies with the number that an index has.
    pub fn bound(&self, index: Option<&str>, body: Option<i64>) -> Bodies {
        let mut bodies = self.bodies.clone();
        bodies.bound.extend(index.map(str::to_owned).zip(body));
        bodies
    }

    /// Returns the number of a coordinate.
    pub fn number_of(&self, name: &str, body: Option<i64>) -> Option<usize> {
        let is_it = |member: &Member| {
            self.definition.coordinates[member.of].name == name && member.body == body
        };
        self.coordinates.iter().position(is_it)
    }

    /// Returns the definition of a coordinate.
    pub fn coordinate(&self, number: usize) -> &'d WrittenCoordinate {
        &self.definition.coordinates[self.coordinates[number].of]
    }

    /// Returns whether a coordinate is an angle that goes round and round.
    pub fn is_periodic(&self, coordinate: usize) -> bool {
        self.coordinate(coordinate).periodic
    }

    /// Returns whether the sliding speed of a contact has the same factors of the rates of change in all states.
    pub fn has_constant_factors(&self, contact: usize) -> Valued<bool> {
        let (contact, mut bodies) = self.contact(contact);
        let Some(sliding) = &contact.sliding else { return Ok(false) };
        let (found, _) = self.analysed(sliding, &mut bodies)?;
        Ok(found.depends == Dependence { rates: 1, ..Dependence::default() })
    }

    /// Analyses a formula.
    pub fn analysed(
        &self,
        formula: &Formula,
        bodies: &mut Bodies,
    ) -> Valued<(TermAnalysis, Dimensions<'_>)> {
        let mut values = Dimensions {
            names: self.names(),
            numbers: vec![None; formula.numbers],
            checks: self.definition.has_units(),
            appearing: Vec::new(),
        };
        Ok((bodies.evaluate(formula, &mut values)?, values))
    }

    /// Returns the coordinates of places such as `x[block]` with the bodies for which all of them exist.
    pub fn places<const N: usize>(
        &self,
        places: [&IndexedName; N],
    ) -> Result<Places<N>, (usize, FormulaFault)> {
        let indices = self.definition.repeat.iter().map(|(index, _)| index.as_str());
        let index =
            indices.into_iter().find(|index| places.iter().any(|place| mentions(&place.0, index)));
        let last = index.map_or(1, |index| self.bodies.of(index).unwrap_or(0));
        let mut all = Vec::new();
        'bodies: for body in 1..=last {
            let bodies = self.bound(index, index.map(|_| body));
            let mut numbers = [0; N];
            for (which, place) in places.iter().enumerate() {
                let (name, of) = place_of(&place.0, &bodies).map_err(|fault| (which, fault))?;
                let known = self.definition.coordinates.iter().find(|given| given.name == name);
                match (self.number_of(&name, of), known) {
                    (Some(number), _) => numbers[which] = number,
                    // The last body has no coupling to a next one.
                    (None, Some(_)) if N > 1 && index.is_some() && of.is_some() => continue 'bodies,
                    _ => {
                        let meaning = Name { name, primes: 0, body: None };
                        let fault = self.names().find(0, &meaning, of).err();
                        let other = || {
                            FormulaFault::new(0, "not a coordinate", &place.0.text, "a coordinate")
                        };
                        return Err((which, fault.unwrap_or_else(other)));
                    }
                }
            }
            all.push((numbers, bodies));
        }
        if all.is_empty() && last > 0 {
            let found = places[0].0.text.as_str();
            let allowed = "bodies from 1 to their number";
            let fault = FormulaFault::new(0, "bodies that do not exist", found, allowed);
            return Err((0, fault));
        }
        Ok(all)
    }
}

/// Returns a name with its index, as the file writes it.
pub(super) fn with_index(name: &str, index: Option<&str>) -> String {
    index.map_or_else(|| name.to_owned(), |index| format!("{name}[{index}]"))
}

/// Returns whether the body of a place depends on an index.
fn mentions(place: &Formula, index: &str) -> bool {
    fn in_term(term: &FormulaTerm, index: &str) -> bool {
        match &term.content {
            TermContent::Name(name) => {
                name.name == index || name.body.as_ref().is_some_and(|body| in_term(body, index))
            }
            TermContent::Sum(parts) | TermContent::Product(parts) => {
                parts.iter().any(|(_, part)| in_term(part, index))
            }
            _ => false,
        }
    }
    match &place.root.content {
        TermContent::Name(Name { body: Some(body), .. }) => in_term(body, index),
        _ => false,
    }
}
