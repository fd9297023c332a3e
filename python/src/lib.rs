//! The Python module `stickslip._stickslip`: the library for Python, and nothing of its own.
//!
//! Work is done in a thread of its own without Python's lock (`waiting`); results are Arrow tables that
//! are handed over without a copy (`table`); what goes wrong has the text of the command line (`error`).
#![deny(missing_docs)]

mod designs;
mod equilibria;
mod error;
mod machine;
mod results;
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
    module.add("__version__", stickslip::table::VERSION)?;
    module.add_class::<study::PyStudy>()?;
    module.add_class::<results::Results>()?;
    module.add_class::<table::Table>()?;
    module.add_class::<equilibria::EquilibriumSet>()?;
    module.add_class::<simulation::Simulation>()?;
    module.add_function(wrap_pyfunction!(study::_unpickle, module)?)?;
    for function in [
        wrap_pyfunction!(equilibria::equilibrium_set, module)?,
        wrap_pyfunction!(simulation::simulate, module)?,
    ] {
        // Where users find it.
        function.setattr("__module__", "stickslip")?;
        module.add_function(function)?;
    }
    error::add(module)
}
