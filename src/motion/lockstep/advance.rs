//! One step of all lanes of a group: to the limit of the series or to the first event, with the
//! decision after it and a report of what happened.

use std::f64::consts::TAU;

use fearless_simd::mask64x8;
use fearless_simd::prelude::*;

use super::events::{first_event, switch};
use super::kernel::Kernel;
use super::kernel_lanes::{KernelLanes, propagate};
use super::{LANES, Lanes};
use crate::motion::Failure;
use crate::motion::lockstep::vector::{Fused, Vector, vectorized};
use crate::motion::settings::MOST_AT_ONCE;

/// The events of a step, as bit masks of lanes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StepReport {
    /// The lane's step has been taken.
    pub(crate) taken: u64,
    /// A contact changed its phase, or came to rest.
    pub(crate) event: u64,
    /// An angle passed through 0.
    pub(crate) round: u64,
    /// The requested time or the end time was reached, or the perturbation must be rescaled.
    pub(crate) attention: u64,
    /// The amplitude may have been larger than the watched one.
    pub(crate) larger: u64,
    /// All contacts stick, perhaps for good.
    pub(crate) rest: u64,
    /// Everything is slow while a contact slides.
    pub(crate) still: u64,
    /// Without dry friction: a contact has turned back, which no condition detects.
    pub(crate) turned: u64,
    /// The lanes for which events, completed turns and reversals are reported.
    pub(crate) reporting_lanes: u64,
    /// Lanes that cannot continue.
    pub(crate) failed: u64,
    failures: [Option<Failure>; LANES],
}

impl StepReport {
    /// Returns the lanes with anything to report.
    pub(crate) fn any(&self) -> u64 {
        let events = (self.event | self.round | self.turned) & self.reporting_lanes;
        events | self.attention | self.larger | self.rest | self.still | self.failed
    }

    /// Returns why a lane cannot continue.
    pub(crate) fn failure(&self, lane: usize) -> Option<Failure> {
        self.failures[lane]
    }

    /// Notes that a lane cannot continue.
    fn fail(&mut self, lane: usize, failure: Failure) {
        self.failed |= 1 << lane;
        self.failures[lane] = Some(failure);
    }
}

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
    let within = g.kernel.resolved(&g.workspace, within);
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
    report.still = g.kernel.still(&g.workspace, g.sliding) & commit;

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
        let moved = propagate(simd, &g.kernel, &mut g.workspace, &g.perturbation, length);
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
