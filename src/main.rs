//! The `stickslip` program: calls the command line of the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    stickslip::cli::main()
}
