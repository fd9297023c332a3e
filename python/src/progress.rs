//! Progress bars of tqdm, in a terminal or a notebook, drawn while a computation runs in another thread.

use pyo3::prelude::*;
use stickslip::engine::{ProgressDisplay, Snapshot, Watch};

/// How progress is shown: the bars, if there are any.
pub struct Bars {
    watch: Watch,
    bars: Option<Py<PyAny>>,
}

impl Bars {
    /// Prepares the bars if `progress` is wanted.
    ///
    /// # Errors
    /// Returns a `ModuleNotFoundError` without tqdm.
    pub fn new(py: Python<'_>, progress: bool) -> PyResult<Self> {
        let bars = || py.import("stickslip._progress")?.getattr("Bars")?.call0();
        let bars = progress.then(bars).transpose()?.map(Bound::unbind);
        Ok(Bars { watch: Watch::default(), bars })
    }

    /// Returns no bars.
    pub fn none() -> Self {
        Bars { watch: Watch::default(), bars: None }
    }

    /// Returns how the computation has to report its progress.
    pub fn show(&self) -> ProgressDisplay {
        match self.bars {
            Some(_) => ProgressDisplay::Watched(self.watch.clone()),
            None => ProgressDisplay::Nothing,
        }
    }

    /// Draws the progress of this moment.
    ///
    /// # Errors
    /// Returns the exception of tqdm or of a signal handler.
    pub fn draw(&self, py: Python<'_>) -> PyResult<()> {
        let Some(bars) = &self.bars else { return Ok(()) };
        for (part, (study, counts)) in (1_u64..).zip(self.watch.look()) {
            let Snapshot { runs, most_runs, equilibria, failed, .. } = counts;
            bars.call_method1(py, "draw", (part, study, runs, most_runs, equilibria, failed))?;
        }
        Ok(())
    }

    /// Draws the last state and leaves it.
    ///
    /// # Errors
    /// Returns the exception of tqdm or of a signal handler.
    pub fn close(&self, py: Python<'_>) -> PyResult<()> {
        self.draw(py)?;
        if let Some(bars) = &self.bars {
            bars.call_method0(py, "close")?;
        }
        Ok(())
    }
}
