//! Power series in time of every expression of a recorded system, order by order: Taylor's method.
//!
//! Each node has a rule that gives its coefficient of order `k` from the coefficients of its operands up to `k` and its
//! own below `k` (Å. Jorba, M. Zou, Exp. Math. 14 (2005) 99, doi:10.1080/10586458.2005.10128904). With dual numbers the
//! same rules give the series and their derivatives along a displacement. A linear system is factored once per
//! expansion, because its matrix enters every order with its coefficient of order zero.

use crate::model::{Elementary, Graph, Node, NodeId, Solve};

/// The orders `j` of a sum over products of coefficients.
type Orders = std::ops::RangeInclusive<usize>;

/// The power series of all nodes of a graph.
pub struct Expansion<'g, T> {
    graph: &'g Graph,
    order: usize,
    /// Coefficients 0 to `order` of each node.
    terms: Vec<T>,
    /// Coefficients 0 to `order` of each component of the state.
    state: Vec<T>,
}

impl<'g, T: Elementary> Expansion<'g, T> {
    /// Expands a recorded system up to an order, from the values of its inputs and its state at a time. Missing
    /// values are 0. `None` if a linear system is singular.
    pub fn new(graph: &'g Graph, order: usize, inputs: &[T], state: &[T], time: T) -> Option<Self> {
        let length = order + 1;
        let zero = T::constant(0.0);
        let mut expansion = Expansion {
            graph,
            order,
            terms: vec![zero; graph.nodes.len() * length],
            state: vec![zero; state.len().max(graph.derivative.len()) * length],
        };
        for (component, value) in state.iter().enumerate() {
            expansion.state[component * length] = *value;
        }
        let mut solvers: Vec<Option<Solver<T>>> = graph.solves.iter().map(|_| None).collect();
        for k in 0..=order {
            let mut solutions: Vec<Vec<T>> = vec![Vec::new(); graph.solves.len()];
            for (place, node) in graph.nodes.iter().enumerate() {
                let term = match *node {
                    Node::Solution { solve, row } => {
                        let (solve, row) = (solve as usize, row as usize);
                        if solutions[solve].is_empty() {
                            solutions[solve] = expansion.solve(solve, k, &mut solvers[solve])?;
                        }
                        solutions[solve][row]
                    }
                    node => expansion.term(place as NodeId, node, k, inputs, time),
                };
                expansion.terms[place * length + k] = term;
            }
            if k < order {
                let next = T::constant(1.0 / (k + 1) as f64);
                for (component, slope) in graph.derivative.iter().enumerate() {
                    expansion.state[component * length + k + 1] = expansion.at(*slope, k) * next;
                }
            }
        }
        Some(expansion)
    }

    /// Returns the coefficients of a node, from order zero.
    pub fn series(&self, node: NodeId) -> &[T] {
        let from = node as usize * (self.order + 1);
        &self.terms[from..=from + self.order]
    }

    /// Returns the coefficients of a component of the state, from order zero.
    pub fn state(&self, component: usize) -> &[T] {
        let from = component * (self.order + 1);
        &self.state[from..=from + self.order]
    }

    fn at(&self, node: NodeId, k: usize) -> T {
        self.terms[node as usize * (self.order + 1) + k]
    }

    /// Returns the coefficient of order `k` of a node.
    fn term(&self, place: NodeId, node: Node, k: usize, inputs: &[T], time: T) -> T {
        let zero = T::constant(0.0);
        let constant = |value: T| if k == 0 { value } else { zero };
        match node {
            Node::Constant(value) => constant(T::constant(value)),
            Node::Input(index) => constant(inputs.get(index as usize).copied().unwrap_or(zero)),
            Node::Time => match k {
                0 => time,
                1 => T::constant(1.0),
                _ => zero,
            },
            Node::State(component) => {
                let place = component as usize * (self.order + 1) + k;
                self.state.get(place).copied().unwrap_or(zero)
            }
            Node::Sum(one, other) => self.at(one, k) + self.at(other, k),
            Node::Difference(one, other) => self.at(one, k) - self.at(other, k),
            Node::Negation(one) => -self.at(one, k),
            Node::Product(one, other) => self.convolution(one, other, 0..=k, k),
            Node::Quotient(one, other) => {
                let known = self.convolution(place, other, 0..=k.saturating_sub(1), k);
                let known = if k == 0 { zero } else { known };
                (self.at(one, k) - known) * self.at(other, 0).reciprocal()
            }
            Node::Sine(angle) if k == 0 => self.at(angle, 0).sin_cos().0,
            Node::Cosine(angle) if k == 0 => self.at(angle, 0).sin_cos().1,
            Node::Sine(angle) => self.weighted(angle, place + 1, 1..=k, k),
            Node::Cosine(angle) => -self.weighted(angle, place - 1, 1..=k, k),
            Node::SquareRoot(one) if k == 0 => self.at(one, 0).sqrt(),
            Node::SquareRoot(one) => {
                let known = self.convolution(place, place, 1..=k - 1, k);
                (self.at(one, k) - known) * (self.at(place, 0) + self.at(place, 0)).reciprocal()
            }
            Node::Exponential(one) if k == 0 => self.at(one, 0).exp(),
            Node::Exponential(one) => self.weighted(one, place, 1..=k, k),
            Node::ArcTangent(one, _) if k == 0 => self.at(one, 0).atan(),
            Node::ArcTangent(one, slope) => {
                let known = self.weighted(place, slope, 1..=k - 1, k);
                (self.at(one, k) - known) * self.at(slope, 0).reciprocal()
            }
            // Solutions are computed together.
            Node::Solution { .. } => zero,
        }
    }

    /// Returns the sum of `one_j other_(k-j)` over `j`.
    fn convolution(&self, one: NodeId, other: NodeId, orders: Orders, k: usize) -> T {
        self.sum(one, other, orders, k, |_, product| product)
    }

    /// Returns the sum of `j/k one_j other_(k-j)` over `j`: a coefficient of the integral of `one' other`.
    fn weighted(&self, one: NodeId, other: NodeId, orders: Orders, k: usize) -> T {
        let weight = |j: usize, product: T| T::constant(j as f64 / k as f64) * product;
        self.sum(one, other, orders, k, weight)
    }

    fn sum(
        &self,
        one: NodeId,
        other: NodeId,
        orders: Orders,
        k: usize,
        term: impl Fn(usize, T) -> T,
    ) -> T {
        let (one, other) = (self.series(one), self.series(other));
        orders.fold(T::constant(0.0), |sum, j| sum + term(j, one[j] * other[k - j]))
    }

    /// Returns the coefficients of order `k` of the solution of a linear system, which is factored at order zero. `None`
    /// if it is singular.
    fn solve(&self, index: usize, k: usize, solver: &mut Option<Solver<T>>) -> Option<Vec<T>> {
        let Solve { matrix, right } = &self.graph.solves[index];
        let size = right.len();
        if k == 0 {
            *solver = Solver::new(matrix.iter().map(|&node| self.at(node, 0)).collect(), size);
        }
        let earlier = |row: usize, k: usize| {
            let column = |column: usize| {
                let solution = self.solution(index, column);
                self.convolution(matrix[row * size + column], solution, 1..=k, k)
            };
            (0..size).map(column).fold(T::constant(0.0), |sum, one| sum + one)
        };
        let right = (0..size).map(|row| {
            let known = if k == 0 { T::constant(0.0) } else { earlier(row, k) };
            self.at(right[row], k) - known
        });
        Some(solver.as_ref()?.solve(right.collect()))
    }

    /// Returns the node of a component of the solution of a linear system.
    fn solution(&self, index: usize, component: usize) -> NodeId {
        let is_it = |node: &Node| {
            matches!(*node, Node::Solution { solve, row }
                if solve as usize == index && row as usize == component)
        };
        // The recorder adds one node for each component.
        self.graph.nodes.iter().position(is_it).unwrap_or(0) as NodeId
    }
}

/// The factors `L U` of a matrix with its rows exchanged.
struct Solver<T> {
    size: usize,
    factors: Vec<T>,
    rows: Vec<usize>,
}

impl<T: Elementary> Solver<T> {
    /// Factors a matrix with partial pivoting; `None` if it is singular.
    fn new(mut factors: Vec<T>, size: usize) -> Option<Self> {
        let mut rows: Vec<usize> = (0..size).collect();
        for column in 0..size {
            let magnitude = |row: &usize| factors[*row * size + column].value().abs();
            let pivot = (column..size).max_by(|a, b| magnitude(a).total_cmp(&magnitude(b)))?;
            if magnitude(&pivot) == 0.0 || !magnitude(&pivot).is_finite() {
                return None;
            }
            rows.swap(column, pivot);
            (0..size).for_each(|j| factors.swap(column * size + j, pivot * size + j));
            let inverse = factors[column * size + column].reciprocal();
            for row in column + 1..size {
                let factor = factors[row * size + column] * inverse;
                factors[row * size + column] = factor;
                for j in column + 1..size {
                    let change = factor * factors[column * size + j];
                    factors[row * size + j] = factors[row * size + j] - change;
                }
            }
        }
        Some(Solver { size, factors, rows })
    }

    fn solve(&self, right: Vec<T>) -> Vec<T> {
        let size = self.size;
        let mut solution: Vec<T> = self.rows.iter().map(|&row| right[row]).collect();
        for row in 0..size {
            for column in 0..row {
                let known = self.factors[row * size + column] * solution[column];
                solution[row] = solution[row] - known;
            }
        }
        for row in (0..size).rev() {
            for column in row + 1..size {
                let known = self.factors[row * size + column] * solution[column];
                solution[row] = solution[row] - known;
            }
            solution[row] = solution[row] * self.factors[row * size + row].reciprocal();
        }
        solution
    }
}
