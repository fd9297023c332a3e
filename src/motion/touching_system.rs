//! Contacts that touch each other or may open: the start of a motion, and their phases after impacts and other events.
//!
//! What is left of the speeds of bodies that touch or stick, to rounding or in the band, is removed before their phases are
//! decided.

use smallvec::SmallVec;

use super::condition::Condition;
use super::impact::{Impact, impact};
use super::impulse_response::ImpactPlace;
use super::stick_slip::first_phases;
use super::{Direction, Evaluator, Failure, Phase, Phases, Settings, event_driven, switch_model};
use crate::model::{Components, Dual, Gap, Method, Opening, TOUCHING};

/// Bodies that start deeper in each other than this, non-dimensional, are no start of a motion.
const DEEPEST: f64 = 1e-6;

/// Sliding speeds up to this, over 1 and the opening and sliding speeds before an impact, are zero after it.
const STOPPED: f64 = 1e-12;

/// Bodies in touch that move more slowly than this, non-dimensional, rest: rounding is left of their speeds.
pub(crate) const STILL: f64 = 1e-12;
/// A sliding speed that depends on the velocities with a factor below this vanishes with the factor, as that of a crank at its dead
/// centre: no friction stops the velocities there.
pub(super) const VANISHES: f64 = 1e-6;
/// The least and the largest number of times that all speeds at rest are removed in turn.
const SWEEPS: (usize, usize) = (20, 200);
/// What is left of speeds at rest, non-dimensional, when they are no longer removed after the least number of times.
const LEFT: f64 = 1e-15;

/// Returns whether bodies that may separate touch, and do not move apart.
pub(crate) fn lies([gap, speed, _]: &[f64; 3]) -> bool {
    gap.abs() <= TOUCHING && speed.abs() <= STILL
}

/// A system whose contacts may touch each other, or may open, for decisions in one state.
pub(super) struct TouchingSystem<'a> {
    pub(super) evaluator: &'a Evaluator,
    pub(super) gaps: &'a [Gap],
    pub(super) openings: &'a [Opening],
    pub(super) settings: Settings,
}

impl<'a> TouchingSystem<'a> {
    /// Returns the system of an evaluator, if it has gaps or openings.
    pub(super) fn new(evaluator: &'a Evaluator, settings: Settings) -> Option<Self> {
        let touching = evaluator.system().touching();
        let openings = &evaluator.graph().openings[..];
        let gaps = touching.map_or(&[][..], |touching| touching.gaps());
        let is_any = touching.is_some() || !openings.is_empty();
        is_any.then_some(TouchingSystem { evaluator, gaps, openings, settings })
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
        let impact = self.meet(state, &mut phases)?;
        Ok((phases, impact))
    }

    /// Resolves the impact of the contacts that are at each other, and decides the phases after it.
    pub(super) fn meet(
        &self,
        state: &mut Components,
        phases: &mut Phases,
    ) -> Result<Impact, Failure> {
        let impact = self.collide(state, phases, |_| true, None)?;
        self.decide(state, phases, &[], None)?;
        Ok(impact)
    }

    /// Returns the place in which contacts meet where a condition has failed; `None` for a condition that begins no impact.
    pub(super) fn place_of(&self, failed: Condition) -> Option<ImpactPlace> {
        let opening = |contact: usize| self.openings.iter().position(|one| one.contact == contact);
        match failed {
            Condition::Gap(gap) => Some(ImpactPlace::Gap(gap)),
            Condition::Landing(contact) => Some(ImpactPlace::Opening(opening(contact)?)),
            _ => None,
        }
    }

    /// Returns the places in which contacts that were apart meet in a state.
    pub(super) fn meeting(&self, phases: &[Phase], state: &[f64]) -> SmallVec<[ImpactPlace; 2]> {
        let at = self.evaluator.openings(|component| state[component]);
        let lands = |opening: &usize| {
            let [gap, speed, _] = at[*opening];
            let is_apart = phases[self.openings[*opening].contact] == Phase::Apart;
            is_apart && gap <= TOUCHING && speed < 0.0
        };
        let closes = |gap: &usize| {
            let between = &self.gaps[*gap];
            let speed = |contact: usize| state[self.speed_at_gap(contact)];
            let [behind, ahead] = between.contacts.map(speed);
            let is_open = phases[self.contacts() + gap] == Phase::Open;
            is_open && self.width(between, state) <= TOUCHING && behind > ahead
        };
        let gaps = (0..self.gaps.len()).filter(closes).map(ImpactPlace::Gap);
        gaps.chain((0..self.openings.len()).filter(lands).map(ImpactPlace::Opening)).collect()
    }

    /// Resolves the impact of the contacts that are at each other, where those that were apart before take part if `meets` says so. The
    /// phases that it returns are not decided yet. If a direction of a neighbouring motion is given, it becomes that after the impact.
    pub(super) fn collide(
        &self,
        state: &mut Components,
        phases: &mut Phases,
        meets: impl Fn(ImpactPlace) -> bool,
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
        let touches = |opening: &usize| {
            let meets = || meets(ImpactPlace::Opening(*opening));
            let is_apart = phases[self.openings[*opening].contact] == Phase::Apart;
            !is_apart || at[*opening][0] <= TOUCHING && meets()
        };
        let at_gaps = (0..gaps.len()).filter(|gap| {
            let meets = || phases[contacts + gap] != Phase::Open || meets(ImpactPlace::Gap(*gap));
            self.width(&gaps[*gap], state) <= TOUCHING && meets()
        });
        let at_openings = (0..self.openings.len()).filter(touches);
        let at_each_other: SmallVec<[ImpactPlace; 8]> =
            at_gaps.map(ImpactPlace::Gap).chain(at_openings.map(ImpactPlace::Opening)).collect();
        let impact = match direction {
            None => impact(self.evaluator, state, &at_each_other, phases)?,
            Some(direction) => {
                let both = state.iter().zip(&*direction);
                let mut dual: SmallVec<[Dual; 20]> =
                    both.map(|(value, slope)| Dual { value: *value, slope: *slope }).collect();
                let impact = impact(self.evaluator, &mut dual, &at_each_other, phases)?;
                state.iter_mut().zip(&dual).for_each(|(to, after)| *to = after.value);
                direction.iter_mut().zip(&dual).for_each(|(to, after)| *to = after.slope);
                impact
            }
        };
        for place in &at_each_other {
            let ImpactPlace::Gap(gap) = place else { continue };
            let gap = &gaps[*gap];
            let ahead = self.position(gap.contacts[1]);
            state[ahead] -= self.width(gap, state);
        }
        for gap in 0..gaps.len() {
            let closed = impact.together.contains(&ImpactPlace::Gap(gap));
            phases[contacts + gap] = if closed { Phase::Closed } else { Phase::Open };
        }
        self.join(state, phases, None);
        let mut speeds = self.evaluator.speeds(state);
        for (opening, [_, approach, sliding]) in self.openings.iter().zip(&at) {
            let is_slow =
                speeds[opening.contact].abs() <= STOPPED * (1.0 + approach.abs() + sliding.abs());
            if is_slow || impact.stopped.contains(&opening.contact) {
                speeds[opening.contact] = 0.0;
                self.stop(opening.contact, state);
            }
        }
        let system = self.evaluator.system();
        let of_contacts = (0..contacts).map(|contact| (system.friction(contact), speeds[contact]));
        let first = first_phases(self.settings.method, self.settings.band, of_contacts, &[]);
        phases[..contacts].copy_from_slice(&first);
        for (index, opening) in self.openings.iter().enumerate() {
            if !impact.together.contains(&ImpactPlace::Opening(index)) {
                phases[opening.contact] = Phase::Apart;
            }
        }
        self.bring_to_rest(state, phases);
        Ok(impact)
    }

    /// Decides the phases where the condition of a contact or a gap has failed: `failed` is a contact, and whether its normal force
    /// has become negative. `at_once` is a contact that stops at the instant at which it set off; it stays at rest.
    pub(super) fn switch(
        &self,
        state: &mut Components,
        phases: &mut Phases,
        failed: Option<(usize, bool)>,
        at_once: Option<usize>,
    ) -> Result<(), Failure> {
        let contact = failed.map(|(contact, _)| contact);
        self.join(state, phases, contact);
        let speeds = self.evaluator.speeds(state);
        let mut fixed: SmallVec<[usize; 1]> = SmallVec::new();
        match self.settings.method {
            Method::Switch => {
                switch_model::cross_band(self.settings.band, phases, |contact| speeds[contact]);
            }
            Method::Event => {
                let (_, stopped) = event_driven::stop(phases, |contact| speeds[contact], at_once);
                for (contact, _) in stopped.iter().enumerate().filter(|(_, stopped)| **stopped) {
                    self.stop(contact, state);
                }
                fixed.extend(at_once.filter(|contact| stopped[*contact]));
            }
        }
        self.close(state, phases);
        self.bring_to_rest(state, phases);
        let released = failed.filter(|(_, released)| *released).map(|(contact, _)| contact);
        self.decide(state, phases, &fixed, released)
    }

    /// Stops a contact, if its speed is a component.
    fn stop(&self, contact: usize, state: &mut [f64]) {
        if let Some(speed) = self.speed_component(contact) {
            state[speed] = 0.0;
        }
    }

    /// Makes the speeds of contacts that touch equal, which differ by rounding: to that of the contact `failed`, if it is
    /// one of them.
    fn join(&self, state: &mut Components, phases: &[Phase], failed: Option<usize>) {
        for cluster in self.evaluator.clusters(phases) {
            let leader = failed.filter(|contact| cluster.contains(contact)).unwrap_or(cluster[0]);
            let speed = state[self.speed_at_gap(leader)];
            for contact in cluster {
                state[self.speed_at_gap(contact)] = speed;
            }
        }
    }

    /// Closes the gaps whose contacts are at each other with equal speeds, such as two that have stopped there. Bodies that lie at
    /// each other without a force touch again, too: one of them may set off towards the other.
    ///
    /// An impact moves all contacts a little. Contacts that rest in touch separate by less than can be resolved, and stop
    /// again. Where one of them needs the force of the other, it would then fall on it over the width within which impacts
    /// are located, and this impact would separate others in the same way, without end.
    fn close(&self, state: &[f64], phases: &mut Phases) {
        let at = self.evaluator.openings(|component| state[component]);
        let lie = |place: &usize| {
            phases[self.openings[*place].contact] == Phase::Apart && lies(&at[*place])
        };
        let that_lie: SmallVec<[usize; 4]> = (0..at.len()).filter(lie).collect();
        for place in that_lie {
            let contact = self.openings[place].contact;
            let friction = self.evaluator.system().friction(contact);
            let touching = std::iter::once((friction, at[place][2]));
            phases[contact] =
                first_phases(self.settings.method, self.settings.band, touching, &[Phase::Stick])
                    [0];
        }
        for (gap, phase) in self.gaps.iter().zip(&mut phases[self.contacts()..]) {
            let [behind, ahead] = gap.contacts.map(|contact| state[self.speed_at_gap(contact)]);
            if behind == ahead && self.width(gap, state) <= TOUCHING {
                *phase = Phase::Closed;
            }
        }
    }

    /// Removes what is left of opening speeds where bodies touch, and of sliding speeds where they stick, by impulses of the
    /// contacts, each in turn. The friction that sticking requires would contain what decays of these speeds, and no decision
    /// would meet all conditions within their slack.
    fn bring_to_rest(&self, state: &mut Components, phases: &[Phase]) {
        let graph = self.evaluator.graph();
        let touching: SmallVec<[usize; 4]> = (0..self.openings.len())
            .filter(|opening| phases[self.openings[*opening].contact] != Phase::Apart)
            .collect();
        if touching.is_empty() {
            return;
        }
        let places: SmallVec<[ImpactPlace; 4]> =
            touching.iter().map(|opening| ImpactPlace::Opening(*opening)).collect();
        let responses = self.evaluator.responses(&state[..], &places);
        let mut speeds = self.evaluator.openings(|place| state[place]);
        for sweep in 1..=SWEEPS.1 {
            let mut largest: f64 = 0.0;
            for (opening, response) in touching.iter().zip(responses.chunks(2)) {
                let contact = self.openings[*opening].contact;
                let slides = phases[contact] != Phase::Stick;
                for (which, by) in response.iter().enumerate().take(if slides { 1 } else { 2 }) {
                    let answer = by.openings[*opening][which];
                    let left = speeds[*opening][1 + which];
                    if answer == 0.0 || left == 0.0 {
                        continue;
                    }
                    let impulse = -left / answer;
                    let change = by.components.iter().fold(0.0, |most: f64, by| most.max(by.abs()));
                    if which == 1 && VANISHES * (impulse * change).abs() > left.abs() {
                        continue;
                    }
                    largest = largest.max(left.abs());
                    for (value, by) in state.iter_mut().zip(&by.components) {
                        *value += impulse * by;
                    }
                    for (speeds, by) in speeds.iter_mut().zip(&by.openings) {
                        speeds[1] += impulse * by[0];
                        speeds[2] += impulse * by[1];
                    }
                }
                if !slides && graph.speed_component(contact).is_some() {
                    self.stop(contact, state);
                }
            }
            if sweep >= SWEEPS.0 && largest <= LEFT {
                break;
            }
        }
    }
}
