//! The program `stickslip` in the process of Python: the command line of the library.

use std::ffi::OsString;
use std::io::{Write, stdout};

use pyo3::prelude::*;
use stickslip::cli;
use stickslip::study::Registry;

/// Runs the program and returns the exit code. The first argument is the name of the program.
#[pyfunction]
pub fn _command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| {
        let code = cli::run_with(Registry::new(), arguments);
        // Python ends the process without Rust's own end, which would write what is left in the buffer.
        let _ = stdout().flush();
        code
    })
}
