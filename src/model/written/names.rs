//! The names in the formulas of a system.

use super::definition::SystemDefinition;
use super::evaluate::Bodies;
use super::formula::{Dimension, Formula, FormulaFault, NONE, Name, Valued, WHOLE};

/// The names of a system with certain numbers of bodies.
#[derive(Clone, Debug)]
pub(super) struct SystemNames {
    parameters: Vec<(String, Dimension)>,
    coordinates: Vec<(String, Option<i64>, Dimension)>,
    /// The angle of the part that turns.
    turning: Option<String>,
    /// The motions that tables give.
    motions: Vec<(String, Dimension)>,
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

impl SystemNames {
    pub fn of(definition: &SystemDefinition, bodies: &Bodies) -> SystemNames {
        let parameters = definition.parameters.iter();
        let coordinates = definition.coordinates.iter().map(|coordinate| {
            let count = coordinate.index.as_ref().and_then(|index| bodies.of(index));
            (coordinate.name.clone(), count, coordinate.unit.dimension)
        });
        SystemNames {
            parameters: parameters
                .map(|parameter| (parameter.name.clone(), parameter.unit.dimension))
                .collect(),
            coordinates: coordinates.collect(),
            turning: definition.turning.as_ref().map(|turning| turning.angle.clone()),
            motions: definition
                .motions
                .iter()
                .map(|motion| (motion.name.clone(), motion.unit.dimension))
                .collect(),
        }
    }

    /// Returns what a name means, and its dimension.
    pub fn find(&self, at: usize, name: &Name, body: Option<i64>) -> Valued<(Meaning, Dimension)> {
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
        let turns = self.turning.as_deref() == Some(text);
        let given = self.motions.iter().find(|known| known.0 == text);
        let angle = turns.then_some((None, NONE));
        let angle = angle.or(given.map(|known| (None, known.1)));
        let coordinate = self.coordinates.iter().find(|known| known.0 == text);
        if let Some((count, dimension)) = coordinate.map(|known| (known.1, known.2)).or(angle) {
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
                let parameter = self.parameters.iter().find(|known| known.0 == text);
                parameter.map(|known| (Meaning::Constant, known.1))
            }
        };
        match constant {
            Some(_) if name.primes > 0 || body.is_some() => {
                let allowed = format!("{text}; only a coordinate has rates and bodies");
                Err(FormulaFault::new(at, "not a coordinate", shown, allowed))
            }
            Some(constant) => Ok(constant),
            None => {
                let coordinates = self.coordinates.iter().map(|known| known.0.clone());
                let parameters = self.parameters.iter().map(|known| known.0.clone());
                let motions = self.motions.iter().map(|known| known.0.clone());
                let names =
                    coordinates.chain(parameters).chain(self.turning.clone()).chain(motions);
                let names = names.chain(["t", "pi"].map(str::to_owned));
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
        super::formula::TermContent::Name(Name { name, primes: 0, body }) => {
            let body = body.as_ref().map(|body| bodies.index(body)).transpose()?;
            Ok((name.clone(), body))
        }
        _ => {
            let allowed = "a coordinate, such as x or x[block]";
            Err(FormulaFault::new(0, "not a coordinate", place.text.as_str(), allowed))
        }
    }
}
