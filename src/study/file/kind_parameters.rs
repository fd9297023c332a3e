//! The parameters and coordinates of all kinds of models, with any friction law.

use std::collections::HashSet;

use crate::model::{
    Ball, BallContact, FRICTION_LAWS, FrictionLaw, Kick, MAX_BALLS, Model, ModelKind, ProfilePart,
    Ramp, RampShape, SpeedProfile,
};
use crate::study::kinds::model_kinds;
use crate::study::plan::parameter::{MOST_MEMBERS, Parameter};
use crate::study::sampling::initial_box::{axis_names, general_axes};

/// Returns the coordinates of the box of start states of this kind of model, for any number of balls.
pub(in crate::study) fn axes_of(kind: &'static ModelKind) -> Vec<String> {
    let models = models_of(kind);
    let general = models.first().map(general_axes).unwrap_or_default().into_iter();
    let axes = models.iter().take(1).flat_map(axis_names);
    general.map(str::to_owned).chain(axes).collect()
}

/// A kick of a model that has all parameters.
const KICK: Kick = Kick { at_s: 1.0, speed_m_s: 0.0, direction_rad: 0.0 };

/// Returns a profile with as many ramps and plateaus as possible.
fn longest_profile(speed_rad_s: f64) -> SpeedProfile {
    let pair = |number: usize| {
        let to_rad_s = (number < MOST_MEMBERS).then_some(speed_rad_s);
        let ramp = Ramp { shape: RampShape::Linear, to_rad_s, over_s: 1.0 };
        [ProfilePart::Ramp(ramp), ProfilePart::Hold(Some(1.0))]
    };
    let parts = (1..=MOST_MEMBERS).flat_map(pair).collect();
    SpeedProfile { start_speed_rad_s: speed_rad_s, parts }
}

/// Returns one model of every kind and every friction law, with the largest number of balls or other bodies.
pub(super) fn all_models() -> Vec<Model> {
    model_kinds().iter().copied().flat_map(models_of).collect()
}

/// Returns one model of a kind with every friction law that a study can give it, with the largest number of balls or other
/// bodies.
fn models_of(kind: &'static ModelKind) -> Vec<Model> {
    let model = || {
        let mut model = kind.default_model();
        if let Some(machine) = model.ball_balancer_mut() {
            machine.balls = vec![Ball::default(); MAX_BALLS];
            machine.contact = Some(BallContact::default());
            machine.kicks = vec![KICK; MOST_MEMBERS];
        }
        let speed = model.speed_parameter();
        let last = speed.and_then(|speed| speed.numbers(&mut model, None).pop().copied());
        *model.speed_profile_mut() = last.map(longest_profile);
        for count in kind.parameters {
            if let Some(most) = count.largest_count() {
                count.numbers(&mut model, None).into_iter().for_each(|slot| *slot = most as f64);
            }
        }
        model
    };
    if !kind.has_law_of_study() {
        return vec![model()];
    }
    let laws = FRICTION_LAWS.map(|law| {
        let examples: Vec<f64> = law.parameters().iter().map(|entry| entry.examples[1]).collect();
        FrictionLaw::new(law, &examples)
    });
    let with = |model: &Model, law: FrictionLaw| {
        let mut model = model.clone();
        *model.friction_mut() = law;
        model
    };
    laws.map(|law| with(&model(), law)).into()
}

/// Returns the names of the parameters of this kind of model with any friction law, and those of its whole numbers.
pub(in crate::study) fn parameters_of(kind: &'static ModelKind) -> Vec<String> {
    distinct(&models_of(kind)).into_iter().map(Parameter::name).collect()
}

/// Returns the names of the parameters of all kinds, except for a force whose name without its unit is also the name of a
/// choice.
pub(in crate::study) fn parameters_of_any() -> Vec<String> {
    let names = all_parameters().into_iter().map(Parameter::name);
    names.filter(|name| name != "normal_force_n").collect()
}

/// Returns the names of the numeric parameters of this kind of model with any friction law.
pub(in crate::study) fn numeric_parameters_of(kind: &'static ModelKind) -> Vec<String> {
    let numeric = distinct(&models_of(kind)).into_iter().filter(|parameter| parameter.is_number());
    numeric.map(Parameter::name).collect()
}

/// Returns every numeric parameter of any model, without repeated names.
pub(super) fn numeric() -> Vec<Parameter> {
    all_parameters().into_iter().filter(|parameter| parameter.is_number()).collect()
}

/// Returns everything that a sweep may set.
pub(super) fn all_swept() -> Vec<Parameter> {
    all_parameters().into_iter().chain([Parameter::BALLS]).collect()
}

/// Returns every parameter of any model, without repeated names.
fn all_parameters() -> Vec<Parameter> {
    distinct(&all_models())
}

fn distinct(models: &[Model]) -> Vec<Parameter> {
    let mut names = HashSet::new();
    let all = models.iter().flat_map(Parameter::all);
    all.filter(|parameter| names.insert(parameter.name())).collect()
}
