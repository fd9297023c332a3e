//! Many runs in lockstep: every lane has its own case, time, step and phases, and takes the next
//! case when its run has ended.
//!
//! What a lane computes depends on its own values only: no operation mixes lanes, all of them are
//! correctly rounded on every machine, and what is rare (events, endings) is done lane by lane in
//! plain `f64`. So a run's result is the same to the last bit in any lane, beside any neighbours,
//! in vectors of any width.

use std::f64::consts::TAU;

use fearless_simd::{Level, Simd, f64x8, mask64x8, prelude::*};
use stickslip::ending::certified_by_closed_form;
use stickslip::model::{Balancer, Method, RestPoint, State};
use stickslip::motion::{Motion, Phase as Doing, Settings};

use crate::equations::{Ball, Contact, N, Phase, Vector};
use crate::inertial;
use crate::locate::{Conditions, Search, Verdict, judge};
use crate::modal::{self, Modes};
use crate::step::{INNER, Tolerance, Tried, attempt};

pub const LANES: usize = 8;

/// What is to be computed.
#[derive(Clone, Debug)]
pub struct Task {
    pub balancer: Balancer<2>,
    pub start: State<2>,
    pub end_time: f64,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ending {
    Rest,
    EndTime,
    /// Something that is left to the scalar code.
    GivenUp,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Done {
    pub ending: Ending,
    pub time: f64,
    pub state: [f64; N],
    /// Steps tried, for whatever reason.
    pub steps: f64,
    pub rejected: u32,
    pub trials: u32,
    pub events: u32,
    pub looks: u32,
    /// Steps tried with both, one, no ball sticking.
    pub all_stick_steps: u32,
}

#[derive(Clone, Copy, Debug, Default)]
pub struct Totals {
    /// Steps of vectors, and of lanes with a case in them.
    pub vector_steps: u64,
    pub lane_steps: u64,
}

/// Eight lanes.
struct Group<S: Simd> {
    state: Vector<S>,
    derivative: Vector<S>,
    time: f64x8<S>,
    end_time: f64x8<S>,
    longest: f64x8<S>,
    longest_sticking: f64x8<S>,
    next: f64x8<S>,
    trial: f64x8<S>,
    phase: Phase<S>,
    modes: Modes<S>,
    limit: [f64x8<S>; 2],
    /// 1 where a ball sticks, else 0.
    stuck: [f64x8<S>; 2],
    direction: [f64x8<S>; 2],
    values: [f64x8<S>; 4],
    slopes: [f64x8<S>; 4],
    rest: [f64x8<S>; 2],
    rest_radius_squared: f64x8<S>,
    steps: f64x8<S>,
    search: [Option<Search>; LANES],
    task: [Option<usize>; LANES],
    count: [[u32; 5]; LANES],
}

const SLACK: f64 = 1e-13;
const STEP_LIMIT: f64 = 200_000.0;

impl<S: Simd> Group<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        macro_rules! c {
            ($value:expr) => {
                f64x8::splat(simd, $value)
            };
        }
        let ball = Ball {
            mass: c!(0.0),
            mobility: c!(0.0),
            mobile_mass: c!(0.0),
            friction: c!(0.0),
            rolling_linear: c!(0.0),
            rolling_quadratic: c!(0.0),
        };
        Group {
            state: [c!(0.0); N],
            derivative: [c!(0.0); N],
            time: c!(0.0),
            end_time: c!(1.0),
            longest: c!(0.0),
            longest_sticking: c!(0.0),
            next: c!(0.0),
            trial: c!(0.0),
            phase: Phase {
                omega: c!(0.0),
                two_omega: c!(0.0),
                omega_squared: c!(0.0),
                drag: c!(0.0),
                drag_omega: c!(0.0),
                imbalance: c!(0.0),
                balls: [ball; 2],
            },
            modes: Modes::blank(simd),
            limit: [c!(0.0); 2],
            stuck: [c!(0.0); 2],
            direction: [c!(1.0); 2],
            values: [c!(1.0); 4],
            slopes: [c!(0.0); 4],
            rest: [c!(0.0); 2],
            rest_radius_squared: c!(-1.0),
            steps: c!(0.0),
            search: [None; LANES],
            task: [None; LANES],
            count: [[0; 5]; LANES],
        }
    }

    fn load(&mut self, lane: usize, number: usize, task: &Task, settings: Settings) -> bool {
        let b = &task.balancer;
        let p = &mut self.phase;
        p.omega[lane] = b.speed;
        p.two_omega[lane] = 2.0 * b.speed;
        p.omega_squared[lane] = b.speed * b.speed;
        p.drag[lane] = 2.0 * b.damping_ratio;
        p.drag_omega[lane] = 2.0 * b.damping_ratio * b.speed;
        p.imbalance[lane] = b.imbalance * b.speed * b.speed;
        self.modes.set(lane, b.speed, b.damping_ratio, b.imbalance);
        for (i, ball) in b.balls.iter().enumerate() {
            p.balls[i].mass[lane] = ball.mass;
            p.balls[i].rolling_linear[lane] = -ball.rolling_linear;
            p.balls[i].rolling_quadratic[lane] = -ball.rolling_quadratic;
            self.limit[i][lane] = ball.friction.limit;
        }
        self.time[lane] = 0.0;
        self.end_time[lane] = task.end_time;
        let unit = 0.5 * std::f64::consts::PI / (b.speed.abs() + 1.0);
        let longest = KNOBS.get()[1] * unit;
        self.longest[lane] = longest;
        self.longest_sticking[lane] = KNOBS.get()[2] * unit;
        self.next[lane] = 0.1 * longest;
        self.steps[lane] = 0.0;
        self.task[lane] = Some(number);
        self.count[lane] = [0; 5];
        self.begin_phase(lane, task, settings, task.start)
    }

    /// Begins a phase from a state in which what balls at rest do is to be decided.
    fn begin_phase(
        &mut self,
        lane: usize,
        task: &Task,
        settings: Settings,
        state: State<2>,
    ) -> bool {
        self.trial[lane] = f64::INFINITY;
        self.search[lane] = None;
        let b = &task.balancer;
        let Ok(motion) = Motion::new(b, settings, state) else { return false };
        let [s, d] = [motion.state(), motion.derivative()].map(flat);
        for i in 0..N {
            self.state[i][lane] = s[i];
            self.derivative[i][lane] = d[i];
        }
        for (i, doing) in motion.phases().iter().enumerate() {
            let (direction, free) = match doing {
                Doing::Stick => (1.0, 0.0),
                Doing::Slip(direction) => (*direction, 1.0),
                _ => return false,
            };
            let ball = &b.balls[i];
            self.direction[i][lane] = direction;
            self.stuck[i][lane] = 1.0 - free;
            let to = &mut self.phase.balls[i];
            to.mobility[lane] = ball.mobility * free;
            to.mobile_mass[lane] = ball.mass * (ball.mobility * free);
            to.friction[lane] = free * (direction * ball.friction.coefficient);
        }
        let forces = motion.forces();
        for i in 0..2 {
            let (n, f) = (forces.normal[i], forces.friction[i]);
            if n < 0.25 * b.speed * b.speed {
                return false;
            }
            let (s, c) = libm::sincos(s[4 + i]);
            let [j_x, j_y] = jerk(b, &flat(motion.state()), &d);
            let (value, slope, other, other_slope) = if self.stuck[i][lane] > 0.0 {
                let limit = b.balls[i].friction.limit;
                let (n_dot, f_dot) = (-(c * j_x + s * j_y), s * j_x - c * j_y);
                let reserve = limit * n + SLACK;
                (reserve - f, limit * n_dot - f_dot, reserve + f, limit * n_dot + f_dot)
            } else {
                let direction = self.direction[i][lane];
                (direction * motion.state().beta_dot[i], direction * d[6 + i], 1.0, 0.0)
            };
            self.values[2 * i][lane] = value;
            self.slopes[2 * i][lane] = slope;
            self.values[2 * i + 1][lane] = other;
            self.slopes[2 * i + 1][lane] = other_slope;
        }
        self.rest_radius_squared[lane] = -1.0;
        if motion.all_stick() {
            let rest = b.rest_point(&motion.state().beta);
            self.rest[0][lane] = rest.position[0];
            self.rest[1][lane] = rest.position[1];
            self.rest_radius_squared[lane] = rest_radius_squared(b, &rest);
        }
        true
    }

    fn lane_state(&self, lane: usize) -> [f64; N] {
        std::array::from_fn(|i| self.state[i][lane])
    }
}

/// The square of the distance from rest below which no ball can break loose; negative where none.
fn rest_radius_squared(b: &Balancer<2>, rest: &RestPoint<2>) -> f64 {
    let mut least = f64::INFINITY;
    for i in 0..2 {
        let limit = b.balls[i].friction.limit;
        least = least.min((limit * rest.normal[i] - rest.friction[i].abs()) / (1.0 + limit));
    }
    if least < 0.0 { -1.0 } else { least * least / (1.0 + 4.0 * b.damping_ratio * b.damping_ratio) }
}

fn flat(s: &State<2>) -> [f64; N] {
    let ([x, y], [u, v]) = (s.position, s.velocity);
    [x, y, u, v, s.beta[0], s.beta[1], s.beta_dot[0], s.beta_dot[1]]
}

pub fn unflat(s: &[f64; N]) -> State<2> {
    State {
        position: [s[0], s[1]],
        velocity: [s[2], s[3]],
        beta: [s[4], s[5]],
        beta_dot: [s[6], s[7]],
    }
}

/// The rate of change of the table's absolute acceleration, but for that of the balls'
/// accelerations (their share is small; it is used to look for dips and as a first guess).
fn jerk(b: &Balancer<2>, s: &[f64; N], d: &[f64; N]) -> [f64; 2] {
    let drag = 2.0 * b.damping_ratio;
    let mut x = -s[2] - drag * (d[2] - b.speed * s[3]);
    let mut y = -s[3] - drag * (d[3] + b.speed * s[2]);
    for i in 0..2 {
        let (sine, cosine) = libm::sincos(s[4 + i]);
        let (rate, acceleration) = (s[6 + i], d[6 + i]);
        let w = b.speed + rate;
        let along = b.balls[i].mass * (acceleration * (rate + 2.0 * w));
        let across = b.balls[i].mass * (rate * w * w);
        x += cosine * along - sine * across;
        y += sine * along + cosine * across;
    }
    [x, y]
}

/// Values and slopes of the conditions at the end of a step.
#[inline(always)]
fn conditions<S: Simd>(
    group: &Group<S>,
    tried: &Tried<S>,
) -> ([f64x8<S>; 4], [f64x8<S>; 4], mask64x8<S>) {
    let (s, d, p) = (&tried.end, &tried.derivative, &group.phase);
    let zero = f64x8::splat(s[0].simd, 0.0);
    let one = f64x8::splat(s[0].simd, 1.0);
    let two = f64x8::splat(s[0].simd, 2.0);
    let slack = f64x8::splat(s[0].simd, SLACK);
    let mut j_x = -s[2] - (p.drag * d[2] - p.drag_omega * s[3]);
    let mut j_y = -s[3] - (p.drag * d[3] + p.drag_omega * s[2]);
    for i in 0..2 {
        let Contact { sine, cosine, .. } = tried.contacts[i];
        let (rate, acceleration) = (s[6 + i], d[6 + i]);
        let w = p.omega + rate;
        let along = p.balls[i].mass * (acceleration * w.mul_add_precise(two, rate));
        let across = p.balls[i].mass * (rate * (w * w));
        j_x = j_x + (cosine * along - sine * across);
        j_y = j_y + (sine * along + cosine * across);
    }
    let mut values = [one; 4];
    let mut slopes = [zero; 4];
    let quarter = p.omega_squared * f64x8::splat(s[0].simd, 0.25);
    let mut lost = quarter.simd_lt(zero);
    for i in 0..2 {
        let Contact { sine, cosine, normal, tangential } = tried.contacts[i];
        let stuck = group.stuck[i].simd_gt(zero);
        let n_dot = -(cosine * j_x + sine * j_y);
        let f_dot = sine * j_x - cosine * j_y;
        let limit = group.limit[i];
        let reserve = limit * normal + slack;
        let direction = group.direction[i];
        values[2 * i] = stuck.select(reserve - tangential, direction * s[6 + i]);
        slopes[2 * i] = stuck.select(limit * n_dot - f_dot, direction * d[6 + i]);
        values[2 * i + 1] = stuck.select(reserve + tangential, one);
        slopes[2 * i + 1] = stuck.select(limit * n_dot + f_dot, zero);
        lost = lost | normal.simd_lt(quarter);
    }
    (values, slopes, lost)
}

/// Whether a condition fails or may have dipped below zero in a step.
#[inline(always)]
fn suspicious<S: Simd>(
    lengths: f64x8<S>,
    start: (&[f64x8<S>; 4], &[f64x8<S>; 4]),
    end: (&[f64x8<S>; 4], &[f64x8<S>; 4]),
) -> mask64x8<S> {
    let zero = f64x8::splat(lengths.simd, 0.0);
    let half = f64x8::splat(lengths.simd, 0.5);
    let mut suspects = lengths.simd_lt(zero);
    for i in 0..4 {
        let least = start.0[i].min(end.0[i]);
        let changes = [start.1[i] * lengths, end.1[i] * lengths];
        let hump = changes[0].simd_ge(zero) & changes[1].simd_le(zero);
        let most = changes[0].abs().max(changes[1].abs());
        let near = least.simd_lt(half * most) & !hump;
        suspects = suspects | near | end.0[i].simd_lt(zero);
    }
    suspects
}

/// Whether the speed of a ball that slips may have dipped below zero between two places inside.
#[inline(always)]
fn suspicious_inside<S: Simd>(
    group: &Group<S>,
    tried: &Tried<S>,
    length: f64x8<S>,
    values: &[f64x8<S>; 4],
    slopes: &[f64x8<S>; 4],
) -> mask64x8<S> {
    let zero = f64x8::splat(length.simd, 0.0);
    let mut suspects = length.simd_lt(zero);
    macro_rules! piece {
        ($span:expr, $from:expr, $to:expr) => {{
            let half = f64x8::splat(length.simd, 0.5 * $span) * length;
            let ((a, p), (b, q)) = ($from, $to);
            let hump = p.simd_ge(zero) & q.simd_le(zero);
            let near = a.min(b).simd_lt(half * p.abs().max(q.abs())) & !hump;
            near | b.simd_lt(zero)
        }};
    }
    macro_rules! ball {
        ($($i:literal)*) => {$(
            let d = group.direction[$i];
            let t = &tried.inner;
            let start = (group.values[2 * $i], group.slopes[2 * $i]);
            let a = (d * t[0][$i], d * t[0][2 + $i]);
            let b = (d * t[1][$i], d * t[1][2 + $i]);
            let c = (d * t[2][$i], d * t[2][2 + $i]);
            let end = (values[2 * $i], slopes[2 * $i]);
            let found = piece!(INNER[0], start, a)
                | piece!(INNER[1] - INNER[0], a, b)
                | piece!(INNER[2] - INNER[1], b, c)
                | piece!(1.0 - INNER[2], c, end);
            suspects = suspects | (found & group.stuck[$i].simd_eq(zero));
        )*};
    }
    ball!(0 1);
    suspects
}

/// Computes all tasks, `8 M` at a time.
/// `COORDINATES`: 0 the turning frame, 1 modal (S), 2 modal without the balls' shaking (F),
/// 3 a frame at rest.
pub fn simulate<const M: usize, const COORDINATES: usize>(
    level: Level,
    tasks: &[Task],
    settings: Settings,
) -> (Vec<Option<Done>>, Totals) {
    assert!(settings.method == Method::Event);
    crate::at_level!(level, simd => run::<_, M, COORDINATES>(simd, tasks, settings))
}

#[inline(always)]
fn run<S: Simd, const M: usize, const COORDINATES: usize>(
    simd: S,
    tasks: &[Task],
    settings: Settings,
) -> (Vec<Option<Done>>, Totals) {
    let mut done: Vec<Option<Done>> = vec![None; tasks.len()];
    let mut upcoming = 0;
    let mut totals = Totals::default();
    let tolerance =
        Tolerance { relative: settings.tolerance.relative, absolute: settings.tolerance.absolute };
    let mut groups: [Group<S>; M] = std::array::from_fn(|_| Group::new(simd));
    for group in &mut groups {
        for lane in 0..LANES {
            refill(group, lane, tasks, settings, &mut upcoming, &mut done);
        }
    }
    let safety = KNOBS.get()[0];
    // Errors before this time count more (squared).
    let weights = [300.0, KNOBS.get()[3] * KNOBS.get()[3]];
    macro_rules! c {
        ($value:expr) => {
            f64x8::splat(simd, $value)
        };
    }
    let nothing = Contact { sine: c!(0.0), cosine: c!(0.0), normal: c!(0.0), tangential: c!(0.0) };
    let blank = Tried {
        end: [c!(0.0); N],
        derivative: [c!(0.0); N],
        contacts: [nothing; 2],
        error_squared: c!(0.0),
        inner: [[c!(0.0); 4]; 3],
    };
    let mut tried = blank;
    let mut stages = [[c!(0.0); N]; 12];
    let one = c!(1.0);
    while groups.iter().any(|group| group.task.iter().any(Option::is_some)) {
        totals.vector_steps += M as u64;
        for m in 0..M {
            let g = &mut groups[m];
            let sticking = (g.stuck[0] + g.stuck[1]).simd_gt(c!(0.0));
            let longest = sticking.select(g.longest.min(g.longest_sticking), g.longest);
            let length = g.next.min(longest).min(g.trial).min(g.end_time - g.time);
            match COORDINATES {
                0 => attempt(
                    tolerance,
                    &g.phase,
                    &g.state,
                    &g.derivative,
                    length,
                    &mut stages,
                    &mut tried,
                ),
                1 => modal::attempt::<S, false>(
                    tolerance,
                    &g.phase,
                    &g.modes,
                    &g.state,
                    &g.derivative,
                    length,
                    &mut stages,
                    &mut tried,
                ),
                3 => inertial::attempt(
                    tolerance,
                    &g.phase,
                    &g.state,
                    &g.derivative,
                    length,
                    &mut stages,
                    &mut tried,
                ),
                _ => modal::attempt::<S, true>(
                    tolerance,
                    &g.phase,
                    &g.modes,
                    &g.state,
                    &g.derivative,
                    length,
                    &mut stages,
                    &mut tried,
                ),
            }
            let (values, slopes, lost) = conditions(g, &tried);
            let alive = (0..LANES)
                .fold(0_u64, |bits, lane| bits | u64::from(g.task[lane].is_some()) << lane);
            let searching = (0..LANES)
                .fold(0_u64, |bits, lane| bits | u64::from(g.search[lane].is_some()) << lane);
            totals.lane_steps += u64::from(alive.count_ones());
            let early = g.time.simd_lt(c!(weights[0]));
            tried.error_squared = tried.error_squared * early.select(c!(weights[1]), one);
            let good = tried.error_squared.simd_le(one);
            let mut suspects = suspicious(length, (&g.values, &g.slopes), (&values, &slopes));
            if COORDINATES != 0 {
                suspects = suspects | suspicious_inside(g, &tried, length, &values, &slopes);
            }
            let good_bits = good.to_bitmask() & alive;
            let mut looks = (suspects.to_bitmask() | searching) & good_bits;
            let mut commit = good_bits & !looks;
            let mut give_up = lost.to_bitmask() & good_bits;
            let mut events = 0_u64;
            while looks != 0 {
                let lane = looks.trailing_zeros() as usize;
                looks &= looks - 1;
                g.count[lane][3] += 1;
                let at = |v: &[f64x8<S>; 4]| [v[0][lane], v[1][lane], v[2][lane], v[3][lane]];
                let start = Conditions { values: at(&g.values), slopes: at(&g.slopes) };
                let end = Conditions { values: at(&values), slopes: at(&slopes) };
                let inner = || {
                    let mut inner = [end; 3];
                    for (point, at) in inner.iter_mut().zip(&tried.inner) {
                        for i in 0..2 {
                            let stuck = g.stuck[i][lane] > 0.0;
                            // Of a ball that sticks nothing is known inside.
                            let d = if stuck { f64::NAN } else { g.direction[i][lane] };
                            point.values[2 * i] = d * at[i][lane];
                            point.slopes[2 * i] = d * at[2 + i][lane];
                            if stuck {
                                point.values[2 * i + 1] = f64::NAN;
                            }
                        }
                    }
                    inner
                };
                let verdict = judge(g.search[lane], &start, length[lane], &end, inner);
                match verdict {
                    Verdict::Commit => commit |= 1 << lane,
                    Verdict::Event => {
                        commit |= 1 << lane;
                        events |= 1 << lane;
                    }
                    Verdict::Retry(trial, search) => {
                        g.trial[lane] = trial;
                        g.search[lane] = Some(search);
                        g.count[lane][1] += 1;
                    }
                    Verdict::GiveUp => give_up |= 1 << lane,
                }
                if matches!(verdict, Verdict::Commit | Verdict::Event) {
                    g.trial[lane] = f64::INFINITY;
                    g.search[lane] = None;
                }
            }
            // Step control of DOP853: order 8, safety 0.9, change between 1/3 and 6.
            let e = tried.error_squared.max(c!(1e-100));
            let change = c!(safety) / e.sqrt().sqrt().sqrt().sqrt();
            let finite = e.simd_lt(c!(1e200));
            let grown = length * change.max(c!(0.333)).min(c!(6.0));
            let shrunk = length * finite.select(change.max(c!(0.333)).min(one), c!(0.1));
            let shortened = length.simd_le(grown) & length.simd_lt(g.next);
            let suggested = shortened.select(g.next, grown);
            let commits = mask64x8::from_bitmask(simd, commit);
            let rejected = alive & !good_bits;
            let rejects = mask64x8::from_bitmask(simd, rejected);
            g.next = commits.select(suggested, rejects.select(shrunk, g.next));
            let left = g.end_time - g.time;
            let time = left.simd_le(length).select(g.end_time, g.time + length);
            g.time = commits.select(time, g.time);
            g.steps = g.steps + one;
            for i in 0..N {
                g.state[i] = commits.select(tried.end[i], g.state[i]);
                g.derivative[i] = commits.select(tried.derivative[i], g.derivative[i]);
            }
            for i in [4, 5] {
                let turns = (g.state[i] * c!(1.0 / TAU)).floor();
                g.state[i] = turns.mul_add_precise(c!(-TAU), g.state[i]);
            }
            for i in 0..4 {
                g.values[i] = commits.select(values[i], g.values[i]);
                g.slopes[i] = commits.select(slopes[i], g.slopes[i]);
            }
            // At rest for good?
            let u_x = g.state[0] - g.rest[0];
            let u_y = g.state[1] - g.rest[1];
            let v_x = g.state[2] - g.phase.omega * u_y;
            let v_y = g.state[3] + g.phase.omega * u_x;
            let distance = u_x * u_x + u_y * u_y + (v_x * v_x + v_y * v_y);
            let at_rest = distance.simd_le(g.rest_radius_squared);
            let at_end = g.time.simd_ge(g.end_time);
            let too_many = g.steps.simd_gt(c!(STEP_LIMIT));
            // What is rare.
            let mut rare = rejected;
            while rare != 0 {
                let lane = rare.trailing_zeros() as usize;
                rare &= rare - 1;
                g.count[lane][0] += 1;
                g.search[lane] = None;
                g.trial[lane] = f64::INFINITY;
            }
            while events != 0 {
                let lane = events.trailing_zeros() as usize;
                events &= events - 1;
                g.count[lane][2] += 1;
                if let Some(number) = g.task[lane] {
                    let mut state = unflat(&g.lane_state(lane));
                    for i in 0..2 {
                        let slips = g.stuck[i][lane] == 0.0;
                        if slips && g.direction[i][lane] * state.beta_dot[i] <= 0.0 {
                            state.beta_dot[i] = 0.0;
                        }
                    }
                    if !g.begin_phase(lane, &tasks[number], settings, state) {
                        give_up |= 1 << lane;
                    }
                }
            }
            let mut ended = (at_rest.to_bitmask() | at_end.to_bitmask() | too_many.to_bitmask())
                & alive
                & (commit | too_many.to_bitmask())
                | give_up;
            while ended != 0 {
                let lane = ended.trailing_zeros() as usize;
                ended &= ended - 1;
                let Some(number) = g.task[lane] else { continue };
                let state = g.lane_state(lane);
                let task = &tasks[number];
                let all_stick = g.stuck.iter().all(|stuck| stuck[lane] > 0.0);
                let rest = |state: &[f64; N]| {
                    let state = unflat(state);
                    let rest = task.balancer.rest_point(&state.beta);
                    certified_by_closed_form(&task.balancer, &rest, &state)
                };
                let slow = state[6].abs() <= 1e-6 && state[7].abs() <= 1e-6;
                let ending = if give_up >> lane & 1 == 1 || g.steps[lane] > STEP_LIMIT {
                    Ending::GivenUp
                } else if g.time[lane] < task.end_time {
                    // An event in the same step may have changed what the balls do.
                    if !all_stick || !at_rest.test(lane) {
                        continue;
                    }
                    Ending::Rest
                } else if all_stick && rest(&state) {
                    Ending::Rest
                } else if slow {
                    Ending::GivenUp
                } else {
                    Ending::EndTime
                };
                let [rejected, trials, events, looks, all_stick_steps] = g.count[lane];
                let (time, steps) = (g.time[lane], g.steps[lane]);
                done[number] = Some(Done {
                    ending,
                    time,
                    state,
                    steps,
                    rejected,
                    trials,
                    events,
                    looks,
                    all_stick_steps,
                });
                refill(g, lane, tasks, settings, &mut upcoming, &mut done);
            }
        }
    }
    (done, totals)
}

/// Gives a lane the next task that can be begun, or none.
fn refill<S: Simd>(
    group: &mut Group<S>,
    lane: usize,
    tasks: &[Task],
    settings: Settings,
    upcoming: &mut usize,
    done: &mut [Option<Done>],
) {
    while *upcoming < tasks.len() {
        let number = *upcoming;
        *upcoming += 1;
        if group.load(lane, number, &tasks[number], settings) {
            return;
        }
        done[number] = None;
    }
    group.task[lane] = None;
    group.search[lane] = None;
    group.trial[lane] = 0.0;
}

/// For trials only: a setting by the environment.
pub fn knob(name: &str, default: f64) -> f64 {
    std::env::var(name).map_or(default, |text| text.parse().unwrap_or(default))
}

thread_local! {
    static KNOBS: std::cell::Cell<[f64; 4]> = const { std::cell::Cell::new([0.9, 1.0, 1.0, 1.0]) };
}

/// For trials only: safety factor of the step control, and how much longer than stickslip's the
/// longest step may be, altogether and while a ball sticks; by how much the tolerance is stricter in
/// the first 300 units of time.
pub fn set_knobs(safety: f64, longest: f64, sticking: f64, stricter: f64) {
    KNOBS.set([safety, longest, sticking, stricter]);
}
