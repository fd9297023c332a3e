//! `stickslip completions`: prints completion scripts for shells.

use clap::Args;
use clap_complete::{Shell, generate};

use super::output::{CliError, End, print};

const EXAMPLES: &str = "\
Examples:
  stickslip completions bash > ~/.local/share/bash-completion/completions/stickslip
  stickslip completions zsh > ~/.zfunc/_stickslip
  stickslip completions fish > ~/.config/fish/completions/stickslip.fish";

/// Print a completion script for a shell
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Prints the completions.
pub fn completions(arguments: &Arguments) -> Result<End, CliError> {
    let mut script = Vec::new();
    generate(arguments.shell, &mut super::definition(), "stickslip", &mut script);
    print(&String::from_utf8_lossy(&script))?;
    Ok(End::Well)
}
