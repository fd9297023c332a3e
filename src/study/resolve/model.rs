//! Resolution of the model, with all defaults.

use crate::model::{Ball, MAX_BALLS, Machine, Model, ModelKind, ParameterDescriptor};
use crate::study::error::{Fault, StudyError, describe_number, shorten};
use crate::study::file::key_units::list_keys;
use crate::study::file::model_parts::{BallFile, Balls};
use crate::study::file::parameters_file::{BALLS, KindFile, ParametersFile, parameter_keys};
use crate::study::file::source::{Source, SourcePath};
use crate::study::file::study_file::ModelFile;
use crate::study::file::unit_keys::{Keys, Names};
use crate::study::file::yaml_tree::Content;
use crate::study::kinds::model_kind;
use crate::study::plan::base::Base;
use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::resolve::contact_laws::{
    check_contact, check_friction, contact_to_file, friction_to_file, resolve_contact,
    resolve_friction,
};
use crate::study::resolve::stages::{
    check_stages, kicks_to_file, profile_to_file, resolve_kicks, resolve_profile, stages_of,
};

impl Base {
    /// Validates the parameters and fills in the defaults.
    ///
    /// # Errors
    /// Returns an error for the first parameter that the model does not have or that is physically
    /// impossible.
    pub fn resolve(source: &Source, written: &ModelFile) -> Result<Base, StudyError> {
        let path = source.path("model.parameters");
        let given = written.parameters.clone().unwrap_or_default();
        let kind = written.kind.0;
        // One ball represents all balls until all values are known.
        let mut model = kind.default_model();
        *model.friction_mut() =
            resolve_friction(source, written.friction.as_ref(), kind.sliding_speed)?;
        for (name, value) in &given.numbers {
            if let Some(count) = find_count(kind, name) {
                set_count(&path, count, &mut model, *value)?;
                continue;
            }
            let Some(parameter) = Parameter::find(name, &model) else {
                let problem = format!("not a parameter of {}", model.kind().name);
                let fault = Fault::new(problem, name.as_str(), parameter_names(kind).join(", "));
                return Err(path.key(name).refuse_key(fault));
            };
            parameter.check(*value, &model).map_err(|fault| path.key(name).refuse_value(fault))?;
            parameter.set(&mut model, ParameterValue::Number(*value));
        }
        let (mut general, mut balls, mut random_kicks) = (Ball::default(), Vec::new(), Vec::new());
        if let Some(machine) = model.ball_balancer_mut() {
            machine.normal_force = written.normal_force.unwrap_or(machine.normal_force);
            machine.contact = resolve_contact(source, written.contact.as_ref())?;
            general = machine.balls.first().copied().unwrap_or_default();
            balls = own_values(&path.key("balls"), given.balls.as_ref())?;
            machine.balls = balls.iter().map(|ball| overlay(general, ball)).collect();
        }
        let speed = model.speed_parameter();
        let last_speed = speed.and_then(|speed| speed.numbers(&mut model, None).pop().copied());
        let (parts, disturbances) = stages_of(source, written, last_speed.unwrap_or(1.0))?;
        if let (Some(parts), Some(speed), Some(last)) = (&parts, speed, last_speed) {
            let last = (last, given.numbers.contains_key(speed.name));
            let path = source.path("model.speed_profile");
            let (profile, last) = resolve_profile(&path, parts, last)?;
            *model.speed_profile_mut() = Some(profile);
            speed.numbers(&mut model, None).into_iter().for_each(|speed| *speed = last);
        }
        if let Some(machine) = model.ball_balancer_mut() {
            let path = source.path("model.disturbances");
            let kicks = resolve_kicks(&path, disturbances.as_deref().unwrap_or_default())?;
            let random = (1..).zip(&kicks).filter(|(_, (_, is_random))| *is_random);
            random_kicks = random.map(|(number, _)| number).collect();
            machine.kicks = kicks.into_iter().map(|(kick, _)| kick).collect();
        } else {
            let turns = speed.is_some();
            let hits = disturbances.is_some() && written.protocol.is_some();
            let foreign = [
                (path.key("balls"), given.balls.is_some()),
                (source.path("model.normal_force"), written.normal_force.is_some()),
                (source.path("model.contact"), written.contact.is_some()),
                (source.path("model.disturbances"), written.disturbances.is_some()),
                (source.path("model.protocol"), hits),
            ];
            let of_turning = [
                (source.path("model.speed_profile"), written.speed_profile.is_some()),
                (source.path("model.protocol"), written.protocol.is_some()),
            ];
            if let Some((path, _)) = of_turning.into_iter().find(|(_, given)| *given && !turns) {
                let allowed =
                    "a model with a part that turns (`turning` in its system file), or no such key";
                let found = format!("kind: {}", model.kind().name);
                return Err(path.refuse_key(Fault::new(
                    "no part of this model turns",
                    found,
                    allowed,
                )));
            }
            if let Some((path, _)) = foreign.into_iter().find(|(_, given)| *given) {
                let allowed = "kind: ball_balancer, or no such key";
                let found = format!("kind: {}", model.kind().name);
                return Err(path.wrong_key("only for a ball balancer", found, allowed));
            }
        }
        check_stages(source, &model)?;
        check_friction(source, &model)?;
        check_contact(source, &model)?;
        let fewest_balls = balls.len();
        Ok(Base { model, general, each_ball: balls, fewest_balls, random_kicks })
    }

    /// Returns the model in the form of a study file, with all values except those that others determine.
    pub fn to_file(&self, determined: &[&str]) -> ModelFile {
        let kind = self.model.kind();
        let mut parameters = ParametersFile::default();
        let numbers =
            kind.parameters.iter().filter(|entry| entry.is_number() && !entry.has_own_key());
        for parameter in numbers {
            let found = Parameter::find(parameter.name, &self.model);
            let value = found.map(|found| found.get(&self.model, &self.general));
            let is_given = parameter.is_given(&mut self.model.clone());
            if determined.contains(&parameter.name) || !is_given {
                continue;
            }
            if let Some(ParameterValue::Number(number)) = value {
                parameters.numbers.insert(parameter.name.to_owned(), number);
            }
        }
        let counts = self.counts().map(|(name, number)| (name.to_owned(), number));
        parameters.numbers.extend(counts);
        let machine = self.model.ball_balancer();
        parameters.balls = machine.map(|_| match self.has_own() {
            true => Balls::Each(self.each_ball.clone()),
            false => Balls::Number(self.each_ball.len() as u64),
        });
        ModelFile {
            kind: KindFile(kind),
            system: kind.source().cloned(),
            parameters: Some(parameters),
            friction: (kind.has_law_of_study())
                .then(|| friction_to_file(self.model.friction(), kind.sliding_speed)),
            normal_force: machine.map(|machine| machine.normal_force),
            contact: machine.map(|machine| contact_to_file(machine.contact)),
            speed_profile: self.model.speed_profile().map(profile_to_file),
            disturbances: machine
                .map(|machine| kicks_to_file(&machine.kicks, &self.random_kicks))
                .filter(|kicks| !kicks.is_empty()),
            protocol: None,
        }
    }
}

/// Returns the whole number of a kind of model with this name.
pub(crate) fn find_count(kind: &ModelKind, name: &str) -> Option<&'static ParameterDescriptor> {
    kind.parameters.iter().find(|entry| entry.name == name && entry.largest_count().is_some())
}

fn set_count(
    path: &SourcePath<'_>,
    count: &ParameterDescriptor,
    model: &mut Model,
    value: f64,
) -> Result<(), StudyError> {
    let [least, most] = count.counts().unwrap_or([1, 1]);
    if value.fract() != 0.0 || !(least as f64..=most as f64).contains(&value) {
        let allowed = format!("a whole number from {least} to {most}");
        let fault = Fault::new("not a possible number", describe_number(value), allowed);
        return Err(path.key(count.name).refuse_value(fault));
    }
    count.numbers(model, None).into_iter().for_each(|number| *number = value);
    Ok(())
}

/// Returns the names of the parameters that a study file may give for this kind of model.
fn parameter_names(kind: &ModelKind) -> Vec<&'static str> {
    let numbers = kind.parameters.iter().filter(|entry| entry.is_number() && !entry.has_own_key());
    let mut names: Vec<&str> = numbers.map(|parameter| parameter.name).collect();
    let has_balls = kind.parameters.iter().any(ParameterDescriptor::is_of_each_ball);
    names.extend(has_balls.then_some(BALLS));
    names
}

/// Checks the names of the parameters before the file is decoded, because the message lists only the parameters of this
/// kind of model, and that each has one value.
pub(in crate::study) fn check_parameters(source: &Source, names: &Names) -> Result<(), StudyError> {
    let below = |name| source.root.get("model")?.get(name);
    let (Some(kind), Some(Content::Map(given))) =
        (below("kind"), below("parameters").map(|node| &node.content))
    else {
        return Ok(());
    };
    let Some(kind) = model_kind(kind.name()) else { return Ok(()) };
    let path = source.path("model.parameters");
    for (key, value) in given {
        let name = names.find(Keys::Parameters, key.name()).0;
        let elsewhere =
            kind.parameters.iter().find(|entry| entry.name == name && entry.has_own_key());
        if let Some(section) = elsewhere.and_then(ParameterDescriptor::own_key) {
            let allowed = format!(
                "the key `model.{section}`; only a sweep, a distribution or a design has `{name}`"
            );
            return Err(path.key(name).wrong_key("not a key of `parameters`", name, allowed));
        }
        let is_known = match kind.source() {
            Some(_) => kind.parameters.iter().any(|entry| entry.name == name),
            None => parameter_keys().contains(&name),
        };
        if !is_known {
            let allowed = list_keys(name, &parameter_names(kind));
            return Err(path.key(name).wrong_key("unknown key", shorten(name), allowed));
        }
        if name != BALLS && matches!(value.content, Content::List(_)) {
            let is_suspension = ["stiffness_n_m", "damping_n_s_m"].contains(&name);
            let isotropic = match is_suspension && kind.offers.vibration {
                true => ": the suspension is isotropic, with the same value in all directions",
                false => "; a sweep contains several values",
            };
            let fault = Fault::new("a list", value.describe(), format!("a number{isotropic}"));
            return Err(path.key(name).refuse_value(fault));
        }
    }
    Ok(())
}

fn own_values(path: &SourcePath<'_>, balls: Option<&Balls>) -> Result<Vec<BallFile>, StudyError> {
    let number = match balls {
        None => Machine::default().balls.len() as u64,
        Some(Balls::Number(number)) => *number,
        Some(Balls::Each(each)) => each.len() as u64,
    };
    if !(1..=MAX_BALLS as u64).contains(&number) {
        let allowed = format!("between 1 and {MAX_BALLS} balls");
        return Err(path.wrong_value("wrong number of balls", number.to_string(), allowed));
    }
    let Some(Balls::Each(each)) = balls else {
        return Ok((0..number).map(|_| BallFile::default()).collect());
    };
    for (index, ball) in each.iter().enumerate() {
        for (key, general, value) in ball.values() {
            let form = Model::from(Machine::default());
            if let (Some(parameter), Some(value)) = (Parameter::find(general, &form), value) {
                parameter
                    .check(value, &form)
                    .map_err(|fault| path.item(index).key(key).refuse_value(fault))?;
            }
        }
    }
    Ok(each.clone())
}

fn overlay(general: Ball, given: &BallFile) -> Ball {
    let mut ball = Ball {
        mass_kg: given.mass_kg.unwrap_or(general.mass_kg),
        diameter_m: given.diameter_m.unwrap_or(general.diameter_m),
        friction_coefficient: given.friction_coefficient.unwrap_or(general.friction_coefficient),
        density_kg_m3: general.density_kg_m3,
    };
    ball.derive();
    ball
}
