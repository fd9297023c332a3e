//! One step of all lanes of a group: tried, judged, and taken where it stands.

use std::f64::consts::TAU;

use fearless_simd::{Simd, mask64x8, prelude::*};

use super::conditions::{InLanes, conditions, suspicious};
use super::displacement::over_switch;
use super::group::{Group, Room};
use super::lane::{Trouble, next_phases};
use super::locate::{Verdict, judge};
use super::step::{attempt, carry};
use super::{LANES, Lanes};
use crate::motion::Failure;
use crate::motion::contact::check_forces;
use crate::motion::driver::SHORTEST;

/// No component of the rate of change is larger where everything is slow.
const STILL: f64 = 1e-6;
/// The square of the size beyond which a displacement is to be made small again.
const LARGE: f64 = 1e200;

/// What has happened in a step, as bit masks of lanes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Happened {
    /// The lane's step has been taken.
    pub(crate) taken: u64,
    /// A ball changed what it does, or came to rest.
    pub(crate) event: u64,
    /// A ball has gone through the angle 0.
    pub(crate) round: u64,
    /// The time has come that was asked for, or the end.
    pub(crate) attention: u64,
    /// All balls stick, so near to rest that they may do so for ever.
    pub(crate) rest: u64,
    /// Without dry friction: everything is slow.
    pub(crate) still: u64,
    /// Without dry friction: a ball has turned back, which no condition tells.
    pub(crate) turned: u64,
    /// A lane that cannot go on.
    pub(crate) trouble: [Option<Trouble>; LANES],
}

impl Happened {
    /// Lanes of which anything is to be told.
    pub(crate) fn any(&self) -> u64 {
        let troubles = self.trouble.iter().enumerate();
        let troubles = troubles.filter(|(_, trouble)| trouble.is_some());
        let bits = troubles.fold(0, |bits, (lane, _)| bits | 1 << lane);
        let happened = self.event | self.round | self.turned;
        happened | self.attention | self.rest | self.still | bits
    }
}

/// Takes a step in all lanes of a group. Where `displaced`, a displacement of each is carried along.
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
    let left = g.until - g.time;
    let length = g.next.min(g.longest).min(g.trial).min(left);
    attempt(
        g.tolerance,
        &g.equations,
        (&g.state, &g.rate),
        length,
        &mut room.stages,
        if displaced { Some(&mut room.linearised) } else { None },
        &mut room.tried,
    );
    room.length = length;
    let tried = &room.tried;
    let found = conditions(&g.equations, &g.watched, (&tried.end, &tried.rate, &tried.forces));
    let good = tried.error_squared.simd_le(c!(1.0)).to_bitmask() & g.alive;
    let suspects = suspicious(length, &g.conditions, &found).to_bitmask();
    let mut happened = Happened::default();
    let mut commit = good;
    let mut failed = [(0, 0); LANES];
    let mut looks = (suspects | g.searching) & good;
    while looks != 0 {
        let lane = looks.trailing_zeros() as usize;
        looks &= looks - 1;
        match look(g, &found, lane, length[lane]) {
            Looked::Stands => {}
            Looked::Event(condition) => {
                failed[lane] = condition;
                happened.event |= 1 << lane;
            }
            Looked::Again => commit &= !(1 << lane),
            Looked::GiveUp => {
                commit &= !(1 << lane);
                happened.trouble[lane] = Some(Trouble::GiveUp);
            }
        }
    }
    g.tried += c!(1.0);
    let mut rejected = g.alive & !good;
    while rejected != 0 {
        let lane = rejected.trailing_zeros() as usize;
        rejected &= rejected - 1;
        reject(g, lane, length[lane], room.tried.error_squared[lane], &mut happened);
    }
    happened.taken = commit;
    if commit == 0 {
        return happened;
    }

    // Error control of DOP853: order 8, safety 0.9, change between 1/3 and 6.
    let tried = &room.tried;
    let root = tried.error_squared.sqrt().sqrt().sqrt().sqrt();
    let change = (c!(0.9) / root).min(c!(6.0)).max(c!(0.333));
    let suggestion = length * change;
    let commits = mask64x8::from_bitmask(simd, commit);
    let shortened = length.simd_le(suggestion) & length.simd_lt(g.next);
    let next = shortened.select(g.next, suggestion);
    g.next = commits.select(next, g.next);
    g.trial = commits.select(c!(f64::INFINITY), g.trial);
    g.before = g.state;
    g.time_before = g.time;
    let time = left.simd_le(length).select(g.until, g.time + length);
    g.time = commits.select(time, g.time);
    for i in 0..4 {
        g.state.table[i] = commits.select(tried.end.table[i], g.state.table[i]);
        g.rate.table[i] = commits.select(tried.rate.table[i], g.rate.table[i]);
    }
    let mut round = g.time.simd_lt(g.time);
    for i in 0..N {
        let angle = tried.end.angle[i];
        let beyond = (angle.simd_lt(c!(0.0)) | angle.simd_ge(c!(TAU))) & commits;
        let turns = beyond.select((angle / c!(TAU)).floor(), c!(0.0));
        let within = turns.mul_add_precise(c!(-TAU), angle);
        g.turns[i] += turns;
        round |= beyond;
        g.state.angle[i] = commits.select(within, g.state.angle[i]);
        g.state.speed[i] = commits.select(tried.end.speed[i], g.state.speed[i]);
        g.rate.angle[i] = commits.select(tried.rate.angle[i], g.rate.angle[i]);
        g.rate.speed[i] = commits.select(tried.rate.speed[i], g.rate.speed[i]);
        let fast = g.state.speed[i].abs().simd_gt(g.slow) & commits;
        g.slow_since[i] = fast.select(g.time, g.slow_since[i]);
        for which in 0..3 {
            g.conditions.values[i][which] =
                commits.select(found.values[i][which], g.conditions.values[i][which]);
            g.conditions.slopes[i][which] =
                commits.select(found.slopes[i][which], g.conditions.slopes[i][which]);
        }
    }
    happened.round = round.to_bitmask();
    if displaced {
        let moved = carry(&g.equations, &g.displacement, length, &room.linearised, &mut room.rates);
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
    // At rest for good?
    let u_x = g.state.table[0] - g.rest[0];
    let u_y = g.state.table[1] - g.rest[1];
    let v_x = g.state.table[2] - g.equations.speed * u_y;
    let v_y = g.state.table[3] + g.equations.speed * u_x;
    let distance = u_x * u_x + u_y * u_y + (v_x * v_x + v_y * v_y);
    happened.rest = distance.simd_le(g.rest_radius_squared).to_bitmask() & commit;
    let due = g.time.simd_ge(g.attention) | g.time.simd_ge(g.until);
    happened.attention |= due.to_bitmask() & commit;
    if g.sliding != 0 {
        let mut most = g.rate.table[0].abs();
        for i in 1..4 {
            most = most.max(g.rate.table[i].abs());
        }
        for i in 0..N {
            most = most.max(g.rate.angle[i].abs()).max(g.rate.speed[i].abs());
        }
        happened.still = most.simd_le(c!(STILL)).to_bitmask() & commit & g.sliding;
        let mut turned = g.time.simd_lt(g.time);
        for i in 0..N {
            turned |= (g.before.speed[i] * g.state.speed[i]).simd_le(c!(0.0));
        }
        happened.turned = turned.to_bitmask() & commit & g.sliding;
    }
    let mut overdone = g.tried.simd_ge(g.most).to_bitmask() & g.alive;
    while overdone != 0 {
        let lane = overdone.trailing_zeros() as usize;
        overdone &= overdone - 1;
        happened.trouble[lane].get_or_insert(Trouble::Failure(Failure::StepLimit));
    }
    happened
}

/// What a look at a step has shown.
enum Looked {
    Stands,
    Event((usize, usize)),
    Again,
    GiveUp,
}

#[inline(never)]
fn look<S: Simd, const N: usize>(
    g: &mut Group<S, N>,
    found: &InLanes<S, N>,
    lane: usize,
    length: f64,
) -> Looked {
    let (start, end) = (g.conditions.lane(lane), found.lane(lane));
    let Some(own) = &mut g.lanes[lane] else { return Looked::Stands };
    let verdict = judge(own.search.as_ref(), own.width, &start, length, &end);
    own.search = None;
    g.searching &= !(1 << lane);
    match verdict {
        Verdict::Commit => Looked::Stands,
        Verdict::Event(ball, which) => Looked::Event((ball, which)),
        Verdict::Retry(trial, search) => {
            own.not_taken += 1;
            own.search = Some(search);
            g.searching |= 1 << lane;
            g.trial[lane] = trial;
            Looked::Again
        }
        Verdict::GiveUp => Looked::GiveUp,
    }
}

/// A step whose error is too large: the next one is shorter.
#[inline(never)]
fn reject<S: Simd, const N: usize>(
    g: &mut Group<S, N>,
    lane: usize,
    length: f64,
    error_squared: f64,
    happened: &mut Happened,
) {
    let Some(own) = &mut g.lanes[lane] else { return };
    own.not_taken += 1;
    own.search = None;
    g.searching &= !(1 << lane);
    g.trial[lane] = f64::INFINITY;
    let finite = error_squared.is_finite();
    let change = 0.9 / error_squared.sqrt().sqrt().sqrt().sqrt();
    let next = if finite { length * change.clamp(0.333, 1.0) } else { 0.1 * length };
    g.next[lane] = next;
    if next < SHORTEST * g.time[lane].max(1.0) {
        let failure = if finite { Failure::StepLimit } else { Failure::NotFinite };
        happened.trouble[lane] = Some(Trouble::Failure(failure));
    } else if g.tried[lane] >= g.most[lane] {
        happened.trouble[lane] = Some(Trouble::Failure(Failure::StepLimit));
    }
}

/// Decides what comes after an event.
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
    let mut phases = before;
    let forces = next_phases(own, &mut state, &mut phases)?;
    check_forces(&forces)?;
    for ball in 0..N {
        if phases[ball] != before[ball] {
            own.switches += 1;
            own.last_switches[ball] = time;
        }
    }
    g.enter(lane, &state, &phases, &forces);
    if displaced && let Some(own) = &mut g.lanes[lane] {
        let rate = g.rate.lane(lane);
        let failed = (&before, (ball, which));
        over_switch(&mut g.displacement, lane, own, failed, (&state, &rate));
    }
    Ok(())
}
