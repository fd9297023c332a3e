//! The values of parameters in a model.

use super::{Ball, Field, Model, ParameterDescriptor, ProfilePart};

impl ParameterDescriptor {
    /// Returns whether a model has a value; only a parameter that determines another one may have none.
    pub fn is_given(&self, model: &mut Model) -> bool {
        match (self.field, model) {
            (Field::OfMachine { number, .. }, Model::BallBalancer(machine)) => {
                number(machine).is_some()
            }
            (Field::OfBall { number, .. }, Model::BallBalancer(machine)) => {
                machine.balls.iter_mut().any(|ball| number(ball).is_some())
            }
            _ => true,
        }
    }

    /// Returns the numbers of a model that the parameter sets: those of all members, such as balls, or of one, counted
    /// from 1. None for a model without this parameter.
    pub fn numbers<'a>(&self, model: &'a mut Model, member: Option<usize>) -> Vec<&'a mut f64> {
        let parts = |model: &'a mut Model| {
            let profile = model.speed_profile_mut().as_mut();
            profile.into_iter().flat_map(|profile| &mut profile.parts)
        };
        let machine = match (self.field, model) {
            (Field::Profile(field), model) => {
                return model.speed_profile_mut().as_mut().map(field).into_iter().collect();
            }
            (Field::Ramp(field), model) => {
                let ramps = parts(model).filter_map(|part| match part {
                    ProfilePart::Ramp(ramp) => Some(ramp),
                    _ => None,
                });
                return meant(ramps, member).filter_map(field).collect();
            }
            (Field::Hold, model) => {
                let holds = parts(model).filter_map(|part| match part {
                    ProfilePart::Hold(lasts_s) => Some(lasts_s),
                    _ => None,
                });
                return meant(holds, member).filter_map(Option::as_mut).collect();
            }
            (Field::Own { .. } | Field::Count { .. }, Model::Own(model)) => {
                return model.number_mut(self).into_iter().collect();
            }
            (_, Model::Own(_)) => return Vec::new(),
            (_, Model::BallBalancer(machine)) => machine,
        };
        match self.field {
            Field::Kick(field) => meant(&mut machine.kicks, member).map(field).collect(),
            Field::Machine(field) => vec![field(machine)],
            Field::OfMachine { number, following, .. } => {
                let value = following(machine);
                vec![number(machine).get_or_insert(value)]
            }
            Field::Contact(field) => machine.contact.as_mut().map(field).into_iter().collect(),
            Field::OfBall { number, following, .. } => {
                let of_ball = |ball: &'a mut Ball| {
                    let value = following(ball);
                    number(ball).get_or_insert(value)
                };
                meant(&mut machine.balls, member).map(of_ball).collect()
            }
            Field::Ball(field) => meant(&mut machine.balls, member).map(field).collect(),
            _ => Vec::new(),
        }
    }
}

/// Returns all members, or one of them, counted from 1.
fn meant<T>(all: impl IntoIterator<Item = T>, member: Option<usize>) -> impl Iterator<Item = T> {
    let numbered = (1..).zip(all);
    numbered.filter(move |(number, _)| member.is_none_or(|n| n == *number)).map(|(_, item)| item)
}
