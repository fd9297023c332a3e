//! Resolution of friction laws, and the reverse.

use indexmap::IndexMap;

use crate::model::{FrictionLaw, Model, SlidingSpeed};
use crate::study::error::{Fault, StudyError};
use crate::study::file::friction_file::FrictionFile;
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
