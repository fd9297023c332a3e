//! The pictures of a system for an animation: its formulas as expressions of JavaScript.

use super::definition::{WrittenShape, WrittenUnit, WrittenView};
use super::evaluate::FormulaValues;
use super::formula::{Dimension, FormulaFault, FormulaFunction, Name, Valued};
use super::instance::{Instance, Member, with_index};
use super::names::place_of;
use crate::model::{Drawing, DrawnFrame, DrawnQuantity, DrawnShape, DrawnView};

/// The largest number of coordinates and motions that the page shows over time.
const MOST_PLOTS: usize = 4;

/// The values of names as texts.
struct ScriptValues<'a> {
    instance: &'a Instance<'a>,
    /// The values of the parameters, in SI units.
    parameters: &'a [f64],
}

impl Instance<'_> {
    /// Returns the pictures with these values of the parameters, in SI units; `None` for a system without pictures.
    pub fn drawing(&self, parameters: &[f64]) -> Valued<Option<Drawing>> {
        if self.definition.draw.is_empty() {
            return Ok(None);
        }
        let views = self.definition.draw.iter();
        let views = views.map(|view| {
            let shapes = view.shapes.iter().map(|shape| self.drawn_shapes(shape, parameters));
            let shapes = shapes.collect::<Valued<Vec<_>>>()?;
            let WrittenView { name, turns, .. } = view;
            let frame = if *turns { DrawnFrame::Fixed } else { DrawnFrame::Only };
            Ok(DrawnView { name: name.clone(), frame, shapes: shapes.concat() })
        });
        let quantity = |(number, member): (usize, &Member)| {
            let coordinate = &self.definition.coordinates[member.of];
            DrawnQuantity {
                name: in_words(&coordinate.name, member.body),
                angular: coordinate.periodic,
                enlarged: coordinate.enlarged,
                contact: self
                    .positions
                    .iter()
                    .position(|position| *position == number && coordinate.periodic),
            }
        };
        let definition = self.definition;
        let plot = |(number, (name, unit)): (usize, (String, &WrittenUnit))| {
            let unit = format!(" [{}]", unit.si);
            let unit = if definition.has_units() { unit } else { String::new() };
            [name + &unit, format!("q[{number}]")]
        };
        let named = self.coordinates.iter().map(|member| {
            let coordinate = &definition.coordinates[member.of];
            (in_words(&coordinate.name, member.body), &coordinate.unit)
        });
        let moving = definition.motions.iter();
        let moving = moving.map(|motion| (in_words(&motion.name, None), &motion.unit));
        let plots = named.chain(moving).enumerate();
        let motions = self.definition.motions.iter().map(|motion| DrawnQuantity {
            name: in_words(&motion.name, None),
            angular: false,
            enlarged: false,
            contact: None,
        });
        let quantities = self.coordinates.iter().enumerate().map(quantity);
        Ok(Some(Drawing {
            plots: plots.take(MOST_PLOTS).map(plot).collect(),
            quantities: quantities.chain(motions).collect(),
            views: views.collect::<Valued<Vec<_>>>()?,
            note: String::new(),
        }))
    }

    /// Returns a shape of each body.
    fn drawn_shapes(&self, shape: &WrittenShape, parameters: &[f64]) -> Valued<Vec<DrawnShape>> {
        let bodies = shape.index.as_ref().and_then(|index| self.bodies.of(index));
        let of_body = |body: Option<i64>| {
            let bodies = self.bound(shape.index.as_deref(), body);
            let mut values = ScriptValues { instance: self, parameters };
            let texts = shape.values.iter();
            let texts = texts.map(|formula| bodies.clone().evaluate(formula, &mut values));
            Ok(DrawnShape {
                name: in_words(&shape.name, body),
                form: shape.form,
                values: texts.collect::<Valued<Vec<_>>>()?,
                contact: self.contact_of(shape, body)?,
            })
        };
        match bodies {
            Some(count) => (1..=count).map(|body| of_body(Some(body))).collect(),
            None => Ok(vec![of_body(None)?]),
        }
    }

    /// Returns the contact whose phase a shape of a body shows.
    pub fn contact_of(&self, shape: &WrittenShape, body: Option<i64>) -> Valued<Option<usize>> {
        let Some(place) = &shape.contact else { return Ok(None) };
        let (name, of) = place_of(&place.0, &self.bound(shape.index.as_deref(), body))?;
        let is_it =
            |member: &Member| self.definition.contacts[member.of].name == name && member.body == of;
        let found = self.contacts.iter().position(is_it);
        let known = || self.definition.contacts.iter();
        let named = || known().map(|contact| with_index(&contact.name, contact.index.as_deref()));
        let unknown = || match known().zip(named()).find(|(contact, _)| contact.name == name) {
            Some((_, key)) => FormulaFault::new(0, "not a contact", &place.0.text, key),
            None => FormulaFault {
                names: named().collect(),
                ..FormulaFault::new(0, "not a contact", name.as_str(), "")
            },
        };
        found.ok_or_else(unknown).map(Some)
    }
}

/// Returns a name as words, with the number of its body.
fn in_words(name: &str, body: Option<i64>) -> String {
    let words = name.replace('_', " ");
    body.map_or_else(|| words.clone(), |body| format!("{words} {body}"))
}

impl FormulaValues for ScriptValues<'_> {
    type Value = String;

    fn number(&mut self, value: f64, _: Dimension, _: usize) -> String {
        format!("({value:?})")
    }

    fn named(&mut self, _: usize, name: &Name, body: Option<i64>) -> Valued<String> {
        if let Some(number) = self.instance.number_of(&name.name, body) {
            return Ok(format!("q[{number}]"));
        }
        let definition = self.instance.definition;
        let mut motions = definition.motions.iter();
        if let Some(number) = motions.position(|motion| motion.name == name.name) {
            return Ok(format!("q[{}]", self.instance.coordinates.len() + number));
        }
        let named = definition.parameters.iter().zip(self.parameters);
        let mut named = named.filter(|(parameter, _)| parameter.name == name.name);
        Ok(match (named.next(), name.name.as_str()) {
            (Some((_, value)), _) => format!("({value:?})"),
            (None, "pi") => "Math.PI".to_owned(),
            (None, "t") => "t".to_owned(),
            // A check has found all names before, so that this is the angle of the part that turns.
            (None, _) => format!("turned[{}]", name.primes),
        })
    }

    fn sum(&mut self, _: usize, terms: Vec<(bool, String)>) -> Valued<String> {
        let text = |(minus, term)| format!("{}{term}", if minus { "-" } else { "+" });
        Ok(format!("(0{})", terms.into_iter().map(text).collect::<String>()))
    }

    fn product(&mut self, _: usize, factors: Vec<(bool, String)>) -> Valued<String> {
        let text = |(over, factor)| format!("{}{factor}", if over { "/" } else { "*" });
        Ok(format!("(1{})", factors.into_iter().map(text).collect::<String>()))
    }

    fn power(&mut self, _: usize, base: String, exponent: f64) -> Valued<String> {
        Ok(format!("Math.pow({base},{exponent:?})"))
    }

    fn call(&mut self, _: usize, function: FormulaFunction, of: String) -> Valued<String> {
        Ok(format!("Math.{}({of})", function.name()))
    }
}
