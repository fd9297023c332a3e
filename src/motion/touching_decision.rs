//! The joint decision between stick and slip, closed and open, where contacts touch each other or may open.
//!
//! If no gap is closed and no contact may open, contacts at rest are decided as in any system ([`super::stick_slip`]).
//! Otherwise all combinations of the phases that are not known are tried. The phases of contacts that touch no other
//! follow from the other phases, unless several motions may be possible ([`super::separate_contacts`]). A combination
//! holds if
//!
//! - contacts that stick need no more friction than there is: each alone, or together with those that it touches and that
//!   stick too, for some forces in the gaps between them ([`crate::model::held`]);
//! - contacts that set off accelerate in their direction;
//! - gaps that stay closed are under pressure, and gaps that open do so with an acceleration that is not negative; so do
//!   contacts that open.
//!
//! Exactly one motion must remain ([`Failure::NoSolution`], [`Failure::TooManyCombinations`]).

use smallvec::SmallVec;

use super::cluster::{HeldCluster, held_clusters};
use super::evaluator::{ContactForces, Forces, GapForces};
use super::incremental_forces::TOGETHER;
use super::joint_decision::{AGREE, RecordedForces, check_forces, is_finite, only_motion};
use super::lockstep::width;
use super::phase::any_closed;
use super::separate_contacts::SeparateContacts;
use super::stick_slip::decide_at_rest;
use super::touching_system::TouchingSystem;
use super::{Direction, Failure, IncrementalForces, Phase, Phases, event_driven, switch_model};
use crate::model::{Method, Opening};

/// The most combinations that are tried.
const MOST_TRIED: usize = 100_000;

/// The largest acceleration, over 1 and the largest of all, at which bodies still approach each other by rounding whose force has just
/// vanished: it accelerates light bodies the more.
const RELEASED: f64 = 1e-7;

/// So few combinations are computed one by one.
const FEW: usize = 3;

impl TouchingSystem<'_> {
    /// Decides the phases of contacts at rest or in the band, and of closed gaps. The contacts `fixed` stay as they are. Where the
    /// normal force of the contact `released` has become negative, by less than the forces are rounded here, it opens if that is
    /// the same motion.
    pub(super) fn decide(
        &self,
        state: &[f64],
        phases: &mut Phases,
        fixed: &[usize],
        released: Option<usize>,
    ) -> Result<(), Failure> {
        if self.openings.is_empty() && !any_closed(phases) {
            let model = RecordedForces::new(self.evaluator, state);
            return decide_at_rest(self.settings.method, &model, phases, fixed);
        }
        let slack = self.slack();
        let residual = self.residual_of_gaps(state, phases);
        let for_motion = match self.settings.method {
            Method::Switch => slack,
            Method::Event => slack + residual,
        };
        let are_determined = self.evaluator.graph().determines_all_forces();
        let given = phases.clone();
        let mut equations = self.evaluator.incremental_forces(state);
        type Found = (Forces, SmallVec<[GapForces; 8]>);
        let fits = |candidate: &Phases, (forces, gaps): &Found, least: f64| {
            let of_candidate = (forces, &gaps[..]);
            let fit = || {
                (are_determined || self.agree(candidate, of_candidate, residual))
                    && self.fits(
                        candidate,
                        &given,
                        of_candidate,
                        (fixed, released),
                        [slack, for_motion, least],
                    )
            };
            !forces.iter().all(is_finite) || fit()
        };
        // A contact opens where its normal force is certainly negative, by half of the width within which this is located.
        let least = -0.25 * width(self.settings.tolerance.relative);
        // The given combination is tried first, alone.
        let (is_consistent, others) = self.candidates(&mut equations, &given, fixed)?;
        // Most combinations do not fit. Those that fit to rounding are computed once more, alone.
        let mut likely: Vec<Phases> = Vec::new();
        for some in others.chunks(TOGETHER) {
            if some.len() < FEW || !are_determined {
                likely.extend_from_slice(some);
                continue;
            }
            let forces = equations.forces_of_several(some);
            let fit = some
                .iter()
                .zip(&forces)
                .filter(|(candidate, forces)| fits(candidate, forces, least));
            likely.extend(fit.map(|(candidate, _)| candidate.clone()));
        }
        likely.insert(0, given.clone());
        if let Some(contact) = released {
            likely.sort_by_key(|candidate| candidate[contact] != Phase::Apart);
        }
        let mut only = |least: f64| {
            only_motion(likely.iter().cloned(), |candidate| {
                if !is_consistent && *candidate == given {
                    return None;
                }
                let found = equations.forces_and_gaps(candidate);
                fits(candidate, &found, least).then(|| self.of_motion(found))
            })
        };
        let (decided, forces) = match only(least) {
            // Light bodies separate with a force that is negative by less.
            Err(Failure::NoSolution { solutions: 2.. }) => only(0.0),
            other => other,
        }?;
        *phases = decided;
        check_forces(&forces)
    }

    /// Returns whether the given phases are consistent, and all other combinations that may hold.
    fn candidates(
        &self,
        equations: &mut IncrementalForces,
        given: &Phases,
        fixed: &[usize],
    ) -> Result<(bool, Vec<Phases>), Failure> {
        let alone = self.alone(given, fixed);
        let assumed = self.combinations(given, &[fixed, &alone.contacts].concat())?;
        let is_consistent = assumed.contains(given);
        let is_assumed = |place: &usize| !alone.contacts.contains(place);
        let places: Vec<usize> = (0..given.len()).filter(is_assumed).collect();
        let mut all: Vec<Phases> = Vec::new();
        for assumed in assumed {
            match alone.decide(equations, &assumed) {
                Some(decided) => all.push(decided),
                None => all.extend(self.combinations(&assumed, &places)?),
            }
            if all.len() > MOST_TRIED {
                return Err(Failure::TooManyCombinations);
            }
        }
        all.retain(|phases| phases != given);
        Ok((is_consistent, all))
    }

    /// Returns the contacts at rest, except for those that are `fixed`, that touch no other. There are none in a system with
    /// contacts that open: which bodies these keep together is not known.
    fn alone(&self, given: &Phases, fixed: &[usize]) -> SeparateContacts {
        let (of_contacts, of_gaps) = given.split_at(self.contacts());
        let touches = |contact: usize| {
            let gaps = self.gaps.iter().zip(of_gaps);
            let mut closed = gaps.filter(|(_, phase)| **phase == Phase::Closed);
            closed.any(|(gap, _)| gap.contacts.contains(&contact))
        };
        let is_alone = |(contact, phase): &(usize, &Phase)| {
            self.openings.is_empty()
                && matches!(phase, Phase::Stick | Phase::Transition(_))
                && !fixed.contains(contact)
                && !touches(*contact)
        };
        let contacts: SmallVec<[usize; 8]> =
            of_contacts.iter().enumerate().filter(is_alone).map(|(contact, _)| contact).collect();
        let limit = |contact: &usize| self.evaluator.system().friction(*contact).limit;
        SeparateContacts {
            limits: contacts.iter().map(limit).collect(),
            contacts,
            sets_off: self.sets_off(),
            slack: self.slack(),
        }
    }

    /// Returns forces that tell two motions apart, those of the openings behind those of the contacts, and by which the normal forces
    /// are sound: an opening is a contact, too, and its conditions are known to hold.
    fn of_motion(&self, (mut forces, gaps): (Forces, SmallVec<[GapForces; 8]>)) -> Forces {
        for (opening, found) in self.openings.iter().zip(&gaps[self.gaps.len()..]) {
            let contact = &mut forces[opening.contact];
            if contact.normal.is_finite() {
                contact.normal = 1.0;
            }
            let opens = ContactForces { acceleration: found.opening_acceleration, ..*contact };
            forces.push(opens);
        }
        forces
    }

    /// Returns the largest acceleration with which what is left of the gaps of contacts that touch decays. Bodies that are held cannot
    /// follow it, and conditions of motion allow for it.
    fn residual_of_gaps(&self, state: &[f64], phases: &[Phase]) -> f64 {
        let at = self.evaluator.openings(|component| state[component]);
        let touching = self.openings.iter().zip(at);
        let touching = touching.filter(|(opening, _)| phases[opening.contact] != Phase::Apart);
        touching.map(|(_, [gap, speed, _])| gap.abs() + 2.0 * speed.abs()).fold(0.0, f64::max)
    }

    /// Returns the slack of the conditions.
    fn slack(&self) -> f64 {
        match self.settings.method {
            Method::Switch => switch_model::SLACK,
            Method::Event => event_driven::tie(self.evaluator.system().force_scale()),
        }
    }

    /// Returns all consistent combinations of the phases that are open to decision.
    fn combinations(&self, given: &Phases, fixed: &[usize]) -> Result<Vec<Phases>, Failure> {
        let mut all = Vec::new();
        self.combine(&mut Phases::new(), given, fixed, &mut all)?;
        Ok(all)
    }

    /// Adds the consistent combinations that begin with some phases.
    fn combine(
        &self,
        begun: &mut Phases,
        given: &Phases,
        fixed: &[usize],
        all: &mut Vec<Phases>,
    ) -> Result<(), Failure> {
        let place = begun.len();
        let Some(phase) = given.get(place) else {
            all.push(begun.clone());
            let few = all.len() <= MOST_TRIED;
            return few.then_some(()).ok_or(Failure::TooManyCombinations);
        };
        let choices: SmallVec<[Phase; 4]> = match phase {
            _ if fixed.contains(&place) => [*phase].into_iter().collect(),
            Phase::Stick | Phase::Transition(_) => {
                let directions = [Direction::Forward, Direction::Backward];
                let sets_off = directions.map(self.sets_off());
                [Phase::Stick].into_iter().chain(sets_off).chain(self.apart(place)).collect()
            }
            Phase::Slip(_) | Phase::Free => [*phase].into_iter().chain(self.apart(place)).collect(),
            Phase::Closed => [Phase::Closed, Phase::Open].into_iter().collect(),
            other => [*other].into_iter().collect(),
        };
        for choice in choices {
            begun.push(choice);
            if self.is_consistent(begun, given) {
                self.combine(begun, given, fixed, all)?;
            }
            begun.pop();
        }
        Ok(())
    }

    /// Returns the further choice of a contact that opens.
    fn apart(&self, contact: usize) -> Option<Phase> {
        self.openings.iter().any(|opening| opening.contact == contact).then_some(Phase::Apart)
    }

    /// Returns the phase of a contact that sets off in a direction.
    fn sets_off(&self) -> fn(Direction) -> Phase {
        match self.settings.method {
            Method::Switch => Phase::Transition,
            Method::Event => Phase::Slip,
        }
    }

    /// Returns whether the last one of the phases, which may be followed by others, agrees with those before it: contacts that
    /// touch do not move into each other, those of a closed gap move together, and no gap opens between two that stick.
    fn is_consistent(&self, begun: &[Phase], given: &Phases) -> bool {
        let (contacts, place) = (self.contacts(), begun.len() - 1);
        let gaps = self.gaps;
        let was_closed = |gap: usize| given[contacts + gap] == Phase::Closed;
        let of = |gap: usize| gaps[gap].contacts.map(|contact| begun[contact]);
        let is_free = |of: [Phase; 2]| of.contains(&Phase::Free);
        if place >= contacts {
            let ([behind, ahead], gap) = (of(place - contacts), place - contacts);
            return match begun[place] {
                Phase::Closed => is_free([behind, ahead]) || direction(behind) == direction(ahead),
                _ => !was_closed(gap) || [behind, ahead] != [Phase::Stick; 2],
            };
        }
        let is_last = |gap: &usize| gaps[*gap].contacts.into_iter().max() == Some(place);
        (0..gaps.len()).filter(is_last).filter(|gap| was_closed(*gap)).all(|gap| {
            let [behind, ahead] = of(gap);
            is_free([behind, ahead]) || direction(behind) <= direction(ahead)
        })
    }

    /// Returns whether contacts that stick do not accelerate, and those that touch do not move apart or into each other. Where equations
    /// are dependent, they may contradict each other, as of a body between two walls that close in on it.
    fn agree(
        &self,
        phases: &Phases,
        (forces, gaps): (&Forces, &[GapForces]),
        residual: f64,
    ) -> bool {
        let scale = forces.iter().fold(1.0, |most: f64, of| most.max(of.acceleration.abs()));
        let most = AGREE * scale + residual;
        let sticks = |(of, phase): (&ContactForces, &Phase)| {
            *phase != Phase::Stick || of.acceleration.abs() <= most + of.speed.abs()
        };
        let touches = |(opening, of): (&Opening, &GapForces)| {
            phases[opening.contact] == Phase::Apart || of.opening_acceleration.abs() <= most
        };
        forces.iter().zip(phases).all(sticks)
            && self.openings.iter().zip(&gaps[self.gaps.len()..]).all(touches)
    }

    /// Returns whether phases meet all conditions, with this slack of forces and of accelerations, and this least force of contacts that
    /// may open. Gaps that are closed in `given` touch.
    fn fits(
        &self,
        phases: &Phases,
        given: &Phases,
        (forces, gap_forces): (&Forces, &[GapForces]),
        (fixed, released): (&[usize], Option<usize>),
        [slack, for_motion, least]: [f64; 3],
    ) -> bool {
        let scale = || forces.iter().fold(1.0, |most: f64, of| most.max(of.acceleration.abs()));
        let (of_contacts, of_gaps) = phases.split_at(self.contacts());
        let was_closed = &given[self.contacts()..];
        let gaps = self.gaps.iter().zip(of_gaps).zip(gap_forces).zip(was_closed);
        for (((gap, phase), forces), was) in gaps {
            let sticks = gap.contacts.iter().all(|contact| phases[*contact] == Phase::Stick);
            let holds = match phase {
                Phase::Closed => sticks || forces.force >= -slack * gap.reduced_mass(),
                _ if *was == Phase::Closed => !sticks && forces.opening_acceleration >= -slack,
                _ => true,
            };
            if !holds {
                return false;
            }
        }
        for (opening, found) in self.openings.iter().zip(&gap_forces[self.gaps.len()..]) {
            let holds = match (phases[opening.contact], given[opening.contact]) {
                (Phase::Apart, Phase::Apart) => true,
                (Phase::Apart, _) if released == Some(opening.contact) => {
                    found.opening_acceleration >= -RELEASED * scale()
                }
                (Phase::Apart, _) => found.opening_acceleration >= -for_motion,
                _ => found.force >= least,
            };
            if !holds {
                return false;
            }
        }
        let clusters = held_clusters(self.gaps, phases);
        let in_cluster =
            |contact: usize| clusters.iter().any(|cluster| cluster.contacts.contains(&contact));
        let limit = |contact: usize| self.evaluator.system().friction(contact).limit;
        let holds = |contact: usize| {
            let ContactForces { acceleration, normal, friction, .. } = forces[contact];
            match of_contacts[contact] {
                Phase::Stick if fixed.contains(&contact) || in_cluster(contact) => true,
                Phase::Stick => limit(contact) * normal - friction.abs() >= -slack,
                Phase::Transition(direction) => direction * acceleration >= -for_motion,
                // It was at rest, and sets off.
                Phase::Slip(direction) if given[contact] == Phase::Stick => {
                    direction * acceleration >= -for_motion
                }
                _ => true,
            }
        };
        let pair = |contact: usize| [forces[contact].normal, forces[contact].friction];
        let held = |cluster: &HeldCluster| {
            let is_fixed = cluster.contacts.iter().any(|contact| fixed.contains(contact));
            is_fixed || cluster.holding(limit, pair).reserve >= -slack
        };
        (0..of_contacts.len()).all(holds) && clusters.iter().all(held)
    }
}

/// Returns the direction in which a contact moves or sets off; 0 if it sticks.
fn direction(phase: Phase) -> f64 {
    phase.mode().direction()
}
