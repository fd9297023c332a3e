//! One step of all lanes of a group: to the limit of the series or to the first event, with the
//! decision after it.

use std::f64::consts::TAU;

use fearless_simd::{Simd, mask64x8, prelude::*};

use super::event_functions::look_over;
use super::event_location::{Ends, first_event};
use super::group::{Group, Room};
use super::lane::Trouble;
use super::mode_selection::{InPlace, next_phases};
use super::series::Series;
use super::step::within_tolerance;
use super::tangent::{carry, over_switch};
use super::{LANES, Lanes};
use crate::motion::Failure;
use crate::motion::contact::{SmoothPhase, check_forces};
use crate::motion::driver::SHORTEST;
use crate::motion::guard::Guard;
use crate::motion::settings::MOST_AT_ONCE;

/// Bound on every component of the rate of change if everything is slow.
const STILL: f64 = 1e-6;
/// Square of the size above which a displacement must be rescaled.
const LARGE: f64 = 1e200;

/// The events of a step, as bit masks of lanes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Happened {
    /// The lane's step has been taken.
    pub(crate) taken: u64,
    /// A ball changed its phase, or came to rest.
    pub(crate) event: u64,
    /// A ball passed through the angle 0.
    pub(crate) round: u64,
    /// The requested time or the end time was reached.
    pub(crate) attention: u64,
    /// All balls stick and are so near to rest that they may stick permanently.
    pub(crate) rest: u64,
    /// Without dry friction: everything is slow.
    pub(crate) still: u64,
    /// Without dry friction: a ball has turned back, which no condition detects.
    pub(crate) turned: u64,
    /// The lanes for which events, completed turns and reversals are reported.
    pub(crate) told: u64,
    /// Lanes that cannot continue.
    pub(crate) trouble: [Option<Trouble>; LANES],
}

impl Happened {
    /// Returns the lanes with anything to report.
    pub(crate) fn any(&self) -> u64 {
        let troubles = self.trouble.iter().enumerate();
        let troubles = troubles.filter(|(_, trouble)| trouble.is_some());
        let bits = troubles.fold(0, |bits, (lane, _)| bits | 1 << lane);
        let happened = (self.event | self.round | self.turned) & self.told;
        happened | self.attention | self.rest | self.still | bits
    }
}

/// Takes a step in all lanes of a group. If `displaced`, a displacement of each lane is propagated.
pub(crate) fn advance<S: Simd, const N: usize>(
    simd: S,
    group: &mut Group<S, N>,
    room: &mut Room<S, N>,
    displaced: bool,
) -> Happened {
    simd.vectorize(
        #[inline(always)]
        || step(simd, group, room, displaced),
    )
}

#[inline(always)]
fn step<S: Simd, const N: usize>(
    simd: S,
    group: &mut Group<S, N>,
    room: &mut Room<S, N>,
    displaced: bool,
) -> Happened {
    macro_rules! c {
        ($value:expr) => {
            Lanes::splat(simd, $value)
        };
    }
    let g = group;
    let mut happened = Happened { told: g.told, ..Happened::default() };
    room.series.expand(&g.equations, &g.state);
    let series = &room.series;
    let doubts = &mut room.doubts;
    let within = within_tolerance(series, g.tolerance, g.next).min(g.longest);
    let left = g.until - g.time;
    let mut length = within.min(left);
    look_over(series, &g.equations, &g.watched, length, doubts);
    let mut failed = [(0, 0); LANES];
    let mut looks = doubts.any() & g.alive;
    while looks != 0 {
        let lane = looks.trailing_zeros() as usize;
        looks &= looks - 1;
        let Some(own) = &g.lanes[lane] else { continue };
        match first_event(series, own, lane, length[lane], doubts) {
            Ends::Nothing => {}
            Ends::At(part, condition) => {
                length[lane] *= part;
                failed[lane] = condition;
                happened.event |= 1 << lane;
            }
            Ends::AtOnce => happened.trouble[lane] = Some(Trouble::Fallback),
        }
    }
    let end = series.at(&g.equations, &g.state, length);
    // Zero, unless a component is infinite or NaN.
    let mut nought = within * c!(0.0);
    for value in end.table.iter().chain(&end.angle).chain(&end.speed) {
        nought = value.mul_add_precise(c!(0.0), nought);
    }
    let finite = nought.simd_eq(c!(0.0));
    let moves = within.simd_ge(g.time.max(c!(1.0)) * c!(SHORTEST));
    let commits = finite & moves;
    let mut stopped = g.alive & !commits.to_bitmask();
    while stopped != 0 {
        let lane = stopped.trailing_zeros() as usize;
        stopped &= stopped - 1;
        let lasts = finite.to_bitmask() & 1 << lane != 0;
        let failure = if lasts { Failure::StepLimit } else { Failure::NotFinite };
        happened.trouble[lane] = Some(Trouble::Failure(failure));
        happened.event &= !(1 << lane);
    }
    let given_up = happened.trouble.iter().enumerate();
    let given_up = given_up.filter(|(_, trouble)| trouble.is_some());
    let commit = given_up.fold(g.alive, |commit, (lane, _)| commit & !(1 << lane));
    let commits = mask64x8::from_bitmask(simd, commit);
    happened.taken = commit;
    g.taken += c!(1.0);
    if g.sliding != 0 {
        still(g, series, &mut happened);
    }

    g.next = commits.select(within, g.next);
    g.before = g.state;
    g.time_before = g.time;
    let time = left.simd_le(length).select(g.until, g.time + length);
    g.time = commits.select(time, g.time);
    for i in 0..4 {
        g.state.table[i] = commits.select(end.table[i], g.state.table[i]);
    }
    let mut round = g.time.simd_lt(g.time);
    for i in 0..N {
        let angle = end.angle[i];
        let beyond = (angle.simd_lt(c!(0.0)) | angle.simd_ge(c!(TAU))) & commits;
        let turns = beyond.select((angle / c!(TAU)).floor(), c!(0.0));
        let within = turns.mul_add_precise(c!(-TAU), angle);
        g.turns[i] += turns;
        round |= beyond;
        g.state.angle[i] = commits.select(within, g.state.angle[i]);
        g.state.speed[i] = commits.select(end.speed[i], g.state.speed[i]);
        let fast = g.state.speed[i].abs().simd_gt(g.slow) & commits;
        g.slow_since[i] = fast.select(g.time, g.slow_since[i]);
    }
    room.end = end;
    room.length = length;
    happened.round = round.to_bitmask();
    if displaced {
        let moved = carry(series, &g.equations, &g.displacement, length, &mut room.displaced);
        let mut size = c!(0.0);
        for i in 0..4 {
            g.displacement.table[i] = commits.select(moved.table[i], g.displacement.table[i]);
            size = g.displacement.table[i].mul_add_precise(g.displacement.table[i], size);
        }
        for i in 0..N {
            g.displacement.angle[i] = commits.select(moved.angle[i], g.displacement.angle[i]);
            g.displacement.speed[i] = commits.select(moved.speed[i], g.displacement.speed[i]);
            size = g.displacement.angle[i].mul_add_precise(g.displacement.angle[i], size);
            size = g.displacement.speed[i].mul_add_precise(g.displacement.speed[i], size);
        }
        let extreme = size.simd_gt(c!(LARGE)) | size.simd_lt(c!(1.0 / LARGE));
        happened.attention |= extreme.to_bitmask() & commit;
    }
    let mut events = happened.event;
    while events != 0 {
        let lane = events.trailing_zeros() as usize;
        events &= events - 1;
        if let Err(trouble) = switch(g, lane, failed[lane], displaced) {
            happened.trouble[lane] = Some(trouble);
        }
    }
    // Detects lanes that may rest permanently.
    let u_x = g.state.table[0] - g.rest[0];
    let u_y = g.state.table[1] - g.rest[1];
    let v_x = g.state.table[2] - g.equations.speed * u_y;
    let v_y = g.state.table[3] + g.equations.speed * u_x;
    let distance = u_x * u_x + u_y * u_y + (v_x * v_x + v_y * v_y);
    happened.rest = distance.simd_le(g.rest_radius_squared).to_bitmask() & commit;
    let due = g.time.simd_ge(g.attention) | g.time.simd_ge(g.until);
    happened.attention |= due.to_bitmask() & commit;
    if g.sliding != 0 {
        let mut turned = g.time.simd_lt(g.time);
        for i in 0..N {
            turned |= (g.before.speed[i] * g.state.speed[i]).simd_le(c!(0.0));
        }
        happened.turned = turned.to_bitmask() & commit & g.sliding;
    }
    let sound = g.most_per_time.mul_add_precise(g.time, c!(MOST_AT_ONCE as f64));
    let mut overdone = g.taken.simd_ge(sound.min(g.most)).to_bitmask() & g.alive;
    while overdone != 0 {
        let lane = overdone.trailing_zeros() as usize;
        overdone &= overdone - 1;
        happened.trouble[lane].get_or_insert(Trouble::Failure(Failure::StepLimit));
    }
    happened
}

/// Reports lanes without dry friction in which everything is slow at the step's start.
#[inline(always)]
fn still<S: Simd, const N: usize>(g: &Group<S, N>, series: &Series<S, N>, happened: &mut Happened) {
    let [first, second, third, ..] = &series.terms;
    let two = Lanes::splat(g.time.simd, 2.0);
    let mut most = Lanes::splat(g.time.simd, 0.0);
    for axis in 0..2 {
        most = most.max(second.table[axis].abs()).max((two * third.table[axis]).abs());
    }
    for i in 0..N {
        most = most.max(first.balls[i].speed.abs()).max(second.balls[i].speed.abs());
    }
    let slow = most.simd_le(Lanes::splat(g.time.simd, STILL));
    happened.still = slow.to_bitmask() & happened.taken & g.sliding;
}

/// Decides the phases after an event.
#[inline(never)]
fn switch<S: Simd, const N: usize>(
    g: &mut Group<S, N>,
    lane: usize,
    (ball, which): (usize, usize),
    displaced: bool,
) -> Result<(), Trouble> {
    let time = g.time[lane];
    let mut state = g.state.lane(lane);
    let Some(own) = &mut g.lanes[lane] else { return Ok(()) };
    let before = own.phases;
    own.during = before;
    if which == 2 {
        return Err(Failure::ContactLost { ball: ball + 1 }.into());
    }
    let system = InPlace::new(own, &state);
    let mut phases = before;
    let forces = next_phases(own, &system, &mut state, &mut phases)?;
    check_forces(&forces)?;
    let mut grazed = false;
    if displaced {
        let rate = SmoothPhase::new(&system, &phases).derivative_with(&state, &forces);
        let phase = SmoothPhase::new(&system, &before);
        let guard = Guard::of(ball, before[ball], which);
        let failed = (&phase, guard);
        grazed =
            over_switch(&mut g.displacement, lane, (&system, own.margins), failed, (&state, &rate));
    }
    own.grazed |= grazed;
    for ball in 0..N {
        if phases[ball] != before[ball] {
            own.switches += 1;
            own.last_switches[ball] = time;
        }
    }
    g.enter(lane, &state, &phases);
    Ok(())
}
