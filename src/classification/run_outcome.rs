//! The outcome of a run in a lane, in SI units.

use super::closed_orbit::Orbit;
use super::creep::{creeps, may_creep};
use super::cycle::Cycle;
use super::ending::Ending;
use super::held_bodies::{friction_margin, held_margin};
use super::horizons::TailStatistics;
use super::lane_run::LaneRun;
use super::lane_step::LaneStep;
use super::outcome::{ClosedOrbit, Evidence, LyapunovExponent, Outcome, Rest, TouchingOutcome};
use super::output_watch::OutputOutcome;
use super::settled::{SLOW, approaches_edge};
use super::system_view::ContactPlace;
use crate::model::{ContactUnits, OutputValue};
use crate::motion::lockstep::LaneGroup;
use crate::motion::{Failure, Motion, Phase, SINGULAR, any_closed};

/// The smallest pivot of the mass matrix, over the entry on its diagonal, that explains why a motion could not be continued.
const NEARLY_SINGULAR: f64 = 1e-3;

/// The time over which rates of change of outputs are differences.
const AHEAD: f64 = 1e-3;

/// Returns the latest of some times.
fn latest(times: &[f64]) -> f64 {
    times.iter().copied().fold(0.0, f64::max)
}

impl LaneRun {
    /// Returns the outcome of a run that ends after its latest step.
    pub(super) fn outcome(&self, group: &dyn LaneGroup, lane: usize, ending: Ending) -> Outcome {
        let natural = self.units.natural_rad_s;
        let step = LaneStep { group, lane, view: &self.view };
        let ending = self.checked(ending, &group.state(lane));
        let position = self.view.wrapped(&group.state(lane));
        let position = self.units.of_contacts(&position, |unit| unit.position);
        let outputs = self.outputs(&ending, &step);
        let amplitude_m = self.amplitude_of_outputs(&outputs, (&ending, &group.state(lane)));
        let base = Outcome {
            end_time_s: Some(step.time() / natural),
            extended: self.extended,
            position: Some(position),
            outputs,
            stages: self.stages.outcomes(&step, &self.units),
            peak: self.view.vibration.and_then(|_| self.stages.peak(&self.units)),
            touching: group.touches(lane).map(|touches| TouchingOutcome {
                impacts: touches.impacts,
                lifted_off: touches.lifted_off,
                time_s: touches.time / natural,
                at_end: any_closed(group.phases(lane)),
                force_n: None,
            }),
            effort: step.effort(),
            ..Outcome::default()
        };
        let rest = |since: Option<f64>, friction_margin: Option<f64>| Rest {
            since_s: since.map(|since| since / natural),
            friction_margin,
        };
        let stopped = || Some(latest(group.last_switches(lane)));
        let outcome = match ending {
            Ending::Rest => {
                let is_held =
                    || held_margin(&self.view, step.phases(), &group.state(lane)).is_some();
                let certified =
                    self.view.rest_forms().is_none_or(|forms| forms.are_closed()) || is_held();
                let evidence =
                    if certified { Evidence::RestCertified } else { Evidence::RestContracting };
                self.at_rest(&step, base, |margin| evidence(rest(stopped(), margin)))
            }
            Ending::Settled(place) => {
                let margin = friction_margin(&self.view, step.phases(), &group.state(lane));
                let settled = Evidence::Settled(rest(self.slow_since(&step), margin));
                let touching = self.with_force(&base, self.force_in_gaps(&step));
                // Steady motion goes on.
                let rates = self.view.evaluator.rates(step.phases(), &place);
                let speed = |contact: &ContactPlace| match rates[contact.position] {
                    rate if rate.abs() > SLOW => rate,
                    _ => 0.0,
                };
                let speeds: Vec<f64> = self.view.contacts.iter().map(speed).collect();
                let turns = speeds.iter().filter(|speed| **speed != 0.0).count() as u8;
                Outcome {
                    touching,
                    balls_running: self.view.revolves().then_some(turns),
                    mean_speed: self.view.revolves().then(|| self.speeds(&speeds)),
                    ..self.at_rest(&step, base, |_| settled)
                }
            }
            Ending::Orbit(orbit) if orbit.rests && orbit.attracts => {
                self.at_rest(&step, base, |_| Evidence::PeriodicRest(rest(stopped(), orbit.margin)))
            }
            Ending::Orbit(orbit) => Outcome {
                evidence: {
                    let of = if orbit.attracts { Evidence::ClosedOrbit } else { Evidence::Repeats };
                    of(ClosedOrbit {
                        period_s: orbit.period / natural,
                        friction_margin: orbit.margin,
                        cycle: Some(self.cycle(&orbit, amplitude_m)),
                    })
                },
                balls_running: self.view.revolves().then(|| running(&orbit)),
                amplitude_m: self.amplitude_m(orbit.amplitude),
                mean_speed: self.view.moves_on().then(|| self.speeds(&orbit.speed)),
                ..base
            },
            // Without a rest certificate, rest begins when the contacts are slow. The contacts are on the edge of the
            // set, approached from outside.
            Ending::EndTime if self.creeps(&step) => self.at_rest(&step, base, |margin| {
                let margin = margin.map(|margin| margin.max(0.0));
                Evidence::Creep(rest(Some(latest(&group.slow_since(lane))), margin))
            }),
            Ending::Creep(creep) => Outcome {
                evidence: Evidence::PeriodicCreep { period_s: creep.period / natural },
                mean_speed: self.view.moves_on().then(|| self.speeds(&creep.speed)),
                ..self.at_end_time(&step, base)
            },
            Ending::EndTime => self.at_end_time(&step, base),
            Ending::Failure(failure) => Outcome { evidence: Evidence::Failure(failure), ..base },
        };
        Outcome { amplitude_m: outcome.amplitude_m.or(amplitude_m), ..outcome }
    }

    /// Returns the outputs of a run that ends after its latest step.
    fn outputs(&self, ending: &Ending, step: &LaneStep) -> Vec<OutputOutcome> {
        if !self.view.has_outputs {
            return Vec::new();
        }
        let state = step.group.state(step.lane);
        let measured = match ending {
            Ending::Rest => {
                let rest = self.view.rest_forms().and_then(|forms| forms.rest_state(&state));
                self.constant_outputs(step.phases(), rest.as_ref().unwrap_or(&state))
            }
            Ending::Settled(place) => self.constant_outputs(step.phases(), place),
            Ending::Orbit(orbit) => orbit.outputs.clone(),
            Ending::Creep(creep) => creep.outputs.clone(),
            Ending::EndTime => self.horizons.now.statistics.outputs.measured(false),
            Ending::Failure(_) => Vec::new(),
        };
        let measured = measured.into_iter().chain(std::iter::repeat(OutputOutcome::at(0.0)));
        let ends = self.view.system().outputs(&state).into_iter();
        let all = ends.zip(measured).map(|(end, measured)| OutputOutcome { end, ..measured });
        let units = self.units.outputs.iter();
        all.zip(units).map(|(output, units)| output.in_units(units)).collect()
    }

    /// Returns the outputs of a motion that stays in a state but for a translation that no equation notices.
    fn constant_outputs(&self, phases: &[Phase], state: &[f64]) -> Vec<OutputOutcome> {
        let rates = self.view.evaluator.rates(phases, state);
        let translations = &self.view.translations;
        let carried =
            |place: usize| rates[place] - translations.remaining(|place| rates[place], place);
        let ahead = state.iter().zip(0..).map(|(value, place)| value + AHEAD * carried(place));
        let ahead: Vec<f64> = ahead.collect();
        let [now, later] = [state, &ahead].map(|state| self.view.system().outputs(state));
        let each = now.iter().zip(&later);
        each.map(|(now, later)| OutputOutcome::constant(*now, (later - now) / AHEAD)).collect()
    }

    /// Returns the largest amplitude of the coordinates that are lengths, m; `None` if there is none, or if all of them drift.
    fn amplitude_of_outputs(
        &self,
        outputs: &[OutputOutcome],
        (ending, state): (&Ending, &[f64]),
    ) -> Option<f64> {
        // Until the end time, a coordinate may move on with a translation.
        let (changed, ends) = match ending {
            Ending::EndTime => (
                self.view.translations.changed(state, |state| self.view.system().outputs(state)),
                self.horizons.now.statistics.outputs.displaced(),
            ),
            _ => Default::default(),
        };
        let amplitude = |(number, output): (usize, &OutputOutcome)| {
            let amplitude = output.value(OutputValue::Amplitude)?;
            let displaced = ends.get(number).and_then(|ends| ends.creep).unwrap_or_default();
            let size = self.units.outputs[number].size;
            let drifts = changed.get(number) == Some(&true) && (displaced * size).abs() > amplitude;
            (self.units.outputs[number].has_amplitude && !drifts).then_some(amplitude)
        };
        let outputs = outputs.iter().take(self.units.outputs.len());
        outputs.enumerate().filter_map(amplitude).reduce(f64::max)
    }

    /// Returns an ending, or that the mass matrix is no longer one of a mechanical system. A motion cannot be continued where the
    /// matrix becomes singular.
    fn checked(&self, ending: Ending, state: &[f64]) -> Ending {
        let least = if matches!(ending, Ending::Failure(_)) { NEARLY_SINGULAR } else { SINGULAR };
        let is_finite = state.iter().all(|value| value.is_finite());
        match is_finite && self.view.system().smallest_inertia(state) < least {
            true => Ending::Failure(Failure::IndefiniteMass),
            false => ending,
        }
    }

    /// Returns the outcome of a run at rest; `evidence` makes the evidence from the friction margin at the rest point.
    fn at_rest(
        &self,
        step: &LaneStep,
        base: Outcome,
        evidence: impl FnOnce(Option<f64>) -> Evidence,
    ) -> Outcome {
        let state = step.group.state(step.lane);
        let rest = self.view.rest_forms().map(|forms| forms.at_rest(&state));
        let amplitude = rest.map_or_else(|| self.view.square(&state).sqrt(), |rest| rest.amplitude);
        let margin = held_margin(&self.view, step.phases(), &state)
            .or_else(|| rest.map(|rest| rest.friction_margin).filter(|margin| margin.is_finite()));
        let revolves = self.view.revolves();
        let force = || self.view.rest_forms()?.contact_force(&state);
        Outcome {
            touching: self.with_force(&base, base.touching.and_then(|_| force())),
            evidence: evidence(margin),
            balls_running: revolves.then_some(0),
            amplitude_m: self.amplitude_m(amplitude),
            mean_speed: revolves.then(|| vec![0.0; self.view.contacts.len()]),
            ..base
        }
    }

    /// Returns what balls that touch have done, with a force on a contact, over its mass.
    fn with_force(&self, base: &Outcome, force: Option<(usize, f64)>) -> Option<TouchingOutcome> {
        let force_n = force.map(|(contact, force)| force * self.units.contacts[contact].force_n);
        base.touching.map(|touching| TouchingOutcome { force_n, ..touching })
    }

    /// Returns the contact that the largest force in a gap acts on, and the force over the contact's mass.
    fn force_in_gaps(&self, step: &LaneStep) -> Option<(usize, f64)> {
        let gaps = self.view.system().touching()?.gaps();
        let state = step.group.state(step.lane);
        let phases = step.group.phases(step.lane);
        let (_, forces) = self.view.evaluator.incremental_forces(&state).forces_and_gaps(phases);
        let closed = gaps.iter().zip(&forces).zip(&phases[self.view.contacts.len()..]);
        let closed = closed.filter(|(_, phase)| **phase == Phase::Closed);
        let largest = closed.max_by(|left, right| left.0.1.force.total_cmp(&right.0.1.force));
        largest.map(|((gap, force), _)| (gap.contacts[0], force.force / gap.masses[0]))
    }

    /// Returns the outcome of a run at its end time without another ending.
    fn at_end_time(&self, step: &LaneStep, base: Outcome) -> Outcome {
        let natural = self.units.natural_rad_s;
        let TailStatistics { window, separation, .. } = &self.horizons.now.statistics;
        let lyapunov = separation.exponent().map(|exponent| in_seconds(exponent, natural));
        let base = Outcome { lyapunov, ..base };
        let watch = self.watch.as_ref();
        let base = Outcome {
            evidence: if let Some(orbit) = watch.and_then(|watch| watch.unstable_orbit()) {
                Evidence::UnstableOrbit(self.cycle(orbit, None))
            } else if separation.is_irregular() {
                Evidence::Lyapunov
            } else if watch.is_some_and(|watch| watch.fills_a_torus()) {
                Evidence::Torus
            } else {
                Evidence::EndTime
            },
            ..base
        };
        let Some(means) = window.means(step) else { return base };
        let revolves = self.view.revolves();
        let contacts = self.view.contacts.iter().zip(&means.moved);
        let runs = contacts
            .filter(|(contact, moved)| contact.angular && moved.abs() >= std::f64::consts::TAU);
        Outcome {
            balls_running: revolves.then(|| runs.count() as u8),
            amplitude_m: self.amplitude_m(means.amplitude),
            mean_speed: revolves.then(|| self.speeds(&means.speed)),
            ..base
        }
    }

    /// Returns speeds of contacts in SI units.
    fn speeds(&self, speeds: &[f64]) -> Vec<f64> {
        self.units.of_contacts(speeds, |unit| unit.sliding_speed)
    }

    /// Returns the time since which a settled run is at rest: if a displacement is measured, since
    /// the contacts are slow, otherwise since everything is slow.
    fn slow_since(&self, step: &LaneStep) -> Option<f64> {
        match self.view.vibration {
            Some(_) => Some(latest(&step.group.slow_since(step.lane))),
            None => self.settled.slow_since,
        }
    }

    /// Returns whether all contacts creep.
    fn creeps(&self, step: &LaneStep) -> bool {
        let LaneStep { group, lane, view } = *step;
        let slow = group.slow_since(lane).iter().all(|since| *since < step.time());
        let state = group.state(lane);
        let may = || {
            view.rest_forms().is_some_and(|forms| may_creep(forms, &state))
                || view.vibration.is_none() && approaches_edge(view, group.phases(lane), &state)
        };
        slow && may() && group.copy(lane).is_some_and(|saved| creeps(Motion::resume(&saved)))
    }

    /// Returns an amplitude of the displacement, m; `None` for a system without a displacement.
    fn amplitude_m(&self, amplitude: f64) -> Option<f64> {
        self.view.vibration.map(|_| amplitude * self.units.length_m)
    }

    /// Returns a cycle with its largest displacement, or the amplitude of its outputs if they have one.
    fn cycle(&self, orbit: &Orbit, amplitude_m: Option<f64>) -> Box<Cycle> {
        let units = &self.units;
        let contacts = self.view.contacts.iter().zip(&units.contacts);
        let position = |(((contact, unit), &turns), extremes): (
            ((&ContactPlace, &ContactUnits), &i32),
            &[f64; 2],
        )| {
            (turns == 0 && contact.angular).then(|| extremes.map(|value| value * unit.position))
        };
        let positions = contacts.zip(&orbit.turns).zip(&orbit.position_extremes);
        let speeds = orbit.speed_extremes.iter().zip(&units.contacts);
        let speeds = speeds.map(|(two, unit)| two.map(|speed| speed * unit.sliding_speed));
        let peak_m = amplitude_m.or_else(|| self.amplitude_m(orbit.peak));
        Box::new(Cycle {
            turns: orbit.turns.clone(),
            configurations: orbit.configurations.clone(),
            touching: orbit.touching.clone(),
            speed_extremes: speeds.collect(),
            position_extremes: positions.map(position).collect(),
            stick_fraction: orbit.stick_fraction.clone(),
            peak_amplitude_m: peak_m.unwrap_or(0.0),
            multipliers: orbit.multipliers.clone(),
            neutral_directions: orbit.neutral_directions as u8,
        })
    }
}

/// An exponent per unit of non-dimensional time as one per second.
fn in_seconds(exponent: LyapunovExponent, natural: f64) -> LyapunovExponent {
    LyapunovExponent {
        exponent_1_s: exponent.exponent_1_s * natural,
        interval_1_s: exponent.interval_1_s.map(|ends| ends.map(|rate| rate * natural)),
        window_s: exponent.window_s / natural,
        ..exponent
    }
}

/// Returns the number of contacts that revolve.
fn running(orbit: &Orbit) -> u8 {
    orbit.turns.iter().filter(|&&turns| turns != 0).count() as u8
}
