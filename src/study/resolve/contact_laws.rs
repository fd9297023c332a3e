//! Resolution of the laws of friction and of the contact between balls, and the reverse.

use indexmap::IndexMap;

use crate::model::{BallContact, FrictionLaw, Model, SlidingSpeed, rolling_restitution};
use crate::study::error::{Fault, StudyError, describe_number};
use crate::study::file::friction_file::FrictionFile;
use crate::study::file::model_parts::{ContactFile, ContactLawFile, NoContact};
use crate::study::file::source::Source;

/// Returns the friction law with sliding speeds in the unit of this kind of model.
pub(in crate::study) fn resolve_friction(
    source: &Source,
    written: Option<&FrictionFile>,
    unit: SlidingSpeed,
) -> Result<FrictionLaw, StudyError> {
    let Some(FrictionFile { law, values }) = written else { return Ok(FrictionLaw::COULOMB) };
    let path = source.path("model.friction").key(law.name());
    let mut numbers = Vec::new();
    for parameter in law.parameters() {
        let name = parameter.name(unit);
        let foreign = parameter.names().into_iter().find(|other| *other != name);
        if let Some(found) = foreign.filter(|found| values.contains_key(*found)) {
            let fault = Fault::new("a speed in the unit of another kind of model", found, name);
            return Err(path.key(found).refuse_key(fault));
        }
        let Some(value) = values.get(name) else {
            let fault = Fault::new("missing key", "no such key", format!("a value for `{name}`"));
            return Err(path.refuse_value(fault));
        };
        numbers.push(*value);
    }
    Ok(FrictionLaw::new(*law, &numbers))
}

/// Validates the friction law together with the other parameters.
pub(in crate::study) fn check_friction(source: &Source, model: &Model) -> Result<(), StudyError> {
    model.validate().map_err(|invalid| {
        let problem = "no physical meaning";
        let unit = model.kind().sliding_speed;
        let mut of_law = model.friction().law().parameters().iter();
        if !of_law.any(|parameter| parameter.name(unit) == invalid.name) {
            let found = format!("{} is {}", invalid.name, invalid.found);
            return source.path("model.parameters").wrong_value(problem, found, invalid.allowed);
        }
        let path = source.path("model.friction").key(model.friction().name()).key(&invalid.name);
        path.wrong_value(problem, invalid.found, invalid.allowed)
    })
}

/// Returns the law in the form of a study file.
pub(in crate::study) fn friction_to_file(law: &FrictionLaw, unit: SlidingSpeed) -> FrictionFile {
    let names = law.law().parameters().iter().map(|parameter| parameter.name(unit));
    let values: IndexMap<_, _> =
        names.map(str::to_owned).zip(law.values().iter().copied()).collect();
    FrictionFile { law: law.law(), values }
}

/// Returns the law of contact between balls; `None` for balls that pass through each other.
pub(in crate::study) fn resolve_contact(
    source: &Source,
    written: Option<&ContactFile>,
) -> Result<Option<BallContact>, StudyError> {
    let Some(ContactFile::Law(law)) = written else { return Ok(None) };
    let path = source.path("model.contact");
    let default = BallContact::default();
    if law.restitution.is_some() && law.material_restitution.is_some() {
        return Err(path.key("material_restitution").wrong_key(
            "the restitution is given twice",
            "material_restitution beside restitution",
            "one of both",
        ));
    }
    let rolling = law.material_restitution.map(rolling_restitution);
    Ok(Some(BallContact {
        restitution: law.restitution.or(rolling).unwrap_or(default.restitution),
        friction_coefficient: law.friction_coefficient.unwrap_or(default.friction_coefficient),
    }))
}

/// Checks that balls without dry friction on the ring have none between each other.
pub(in crate::study) fn check_contact(source: &Source, model: &Model) -> Result<(), StudyError> {
    let Some(machine) = model.ball_balancer() else { return Ok(()) };
    let friction = machine.contact.map_or(0.0, |contact| contact.friction_coefficient);
    if friction == 0.0 || machine.friction.can_stick() {
        return Ok(());
    }
    let problem =
        format!("friction between balls with {} friction on the ring", machine.friction.name());
    let found = describe_number(friction);
    let fault = Fault::new(problem, found, "0, or a friction law with stick");
    Err(source.path("model.contact").key("friction_coefficient").refuse_value(fault))
}

/// Returns the contact in the form of a study file.
pub(in crate::study) fn contact_to_file(contact: Option<BallContact>) -> ContactFile {
    contact.map_or(ContactFile::Without(NoContact::None), |contact| {
        ContactFile::Law(ContactLawFile {
            restitution: Some(contact.restitution),
            material_restitution: None,
            friction_coefficient: Some(contact.friction_coefficient),
        })
    })
}
