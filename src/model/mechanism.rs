//! Equations of motion from a mass matrix, forces and contacts.
//!
//! A mechanism has coordinates `q` with the equations of motion
//!
//! ```text
//! M q̈ = h + Σ (w_N λ_N - w_T λ_T)
//! ```
//!
//! with a normal force `λ_N ≥ 0` and a friction force `λ_T` in each contact. The directions `w_N` and `w_T` are the
//! derivatives of the rate of the gap and of the sliding speed by the velocities (C. Glocker, *Set-Valued Force Laws*,
//! Springer 2001, doi:10.1007/978-3-540-44479-4; R. I. Leine, H. Nijmeijer, *Dynamics and Bifurcations of Non-Smooth Mechanical
//! Systems*, Springer 2004, doi:10.1007/978-3-540-44398-8). Accelerations, normal forces and friction forces are the unknowns
//! of one linear system, whose equations depend on the modes of the contacts:
//!
//! | mode | normal | tangential |
//! |---|---|---|
//! | apart | `λ_N = 0` | `λ_T = 0` |
//! | slip | `g̈ = -2ġ - g` | `λ_T = σ μ λ_N` and the drag |
//! | stick | `g̈ = -2ġ - g` | `γ̇ = 0`, or `γ̇ = -γ` for a sliding speed that several velocities give |
//!
//! The normal force of a contact that does not open is given, or it is a reaction: a linear function of the accelerations, such as
//! the force of a ring on a ball.
//!
//! What rounding leaves of the gap `g` and of the sliding speed `γ` decays.

use super::contact_mode::record_contact;
use super::mechanism_contact::ContactRows;
use super::redundant_contacts::may_be_dependent;
use super::shared_loads::SharedLoads;
use super::{
    Contact, ContactEquations, ContactLayout, Expression, ForcingLayout, MechanismContact,
    MechanismNormal, Node, Number, OpeningEquations, Recorder, StateLayout, SystemEquations,
};

/// The equations of motion of bodies with contacts.
pub struct Mechanism<'r> {
    /// Each coordinate with its velocity, components of the state.
    pub coordinates: Vec<[Expression<'r>; 2]>,
    /// The rates of change of the coordinates, linear functions of the velocities; none: each is its velocity. Mass matrix and
    /// forces are those of the velocities.
    pub rates: Vec<Expression<'r>>,
    /// Other components of the state with their rates of change, such as the phase of a force.
    pub others: Vec<[Expression<'r>; 2]>,
    /// The mass matrix, row by row.
    pub mass: Vec<Vec<Expression<'r>>>,
    /// The forces, without those of the contacts.
    pub forces: Vec<Expression<'r>>,
    /// The contacts, whose inputs [`super::add_mechanism_inputs`] adds.
    pub contacts: Vec<MechanismContact<'r>>,
    /// The component of `others` in which the equations are periodic, with its period.
    pub forcing: Option<(Expression<'r>, f64)>,
    /// The coordinates without contact that are angles with a period of one turn.
    pub angles: Vec<Expression<'r>>,
}

impl<'r> Mechanism<'r> {
    /// Records the equations.
    ///
    /// # Panics
    /// Panics if the sizes of coordinates, mass matrix and forces differ, or if a coordinate is no component of the state: such a
    /// mechanism is a programming error.
    pub fn record(self, recorder: &'r Recorder) -> SystemEquations<'r> {
        let [zero, one, two] = [0.0, 1.0, 2.0].map(Expression::constant);
        let rows: Vec<ContactRows<'r>> =
            self.contacts.iter().map(|contact| self.rows(recorder, contact)).collect();
        let normal_forces: Vec<_> = self.contacts.iter().map(MechanismContact::normal).collect();
        let n = self.coordinates.len();
        // Accelerations, normal forces of gaps, friction forces.
        let normals: Vec<Option<usize>> = rows
            .iter()
            .scan(n, |next, row| {
                let place = row.normal.is_some().then_some(*next);
                *next += usize::from(place.is_some());
                Some(place)
            })
            .collect();
        let first_friction = n + normals.iter().flatten().count();
        let size = first_friction + rows.len();
        let shared = SharedLoads::new(recorder, &self.contacts, &rows);
        let mut matrix = vec![vec![zero; size]; size];
        let mut right = vec![zero; size];
        for (i, row) in self.mass.iter().enumerate() {
            matrix[i][..n].copy_from_slice(row);
            right[i] = self.forces[i];
        }
        for (k, row) in rows.iter().enumerate() {
            let (along, drift) = &row.tangential;
            let place = first_friction + k;
            let Contact { free, signed_friction, drag } = row.contact;
            let stuck = shared.holds(k);
            let force_unit = Expression::constant(self.contacts[k].force_unit);
            for (i, share) in along.iter().enumerate() {
                matrix[i][place] = force_unit * *share;
                matrix[place][i] = stuck * *share;
            }
            matrix[place][place] = if shared.is_first(k) { free } else { one - stuck };
            // Rounding leaves a small sliding speed. It decays by itself if one velocity determines the sliding speed; otherwise
            // the friction force removes it.
            let residual =
                if row.only_velocity().is_some() { zero } else { self.contacts[k].sliding_speed };
            right[place] = drag - stuck * (*drift + residual);
            if along.iter().all(|share| share.known() == Some(0.0)) {
                // No friction.
                matrix[place][place] = one;
                right[place] = zero;
            }
            match (&row.normal, normals[k], &normal_forces[k]) {
                (Some((across, drift)), Some(normal), _) => {
                    let [gap, speed] = row.gap;
                    for (i, share) in across.iter().enumerate() {
                        matrix[i][normal] = -*share;
                        matrix[normal][i] = row.closed * *share;
                    }
                    matrix[normal][normal] = one - row.closed;
                    right[normal] = -(row.closed * (*drift + two * speed + gap));
                    matrix[place][normal] = -signed_friction;
                }
                (_, _, MechanismNormal::Given(force)) => {
                    right[place] = right[place] + signed_friction * *force;
                }
                (_, _, MechanismNormal::Reaction(rest, factors)) => {
                    right[place] = right[place] + signed_friction * *rest;
                    for (i, factor) in factors.iter().enumerate() {
                        matrix[place][i] = matrix[place][i] - signed_friction * *factor;
                    }
                }
                _ => {}
            }
        }
        let determined = if may_be_dependent(&rows, |row| shared.is_first(row)) { n } else { size };
        let unknowns = recorder.unknowns(&matrix, &right, (false, determined));
        let sum = |shares: &[Expression<'r>], drift: Expression<'r>| {
            shares.iter().zip(&unknowns).fold(drift, |sum, (share, value)| sum + *share * *value)
        };
        let mut equations = SystemEquations {
            derivative: self.derivative(recorder, &unknowns, &rows),
            layout: self.layout(recorder),
            ..SystemEquations::default()
        };
        for (k, (row, contact)) in rows.iter().zip(&self.contacts).enumerate() {
            let normal = match (&normal_forces[k], normals[k]) {
                (&MechanismNormal::Gap(gap), Some(place)) => {
                    let (across, drift) =
                        row.normal.as_ref().expect("a gap has a normal direction");
                    equations.openings.push(OpeningEquations {
                        contact: k,
                        gap,
                        speed: row.gap[1],
                        acceleration: sum(across, *drift),
                        force: unknowns[place],
                        friction: unknowns[first_friction + k],
                    });
                    row.closed * unknowns[place] + (one - row.closed) * gap
                }
                (MechanismNormal::Reaction(rest, factors), _) => sum(factors, *rest),
                (MechanismNormal::Given(force) | MechanismNormal::Gap(force), _) => *force,
            };
            equations.contacts.push(ContactEquations {
                sliding_speed: contact.sliding_speed,
                sliding_acceleration: sum(&row.tangential.0, row.tangential.1),
                normal,
                friction: unknowns[first_friction + k],
            });
        }
        let loads = |k: usize| (unknowns[first_friction + k], equations.contacts[k].normal);
        let forces: Vec<_> = (0..rows.len()).map(|k| shared.friction(k, loads)).collect();
        equations.contacts.iter_mut().zip(forces).for_each(|(to, force)| to.friction = force);
        equations
    }

    /// Returns the equations of a contact, whose inputs are recorded.
    fn rows(&self, recorder: &'r Recorder, contact: &MechanismContact<'r>) -> ContactRows<'r> {
        let zero = Expression::constant(0.0);
        // Positions move with the velocities, and other components with their rates.
        let others = self.others.iter().map(|[of, rate]| (*of, *rate));
        let moves: Vec<_> = self.moves().chain(others).collect();
        let by_velocities = |of: Expression<'r>| -> Vec<Expression<'r>> {
            let one = Expression::constant(1.0);
            let by = |[_, velocity]: &[Expression<'r>; 2]| {
                recorder.rate_of_change(of, &[(*velocity, one)])
            };
            self.coordinates.iter().map(by).collect()
        };
        let speed = contact.sliding_speed;
        let tangential = (by_velocities(speed), recorder.rate_of_change(speed, &moves));
        let recorded = record_contact(recorder, &contact.friction, speed);
        let limit = recorder.input("limit");
        match contact.normal {
            MechanismNormal::Given(_) | MechanismNormal::Reaction(..) => {
                let (gap, closed) = ([zero; 2], zero);
                ContactRows { normal: None, tangential, gap, closed, contact: recorded, limit }
            }
            MechanismNormal::Gap(gap) => {
                let opening = recorder.rate_of_change(gap, &moves);
                let drift = recorder.rate_of_change(opening, &moves);
                ContactRows {
                    normal: Some((by_velocities(opening), drift)),
                    tangential,
                    gap: [gap, opening],
                    closed: recorder.switch("closed"),
                    contact: recorded,
                    limit,
                }
            }
        }
    }

    /// Returns each coordinate with its rate of change.
    fn moves(&self) -> impl Iterator<Item = (Expression<'r>, Expression<'r>)> + '_ {
        let rate = |(place, [position, velocity]): (usize, &[Expression<'r>; 2])| {
            (*position, self.rates.get(place).copied().unwrap_or(*velocity))
        };
        self.coordinates.iter().enumerate().map(rate)
    }

    fn derivative(
        &self,
        recorder: &Recorder,
        unknowns: &[Expression<'r>],
        rows: &[ContactRows<'r>],
    ) -> Vec<Expression<'r>> {
        let mut derivative = vec![Expression::constant(0.0); recorder.components()];
        for (position, rate) in self.moves() {
            derivative[component(recorder, position)] = rate;
        }
        for ([_, velocity], acceleration) in self.coordinates.iter().zip(unknowns) {
            derivative[component(recorder, *velocity)] = *acceleration;
        }
        let one = Expression::constant(1.0);
        for (contact, row) in self.contacts.iter().zip(rows) {
            if let Some((place, factor)) = row.only_velocity() {
                let residual = match factor.known() {
                    Some(1.0) => contact.sliding_speed,
                    _ => contact.sliding_speed / factor,
                };
                // A speed that is zero stays exactly zero, although rounding leaves a small acceleration.
                let rate = &mut derivative[component(recorder, self.coordinates[place][1])];
                *rate = row.contact.free * *rate - (one - row.contact.free) * residual;
            }
        }
        for [other, rate] in &self.others {
            derivative[component(recorder, *other)] = *rate;
        }
        derivative
    }

    fn layout(&self, recorder: &Recorder) -> StateLayout {
        let contact = |contact: &MechanismContact<'r>| ContactLayout {
            position: component(recorder, contact.position.0),
            angular: contact.position.1,
        };
        let velocity = |pair: &[Expression<'r>; 2]| vec![component(recorder, pair[1])];
        let forcing = |(of, period)| ForcingLayout { component: component(recorder, of), period };
        StateLayout {
            contacts: self.contacts.iter().map(contact).collect(),
            velocities: self.coordinates.iter().map(velocity).collect(),
            vibration: None,
            forcing: self.forcing.map(forcing),
            angles: self.angles.iter().map(|angle| component(recorder, *angle)).collect(),
        }
    }
}

/// Returns the number of a component of the state.
fn component(recorder: &Recorder, of: Expression<'_>) -> usize {
    match recorder.node_of(of) {
        Node::State(component) | Node::Discrete(component) => component as usize,
        other => panic!("a coordinate is a component of the state, not {other:?}"),
    }
}
