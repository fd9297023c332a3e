//! The rest of a system with all contacts stuck, derived from its recorded equations: whether any contact can ever break
//! loose.
//!
//! With the positions of the contacts fixed, the equations of the other components of the state may be affine. Their
//! coefficients give the motion ([`super::stuck_motion`]). If they are not affine, Newton's method finds the rest point near
//! the state, and bounds of the derivatives in a region that contains both show that the motion approaches the rest point. A
//! system whose free components are not damped has no such certificate.

use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::{DMatrix, DVector};
use smallvec::SmallVec;

use super::stuck_motion::{AffineForce, Curvature, Distance, StuckContact, StuckMotion};
use crate::model::{
    Bounded, Components, Degree, Gap, Interval, NodeId, RestAmplitude, RestForms, TOUCHING,
    strength_that_holds,
};
use crate::motion::{Evaluator, PerContact};

/// The residual speeds of contacts in the band of the switch model decay as `e^-t`. Their effect on forces and rates, which is
/// nearly in proportion to them, is bounded with this factor.
const RESIDUAL: f64 = 2.0;

/// Motions at positions of the contacts that differ by at most this, non-dimensional, are nearly equal; a certificate fails by far if it
/// fails at this part of the distance.
const NEARBY: f64 = 1e-6;
const FAR: f64 = 0.5;

/// The most steps of Newton's method, and the size of the last of them, over 1 and the largest component.
const MOST_STEPS: usize = 20;
const THERE: f64 = 1e-12;

/// The rest of a system whose contacts do not move while all of them stick.
#[derive(Debug)]
pub(super) struct DerivedRest {
    evaluator: Evaluator,
    /// Whether the equations are affine then.
    is_affine: bool,
    free: Vec<usize>,
    positions: Vec<usize>,
    speeds: Vec<usize>,
    vibration: Option<[usize; 2]>,
    /// The motion for the latest positions of the contacts.
    latest: Mutex<Option<(PerContact, Option<Arc<StuckMotion>>)>>,
}

impl DerivedRest {
    /// Returns the forms of a system with these components that belong to no contact, if its contacts can rest.
    pub(super) fn of(evaluator: &Evaluator, free: &[usize]) -> Option<Self> {
        let graph = evaluator.graph();
        let contacts = 0..graph.layout.contacts.len();
        let speeds: Option<Vec<usize>> =
            contacts.map(|contact| graph.speed_component(contact)).collect();
        let mut forms = DerivedRest {
            evaluator: evaluator.clone(),
            is_affine: false,
            free: free.to_vec(),
            positions: graph.layout.contacts.iter().map(|contact| contact.position).collect(),
            speeds: speeds?,
            vibration: graph.layout.vibration,
            latest: Mutex::default(),
        };
        // The structure of the equations is the same in all states but for coincidences.
        let probe: Vec<f64> = (0..graph.derivative.len()).map(|i| 0.3 + 0.07 * i as f64).collect();
        let [stays, is_affine] = forms.structure(&forms.stopped(&probe));
        forms.is_affine = is_affine;
        (graph.events.is_empty() && stays).then_some(forms)
    }

    /// Returns a state without the residual speeds of the contacts.
    fn stopped(&self, state: &[f64]) -> Vec<f64> {
        let mut stopped = state.to_vec();
        self.speeds.iter().for_each(|speed| stopped[*speed] = 0.0);
        stopped
    }

    /// Returns whether the contacts do not move while they stick and no free component, such as the time, moves at a constant rate;
    /// and whether the free components then have affine equations and the contacts affine forces.
    fn structure(&self, state: &[f64]) -> [bool; 2] {
        let graph = self.evaluator.graph();
        let values =
            self.evaluator.all_values(&self.evaluator.no_phases(), |component| state[component]);
        let degrees = graph.degrees(&values, |component| self.free.contains(&component));
        let is = |node: NodeId, degree: Degree| degrees[node as usize] <= degree;
        let stays = |position: &usize| {
            let rate = graph.derivative[*position];
            is(rate, Degree::Constant) && values[rate as usize] == 0.0
        };
        let drifts = |node: NodeId| is(node, Degree::Constant) && values[node as usize] != 0.0;
        let forces = graph.contacts.iter().flat_map(|[.., normal, friction]| [*normal, *friction]);
        let rates = || self.free.iter().map(|component| graph.derivative[*component]);
        let are_affine = rates().chain(forces).all(|node| is(node, Degree::Affine));
        [self.positions.iter().all(stays) && !rates().any(drifts), are_affine]
    }

    /// Returns the motion at the positions of the contacts in a state.
    fn motion(&self, state: &[f64]) -> Option<Arc<StuckMotion>> {
        if !self.is_affine {
            return self.near(self.stopped(state)).map(Arc::new);
        }
        let positions: PerContact =
            self.positions.iter().map(|component| state[*component]).collect();
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

    /// Returns the motion near the rest point that Newton's method finds from a state.
    fn near(&self, mut state: Vec<f64>) -> Option<StuckMotion> {
        for _ in 0..MOST_STEPS {
            let motion = self.derived(&state)?;
            let (mut step, mut largest) = (0.0_f64, 1.0_f64);
            for (component, rest) in self.free.iter().zip(motion.rest.iter()) {
                step = step.max((rest - state[*component]).abs());
                largest = largest.max(rest.abs());
                state[*component] = *rest;
            }
            if step <= THERE * largest {
                return Some(motion);
            }
        }
        None
    }

    /// Returns how much derivatives differ, within a distance of the rest point, from those at the rest point.
    fn curvature(&self, motion: &StuckMotion, state: &[f64], distance: f64) -> Curvature {
        let graph = self.evaluator.graph();
        let (phases, stopped) = (self.evaluator.no_phases(), self.stopped(state));
        let n = self.free.len();
        let radius = motion.distance.components(n) * distance;
        let place = |component: usize| self.free.iter().position(|other| *other == component);
        let along = |direction: usize| {
            let component = |component: usize| Bounded {
                value: place(component).map_or(Interval::exact(stopped[component]), |place| {
                    Interval::around(motion.rest[place], radius[place])
                }),
                slope: Interval::exact(if component == direction { 1.0 } else { 0.0 }),
            };
            self.evaluator.all_values(&phases, component)
        };
        let columns: Vec<_> = self.free.iter().map(|component| along(*component)).collect();
        let differs = |node: NodeId, column: usize, at_rest: f64| {
            columns[column][node as usize].slope.farthest_from(at_rest)
        };
        let rates = DMatrix::from_fn(n, n, |row, column| {
            let node = graph.derivative[self.free[row]];
            differs(node, column, motion.matrix[(row, column)])
        });
        let of_contact = |(nodes, contact): (&[NodeId; 4], &StuckContact)| {
            let [.., normal, friction] = *nodes;
            let of = |node: NodeId, force: &AffineForce| {
                DVector::from_fn(n, |column, _| differs(node, column, force.gradient(column)))
            };
            [of(friction, &contact.friction), of(normal, &contact.normal)]
        };
        let forces = graph.contacts.iter().zip(&motion.contacts).map(of_contact).collect();
        Curvature { rates, forces }
    }

    fn derived(&self, state: &[f64]) -> Option<StuckMotion> {
        let graph = self.evaluator.graph();
        let phases = self.evaluator.no_phases();
        let n = self.free.len();
        let along = |direction: usize| {
            let along = |component| if component == direction { 1.0 } else { 0.0 };
            self.evaluator.values_along(&phases, state, along)
        };
        let columns: Vec<_> = self.free.iter().map(|component| along(*component)).collect();
        let values = self.evaluator.all_values(&phases, |component| state[component]);
        let gradient = |node: NodeId| {
            DVector::from_iterator(n, columns.iter().map(|values| values[node as usize].slope))
        };
        let rates: Vec<NodeId> =
            self.free.iter().map(|component| graph.derivative[*component]).collect();
        let rate = DVector::from_iterator(n, rates.iter().map(|node| values[*node as usize]));
        let matrix = DMatrix::from_fn(n, n, |i, j| columns[j][rates[i] as usize].slope);
        let to_rest = match n {
            0 => rate,
            _ => -matrix.clone().lu().solve(&rate)?,
        };
        let place = DVector::from_iterator(n, self.free.iter().map(|component| state[*component]));
        let rest = place + &to_rest;
        let distance = Distance::of(&matrix)?;
        let force = |node: NodeId| {
            let gradient = gradient(node);
            let at_rest = values[node as usize] + gradient.dot(&to_rest);
            AffineForce::new(at_rest, gradient, &matrix, &distance)
        };
        let contact = |(contact, [.., normal, friction]): (usize, &[NodeId; 4])| StuckContact {
            friction: force(*friction),
            normal: force(*normal),
            limit: self.evaluator.system().friction(contact).limit,
        };
        let contacts = graph.contacts.iter().enumerate().map(contact).collect();
        let measured = |component: usize| {
            let free = self.free.iter().position(|other| *other == component);
            free.map_or(state[component], |place| rest[place])
        };
        let amplitude = self.vibration.map_or(0.0, |[x, y]| measured(x).hypot(measured(y)));
        Some(StuckMotion { matrix, rest, distance, contacts, amplitude })
    }

    /// Returns whether the motion at other positions of the contacts, nearly the same, fails the certificate by far. This saves an exact
    /// test in most states while residual speeds still change the positions a little.
    fn is_far(&self, state: &[f64]) -> bool {
        // A panic while the motion is locked leaves it complete.
        let latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        let Some((positions, Some(motion))) = &*latest else { return false };
        let mut shifts =
            positions.iter().zip(&self.positions).map(|(of, place)| (of - state[*place]).abs());
        let are_same = shifts.clone().all(|shift| shift == 0.0);
        let has_gaps = !self.evaluator.graph().gaps.is_empty();
        if are_same || has_gaps || !shifts.all(|shift| shift <= NEARBY) {
            return false;
        }
        let free = self.free.iter().map(|component| state[*component]);
        let displaced = DVector::from_iterator(self.free.len(), free) - &motion.rest;
        let distance = FAR * motion.distance.size(&displaced) - NEARBY / FAR;
        let none = SmallVec::<[[f64; 2]; 8]>::from_elem([0.0; 2], positions.len());
        distance > 0.0 && !motion.holds_all_contacts(&[], 1.0, distance, &none)
    }

    /// Returns the gaps that are closed in a state.
    fn closed_gaps(&self, state: &[f64]) -> Vec<Gap> {
        let gaps = self.evaluator.system().touching().map_or(&[][..], |touching| touching.gaps());
        let width =
            |gap: &Gap| gap.width(gap.contacts.map(|contact| state[self.positions[contact]]));
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
            DVector::from_iterator(n, self.free.iter().map(|component| state[*component]))
                - &motion.rest;
        let contacts = self.evaluator.graph().contacts.len();
        if self.speeds.iter().all(|speed| state[*speed] == 0.0) {
            return (displaced, 0.0, SmallVec::from_elem([0.0; 2], contacts));
        }
        let (phases, stopped) = (self.evaluator.no_phases(), self.stopped(state));
        let [with, without] = [state, &stopped].map(|state| self.evaluator.rates(&phases, state));
        let pushed = DVector::from_iterator(
            n,
            self.free.iter().map(|component| with[*component] - without[*component]),
        );
        let [with, without] = [state, &stopped].map(|state| self.evaluator.forces(&phases, state));
        let differ = with.iter().zip(&without).map(|(with, without)| {
            let [friction, normal] =
                [with.friction - without.friction, with.normal - without.normal];
            [friction, normal].map(|change| RESIDUAL * change.abs())
        });
        (displaced, RESIDUAL * motion.distance.size(&pushed), differ.collect())
    }

    /// Returns whether friction holds all contacts for all later times, with coefficients of friction that are larger by a
    /// fraction.
    fn holds(&self, motion: &StuckMotion, state: &[f64], excess: f64) -> bool {
        let (displaced, push, residual) = self.displaced(motion, state);
        let distance = motion.distance.size(&displaced) + push;
        let gaps = self.closed_gaps(state);
        if self.is_affine {
            return motion.holds_all_contacts(&gaps, 1.0 + excess, distance, &residual);
        }
        let curvature = self.curvature(motion, state, distance);
        motion.contracts(&gaps, 1.0 + excess, distance, &residual, &curvature)
    }
}

impl RestForms for DerivedRest {
    fn surely_rests(&self, state: &[f64]) -> bool {
        // Without free components nothing changes any more, and the contacts stick.
        let holds = || self.motion(state).is_some_and(|motion| self.holds(&motion, state, 0.0));
        self.free.is_empty() || !self.is_far(state) && holds()
    }

    fn rests(&self, state: &[f64]) -> bool {
        if self.free.is_empty() || !self.is_affine {
            return self.surely_rests(state);
        }
        let Some(motion) = self.motion(state) else { return false };
        let gaps = self.closed_gaps(state);
        let (displaced, push, residual) = self.displaced(&motion, state);
        motion.holds_all_contacts(&gaps, 1.0, 0.0, &residual)
            && motion.followed_to_rest(&gaps, displaced, push, &residual)
    }

    fn are_closed(&self) -> bool {
        self.is_affine || self.free.is_empty()
    }

    fn at_rest(&self, state: &[f64]) -> RestAmplitude {
        let Some(motion) = self.motion(state) else {
            return RestAmplitude { amplitude: f64::NAN, friction_margin: f64::NAN };
        };
        let contacts = motion.held_contacts(1.0, AffineForce::at_rest);
        let needed = strength_that_holds(&contacts, &self.closed_gaps(state));
        // On the very edge of the set only the slack of the conditions is missing.
        RestAmplitude { amplitude: motion.amplitude, friction_margin: (1.0 - needed).max(0.0) }
    }

    fn rest_state(&self, state: &[f64]) -> Option<Components> {
        let mut rest = Components::from(self.stopped(state));
        if !self.free.is_empty() {
            let motion = self.motion(state)?;
            self.free
                .iter()
                .zip(motion.rest.iter())
                .for_each(|(component, value)| rest[*component] = *value);
        }
        Some(rest)
    }

    /// Contacts creep only against a drag: without one, the forces on them do not depend on their speeds.
    fn nearly_rests(&self, state: &[f64], excess: f64) -> bool {
        let system = self.evaluator.system();
        let drags = |contact| system.friction(contact).damping_rate(1.0) > 0.0;
        (!self.free.is_empty() || (0..system.contacts()).any(drags))
            && self.motion(state).is_some_and(|motion| self.holds(&motion, state, excess))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::DerivedRest;
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
        let derived = DerivedRest::of(&view.evaluator, &view.free).expect("affine equations");
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
            let [expected, found] = [balancer.at_rest(&state), derived.at_rest(&state)];
            assert!((expected.amplitude - found.amplitude).abs() < 1e-12);
            let margin = expected.friction_margin.max(0.0);
            let scale =
                1.0 + rest.friction.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
            assert!(
                (margin - found.friction_margin).abs()
                    < 1e-12 * scale / balancer.balls[0].friction.limit,
                "{expected:?} {found:?}"
            );
            for (place, [in_closed_form, derived]) in [
                [balancer.surely_rests(&state), derived.surely_rests(&state)],
                [balancer.rests(&state), derived.rests(&state)],
            ]
            .into_iter()
            .enumerate()
            {
                by_both[place] += u32::from(in_closed_form && derived);
                by_one[place] += u32::from(in_closed_form != derived);
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
        let model =
            BallsInContact::<2>::new(&machine, &contact, &[1.0, 1.0 + apart]).expect("two balls");
        let view = SystemView::new(Evaluator::new(Arc::new(model.clone())));
        let derived = DerivedRest::of(&view.evaluator, &view.free).expect("affine equations");
        let (mut rest, mut helped) = (0, 0);
        for k in 0..2000 {
            let behind = std::f64::consts::TAU * f64::from(k) / 2000.0;
            let beta = [behind, behind + apart];
            let [x, y] = model.balancer.rest_point(&beta).position;
            let state = [x, y, 0.0, 0.0, beta[0], beta[1], 0.0, 0.0];
            let [expected, found] = [model.at_rest(&state), derived.at_rest(&state)];
            let margin = expected.friction_margin.max(0.0);
            assert!((margin - found.friction_margin).abs() < 1e-9, "{expected:?} {found:?}");
            assert_eq!(model.rests(&state), derived.rests(&state), "{beta:?}");
            rest += i32::from(derived.rests(&state));
            helped += i32::from(derived.rests(&state) && !model.balancer.rests(&state));
        }
        assert!(rest > helped && helped > 0, "{rest} {helped}");
    }
}
