//! The Python module `stickslip._stickslip`: bindings of the library.
//!
//! Computations run in a separate thread without Python's lock (`waiting`), results are Arrow
//! tables without a copy (`table`), and exceptions have the messages of the command line (`error`).
#![deny(missing_docs)]

mod command;
mod directory;
mod equilibria;
mod error;
mod given;
mod identification;
mod json;
mod machine;
mod optimum;
mod plotting;
mod progress;
mod results;
mod run;
mod simulation;
mod study;
mod table;
mod threads;
mod values;
mod waiting;

use pyo3::prelude::*;

/// The compiled part of the package.
#[pymodule]
fn _stickslip(module: &Bound<'_, PyModule>) -> PyResult<()> {
    stickslip::engine::show_messages(stickslip::cli::print_message);
    module.add("__version__", stickslip::table::VERSION)?;
    module.add_class::<study::PyStudy>()?;
    module.add_class::<results::Results>()?;
    module.add_class::<table::Table>()?;
    module.add_class::<equilibria::EquilibriumSet>()?;
    module.add_class::<identification::Identification>()?;
    module.add_class::<optimum::Optimum>()?;
    module.add_class::<simulation::Simulation>()?;
    module.add_function(wrap_pyfunction!(command::_command, module)?)?;
    module.add_function(wrap_pyfunction!(plotting::_figures, module)?)?;
    module.add_function(wrap_pyfunction!(study::_latex, module)?)?;
    module.add_function(wrap_pyfunction!(study::_unpickle, module)?)?;
    for function in [
        wrap_pyfunction!(equilibria::equilibrium_set, module)?,
        wrap_pyfunction!(results::open, module)?,
        wrap_pyfunction!(simulation::simulate, module)?,
    ] {
        // Names the public module instead of the compiled module.
        function.setattr("__module__", "stickslip")?;
        module.add_function(function)?;
    }
    error::add(module)
}
