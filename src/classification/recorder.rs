//! Records the motion of a run inside the engine that computes it, so that the recorded motion is
//! exactly that of the run and is not affected by the recording.
//!
//! The engine passes every step to the recorder. A run that is continued to a later end time
//! restarts from the state saved before its end time had an effect; the record is rewound to the
//! same state.

use crate::model::System;
use crate::motion::{Effort, Instant, Motion, Phase};

/// The recorded instants.
#[derive(Clone, Debug, PartialEq)]
pub enum Instants {
    /// The start, the end of every step, and evenly spaced instants inside each step. At a switch
    /// there are two instants: before and after it.
    EveryStep {
        /// Number of instants inside each step.
        inside: u32,
    },
    /// These non-dimensional times, ascending; at a switch, after it.
    At(Vec<f64>),
}

/// A motion at an instant, non-dimensional.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Time.
    pub time: f64,
    /// How many steps had been taken when it was recorded: 0 at the start.
    pub step: u64,
    /// Position and velocity `(x, y, ẋ, ẏ)` of the ring's centre, in the frame that turns with the
    /// disc; `None` for a block.
    pub table: Option<[f64; 4]>,
    /// One sample per contact.
    pub contacts: Vec<ContactSample>,
}

/// A contact at an instant, non-dimensional.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactSample {
    /// Angle of a ball including the turns since the start, rad; position of a block.
    pub position: f64,
    /// Sliding speed: of a ball relative to the ring, of a block relative to its support.
    pub speed: f64,
    /// Its phase.
    pub phase: Phase,
    /// Friction force, acting against positive speed; in stick, the force required to stick.
    pub friction: f64,
    /// Friction limit: the static coefficient times the normal force.
    pub limit: f64,
    /// Normal force.
    pub normal: f64,
}

/// A change of a contact's phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Switch {
    /// Non-dimensional time.
    pub time: f64,
    /// The contact, from 0.
    pub contact: usize,
    /// Just before.
    pub before: ContactSample,
    /// Just after.
    pub after: ContactSample,
}

/// A recorded run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Instants in the order of time.
    pub samples: Vec<Sample>,
    /// All switches in chronological order, as many as counted in the run's effort.
    pub switches: Vec<Switch>,
    /// Whether the limit of the recorder was exceeded.
    pub cut_off: bool,
}

/// Records one run.
#[derive(Clone, Debug)]
pub struct Recorder {
    instants: Instants,
    most: usize,
    /// Time reached by the run.
    time: f64,
    effort: Effort,
    begun: bool,
    recording: Recording,
}

impl Recorder {
    /// Creates a recorder of these instants for at most `most` samples and as many switches.
    pub fn new(instants: Instants, most: usize) -> Self {
        Recorder {
            instants,
            most,
            time: 0.0,
            effort: Effort::default(),
            begun: false,
            recording: Recording::default(),
        }
    }

    /// Returns the recording.
    pub fn finish(self) -> Recording {
        self.recording
    }

    /// Discards everything: the run is computed again.
    pub(super) fn restart(&mut self) {
        *self =
            Recorder::new(std::mem::replace(&mut self.instants, Instants::At(vec![])), self.most);
    }

    /// Rewinds to the time at which the run had cost `effort`.
    pub(super) fn rewind(&mut self, time: f64, effort: Effort) {
        let Recording { samples, switches, cut_off } = &mut self.recording;
        samples.truncate(samples.partition_point(|sample| sample.step <= effort.steps));
        switches.truncate(usize::try_from(effort.switches).unwrap_or(usize::MAX));
        *cut_off &= samples.len() >= self.most || switches.len() >= self.most;
        (self.time, self.effort) = (time, effort);
    }

    /// Adds the start of a run, or its latest step; a step that was added before is ignored.
    pub(super) fn take_in<S: System<N, FREE>, const N: usize, const FREE: usize>(
        &mut self,
        system: &S,
        motion: &mut Motion<'_, S, N, FREE>,
    ) {
        let effort = motion.effort();
        if !self.begun {
            self.begun = true;
            let first = match &self.instants {
                Instants::EveryStep { .. } => true,
                Instants::At(times) => times.first() == Some(&0.0),
            };
            if first {
                self.push(system, 0, &motion.now());
            }
        }
        if effort.steps == self.effort.steps {
            return;
        }
        let Some(began) = motion.last_step_began() else { return };
        match &self.instants {
            Instants::EveryStep { inside } => {
                let (parts, length) = (inside + 1, motion.time() - began);
                for part in 1..parts {
                    let time = began + length * f64::from(part) / f64::from(parts);
                    if let Some(instant) = motion.inside_last_step(time) {
                        self.push(system, effort.steps, &instant);
                    }
                }
                if let Some(before) = motion.before_switch() {
                    self.push(system, effort.steps, &before);
                }
                self.push(system, effort.steps, &motion.now());
            }
            Instants::At(times) => {
                let first = times.partition_point(|time| *time <= self.time);
                let end = times.partition_point(|time| *time <= motion.time());
                let due: Vec<f64> = times.get(first..end).unwrap_or_default().to_vec();
                for time in due {
                    let instant = motion.inside_last_step(time).unwrap_or_else(|| motion.now());
                    self.push(system, effort.steps, &instant);
                }
            }
        }
        if let Some(before) = motion.before_switch() {
            self.switches(system, &before, &motion.now());
        }
        (self.time, self.effort) = (motion.time(), effort);
    }

    fn switches<S: System<N, FREE>, const N: usize, const FREE: usize>(
        &mut self,
        system: &S,
        before: &Instant<N, FREE>,
        after: &Instant<N, FREE>,
    ) {
        for contact in (0..N).filter(|&contact| before.phases[contact] != after.phases[contact]) {
            if self.recording.switches.len() >= self.most {
                self.recording.cut_off = true;
                return;
            }
            self.recording.switches.push(Switch {
                time: after.time,
                contact,
                before: contact_sample(system, before, contact),
                after: contact_sample(system, after, contact),
            });
        }
    }

    fn push<S: System<N, FREE>, const N: usize, const FREE: usize>(
        &mut self,
        system: &S,
        step: u64,
        instant: &Instant<N, FREE>,
    ) {
        if self.recording.samples.len() >= self.most {
            self.recording.cut_off = true;
            return;
        }
        let Instant { time, state, .. } = instant;
        let table = || {
            Some([*state.position.first()?, *state.position.get(1)?])
                .zip(Some([*state.velocity.first()?, *state.velocity.get(1)?]))
                .map(|([x, y], [x_dot, y_dot])| [x, y, x_dot, y_dot])
        };
        self.recording.samples.push(Sample {
            time: *time,
            step,
            table: table(),
            contacts: (0..N).map(|contact| contact_sample(system, instant, contact)).collect(),
        });
    }
}

fn contact_sample<S: System<N, FREE>, const N: usize, const FREE: usize>(
    system: &S,
    instant: &Instant<N, FREE>,
    contact: usize,
) -> ContactSample {
    let normal = instant.forces.normal[contact];
    ContactSample {
        position: instant.unwrapped[contact],
        speed: instant.state.beta_dot[contact],
        phase: instant.phases[contact],
        friction: instant.forces.friction[contact],
        limit: system.friction(contact).limit * normal,
        normal,
    }
}
