//! The interface of eight lanes, whichever kernel computes them.

use std::sync::Arc;

use fearless_simd::prelude::*;

use super::advance::StepReport;
use super::kernel::{Kernel, LONGEST};
use super::kernel_lanes::{KernelLanes, propagate};
use super::saved_run::SavedRun;
use super::step_states::StepStates;
use super::vector::Vector;
use super::{LANES, Lanes, advance};
use crate::model::{Components, System};
use crate::motion::impact::Impact;
use crate::motion::settings::MOST_PER_TIME;
use crate::motion::{Effort, PerContact, Phase, Touches};

/// Eight lanes, some of them empty. States are in the components of the system.
pub(crate) trait LaneGroup: StepStates {
    /// Returns whether runs of a system can be put into these lanes.
    fn fits(&self, system: &Arc<dyn System>) -> bool;
    /// Returns whether the kernel of the lanes is written for systems of one type.
    fn is_tuned(&self) -> bool;
    /// Returns an empty lane, or `None` if all lanes have a run.
    fn empty_lane(&self) -> Option<usize>;
    /// Returns the number of lanes with a run.
    fn runs(&self) -> u32;
    /// Puts a run into a lane, until a time at the latest.
    fn put(&mut self, lane: usize, saved: &SavedRun, until: f64);
    /// Changes the time at which a lane stops.
    fn set_until(&mut self, lane: usize, until: f64);
    /// Takes a run out of its lane.
    fn take(&mut self, lane: usize) -> Option<SavedRun>;
    /// Returns a copy of the run in a lane.
    fn copy(&self, lane: usize) -> Option<SavedRun>;
    /// Takes a step in all lanes. If `perturbed`, a perturbation of each lane is propagated.
    fn advance(&mut self, perturbed: bool) -> StepReport;

    /// Requests that a lane be reported after each step from a time on.
    fn set_attention(&mut self, lane: usize, from: f64);
    /// Requests that a lane be reported after each step in which the amplitude of the vibration may exceed the root of
    /// `square`.
    fn watch_amplitude(&mut self, lane: usize, square: f64);
    /// Sets whether turns and switches of a lane are reported.
    fn set_reporting(&mut self, lane: usize, reports: bool);
    /// Returns whether a time may shorten the next step of a lane.
    fn reaches(&self, lane: usize, time: f64) -> bool;
    /// Returns the length of the longest possible step of a lane.
    fn longest(&self, lane: usize) -> f64;

    /// The time of a lane.
    fn time(&self, lane: usize) -> f64;
    /// The time of a lane before its latest step.
    fn time_before(&self, lane: usize) -> f64;
    /// Returns the present state, with angles in [0, 2π).
    fn state(&self, lane: usize) -> Components;
    /// Returns the state at the end of the latest step, before an event that resets it, with angles not yet reduced to
    /// one turn.
    fn end_of_step(&self, lane: usize) -> Components;
    /// Returns a component before the latest step.
    fn component_at_start(&self, lane: usize, component: usize) -> f64;
    /// Returns a component of [`LaneGroup::end_of_step`].
    fn component_at_end(&self, lane: usize, component: usize) -> f64;
    /// Returns the whole turns of the contacts since the start of the run.
    fn turns(&self, lane: usize) -> PerContact;

    /// Returns the phases after the latest step. A lane without a run has none.
    fn phases(&self, lane: usize) -> &[Phase];
    /// Returns the phases in the latest step, before an event at its end.
    fn phases_during_step(&self, lane: usize) -> &[Phase];
    /// Returns whether an event at the end of the latest step reset the state.
    fn was_reset(&self, lane: usize) -> bool;
    /// Returns when each contact last changed its phase; 0 if it has not.
    fn last_switches(&self, lane: usize) -> &[f64];
    /// Returns the last time at which each contact was faster than `SLOW`, or than the band if that is wider: 0 if
    /// it never was, and the current time if it is now.
    fn slow_since(&self, lane: usize) -> PerContact;
    /// Returns the impact at the end of the latest step or, before the first step, at the start.
    fn impact(&self, lane: usize) -> Option<&Impact>;
    /// Returns how the contacts of the run in a lane have touched; `None` for a system without gaps.
    fn touches(&self, lane: usize) -> Option<Touches>;
    /// Returns the number of impacts of the run in a lane.
    fn impacts(&self, lane: usize) -> u64;
    /// Returns the effort of the run in a lane.
    fn effort(&self, lane: usize) -> Effort;

    /// Perturbs a lane in a direction.
    fn perturb(&mut self, lane: usize, direction: &[f64]);
    /// Returns the perturbation of a lane, and whether it met a switch by grazing and is undefined since.
    fn perturbation(&self, lane: usize) -> (Components, bool);
    /// Returns the perturbations of all lanes at a time after the start of the latest step, which must have been
    /// perturbed.
    fn perturbations_within(&mut self, after: f64) -> Vec<Components>;
}

impl<S: Vector, K: Kernel<S>> LaneGroup for KernelLanes<S, K> {
    fn fits(&self, system: &Arc<dyn System>) -> bool {
        self.kernel.fits(system)
    }

    fn is_tuned(&self) -> bool {
        K::IS_TUNED
    }

    fn empty_lane(&self) -> Option<usize> {
        let lane = (!self.alive).trailing_zeros() as usize;
        (lane < LANES).then_some(lane)
    }

    fn runs(&self) -> u32 {
        self.alive.count_ones()
    }

    fn put(&mut self, lane: usize, saved: &SavedRun, until: f64) {
        let run = &saved.lane;
        for contact in 0..self.kernel.contacts() {
            self.turns[contact][lane] = saved.turns[contact];
            self.slow_since[contact][lane] = saved.slow_since[contact];
        }
        let tolerance = run.settings.tolerance;
        self.tolerance[0][lane] = tolerance.relative;
        self.tolerance[1][lane] = tolerance.absolute;
        self.time[lane] = saved.time;
        self.time_before[lane] = saved.time;
        self.until[lane] = until;
        self.attention[lane] = f64::INFINITY;
        self.longest[lane] = LONGEST * run.longest_step;
        self.next[lane] = saved.next;
        self.slow[lane] = run.slow;
        self.taken[lane] = saved.taken;
        self.most[lane] = run.settings.effort_limit as f64;
        self.most_per_time[lane] = MOST_PER_TIME * run.fastest_rate;
        self.kernel.set_lane(&mut self.perturbation, lane, &saved.perturbation);
        let bit = 1 << lane;
        self.alive |= bit;
        self.ended &= !bit;
        self.reset &= !bit;
        self.watched &= !bit;
        let slides =
            (0..self.kernel.contacts()).any(|contact| !run.system.friction(contact).can_stick());
        self.sliding = self.sliding & !bit | if slides { bit } else { 0 };
        self.kernel.set_system(lane, run);
        self.lanes[lane] = Some(run.clone());
        self.enter(lane, &saved.state);
    }

    fn set_until(&mut self, lane: usize, until: f64) {
        self.until[lane] = until;
    }

    fn take(&mut self, lane: usize) -> Option<SavedRun> {
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

    fn copy(&self, lane: usize) -> Option<SavedRun> {
        let run = self.lanes[lane].as_ref()?;
        Some(SavedRun {
            lane: run.clone(),
            time: self.time[lane],
            state: self.kernel.lane(&self.state, lane),
            turns: self.turns(lane),
            slow_since: self.slow_since(lane),
            next: self.next[lane],
            taken: self.taken[lane],
            perturbation: self.kernel.lane(&self.perturbation, lane),
        })
    }

    fn advance(&mut self, perturbed: bool) -> StepReport {
        advance::advance(self, perturbed)
    }

    fn set_attention(&mut self, lane: usize, from: f64) {
        self.attention[lane] = from;
    }

    fn watch_amplitude(&mut self, lane: usize, square: f64) {
        self.watched |= 1 << lane;
        self.watched_square[lane] = square;
    }

    fn set_reporting(&mut self, lane: usize, reports: bool) {
        let bit = 1 << lane;
        self.reporting_lanes = self.reporting_lanes & !bit | if reports { bit } else { 0 };
    }

    fn reaches(&self, lane: usize, time: f64) -> bool {
        self.longest[lane] >= time - self.time[lane]
    }

    fn longest(&self, lane: usize) -> f64 {
        let run = self.lanes[lane].as_ref();
        run.map_or(f64::INFINITY, |run| LONGEST * run.longest_step)
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

    fn component_at_start(&self, lane: usize, component: usize) -> f64 {
        self.kernel.lane_component(&self.before, lane, component)
    }

    fn component_at_end(&self, lane: usize, component: usize) -> f64 {
        let is_position = |contact: usize| self.kernel.coordinates(contact).0 == component;
        let keeps = self.was_reset(lane) || (0..self.kernel.contacts()).any(is_position);
        self.kernel.lane_component(if keeps { &self.end } else { &self.state }, lane, component)
    }

    fn turns(&self, lane: usize) -> PerContact {
        self.turns.iter().map(|turns| turns[lane]).collect()
    }

    fn phases(&self, lane: usize) -> &[Phase] {
        self.lanes[lane].as_ref().map_or(&[], |run| &run.phases)
    }

    fn phases_during_step(&self, lane: usize) -> &[Phase] {
        let had_event = self.ended & 1 << lane != 0;
        let run = self.lanes[lane].as_ref();
        run.map_or(&[], |run| if had_event { &run.during } else { &run.phases })
    }

    fn was_reset(&self, lane: usize) -> bool {
        self.reset & 1 << lane != 0
    }

    fn last_switches(&self, lane: usize) -> &[f64] {
        self.lanes[lane].as_ref().map_or(&[], |run| &run.last_switches)
    }

    fn slow_since(&self, lane: usize) -> PerContact {
        self.slow_since.iter().map(|since| since[lane]).collect()
    }

    fn impact(&self, lane: usize) -> Option<&Impact> {
        let latest = self.lanes[lane].as_ref().filter(|run| run.hit_at == self.time[lane]);
        latest?.impact.as_deref()
    }

    fn touches(&self, lane: usize) -> Option<Touches> {
        self.lanes[lane].as_ref()?.touches(self.time[lane])
    }

    fn impacts(&self, lane: usize) -> u64 {
        self.lanes[lane].as_ref().map_or(0, |run| run.touches.impacts)
    }

    fn effort(&self, lane: usize) -> Effort {
        let run = self.lanes[lane].as_ref();
        run.map_or_else(Effort::default, |run| run.effort(self.taken[lane]))
    }

    fn perturb(&mut self, lane: usize, direction: &[f64]) {
        self.kernel.set_lane(&mut self.perturbation, lane, direction);
        if let Some(run) = &mut self.lanes[lane] {
            run.grazed = false;
        }
    }

    fn perturbation(&self, lane: usize) -> (Components, bool) {
        let grazed = self.lanes[lane].as_ref().is_some_and(|run| run.grazed);
        (self.kernel.lane(&self.perturbation, lane), grazed)
    }

    fn perturbations_within(&mut self, after: f64) -> Vec<Components> {
        let length = Lanes::splat(self.simd, after);
        // The equations of lanes whose step has ended with a switch are already those after it.
        self.exchange_phases(true);
        let states = propagate(
            self.simd,
            &self.kernel,
            &mut self.workspace,
            &self.perturbation_before,
            length,
        );
        self.exchange_phases(false);
        (0..LANES).map(|lane| self.kernel.lane(&states, lane)).collect()
    }
}
