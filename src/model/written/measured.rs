//! What a system of a file measures, recorded once: its coordinates, their rates of change and the outputs of the file.

use super::formula::Valued;
use crate::model::{Components, Expression, GraphPart, Recorder, SystemEquations};

/// The measured quantities.
#[derive(Debug)]
pub(super) struct MeasuredQuantities {
    all: GraphPart,
    each: Vec<GraphPart>,
}

impl MeasuredQuantities {
    /// Records the quantities that a system measures.
    pub(super) fn of(
        quantities: impl for<'r> FnOnce(&'r Recorder) -> Valued<Vec<Expression<'r>>>,
    ) -> Valued<Self> {
        let recorder = Recorder::default();
        // The graph has these quantities in the place of rates of change.
        let equations =
            SystemEquations { derivative: quantities(&recorder)?, ..SystemEquations::default() };
        let graph = recorder.finish(&equations);
        let each = graph.derivative.iter().map(|quantity| graph.part(vec![*quantity]));
        Ok(MeasuredQuantities { each: each.collect(), all: graph.part(graph.derivative.clone()) })
    }

    /// Returns the values in a state; `inputs` are those of the system.
    pub(super) fn values(&self, inputs: &[f64], state: &[f64]) -> Components {
        self.all.values(|index| inputs[index], |component| state[component]).collect()
    }

    /// Returns the value of one quantity, which may need few components of the state.
    pub(super) fn value(
        &self,
        number: usize,
        inputs: &[f64],
        state: impl Fn(usize) -> f64,
    ) -> Option<f64> {
        self.each.get(number)?.values(|index| inputs[index], state).next()
    }
}
