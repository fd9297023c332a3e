//! The parameters that a study may sweep or draw: names, units, meanings and setters.

use std::fmt;

use serde::Serialize;

use crate::model::{
    Ball, FRICTION_COEFFICIENT, Field, LawParameter, Lowest, MAX_BALLS, Model, NormalForce,
    ParameterDescriptor, SlidingSpeed,
};
use crate::study::error::{Fault, describe_number};
use crate::study::file::parameters_file::BALLS;
use crate::study::plan::units::{ShownUnits, Unit, short_name};

/// The value of a parameter at a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ParameterValue {
    /// A number in the parameter's unit.
    Number(f64),
    /// A word, such as `newton`.
    Text(&'static str),
}

impl fmt::Display for ParameterValue {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ParameterValue::Number(number) => out.write_str(&describe_number(*number)),
            ParameterValue::Text(text) => out.write_str(text),
        }
    }
}

/// Whether a column holds numbers or words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterKind {
    /// Numbers in the parameter's unit.
    Number,
    /// Words.
    Text,
}

/// A parameter that differs between points or runs, as a column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct VariedParameter {
    /// Name, as in the study file and in tables.
    pub name: String,
    /// Unit, such as `kg`; `1` for dimensionless numbers, empty for words.
    pub unit: &'static str,
    /// Meaning, in a few words.
    pub meaning: String,
    /// Whether the values are numbers or words.
    pub kind: ParameterKind,
    /// The unit in which people read the values, if it is not `unit`.
    pub shown: Option<Unit>,
}

impl VariedParameter {
    /// Returns the parameter with the unit that a study chooses for it.
    pub(in crate::study) fn shown_in(self, units: &ShownUnits) -> Self {
        let chosen =
            units.of_parameter(&self.name).filter(|unit| unit.symbol != self.unit).cloned();
        VariedParameter { shown: chosen, ..self }
    }

    /// Returns the name without its unit, such as `ball_mass_1` for `ball_mass_1_kg`.
    pub fn short_name(&self) -> String {
        short_name(&self.name, self.unit)
    }

    /// Returns the name for people: that of tables, or with the chosen unit, such as `speed [rpm]`.
    pub fn shown_name(&self) -> String {
        match &self.shown {
            Some(unit) => format!("{} [{}]", self.short_name(), unit.symbol),
            None => self.name.clone(),
        }
    }

    /// Returns the unit in which people read the values; empty for dimensionless numbers and words.
    pub fn shown_unit(&self) -> &str {
        match &self.shown {
            Some(unit) => &unit.symbol,
            None if self.unit == "1" => "",
            None => self.unit,
        }
    }

    /// Returns a value as people read it.
    pub fn shown_number(&self, value: f64) -> f64 {
        self.shown.as_ref().map_or(value, |unit| unit.of(value))
    }
}

/// The largest number of members of one kind: balls, ramps and plateaus of a speed profile, and kicks.
pub(in crate::study) const MOST_MEMBERS: usize = 8;

/// Where a parameter is defined.
#[derive(Clone, Copy, Debug)]
enum Definition {
    /// In the kind of model.
    Model(&'static ParameterDescriptor),
    /// In the friction law of a model with sliding speeds in this unit.
    Law(&'static LawParameter, SlidingSpeed),
    /// The number of balls.
    Balls,
}

/// A parameter of a model, of all its balls or other members, or of one of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parameter {
    definition: Definition,
    /// The place among the parameters of the model.
    order: usize,
    /// The member, counted from one, if this is the parameter of one ball, ramp, plateau or kick.
    member: Option<usize>,
}

impl Parameter {
    /// The number of balls, which only a sweep sets for some points. [`Parameter::all`] does not contain it.
    pub const BALLS: Parameter =
        Parameter { definition: Definition::Balls, order: 0, member: None };

    /// Returns all parameters of a model, those of the friction law after the friction coefficient.
    pub fn all(model: &Model) -> Vec<Parameter> {
        let kind = model.kind();
        let of_law = || {
            let law = model.friction().law().parameters().iter();
            law.map(|parameter| Definition::Law(parameter, kind.sliding_speed))
        };
        let with_law = |parameter: &'static ParameterDescriptor| {
            let law = (parameter.name == FRICTION_COEFFICIENT).then(of_law).into_iter().flatten();
            std::iter::once(Definition::Model(parameter)).chain(law)
        };
        // A whole number is the same for all runs.
        let numbers = kind.parameters.iter().filter(|entry| entry.largest_count().is_none());
        let has = |parameter: &Parameter| !parameter.fields(&mut model.clone()).is_empty();
        let definitions = numbers.flat_map(with_law).enumerate();
        let parameters = definitions.flat_map(|(order, definition)| {
            let general = Parameter { definition, order, member: None };
            let members = if general.is_of_members() { MOST_MEMBERS } else { 0 };
            let each = (1..=members).map(|member| general.of_one_member(member));
            // The last ramp has no speed at its end: that is the speed of the machine.
            let each: Vec<Parameter> = each.filter(has).collect();
            let exists = !general.has_own_key() || has(&general);
            exists.then_some(general).into_iter().chain(each)
        });
        parameters.collect()
    }

    /// Returns the parameter of this name, if the model has one.
    pub fn find(name: &str, model: &Model) -> Option<Parameter> {
        Parameter::all(model).into_iter().find(|parameter| parameter.name() == name)
    }

    /// Returns the descriptor of a parameter that the kind of model defines.
    fn descriptor(self) -> Option<&'static ParameterDescriptor> {
        match self.definition {
            Definition::Model(parameter) => Some(parameter),
            Definition::Law(..) | Definition::Balls => None,
        }
    }

    /// Returns the name, the unit and the meaning without the number of a ball.
    fn words(self) -> [&'static str; 3] {
        match self.definition {
            Definition::Model(parameter) => [parameter.name, parameter.unit, parameter.meaning],
            Definition::Law(law, speed) => [law.name(speed), law.unit(speed), law.meaning],
            Definition::Balls => [BALLS, "1", "number of balls"],
        }
    }

    /// Returns the name without the number of a ball.
    pub(in crate::study) fn general_name(self) -> &'static str {
        self.words()[0]
    }

    /// Returns the name, as in the study file.
    pub fn name(self) -> String {
        match (self.descriptor(), self.member) {
            (Some(parameter), Some(member)) => parameter.name_of_member(member),
            _ => self.general_name().to_owned(),
        }
    }

    /// Returns the unit: `1` for dimensionless numbers, empty for words.
    pub fn unit(self) -> &'static str {
        self.words()[1]
    }

    /// Returns the meaning.
    pub fn meaning(self) -> String {
        let meaning = self.words()[2];
        match (self.descriptor().and_then(ParameterDescriptor::member), self.member) {
            (Some(word), Some(number)) => format!("{meaning} of {word} {number}"),
            (Some(word), None) => format!("{meaning} of every {word}"),
            (None, _) => meaning.to_owned(),
        }
    }

    /// Returns whether the values are numbers.
    pub fn is_number(self) -> bool {
        self.descriptor().is_none_or(ParameterDescriptor::is_number)
    }

    /// Returns whether the parameter determines another one, so that a model may have no value of it.
    pub fn determines_another(self) -> bool {
        self.descriptor().is_some_and(|parameter| parameter.determines().is_some())
    }

    /// Returns whether a model has a value of the parameter.
    pub fn is_given(self, model: &Model) -> bool {
        self.descriptor().is_none_or(|parameter| parameter.is_given(&mut model.clone()))
    }

    /// Returns whether the friction law has the parameter.
    pub fn is_of_law(self) -> bool {
        matches!(self.definition, Definition::Law(..))
    }

    /// Returns whether each ball may have its own value.
    pub fn is_of_balls(self) -> bool {
        self.descriptor().is_some_and(ParameterDescriptor::is_of_each_ball)
    }

    /// Returns the number of the ball, from 1, if this is the parameter of one ball.
    pub fn ball(self) -> Option<usize> {
        self.member.filter(|_| self.is_of_balls())
    }

    fn is_of_members(self) -> bool {
        self.descriptor().is_some_and(|parameter| parameter.member().is_some())
    }

    /// Returns whether the parameter is one of the speed profile or of a kick.
    pub fn is_of_stages(self) -> bool {
        use Field::{Hold, Kick, Profile, Ramp};
        let of_stages = |field| matches!(field, Profile(_) | Ramp(_) | Hold | Kick(_));
        self.descriptor().is_some_and(|parameter| of_stages(parameter.field))
    }

    /// Returns whether the value stands under a key of its own in a study file.
    pub fn has_own_key(self) -> bool {
        self.descriptor().is_some_and(ParameterDescriptor::has_own_key)
    }

    /// Returns whether the parameter applies to all balls, or to all other members, together.
    pub fn is_general(self) -> bool {
        self.is_of_members() && self.member.is_none()
    }

    /// Returns the parameter of all members together, if this is the parameter of one.
    pub fn general(self) -> Option<Parameter> {
        self.member.map(|_| Parameter { member: None, ..self })
    }

    /// Returns the corresponding parameter of one ball or other member.
    pub fn of_one_member(self, member: usize) -> Parameter {
        Parameter { member: Some(member), ..self }
    }

    /// Returns whether the model's friction law does not use the parameter.
    pub fn is_unused(self, model: &Model) -> bool {
        self.general_name() == FRICTION_COEFFICIENT
            && !model.friction().law().uses_friction_coefficient()
    }

    /// Returns the column of the parameter in a table.
    pub fn column(self) -> VariedParameter {
        let kind = if self.is_number() { ParameterKind::Number } else { ParameterKind::Text };
        VariedParameter {
            name: self.name(),
            unit: self.unit(),
            meaning: self.meaning(),
            kind,
            shown: None,
        }
    }

    /// Sets the value in a model; a value of the wrong kind changes nothing. A number of balls removes the last balls.
    pub fn set(self, model: &mut Model, value: ParameterValue) {
        match value {
            ParameterValue::Number(number) if self == Parameter::BALLS => {
                if let Some(machine) = model.ball_balancer_mut() {
                    machine.balls.truncate(number as usize);
                }
            }
            ParameterValue::Number(number) => {
                self.fields(model).into_iter().for_each(|field| *field = number);
                if let Some(machine) = model.ball_balancer_mut() {
                    machine.derive();
                }
            }
            ParameterValue::Text(text) => {
                let force = NormalForce::named(text);
                if let (false, Some(force), Some(machine)) =
                    (self.is_number(), force, model.ball_balancer_mut())
                {
                    machine.normal_force = force;
                }
            }
        }
    }

    /// Returns the numbers of a model that the parameter sets: several for a parameter of all
    /// balls, none if the model does not have the parameter.
    fn fields(self, model: &mut Model) -> Vec<&mut f64> {
        match self.definition {
            Definition::Model(parameter) => parameter.numbers(model, self.member),
            Definition::Law(law, _) => {
                model.friction_mut().value_mut(law.name).into_iter().collect()
            }
            Definition::Balls => Vec::new(),
        }
    }

    /// Sets the default of the balls if this parameter applies to all balls together.
    pub fn set_general(self, general: &mut Ball, number: f64) {
        if let Some(field) = self.of_all_balls(general) {
            *field = number;
        }
        general.derive();
    }

    /// Returns the value in a model; `general` contains the default values of the balls.
    pub fn get(self, model: &Model, general: &Ball) -> ParameterValue {
        if let Some(number) = self.of_all_balls(&mut general.clone()) {
            return ParameterValue::Number(*number);
        }
        if self == Parameter::BALLS {
            return ParameterValue::Number(model.balls() as f64);
        }
        // A parameter of all balls has returned its general value above.
        if let Some(number) = self.fields(&mut model.clone()).first() {
            return ParameterValue::Number(**number);
        }
        let machine = model.ball_balancer();
        ParameterValue::Text(machine.map_or("", |machine| machine.normal_force.name()))
    }

    /// Returns the number of a ball that a parameter of all balls sets.
    fn of_all_balls(self, ball: &mut Ball) -> Option<&mut f64> {
        match self.definition {
            _ if self.member.is_some() => None,
            Definition::Model(ParameterDescriptor { field: Field::Ball(field), .. }) => {
                Some(field(ball))
            }
            Definition::Model(ParameterDescriptor {
                field: Field::OfBall { number, following, .. },
                ..
            }) => {
                let value = following(ball);
                Some(number(ball).get_or_insert(value))
            }
            _ => None,
        }
    }

    /// Checks whether the value alone is possible in a model of this form. [`Model::validate`]
    /// checks values against each other.
    ///
    /// # Errors
    /// Returns a fault if the value is impossible.
    pub fn check(self, number: f64, form: &Model) -> Result<(), Fault> {
        if self == Parameter::BALLS {
            return check_number_of_balls(number);
        }
        let mut model = form.clone();
        self.set(&mut model, ParameterValue::Number(number));
        if let Definition::Law(LawParameter { lowest: Lowest::FrictionCoefficient, .. }, _) =
            self.definition
        {
            // Its lower bound is another parameter; a single value is only bounded by zero.
            if let Some(kinetic) = Parameter::find(FRICTION_COEFFICIENT, &model) {
                kinetic.set(&mut model, ParameterValue::Number(0.0));
            }
        }
        match model.validate_values() {
            Err(invalid) if invalid.name == self.validated_name() => {
                Err(Fault::new("no physical meaning", describe_number(number), invalid.allowed))
            }
            _ => Ok(()),
        }
    }

    /// Returns the name that the validation reports.
    fn validated_name(self) -> String {
        if self.is_general() { self.of_one_member(1).name() } else { self.name() }
    }
}

/// Checks a number of balls.
pub(in crate::study) fn check_number_of_balls(number: f64) -> Result<(), Fault> {
    if number.fract() == 0.0 && (1.0..=MAX_BALLS as f64).contains(&number) {
        return Ok(());
    }
    let allowed = format!("a whole number from 1 to {MAX_BALLS}");
    Err(Fault::new("not a number of balls", describe_number(number), allowed))
}

impl Parameter {
    /// Returns a key that orders parameters as in the documentation, and those of single balls after that of all balls.
    pub fn key(&self) -> (usize, &'static str, Option<usize>) {
        (self.order, self.general_name(), self.member)
    }
}

impl PartialEq for Parameter {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for Parameter {}
