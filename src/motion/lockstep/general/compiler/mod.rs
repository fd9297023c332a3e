//! Finds the operations on power series of the recorded equations of a system.
//!
//! Read this file first, then `linear` for sums and `unknowns` for linear systems.

mod linear;
mod unknowns;

use std::collections::HashMap;

use super::operations::{
    Operation, Operations, RowProducts, SIDE_BY_SIDE, Slot, TurningAngle, reads_and_writes, sorted,
};
use super::statics::{Static, StaticId, Statics};
use super::turning::TurningNodes;
use crate::model::{Function, Graph, Node, NodeId};

/// A linear combination under construction.
#[derive(Clone, Default)]
struct LinearCombination {
    constant: Option<StaticId>,
    terms: Vec<(Slot, StaticId)>,
}

struct Compiler<'g> {
    graph: &'g Graph,
    /// Whether products of sums are multiplied out.
    expands: bool,
    /// The products of two series that have been multiplied out.
    pairs: HashMap<[Slot; 2], Slot>,
    /// Sums of several products in the rows of linear systems.
    in_rows: Vec<RowProducts>,
    statics: Statics,
    static_of: Vec<Option<StaticId>>,
    slot_of: Vec<Option<Slot>>,
    operations: Vec<Operation>,
    /// The angles whose rates are speeds.
    turning: Vec<(TurningAngle, TurningNodes)>,
    slots: u32,
}

/// Compiles a recorded system.
pub(super) fn compile(graph: &Graph, expands: bool) -> Operations {
    let components = graph.derivative.len() as u32;
    let mut compiler = Compiler {
        graph,
        expands,
        pairs: HashMap::new(),
        in_rows: Vec::new(),
        statics: Statics::default(),
        static_of: vec![None; graph.nodes.len()],
        slot_of: vec![None; graph.nodes.len()],
        operations: Vec::new(),
        turning: Vec::new(),
        slots: components,
    };
    for (place, node) in graph.nodes.iter().enumerate() {
        if let Node::State(component) | Node::Discrete(component) = *node {
            compiler.slot_of[place] = Some(component);
        }
    }
    let guards = || graph.events.iter().map(|event| event.guard);
    let of_contacts = graph.contacts.iter().flat_map(|contact| &contact[..3]);
    let outputs = graph.derivative.iter().chain(of_contacts).copied();
    let gaps = || graph.gaps.iter().map(|[_, force]| *force);
    let mut outputs: Vec<NodeId> = outputs.chain(guards()).chain(gaps()).collect();
    let mut wanted = compiler.wanted(&outputs);
    // The friction that sticking requires is a sum of other series, or contains a part of its own.
    let frictions = graph.contacts.iter().map(|contact| contact[3]);
    let more: Vec<NodeId> = frictions.filter(|node| !compiler.is_sum_of(*node, &wanted)).collect();
    if !more.is_empty() {
        outputs.extend(more);
        wanted = compiler.wanted(&outputs);
    }
    for (place, wanted) in wanted.iter().enumerate() {
        if *wanted {
            compiler.emit(place as NodeId);
        }
    }
    let required: Vec<Slot> =
        (0..graph.contacts.len()).map(|contact| compiler.required_friction(contact)).collect();
    let one = compiler.statics.add(Static::Constant(1.0));
    let slot = |node: NodeId| compiler.slot_of[node as usize].unwrap_or(0);
    let rates: Vec<Slot> = graph.derivative.iter().map(|&node| slot(node)).collect();
    let settling = rates.iter().enumerate().filter(|(component, _)| !graph.translates(*component));
    let settling = settling.map(|(_, rate)| *rate).collect();
    let kinematic = rates.iter().enumerate().filter_map(|(component, &rate)| {
        let terms = match compiler.operation_of(rate) {
            None => vec![(rate, one)],
            Some(Operation::Linear { terms, .. }) => terms.clone(),
            Some(_) => return None,
        };
        let of_components = terms.iter().all(|(slot, _)| *slot < components);
        of_components.then_some((component as Slot, terms))
    });
    let contacts = graph.contacts.iter().zip(required).map(|(contact, required)| {
        let [speed, acceleration, normal, _] = contact.map(slot);
        [speed, acceleration, normal, required]
    });
    let is_parameter = |input: &(StaticId, u32)| graph.parameters.contains(&input.1);
    let [inputs, discrete] = compiler.statics.inputs_and_discrete();
    let (parameters, of_modes) = inputs.into_iter().partition(is_parameter);
    Operations {
        inputs: [of_modes, parameters],
        discrete,
        kinematic: kinematic.collect(),
        rates,
        settling,
        contacts: contacts.collect(),
        guards: guards().map(slot).collect(),
        gaps: gaps().map(slot).collect(),
        // Components are computed in groups.
        slots: (compiler.slots as usize).max(graph.derivative.len().next_multiple_of(SIDE_BY_SIDE)),
        all: sorted(compiler.operations, components),
        statics: compiler.statics,
    }
}

impl Compiler<'_> {
    /// Returns whether a node is linear in components of the state and in nodes that are wanted.
    fn is_sum_of(&self, place: NodeId, wanted: &[bool]) -> bool {
        let node = self.graph.nodes[place as usize];
        let is_known = self.slot_of[place as usize].is_some()
            || self.static_of[place as usize].is_some()
            || wanted[place as usize];
        let operands = || node.operands(&self.graph.solves).into_iter();
        is_known || self.is_linear(node) && operands().all(|term| self.is_sum_of(term, wanted))
    }

    /// Returns which nodes need a series of their own: outputs, operands of what is not linear, and linear expressions
    /// with several users. Finds the static numbers.
    fn wanted(&mut self, outputs: &[NodeId]) -> Vec<bool> {
        let nodes = &self.graph.nodes;
        let mut used = vec![0_u32; nodes.len()];
        let mut wanted = vec![false; nodes.len()];
        for &output in outputs {
            used[output as usize] += 1;
            wanted[output as usize] = true;
        }
        for (place, node) in nodes.iter().enumerate() {
            self.static_of[place] = self.static_number(*node);
        }
        for place in (0..nodes.len()).rev() {
            if used[place] == 0 || self.static_of[place].is_some() {
                continue;
            }
            let linear = self.is_linear(nodes[place]);
            wanted[place] |= !linear || (used[place] > 1 && !self.expands);
            for operand in nodes[place].operands(&self.graph.solves) {
                used[operand as usize] += 1;
                let in_system = matches!(nodes[place], Node::Solution { .. });
                wanted[operand as usize] |= !linear && !in_system;
            }
            // The cosine comes with the sine and stands after it.
            if let Node::Cosine(_) = nodes[place] {
                wanted[place - 1] = true;
                used[place - 1] += 1;
            }
        }
        wanted
    }

    fn is_static(&self, node: NodeId) -> bool {
        self.static_of[node as usize].is_some()
    }

    fn is_linear(&self, node: Node) -> bool {
        match node {
            Node::Sum(..) | Node::Difference(..) | Node::Negation(_) => true,
            Node::Product(a, b) => self.expands || self.is_static(a) || self.is_static(b),
            Node::Quotient(_, b) => self.is_static(b),
            _ => false,
        }
    }

    /// Returns the static number of a node whose operands are static.
    fn static_number(&mut self, node: Node) -> Option<StaticId> {
        let of = |id: NodeId| self.static_of[id as usize];
        let number = match node {
            Node::Constant(value) => Static::Constant(value),
            Node::Input(index) => Static::Input(index),
            Node::Discrete(component) => Static::Discrete(component),
            Node::Sum(a, b) => Static::Sum(of(a)?, of(b)?),
            Node::Difference(a, b) => Static::Difference(of(a)?, of(b)?),
            Node::Negation(a) => Static::Negation(of(a)?),
            Node::Product(a, b) => Static::Product(of(a)?, of(b)?),
            Node::Quotient(a, b) => Static::Quotient(of(a)?, of(b)?),
            Node::Sine(a) => Static::Sine(of(a)?),
            Node::Cosine(a) => Static::Cosine(of(a)?),
            Node::SquareRoot(a) => Static::SquareRoot(of(a)?),
            Node::Exponential(a) => Static::Function(Function::Exponential, of(a)?),
            Node::Function(function, a, _) => Static::Function(function, of(a)?),
            Node::State(_) | Node::Solution { .. } => return None,
        };
        Some(self.statics.add(number))
    }

    /// Returns the operation that computes a series; `None` for a component of the state.
    fn operation_of(&self, slot: Slot) -> Option<&Operation> {
        let writes = |operation: &&Operation| reads_and_writes(operation).1.contains(&slot);
        self.operations.iter().find(writes)
    }

    fn new_slot(&mut self) -> Slot {
        self.slots += 1;
        self.slots - 1
    }

    fn slot(&self, node: NodeId) -> Slot {
        self.slot_of[node as usize].unwrap_or(0)
    }

    /// Adds the operation that computes a node.
    fn emit(&mut self, place: NodeId) {
        if self.slot_of[place as usize].is_some() {
            return;
        }
        let node = self.graph.nodes[place as usize];
        if let Some(constant) = self.static_of[place as usize] {
            let out = self.new_slot();
            self.slot_of[place as usize] = Some(out);
            let constant = Some(constant);
            self.operations.push(Operation::Linear { out, constant, terms: vec![] });
            return;
        }
        let operation = match node {
            Node::Sine(angle) => self.sine_and_cosine(place, angle),
            Node::Solution { solve, .. } => return self.emit_solve(solve),
            Node::Product(a, b) if !self.is_linear(node) && self.pair_of(a, b).is_some() => {
                self.slot_of[place as usize] = self.pair_of(a, b);
                return;
            }
            Node::Product(a, b) if !self.is_linear(node) => {
                Operation::Product { out: self.slots, a: self.slot(a), b: self.slot(b) }
            }
            Node::Quotient(a, b) if !self.is_linear(node) => {
                Operation::Quotient { out: self.slots, a: self.slot(a), b: self.slot(b) }
            }
            Node::SquareRoot(a) => Operation::SquareRoot { out: self.slots, a: self.slot(a) },
            Node::Exponential(a) => Operation::Exponential { out: self.slots, a: self.slot(a) },
            Node::Function(function, a, slope) => {
                let [a, slope] = [a, slope].map(|node| self.slot(node));
                Operation::Function { function, out: self.slots, a, slope }
            }
            _ => {
                let sum = self.linear_of(place);
                self.slot_of[place as usize] = Some(self.emit_linear(sum));
                return;
            }
        };
        if self.slot_of[place as usize].is_none() {
            self.slot_of[place as usize] = Some(self.new_slot());
        }
        self.operations.push(operation);
    }

    /// Returns the product of two nodes, if it is known.
    fn pair_of(&self, a: NodeId, b: NodeId) -> Option<Slot> {
        let mut pair = [self.slot(a), self.slot(b)];
        pair.sort_unstable();
        self.pairs.get(&pair).copied()
    }

    /// Returns the operation of sine and cosine, whose places follow each other.
    fn sine_and_cosine(&mut self, place: NodeId, angle: NodeId) -> Operation {
        let [sine, cosine] = [(); 2].map(|()| self.new_slot());
        self.slot_of[place as usize] = Some(sine);
        self.slot_of[place as usize + 1] = Some(cosine);
        let Some(nodes) = TurningNodes::of(self.graph, angle) else {
            return Operation::SineCosine { sine, cosine, angle: self.slot(angle) };
        };
        let [sine_speed, cosine_speed] = [sine, cosine].map(|of| self.pair_with([nodes.speed, of]));
        let turning = TurningAngle {
            angle: self.slot(angle),
            speed: nodes.speed,
            switch: nodes.switch.and_then(|node| self.static_of[node as usize]),
            sine,
            cosine,
            sine_speed,
            cosine_speed,
        };
        self.turning.push((turning.clone(), nodes));
        Operation::Turning(turning)
    }

    /// Returns the place of a product that another operation computes.
    fn pair_with(&mut self, mut pair: [Slot; 2]) -> Slot {
        let product = self.new_slot();
        pair.sort_unstable();
        *self.pairs.entry(pair).or_insert(product)
    }
}
