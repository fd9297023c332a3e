//! The programs of a recorded system, which equal systems share.

use std::sync::{Arc, Mutex, PoisonError};

use super::compiler::compile;
use super::operations::{Operations, Slot};
use super::series::Programs;
use crate::graph::{Cell, Instruction};
use crate::model::{Graph, PerStructure, System};

/// The largest number of systems without a structure whose equations are kept ready.
const MOST_KNOWN: usize = 16;

/// The equations of a system, ready to run.
#[derive(Debug)]
pub(super) struct Compiled {
    pub(super) operations: Operations,
    /// The arguments of exponential functions.
    pub(super) exponents: Vec<Slot>,
    /// The velocities and forces that determine the length of a step. Of each group, the largest counts. Forces have one
    /// coefficient less.
    pub(super) tolerated: Vec<Vec<Slot>>,
    /// The cells of parameters, and of what depends on parameters alone.
    pub(super) parameters: Vec<Cell>,
    pub(super) programs: Programs,
}

/// Returns recorded equations, ready to run. Equal systems share them.
pub(super) fn compiled(system: &dyn System, graph: &Arc<Graph>) -> Arc<Compiled> {
    static COMPILED: PerStructure<Compiled> = PerStructure::new();
    if system.structure().is_some() {
        return COMPILED.get(system.structure(), || Compiled::new(graph));
    }
    // The latest equations of systems without a structure.
    static LATEST: Mutex<Vec<(Arc<Graph>, Arc<Compiled>)>> = Mutex::new(Vec::new());
    // A panic while the equations are locked leaves them complete.
    let mut latest = LATEST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, known)) = latest.iter().find(|(known, _)| known == graph) {
        return Arc::clone(known);
    }
    let compiled = Arc::new(Compiled::new(graph));
    latest.truncate(MOST_KNOWN - 1);
    latest.insert(0, (Arc::clone(graph), Arc::clone(&compiled)));
    compiled
}

impl Compiled {
    fn new(graph: &Graph) -> Self {
        let (operations, programs) = cheapest(graph);
        let parameters = operations.inputs[1].iter().map(|(cell, _)| *cell);
        let fixed = &programs.fixed.program;
        let computed = fixed.instructions.iter().flat_map(Instruction::writes);
        let parameters = parameters.chain(computed.filter(|cell| fixed.kept[*cell as usize]));
        let parameters: Vec<Cell> = parameters.collect();
        let velocities = graph.layout.velocities.iter();
        let velocities = velocities.map(|group| group.iter().map(|place| *place as Slot).collect());
        let forces = std::iter::once(operations.forces_over_time());
        Compiled {
            exponents: operations.exponents(),
            tolerated: velocities.chain(forces).collect(),
            operations,
            parameters,
            programs,
        }
    }
}

/// Returns the operations of a recorded system and their programs, with products of sums multiplied out if fewer products
/// remain.
fn cheapest(graph: &Graph) -> (Operations, Programs) {
    let forms = [true, false].map(|expands| {
        let operations = compile(graph, expands);
        let programs = operations.programs();
        (operations, programs)
    });
    let [expanded, plain] = forms;
    let cost =
        |programs: &Programs| programs.motion.program.cost() + programs.normals.program.cost();
    if cost(&expanded.1) <= cost(&plain.1) { expanded } else { plain }
}
