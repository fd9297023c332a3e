//! Contacts that touch each other or may open: the start of a motion, and their phases after impacts and other events.

use smallvec::SmallVec;

use super::impact::{Impact, impact};
use super::impulse_response::ImpactPlace;
use super::stick_slip::{end_slip, first_phases};
use super::{Direction, Evaluator, Failure, Phase, Phases, Settings};
use crate::model::{Components, Dual, Gap, Opening, TOUCHING};

/// Bodies that start deeper in each other than this, non-dimensional, are no start of a motion.
const DEEPEST: f64 = 1e-6;

/// Sliding speeds up to this, over 1 and the opening and sliding speeds before an impact, are zero after it.
const STOPPED: f64 = 1e-12;

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
        let impact = self.collide(state, phases, None)?;
        self.decide(state, phases, &[])?;
        Ok(impact)
    }

    /// Resolves the impact of the contacts that are at each other. The phases that it returns are not decided yet. If a direction
    /// of a neighbouring motion is given, it becomes that after the impact.
    pub(super) fn collide(
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
        let touches = |opening: &usize| {
            phases[self.openings[*opening].contact] != Phase::Apart || at[*opening][0] <= TOUCHING
        };
        let at_gaps = (0..gaps.len()).filter(|gap| self.width(&gaps[*gap], state) <= TOUCHING);
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
            if speeds[opening.contact].abs() <= STOPPED * (1.0 + approach.abs() + sliding.abs()) {
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
        let stopped = end_slip(self.settings, phases, |contact| speeds[contact]);
        for (contact, _) in stopped.iter().enumerate().filter(|(_, stopped)| **stopped) {
            self.stop(contact, state);
        }
        let fixed = at_once.filter(|contact| stopped[*contact]);
        self.close(state, phases);
        self.bring_to_rest(state, phases);
        self.decide(state, phases, fixed.as_slice())
    }
}
