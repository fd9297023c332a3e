//! Records the equations of a system as a graph in which equal expressions are one node.

use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::Arc;

use super::{Expression, Node, NodeId, PerStructure, Solve};
use crate::model::System;

/// A graph that is being recorded.
#[derive(Default)]
pub struct Recorder(RefCell<Recording>);

#[derive(Default)]
struct Recording {
    nodes: Vec<Node>,
    /// The place of each node. A NaN equals itself here, as its bits do.
    known: HashMap<(u8, u64, u64), NodeId>,
    solves: Vec<Solve>,
    inputs: Vec<String>,
    switches: Vec<u32>,
    parameters: Vec<u32>,
    states: u32,
}

/// The equations of a system, with expressions.
#[derive(Default)]
pub struct SystemEquations<'r> {
    /// The time derivative of each component of the state.
    pub derivative: Vec<Expression<'r>>,
    /// The contacts.
    pub contacts: Vec<ContactEquations<'r>>,
    /// The events that reset the state. Of several at one instant, the first in this order comes first.
    pub events: Vec<EventEquations<'r>>,
    /// The gaps between contacts.
    pub gaps: Vec<GapEquations<'r>>,
    /// The contacts that open and close.
    pub openings: Vec<OpeningEquations<'r>>,
    /// The meaning of the components.
    pub layout: Layout,
}

/// The meaning of the components of a state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// The contacts, in their order.
    pub contacts: Vec<ContactLayout>,
    /// The components that are velocities, which determine the length of a step. Of each group, the largest counts.
    pub velocities: Vec<Vec<usize>>,
    /// The components that are the displacement whose amplitude is measured, if the system has such a displacement;
    /// otherwise the positions of the contacts are measured.
    pub vibration: Option<[usize; 2]>,
    /// The component in which the equations are periodic, if the system is forced periodically.
    pub forcing: Option<ForcingLayout>,
}

/// The time, or the phase of a periodic force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForcingLayout {
    /// The component of the state, which grows at a constant rate.
    pub component: usize,
    /// When the component has grown by this value, the equations are the same as before.
    pub period: f64,
}

/// The coordinate of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactLayout {
    /// The component that is its position.
    pub position: usize,
    /// Whether the position is an angle, with a period of one turn.
    pub angular: bool,
}

/// What the mode of a contact is decided by.
#[derive(Clone, Copy)]
pub struct ContactEquations<'r> {
    /// The sliding speed.
    pub sliding_speed: Expression<'r>,
    /// The sliding acceleration.
    pub sliding_acceleration: Expression<'r>,
    /// The normal force, compression positive.
    pub normal: Expression<'r>,
    /// The friction force; in stick, the force required to stick.
    pub friction: Expression<'r>,
}

/// What the mode of a gap is decided by.
#[derive(Clone, Copy)]
pub struct GapEquations<'r> {
    /// The second time derivative of its width.
    pub opening_acceleration: Expression<'r>,
    /// The force in it, compression positive; 0 while it is open. It is an unknown of [`Recorder::accelerations`], like the
    /// accelerations of contacts that move; impacts follow from its column.
    pub force: Expression<'r>,
}

/// What the opening and the closing of a contact are decided by, as expressions or by their nodes. While the contact is apart, the
/// `normal` of its [`ContactEquations`] is the gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opening<T = NodeId> {
    /// The contact, counted from 0.
    pub contact: usize,
    /// The distance of the bodies, which depends on positions and time.
    pub gap: T,
    /// The rate of change of the gap.
    pub speed: T,
    /// The second time derivative of the gap.
    pub acceleration: T,
    /// The normal force: an unknown of the linear system of the accelerations, as is the friction force unless it is 0. Impacts
    /// follow from their columns.
    pub force: T,
    /// The friction force in these equations; contacts that share a load show other forces.
    pub friction: T,
}

/// An opening in the equations of a system.
pub type OpeningEquations<'r> = Opening<Expression<'r>>;

/// An event that resets the state, such as an impact or a kick, as expressions or by their nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Event<T = NodeId> {
    /// The event happens where this function of the state falls through zero. The reset must make it positive, or zero
    /// and rising.
    pub guard: T,
    /// The components that the event changes, with their values after it as functions of the state before it.
    pub reset: Vec<(usize, T)>,
}

/// An event in the equations of a system.
pub type EventEquations<'r> = Event<Expression<'r>>;

/// The recorded equations of a system.
#[derive(Clone, Debug, PartialEq)]
pub struct Graph {
    /// The nodes, operands first.
    pub nodes: Vec<Node>,
    /// The linear systems.
    pub solves: Vec<Solve>,
    /// The names of the inputs.
    pub inputs: Vec<String>,
    /// The inputs that are 0 or 1.
    pub switches: Vec<u32>,
    /// The inputs that do not depend on the modes of contacts and gaps.
    pub parameters: Vec<u32>,
    /// The time derivative of each component of the state.
    pub derivative: Vec<NodeId>,
    /// Sliding speed, sliding acceleration, normal force and friction force of each contact.
    pub contacts: Vec<[NodeId; 4]>,
    /// The events.
    pub events: Vec<Event>,
    /// Opening acceleration and force of each gap.
    pub gaps: Vec<[NodeId; 2]>,
    /// The contacts that open and close.
    pub openings: Vec<Opening>,
    /// The meaning of the components.
    pub layout: Layout,
    /// The nodes that depend on unknowns of linear systems and that rates and openings need, operands first.
    pub(crate) rates_with_unknowns: Vec<NodeId>,
}

impl Graph {
    fn with_rates_with_unknowns(mut self) -> Self {
        let of_opening = |one: &Opening| [one.acceleration, self.contacts[one.contact][1]];
        let rates = self.derivative.iter().copied();
        let is_needed = self.needed_by(rates.chain(self.openings.iter().flat_map(of_opening)));
        let mut nodes = self.depending_on(|node| matches!(node, Node::Solution { .. }));
        nodes.retain(|node| is_needed[*node as usize]);
        self.rates_with_unknowns = nodes;
        self
    }

    /// Returns whether each node is needed for one of these nodes.
    fn needed_by(&self, results: impl Iterator<Item = NodeId>) -> Vec<bool> {
        let mut is_needed = vec![false; self.nodes.len()];
        results.for_each(|node| is_needed[node as usize] = true);
        for place in (0..self.nodes.len()).rev() {
            if is_needed[place] {
                let operands = self.nodes[place].operands(&self.solves);
                operands.into_iter().for_each(|one| is_needed[one as usize] = true);
            }
        }
        is_needed
    }

    /// Returns the nodes that vary by themselves or depend on such nodes, operands first.
    pub fn depending_on(&self, varies: impl Fn(&Node) -> bool) -> Vec<NodeId> {
        let mut depends = vec![false; self.nodes.len()];
        for (place, node) in self.nodes.iter().enumerate() {
            depends[place] = varies(node)
                || node.operands(&self.solves).iter().any(|one| depends[*one as usize]);
        }
        (0..).zip(depends).filter(|(_, depends)| *depends).map(|(node, _)| node).collect()
    }

    /// Returns whether a contact may creep: its position, which is no angle, occurs in no equation.
    pub fn may_creep(&self, contact: &ContactLayout) -> bool {
        if contact.angular {
            return false;
        }
        let resets = self.events.iter().flat_map(|event| &event.reset).map(|(_, value)| value);
        let results = (self.derivative.iter())
            .chain(self.contacts.iter().flatten())
            .chain(self.gaps.iter().flatten())
            .chain(self.openings.iter().map(|opening| &opening.gap))
            .chain(self.events.iter().map(|event| &event.guard))
            .chain(resets);
        let is_read = self.needed_by(results.copied());
        let is_position =
            |node: &Node| matches!(node, Node::State(one) if *one as usize == contact.position);
        !self.nodes.iter().zip(is_read).any(|(node, read)| read && is_position(node))
    }

    /// Returns the recorded equations of a system.
    pub fn of(system: &dyn System) -> Arc<Self> {
        static RECORDED: PerStructure<Graph> = PerStructure::new();
        RECORDED.get(system.structure(), || {
            let recorder = Recorder::default();
            recorder.finish(&system.record(&recorder))
        })
    }

    /// Returns the component that is the sliding speed of a contact, if it is one component.
    pub fn speed_component(&self, contact: usize) -> Option<usize> {
        self.component(self.contacts[contact][0])
    }

    /// Returns whether the position of a contact moves at a rate that depends on its sliding speed alone.
    pub fn holds_position(&self, contact: usize) -> bool {
        let Some(speed) = self.held_component(contact) else { return false };
        let mut open = vec![self.derivative[self.layout.contacts[contact].position]];
        while let Some(node) = open.pop() {
            match self.nodes[node as usize] {
                Node::State(component) if component as usize != speed => return false,
                node => open.extend(node.operands(&self.solves)),
            }
        }
        true
    }

    /// Returns the component that alone determines the sliding speed of a contact, by a constant factor and a constant summand:
    /// `x'` for `x' - v_belt`. Returns `None` if the sliding speed equals the component.
    pub fn shifted_component(&self, contact: usize) -> Option<usize> {
        let mut node = self.contacts[contact][0];
        if self.component(node).is_some() {
            return None;
        }
        loop {
            node = match self.nodes[node as usize] {
                Node::State(component) => return Some(component as usize),
                Node::Negation(of) => of,
                Node::Sum(a, b) | Node::Product(a, b) | Node::Difference(a, b)
                    if self.is_constant(a) =>
                {
                    b
                }
                Node::Sum(a, b)
                | Node::Product(a, b)
                | Node::Difference(a, b)
                | Node::Quotient(a, b)
                    if self.is_constant(b) =>
                {
                    a
                }
                _ => return None,
            };
        }
    }

    /// Returns the component that keeps its value while a contact sticks.
    pub fn held_component(&self, contact: usize) -> Option<usize> {
        self.speed_component(contact).or_else(|| self.shifted_component(contact))
    }

    fn component(&self, node: NodeId) -> Option<usize> {
        match self.nodes[node as usize] {
            Node::State(component) => Some(component as usize),
            _ => None,
        }
    }

    /// Returns whether a node depends on no component of the state.
    fn is_constant(&self, node: NodeId) -> bool {
        let mut open = vec![node];
        while let Some(node) = open.pop() {
            match self.nodes[node as usize] {
                Node::State(_) | Node::Discrete(_) => return false,
                node => open.extend(node.operands(&self.solves)),
            }
        }
        true
    }
}

impl Recorder {
    /// Returns a new input with this name, which may depend on the modes of contacts and gaps.
    pub fn input(&self, name: impl Into<String>) -> Expression<'_> {
        let mut recording = self.0.borrow_mut();
        let index = recording.inputs.len() as u32;
        recording.inputs.push(name.into());
        drop(recording);
        Expression::node(self, self.add(Node::Input(index)))
    }

    /// Returns a new input that has the same value for all modes of contacts and gaps. What depends on such inputs alone is
    /// computed once for each run. A run panics if the value differs between modes: such a system is a programming error.
    pub fn parameter(&self, name: impl Into<String>) -> Expression<'_> {
        let mut recording = self.0.borrow_mut();
        let index = recording.inputs.len() as u32;
        recording.parameters.push(index);
        drop(recording);
        self.input(name)
    }

    /// Returns a new input that is 0 or 1.
    pub fn switch(&self, name: impl Into<String>) -> Expression<'_> {
        let mut recording = self.0.borrow_mut();
        let index = recording.inputs.len() as u32;
        recording.switches.push(index);
        drop(recording);
        self.input(name)
    }

    /// Returns the next component of the state. The time of a system whose equations contain it is a component with
    /// the rate of change 1.
    pub fn state(&self) -> Expression<'_> {
        self.component(Node::State)
    }

    /// Returns the next component of the state, which only events change: its rate of change is 0, and neighbouring
    /// motions have the same value.
    pub fn discrete(&self) -> Expression<'_> {
        self.component(Node::Discrete)
    }

    fn component(&self, node: fn(u32) -> Node) -> Expression<'_> {
        let mut recording = self.0.borrow_mut();
        let index = recording.states;
        recording.states += 1;
        drop(recording);
        Expression::node(self, self.add(node(index)))
    }

    /// Returns the solution `x` of the linear system `A x = b`; the matrix has one row for each component of `right`.
    ///
    /// The order of the equations and their units do not matter: each evaluation eliminates with row exchanges where a pivot
    /// is small. A matrix that is singular in some state gives values that are not finite, and the run then fails.
    ///
    /// # Panics
    /// Panics if the matrix is not square: a system with such equations is a programming error.
    pub fn solve<'r>(
        &'r self,
        matrix: &[Vec<Expression<'r>>],
        right: &[Expression<'r>],
    ) -> Vec<Expression<'r>> {
        self.unknowns(matrix, right, false)
    }

    /// Returns the accelerations `x` of coordinates, which solve the equations of motion `A x = b`. Reactions, such as the forces
    /// in gaps, may be further unknowns.
    ///
    /// Row `i` is the equation of coordinate `i`. Unknowns whose diagonal entry is the number 1 are eliminated first, without a
    /// comparison of pivots: that entry must not be small beside the other entries of the row. The other unknowns are
    /// eliminated with row exchanges, as by [`Recorder::solve`]. Of several, the first one is eliminated first.
    ///
    /// # Panics
    /// Panics if the matrix is not square: a system with such equations is a programming error.
    pub fn accelerations<'r>(
        &'r self,
        matrix: &[Vec<Expression<'r>>],
        right: &[Expression<'r>],
    ) -> Vec<Expression<'r>> {
        self.unknowns(matrix, right, true)
    }

    fn unknowns<'r>(
        &'r self,
        matrix: &[Vec<Expression<'r>>],
        right: &[Expression<'r>],
        has_sound_diagonal: bool,
    ) -> Vec<Expression<'r>> {
        let size = right.len();
        assert!(matrix.len() == size && matrix.iter().all(|row| row.len() == size), "not square");
        let ids = |all: &[Expression<'r>]| all.iter().map(|one| one.id(self)).collect::<Vec<_>>();
        let matrix = matrix.iter().flat_map(|row| ids(row)).collect();
        let solve = Solve { matrix, right: ids(right), has_sound_diagonal };
        let mut recording = self.0.borrow_mut();
        let index = recording.solves.len() as u32;
        recording.solves.push(solve);
        drop(recording);
        let rows = 0..size as u32;
        let solution = |row| self.add(Node::Solution { solve: index, row });
        rows.map(|row| Expression::node(self, solution(row))).collect()
    }

    /// Returns the graph of these equations.
    pub fn finish(&self, equations: &SystemEquations<'_>) -> Graph {
        let derivative = equations.derivative.iter().map(|one| one.id(self)).collect();
        let contact = |one: &ContactEquations<'_>| {
            [one.sliding_speed, one.sliding_acceleration, one.normal, one.friction]
                .map(|expression| expression.id(self))
        };
        let contacts = equations.contacts.iter().map(contact).collect();
        let event = |one: &EventEquations<'_>| Event {
            guard: one.guard.id(self),
            reset: one
                .reset
                .iter()
                .map(|(component, value)| (*component, value.id(self)))
                .collect(),
        };
        let events = equations.events.iter().map(event).collect();
        let gap = |one: &GapEquations<'_>| {
            [one.opening_acceleration, one.force].map(|expression| expression.id(self))
        };
        let gaps = equations.gaps.iter().map(gap).collect();
        let opening = |one: &OpeningEquations<'_>| {
            let parts = [one.gap, one.speed, one.acceleration, one.force, one.friction];
            let [gap, speed, acceleration, force, friction] = parts.map(|part| part.id(self));
            Opening { contact: one.contact, gap, speed, acceleration, force, friction }
        };
        let openings = equations.openings.iter().map(opening).collect();
        let Recording { nodes, solves, inputs, switches, parameters, .. } = &*self.0.borrow();
        Graph {
            nodes: nodes.clone(),
            solves: solves.clone(),
            inputs: inputs.clone(),
            switches: switches.clone(),
            parameters: parameters.clone(),
            derivative,
            contacts,
            events,
            gaps,
            openings,
            layout: equations.layout.clone(),
            rates_with_unknowns: Vec::new(),
        }
        .with_rates_with_unknowns()
    }

    /// Returns the number of components of the state.
    pub(in crate::model) fn components(&self) -> usize {
        self.0.borrow().states as usize
    }

    /// Returns the node of an expression.
    pub(in crate::model) fn node_of(&self, of: Expression<'_>) -> Node {
        let id = of.id(self);
        self.0.borrow().nodes[id as usize]
    }

    /// Returns the nodes up to one of them.
    pub(super) fn nodes_until(&self, last: NodeId) -> Vec<Node> {
        self.0.borrow().nodes[..=last as usize].to_vec()
    }

    /// Returns the place of a node, which is added if it is new.
    pub(super) fn add(&self, node: Node) -> NodeId {
        let mut recording = self.0.borrow_mut();
        let next = recording.nodes.len() as NodeId;
        let id = *recording.known.entry(key(node)).or_insert(next);
        if id == next {
            recording.nodes.push(node);
        }
        id
    }
}

/// Returns a key that only equal nodes share. The order of the operands of sums and products does not matter.
fn key(node: Node) -> (u8, u64, u64) {
    let two = |kind: u8, one: NodeId, other: NodeId| (kind, one.into(), other.into());
    match node {
        Node::Constant(value) => (0, value.to_bits(), 0),
        Node::Input(index) => two(1, index, 0),
        Node::State(index) => two(2, index, 0),
        Node::Discrete(index) => two(3, index, 0),
        Node::Sum(one, other) => two(4, one.min(other), one.max(other)),
        Node::Difference(one, other) => two(5, one, other),
        Node::Negation(one) => two(6, one, 0),
        Node::Product(one, other) => two(7, one.min(other), one.max(other)),
        Node::Quotient(one, other) => two(8, one, other),
        Node::Sine(one) => two(9, one, 0),
        Node::Cosine(one) => two(10, one, 0),
        Node::SquareRoot(one) => two(11, one, 0),
        Node::Exponential(one) => two(12, one, 0),
        Node::Function(function, one, other) => two(20 + function as u8, one, other),
        Node::Solution { solve, row } => two(14, solve, row),
    }
}
