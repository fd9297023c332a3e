//! Records the motion of a run inside the engine that computes it, so that the recorded motion is
//! exactly that of the run and is not affected by the recording.
//!
//! The engine passes every step to the recorder. A run that is continued to a later end time
//! restarts from the state saved before its end time had an effect; the record is rewound to the
//! same state.
//!
//! Where a stage of the run ends and the next one begins, there are two instants, as at a switch: a kick changes
//! velocities, and a corner of the speed changes forces.

use super::gap_sample::{GapSample, Touch, gap_samples, touches};
use super::lane_step::LaneStep;
use super::system_view::SystemView;
use crate::model::Components;
use crate::motion::{Effort, Instant, Phase};

/// The recorded instants.
#[derive(Clone, Debug, PartialEq)]
pub enum Instants {
    /// The start, the end of every step, and evenly spaced instants inside each step. At a switch, and where a stage of
    /// the run begins, there are two instants: before and after it.
    EveryStep {
        /// Number of instants inside each step.
        inside: u32,
    },
    /// These non-dimensional times, ascending; at a switch or at the begin of a stage, after it.
    At(Vec<f64>),
}

/// A motion at an instant, non-dimensional.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionSample {
    /// Time.
    pub time: f64,
    /// How many steps had been taken when it was recorded: 0 at the start.
    pub step: u64,
    /// Position and velocity `(x, y, ẋ, ẏ)` of the disc's centre, in the frame that turns with the
    /// disc; `None` for a block.
    pub table: Option<[f64; 4]>,
    /// One sample per contact.
    pub contacts: Vec<ContactSample>,
    /// One sample per gap between contacts.
    pub gaps: Vec<GapSample>,
    /// The outputs, for a system that has some.
    pub outputs: Components,
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
    /// Normal force; 0 while the contact is apart.
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
pub struct RecordedRun {
    /// Instants in the order of time.
    pub samples: Vec<MotionSample>,
    /// All switches in chronological order, as many as counted in the run's effort; also those at the begin of a stage.
    pub switches: Vec<Switch>,
    /// All impacts between contacts in chronological order, as many as counted in the outcome, and where contacts that
    /// touch separate.
    pub touches: Vec<Touch>,
    /// The times at which contacts that were apart have hit, with the contact, counted from 0.
    pub landings: Vec<(f64, usize)>,
    /// Whether the limit of the recorder was exceeded.
    pub cut_off: bool,
}

/// Records one run.
#[derive(Clone, Debug)]
pub struct RunRecorder {
    instants: Instants,
    most: usize,
    /// Time reached by the run.
    time: f64,
    effort: Effort,
    begun: bool,
    /// The end of a stage, until the next stage begins.
    left: Option<Instant>,
    recording: RecordedRun,
}

impl RunRecorder {
    /// Creates a recorder of these instants for at most `most` samples, as many switches and as many
    /// touches.
    pub fn new(instants: Instants, most: usize) -> Self {
        RunRecorder {
            instants,
            most,
            time: 0.0,
            effort: Effort::default(),
            begun: false,
            left: None,
            recording: RecordedRun::default(),
        }
    }

    /// Returns the recording.
    pub fn finish(self) -> RecordedRun {
        self.recording
    }

    /// Discards everything: the run is computed again.
    pub(super) fn restart(&mut self) {
        *self = RunRecorder::new(
            std::mem::replace(&mut self.instants, Instants::At(vec![])),
            self.most,
        );
    }

    /// Rewinds to the time at which the run had cost `effort`.
    pub(super) fn rewind(&mut self, time: f64, effort: Effort) {
        let RecordedRun { samples, switches, touches, landings, cut_off } = &mut self.recording;
        landings.truncate(landings.partition_point(|(landed, _)| *landed <= time));
        samples.truncate(samples.partition_point(|sample| sample.step <= effort.steps));
        switches.truncate(usize::try_from(effort.switches).unwrap_or(usize::MAX));
        touches.truncate(touches.partition_point(|touch| touch.time <= time));
        *cut_off &=
            [samples.len(), switches.len(), touches.len()].iter().any(|all| *all >= self.most);
        (self.time, self.effort) = (time, effort);
    }

    /// Adds the start of a run, or its latest step; a step that was added before is ignored.
    pub(super) fn take_in(&mut self, step: &LaneStep) {
        let (view, effort) = (step.view, step.effort());
        if !self.begun {
            self.begun = true;
            let first = match &self.instants {
                Instants::EveryStep { .. } => true,
                Instants::At(times) => times.first() == Some(&0.0),
            };
            let now = step.now();
            if first {
                self.push(view, 0, &now);
            }
            self.touches(step, [&now, &now]);
        }
        if let Some(before) = self.left.take() {
            self.enters(step, &before);
        }
        if effort.steps == self.effort.steps {
            return;
        }
        let began = step.began();
        match &self.instants {
            Instants::EveryStep { inside } => {
                let (parts, length) = (inside + 1, step.time() - began);
                for part in 1..parts {
                    let time = began + length * f64::from(part) / f64::from(parts);
                    if let Some(instant) = step.inside(time) {
                        self.push(view, effort.steps, &instant);
                    }
                }
                if let Some(before) = step.before_switch() {
                    self.push(view, effort.steps, &before);
                }
                self.push(view, effort.steps, &step.now());
            }
            Instants::At(times) => {
                let first = times.partition_point(|time| *time <= self.time);
                let end = times.partition_point(|time| *time <= step.time());
                let due: Vec<f64> = times.get(first..end).unwrap_or_default().to_vec();
                for time in due {
                    let instant = step.inside(time).unwrap_or_else(|| step.now());
                    self.push(view, effort.steps, &instant);
                }
            }
        }
        if let Some(before) = step.before_switch() {
            self.switches(view, &before, &step.now());
            self.touches(step, [&before, &step.now()]);
        }
        (self.time, self.effort) = (step.time(), effort);
    }

    /// Keeps the latest step as the last one of a stage.
    pub(super) fn leaves(&mut self, step: &LaneStep) {
        self.left = Some(step.now());
    }

    /// Adds the begin of a stage after the end of the one before.
    fn enters(&mut self, step: &LaneStep, before: &Instant) {
        let (view, now) = (step.view, step.now());
        let every_step = matches!(self.instants, Instants::EveryStep { .. });
        if every_step || self.recording.samples.pop_if(|last| last.time == now.time).is_some() {
            self.push(view, step.effort().steps, &now);
        }
        self.switches(view, before, &now);
        self.touches(step, [before, &now]);
    }

    fn switches(&mut self, view: &SystemView, before: &Instant, after: &Instant) {
        let contacts = 0..view.contacts.len();
        for contact in contacts.filter(|&contact| before.phases[contact] != after.phases[contact]) {
            if self.recording.switches.len() >= self.most {
                self.recording.cut_off = true;
                return;
            }
            self.recording.switches.push(Switch {
                time: after.time,
                contact,
                before: contact_sample(view, before, contact),
                after: contact_sample(view, after, contact),
            });
        }
    }

    fn touches(&mut self, step: &LaneStep, [before, after]: [&Instant; 2]) {
        let landed = step.landed().iter().map(|contact| (after.time, *contact));
        let left = self.most.saturating_sub(self.recording.landings.len());
        self.recording.cut_off |= landed.len() > left;
        self.recording.landings.extend(landed.take(left));
        for touch in touches(step.view, step.hits(), before, after) {
            if self.recording.touches.len() >= self.most {
                self.recording.cut_off = true;
                return;
            }
            self.recording.touches.push(touch);
        }
    }

    fn push(&mut self, view: &SystemView, step: u64, instant: &Instant) {
        if self.recording.samples.len() >= self.most {
            self.recording.cut_off = true;
            return;
        }
        let contacts = 0..view.contacts.len();
        self.recording.samples.push(MotionSample {
            time: instant.time,
            step,
            table: view.vibration.map(|places| places.map(|place| instant.state[place])),
            contacts: contacts.map(|contact| contact_sample(view, instant, contact)).collect(),
            gaps: gap_samples(view, instant),
            outputs: view.outputs(&instant.state, &instant.unwrapped),
        });
    }
}

fn contact_sample(view: &SystemView, instant: &Instant, contact: usize) -> ContactSample {
    let (forces, phase) = (instant.forces[contact], instant.phases[contact]);
    // What the equations have in the place of the normal force of a contact that is apart is its gap.
    let normal = if phase == Phase::Apart { 0.0 } else { forces.normal };
    ContactSample {
        position: instant.unwrapped[contact],
        speed: forces.speed,
        phase,
        friction: forces.friction,
        limit: view.system().friction(contact).limit * normal,
        normal,
    }
}
