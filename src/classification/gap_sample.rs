//! The gaps between contacts in a recorded motion: their widths, and the impacts and openings between two instants.

use super::system_view::SystemView;
use crate::model::Gap;
use crate::motion::{Hit, Instant, Phase};

/// A gap at an instant, non-dimensional.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GapSample {
    /// The contact behind and the contact ahead, counted from 0.
    pub contacts: [usize; 2],
    /// Its width: for balls, the angle between their centres less the angle at which they touch, rad.
    pub width: f64,
    /// The speed at which it opens, negative where it closes.
    pub opening_speed: f64,
    /// Open or closed.
    pub phase: Phase,
}

/// A change of a gap: an impact of its two contacts, or the end of their contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Touch {
    /// Non-dimensional time.
    pub time: f64,
    /// Positions of the contact behind and of the contact ahead, with the turns since the start.
    pub positions: [f64; 2],
    /// Just before.
    pub before: GapSample,
    /// Just after. After an impact of contacts that do not stay together, the gap is open again.
    pub after: GapSample,
}

impl Touch {
    /// Returns whether it is an impact.
    pub fn is_impact(&self) -> bool {
        self.before.phase == Phase::Open
    }
}

/// Returns the gaps of a system at an instant; none for a system without gaps.
pub(super) fn gap_samples(view: &SystemView, instant: &Instant) -> Vec<GapSample> {
    let gaps = view.system().touching().map_or(&[][..], |touching| touching.gaps());
    let phases = instant.phases.get(view.contacts.len()..).unwrap_or_default();
    let sample = |(gap, phase): (&Gap, &Phase)| {
        // What is left in the band of the speed of a contact that sticks moves nothing.
        let [behind, ahead] = gap.contacts.map(|contact| match instant.phases[contact] {
            Phase::Stick => 0.0,
            _ => instant.forces[contact].speed,
        });
        let places = gap.contacts.map(|contact| instant.state[view.contacts[contact].position]);
        GapSample {
            contacts: gap.contacts,
            width: gap.width(places),
            opening_speed: ahead - behind,
            phase: *phase,
        }
    };
    gaps.iter().zip(phases).map(sample).collect()
}

/// Returns the impacts `hits` of an event, and the ends of contact between the instants just before and just after it.
pub(super) fn touches(
    view: &SystemView,
    hits: &[Hit],
    before: &Instant,
    after: &Instant,
) -> Vec<Touch> {
    let pairs = gap_samples(view, before).into_iter().zip(gap_samples(view, after));
    let touch = |(gap, (before, of_after)): (usize, (GapSample, GapSample))| {
        let of_before = match hits.iter().find(|hit| hit.gap == gap) {
            Some(Hit { opening_speed, .. }) => {
                GapSample { opening_speed: *opening_speed, phase: Phase::Open, ..of_after }
            }
            None if before.phase == Phase::Closed && of_after.phase == Phase::Open => before,
            None => return None,
        };
        let positions = of_after.contacts.map(|contact| after.unwrapped[contact]);
        Some(Touch { time: after.time, positions, before: of_before, after: of_after })
    };
    pairs.enumerate().filter_map(touch).collect()
}
