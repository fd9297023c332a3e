//! How velocities answer to impulses in gaps, derived from the recorded equations.
//!
//! Forces during an impact are so large that all others, friction of the supports among them, are negligible beside them.
//! The accelerations are then the velocities' changes per unit of impulse. In the linear equations `A x = b` of the
//! accelerations, with contacts that slip without friction, a unit of the force in a gap contributes its column of `A` with
//! the opposite sign to the right side.
//!
//! The friction force of a gap retards both bodies ([`Gap::lever`]). The contact force pushes the same two bodies apart, so
//! that the contribution of friction follows from that of the contact force.

use smallvec::{SmallVec, smallvec};

use super::Evaluator;
use super::evaluator::{Entries, Unknowns, solved};
use crate::model::{ContactMode, Dual, Elementary, Gap, Node, NodeId, Number, Solve};

/// The change of each component of the state by a unit of impulse.
pub type Response = Vec<Dual>;

impl Evaluator {
    /// Returns for each of some gaps, by their numbers, the responses to a unit of its contact impulse and of its friction impulse.
    ///
    /// # Panics
    /// Panics if the force in a gap is no unknown of [`crate::model::Recorder::accelerations`]: a system with such equations is
    /// a programming error.
    pub fn responses(&self, state: &[Dual], touching: &[usize]) -> Vec<[Response; 2]> {
        let graph = self.graph();
        let gaps = self.system().touching().map_or(&[][..], |system| system.gaps());
        // Contacts that set off in no direction have no friction.
        let mut modes: SmallVec<[ContactMode; 16]> =
            smallvec![ContactMode::SetOff(0.0); graph.contacts.len()];
        modes.resize(modes.len() + graph.gaps.len(), ContactMode::Open);
        let inputs = self.system().inputs(&modes);
        let values = self.values_with::<Dual>(&inputs, false, |component| state[component]);
        let unknown = |node: NodeId| match graph.nodes[node as usize] {
            Node::Solution { solve, row } => (solve, row as usize),
            _ => panic!("a gap needs a force that is an unknown"),
        };
        let forces: SmallVec<[usize; 8]> =
            graph.gaps.iter().map(|[_, force]| unknown(*force).1).collect();
        let respond = |gap: &Gap, force: NodeId| {
            let (solve, column) = unknown(force);
            let Solve { matrix, right, .. } = &graph.solves[solve as usize];
            let entry =
                |row: usize, column: usize| values[matrix[row * right.len() + column] as usize];
            // There is no force in the other gaps.
            let rows: SmallVec<[usize; 16]> =
                (0..right.len()).filter(|row| !forces.contains(row)).collect();
            let entries: Entries<Dual> = rows
                .iter()
                .flat_map(|row| rows.iter().map(|column| entry(*row, *column)))
                .collect();
            // A body whose acceleration is no unknown does not move.
            let sides = gap.contacts.map(|contact| {
                match graph.nodes[graph.contacts[contact][1] as usize] {
                    Node::Solution { row, .. } => Some(row as usize),
                    _ => None,
                }
            });
            let push = |row: usize| -entry(row, column);
            let retard = |row: usize| match sides.map(|side| side == Some(row)) {
                [true, _] => Dual::constant(gap.lever) * push(row),
                [_, true] => Dual::constant(-gap.lever) * push(row),
                _ => Dual::constant(0.0),
            };
            let answer = |of_force: f64, contribution: &dyn Fn(usize) -> Dual| {
                let right: Unknowns<Dual> = rows.iter().map(|row| contribution(*row)).collect();
                let accelerations = solved(entries.clone(), right);
                let of_row = |row: u32| {
                    if row as usize == column {
                        return Some(Dual::constant(of_force));
                    }
                    let place = rows.iter().position(|one| *one == row as usize)?;
                    Some(accelerations[place])
                };
                self.change_of_rates(&values, |node| match *node {
                    Node::Solution { solve: own, row } if own == solve => of_row(row),
                    _ => None,
                })
            };
            [answer(1.0, &push), answer(0.0, &retard)]
        };
        touching.iter().map(|gap| respond(&gaps[*gap], graph.gaps[*gap][1])).collect()
    }

    /// Returns the change of the rate of each component with unknowns, in which the rates are linear, from the values of all
    /// other nodes; `changed` returns the change of an unknown.
    fn change_of_rates(
        &self,
        values: &[Dual],
        changed: impl Fn(&Node) -> Option<Dual>,
    ) -> Response {
        let graph = self.graph();
        let zero = Dual::constant(0.0);
        let mut changes = vec![zero; graph.nodes.len()];
        for (place, node) in graph.nodes.iter().enumerate() {
            let change = |node: NodeId| changes[node as usize];
            let value = |node: NodeId| values[node as usize];
            let of = match *node {
                Node::Sum(one, other) => change(one) + change(other),
                Node::Difference(one, other) => change(one) - change(other),
                Node::Negation(one) => -change(one),
                Node::Product(one, other) => {
                    change(one) * value(other) + change(other) * value(one)
                }
                Node::Quotient(one, other) if !change(one).is_zero() => {
                    change(one) * value(other).reciprocal()
                }
                Node::Solution { .. } => changed(node).unwrap_or(zero),
                _ => zero,
            };
            changes[place] = of;
        }
        graph.derivative.iter().map(|node| changes[*node as usize]).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use crate::model::{
        Balancer, Ball, BallContact, BallsInContact, Dual, Machine, System, Touching,
    };
    use crate::motion::Evaluator;

    /// The equations of motion, integrated over an impact: `Σ_j A_ij Δβ̇_j` is the tangential impulse over the mass of ball
    /// `i` with `A_ij = (1 + 4J) δ_ij - m_j cos(β_i - β_j)`, and `Δẋ = Σ m s Δβ̇`, `Δẏ = -Σ m c Δβ̇`. The slopes are those of
    /// central differences.
    #[test]
    fn responses_solve_the_equations_of_an_impact() {
        let contact = BallContact::default();
        let balls = [2e-4, 1.4e-4, 5e-4].map(|mass_kg| Ball { mass_kg, ..Ball::default() });
        let machine = Machine {
            balls: balls.to_vec(),
            contact: Some(contact),
            ring_runout_m: 1e-4,
            ..Machine::default()
        };
        let state = [0.01, 0.02, 0.3, -0.2, 0.7, 1.0, 4.0, 0.1, -0.2, 0.3];
        let direction = [0.3, 0.1, 0.2, 0.5, 0.9, -0.4, 0.6, 0.2, -0.8, 0.1];
        let system = BallsInContact::<3>::new(&machine, &contact, &state[4..7]).expect("3 balls");
        let Balancer { balls, .. } = system.balancer;
        let evaluator = Evaluator::new(Arc::new(system.clone()) as Arc<dyn System>);
        let responses = |size: f64| {
            let component =
                |(value, slope): (&f64, &f64)| Dual { value: value + size * slope, slope: *slope };
            let moved: Vec<Dual> = state.iter().zip(&direction).map(component).collect();
            evaluator.responses(&moved, &[0, 1, 2])
        };
        let size = 1e-6;
        let [here, less, more] = [0.0, -size, size].map(responses);
        for (place, gap) in Touching::gaps(&system).iter().enumerate() {
            for (way, pushes) in gap.pushes().into_iter().enumerate() {
                let response: Vec<f64> = here[place][way].iter().map(|one| one.value).collect();
                let speeds = &response[7..];
                for (i, ball) in balls.iter().enumerate() {
                    let along: f64 = gap
                        .contacts
                        .into_iter()
                        .zip(pushes)
                        .filter(|(contact, _)| *contact == i)
                        .map(|(_, push)| push[0])
                        .sum();
                    let coupled = (0..3)
                        .map(|j| balls[j].mass * (state[4 + i] - state[4 + j]).cos() * speeds[j]);
                    let found = speeds[i] / ball.mobility - coupled.sum::<f64>();
                    assert!(
                        (found - along).abs() < 1e-12 * gap.pushes()[0][0][0].abs(),
                        "{found} {along}"
                    );
                }
                let sum = |turned: fn(f64) -> f64| -> f64 {
                    (0..3).map(|j| balls[j].mass * turned(state[4 + j]) * speeds[j]).sum()
                };
                assert!((response[2] - sum(f64::sin)).abs() < 1e-12);
                assert!((response[3] + sum(f64::cos)).abs() < 1e-12);
                for (component, one) in here[place][way].iter().enumerate() {
                    let [less, more] = [&less, &more].map(|of| of[place][way][component].value);
                    let slope = (more - less) / (2.0 * size);
                    assert!(
                        (one.slope - slope).abs() < 1e-5 * (1.0 + slope.abs()),
                        "{component}: {} {slope}",
                        one.slope
                    );
                }
            }
        }
    }
}
