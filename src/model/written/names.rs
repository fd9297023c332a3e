//! The names in the formulas of a system.

use super::definition::SystemDefinition;
use super::evaluate::Bodies;
use super::formula::{Dimension, Formula, FormulaFault, NONE, Name, TermContent, Valued, WHOLE};

/// The names of a system with certain numbers of bodies.
#[derive(Clone, Copy)]
pub(super) struct SystemNames<'a> {
    pub definition: &'a SystemDefinition,
    pub bodies: &'a Bodies,
}

/// What a name means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    Constant,
    Time,
    Given,
    GivenRate,
    Position,
    Rate,
    Acceleration,
}

/// The names that no system can give away.
pub(super) const RESERVED: [&str; 12] =
    ["t", "pi", "sin", "cos", "tan", "exp", "log", "sqrt", "tanh", "atan", "sum", "if"];

impl SystemNames<'_> {
    /// Returns what a name means, and its dimension.
    pub fn find(&self, at: usize, name: &Name, body: Option<i64>) -> Valued<(Meaning, Dimension)> {
        let definition = self.definition;
        let text = name.name.as_str();
        let shown = format!("`{text}{}`", "'".repeat(name.primes));
        let of_one = |body: Option<i64>, count: Option<i64>| match (body, count) {
            (None, None) => Ok(()),
            (Some(body), Some(count)) if (1..=count).contains(&body) => Ok(()),
            (Some(body), Some(count)) => Err(FormulaFault::new(
                at,
                "a body that does not exist",
                format!("`{text}[{body}]` of {count}"),
                format!(
                    "{text}[1] to {text}[{count}]; if(condition, ..., 0) leaves out a term, as in \
                         if(block < blocks, ..., 0)"
                ),
            )),
            (None, Some(_)) => {
                let allowed = format!("the number of the body, such as {text}[1]");
                Err(FormulaFault::new(at, "one of several bodies", &shown, allowed))
            }
            (Some(_), None) => {
                let allowed = format!("{text} without a number: it is the coordinate of one body");
                Err(FormulaFault::new(at, "only one body", &shown, allowed))
            }
        };
        let turns = definition.turning.as_ref().is_some_and(|turning| turning.angle == text);
        let given = definition.motions.iter().find(|known| known.name == text);
        let angle = turns.then_some((None, NONE));
        let angle = angle.or(given.map(|known| (None, known.unit.dimension)));
        let coordinate = definition.coordinates.iter().find(|known| known.name == text);
        let coordinate = coordinate.map(|known| {
            let count = known.index.as_ref().and_then(|index| self.bodies.of(index));
            (count, known.unit.dimension)
        });
        if let Some((count, dimension)) = coordinate.or(angle) {
            of_one(body, count)?;
            let [mass, length, time] = dimension;
            let meaning = |of_coordinate| match (turns, given) {
                (true, _) => Meaning::Time,
                (false, Some(_)) if name.primes > 0 => Meaning::GivenRate,
                (false, Some(_)) => Meaning::Given,
                (false, None) => of_coordinate,
            };
            return match name.primes {
                0 => Ok((meaning(Meaning::Position), dimension)),
                1 => Ok((meaning(Meaning::Rate), [mass, length, time - WHOLE])),
                2 => Ok((meaning(Meaning::Acceleration), [mass, length, time - 2 * WHOLE])),
                _ => {
                    let allowed = "at most two primes: x'' is an acceleration";
                    Err(FormulaFault::new(at, "a third derivative", shown, allowed))
                }
            };
        }
        let constant = match text {
            "t" => Some((Meaning::Time, [0, 0, WHOLE])),
            "pi" => Some((Meaning::Constant, NONE)),
            _ => {
                let parameter = definition.parameters.iter().find(|known| known.name == text);
                parameter.map(|known| (Meaning::Constant, known.unit.dimension))
            }
        };
        match constant {
            Some(_) if name.primes > 0 || body.is_some() => {
                let allowed = format!("{text}; only a coordinate has rates and bodies");
                Err(FormulaFault::new(at, "not a coordinate", shown, allowed))
            }
            Some(constant) => Ok(constant),
            None => {
                let coordinates = definition.coordinates.iter().map(|known| &known.name);
                let parameters = definition.parameters.iter().map(|known| &known.name);
                let turning = definition.turning.iter().map(|turning| &turning.angle);
                let motions = definition.motions.iter().map(|known| &known.name);
                let names = coordinates.chain(parameters).chain(turning).chain(motions);
                let names = names.cloned().chain(["t", "pi"].map(str::to_owned));
                Err(FormulaFault {
                    names: names.collect(),
                    ..FormulaFault::new(at, "unknown name", text, "")
                })
            }
        }
    }
}

/// Returns the coordinate and the body that a place such as `x[block + 1]` names.
pub(super) fn place_of(place: &Formula, bodies: &Bodies) -> Valued<(String, Option<i64>)> {
    match &place.root.content {
        TermContent::Name(Name { name, primes: 0, body }) => {
            let body = body.as_ref().map(|body| bodies.index(body)).transpose()?;
            Ok((name.clone(), body))
        }
        _ => {
            let allowed = "a coordinate, such as x or x[block]";
            Err(FormulaFault::new(0, "not a coordinate", place.text.as_str(), allowed))
        }
    }
}
