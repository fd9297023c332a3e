//! What a system of a file measures, recorded once: its coordinates, their rates of change and the outputs of the file.

use smallvec::SmallVec;

use super::formula::Valued;
use crate::model::{Components, Expression, Graph, Node, Recorder, SystemEquations};

/// The measured quantities, as a graph.
#[derive(Debug)]
pub(super) struct MeasuredQuantities(Graph);

impl MeasuredQuantities {
    /// Records the quantities that a system measures.
    pub(super) fn of(
        quantities: impl for<'r> FnOnce(&'r Recorder) -> Valued<Vec<Expression<'r>>>,
    ) -> Valued<Self> {
        let recorder = Recorder::default();
        // The graph has these quantities in the place of rates of change.
        let equations =
            SystemEquations { derivative: quantities(&recorder)?, ..SystemEquations::default() };
        Ok(MeasuredQuantities(recorder.finish(&equations)))
    }

    /// Returns the values in a state; `inputs` are those of the system.
    pub(super) fn values(&self, inputs: &[f64], state: &[f64]) -> Components {
        let mut values: SmallVec<[f64; 128]> = SmallVec::with_capacity(self.0.nodes.len());
        for node in &self.0.nodes {
            let at = |node: u32| values[node as usize];
            values.push(Node::value(node, at, |index| inputs[index], |index| state[index]));
        }
        self.0.derivative.iter().map(|&node| values[node as usize]).collect()
    }
}
