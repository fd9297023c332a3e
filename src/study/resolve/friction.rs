//! Resolution of friction laws, and the reverse.

use crate::model::{FrictionLaw, Model};
use crate::study::error::{Fault, StudyError};
use crate::study::file::source_path::SourcePath;
use crate::study::file::study_file::{
    FrictionFile, ModelFile, ModelKind, SmoothFile, StribeckFile,
};
use crate::study::file::yaml_tree::Source;

/// Returns the friction law with the speed of this kind of model.
///
/// # Errors
/// Returns an error if the speed is missing, or has the unit of another kind of model.
pub(in crate::study) fn resolve_friction(
    source: &Source,
    written: &ModelFile,
) -> Result<FrictionLaw, StudyError> {
    let path = source.path("model.friction");
    let of_balls = written.kind == ModelKind::BallBalancer;
    let speed = |path: SourcePath<'_>, stem: &str, rad_s: Option<f64>, m_s: Option<f64>| {
        let (unit, own, other_unit, other) =
            if of_balls { ("rad_s", rad_s, "m_s", m_s) } else { ("m_s", m_s, "rad_s", rad_s) };
        let allowed = format!("{stem}_{unit}");
        if other.is_some() {
            let found = format!("{stem}_{other_unit}");
            let path = path.key(&found);
            let fault = Fault::new("a speed in the unit of another kind of model", found, allowed);
            return Err(path.refuse_key(fault));
        }
        own.ok_or_else(|| {
            let fault =
                Fault::new("missing key", "no such key", format!("a value for `{allowed}`"));
            path.refuse_value(fault)
        })
    };
    Ok(match written.friction {
        None | Some(FrictionFile::Coulomb) => FrictionLaw::Coulomb,
        Some(FrictionFile::Stribeck(law)) => FrictionLaw::Stribeck {
            static_friction_coefficient: law.static_friction_coefficient,
            stribeck_speed: speed(
                path.key("stribeck"),
                "stribeck_speed",
                law.stribeck_speed_rad_s,
                law.stribeck_speed_m_s,
            )?,
        },
        Some(FrictionFile::Smooth(law)) => FrictionLaw::Smooth {
            smoothing_speed: speed(
                path.key("smooth"),
                "smoothing_speed",
                law.smoothing_speed_rad_s,
                law.smoothing_speed_m_s,
            )?,
        },
        Some(FrictionFile::Viscous { viscous_coefficient_n_s_m }) => {
            FrictionLaw::Viscous { viscous_coefficient_n_s_m }
        }
    })
}

/// Validates the friction law together with the other parameters.
///
/// # Errors
/// Returns an error if a value of the law is physically impossible.
pub(in crate::study) fn check_friction(source: &Source, model: &Model) -> Result<(), StudyError> {
    model.validate().map_err(|invalid| {
        let path = source.path("model.friction").key(model.friction().name()).key(&invalid.name);
        let fault = Fault::new("no physical meaning", invalid.found, invalid.allowed);
        path.refuse_value(fault)
    })
}

/// Returns the law in the form of a study file.
pub(in crate::study) fn friction_to_file(law: &FrictionLaw, kind: ModelKind) -> FrictionFile {
    let of_balls = kind == ModelKind::BallBalancer;
    let pair = |speed: f64| if of_balls { (Some(speed), None) } else { (None, Some(speed)) };
    match *law {
        FrictionLaw::Coulomb => FrictionFile::Coulomb,
        FrictionLaw::Stribeck { static_friction_coefficient, stribeck_speed } => {
            let (stribeck_speed_rad_s, stribeck_speed_m_s) = pair(stribeck_speed);
            FrictionFile::Stribeck(StribeckFile {
                static_friction_coefficient,
                stribeck_speed_rad_s,
                stribeck_speed_m_s,
            })
        }
        FrictionLaw::Smooth { smoothing_speed } => {
            let (smoothing_speed_rad_s, smoothing_speed_m_s) = pair(smoothing_speed);
            FrictionFile::Smooth(SmoothFile { smoothing_speed_rad_s, smoothing_speed_m_s })
        }
        FrictionLaw::Viscous { viscous_coefficient_n_s_m } => {
            FrictionFile::Viscous { viscous_coefficient_n_s_m }
        }
    }
}
