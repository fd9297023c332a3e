//! The `stickslip` program: arguments in, exit code out. All else is the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    stickslip::cli::main()
}
