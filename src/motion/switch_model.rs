//! The switch model (thesis sections 4.2 and 4.3, after Leine): a band around zero speed.
//!
//! Around zero speed of each ball lies a band `|β̇| ≤ η`. Outside it a ball slips; inside it either
//! sticks, with a constant angle and a speed that tends to the middle of the band, or is in
//! transition, against full friction. The thesis evaluates that vector field inside a general
//! solver. Here every smooth phase is integrated with its configuration fixed, the instant at which
//! a condition of the configuration fails is located on the dense output, and the next
//! configuration is decided jointly for all balls in the band; no step crosses a switch, so that
//! the method keeps its order.

use super::Failure;
use super::evaluator::Forces;
use super::joint_decision::{ForceModel, Open, resolve_modes, sets_off, stick_reserve};
use super::{Direction, Phase, Phases, Settings};
use crate::model::System;

/// Slack of the conditions for stick and transition, as an acceleration over `L ω_n²`: a phase ends
/// when its condition fails by more than this.
///
/// The slack prevents a decision that is met only up to rounding (the instant of break-away) from
/// being taken twice. It also determines how often a creeping ball, whose tangential force stays
/// near the friction limit, alternates between stick and transition: the number of switches is
/// inversely proportional to the slack. Friction limits of a real balancer are about 1e-3, a
/// million times larger.
pub const SLACK: f64 = 1e-9;

impl Settings {
    /// Returns the settings with a band in which the drag on each contact that can stick is at most half of the slack.
    ///
    /// A contact has no drag in the band, as at rest. A force between dry friction alone and both together at the edge of
    /// the band accelerates the contact inside the band and slows it down outside, so that it would enter and leave the
    /// band without end. In the narrower band, the slack covers this difference, and the contact sticks.
    pub(super) fn narrowed(self, system: &dyn System) -> Self {
        let contacts = (0..system.contacts()).map(|contact| system.friction(contact));
        let rates = contacts.filter(|friction| friction.can_stick());
        let rates = rates.map(|friction| friction.damping_rate(system.force_scale()));
        let most = rates.fold(0.0, f64::max);
        Settings { band: self.band.min(0.5 * SLACK / most), ..self }
    }
}

/// Decides stick or transition jointly for all contacts in the band and returns what `then` returns for the
/// corresponding forces. Slipping contacts are unchanged.
pub(super) fn decide<R>(
    system: &dyn ForceModel,
    phases: &mut Phases,
    then: impl FnOnce(&Forces) -> Result<R, Failure>,
) -> Result<R, Failure> {
    let mut open = Open::new();
    for phase in phases.iter() {
        open.push(phase.in_band());
    }
    let choices = [
        Phase::Stick,
        Phase::Transition(Direction::Forward),
        Phase::Transition(Direction::Backward),
    ];
    let better = |forces: &Forces, phases: &[Phase], contact: usize| match phases[contact] {
        Phase::Slip(_) | Phase::Free | Phase::Apart | Phase::Open | Phase::Closed => None,
        Phase::Stick => (stick_reserve(system, forces, contact) < -SLACK)
            .then(|| Phase::Transition(sets_off(system, forces, contact))),
        Phase::Transition(direction) => {
            (direction * forces[contact].acceleration < -SLACK).then_some(Phase::Stick)
        }
    };
    resolve_modes(system, phases, &open, choices, better, then)
}

/// Enters or leaves the band where the speeds have reached its edge.
pub(super) fn cross_band(band: f64, phases: &mut Phases, speed: impl Fn(usize) -> f64) {
    for (contact, phase) in phases.iter_mut().enumerate() {
        *phase = match *phase {
            Phase::Slip(direction) if direction * speed(contact) <= band => Phase::Stick,
            Phase::Transition(direction) if direction * speed(contact) >= band => {
                Phase::Slip(direction)
            }
            _ => *phase,
        };
    }
}
