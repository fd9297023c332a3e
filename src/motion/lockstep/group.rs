//! Eight lanes with the runs in them, computed by a kernel.

use std::f64::consts::TAU;
use std::sync::Arc;

use fearless_simd::prelude::*;
use smallvec::SmallVec;

use super::gaps::GapLanes;
use super::kernel::Kernel;
use super::lane::{Lane, Saved};
use super::lane_group::{Happened, LaneGroup};
use super::{LANES, Lanes, advance};
use crate::model::{Components, System};
use crate::motion::lockstep::vector::{Vector, vectorized};
use crate::motion::settings::MOST_PER_TIME;
use crate::motion::{Effort, Hit, PerContact, Phase, Touches};

/// Eight lanes, some of them empty.
pub(super) struct Group<S: Vector, K: Kernel<S>> {
    pub(super) simd: S,
    pub(super) kernel: K,
    pub(super) gaps: GapLanes<S>,
    pub(super) room: Box<K::Room>,
    pub(super) state: K::Flow,
    pub(super) time: Lanes<S>,
    pub(super) until: Lanes<S>,
    pub(super) attention: Lanes<S>,
    pub(super) longest: Lanes<S>,
    pub(super) next: Lanes<S>,
    pub(super) tolerance: [Lanes<S>; 2],
    pub(super) turns: SmallVec<[Lanes<S>; 8]>,
    pub(super) slow: Lanes<S>,
    pub(super) slow_since: SmallVec<[Lanes<S>; 8]>,
    /// Number of steps taken.
    pub(super) taken: Lanes<S>,
    pub(super) most: Lanes<S>,
    /// Number of steps allowed per unit of time.
    pub(super) most_per_time: Lanes<S>,
    pub(super) displacement: K::Flow,
    pub(super) lanes: [Option<Lane>; LANES],
    /// Bit masks: lanes with a run, and lanes with a contact that cannot stick.
    pub(super) alive: u64,
    pub(super) sliding: u64,
    /// Lanes for which turns and switches are reported.
    pub(super) told: u64,
    /// Lanes whose amplitude is watched, with the square of the amplitude above which a step is reported.
    pub(super) watched: u64,
    pub(super) watched_square: Lanes<S>,
    /// Lanes whose latest step ended with an event.
    pub(super) ended: u64,
    /// Lanes in which an event at the end of the latest step reset the state.
    pub(super) reset: u64,
    /// State, displacement and time before the latest step.
    pub(super) before: K::Flow,
    pub(super) displacement_before: K::Flow,
    pub(super) time_before: Lanes<S>,
    /// The step's end, with angles not yet reduced to one turn.
    pub(super) end: K::Flow,
    pub(super) length: Lanes<S>,
}

impl<S: Vector, K: Kernel<S>> Group<S, K> {
    /// Empty lanes.
    pub(super) fn new(simd: S, kernel: K) -> Self {
        let constant = |value: f64| Lanes::splat(simd, value);
        let zero = constant(0.0);
        let flow = kernel.flow(simd);
        let of_contacts = SmallVec::from_elem(zero, kernel.contacts());
        Group {
            simd,
            gaps: GapLanes::none(simd, kernel.contacts()),
            room: Box::new(kernel.room(simd)),
            state: flow.clone(),
            time: zero,
            until: constant(1.0),
            attention: constant(f64::INFINITY),
            longest: zero,
            next: constant(1.0),
            tolerance: [constant(1.0); 2],
            turns: of_contacts.clone(),
            slow: zero,
            slow_since: of_contacts,
            taken: zero,
            most: constant(f64::INFINITY),
            most_per_time: zero,
            displacement: flow.clone(),
            lanes: std::array::from_fn(|_| None),
            alive: 0,
            sliding: 0,
            told: 0,
            watched: 0,
            watched_square: zero,
            ended: 0,
            reset: 0,
            before: flow.clone(),
            displacement_before: flow.clone(),
            time_before: zero,
            end: flow,
            length: zero,
            kernel,
        }
    }

    /// Starts a phase in a lane.
    pub(super) fn enter(&mut self, lane: usize, state: &[f64]) {
        let Some(own) = &self.lanes[lane] else { return };
        self.kernel.set_lane(&mut self.state, lane, state);
        self.kernel.set_phases(&mut self.room, lane, own, state);
        self.kernel.set_rest(lane, own, state);
        self.gaps.set(lane, own);
    }
}

impl<S: Vector, K: Kernel<S>> LaneGroup for Group<S, K> {
    fn fits(&self, system: &Arc<dyn System>) -> bool {
        self.kernel.fits(system)
    }

    fn empty_lane(&self) -> Option<usize> {
        let lane = (!self.alive).trailing_zeros() as usize;
        (lane < LANES).then_some(lane)
    }

    fn runs(&self) -> u32 {
        self.alive.count_ones()
    }

    fn put(&mut self, lane: usize, saved: &Saved, until: f64) {
        let own = &saved.lane;
        for contact in 0..self.kernel.contacts() {
            self.turns[contact][lane] = saved.turns[contact];
            self.slow_since[contact][lane] = saved.slow_since[contact];
        }
        let tolerance = own.settings.tolerance;
        self.tolerance[0][lane] = tolerance.relative;
        self.tolerance[1][lane] = tolerance.absolute;
        self.time[lane] = saved.time;
        self.time_before[lane] = saved.time;
        self.until[lane] = until;
        self.attention[lane] = f64::INFINITY;
        self.longest[lane] = K::LONGEST * own.longest_step;
        self.next[lane] = saved.next;
        self.slow[lane] = own.slow;
        self.taken[lane] = saved.taken;
        self.most[lane] = own.settings.effort_limit as f64;
        self.most_per_time[lane] = MOST_PER_TIME * own.pace;
        self.kernel.set_lane(&mut self.displacement, lane, &saved.displacement);
        let bit = 1 << lane;
        self.alive |= bit;
        self.ended &= !bit;
        self.reset &= !bit;
        self.watched &= !bit;
        let slides =
            (0..self.kernel.contacts()).any(|contact| !own.system.friction(contact).can_stick());
        self.sliding = self.sliding & !bit | if slides { bit } else { 0 };
        self.kernel.set_system(lane, own);
        self.lanes[lane] = Some(own.clone());
        self.enter(lane, &saved.state);
    }

    fn set_until(&mut self, lane: usize, until: f64) {
        self.until[lane] = until;
    }

    fn take(&mut self, lane: usize) -> Option<Saved> {
        let saved = self.copy(lane);
        let bit = 1 << lane;
        self.alive &= !bit;
        self.sliding &= !bit;
        self.watched &= !bit;
        self.lanes[lane] = None;
        self.kernel.clear(lane);
        // The lane takes steps of length 0 until it has a run again.
        self.until[lane] = self.time[lane];
        self.attention[lane] = f64::INFINITY;
        self.most[lane] = f64::INFINITY;
        saved
    }

    fn copy(&self, lane: usize) -> Option<Saved> {
        let own = self.lanes[lane].as_ref()?;
        Some(Saved {
            lane: own.clone(),
            time: self.time[lane],
            state: self.kernel.lane(&self.state, lane),
            turns: self.turns(lane),
            slow_since: self.slow_since(lane),
            next: self.next[lane],
            taken: self.taken[lane],
            displacement: self.kernel.lane(&self.displacement, lane),
        })
    }

    fn advance(&mut self, displaced: bool) -> Happened {
        advance::advance(self, displaced)
    }

    fn set_attention(&mut self, lane: usize, from: f64) {
        self.attention[lane] = from;
    }

    fn watch_amplitude(&mut self, lane: usize, square: f64) {
        self.watched |= 1 << lane;
        self.watched_square[lane] = square;
    }

    fn set_told(&mut self, lane: usize, told: bool) {
        let bit = 1 << lane;
        self.told = self.told & !bit | if told { bit } else { 0 };
    }

    fn reaches(&self, lane: usize, time: f64) -> bool {
        self.longest[lane] >= time - self.time[lane]
    }

    fn longest(&self, lane: usize) -> f64 {
        let own = self.lanes[lane].as_ref();
        own.map_or(f64::INFINITY, |own| K::LONGEST * own.longest_step)
    }

    fn time(&self, lane: usize) -> f64 {
        self.time[lane]
    }

    fn time_before(&self, lane: usize) -> f64 {
        self.time_before[lane]
    }

    fn state(&self, lane: usize) -> Components {
        self.kernel.lane(&self.state, lane)
    }

    fn end_of_step(&self, lane: usize) -> Components {
        let end = self.kernel.lane(&self.end, lane);
        if self.was_reset(lane) {
            return end;
        }
        // A switch may have changed speeds.
        let mut state = self.kernel.lane(&self.state, lane);
        for contact in 0..self.kernel.contacts() {
            let (position, _) = self.kernel.coordinates(contact);
            state[position] = end[position];
        }
        state
    }

    fn state_within(&self, lane: usize, after: f64) -> Components {
        if after == 0.0 {
            return self.kernel.lane(&self.before, lane);
        }
        self.state_at(lane, after)
    }

    fn states_within(&self, lane: usize, after: [f64; LANES]) -> [Components; LANES] {
        self.states_at(lane, after)
    }

    fn component_within(&self, lane: usize, component: usize, after: f64) -> f64 {
        self.component_at(lane, component, &self.kernel.lane(&self.before, lane), after)
    }

    fn rate_within(&self, lane: usize, component: usize, after: f64) -> f64 {
        self.rate_at(lane, component, after)
    }

    fn unwrapped_within(&self, lane: usize, after: f64) -> PerContact {
        let start = self.kernel.lane(&self.before, lane);
        let position = |(contact, turned): (usize, f64)| {
            let (component, _) = self.kernel.coordinates(contact);
            self.component_at(lane, component, &start, after) + turned
        };
        self.turned_before(lane).into_iter().enumerate().map(position).collect()
    }

    fn turned_before(&self, lane: usize) -> PerContact {
        let contact = |contact: usize| {
            if !self.kernel.is_angular(contact) {
                return 0.0;
            }
            // Turns are counted at the step's end.
            let end = self.kernel.position(&self.end, contact)[lane];
            let reduced = self.kernel.position(&self.state, contact)[lane];
            let counted = ((end - reduced) / TAU).round();
            (self.turns[contact][lane] - counted) * TAU
        };
        (0..self.kernel.contacts()).map(contact).collect()
    }

    fn squares_within(&self, lane: usize, after: [f64; 5]) -> [f64; 5] {
        self.squares_at(lane, after)
    }

    fn largest_squares_within(
        &self,
        lane: usize,
        known: f64,
        near: f64,
    ) -> SmallVec<[(f64, f64); 8]> {
        self.largest_squares(lane, (known, near))
    }

    fn passage(&self, lane: usize, contact: usize) -> Option<(f64, Components)> {
        self.passage_in_step(lane, contact)
    }

    fn turns(&self, lane: usize) -> PerContact {
        self.turns.iter().map(|turns| turns[lane]).collect()
    }

    fn phases(&self, lane: usize) -> &[Phase] {
        self.lanes[lane].as_ref().map_or(&[], |own| &own.phases)
    }

    fn phases_during_step(&self, lane: usize) -> &[Phase] {
        let had_event = self.ended & 1 << lane != 0;
        let own = self.lanes[lane].as_ref();
        own.map_or(&[], |own| if had_event { &own.during } else { &own.phases })
    }

    fn was_reset(&self, lane: usize) -> bool {
        self.reset & 1 << lane != 0
    }

    fn last_switches(&self, lane: usize) -> &[f64] {
        self.lanes[lane].as_ref().map_or(&[], |own| &own.last_switches)
    }

    fn slow_since(&self, lane: usize) -> PerContact {
        self.slow_since.iter().map(|since| since[lane]).collect()
    }

    fn hits(&self, lane: usize) -> &[Hit] {
        let latest = self.lanes[lane].as_ref().filter(|own| own.hit_at == self.time[lane]);
        latest.map_or(&[], |own| &own.hits)
    }

    fn touches(&self, lane: usize) -> Option<Touches> {
        self.lanes[lane].as_ref()?.touches(self.time[lane])
    }

    fn effort(&self, lane: usize) -> Effort {
        let own = self.lanes[lane].as_ref();
        own.map_or_else(Effort::default, |own| own.effort(self.taken[lane]))
    }

    fn displace(&mut self, lane: usize, direction: &[f64]) {
        self.kernel.set_lane(&mut self.displacement, lane, direction);
        if let Some(own) = &mut self.lanes[lane] {
            own.grazed = false;
        }
    }

    fn displacement(&self, lane: usize) -> (Components, bool) {
        let grazed = self.lanes[lane].as_ref().is_some_and(|own| own.grazed);
        (self.kernel.lane(&self.displacement, lane), grazed)
    }

    fn displacements_within(&mut self, after: f64) -> Vec<Components> {
        let length = Lanes::splat(self.simd, after);
        let flow =
            carry(self.simd, &self.kernel, &mut self.room, &self.displacement_before, length);
        (0..LANES).map(|lane| self.kernel.lane(&flow, lane)).collect()
    }
}

/// Propagates displacements over a step of this length. Not inlined, because it is large and called twice.
#[inline(never)]
pub(super) fn carry<S: Vector, K: Kernel<S>>(
    simd: S,
    kernel: &K,
    room: &mut K::Room,
    displacement: &K::Flow,
    length: Lanes<S>,
) -> K::Flow {
    vectorized!(simd, kernel.carry(room, displacement, length))
}
