//! The joint decision between stick and slip, closed and open, where contacts touch each other or may open.
//!
//! All combinations of the open decisions are tried. A combination holds if
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
use super::impact::{Impact, impact};
use super::in_one_state::TOGETHER;
use super::lockstep::width;
use super::modes::{check_forces, first_phases, is_finite, only_motion};
use super::response::Meets;
use super::{Direction, Evaluator, Failure, Phase, Phases, Settings, event_driven, switch_model};
use crate::model::{Components, Dual, Gap, Holding, Method, Opening, TOUCHING};

/// The most combinations that are tried.
const MOST_TRIED: usize = 100_000;

/// So few combinations are computed one by one.
const FEW: usize = 3;

/// Bodies that start deeper in each other than this, non-dimensional, are no start of a motion.
const DEEPEST: f64 = 1e-6;

/// Sliding speeds up to this, over 1 and the opening and sliding speeds before an impact, are zero after it.
const STOPPED: f64 = 1e-12;

/// A system whose contacts may touch each other, or may open, for decisions in one state.
pub(super) struct InTouch<'a> {
    pub(super) evaluator: &'a Evaluator,
    pub(super) gaps: &'a [Gap],
    pub(super) openings: &'a [Opening],
    settings: Settings,
}

impl<'a> InTouch<'a> {
    /// Returns the system of an evaluator, if it has gaps or openings.
    pub(super) fn new(evaluator: &'a Evaluator, settings: Settings) -> Option<Self> {
        let touching = evaluator.system().touching();
        let openings = &evaluator.graph().openings[..];
        let gaps = touching.map_or(&[][..], |touching| touching.gaps());
        let is_any = touching.is_some() || !openings.is_empty();
        is_any.then_some(InTouch { evaluator, gaps, openings, settings })
    }

    pub(super) fn contacts(&self) -> usize {
        self.evaluator.graph().contacts.len()
    }

    /// Returns the component that is the position of a contact.
    fn position(&self, contact: usize) -> usize {
        self.evaluator.graph().layout.contacts[contact].position
    }

    /// Returns the component that is the speed of a contact, if it is one.
    pub(super) fn speed_component(&self, contact: usize) -> Option<usize> {
        self.evaluator.graph().speed_component(contact)
    }

    /// Returns the component that is the speed of a contact next to a gap.
    ///
    /// # Panics
    /// Panics if the speed is no component; the crate's own systems make sure of that.
    pub(super) fn speed_at_gap(&self, contact: usize) -> usize {
        self.speed_component(contact).expect("speeds next to gaps are components")
    }

    pub(super) fn width(&self, gap: &Gap, state: &[f64]) -> f64 {
        gap.width(gap.contacts.map(|contact| state[self.position(contact)]))
    }

    /// Decides the phases at the start of a motion. Contacts that start at each other meet; those of them that do not approach
    /// each other have been in contact before.
    pub(super) fn start(&self, state: &mut Components) -> Result<(Phases, Impact), Failure> {
        let mut phases = self.evaluator.no_phases();
        let (of_contacts, of_gaps) = phases.split_at_mut(self.contacts());
        of_contacts.fill(Phase::Transition(Direction::Forward));
        for (gap, phase) in self.gaps.iter().zip(of_gaps) {
            let [behind, ahead] = gap.contacts.map(|contact| state[self.speed_at_gap(contact)]);
            if behind <= ahead {
                *phase = Phase::Closed;
            }
        }
        let at = self.evaluator.openings(|component| state[component]);
        for (opening, [gap, speed, _]) in self.openings.iter().zip(at) {
            if gap < -DEEPEST {
                return Err(Failure::Overlap { contact: opening.contact + 1 });
            }
            if gap > TOUCHING || speed < 0.0 {
                of_contacts[opening.contact] = Phase::Apart;
            }
        }
        let impact = self.meet(state, &mut phases, None)?;
        Ok((phases, impact))
    }

    /// Resolves the impact of the contacts that are at each other, and decides the phases after it. If a direction of a
    /// neighbouring motion is given, it becomes that after the impact.
    pub(super) fn meet(
        &self,
        state: &mut Components,
        phases: &mut Phases,
        direction: Option<&mut [f64]>,
    ) -> Result<Impact, Failure> {
        let contacts = self.contacts();
        for (contact, phase) in phases[..contacts].iter().enumerate() {
            // What is left of its speed in the band moves nothing.
            if *phase == Phase::Stick {
                self.stop(contact, state);
            }
        }
        let gaps = self.gaps;
        let at = self.evaluator.openings(|component| state[component]);
        let touches = |one: &usize| {
            phases[self.openings[*one].contact] != Phase::Apart || at[*one][0] <= TOUCHING
        };
        let at_gaps = (0..gaps.len()).filter(|gap| self.width(&gaps[*gap], state) <= TOUCHING);
        let at_openings = (0..self.openings.len()).filter(touches);
        let at_each_other: SmallVec<[Meets; 8]> =
            at_gaps.map(Meets::Gap).chain(at_openings.map(Meets::Opening)).collect();
        let slope = |place: usize| direction.as_ref().map_or(0.0, |direction| direction[place]);
        let before: SmallVec<[Dual; 20]> = state
            .iter()
            .enumerate()
            .map(|(place, value)| Dual { value: *value, slope: slope(place) })
            .collect();
        let impact = impact(self.evaluator, &before, &at_each_other, phases)?;
        state.iter_mut().zip(&impact.state).for_each(|(to, after)| *to = after.value);
        if let Some(direction) = direction {
            direction.iter_mut().zip(&impact.state).for_each(|(to, after)| *to = after.slope);
        }
        for place in &at_each_other {
            let Meets::Gap(gap) = place else { continue };
            let gap = &gaps[*gap];
            let ahead = self.position(gap.contacts[1]);
            state[ahead] -= self.width(gap, state);
        }
        for gap in 0..gaps.len() {
            let closed = impact.together.contains(&Meets::Gap(gap));
            phases[contacts + gap] = if closed { Phase::Closed } else { Phase::Open };
        }
        self.join(state, phases, None);
        let mut speeds = self.evaluator.speeds(state);
        for (opening, [_, approach, sliding]) in self.openings.iter().zip(&at) {
            if speeds[opening.contact].abs() <= STOPPED * (1.0 + approach.abs() + sliding.abs()) {
                speeds[opening.contact] = 0.0;
                self.stop(opening.contact, state);
            }
        }
        let system = self.evaluator.system();
        let of_contacts = (0..contacts).map(|one| (system.friction(one), speeds[one]));
        let first = first_phases(self.settings.method, self.settings.band, of_contacts);
        phases[..contacts].copy_from_slice(&first);
        for (one, opening) in self.openings.iter().enumerate() {
            if !impact.together.contains(&Meets::Opening(one)) {
                phases[opening.contact] = Phase::Apart;
            }
        }
        self.bring_to_rest(state, phases);
        self.decide(state, phases, &[])?;
        Ok(impact)
    }

    /// Decides the phases where the condition of a contact or a gap has failed: `failed` is a contact. `at_once` is a contact
    /// that stops at the instant at which it set off; it stays at rest.
    pub(super) fn switch(
        &self,
        state: &mut Components,
        phases: &mut Phases,
        failed: Option<usize>,
        at_once: Option<usize>,
    ) -> Result<(), Failure> {
        self.join(state, phases, failed);
        let speeds = self.evaluator.speeds(state);
        let mut fixed: SmallVec<[usize; 1]> = SmallVec::new();
        match self.settings.method {
            Method::Switch => {
                switch_model::cross_band(self.settings.band, phases, |one| speeds[one]);
            }
            Method::Event => {
                let (_, stopped) = event_driven::stop(phases, |one| speeds[one], at_once);
                for (contact, _) in stopped.iter().enumerate().filter(|(_, stopped)| **stopped) {
                    self.stop(contact, state);
                }
                fixed.extend(at_once.filter(|one| stopped[*one]));
            }
        }
        self.close(state, phases);
        self.bring_to_rest(state, phases);
        self.decide(state, phases, &fixed)
    }

    /// Decides the phases of contacts at rest or in the band, and of closed gaps. The contacts `fixed` stay as they are.
    fn decide(&self, state: &[f64], phases: &mut Phases, fixed: &[usize]) -> Result<(), Failure> {
        let slack = self.slack();
        let given = phases.clone();
        let all = self.combinations(phases, fixed)?;
        let mut equations = self.evaluator.in_state(state);
        type Found = (Forces, SmallVec<[GapForces; 8]>);
        let fits = |candidate: &Phases, (forces, gaps): &Found, least: f64| {
            let fit = || self.fits(candidate, &given, (forces, gaps), fixed, [slack, least]);
            !forces.iter().all(is_finite) || fit()
        };
        // A contact opens where its normal force is certainly negative, by half of the width within which this is located.
        let least = -0.25 * width(self.settings.tolerance.relative);
        // The given combination is tried first, alone.
        let is_given = |one: &Phases| *one == given;
        let is_consistent = all.iter().any(is_given);
        let others: Vec<Phases> = all.into_iter().filter(|one| !is_given(one)).collect();
        // Most combinations do not fit. Those that fit to rounding are computed once more, alone.
        let mut likely: Vec<Phases> = Vec::new();
        for some in others.chunks(TOGETHER) {
            if some.len() < FEW {
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
        let mut only = |least: f64| {
            only_motion(&given, likely.iter().cloned(), |candidate| {
                if !is_consistent && *candidate == given {
                    return None;
                }
                let found = equations.forces_and_gaps(candidate);
                fits(candidate, &found, least).then(|| self.of_motion(candidate, found))
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

    /// Returns forces that tell two motions apart, and by which the normal forces are sound: an opening is a contact, too, and
    /// its conditions are known to hold.
    fn of_motion(
        &self,
        phases: &[Phase],
        (mut forces, gaps): (Forces, SmallVec<[GapForces; 8]>),
    ) -> Forces {
        for (opening, found) in self.openings.iter().zip(&gaps[self.gaps.len()..]) {
            let contact = &mut forces[opening.contact];
            if contact.normal.is_finite() {
                contact.normal = 1.0;
            }
            if phases[opening.contact] == Phase::Apart {
                contact.acceleration = found.opening_acceleration;
            }
        }
        forces
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
        let Some(own) = given.get(place) else {
            all.push(begun.clone());
            let few = all.len() <= MOST_TRIED;
            return few.then_some(()).ok_or(Failure::TooManyCombinations);
        };
        let choices: SmallVec<[Phase; 4]> = match own {
            _ if fixed.contains(&place) => [*own].into_iter().collect(),
            Phase::Stick | Phase::Transition(_) => {
                self.choices().into_iter().chain(self.apart(place)).collect()
            }
            Phase::Slip(_) | Phase::Free => [*own].into_iter().chain(self.apart(place)).collect(),
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
        self.openings.iter().any(|one| one.contact == contact).then_some(Phase::Apart)
    }

    fn choices(&self) -> [Phase; 3] {
        match self.settings.method {
            Method::Switch => [
                Phase::Stick,
                Phase::Transition(Direction::Forward),
                Phase::Transition(Direction::Backward),
            ],
            Method::Event => {
                [Phase::Stick, Phase::Slip(Direction::Forward), Phase::Slip(Direction::Backward)]
            }
        }
    }

    /// Returns whether the last one of the phases, which may be followed by others, agrees with those before it: contacts that
    /// touch do not move into each other, those of a closed gap move together, and no gap opens between two that stick.
    fn is_consistent(&self, begun: &[Phase], given: &Phases) -> bool {
        let (contacts, place) = (self.contacts(), begun.len() - 1);
        let gaps = self.gaps;
        let was_closed = |gap: usize| given[contacts + gap] == Phase::Closed;
        let of = |gap: usize| gaps[gap].contacts.map(|one| begun[one]);
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

    /// Returns whether phases meet all conditions, with this slack and this least force of contacts that may open. Gaps that are
    /// closed in `given` touch.
    fn fits(
        &self,
        phases: &Phases,
        given: &Phases,
        (forces, gap_forces): (&Forces, &[GapForces]),
        fixed: &[usize],
        [slack, least]: [f64; 2],
    ) -> bool {
        let (of_contacts, of_gaps) = phases.split_at(self.contacts());
        let was_closed = &given[self.contacts()..];
        let gaps = self.gaps.iter().zip(of_gaps).zip(gap_forces).zip(was_closed);
        for (((gap, phase), forces), was) in gaps {
            let sticks = gap.contacts.iter().all(|one| phases[*one] == Phase::Stick);
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
                (Phase::Apart, _) => found.opening_acceleration >= -slack,
                _ => found.force >= least,
            };
            if !holds {
                return false;
            }
        }
        let clusters = held_clusters(self.gaps, phases);
        let in_cluster =
            |contact: usize| clusters.iter().any(|one| one.contacts.contains(&contact));
        let holds = |contact: usize| {
            let ContactForces { acceleration, normal, friction, .. } = forces[contact];
            match of_contacts[contact] {
                Phase::Stick if fixed.contains(&contact) || in_cluster(contact) => true,
                Phase::Stick => {
                    let limit = self.evaluator.system().friction(contact).limit;
                    limit * normal - friction.abs() >= -slack
                }
                Phase::Transition(direction) => direction * acceleration >= -slack,
                // It was at rest, and sets off.
                Phase::Slip(direction) if given[contact] == Phase::Stick => {
                    direction * acceleration >= -slack
                }
                _ => true,
            }
        };
        let held = |cluster: &HeldCluster| {
            let is_fixed = cluster.contacts.iter().any(|contact| fixed.contains(contact));
            is_fixed || self.holding(cluster, forces).reserve >= -slack
        };
        (0..of_contacts.len()).all(holds) && clusters.iter().all(held)
    }

    /// Returns the forces that hold contacts that stick and touch.
    fn holding(&self, cluster: &HeldCluster, forces: &Forces) -> Holding {
        let system = self.evaluator.system();
        cluster.holding(
            |contact| system.friction(contact).limit,
            |contact| [forces[contact].normal, forces[contact].friction],
        )
    }
}

/// Returns the direction in which a contact moves or sets off; 0 if it sticks.
fn direction(phase: Phase) -> f64 {
    phase.mode().direction()
}
