//! The recorded equations of a system: a graph whose nodes each stand behind their operands.

use super::part::needed_by;
use super::recorder::Recording;
use super::{
    ContactEquations, Event, EventEquations, GapEquations, GraphPart, Node, NodeId, Opening,
    OpeningEquations, Recorder, Solve, StateLayout, SystemEquations, Translations,
};

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
    pub layout: StateLayout,
    /// The nodes that depend on unknowns of linear systems and that rates and openings need, operands first.
    pub(crate) rates_with_unknowns: Vec<NodeId>,
    /// The translations that no equation notices, whatever the parameters are, with examples of their factors.
    translations: Translations,
    /// The sliding speed of each contact.
    pub(crate) sliding_speeds: GraphPart,
    /// The gap, the opening speed and the sliding speed of each opening, one after another.
    pub(crate) opening_speeds: GraphPart,
}

impl Graph {
    fn with_parts(mut self) -> Self {
        let speed_of = |contact: usize| self.contacts[contact][0];
        let of_opening = |site: &Opening| [site.gap, site.speed, speed_of(site.contact)];
        self.opening_speeds = self.part(self.openings.iter().flat_map(of_opening).collect());
        self.sliding_speeds = self.part((0..self.contacts.len()).map(speed_of).collect());
        let of_opening = |site: &Opening| [site.acceleration, self.contacts[site.contact][1]];
        let rates = self.derivative.iter().copied();
        let is_needed = self.needed_by(rates.chain(self.openings.iter().flat_map(of_opening)));
        let mut nodes = self.depending_on(|node| matches!(node, Node::Solution { .. }));
        nodes.retain(|node| is_needed[*node as usize]);
        self.rates_with_unknowns = nodes;
        self.translations = self.find_translations(None);
        self
    }

    /// Returns the part that these nodes need.
    pub(crate) fn part(&self, results: Vec<NodeId>) -> GraphPart {
        GraphPart::of(&self.nodes, &self.solves, results)
    }

    pub(super) fn needed_by(&self, results: impl Iterator<Item = NodeId>) -> Vec<bool> {
        needed_by(&self.nodes, &self.solves, results)
    }

    /// Returns the nodes that vary by themselves or depend on such nodes, operands first.
    pub fn depending_on(&self, varies: impl Fn(&Node) -> bool) -> Vec<NodeId> {
        let mut depends = vec![false; self.nodes.len()];
        for (place, node) in self.nodes.iter().enumerate() {
            depends[place] = varies(node)
                || node.operands(&self.solves).iter().any(|operand| depends[*operand as usize]);
        }
        (0..).zip(depends).filter(|(_, depends)| *depends).map(|(node, _)| node).collect()
    }

    /// Returns the translations that no equation notices at these values of the inputs.
    pub(crate) fn translations(&self, inputs: impl FnOnce() -> Vec<f64>) -> Translations {
        let has_factors = self.translations.0.iter().any(|one| !one.others.is_empty());
        match has_factors {
            true => self.find_translations(Some(&inputs())),
            false => self.translations.clone(),
        }
    }

    /// Returns whether a translation that no equation notices, whatever the parameters are, displaces a component.
    pub(crate) fn translates(&self, component: usize) -> bool {
        self.translations.displace(component)
    }

    /// Returns whether there is such a translation.
    pub(crate) fn has_translations(&self) -> bool {
        self.translations != Translations::default()
    }

    /// Returns the component that is the sliding speed of a contact, if it is one component.
    pub fn speed_component(&self, contact: usize) -> Option<usize> {
        self.component(self.contacts[contact][0])
    }

    /// Returns whether the equations determine all forces.
    pub(crate) fn determines_all_forces(&self) -> bool {
        self.solves.iter().all(|solve| solve.determined == solve.right.len())
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
        self.only_component(contact, &[])
    }

    /// Returns the component that determines the sliding speed of a contact together with the phase of the forcing, and alone the
    /// rate of its position: `x'` for `x' - v cos(w t)`. While the contact sticks, the phase determines this component.
    pub fn driven_component(&self, contact: usize) -> Option<usize> {
        let phase = self.layout.forcing?.component;
        let position = self.derivative[self.layout.contacts[contact].position];
        let driven = self.only_component(contact, &[phase])?;
        self.depends_at_most_on(position, &[driven]).then_some(driven)
    }

    /// Returns the component that determines the sliding speed of a contact by a constant factor and a summand that depends on no
    /// other components than `beside`.
    fn only_component(&self, contact: usize, beside: &[usize]) -> Option<usize> {
        let mut node = self.contacts[contact][0];
        if self.component(node).is_some() {
            return None;
        }
        loop {
            node = match self.nodes[node as usize] {
                Node::State(component) => return Some(component as usize),
                Node::Negation(of) => of,
                Node::Sum(a, b) | Node::Difference(a, b) if self.depends_at_most_on(a, beside) => b,
                Node::Sum(a, b) | Node::Difference(a, b) if self.depends_at_most_on(b, beside) => a,
                Node::Product(a, b) if self.depends_at_most_on(a, &[]) => b,
                Node::Product(a, b) | Node::Quotient(a, b) if self.depends_at_most_on(b, &[]) => a,
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

    /// Returns the component that alone determines the rate of change of another one, as a velocity does.
    pub(crate) fn only_rate(&self, component: usize) -> Option<usize> {
        let rate = self.derivative[component];
        let mut velocities = self.layout.velocities.iter().flatten().copied();
        velocities.find(|one| !self.is_clock(component) && self.depends_at_most_on(rate, &[*one]))
    }

    /// Returns whether a component grows at a constant rate, as the time does.
    pub(crate) fn is_clock(&self, component: usize) -> bool {
        self.depends_at_most_on(self.derivative[component], &[])
    }

    /// Returns whether a node depends on no other components of the state than these.
    fn depends_at_most_on(&self, node: NodeId, these: &[usize]) -> bool {
        let mut open = vec![node];
        while let Some(node) = open.pop() {
            match self.nodes[node as usize] {
                Node::State(component) if these.contains(&(component as usize)) => {}
                Node::State(_) | Node::Discrete(_) => return false,
                node => open.extend(node.operands(&self.solves)),
            }
        }
        true
    }
}

impl Recorder {
    /// Returns the graph of these equations.
    pub fn finish(&self, equations: &SystemEquations<'_>) -> Graph {
        let derivative = equations.derivative.iter().map(|rate| rate.id(self)).collect();
        let contact = |contact: &ContactEquations<'_>| {
            [contact.sliding_speed, contact.sliding_acceleration, contact.normal, contact.friction]
                .map(|expression| expression.id(self))
        };
        let contacts = equations.contacts.iter().map(contact).collect();
        let event = |event: &EventEquations<'_>| Event {
            guard: event.guard.id(self),
            reset: event
                .reset
                .iter()
                .map(|(component, value)| (*component, value.id(self)))
                .collect(),
        };
        let events = equations.events.iter().map(event).collect();
        let gap = |gap: &GapEquations<'_>| {
            [gap.opening_acceleration, gap.force].map(|expression| expression.id(self))
        };
        let gaps = equations.gaps.iter().map(gap).collect();
        let opening = |site: &OpeningEquations<'_>| {
            let parts = [site.gap, site.speed, site.acceleration, site.force, site.friction];
            let [gap, speed, acceleration, force, friction] = parts.map(|part| part.id(self));
            Opening { contact: site.contact, gap, speed, acceleration, force, friction }
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
            translations: Translations::default(),
            sliding_speeds: GraphPart::default(),
            opening_speeds: GraphPart::default(),
        }
        .with_parts()
    }
}
