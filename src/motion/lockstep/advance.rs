//! One step of all lanes of a group: to the limit of the series or to the first event, with the
//! decision after it.

use std::f64::consts::TAU;
use std::sync::Arc;

use fearless_simd::{mask64x8, prelude::*};
use smallvec::SmallVec;

use super::kernel::{Kernel, StepEnd};
use super::kernel_lanes::{KernelLanes, carry};
use super::lane::Lane;
use super::step_report::StepReport;
use super::{LANES, Lanes, open_gaps};
use crate::model::{Components, Method};
use crate::motion::condition::Condition;
use crate::motion::impact::Impact;
use crate::motion::joint_decision::check_forces;
use crate::motion::lockstep::vector::{Fused, Vector, vectorized};
use crate::motion::saltation::{saltation, saltation_at_impact, saltation_at_reset};
use crate::motion::settings::MOST_AT_ONCE;
use crate::motion::stick_slip::start_phases;
use crate::motion::touching_system::TouchingSystem;
use crate::motion::{Evaluator, Failure, Phase, Phases, any_closed, event_driven, switch_model};

/// The shortest step, over the elapsed time, that still changes the time.
const SHORTEST: f64 = 1e-14;
/// Square of the size above which a perturbation must be rescaled.
const LARGE: f64 = 1e200;

/// The square of the amplitude exceeds its values at the ends of the quarters of a step by less than this part of their
/// range: in the longest steps it oscillates by 5 rad at its highest frequency, by 0.63 rad within half of a quarter, and
/// 1 - cos 0.63 is 0.19.
const BETWEEN: f64 = 0.25;

/// Takes a step in all lanes of a group. If `perturbed`, a perturbation of each lane is propagated.
pub(super) fn advance<S: Vector, K: Kernel<S>>(
    g: &mut KernelLanes<S, K>,
    perturbed: bool,
) -> StepReport {
    vectorized!(g.simd, step(g, perturbed))
}

#[inline(always)]
fn step<S: Vector, K: Kernel<S>>(g: &mut KernelLanes<S, K>, perturbed: bool) -> StepReport {
    let simd = g.simd;
    macro_rules! c {
        ($value:expr) => {
            Lanes::splat(simd, $value)
        };
    }
    let mut report = StepReport { reporting_lanes: g.reporting_lanes, ..StepReport::default() };
    g.kernel.expand(&mut g.workspace, &g.state, perturbed);
    let within = g.kernel.within_tolerance(&g.workspace, g.tolerance, g.next).min(g.longest);
    let left = g.until - g.time;
    let mut length = within.min(left);
    let mut failed = [None; LANES];
    let mut looks = g.kernel.screen_conditions(&mut g.workspace, length) & g.alive;
    looks |= g.gaps.screen((&g.kernel, &g.workspace, &g.state), g.alive, length);
    while looks != 0 {
        let lane = looks.trailing_zeros() as usize;
        looks &= looks - 1;
        match first_event(g, lane, length[lane]) {
            Ok(Some((part, event))) => {
                length[lane] *= part;
                failed[lane] = Some(event);
                report.event |= 1 << lane;
            }
            Ok(None) => {}
            Err(failure) => report.fail(lane, failure),
        }
    }
    g.kernel.at(&g.workspace, &g.state, length, &mut g.end);
    // Zero, unless a component is infinite or NaN.
    let finite = g.kernel.finite(&g.end, within * c!(0.0)).simd_eq(c!(0.0));
    let moves = within.simd_ge(g.time.max(c!(1.0)) * c!(SHORTEST));
    let commits = finite & moves;
    let mut stopped = g.alive & !commits.to_bitmask();
    while stopped != 0 {
        let lane = stopped.trailing_zeros() as usize;
        stopped &= stopped - 1;
        let lasts = finite.to_bitmask() & 1 << lane != 0;
        report.fail(lane, if lasts { Failure::StepLimit } else { Failure::NotFinite });
        report.event &= !(1 << lane);
    }
    let commit = g.alive & !report.failed;
    let commits = mask64x8::from_bitmask(simd, commit);
    report.taken = commit;
    g.taken += c!(1.0);
    report.still = g.kernel.still(&g.workspace) & commit;

    g.next = commits.select(within, g.next);
    g.before.clone_from(&g.state);
    g.time_before = g.time;
    let time = left.simd_le(length).select(g.until, g.time + length);
    g.time = commits.select(time, g.time);
    g.kernel.select(&mut g.state, &g.end, commits);
    let mut round = g.time.simd_lt(g.time);
    for contact in 0..g.kernel.contacts() {
        if g.kernel.is_angular(contact) {
            let angle = g.kernel.position(&g.end, contact);
            let beyond = (angle.simd_lt(c!(0.0)) | angle.simd_ge(c!(TAU))) & commits;
            let turns = beyond.select((angle / c!(TAU)).floor(), c!(0.0));
            let within = turns.fused(c!(-TAU), angle);
            g.turns[contact] += turns;
            round |= beyond;
            let now = g.kernel.position(&g.state, contact);
            g.kernel.set_position(&mut g.state, contact, commits.select(within, now));
        }
        let fast = g.kernel.speed(&g.state, contact).abs().simd_gt(g.slow) & commits;
        g.slow_since[contact] = fast.select(g.time, g.slow_since[contact]);
    }
    g.length = length;
    g.ended = report.event;
    g.reset = 0;
    report.round = round.to_bitmask();
    if perturbed {
        g.perturbation_before.clone_from(&g.perturbation);
        let moved = carry(simd, &g.kernel, &mut g.workspace, &g.perturbation, length);
        g.kernel.select(&mut g.perturbation, &moved, commits);
        let size = g.kernel.square(&g.perturbation);
        let extreme = size.simd_gt(c!(LARGE)) | size.simd_lt(c!(1.0 / LARGE));
        report.attention |= extreme.to_bitmask() & commit;
    }
    let mut events = report.event;
    while events != 0 {
        let lane = events.trailing_zeros() as usize;
        events &= events - 1;
        let Some(event) = failed[lane] else { continue };
        if let Err(trouble) = switch(g, lane, event, perturbed) {
            report.fail(lane, trouble);
        }
    }
    report.rest = g.kernel.rest(&g.state) & commit;
    let due = g.time.simd_ge(g.attention) | g.time.simd_ge(g.until);
    report.attention |= due.to_bitmask() & commit;
    if g.watched != 0 {
        let larger = largest_square(g, length).simd_gt(g.watched_square);
        report.larger = larger.to_bitmask() & commit & g.watched;
    }
    if g.sliding != 0 {
        let mut turned = g.time.simd_lt(g.time);
        for contact in 0..g.kernel.contacts() {
            let before = g.kernel.speed(&g.before, contact);
            turned |= (before * g.kernel.speed(&g.state, contact)).simd_le(c!(0.0));
        }
        report.turned = turned.to_bitmask() & commit & g.sliding;
    }
    let sound = g.most_per_time.fused(g.time, c!(MOST_AT_ONCE as f64));
    let mut overdone = g.taken.simd_ge(sound.min(g.most)).to_bitmask() & g.alive;
    while overdone != 0 {
        let lane = overdone.trailing_zeros() as usize;
        overdone &= overdone - 1;
        if report.failure(lane).is_none() {
            report.fail(lane, Failure::StepLimit);
        }
    }
    report
}

/// Returns a bound of the square of the amplitude in a step, from its values at the ends of the quarters.
#[inline(always)]
fn largest_square<S: Vector, K: Kernel<S>>(g: &KernelLanes<S, K>, length: Lanes<S>) -> Lanes<S> {
    let zero = Lanes::splat(g.simd, 0.0);
    let (mut least, mut most) = (Lanes::splat(g.simd, f64::INFINITY), zero);
    let ends = [&g.before, &g.end].map(|states| g.kernel.vibration_of(states));
    let times = [0.25, 0.5, 0.75].map(|part| Lanes::splat(g.simd, part) * length);
    for [x, y] in ends.into_iter().chain(g.kernel.vibration_at(&g.workspace, times)) {
        let square = x.fused(x, y * y);
        least = least.min(square);
        most = most.max(square);
    }
    (most - least).fused(Lanes::splat(g.simd, BETWEEN), most)
}

/// An event that ends a step.
#[derive(Clone, Copy)]
struct StepEvent {
    failed: Condition,
    /// Whether the condition failed at the start of the step.
    at_once: bool,
}

/// Returns the first event of a step of one lane and its place in the step. A condition that fails only by rounding
/// changes no phase; the next condition may.
#[inline(never)]
fn first_event<S: Vector, K: Kernel<S>>(
    g: &KernelLanes<S, K>,
    lane: usize,
    length: f64,
) -> Result<Option<(f64, StepEvent)>, Failure> {
    let Some(own) = &g.lanes[lane] else { return Ok(None) };
    let mut ignored = SmallVec::<[Condition; 4]>::new();
    loop {
        let mut first = g.kernel.first_event(&g.workspace, own, lane, length, &ignored);
        if g.gaps.lanes_to_examine & 1 << lane != 0 {
            let series = (g.simd, &g.kernel, &*g.workspace, &g.state);
            open_gaps::first_closing(series, (lane, own), length, &mut first);
        }
        match first {
            StepEnd::Nothing => return Ok(None),
            StepEnd::At(part, failed) => {
                return Ok(Some((part, StepEvent { failed, at_once: false })));
            }
            StepEnd::AtOnce(failed) => {
                let event = StepEvent { failed, at_once: true };
                if let Condition::Event(_) | Condition::Gap(_) | Condition::Landing(_) = failed {
                    return Ok(Some((0.0, event)));
                }
                let mut state = g.kernel.lane(&g.state, lane);
                let kernel = (&g.kernel, &g.state, g.time[lane]);
                let mut phases = Phases::from_slice(&own.phases);
                decide(kernel, (lane, own), (&mut state, &mut phases), event)?;
                if phases != own.phases {
                    return Ok(Some((0.0, event)));
                }
                ignored.push(failed);
            }
        }
    }
}

/// Replaces the phases in `phases`, which are those of the run, by those after an event. Contacts that stop lose their speed
/// in `state`, and an event or an impact, which is returned, resets it.
fn decide<S: Vector, K: Kernel<S>>(
    (kernel, states, time): (&K, &K::LaneStates, f64),
    (lane, own): (usize, &Lane),
    (state, phases): (&mut Components, &mut Phases),
    StepEvent { failed, at_once }: StepEvent,
) -> Result<Option<Box<Impact>>, Failure> {
    // The contact set off at this instant and stops at this instant.
    let stops_at_once = |contact: usize| {
        let slips = matches!(own.phases[contact], Phase::Slip(_));
        (at_once && slips && own.last_switches[contact] == time).then_some(contact)
    };
    let (contact, which) = match failed {
        Condition::Contact { contact, which } => (contact, which),
        Condition::Event(event) => {
            if let Some(evaluator) = kernel.evaluator(lane) {
                *state = evaluator.reset(event, phases, state);
                if own.has_openings
                    && let Some(in_touch) = TouchingSystem::new(evaluator, own.settings)
                {
                    let (after, impact) = in_touch.start(state)?;
                    *phases = after;
                    return Ok(Some(Box::new(impact)));
                }
            }
            let system = own.system.as_ref();
            *phases = kernel
                .with_force_model(lane, own, state, |at| start_phases(system, own.settings, at))?;
            return Ok(None);
        }
        Condition::Gap(_) | Condition::Landing(_) => {
            return with_evaluator(kernel, (lane, own), |evaluator| {
                let Some(in_touch) = TouchingSystem::new(evaluator, own.settings) else {
                    return Ok(None);
                };
                Ok(Some(Box::new(in_touch.meet(state, phases)?)))
            });
        }
        Condition::Pressed(_) | Condition::Held(_) => (usize::MAX, 0),
    };
    if which == 2 && !own.has_openings {
        return Err(Failure::ContactLost { ball: contact + 1 });
    }
    let position = |contact: usize| state[kernel.coordinates(contact).0];
    if own.has_openings || any_closed(phases) || open_gaps::any_touch(own, position) {
        return with_evaluator(kernel, (lane, own), |evaluator| {
            if let Some(in_touch) = TouchingSystem::new(evaluator, own.settings) {
                let failed = (contact < kernel.contacts()).then_some(contact);
                let at_once = failed.and_then(stops_at_once);
                in_touch.switch(state, phases, failed, at_once)?;
            }
            Ok(None)
        });
    }
    let speed = |contact: usize| match kernel.coordinates(contact) {
        (_, Some(component)) => state[component],
        (_, None) => kernel.speed(states, contact)[lane],
    };
    match own.settings.method {
        Method::Switch => {
            switch_model::cross_band(own.settings.band, phases, speed);
            kernel.with_force_model(lane, own, state, |at| {
                switch_model::decide(at, phases, check_forces)
            })?;
        }
        Method::Event => {
            let (at_rest, stopped) = event_driven::stop(phases, speed, stops_at_once(contact));
            for (contact, _) in stopped.iter().enumerate().filter(|(_, stopped)| **stopped) {
                match (kernel.coordinates(contact).1, kernel.shifted(contact)) {
                    (Some(component), _) => state[component] = 0.0,
                    (None, Some(component)) => {
                        let mut unit = Components::from_elem(0.0, state.len());
                        unit[component] = 1.0;
                        state[component] -= kernel.with_force_model(lane, own, state, |at| {
                            at.speed(contact) / at.speed_along(contact, &unit)
                        });
                    }
                    (None, None) => {}
                }
            }
            kernel.with_force_model(lane, own, state, |at| {
                event_driven::decide(at, phases, &at_rest, check_forces)
            })?;
        }
    }
    Ok(None)
}

/// Calls `with` with the equations of the system in a lane.
fn with_evaluator<S: Vector, K: Kernel<S>, R>(
    kernel: &K,
    (lane, own): (usize, &Lane),
    with: impl FnOnce(&Evaluator) -> R,
) -> R {
    match kernel.evaluator(lane) {
        Some(evaluator) => with(evaluator),
        None => with(&Evaluator::new(Arc::clone(&own.system))),
    }
}

/// Decides the phases after an event.
#[inline(never)]
fn switch<S: Vector, K: Kernel<S>>(
    g: &mut KernelLanes<S, K>,
    lane: usize,
    event: StepEvent,
    perturbed: bool,
) -> Result<(), Failure> {
    let time = g.time[lane];
    let mut state = g.kernel.lane(&g.state, lane);
    let kernel = &g.kernel;
    let Some(own) = &mut g.lanes[lane] else { return Ok(()) };
    own.hits.clear();
    own.count_event(time)?;
    own.during.copy_from_slice(&own.phases);
    let resets =
        matches!(event.failed, Condition::Event(_) | Condition::Gap(_) | Condition::Landing(_));
    let mut phases = Phases::from_slice(&own.phases);
    let impact = decide((kernel, &g.state, time), (lane, own), (&mut state, &mut phases), event)?;
    own.take_in(impact.as_deref(), time);
    if perturbed {
        let mut direction = kernel.lane(&g.perturbation, lane);
        own.grazed |= match (event.failed, kernel.evaluator(lane)) {
            (Condition::Contact { contact, which }, _) => {
                kernel.with_force_model(lane, own, &state, |at| {
                    let sides: [&[Phase]; 2] = [&own.phases, &phases];
                    saltation(at, sides, (contact, which), &mut direction)
                })
            }
            (Condition::Event(event), Some(evaluator)) => {
                let before = kernel.lane(&g.state, lane);
                let sides: [(&[Phase], &[f64]); 2] = [(&own.phases, &before), (&phases, &state)];
                let along = |direction: &[f64]| {
                    evaluator.event_along(event, &own.phases, &before, direction)
                };
                let (guard, reset) =
                    (|along_: &[f64]| along(along_).0, |along_: &[f64]| along(along_).1);
                saltation_at_reset(evaluator, sides, guard, reset, &mut direction)
            }
            (failed @ (Condition::Gap(_) | Condition::Landing(_)), _) => {
                with_evaluator(kernel, (lane, own), |evaluator| {
                    let before = kernel.lane(&g.state, lane);
                    let sides: [(&[Phase], &[f64]); 2] =
                        [(&own.phases, &before), (&phases, &state)];
                    saltation_at_impact(evaluator, own.settings, sides, failed, &mut direction)
                })
            }
            // Accelerations do not jump where friction no longer holds contacts, or where a gap opens.
            (Condition::Event(_) | Condition::Pressed(_) | Condition::Held(_), _) => false,
        };
        kernel.set_lane(&mut g.perturbation, lane, &direction);
    }
    g.reset |= u64::from(resets) << lane;
    for (contact, phase) in phases.iter().enumerate() {
        if *phase != own.phases[contact] {
            own.switches += u64::from(!phase.is_gap());
            own.last_switches[contact] = time;
        }
    }
    if phases[kernel.contacts()..] != own.phases[kernel.contacts()..] {
        own.touching_time += if any_closed(&own.phases) { time - own.last_touch } else { 0.0 };
        own.last_touch = time;
    }
    own.phases = phases;
    g.enter(lane, &state);
    Ok(())
}
