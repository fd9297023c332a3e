//! The latest step, and the condition whose failure ends it early.

use super::contact::{AHEAD, Phase, SmoothPhase, look_ahead};
use super::dop853::Step;
use super::guard::{Guard, Margins, Point};
use super::interpolant::Interpolant;
use super::root::{fall_of_smooth, fall_through_zero};
use crate::model::{Forces, State, System};

/// The latest step with its dense output.
#[derive(Clone, Debug)]
pub(super) struct LastStep<const N: usize, const FREE: usize> {
    pub(super) step: Step<N, f64, FREE>,
    pub(super) phases: [Phase; N],
    pub(super) end_derivative: State<N, f64, FREE>,
    pub(super) start_time: f64,
    /// The used fraction of the step: less than 1 if a switch shortened it.
    pub(super) used: f64,
    pub(super) interpolant: Option<Interpolant<N, FREE>>,
    /// The condition whose failure shortened the step.
    pub(super) ended_by: Option<Guard>,
}

/// What ends a step early.
#[derive(Clone, Copy, Debug)]
pub(super) struct FirstSwitch {
    /// When, as a fraction of the step.
    pub(super) theta: f64,
    /// The condition that fails.
    pub(super) guard: Guard,
}

impl<const N: usize, const FREE: usize> LastStep<N, FREE> {
    /// Returns the dense output over the step, computed on first use.
    pub(super) fn interpolant<S: System<N, FREE>>(&mut self, system: &S) -> &Interpolant<N, FREE> {
        let (step, phases) = (&self.step, &self.phases);
        let end_derivative = &self.end_derivative;
        self.interpolant.get_or_insert_with(|| {
            let phase = SmoothPhase::new(system, phases);
            step.interpolant(|state| phase.derivative(state), end_derivative)
        })
    }

    /// Returns time and state at which a function of the state falls from above zero to zero or
    /// below; `None` if it does not fall between the step's start and `end`, the state where the
    /// used part of the step ended.
    pub(super) fn falls_through_zero<S: System<N, FREE>>(
        &mut self,
        system: &S,
        end: &State<N, f64, FREE>,
        value: impl Fn(&State<N, f64, FREE>) -> f64,
    ) -> Option<(f64, State<N, f64, FREE>)> {
        let (start, end) = (value(&self.step.start), value(end));
        if !(start > 0.0 && end <= 0.0) {
            return None;
        }
        let (used, start_time, length) = (self.used, self.start_time, self.step.length);
        let interpolant = self.interpolant(system);
        let theta = fall_through_zero(
            |theta| value(&interpolant.at(theta)),
            (0.0, start),
            (used, end),
            1e-13,
        );
        Some((start_time + theta * length, interpolant.at(theta)))
    }

    /// Returns time and state at which a contact passes a position in the direction `sign`; `None`
    /// if it does not between the step's start and `end`, its position where the used part of the
    /// step ended.
    pub(super) fn passes<S: System<N, FREE>>(
        &mut self,
        system: &S,
        contact: usize,
        end: f64,
        (mark, sign): (f64, f64),
    ) -> Option<(f64, State<N, f64, FREE>)> {
        let before = |position: f64| sign * (mark - position);
        let (start, end) = (before(self.step.start.beta[contact]), before(end));
        if !(start > 0.0 && end <= 0.0) {
            return None;
        }
        let (used, start_time, length) = (self.used, self.start_time, self.step.length);
        let interpolant = self.interpolant(system);
        let theta = fall_of_smooth(
            |theta| {
                let (position, slope) = interpolant.position_at(contact, theta);
                (before(position), -sign * slope)
            },
            (0.0, used),
            used * start / (start - end),
            1e-13,
        );
        Some((start_time + theta * length, interpolant.at(theta)))
    }

    /// Returns the condition that fails first, `after` a fraction of the step; `None` if all hold
    /// to its end. `start` is the start of the step, with the derivative there.
    pub(super) fn first_switch<S: System<N, FREE>>(
        &mut self,
        system: &S,
        margins: Margins,
        (start, start_derivative): (Point<N, FREE>, &State<N, f64, FREE>),
        end_forces: &Forces<N, f64, FREE>,
        after: f64,
    ) -> Option<FirstSwitch> {
        let phases = self.phases;
        let phase = SmoothPhase::new(system, &phases);
        let mut first: Option<FirstSwitch> = None;
        let (step_end, length) = (self.step.end, self.step.length);
        let forces = [start.1, end_forces];
        let mut ahead = None;
        for guard in Guard::all(&phases) {
            let value = |point: Point<N, FREE>| guard.value(system, margins, point);
            let (at_start, at_end) = (value(start), value((&step_end, end_forces)));
            let slopes = || {
                let [soon, later] = ahead.get_or_insert_with(|| {
                    [(start.0, start_derivative), (&step_end, &self.end_derivative)].map(
                        |(state, derivative)| {
                            let state = look_ahead(state, derivative);
                            let forces = phase.forces(&state);
                            (state, forces)
                        },
                    )
                });
                let [soon, later] = [soon, later].map(|(state, forces)| value((state, forces)));
                [(soon - at_start) / AHEAD, (later - at_end) / AHEAD]
            };
            if at_end >= 0.0 && !guard.may_dip(system, length, [at_start, at_end], forces, slopes) {
                continue;
            }
            let interpolant = self.interpolant(system);
            let event = guard.first_event((at_start, at_end), |theta| {
                let state = interpolant.at(theta);
                value((&state, &phase.forces(&state)))
            });
            if let Some(theta) = event
                && theta > after
                && first.is_none_or(|first| theta < first.theta)
            {
                first = Some(FirstSwitch { theta, guard });
            }
        }
        first
    }
}
