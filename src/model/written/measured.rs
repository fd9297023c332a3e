//! What a system of a file measures, recorded once: its coordinates, their rates of change and the outputs of the file.

use super::formula::Valued;
use crate::model::{Components, Expression, Graph, GraphPart, Recorder, SystemEquations};

/// The measured quantities.
#[derive(Debug)]
pub(super) struct MeasuredQuantities {
    graph: Graph,
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
        let (each, all) = (each.collect(), graph.part(graph.derivative.clone()));
        Ok(MeasuredQuantities { each, all, graph })
    }

    /// Returns whether they depend on the time no longer from an instant on ([`Graph::lasts_from`]).
    pub(super) fn last_from(&self, clock: usize, time: f64, inputs: &[f64]) -> bool {
        self.graph.lasts_from(clock, time, inputs)
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
