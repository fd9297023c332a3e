//! Compiles the recorded equations of a system to operations on power series.

use std::collections::HashMap;

use super::program::{Entry, Operation, Program, Slot, Static, StaticId};
use super::schedule::{grouped, reads_and_writes};
use crate::model::{Graph, Node, NodeId};

/// A linear combination under construction.
#[derive(Clone, Default)]
struct Linear {
    constant: Option<StaticId>,
    terms: Vec<(Slot, StaticId)>,
}

struct Compiler<'g> {
    graph: &'g Graph,
    /// Whether products of sums are multiplied out.
    expands: bool,
    /// The products of two series that have been multiplied out.
    pairs: HashMap<[Slot; 2], Slot>,
    statics: Vec<Static>,
    known: HashMap<(u8, u64, u64), StaticId>,
    static_of: Vec<Option<StaticId>>,
    slot_of: Vec<Option<Slot>>,
    operations: Vec<Operation>,
    slots: u32,
}

/// Compiles a recorded system.
pub(super) fn compile(graph: &Graph, expands: bool) -> Program {
    let components = graph.derivative.len() as u32;
    let mut compiler = Compiler {
        graph,
        expands,
        pairs: HashMap::new(),
        statics: Vec::new(),
        known: HashMap::new(),
        static_of: vec![None; graph.nodes.len()],
        slot_of: vec![None; graph.nodes.len()],
        operations: Vec::new(),
        slots: components,
    };
    for (place, node) in graph.nodes.iter().enumerate() {
        if let Node::State(component) | Node::Discrete(component) = *node {
            compiler.slot_of[place] = Some(component);
        }
    }
    let guards = || graph.events.iter().map(|event| event.guard);
    let outputs = graph.derivative.iter().chain(graph.contacts.iter().flatten()).copied();
    let gaps = || graph.gaps.iter().map(|[_, force]| *force);
    let outputs: Vec<NodeId> = outputs.chain(guards()).chain(gaps()).collect();
    let wanted = compiler.wanted(&outputs);
    for (place, wanted) in wanted.iter().enumerate() {
        if *wanted {
            compiler.emit(place as NodeId);
        }
    }
    let one = compiler.add(Static::Constant(1.0));
    let slot = |node: NodeId| compiler.slot_of[node as usize].unwrap_or(0);
    let rates: Vec<Slot> = graph.derivative.iter().map(|&node| slot(node)).collect();
    let kinematic = rates.iter().enumerate().filter_map(|(component, &rate)| {
        let terms = match compiler.operation_of(rate) {
            None => vec![(rate, one)],
            Some(Operation::Linear { terms, .. }) => terms.clone(),
            Some(_) => return None,
        };
        let of_components = terms.iter().all(|(slot, _)| *slot < components);
        of_components.then_some((component as Slot, terms))
    });
    Program {
        kinematic: kinematic.collect(),
        rates,
        contacts: graph.contacts.iter().map(|contact| contact.map(slot)).collect(),
        guards: guards().map(slot).collect(),
        gaps: gaps().map(slot).collect(),
        slots: compiler.slots as usize,
        operations: grouped(compiler.operations, components),
        statics: compiler.statics,
    }
}

impl Compiler<'_> {
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
                let is_entry = matches!(nodes[place], Node::Solution { .. })
                    && self.static_of[operand as usize].is_some();
                wanted[operand as usize] |= !linear && !is_entry;
            }
            if let Node::Solution { solve, .. } = nodes[place] {
                for &right in &self.graph.solves[solve as usize].right {
                    wanted[right as usize] = true;
                }
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
            Node::Exponential(a) => Static::Exponential(of(a)?),
            Node::ArcTangent(a, _) => Static::ArcTangent(of(a)?),
            Node::State(_) | Node::Solution { .. } => return None,
        };
        Some(self.add(number))
    }

    /// Returns the place of a static number, which is added if it is new.
    fn add(&mut self, number: Static) -> StaticId {
        let two = |kind: u8, a: StaticId, b: StaticId| (kind, u64::from(a), u64::from(b));
        let key = match number {
            Static::Constant(value) => (0, value.to_bits(), 0),
            Static::Input(index) => two(1, index, 0),
            Static::Sum(a, b) => two(2, a, b),
            Static::Difference(a, b) => two(3, a, b),
            Static::Negation(a) => two(4, a, 0),
            Static::Product(a, b) => two(5, a, b),
            Static::Quotient(a, b) => two(6, a, b),
            Static::Sine(a) => two(7, a, 0),
            Static::Cosine(a) => two(8, a, 0),
            Static::SquareRoot(a) => two(9, a, 0),
            Static::Exponential(a) => two(10, a, 0),
            Static::ArcTangent(a) => two(11, a, 0),
            Static::Discrete(component) => two(12, component, 0),
        };
        let statics = &mut self.statics;
        *self.known.entry(key).or_insert_with(|| {
            statics.push(number);
            statics.len() as StaticId - 1
        })
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
            Node::Sine(angle) => {
                let [sine, cosine, rate] = [(); 3].map(|()| self.new_slot());
                self.slot_of[place as usize] = Some(sine);
                self.slot_of[place as usize + 1] = Some(cosine);
                Operation::SineCosine { sine, cosine, angle: self.slot(angle), rate }
            }
            Node::Solution { solve, .. } => return self.emit_solve(solve),
            Node::Product(a, b) if !self.is_linear(node) => Operation::Products {
                shared: self.slot(a),
                others: vec![(self.slot(b), self.slots)],
            },
            Node::Quotient(a, b) if !self.is_linear(node) => Operation::Quotient {
                out: self.slots,
                a: self.slot(a),
                b: self.slot(b),
                inverse: self.slots + 1,
            },
            Node::SquareRoot(a) => {
                Operation::SquareRoot { out: self.slots, a: self.slot(a), inverse: self.slots + 1 }
            }
            Node::Exponential(a) => {
                Operation::Exponential { out: self.slots, a: self.slot(a), rate: self.slots + 1 }
            }
            Node::ArcTangent(a, slope) => Operation::ArcTangent {
                out: self.slots,
                a: self.slot(a),
                slope: self.slot(slope),
                rate: self.slots + 1,
                inverse: self.slots + 2,
            },
            _ => {
                let mut sum = Linear::default();
                let one = self.add(Static::Constant(1.0));
                self.linear(place, one, &mut sum);
                let Linear { constant, terms } = sum;
                if let ([(slot, factor)], None) = (terms.as_slice(), constant)
                    && *factor == one
                {
                    self.slot_of[place as usize] = Some(*slot);
                    return;
                }
                Operation::Linear { out: self.slots, constant, terms }
            }
        };
        if self.slot_of[place as usize].is_none() {
            self.slot_of[place as usize] = Some(self.slots);
            self.slots += match operation {
                Operation::ArcTangent { .. } => 3,
                Operation::Quotient { .. }
                | Operation::SquareRoot { .. }
                | Operation::Exponential { .. } => 2,
                _ => 1,
            };
        }
        self.operations.push(operation);
    }

    fn emit_solve(&mut self, index: u32) {
        let solve = self.graph.solves[index as usize].clone();
        let size = solve.right.len();
        let matrix = solve.matrix.iter().map(|&node| match self.static_of[node as usize] {
            Some(number) => Entry::Constant(number),
            None => Entry::Series(self.slot(node)),
        });
        let matrix = matrix.collect();
        let right = solve.right.iter().map(|&node| self.slot(node)).collect();
        let out: Vec<Slot> = (0..size).map(|_| self.new_slot()).collect();
        let factors = self.slots;
        self.slots += (size * size) as u32;
        for (place, node) in self.graph.nodes.iter().enumerate() {
            if let Node::Solution { solve, row } = *node
                && solve == index
            {
                self.slot_of[place] = Some(out[row as usize]);
            }
        }
        self.operations.push(Operation::Solve { matrix, right, out, factors });
    }

    /// Adds a node times a static factor to a linear combination.
    fn linear(&mut self, place: NodeId, factor: StaticId, sum: &mut Linear) {
        if let Some(number) = self.static_of[place as usize] {
            let part = self.times(number, factor);
            sum.constant = Some(match sum.constant {
                Some(constant) => self.add(Static::Sum(constant, part)),
                None => part,
            });
            return;
        }
        if let Some(slot) = self.slot_of[place as usize] {
            self.add_term(sum, slot, factor);
            return;
        }
        match self.graph.nodes[place as usize] {
            Node::Sum(a, b) => {
                self.linear(a, factor, sum);
                self.linear(b, factor, sum);
            }
            Node::Difference(a, b) => {
                self.linear(a, factor, sum);
                let minus = self.negative(factor);
                self.linear(b, minus, sum);
            }
            Node::Negation(a) => {
                let minus = self.negative(factor);
                self.linear(a, minus, sum);
            }
            Node::Product(a, b) if !self.is_static(a) && !self.is_static(b) => {
                self.multiply_out([a, b], factor, sum);
            }
            Node::Product(a, b) => {
                let (series, number) = match self.static_of[a as usize] {
                    Some(number) => (b, number),
                    None => (a, self.static_of[b as usize].unwrap_or(factor)),
                };
                let factor = self.times(number, factor);
                self.linear(series, factor, sum);
            }
            Node::Quotient(a, b) => {
                let number = self.static_of[b as usize].unwrap_or(factor);
                let factor = self.add(Static::Quotient(factor, number));
                self.linear(a, factor, sum);
            }
            // Everything else has a slot.
            _ => {}
        }
    }

    fn add_term(&mut self, sum: &mut Linear, slot: Slot, factor: StaticId) {
        match sum.terms.iter().position(|(other, _)| *other == slot) {
            Some(at) => sum.terms[at].1 = self.add(Static::Sum(sum.terms[at].1, factor)),
            None => sum.terms.push((slot, factor)),
        }
    }

    /// Adds the product of two sums times a static factor to a linear combination.
    fn multiply_out(&mut self, factors: [NodeId; 2], factor: StaticId, sum: &mut Linear) {
        let one = self.add(Static::Constant(1.0));
        let [a, b] = factors.map(|place| {
            let mut of_place = Linear::default();
            self.linear(place, one, &mut of_place);
            of_place
        });
        for (constant, other) in [(a.constant, &b), (b.constant, &a)] {
            let Some(constant) = constant else { continue };
            let part = self.times(constant, factor);
            for &(slot, number) in &other.terms {
                let part = self.times(part, number);
                self.add_term(sum, slot, part);
            }
        }
        if let (Some(a), Some(b)) = (a.constant, b.constant) {
            let both = self.times(a, b);
            let part = self.times(both, factor);
            sum.constant = Some(match sum.constant {
                Some(constant) => self.add(Static::Sum(constant, part)),
                None => part,
            });
        }
        for &(one, number) in &a.terms {
            let part = self.times(number, factor);
            for &(other, number) in &b.terms {
                let slot = self.pair([one, other]);
                let part = self.times(part, number);
                self.add_term(sum, slot, part);
            }
        }
    }

    /// Returns the product of two series.
    fn pair(&mut self, mut pair: [Slot; 2]) -> Slot {
        pair.sort_unstable();
        if let Some(&slot) = self.pairs.get(&pair) {
            return slot;
        }
        let out = self.new_slot();
        self.pairs.insert(pair, out);
        let [shared, other] = pair;
        self.operations.push(Operation::Products { shared, others: vec![(other, out)] });
        out
    }

    fn times(&mut self, a: StaticId, b: StaticId) -> StaticId {
        let is_one = |id: StaticId| self.statics[id as usize] == Static::Constant(1.0);
        if is_one(a) {
            b
        } else if is_one(b) {
            a
        } else {
            self.add(Static::Product(a, b))
        }
    }

    fn negative(&mut self, a: StaticId) -> StaticId {
        match self.statics[a as usize] {
            Static::Constant(value) => self.add(Static::Constant(-value)),
            Static::Negation(of) => of,
            _ => self.add(Static::Negation(a)),
        }
    }
}
