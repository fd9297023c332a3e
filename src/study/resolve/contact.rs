//! Resolution of the contact between balls, and the reverse.

use crate::model::{BallContact, Model, rolling_restitution};
use crate::study::error::{Fault, StudyError};
use crate::study::file::contact_file::{ContactFile, ContactLawFile, NoContact};
use crate::study::file::source::Source;
use crate::study::file::yaml_tree::describe_number;

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
