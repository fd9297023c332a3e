//! `stickslip equilibria`: computes equilibrium sets and steady states, without simulation.

use super::equilibria_of_balancer::equilibria_of_balancer;
use super::equilibria_of_system::equilibria_of_system;
pub use super::equilibria_tables::Arguments;
use super::output::{CliError, End};

/// Computes the sets and writes their tables.
///
/// # Errors
/// Returns an error if the study, the options or the output directory cannot be used, or if a table cannot be
/// written.
pub fn equilibria(arguments: &Arguments) -> Result<End, CliError> {
    let study = arguments.study.load()?;
    match study.model().kind().offers.equilibrium_set {
        true => equilibria_of_balancer(arguments, &study),
        false => equilibria_of_system(arguments, &study),
    }
}
