//! The motion of a system while all its contacts stick, derived from its recorded equations: whether any contact can ever
//! break loose.
//!
//! With the positions of the contacts fixed, the other components `z` of the state may obey affine equations
//! `ż = A (z - z_0)` with constant coefficients. If all eigenvalues of `A` lie left of the imaginary axis, Lyapunov's equation
//! `Aᵀ P + P A = -1` has a positive definite solution (H. K. Khalil, *Nonlinear Systems*, 3rd ed., Prentice Hall 2002, theorem
//! 4.6), and the distance `R = sqrt((z - z_0)ᵀ P (z - z_0))` from the rest point `z_0` never grows. A force
//! `f_0 + c (z - z_0)` then differs from that at rest by at most `R sqrt(c P⁻¹ cᵀ)`, for all later times. If friction holds all
//! contacts against these differences, the run has certainly ended in equilibrium. If the bound is too coarse, the motion is
//! followed until the bound suffices.
//!
//! A system whose equations are not affine, or whose free components are not damped, has no such certificate.

use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::{Cholesky, DMatrix, DVector};
use smallvec::SmallVec;

use super::system_view::SystemView;
use crate::model::{
    Dual, Gap, Graph, HeldContact, Node, NodeId, RestAmplitude, RestForms, TOUCHING, held,
    strength_that_holds,
};
use crate::motion::{Evaluator, PerContact, Phase, Phases};

/// The motion is followed in steps of this fraction of the time in which it changes.
const FOLLOWED: f64 = 0.02;
/// The most steps in which a motion is followed.
const MOST_FOLLOWED: usize = 1_000_000;
/// The residual speeds of contacts in the band of the switch model decay as `e^-t`. Their effect on forces and rates, which is
/// nearly in proportion to them, is bounded with this factor.
const RESIDUAL: f64 = 2.0;

/// The rest of a system whose equations with all contacts stuck are affine.
#[derive(Debug)]
pub(super) struct StuckForms {
    evaluator: Evaluator,
    free: Vec<usize>,
    positions: Vec<usize>,
    speeds: Vec<usize>,
    vibration: Option<[usize; 2]>,
    /// The motion for the latest positions of the contacts.
    latest: Mutex<Option<(PerContact, Option<Arc<StuckMotion>>)>>,
}

/// The affine motion for one set of positions of the contacts.
#[derive(Debug)]
struct StuckMotion {
    matrix: DMatrix<f64>,
    rest: DVector<f64>,
    /// The factor of the square root of the quadratic form: `R = |factor (z - z_0)|`.
    factor: DMatrix<f64>,
    contacts: Vec<StuckContact>,
    amplitude: f64,
}

/// The forces of a contact that sticks.
#[derive(Debug)]
struct StuckContact {
    friction: AffineForce,
    normal: AffineForce,
    limit: f64,
}

/// A force that is affine in the free components.
#[derive(Debug)]
struct AffineForce {
    at_rest: f64,
    gradient: DVector<f64>,
    /// The most by which it differs from that at rest, over the distance from the rest point.
    most: f64,
    /// The most by which its rate of change differs from zero, over the distance.
    most_rate: f64,
}

impl StuckForms {
    /// Returns the forms of a system, if its contacts can rest and its equations are affine.
    pub(super) fn of(view: &SystemView) -> Option<Self> {
        let graph = view.evaluator.graph();
        let speeds: Option<Vec<usize>> =
            view.contacts.iter().map(|contact| contact.speed).collect();
        let forms = StuckForms {
            evaluator: view.evaluator.clone(),
            free: view.free.clone(),
            positions: view.contacts.iter().map(|contact| contact.position).collect(),
            speeds: speeds?,
            vibration: graph.layout.vibration,
            latest: Mutex::default(),
        };
        // The structure of the equations is the same in all states but for coincidences.
        let probe: Vec<f64> = (0..graph.derivative.len()).map(|i| 0.3 + 0.07 * i as f64).collect();
        (graph.events.is_empty() && forms.is_affine(&forms.stopped(&probe))).then_some(forms)
    }

    fn phases(&self) -> Phases {
        let graph = self.evaluator.graph();
        let mut phases = Phases::from_elem(Phase::Stick, graph.contacts.len());
        phases.resize(phases.len() + graph.gaps.len(), Phase::Open);
        phases
    }

    /// Returns a state without the residual speeds of the contacts.
    fn stopped(&self, state: &[f64]) -> Vec<f64> {
        let mut stopped = state.to_vec();
        self.speeds.iter().for_each(|speed| stopped[*speed] = 0.0);
        stopped
    }

    /// Returns whether the free components have affine equations and the contacts affine forces, while they do not move.
    fn is_affine(&self, state: &[f64]) -> bool {
        let graph = self.evaluator.graph();
        let values = self.evaluator.all_values(&self.phases(), |component| state[component]);
        let degrees = degrees(graph, &values, |component| self.free.contains(&component));
        let is = |node: NodeId, degree: Degree| degrees[node as usize] <= degree;
        let stays = |position: &usize| {
            let rate = graph.derivative[*position];
            is(rate, Degree::Constant) && values[rate as usize] == 0.0
        };
        let forces = graph.contacts.iter().flat_map(|[.., normal, friction]| [*normal, *friction]);
        self.positions.iter().all(stays)
            && self
                .free
                .iter()
                .map(|one| graph.derivative[*one])
                .chain(forces)
                .all(|node| is(node, Degree::Affine))
    }

    /// Returns the motion at the positions of the contacts in a state.
    fn motion(&self, state: &[f64]) -> Option<Arc<StuckMotion>> {
        let positions: PerContact = self.positions.iter().map(|one| state[*one]).collect();
        // A panic while the motion is locked leaves it complete.
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, motion)) = &*latest
            && *of == positions
        {
            return motion.clone();
        }
        let motion = self.derived(&self.stopped(state)).map(Arc::new);
        *latest = Some((positions, motion.clone()));
        motion
    }

    fn derived(&self, state: &[f64]) -> Option<StuckMotion> {
        let graph = self.evaluator.graph();
        let phases = self.phases();
        let n = self.free.len();
        let along = |direction: usize| {
            let slope = |component| if component == direction { 1.0 } else { 0.0 };
            let dual = |component: usize| Dual { value: state[component], slope: slope(component) };
            self.evaluator.all_values(&phases, dual)
        };
        let columns: Vec<_> = self.free.iter().map(|component| along(*component)).collect();
        let values = self.evaluator.all_values(&phases, |component| state[component]);
        let gradient = |node: NodeId| {
            DVector::from_iterator(n, columns.iter().map(|values| values[node as usize].slope))
        };
        let rates: Vec<NodeId> = self.free.iter().map(|one| graph.derivative[*one]).collect();
        let rate = DVector::from_iterator(n, rates.iter().map(|node| values[*node as usize]));
        let matrix = DMatrix::from_fn(n, n, |i, j| columns[j][rates[i] as usize].slope);
        let to_rest = match n {
            0 => rate,
            _ => -matrix.clone().lu().solve(&rate)?,
        };
        let place = DVector::from_iterator(n, self.free.iter().map(|one| state[*one]));
        let rest = place + &to_rest;
        let lyapunov = match n {
            0 => None,
            _ => Some(Cholesky::new(lyapunov_solution(&matrix)?)?),
        };
        let most = |row: &DVector<f64>| {
            let square = lyapunov.as_ref().map_or(0.0, |form| row.dot(&form.solve(row)));
            square.max(0.0).sqrt()
        };
        let force = |node: NodeId| {
            let gradient = gradient(node);
            let rate = if n == 0 { gradient.clone() } else { matrix.tr_mul(&gradient) };
            AffineForce {
                at_rest: values[node as usize] + gradient.dot(&to_rest),
                most: most(&gradient),
                most_rate: most(&rate),
                gradient,
            }
        };
        let contact = |(contact, [.., normal, friction]): (usize, &[NodeId; 4])| StuckContact {
            friction: force(*friction),
            normal: force(*normal),
            limit: self.evaluator.system().friction(contact).limit,
        };
        let contacts = graph.contacts.iter().enumerate().map(contact).collect();
        let measured = |component: usize| {
            let free = self.free.iter().position(|one| *one == component);
            free.map_or(state[component], |place| rest[place])
        };
        let amplitude = self.vibration.map_or(0.0, |[x, y]| measured(x).hypot(measured(y)));
        let factor = lyapunov.as_ref().map_or(matrix.clone(), |form| form.l().transpose());
        Some(StuckMotion { matrix, rest, factor, contacts, amplitude })
    }

    /// Returns the gaps that are closed in a state.
    fn closed_gaps(&self, state: &[f64]) -> Vec<Gap> {
        let gaps = self.evaluator.system().touching().map_or(&[][..], |touching| touching.gaps());
        let width = |gap: &Gap| gap.width(gap.contacts.map(|one| state[self.positions[one]]));
        gaps.iter().filter(|gap| width(gap) <= TOUCHING).copied().collect()
    }

    /// Returns the place of the free components relative to the rest point, and a bound on the effect of residual speeds: on the
    /// distance, and on the friction and the normal force of each contact.
    fn displaced(
        &self,
        motion: &StuckMotion,
        state: &[f64],
    ) -> (DVector<f64>, f64, SmallVec<[[f64; 2]; 8]>) {
        let n = self.free.len();
        let displaced =
            DVector::from_iterator(n, self.free.iter().map(|one| state[*one])) - &motion.rest;
        let contacts = self.evaluator.graph().contacts.len();
        if self.speeds.iter().all(|speed| state[*speed] == 0.0) {
            return (displaced, 0.0, SmallVec::from_elem([0.0; 2], contacts));
        }
        let (phases, stopped) = (self.phases(), self.stopped(state));
        let [with, without] = [state, &stopped].map(|state| self.evaluator.rates(&phases, state));
        let pushed =
            DVector::from_iterator(n, self.free.iter().map(|one| with[*one] - without[*one]));
        let [with, without] = [state, &stopped].map(|state| self.evaluator.forces(&phases, state));
        let differ = with.iter().zip(&without).map(|(with, without)| {
            let [friction, normal] =
                [with.friction - without.friction, with.normal - without.normal];
            [friction, normal].map(|change| RESIDUAL * change.abs())
        });
        (displaced, RESIDUAL * motion.size(&pushed), differ.collect())
    }

    /// Returns whether friction holds all contacts for all later times, with coefficients of friction that are larger by a
    /// fraction.
    fn holds(&self, motion: &StuckMotion, state: &[f64], excess: f64) -> bool {
        let (displaced, push, residual) = self.displaced(motion, state);
        let distance = motion.size(&displaced) + push;
        motion.endures(&self.closed_gaps(state), 1.0 + excess, distance, &residual)
    }
}

impl RestForms for StuckForms {
    fn surely_rests(&self, state: &[f64]) -> bool {
        // Without free components nothing changes any more, and the contacts stick.
        self.free.is_empty()
            || self.motion(state).is_some_and(|motion| self.holds(&motion, state, 0.0))
    }

    fn rests(&self, state: &[f64]) -> bool {
        if self.free.is_empty() {
            return true;
        }
        let Some(motion) = self.motion(state) else { return false };
        let gaps = self.closed_gaps(state);
        let (displaced, push, residual) = self.displaced(&motion, state);
        motion.endures(&gaps, 1.0, 0.0, &residual)
            && motion.followed_to_rest(&gaps, displaced, push, &residual)
    }

    fn at_rest(&self, state: &[f64]) -> RestAmplitude {
        let Some(motion) = self.motion(state) else {
            return RestAmplitude { amplitude: f64::NAN, friction_margin: f64::NAN };
        };
        let contacts = motion.held_contacts(1.0, |force| force.at_rest);
        let needed = strength_that_holds(&contacts, &self.closed_gaps(state));
        // On the very edge of the set only the slack of the conditions is missing.
        RestAmplitude { amplitude: motion.amplitude, friction_margin: (1.0 - needed).max(0.0) }
    }

    /// Contacts creep only against a drag: without one, the forces on them do not depend on their speeds.
    fn nearly_rests(&self, state: &[f64], excess: f64) -> bool {
        let system = self.evaluator.system();
        let drags = |contact| system.friction(contact).damping_rate(1.0) > 0.0;
        (!self.free.is_empty() || (0..system.contacts()).any(drags))
            && self.motion(state).is_some_and(|motion| self.holds(&motion, state, excess))
    }
}

impl StuckMotion {
    /// Returns the size of a displacement from the rest point.
    fn size(&self, displacement: &DVector<f64>) -> f64 {
        if displacement.is_empty() {
            return 0.0;
        }
        (&self.factor * displacement).norm()
    }

    fn held_contacts(
        &self,
        strength: f64,
        at: impl Fn(&AffineForce) -> f64,
    ) -> SmallVec<[HeldContact; 8]> {
        let contact = |contact: &StuckContact| HeldContact {
            normal: at(&contact.normal),
            friction: at(&contact.friction),
            limit: strength * contact.limit,
            weight: 1.0,
        };
        self.contacts.iter().map(contact).collect()
    }

    /// Returns whether friction holds all contacts if the motion is at most at a distance from the rest point.
    fn endures(&self, gaps: &[Gap], strength: f64, distance: f64, residual: &[[f64; 2]]) -> bool {
        let mut contacts = self.held_contacts(strength, |force| force.at_rest);
        for ((held, contact), residual) in contacts.iter_mut().zip(&self.contacts).zip(residual) {
            let most = [contact.friction.most, contact.normal.most].map(|most| most * distance);
            widen(held, most, *residual);
        }
        held(&contacts, gaps).reserve >= 0.0
    }

    /// Follows the motion until friction certainly holds all contacts. `false` means that a contact breaks loose, or that the
    /// margin is too small for a decision. Between the instants of the steps, forces are bounded by their rates of change.
    fn followed_to_rest(
        &self,
        gaps: &[Gap],
        mut displaced: DVector<f64>,
        push: f64,
        residual: &[[f64; 2]],
    ) -> bool {
        let interval = FOLLOWED / (1.0 + self.matrix.norm());
        let step = (&self.matrix * interval).exp();
        for _ in 0..MOST_FOLLOWED {
            let distance = self.size(&displaced) + push;
            if self.endures(gaps, 1.0, distance, residual) {
                return true;
            }
            let mut contacts =
                self.held_contacts(1.0, |force| force.at_rest + force.gradient.dot(&displaced));
            for ((held, contact), residual) in contacts.iter_mut().zip(&self.contacts).zip(residual)
            {
                let unseen =
                    |force: &AffineForce| force.most_rate * distance * interval + force.most * push;
                widen(held, [unseen(&contact.friction), unseen(&contact.normal)], *residual);
            }
            if held(&contacts, gaps).reserve < 0.0 {
                return false;
            }
            displaced = &step * displaced;
        }
        false
    }
}

/// Takes into account that the friction force and the normal force of a contact may differ by numbers.
fn widen(contact: &mut HeldContact, differences: [f64; 2], others: [f64; 2]) {
    let [friction, normal] = [0, 1].map(|force| differences[force] + others[force]);
    contact.friction += friction.copysign(contact.friction);
    contact.normal -= normal;
}

/// Returns the solution `P` of `Aᵀ P + P A = -1`; `None` if there is not exactly one.
fn lyapunov_solution(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = matrix.nrows();
    let one = DMatrix::<f64>::identity(n, n);
    let transposed = matrix.transpose();
    let equations = one.kronecker(&transposed) + transposed.kronecker(&one);
    let right = DVector::from_iterator(n * n, one.iter().map(|entry| -entry));
    let solution = DMatrix::from_column_slice(n, n, equations.lu().solve(&right)?.as_slice());
    Some((&solution + solution.transpose()) * 0.5)
}

/// How a number depends on variables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Degree {
    Constant,
    Affine,
    Other,
}

/// Returns how each node depends on components of the state that are variables, at these values of the nodes. What is
/// multiplied by a constant zero, such as the mode of a contact, does not count.
fn degrees(graph: &Graph, values: &[f64], is_variable: impl Fn(usize) -> bool) -> Vec<Degree> {
    let mut degrees: Vec<Degree> = Vec::with_capacity(graph.nodes.len());
    for node in &graph.nodes {
        let of = |node: NodeId| degrees[node as usize];
        let is_zero = |node: NodeId| of(node) == Degree::Constant && values[node as usize] == 0.0;
        let degree = match *node {
            Node::Constant(_) | Node::Input(_) => Degree::Constant,
            Node::State(component) | Node::Discrete(component) => {
                if is_variable(component as usize) { Degree::Affine } else { Degree::Constant }
            }
            Node::Sum(one, other) | Node::Difference(one, other) => of(one).max(of(other)),
            Node::Negation(one) => of(one),
            Node::Product(one, other) if is_zero(one) || is_zero(other) => Degree::Constant,
            Node::Product(one, other) => match (of(one), of(other)) {
                (Degree::Constant, other) => other,
                (one, Degree::Constant) => one,
                _ => Degree::Other,
            },
            Node::Solution { solve, .. } => {
                let solve = &graph.solves[solve as usize];
                let is_constant = |node: &NodeId| of(*node) == Degree::Constant;
                match solve.matrix.iter().all(is_constant) {
                    true => {
                        solve.right.iter().map(|node| of(*node)).max().unwrap_or(Degree::Constant)
                    }
                    false => Degree::Other,
                }
            }
            Node::Quotient(one, other) if of(other) == Degree::Constant => of(one),
            _ => {
                let operands = node.operands(&graph.solves);
                let is_constant = |node: &NodeId| of(*node) == Degree::Constant;
                if operands.iter().all(is_constant) { Degree::Constant } else { Degree::Other }
            }
        };
        degrees.push(degree);
    }
    degrees
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::StuckForms;
    use crate::classification::system_view::SystemView;
    use crate::model::{
        Balancer, Ball, BallContact, BallsInContact, Machine, Method, RestForms, System,
    };
    use crate::motion::{Evaluator, Motion, Settings, Tolerance, all_stick};

    /// The derived forms equal the closed forms of the balancer, certify nearly as many states, and no state that moves.
    #[test]
    fn the_balancer_s_closed_forms_follow_from_its_equations() {
        let balls = [1.4e-4, 2.5e-4].map(|mass_kg| Ball { mass_kg, ..Ball::default() });
        let machine = Machine { balls: balls.to_vec(), ring_runout_m: 5e-5, ..Machine::default() };
        let balancer = Balancer::<2>::new(&machine).expect("two balls");
        let system: Arc<dyn System> = Arc::new(balancer);
        let view = SystemView::new(Evaluator::new(Arc::clone(&system)));
        let derived = StuckForms::of(&view).expect("affine equations");
        let mut draws = ChaCha8Rng::seed_from_u64(45);
        let (mut by_both, mut by_one) = ([0; 2], [0; 2]);
        for _ in 0..4000 {
            let beta = [(); 2].map(|()| std::f64::consts::TAU * draws.random::<f64>());
            let rest = balancer.rest_point(&beta);
            let away = 10_f64.powf(-2.0 - 6.0 * draws.random::<f64>());
            let [x, y, x_dot, y_dot] = [(); 4].map(|()| away * (draws.random::<f64>() - 0.5));
            let state = [
                rest.position[0] + x,
                rest.position[1] + y,
                x_dot,
                y_dot,
                beta[0],
                beta[1],
                0.0,
                0.0,
            ];
            let [one, other] = [balancer.at_rest(&state), derived.at_rest(&state)];
            assert!((one.amplitude - other.amplitude).abs() < 1e-12);
            let margin = one.friction_margin.max(0.0);
            let scale =
                1.0 + rest.friction.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
            assert!(
                (margin - other.friction_margin).abs()
                    < 1e-12 * scale / balancer.balls[0].friction.limit,
                "{one:?} {other:?}"
            );
            for (place, [own, derived]) in [
                [balancer.surely_rests(&state), derived.surely_rests(&state)],
                [balancer.rests(&state), derived.rests(&state)],
            ]
            .into_iter()
            .enumerate()
            {
                by_both[place] += u32::from(own && derived);
                by_one[place] += u32::from(own != derived);
                if derived && by_one[0] + by_one[1] < 40 {
                    let tolerance = Tolerance { relative: 1e-10, absolute: 1e-12 };
                    let settings = Settings {
                        method: Method::Event,
                        band: 0.0,
                        tolerance,
                        effort_limit: 100_000,
                    };
                    let mut motion = Motion::new(&system, settings, &state).expect("starts");
                    while motion.time() < 20.0 {
                        motion.advance(20.0).expect("continues");
                        assert!(all_stick(motion.phases()), "{state:?}");
                    }
                }
            }
        }
        assert!(by_both[0] > 100 && by_both[1] > by_both[0], "{by_both:?}");
        assert!(
            by_one[0] < by_both[0] / 4 && by_one[1] < by_both[1] / 20,
            "{by_one:?} {by_both:?}"
        );
    }
    /// Balls that touch hold each other, as in the closed form.
    #[test]
    fn balls_that_touch_hold_each_other() {
        let contact = BallContact::default();
        let balls = [2e-3, 2e-4];
        let balls =
            balls.map(|friction_coefficient| Ball { friction_coefficient, ..Ball::default() });
        let machine = Machine {
            balls: balls.to_vec(),
            speed_rad_s: -216.3772,
            contact: Some(contact),
            ..Machine::default()
        };
        let apart = machine.contact_angle_rad(&machine.balls[0], &machine.balls[1]);
        let own =
            BallsInContact::<2>::new(&machine, &contact, &[1.0, 1.0 + apart]).expect("two balls");
        let view = SystemView::new(Evaluator::new(Arc::new(own.clone())));
        let derived = StuckForms::of(&view).expect("affine equations");
        let (mut rest, mut helped) = (0, 0);
        for k in 0..2000 {
            let behind = std::f64::consts::TAU * f64::from(k) / 2000.0;
            let beta = [behind, behind + apart];
            let [x, y] = own.balancer.rest_point(&beta).position;
            let state = [x, y, 0.0, 0.0, beta[0], beta[1], 0.0, 0.0];
            let [one, other] = [own.at_rest(&state), derived.at_rest(&state)];
            let margin = one.friction_margin.max(0.0);
            assert!((margin - other.friction_margin).abs() < 1e-9, "{one:?} {other:?}");
            assert_eq!(own.rests(&state), derived.rests(&state), "{beta:?}");
            rest += i32::from(derived.rests(&state));
            helped += i32::from(derived.rests(&state) && !own.balancer.rests(&state));
        }
        assert!(rest > helped && helped > 0, "{rest} {helped}");
    }
}
