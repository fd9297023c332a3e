//! Properties of one period of a cycle: sequence of stick and slip, extremes, means, margins.

use super::cycle::{CyclePhase, TouchingPair};
use super::output_watch::{OutputWatch, maximum};
use super::section::Section;
use super::system_view::SystemView;
use super::window::{NODES, WEIGHTS};
use crate::model::{Components, TOUCHING};
use crate::motion::{Motion, PerContact, Phase};

/// Number of instants inside a step at which a resting contact's margin is evaluated.
const LOOKS: usize = 8;

/// The latest step of the followed motion.
pub(super) struct FollowedStep<'a> {
    pub(super) motion: &'a mut Motion,
    /// The difference between the contacts' positions with whole turns and those of the states
    /// within the step.
    pub(super) whole_turns: PerContact,
    /// Time and state of the return, if it is in this step.
    pub(super) end: Option<(f64, &'a [f64])>,
}

/// One period, accumulated step by step.
pub(super) struct Period {
    /// The contacts that rest throughout.
    rests: Vec<usize>,
    time: f64,
    /// The sequence of phases of the contacts.
    pub(super) configurations: Vec<Vec<CyclePhase>>,
    /// For each contact, whether its bodies have met.
    met: Vec<bool>,
    /// For each gap, whether its contacts have touched, and whether they have been apart.
    gaps: Vec<[bool; 2]>,
    /// Least and greatest speed of each contact.
    pub(super) speeds: Vec<[f64; 2]>,
    /// Least and greatest position of each contact.
    pub(super) positions: Vec<[f64; 2]>,
    /// The time for which each contact has stuck.
    pub(super) stuck: Vec<f64>,
    /// Greatest displacement.
    pub(super) peak: f64,
    /// Integral over time of its square.
    pub(super) square_time: f64,
    /// The smallest friction margin of a resting contact.
    pub(super) margin: f64,
    /// The outputs.
    pub(super) outputs: OutputWatch,
}

fn widen([low, high]: &mut [f64; 2], value: f64) {
    (*low, *high) = (low.min(value), high.max(value));
}

impl Period {
    pub(super) fn new(view: &SystemView, section: &Section, start: &[f64]) -> Self {
        let phases = &section.phases;
        let contacts = 0..view.contacts.len();
        let mut period = Period {
            rests: contacts.clone().filter(|&contact| section.rests[contact]).collect(),
            time: 0.0,
            configurations: vec![cycle_phases(view, phases, start)],
            met: vec![false; view.contacts.len()],
            gaps: vec![[false; 2]; phases.len() - view.contacts.len()],
            speeds: contacts.map(|contact| [view.speed(start, contact); 2]).collect(),
            positions: view.wrapped(start).iter().map(|position| [*position; 2]).collect(),
            stuck: vec![0.0; view.contacts.len()],
            peak: view.square(start).sqrt(),
            square_time: 0.0,
            margin: f64::INFINITY,
            outputs: OutputWatch::from(0.0),
        };
        if !period.rests.is_empty() {
            period.margin = view.evaluator.friction_margin(phases, start, &period.rests);
        }
        period.look_at_gaps(view, phases, start);
        period
    }

    /// Returns whether the bodies of a contact stay apart, or touch throughout without sliding although the contact does not stick.
    pub(super) fn is_idle(&self, contact: usize) -> bool {
        let is_apart = |phases: &Vec<CyclePhase>| phases[contact] == CyclePhase::Apart;
        match self.configurations.iter().any(is_apart) {
            true => self.configurations.iter().all(is_apart) && !self.met[contact],
            false => self.speeds[contact] == [0.0; 2],
        }
    }

    /// Returns the contacts that have touched.
    pub(super) fn touching(&self, view: &SystemView) -> Vec<TouchingPair> {
        let gaps = view.system().touching().map_or(&[][..], |touching| touching.gaps());
        let mut pairs: Vec<TouchingPair> = Vec::new();
        for (gap, [_, apart]) in gaps.iter().zip(&self.gaps).filter(|(_, [touched, _])| *touched) {
            let [first, second] = gap.contacts;
            let contacts = [first.min(second), first.max(second)];
            pairs.push(TouchingPair { contacts, throughout: !apart });
        }
        pairs.sort();
        // Two balls have two gaps.
        pairs.dedup_by_key(|pair| pair.contacts);
        pairs
    }

    /// Takes in which contacts touch.
    fn look_at_gaps(&mut self, view: &SystemView, phases: &[Phase], state: &[f64]) {
        let Some(touching) = view.system().touching() else { return };
        let contacts = view.contacts.len();
        for ((gap, phase), seen) in
            touching.gaps().iter().zip(&phases[contacts..]).zip(&mut self.gaps)
        {
            let positions = gap.contacts.map(|contact| state[view.contacts[contact].position]);
            seen[0] |= *phase == Phase::Closed || gap.width(positions) <= TOUCHING;
            seen[1] |= *phase == Phase::Open;
        }
    }

    /// Adds a step, until the end of the period if that is inside the step.
    pub(super) fn take_in(&mut self, view: &SystemView, step: &FollowedStep) {
        let motion = &step.motion;
        let during = motion.phases_during_step();
        // The state at the step's end, with angles not reduced to one turn.
        let at_end = || {
            let mut state = motion.state();
            let unwrapped = motion.unwrapped();
            for (index, contact) in view.contacts.iter().enumerate() {
                state[contact.position] = unwrapped[index] - step.whole_turns[index];
            }
            (motion.time(), state)
        };
        let returned = step.end.map(|(time, state)| (time, Components::from_slice(state)));
        let (time, state) = returned.unwrap_or_else(at_end);
        let length = time - self.time;
        // An impact at the step's end changes the speeds.
        let graph = view.evaluator.graph();
        let jumps =
            !(graph.events.is_empty() && graph.gaps.is_empty() && graph.openings.is_empty());
        let before_events =
            (jumps && step.end.is_none()).then(|| motion.within_last_step(time)).flatten();
        for (stuck, phase) in self.stuck.iter_mut().zip(during) {
            *stuck += if *phase == Phase::Stick { length } else { 0.0 };
        }
        for (node, weight) in NODES.iter().zip(WEIGHTS) {
            let inside = motion.within_last_step(self.time + node * length);
            self.square_time += inside.map_or(0.0, |state| weight * length * view.square(&state));
        }
        self.peak = self.peak.max(view.square(&state).sqrt());
        if let Some((_, outermost)) = motion.falls_through_zero(|state| view.outward(state)) {
            self.peak = self.peak.max(view.square(&outermost).sqrt());
        }
        for (index, contact) in view.contacts.iter().enumerate() {
            let speed = |state: &[f64]| view.speed(state, index);
            let fastest = match contact.speed {
                Some(component) => motion.turns_back(component),
                None => {
                    let rate = |state: &[f64]| view.acceleration(during, state, index);
                    let falls = |sign: f64| motion.falls_through_zero(|state| sign * rate(state));
                    falls(1.0).or_else(|| falls(-1.0)).map(|(_, state)| state)
                }
            };
            for state in fastest.iter().chain(&before_events).chain([&state]) {
                widen(&mut self.speeds[index], speed(state));
            }
            // It turns back where it stops, usually at a switch at the step's end.
            let stops = [1.0, -1.0].map(|sign| {
                let stop = motion.falls_through_zero(|state| sign * speed(state));
                stop.map(|(_, state)| state[contact.position])
            });
            for position in stops.into_iter().flatten().chain([state[contact.position]]) {
                widen(&mut self.positions[index], position + step.whole_turns[index]);
            }
        }
        if !self.rests.is_empty() {
            let lacks = |time: f64| {
                let inside = motion.within_last_step(time);
                let margin =
                    |state: Components| view.evaluator.friction_margin(during, &state, &self.rests);
                -inside.map_or(f64::INFINITY, margin)
            };
            let instant = |look: usize| self.time + look as f64 / LOOKS as f64 * length;
            let looks: Vec<_> = (0..=LOOKS).map(instant).map(|time| (time, lacks(time))).collect();
            let mut most = looks.iter().fold(-self.margin, |most, (_, lack)| most.max(*lack));
            for near in looks.windows(3) {
                most = maximum([near[0], near[1], near[2]], most, lacks).unwrap_or(most);
            }
            self.margin = -most;
        }
        for (contact, gap) in view.evaluator.opening_gaps(&state) {
            self.met[contact] |= gap <= TOUCHING;
        }
        self.look_at_gaps(view, during, &state);
        if view.has_outputs {
            let outputs = |inside: f64| {
                let inside = (inside < time).then(|| motion.within_last_step(inside)).flatten();
                let at_end = || before_events.as_ref().unwrap_or(&state).clone();
                let mut state = inside.unwrap_or_else(at_end);
                view.turn(&mut state, &step.whole_turns);
                view.system().outputs(&state)
            };
            let output = |number: usize, inside: f64| outputs(inside)[number];
            self.outputs.add([self.time, time], |times| times.map(outputs), output);
        }
        // At its end the period returns to its start.
        let now = cycle_phases(view, motion.phases(), &state);
        let ends = step.end.is_some();
        if !ends && self.configurations.last() != Some(&now) {
            self.configurations.push(now);
        }
        if ends
            && self.configurations.len() > 1
            && self.configurations.last() == self.configurations.first()
        {
            self.configurations.pop();
        }
        self.time = time;
    }
}

fn cycle_phases(view: &SystemView, phases: &[Phase], state: &[f64]) -> Vec<CyclePhase> {
    let phases_by_contact = phases.iter().enumerate().take(view.contacts.len());
    let of = |(contact, phase): (usize, &Phase)| CyclePhase::of(*phase, view.speed(state, contact));
    phases_by_contact.map(of).collect()
}
