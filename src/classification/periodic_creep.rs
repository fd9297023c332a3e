//! Creep under a periodic force: contacts that slip a little in every period and stop or turn back again.
//!
//! A ball that gravity pulls to and fro once in a turn of its disc slips a little further in one direction than in the other.
//! Its motion approaches a closed orbit or the edge of the set in which friction holds it, but may take thousands of periods.
//! A run creeps if, in its latest periods,
//!
//! - the state moves from period to period, by a small displacement that hardly changes from the first of them to the last: a
//!   vibration that still decays changes its displacement from each period to the next;
//! - a contact moves, and none slides in one direction all the time.

use nalgebra::DVector;

use super::closed_orbit::PassageState;
use super::output_watch::OutputOutcome;
use super::return_map::ReturnMap;

/// The number of periods in which the displacement must stay the same.
pub(super) const PERIODS: usize = 16;
/// Least and largest displacement in a period, non-dimensional. Less is rounding.
const LEAST: f64 = 1e-9;
const SLIGHT: f64 = 1e-2;
/// Largest change of the displacement, over the displacement.
const STEADY: f64 = 0.1;
/// Least displacement of a contact that creeps, over the largest displacement of a component.
const CREEPS: f64 = 1e-3;
/// A contact that is displaced by more than this, over the same, rolls on and on.
const GOES_ON: f64 = 2.0;

/// The latest period of a run that creeps.
pub(super) struct Creep {
    /// Its length, non-dimensional.
    pub(super) period: f64,
    /// Mean speed of each contact, non-dimensional.
    pub(super) speed: Vec<f64>,
    /// The outputs over the period.
    pub(super) outputs: Vec<OutputOutcome>,
}

/// Returns how a run creeps that has passed these states at the begins of its latest periods, the latest one first; `None` if it
/// does not creep. `map` goes through one period.
pub(super) fn creep(map: ReturnMap, passed: &[PassageState]) -> Option<Creep> {
    let ReturnMap { section, view, .. } = map;
    if passed.len() <= PERIODS {
        return None;
    }
    let moved: Vec<DVector<f64>> =
        passed.windows(2).map(|two| section.difference(two[0].1, two[1].1)).collect();
    let latest = moved.first()?;
    let size = latest.amax();
    let is_steady = moved.iter().all(|step| (step - latest).amax() <= STEADY * size);
    if !(LEAST..=SLIGHT).contains(&size) || !is_steady {
        return None;
    }
    let start = passed.first()?.1;
    let (end, period) = map.follow_closely(start)?;
    let slides = |contact: usize| {
        let [low, high] = period.speeds[contact];
        let one_way = low > 0.0 || high < 0.0;
        one_way && period.stuck[contact] == 0.0 && !period.is_idle(contact)
    };
    let contacts = || view.contacts.iter().enumerate();
    let change = |position: usize| end.state[position] - start[position];
    let moves =
        |least: f64| contacts().any(|(_, contact)| change(contact.position).abs() >= least * size);
    if !moves(CREEPS) || moves(GOES_ON) || contacts().any(|(contact, _)| slides(contact)) {
        return None;
    }
    Some(Creep {
        period: end.time,
        speed: contacts().map(|(_, contact)| change(contact.position) / end.time).collect(),
        outputs: period.outputs.displaced(),
    })
}
