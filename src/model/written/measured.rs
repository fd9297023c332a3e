//! What a system of a file measures, recorded once: its coordinates, their rates of change and the outputs of the file.

use smallvec::SmallVec;

use super::formula::Valued;
use super::system::{RecordedState, WrittenSystem};
use crate::model::{Components, Graph, Node, Recorder, SystemEquations};

/// The nodes of the measured quantities.
#[derive(Debug)]
pub(super) struct Measured(Graph);

impl Measured {
    /// Records what a system measures.
    pub(super) fn of(system: &WrittenSystem) -> Valued<Self> {
        let recorder = Recorder::default();
        let outputs = system.in_recorded_state(&recorder, |state| {
            let RecordedState { coordinates, mut values, .. } = state;
            let mut outputs = coordinates.concat();
            for number in 0..system.instance.outputs.len() {
                let (output, mut bodies) = system.instance.output(number);
                outputs.push(bodies.evaluate(&output.formula, &mut values)?);
            }
            Ok(outputs)
        })?;
        // The graph has these quantities in the place of rates of change.
        let equations = SystemEquations { derivative: outputs, ..SystemEquations::default() };
        Ok(Measured(recorder.finish(&equations)))
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
