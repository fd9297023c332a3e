//! The quantities that a system records: inputs, components of the state, and the unknowns of linear systems.

use super::{Expression, Node, NodeId, Recorder, Solve};

impl Recorder {
    /// Returns a new input with this name, which may depend on the modes of contacts and gaps.
    pub fn input(&self, name: impl Into<String>) -> Expression<'_> {
        let index = self.0.borrow().inputs.len() as u32;
        self.0.borrow_mut().inputs.push(name.into());
        Expression::node(self, self.add(Node::Input(index)))
    }

    /// Returns a new input that has the same value for all modes of contacts and gaps. What depends on such inputs alone is
    /// computed once for each run. A run panics if the value differs between modes: such a system is a programming error.
    pub fn parameter(&self, name: impl Into<String>) -> Expression<'_> {
        let index = self.0.borrow().inputs.len() as u32;
        self.0.borrow_mut().parameters.push(index);
        self.input(name)
    }

    /// Returns a new input that is 0 or 1.
    pub fn switch(&self, name: impl Into<String>) -> Expression<'_> {
        let index = self.0.borrow().inputs.len() as u32;
        self.0.borrow_mut().switches.push(index);
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
        let index = self.0.borrow().states;
        self.0.borrow_mut().states += 1;
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
        self.unknowns(matrix, right, (false, right.len()))
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
        self.unknowns(matrix, right, (true, right.len()))
    }

    /// Returns unknowns as [`Recorder::accelerations`] does, if the matrix has a sound diagonal, and otherwise as [`Recorder::solve`]
    /// does. The equations determine the first of them; the others are 0 where dependent equations leave them open.
    pub(in crate::model) fn unknowns<'r>(
        &'r self,
        matrix: &[Vec<Expression<'r>>],
        right: &[Expression<'r>],
        (has_sound_diagonal, determined): (bool, usize),
    ) -> Vec<Expression<'r>> {
        let size = right.len();
        assert!(matrix.len() == size && matrix.iter().all(|row| row.len() == size), "not square");
        let ids = |all: &[Expression<'r>]| all.iter().map(|part| part.id(self)).collect::<Vec<_>>();
        let matrix = matrix.iter().flat_map(|row| ids(row)).collect();
        let solve = Solve { matrix, right: ids(right), has_sound_diagonal, determined };
        let index = self.0.borrow().solves.len() as u32;
        self.0.borrow_mut().solves.push(solve);
        let rows = 0..size as u32;
        let solution = |row| self.add(Node::Solution { solve: index, row });
        rows.map(|row| Expression::node(self, solution(row))).collect()
    }

    /// Returns the number of components of the state.
    pub(in crate::model) fn components(&self) -> usize {
        self.0.borrow().states as usize
    }

    /// Returns the node of an expression.
    pub(in crate::model) fn node_of(&self, of: Expression<'_>) -> Node {
        self.node(of.id(self))
    }

    /// Returns a node.
    pub(super) fn node(&self, id: NodeId) -> Node {
        self.0.borrow().nodes[id as usize]
    }
}
