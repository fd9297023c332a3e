//! The event that ends a step of one lane, and the phases after it.

use std::borrow::Cow;
use std::sync::Arc;

use smallvec::SmallVec;

use super::gap_conditions;
use super::kernel::{Kernel, StepEnd};
use super::kernel_lanes::KernelLanes;
use super::lane::Lane;
use crate::model::{Components, Method};
use crate::motion::condition::Condition;
use crate::motion::impact::Impact;
use crate::motion::joint_decision::check_forces;
use crate::motion::lockstep::vector::Vector;
use crate::motion::saltation::{saltation, saltation_at_impact, saltation_at_reset};
use crate::motion::stick_slip::start_phases;
use crate::motion::touching_system::{TouchingSystem, VANISHES};
use crate::motion::{Evaluator, Failure, Phase, Phases, any_closed, event_driven, switch_model};

/// An event that ends a step.
#[derive(Clone, Copy)]
pub(super) struct StepEvent {
    failed: Condition,
    /// Whether the condition failed at the start of the step.
    at_once: bool,
}

/// Returns the first event of a step of one lane and its place in the step. A condition that fails only by rounding
/// changes no phase; the next condition may.
#[inline(never)]
pub(super) fn first_event<S: Vector, K: Kernel<S>>(
    g: &KernelLanes<S, K>,
    lane: usize,
    length: f64,
) -> Result<Option<(f64, StepEvent)>, Failure> {
    let Some(run) = &g.lanes[lane] else { return Ok(None) };
    let mut ignored = SmallVec::<[Condition; 4]>::new();
    loop {
        let mut first = g.kernel.first_event(&g.workspace, run, lane, length, &ignored);
        if g.gaps.lanes_to_examine & 1 << lane != 0 {
            let series = (g.simd, &g.kernel, &*g.workspace, &g.state);
            gap_conditions::first_closing(series, (lane, run), length, &mut first);
        }
        match first {
            StepEnd::Nothing => return Ok(None),
            StepEnd::At(part, failed) => {
                return Ok(Some((part, StepEvent { failed, at_once: false })));
            }
            StepEnd::AtOnce(failed) => {
                let event = StepEvent { failed, at_once: true };
                if failed.resets() {
                    return Ok(Some((0.0, event)));
                }
                let mut state = g.kernel.lane(&g.state, lane);
                let kernel = (&g.kernel, &g.state, g.time[lane]);
                let mut phases = Phases::from_slice(&run.phases);
                decide(kernel, (lane, run), (&mut state, &mut phases), event)?;
                if phases != run.phases {
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
    (lane, run): (usize, &Lane),
    (state, phases): (&mut Components, &mut Phases),
    StepEvent { failed, at_once }: StepEvent,
) -> Result<Option<Box<Impact>>, Failure> {
    // The contact set off at this instant and stops at this instant.
    let stops_at_once = |contact: usize| {
        let slips = matches!(run.phases[contact], Phase::Slip(_));
        (at_once && slips && run.last_switches[contact] == time).then_some(contact)
    };
    let (contact, which) = match failed {
        Condition::Contact { contact, which } => (contact, which),
        Condition::Event(event) => {
            if let Some(evaluator) = kernel.evaluator(lane) {
                *state = evaluator.reset(event, phases, state);
                if run.has_openings
                    && let Some(in_touch) = TouchingSystem::new(evaluator, run.settings)
                {
                    let (after, impact) = in_touch.start(state)?;
                    *phases = after;
                    return Ok(Some(Box::new(impact)));
                }
            }
            let system = run.system.as_ref();
            *phases = kernel.with_force_model(lane, run, state, |at| {
                start_phases(system, run.settings, at, &[])
            })?;
            return Ok(None);
        }
        Condition::Gap(_) | Condition::Landing(_) => {
            let meet = |in_touch: &TouchingSystem| in_touch.meet(state, phases).map(Box::new);
            return with_touching(kernel, (lane, run), meet).transpose();
        }
        Condition::Pressed(_) | Condition::Held(_) => (usize::MAX, 0),
    };
    if which == 2 && !run.has_openings {
        return Err(Failure::ContactLost { ball: contact + 1 });
    }
    let position = |contact: usize| state[kernel.coordinates(contact).0];
    if run.has_openings || any_closed(phases) || gap_conditions::any_touch(run, position) {
        let failed = (contact < kernel.contacts()).then_some((contact, which == 2));
        let at_once = failed.and_then(|(contact, _)| stops_at_once(contact));
        let switched = with_touching(kernel, (lane, run), |in_touch| {
            in_touch.switch(state, phases, failed, at_once)
        });
        return switched.transpose().map(|_| None);
    }
    let speed = |contact: usize| match kernel.coordinates(contact) {
        (_, Some(component)) => state[component],
        (_, None) => kernel.speed(states, contact)[lane],
    };
    match run.settings.method {
        Method::Switch => {
            switch_model::cross_band(run.settings.band, phases, speed);
            kernel.with_force_model(lane, run, state, |at| {
                switch_model::decide(at, phases, check_forces)
            })?;
        }
        Method::Event => {
            let (at_rest, stopped) = event_driven::stop(phases, speed, stops_at_once(contact));
            for (contact, stopped) in stopped.into_iter().enumerate().take(kernel.contacts()) {
                match kernel.coordinates(contact).1 {
                    Some(component) if stopped => state[component] = 0.0,
                    // A sliding speed that is no component drifts while its contact sticks, by rounding and by the error of steps.
                    // The law of friction would take what is left for slip.
                    None if stopped || at_rest[contact] => {
                        hold(kernel, (lane, run), state, contact)
                    }
                    _ => {}
                }
            }
            kernel.with_force_model(lane, run, state, |at| {
                event_driven::decide(at, phases, &at_rest, check_forces)
            })?;
        }
    }
    Ok(None)
}

/// Makes the sliding speed of a contact zero, by a change of the velocity on which it depends most, unless no velocity has an
/// influence on it in this state.
fn hold<S: Vector, K: Kernel<S>>(
    kernel: &K,
    (lane, run): (usize, &Lane),
    state: &mut Components,
    contact: usize,
) {
    let along = |component: usize| {
        let mut unit = Components::from_elem(0.0, state.len());
        unit[component] = 1.0;
        kernel.with_force_model(lane, run, state, |at| at.speed_along(contact, &unit))
    };
    let layout = kernel.evaluator(lane).map(|evaluator| &evaluator.graph().layout);
    let velocities = layout.iter().flat_map(|layout| layout.velocities.iter().flatten().copied());
    let largest = || velocities.max_by(|a, b| along(*a).abs().total_cmp(&along(*b).abs()));
    let Some(component) = kernel.shifted(contact).or_else(largest) else { return };
    let factor = along(component);
    let speed = kernel.with_force_model(lane, run, state, |at| at.speed(contact));
    if factor.abs() > VANISHES {
        state[component] -= speed / factor;
    }
}

/// Calls `with` with the system in a lane, if its contacts may touch each other or open.
fn with_touching<S: Vector, K: Kernel<S>, R>(
    kernel: &K,
    (lane, run): (usize, &Lane),
    with: impl FnOnce(&TouchingSystem) -> R,
) -> Option<R> {
    let recorded = || Cow::Owned(Evaluator::new(Arc::clone(&run.system)));
    let evaluator = kernel.evaluator(lane).map_or_else(recorded, Cow::Borrowed);
    TouchingSystem::new(&evaluator, run.settings).map(|in_touch| with(&in_touch))
}

/// Decides the phases after an event.
#[inline(never)]
pub(super) fn switch<S: Vector, K: Kernel<S>>(
    g: &mut KernelLanes<S, K>,
    lane: usize,
    event: StepEvent,
    perturbed: bool,
) -> Result<(), Failure> {
    let time = g.time[lane];
    let mut state = g.kernel.lane(&g.state, lane);
    let kernel = &g.kernel;
    let Some(run) = &mut g.lanes[lane] else { return Ok(()) };
    run.impact = None;
    run.count_event(time)?;
    run.during.copy_from_slice(&run.phases);
    let mut phases = Phases::from_slice(&run.phases);
    let impact = decide((kernel, &g.state, time), (lane, run), (&mut state, &mut phases), event)?;
    run.take_in(impact, time);
    if perturbed {
        let mut direction = kernel.lane(&g.perturbation, lane);
        run.grazed |= match (event.failed, kernel.evaluator(lane)) {
            (Condition::Contact { contact, which }, _) => {
                kernel.with_force_model(lane, run, &state, |at| {
                    saltation(at, [&run.phases, &phases], (contact, which), &mut direction)
                })
            }
            (Condition::Event(event), Some(evaluator)) => {
                let before = kernel.lane(&g.state, lane);
                let sides: [(&[Phase], &[f64]); 2] = [(&run.phases, &before), (&phases, &state)];
                let along = |direction: &[f64]| {
                    evaluator.event_along(event, &run.phases, &before, direction)
                };
                let guard = |direction: &[f64]| along(direction).0;
                let reset = |direction: &[f64]| along(direction).1;
                saltation_at_reset(evaluator, sides, guard, reset, &mut direction)
            }
            (Condition::Gap(_) | Condition::Landing(_), _) => {
                let before = kernel.lane(&g.state, lane);
                let sides: [(&[Phase], &[f64]); 2] = [(&run.phases, &before), (&phases, &state)];
                let grazes = with_touching(kernel, (lane, run), |in_touch| {
                    let place = in_touch.place_of(event.failed)?;
                    Some(saltation_at_impact(in_touch, sides, place, &mut direction))
                });
                grazes.flatten().unwrap_or(true)
            }
            // Accelerations do not jump where friction no longer holds contacts, or where a gap opens.
            (Condition::Event(_) | Condition::Pressed(_) | Condition::Held(_), _) => false,
        };
        kernel.set_lane(&mut g.perturbation, lane, &direction);
    }
    g.reset |= u64::from(event.failed.resets()) << lane;
    for (contact, phase) in phases.iter().enumerate() {
        if *phase != run.phases[contact] {
            run.switches += u64::from(!phase.is_gap());
            run.last_switches[contact] = time;
        }
    }
    if phases[kernel.contacts()..] != run.phases[kernel.contacts()..] {
        run.touches.time += if any_closed(&run.phases) { time - run.last_touch } else { 0.0 };
        run.last_touch = time;
    }
    run.phases = phases;
    g.enter(lane, &state);
    Ok(())
}
