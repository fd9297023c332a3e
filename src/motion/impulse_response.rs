//! How velocities answer to impulses in gaps and at openings, derived from the recorded equations.
//!
//! Forces during an impact are so large that all others, friction of the supports among them, are negligible beside them.
//! The accelerations are then the velocities' changes per unit of impulse. In the linear equations `A x = b` of the
//! accelerations, with contacts that slip without friction, a unit of the force in a gap contributes its column of `A` with
//! the opposite sign to the right side.
//!
//! The friction force of a gap retards both bodies ([`crate::model::Gap::lever`]). The contact force pushes the same two
//! bodies apart, so that the contribution of friction follows from that of the contact force. The friction of a contact
//! that opens is an unknown of its own, with a column of its own.

use smallvec::{SmallVec, smallvec};

use super::Evaluator;
use super::linear_system::{Entries, Solved, Unknowns, solve_for_each};
use crate::model::{ContactMode, Node, NodeId, Opening, Solve};

/// A place where bodies hit each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImpactPlace {
    /// A gap between two contacts, by its number.
    Gap(usize),
    /// A contact that opens, by the number of the opening.
    Opening(usize),
}

/// The change of a state by a unit of impulse.
#[derive(Clone, Debug)]
pub struct ImpulseResponse<T> {
    /// Of each component.
    pub components: Vec<T>,
    /// Of the opening speed and the sliding speed of each opening.
    pub openings: SmallVec<[[T; 2]; 4]>,
}

impl Evaluator {
    /// Returns the responses to a unit of the contact impulse and to one of the friction impulse at each of some places.
    ///
    /// # Panics
    /// Panics if a force there is no unknown of a linear system: a system with such equations is a programming error.
    pub fn responses<T: Solved>(
        &self,
        state: &[T],
        places: &[ImpactPlace],
    ) -> Vec<ImpulseResponse<T>> {
        let graph = self.graph();
        let gaps = self.system().touching().map_or(&[][..], |system| system.gaps());
        // Contacts that set off in no direction have no friction.
        let mut modes: SmallVec<[ContactMode; 16]> =
            smallvec![ContactMode::BreakingAway(0.0); graph.contacts.len()];
        graph.openings.iter().for_each(|site| modes[site.contact] = ContactMode::Apart);
        modes.resize(modes.len() + graph.gaps.len(), ContactMode::Open);
        let inputs = self.system().inputs(&modes);
        let values = self.values_with(&inputs, false, |component| state[component]);
        let unknown = |node: NodeId| match graph.nodes[node as usize] {
            Node::Solution { solve, row } => Some((solve, row as usize)),
            _ => None,
        };
        // There is no other force at any of the places.
        let in_gaps = graph.gaps.iter().map(|[_, force]| *force);
        let at_openings = graph.openings.iter().flat_map(|site| [site.force, site.friction]);
        let forces: SmallVec<[usize; 8]> =
            in_gaps.chain(at_openings).filter_map(unknown).map(|(_, row)| row).collect();
        let zero = T::constant(0.0);
        let mut pushes: Vec<UnitImpulse<T>> = Vec::new();
        for place in places {
            let force = match *place {
                ImpactPlace::Gap(gap) => graph.gaps[gap][1],
                ImpactPlace::Opening(opening) => graph.openings[opening].force,
            };
            let (solve, column) = unknown(force).expect("a force that is an unknown");
            let Solve { matrix, right, .. } = &graph.solves[solve as usize];
            let push =
                |row: usize, column: usize| -values[matrix[row * right.len() + column] as usize];
            let rows = || (0..right.len()).filter(|row| !forces.contains(row));
            let by_contact = rows().map(|row| push(row, column)).collect();
            let by_friction = match *place {
                ImpactPlace::Gap(gap) => {
                    // A body whose acceleration is no unknown does not move.
                    let contact = |side: usize| unknown(graph.contacts[side][1]);
                    let sides = gaps[gap].contacts.map(|side| contact(side).map(|(_, row)| row));
                    let lever = T::constant(gaps[gap].lever);
                    let retards = |row| match sides.map(|side| side == Some(row)) {
                        [true, _] => lever * push(row, column),
                        [_, true] => -lever * push(row, column),
                        _ => zero,
                    };
                    rows().map(retards).collect()
                }
                ImpactPlace::Opening(opening) => match unknown(graph.openings[opening].friction) {
                    Some((_, column)) => rows().map(|row| push(row, column)).collect(),
                    None => rows().map(|_| zero).collect(),
                },
            };
            pushes.push(UnitImpulse { solve, force: (column, 1.0), rates: by_contact });
            pushes.push(UnitImpulse { solve, force: (column, 0.0), rates: by_friction });
        }
        let mut changes = vec![zero; graph.nodes.len()];
        let mut responses = Vec::with_capacity(pushes.len());
        for of_solve in pushes.chunk_by_mut(|push, next| push.solve == next.solve) {
            let solve = of_solve[0].solve;
            let Solve { matrix, right, .. } = &graph.solves[solve as usize];
            let rows: SmallVec<[usize; 16]> =
                (0..right.len()).filter(|row| !forces.contains(row)).collect();
            let entry =
                |row: usize, column: usize| values[matrix[row * right.len() + column] as usize];
            let entries: Entries<T> = rows
                .iter()
                .flat_map(|row| rows.iter().map(|column| entry(*row, *column)))
                .collect();
            let rights = of_solve.iter_mut().map(|push| &mut push.rates).collect();
            solve_for_each(entries, rights, rows.len());
            for UnitImpulse { force: (column, of_force), rates, .. } in of_solve {
                let of_row = |row: u32| {
                    if row as usize == *column {
                        return T::constant(*of_force);
                    }
                    let place = rows.iter().position(|kept| *kept == row as usize);
                    place.map_or(zero, |place| rates[place])
                };
                responses.push(self.response(&values, &mut changes, |node| match *node {
                    Node::Solution { solve: index, row } if index == solve => of_row(row),
                    _ => zero,
                }));
            }
        }
        responses
    }

    /// Returns the change of all rates with unknowns, in which the rates are linear, from the values of all nodes; `changed`
    /// returns the change of an unknown. `changes` has a place for the change of each node. The caller provides zeros.
    fn response<T: Solved>(
        &self,
        values: &[T],
        changes: &mut [T],
        changed: impl Fn(&Node) -> T,
    ) -> ImpulseResponse<T> {
        let graph = self.graph();
        for &place in &graph.rates_with_unknowns {
            let node = &graph.nodes[place as usize];
            let change = |node: NodeId| changes[node as usize];
            let value = |node: NodeId| values[node as usize];
            let of = match *node {
                Node::Sum(a, b) => change(a) + change(b),
                Node::Difference(a, b) => change(a) - change(b),
                Node::Negation(a) => -change(a),
                Node::Product(a, b) => change(a) * value(b) + change(b) * value(a),
                Node::Quotient(a, b) if !change(a).is_zero() => change(a) * value(b).reciprocal(),
                Node::Solution { .. } => changed(node),
                _ => T::constant(0.0),
            };
            changes[place as usize] = of;
        }
        let change = |node: NodeId| changes[node as usize];
        let opening =
            |site: &Opening| [site.acceleration, graph.contacts[site.contact][1]].map(change);
        ImpulseResponse {
            components: graph.derivative.iter().map(|node| change(*node)).collect(),
            openings: graph.openings.iter().map(opening).collect(),
        }
    }
}

/// A unit of an impulse.
struct UnitImpulse<T> {
    /// The linear system of the accelerations.
    solve: u32,
    /// The row of the force in this system, and the change of the force.
    force: (usize, f64),
    /// The right side of the equations of all accelerations, and then their solution.
    rates: Unknowns<T>,
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use crate::model::{
        Balancer, Ball, BallContact, BallsInContact, Dual, Machine, System, Touching,
    };
    use crate::motion::Evaluator;
    use crate::motion::impulse_response::ImpactPlace;

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
            evaluator.responses(&moved, &[0, 1, 2].map(ImpactPlace::Gap))
        };
        let size = 1e-6;
        let [here, less, more] = [0.0, -size, size].map(responses);
        for (place, gap) in Touching::gaps(&system).iter().enumerate() {
            for (way, pushes) in gap.pushes().into_iter().enumerate() {
                let response: Vec<f64> =
                    here[2 * place + way].components.iter().map(|change| change.value).collect();
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
                for (component, change) in here[2 * place + way].components.iter().enumerate() {
                    let [less, more] =
                        [&less, &more].map(|of| of[2 * place + way].components[component].value);
                    let slope = (more - less) / (2.0 * size);
                    assert!(
                        (change.slope - slope).abs() < 1e-5 * (1.0 + slope.abs()),
                        "{component}: {} {slope}",
                        change.slope
                    );
                }
            }
        }
    }
}
