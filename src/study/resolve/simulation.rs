//! Resolution of the simulation settings, with all defaults.

use crate::model::Simulation;
use crate::study::error::{Fault, StudyError};
use crate::study::file::study_file::{SimulationFile, ToleranceFile};
use crate::study::file::yaml_tree::{Source, describe_number};
use crate::study::resolve::extend::{extend_to_file, resolve_extend};

/// In a wider band, moving balls count as sticking, and may switch between stick and transition
/// indefinitely.
const WIDEST_BAND: f64 = 1.0e-2;

/// Validates the simulation settings and fills in the defaults.
///
/// # Errors
/// Returns an error if a band, tolerance or end time is not positive, if the band is too wide, if the end time is not
/// that of the speed profile, which is `ends_s` if the profile has an end, or if the extension is invalid.
pub(crate) fn resolve_simulation(
    source: &Source,
    written: Option<&SimulationFile>,
    ends_s: Option<f64>,
) -> Result<Simulation, StudyError> {
    let default = Simulation::default();
    let given = written.cloned().unwrap_or_default();
    let tolerance = given.tolerance.unwrap_or_default();
    let positive = |keys: &str, given: Option<f64>, default: f64| {
        let value = given.unwrap_or(default);
        if value.is_finite() && value > 0.0 {
            return Ok(value);
        }
        let allowed = "a positive, finite number";
        Err(source.path(keys).wrong_value("not positive", describe_number(value), allowed))
    };
    let band = positive("simulation.band", given.band, default.band)?;
    if band > WIDEST_BAND {
        let allowed = format!("at most {WIDEST_BAND}; a narrower band is more accurate");
        let fault = Fault::new("too wide", describe_number(band), allowed);
        return Err(source.path("simulation.band").refuse_value(fault));
    }
    let default_end_s = ends_s.unwrap_or(default.end_time_s);
    let end_time_s = positive("simulation.end_time_s", given.end_time_s, default_end_s)?;
    if end_time_s != default_end_s && ends_s.is_some() {
        let allowed = format!(
            "{}, no such key, or no `hold_s` at the end of the speed profile",
            describe_number(default_end_s)
        );
        let fault =
            Fault::new("not the end of the speed profile", describe_number(end_time_s), allowed);
        return Err(source.path("simulation.end_time_s").refuse_value(fault));
    }
    let extend = given.extend.as_ref();
    let extend = extend.map(|written| resolve_extend(source, written, end_time_s)).transpose()?;
    Ok(Simulation {
        method: given.method.unwrap_or(default.method),
        band,
        end_time_s,
        extend,
        endings: given.endings.unwrap_or(default.endings),
        relative_tolerance: positive(
            "simulation.tolerance.relative",
            tolerance.relative,
            default.relative_tolerance,
        )?,
        absolute_tolerance: positive(
            "simulation.tolerance.absolute",
            tolerance.absolute,
            default.absolute_tolerance,
        )?,
    })
}

/// Returns the settings in the form of a study file, with all values.
pub(crate) fn simulation_to_file(simulation: &Simulation) -> SimulationFile {
    SimulationFile {
        method: Some(simulation.method),
        band: Some(simulation.band),
        end_time_s: Some(simulation.end_time_s),
        extend: simulation.extend.map(extend_to_file),
        endings: Some(simulation.endings),
        tolerance: Some(ToleranceFile {
            relative: Some(simulation.relative_tolerance),
            absolute: Some(simulation.absolute_tolerance),
        }),
    }
}
