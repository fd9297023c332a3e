//! Checks of the simulation settings that concern several keys.

use crate::model::Simulation;
use crate::study::error::{Fault, StudyError};
use crate::study::file::source::Source;
use crate::study::file::yaml_tree::describe_number;

/// Returns the simulation settings of a study; `ends_s` is the end of the speed profile, if the profile has one.
///
/// # Errors
/// Returns an error if the end time is not that of the speed profile, or if the extension gives no later end time.
pub(crate) fn resolve_simulation(
    source: &Source,
    written: Option<Simulation>,
    ends_s: Option<f64>,
) -> Result<Simulation, StudyError> {
    let mut simulation = written.unwrap_or_default();
    let path = source.path("simulation.end_time_s");
    if let Some(ends_s) = ends_s {
        let end_time_s = std::mem::replace(&mut simulation.end_time_s, ends_s);
        if path.node().is_some() && end_time_s != ends_s {
            let allowed = format!(
                "{}, no such key, or no `hold_s` at the end of the speed profile",
                describe_number(ends_s)
            );
            let found = describe_number(end_time_s);
            let fault = Fault::new("not the end of the speed profile", found, allowed);
            return Err(path.refuse_value(fault));
        }
    }
    let [end_s, later_s] = simulation.end_times_s();
    // Rounding may lose a factor slightly above 1, and a long end time may overflow.
    match simulation.extend {
        Some(extend) if !(later_s > end_s && later_s.is_finite()) => {
            let allowed = "a factor whose later end time is a larger, finite number";
            let fault = Fault::new("no later end time", describe_number(extend.factor), allowed);
            Err(source.path("simulation.extend.factor").refuse_value(fault))
        }
        _ => Ok(simulation),
    }
}
