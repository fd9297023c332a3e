//! Finds the operations on power series of the recorded equations of a system.

use std::collections::HashMap;

use super::operations::{Entry, Operation, Operations, Slot, Static, StaticId};
use super::schedule::{reads_and_writes, sorted};
use super::turning::{Turning, TurningNodes};
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
    /// The angles whose rates are speeds.
    turning: Vec<(Turning, TurningNodes)>,
    slots: u32,
}

/// Compiles a recorded system.
pub(super) fn compile(graph: &Graph, expands: bool) -> Operations {
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
    let outputs: Vec<NodeId> = outputs.chain(guards()).chain(gaps()).collect();
    let wanted = compiler.wanted(&outputs);
    for (place, wanted) in wanted.iter().enumerate() {
        if *wanted {
            compiler.emit(place as NodeId);
        }
    }
    let required: Vec<Slot> =
        (0..graph.contacts.len()).map(|contact| compiler.required_friction(contact)).collect();
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
    let contacts = graph.contacts.iter().zip(required).map(|(contact, required)| {
        let [speed, acceleration, normal, _] = contact.map(slot);
        [speed, acceleration, normal, required]
    });
    Operations {
        kinematic: kinematic.collect(),
        rates,
        contacts: contacts.collect(),
        guards: guards().map(slot).collect(),
        gaps: gaps().map(slot).collect(),
        slots: compiler.slots as usize,
        all: sorted(compiler.operations, components),
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
            Node::ArcTangent(a, slope) => {
                Operation::ArcTangent { out: self.slots, a: self.slot(a), slope: self.slot(slope) }
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
        let turning = Turning {
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

    /// Returns a node as a linear combination.
    fn linear_of(&mut self, place: NodeId) -> Linear {
        let mut sum = Linear::default();
        let one = self.add(Static::Constant(1.0));
        self.linear(place, one, &mut sum);
        sum
    }

    /// Returns the series of a linear combination.
    fn emit_linear(&mut self, sum: Linear) -> Slot {
        let Linear { constant, terms } = sum;
        if let ([(slot, factor)], None) = (terms.as_slice(), constant)
            && self.statics[*factor as usize] == Static::Constant(1.0)
        {
            return *slot;
        }
        let out = self.new_slot();
        self.operations.push(Operation::Linear { out, constant, terms });
        out
    }

    /// Returns the series of the friction force that a contact requires to stick.
    fn required_friction(&mut self, contact: usize) -> Slot {
        let friction = self.graph.contacts[contact][3];
        let mut sum = self.linear_of(friction);
        // Each contact has a switch, which is 0 in stick.
        let switches = &self.graph.switches;
        if switches.len() == self.graph.contacts.len() {
            let switch = self.add(Static::Input(switches[contact]));
            let zero = self.add(Static::Constant(0.0));
            sum.constant = sum.constant.map(|constant| self.with_zero(constant, switch));
            for (_, factor) in &mut sum.terms {
                *factor = self.with_zero(*factor, switch);
            }
            sum.terms.retain(|(_, factor)| *factor != zero);
        }
        self.emit_linear(sum)
    }

    /// Returns a static number with another one replaced by zero.
    fn with_zero(&mut self, number: StaticId, switch: StaticId) -> StaticId {
        let zero = self.add(Static::Constant(0.0));
        if number == switch {
            return zero;
        }
        match self.statics[number as usize] {
            Static::Product(a, b) => {
                let [a, b] = [a, b].map(|one| self.with_zero(one, switch));
                if a == zero || b == zero { zero } else { self.times(a, b) }
            }
            Static::Negation(a) => {
                let a = self.with_zero(a, switch);
                if a == zero { zero } else { self.negative(a) }
            }
            Static::Difference(a, b) if b == switch => self.with_zero(a, switch),
            _ => number,
        }
    }

    fn emit_solve(&mut self, index: u32) {
        let solve = self.graph.solves[index as usize].clone();
        let size = solve.right.len();
        let is_constant =
            |node: NodeId, value: f64| self.graph.nodes[node as usize] == Node::Constant(value);
        let out: Vec<Slot> = (0..size).map(|_| self.new_slot()).collect();
        let mut matrix = Vec::with_capacity(size * size);
        let mut right = Vec::with_capacity(size);
        for (row, entries) in solve.matrix.chunks(size).enumerate() {
            let mut own = self.linear_of(solve.right[row]);
            for (column, &node) in (0..).zip(entries) {
                matrix.push(match self.static_of[node as usize] {
                    Some(_) if is_constant(node, 0.0) => Entry::Zero,
                    Some(number) => Entry::Constant(number),
                    None => {
                        let (factor, slot) = self.scaled_series(node);
                        let unknown = Node::Solution { solve: index, row: column };
                        match self.total_derivative((slot, factor), unknown, &mut own) {
                            Some(turned) => turned,
                            None => {
                                let product = self.pair_with([slot, out[column as usize]]);
                                Entry::Series { factor, slot, product }
                            }
                        }
                    }
                });
            }
            right.push(self.emit_linear(own));
        }
        let diagonal = solve.matrix.iter().step_by(size + 1);
        let units = diagonal.map(|node| solve.has_sound_diagonal && is_constant(*node, 1.0));
        let units = units.collect();
        for (place, node) in self.graph.nodes.iter().enumerate() {
            if let Node::Solution { solve, row } = *node
                && solve == index
            {
                self.slot_of[place] = Some(out[row as usize]);
            }
        }
        self.operations.push(Operation::Solve { matrix, right, out, units });
    }

    /// Returns a node as a constant factor times a series.
    fn scaled_series(&mut self, mut node: NodeId) -> (StaticId, Slot) {
        let mut factor = self.add(Static::Constant(1.0));
        loop {
            let (inner, by) = match self.graph.nodes[node as usize] {
                Node::Negation(a) => (a, self.add(Static::Constant(-1.0))),
                Node::Product(a, b) => match [a, b].map(|one| self.static_of[one as usize]) {
                    [Some(by), _] => (b, by),
                    [_, Some(by)] => (a, by),
                    _ => break,
                },
                _ => break,
            };
            factor = self.times(by, factor);
            node = inner;
        }
        if let Some(slot) = self.slot_of[node as usize] {
            return (factor, slot);
        }
        let sum = self.linear_of(node);
        let slot = self.emit_linear(sum);
        self.slot_of[node as usize] = Some(slot);
        (factor, slot)
    }

    /// Returns the place of a product that another operation computes.
    fn pair_with(&mut self, mut pair: [Slot; 2]) -> Slot {
        let product = self.new_slot();
        pair.sort_unstable();
        *self.pairs.entry(pair).or_insert(product)
    }

    /// Returns the entry of a matrix whose product with an unknown is part of a total derivative ([`super::turning`]); the
    /// other part leaves the right-hand side.
    fn total_derivative(
        &mut self,
        (slot, factor): (Slot, StaticId),
        unknown: Node,
        right: &mut Linear,
    ) -> Option<Entry> {
        let (turning, nodes) = self.turning.iter().find(|(turning, nodes)| {
            let acceleration = nodes.acceleration.map(|node| self.graph.nodes[node as usize]);
            (slot == turning.sine || slot == turning.cosine) && acceleration == Some(unknown)
        })?;
        let is_sine = slot == turning.sine;
        let other = if is_sine { turning.cosine } else { turning.sine };
        let square = *self.pairs.get(&[turning.speed; 2])?;
        let mut pair = [other, square];
        pair.sort_unstable();
        let product = *self.pairs.get(&pair)?;
        let residual = nodes.residual.and_then(|node| self.static_of[node as usize]);
        let turning = turning.clone();
        let expected = if is_sine { self.negative(factor) } else { factor };
        let place = right.terms.iter().position(|term| *term == (product, expected))?;
        right.terms.remove(place);
        Some(Entry::Turned { turning, is_sine, factor, residual, square })
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
        let [a, b] = pair;
        self.operations.push(Operation::Product { out, a, b });
        out
    }

    /// Returns a product; signs stand outside of products.
    fn times(&mut self, a: StaticId, b: StaticId) -> StaticId {
        match [a, b].map(|id| self.statics[id as usize]) {
            [Static::Constant(1.0), _] => b,
            [_, Static::Constant(1.0)] => a,
            [Static::Constant(-1.0), _] => self.negative(b),
            [_, Static::Constant(-1.0)] => self.negative(a),
            [Static::Negation(a), _] => {
                let product = self.times(a, b);
                self.negative(product)
            }
            [_, Static::Negation(b)] => {
                let product = self.times(a, b);
                self.negative(product)
            }
            _ => self.add(Static::Product(a, b)),
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
