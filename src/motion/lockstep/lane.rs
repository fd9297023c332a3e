//! The scalar part of one of the runs in lockstep.

use std::sync::Arc;

use crate::model::System;
use crate::motion::cluster::HeldCluster;
use crate::motion::condition::Margins;
use crate::motion::impact::Impact;
use crate::motion::settings::MOST_EVENTS_AT_ONCE;
use crate::motion::{Effort, Failure, PerContact, Phases, Settings, Touches, any_closed};

/// The scalar part of a run.
#[derive(Clone, Debug)]
pub(crate) struct Lane {
    pub(super) system: Arc<dyn System>,
    pub(super) settings: Settings,
    pub(super) margins: Margins,
    /// What the system says of itself: its static coefficients of friction, the size of its forces, whether it has gaps,
    /// whether contacts open, and whether stick and slip have a unique decision in all states.
    pub(super) limits: PerContact,
    pub(super) force_scale: f64,
    pub(super) has_gaps: bool,
    pub(super) has_openings: bool,
    pub(super) surely_one_solution: bool,
    pub(super) slow: f64,
    /// Width within which events are located.
    pub(super) width: f64,
    pub(super) longest_step: f64,
    pub(super) fastest_rate: f64,
    pub(super) phases: Phases,
    /// The phases in the latest step, before an event at its end.
    pub(super) during: Phases,
    pub(super) last_switches: PerContact,
    pub(super) switches: u64,
    /// The impact of the latest event, if there was one, and the time of the latest impact.
    pub(super) impact: Option<Box<Impact>>,
    pub(super) hit_at: f64,
    /// How the contacts have touched until the latest gap closed or opened, and the time of that.
    pub(super) touches: Touches,
    pub(super) last_touch: f64,
    /// The contacts that stick and touch.
    pub(super) held: Vec<HeldCluster>,
    /// Whether a perturbation met a switch by grazing.
    pub(super) grazed: bool,
    /// The events within a unit of time over the fastest rate, and its begin.
    pub(super) events: u32,
    pub(super) events_since: f64,
}

impl Lane {
    /// Returns the effort of the run for this number of steps.
    pub(super) fn effort(&self, taken: f64) -> Effort {
        Effort { steps: taken as u64, rejected_steps: 0, switches: self.switches }
    }

    /// Returns how the contacts have touched until a time; `None` for a system without gaps.
    pub(super) fn touches(&self, time: f64) -> Option<Touches> {
        self.system.touching()?;
        let now = if any_closed(&self.phases) { time - self.last_touch } else { 0.0 };
        Some(Touches { time: self.touches.time + now, ..self.touches })
    }

    /// Counts an event.
    pub(super) fn count_event(&mut self, time: f64) -> Result<(), Failure> {
        if time >= self.events_since + 1.0 / self.fastest_rate {
            (self.events, self.events_since) = (0, time);
        }
        self.events += 1;
        if self.events > MOST_EVENTS_AT_ONCE { Err(Failure::StepLimit) } else { Ok(()) }
    }

    /// Returns whether a contact sticks and touches others.
    pub(super) fn is_held(&self, contact: usize) -> bool {
        self.held.iter().any(|cluster| cluster.contacts.contains(&contact))
    }

    /// Takes in the impact of an event, if there was one.
    pub(super) fn take_in(&mut self, impact: Option<Box<Impact>>, time: f64) {
        if let Some(impact) = &impact {
            self.touches.impacts += (impact.hits.len() + impact.landed.len()) as u64;
            self.touches.lifted_off += impact.lifted as u64;
            self.hit_at = time;
        }
        self.impact = impact;
    }
}
