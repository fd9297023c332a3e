//! The recurrence of the balancer with friction that is constant or linear in speed.
//!
//! It gives the same series as the recorded equations (`general`) several times as fast: the products are chosen so
//! that few remain, everything has a size known to the compiler, and bounds of the conditions come from few numbers.

#[cfg(all(test, target_arch = "x86_64"))]
mod compared_with_equations;
#[cfg(all(test, target_arch = "x86_64"))]
mod compared_with_general;
mod equations;
mod event_functions;
mod event_location;
mod flow;
mod gap_forces;
mod mode_selection;
mod recurrence;
mod series;
mod step;
mod tail_terms;
mod tangent;
mod terms;
mod turning;

use std::sync::Arc;

use fearless_simd::{mask64x8, prelude::*};

use super::kernel::{Ends, Kernel, Powers};
use super::lane::Lane;
use super::{LANES, Lanes, ORDER};
use crate::model::{Balancer, Components, RestPoint, State, System};
use crate::motion::Evaluator;
use crate::motion::lockstep::trigonometry::sin_cos;
use crate::motion::lockstep::vector::{Fused, Vector};
use crate::motion::modes::{Evaluated, InState};
use crate::motion::saltation::Condition;
use crate::motion::{Phase, all_stick, any_closed};
use equations::Equations;
use event_functions::{Doubts, Watched};
use flow::Flow;
use gap_forces::Gaps;
use mode_selection::InPlace;
use recurrence::RECIPROCALS;
use series::Series;
use turning::Drive;

/// Bound on every component of the rate of change if everything is slow.
const STILL: f64 = 1e-6;

/// The balancer's equations in all lanes.
pub(super) struct Tuned<S: Vector, const N: usize> {
    equations: Equations<S, N>,
    watched: [Watched<S>; N],
    /// The rest point, and the square of the distance from it below which no ball can break loose; negative if there
    /// is no such distance.
    rest: [Lanes<S>; 2],
    rest_radius_squared: Lanes<S>,
    balancers: [Option<Balancer<N>>; LANES],
    /// The phases of the balls that the equations have.
    phases: [[Option<Phase>; N]; LANES],
    gaps: Gaps<S, N>,
    /// The disc, if its speed changes.
    drive: Option<Box<Drive<S, N>>>,
    /// The recorded equations of systems with gaps or a disc whose speed changes, for the decisions that need them.
    evaluators: [Option<Evaluator>; LANES],
    /// The latest of them, for the next one.
    latest: Option<Evaluator>,
    /// Bit mask of lanes with a ball that cannot stick.
    sliding: u64,
}

/// Work space of a step, with the results of the latest step.
pub(super) struct Room<S: Vector, const N: usize> {
    series: Series<S, N>,
    displaced: Series<S, N>,
    doubts: Doubts<S, N>,
}

impl<S: Vector, const N: usize> Tuned<S, N> {
    /// Empty lanes, for discs whose speed changes or for others.
    pub(super) fn new(simd: S, changes: bool) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        Tuned {
            equations: Equations::blank(simd),
            watched: [Watched::nothing(simd); N],
            rest: [zero; 2],
            rest_radius_squared: Lanes::splat(simd, -1.0),
            balancers: [None; LANES],
            phases: [[None; N]; LANES],
            gaps: Gaps::none(simd),
            drive: changes.then(|| Box::new(Drive::blank(simd))),
            evaluators: std::array::from_fn(|_| None),
            latest: None,
            sliding: 0,
        }
    }

    /// Returns whether a system is a balancer with this number of balls whose friction is independent of speed or
    /// proportional to it. Of balls that may touch, all can stick or none can.
    pub(super) fn computes(system: &Arc<dyn System>) -> bool {
        let balancer = while_apart::<N>(system);
        balancer.is_some_and(|own| {
            let sticking = own.balls.iter().filter(|ball| ball.friction.can_stick()).count();
            own.balls.iter().all(|ball| ball.friction.is_linear())
                && (system.touching().is_none() || sticking == 0 || sticking == N)
        })
    }
}

impl<S: Vector, const N: usize> Kernel<S> for Tuned<S, N> {
    /// 5 over the highest frequency of the table in the turning frame, `1 + |ω|`. Hardly any step is as long.
    const LONGEST: f64 = 5.0 / std::f64::consts::FRAC_PI_2;
    type Flow = Flow<S, N>;
    type Room = Room<S, N>;

    fn fits(&self, system: &Arc<dyn System>) -> bool {
        Self::computes(system) && system.speed_terms().is_some() == self.drive.is_some()
    }

    #[inline(always)]
    fn contacts(&self) -> usize {
        N
    }

    #[inline(always)]
    fn is_angular(&self, _contact: usize) -> bool {
        true
    }

    fn flow(&self, simd: S) -> Flow<S, N> {
        Flow::zero(simd)
    }

    fn room(&self, simd: S) -> Room<S, N> {
        Room {
            series: Series::zero(simd),
            displaced: Series::zero(simd),
            doubts: Doubts::none(simd),
        }
    }

    fn set_system(&mut self, lane: usize, own: &Lane) {
        let Some(balancer) = while_apart(&own.system) else { return };
        let mut balancer: Balancer<N> = *balancer;
        if let (Some(drive), Some(speed)) = (&mut self.drive, own.system.speed_terms()) {
            drive.set_machine(lane, &balancer, speed);
            // Everything that depends on the speed is in `Drive`.
            balancer.speed = 0.0;
            balancer.balls.iter_mut().for_each(|ball| ball.rolling_linear = 0.0);
        }
        self.equations.set_machine(lane, &balancer);
        for (watched, ball) in self.watched.iter_mut().zip(&balancer.balls) {
            watched.limit[lane] = ball.friction.limit;
        }
        let bit = 1 << lane;
        let slides = balancer.balls.iter().any(|ball| !ball.friction.can_stick());
        self.sliding = self.sliding & !bit | if slides { bit } else { 0 };
        self.balancers[lane] = Some(balancer);
        self.phases[lane] = [None; N];
        self.gaps.clear(lane);
        let recorded = own.system.touching().is_some() || self.drive.is_some();
        if recorded {
            let new = || Evaluator::new(Arc::clone(&own.system));
            let evaluator = self.latest.as_ref().map_or_else(new, |one| one.of(&own.system));
            self.latest = Some(evaluator.clone());
            self.evaluators[lane] = Some(evaluator);
        } else {
            self.evaluators[lane] = None;
        }
    }

    fn set_phases(&mut self, lane: usize, own: &Lane, _state: &[f64]) {
        let Some(balancer) = &self.balancers[lane] else { return };
        let margins = [own.margins.band, own.margins.slack, 0.5 * own.width];
        for (place, phase) in own.phases[..N].iter().enumerate() {
            // Few balls change their phase at once.
            if self.phases[lane][place].replace(*phase) == Some(*phase) {
                continue;
            }
            self.equations.set_phase(lane, balancer, (place, *phase));
            self.watched[place].set(lane, *phase, margins);
            if let Some(drive) = &mut self.drive {
                let ball = &self.equations.balls[place];
                drive.set_ball(lane, place, [ball.mobility[lane], ball.friction[lane]]);
            }
        }
        if let Some(touching) = own.system.touching() {
            self.gaps.set(lane, own, touching.gaps(), &self.equations);
        }
    }

    fn set_rest(&mut self, lane: usize, own: &Lane, state: &[f64]) {
        self.rest_radius_squared[lane] = -1.0;
        // A run ends in its last stage, in which the speed is constant.
        if self.drive.is_none()
            && all_stick(&own.phases)
            && let Some(balancer) = &self.balancers[lane]
            && let Some(state) = State::<N>::of_components(state)
        {
            let rest = balancer.rest_point(&state.beta);
            self.rest[0][lane] = rest.position[0];
            self.rest[1][lane] = rest.position[1];
            // Forces between balls that touch can hold them where friction alone cannot.
            let touches = any_closed(&own.phases);
            self.rest_radius_squared[lane] =
                if touches { f64::INFINITY } else { rest_radius_squared(balancer, &rest) };
        }
    }

    fn clear(&mut self, lane: usize) {
        self.sliding &= !(1 << lane);
        self.rest_radius_squared[lane] = -1.0;
        self.balancers[lane] = None;
        self.gaps.clear(lane);
        self.evaluators[lane] = None;
    }

    fn lane(&self, flow: &Flow<S, N>, lane: usize) -> Components {
        let mut components = flow.lane(lane).components();
        if self.drive.is_some() {
            components.push(flow.elapsed[lane]);
        }
        components
    }

    fn set_lane(&self, flow: &mut Flow<S, N>, lane: usize, components: &[f64]) {
        flow.set_lane(lane, components);
    }

    #[inline(always)]
    fn select(&self, into: &mut Flow<S, N>, from: &Flow<S, N>, mask: mask64x8<S>) {
        for i in 0..4 {
            into.table[i] = mask.select(from.table[i], into.table[i]);
        }
        for i in 0..N {
            into.angle[i] = mask.select(from.angle[i], into.angle[i]);
            into.speed[i] = mask.select(from.speed[i], into.speed[i]);
        }
        into.elapsed = mask.select(from.elapsed, into.elapsed);
    }

    #[inline(always)]
    fn finite(&self, flow: &Flow<S, N>, start: Lanes<S>) -> Lanes<S> {
        let zero = Lanes::splat(start.simd, 0.0);
        let all = flow.table.iter().chain(&flow.angle).chain(&flow.speed);
        let mut nought = start;
        for value in all {
            nought = value.fused(zero, nought);
        }
        nought
    }

    #[inline(always)]
    fn square(&self, flow: &Flow<S, N>) -> Lanes<S> {
        let mut size = Lanes::splat(flow.table[0].simd, 0.0);
        for value in flow.table {
            size = value.fused(value, size);
        }
        for i in 0..N {
            size = flow.angle[i].fused(flow.angle[i], size);
            size = flow.speed[i].fused(flow.speed[i], size);
        }
        size
    }

    #[inline(always)]
    fn position(&self, flow: &Flow<S, N>, contact: usize) -> Lanes<S> {
        flow.angle[contact]
    }

    #[inline(always)]
    fn set_position(&self, flow: &mut Flow<S, N>, contact: usize, position: Lanes<S>) {
        flow.angle[contact] = position;
    }

    #[inline(always)]
    fn speed(&self, flow: &Flow<S, N>, contact: usize) -> Lanes<S> {
        flow.speed[contact]
    }

    #[inline(always)]
    fn expand(&self, room: &mut Room<S, N>, start: &Flow<S, N>) {
        room.series.expand(&self.equations, (self.drive.as_deref(), &self.gaps), start);
    }

    #[inline(always)]
    fn within_tolerance(
        &self,
        room: &Room<S, N>,
        tolerance: [Lanes<S>; 2],
        before: Lanes<S>,
    ) -> Lanes<S> {
        step::within_tolerance(&room.series, tolerance, before)
    }

    #[inline(always)]
    fn look_over(&self, room: &mut Room<S, N>, length: Lanes<S>) -> u64 {
        let Room { series, doubts, .. } = room;
        let watched = (&self.watched, &self.gaps);
        event_functions::look_over(series, &self.equations, watched, length, doubts);
        doubts.any()
    }

    fn first_event(
        &self,
        room: &Room<S, N>,
        own: &Lane,
        lane: usize,
        length: f64,
        ignored: &[Condition],
    ) -> Ends {
        let Some(balancer) = &self.balancers[lane] else { return Ends::Nothing };
        let at = (lane, length);
        let own = (own, balancer, &self.gaps);
        event_location::first_event(&room.series, own, at, &room.doubts, ignored)
    }

    #[inline(always)]
    fn at(&self, room: &Room<S, N>, start: &Flow<S, N>, time: Lanes<S>) -> Flow<S, N> {
        let mut end = room.series.at(&self.equations, start, time);
        if self.drive.is_some() {
            end.elapsed += time;
        }
        end
    }

    #[inline(always)]
    fn carry(
        &self,
        room: &mut Room<S, N>,
        displacement: &Flow<S, N>,
        length: Lanes<S>,
    ) -> Flow<S, N> {
        let Room { series, displaced, .. } = room;
        let equations = (&self.equations, self.drive.as_deref());
        tangent::carry(series, equations, displacement, length, displaced)
    }

    #[inline(always)]
    fn rest(&self, state: &Flow<S, N>) -> u64 {
        let speed = self.equations.speed;
        let u_x = state.table[0] - self.rest[0];
        let u_y = state.table[1] - self.rest[1];
        let v_x = state.table[2] - speed * u_y;
        let v_y = state.table[3] + speed * u_x;
        let distance = u_x * u_x + u_y * u_y + (v_x * v_x + v_y * v_y);
        distance.simd_le(self.rest_radius_squared).to_bitmask()
    }

    #[inline(always)]
    fn still(&self, room: &Room<S, N>) -> u64 {
        if self.sliding == 0 || self.drive.is_some() {
            return 0;
        }
        let [first, second, third, ..] = &room.series.terms;
        let simd = self.equations.speed.simd;
        let two = Lanes::splat(simd, 2.0);
        let mut most = Lanes::splat(simd, 0.0);
        for axis in 0..2 {
            most = most.max(second.table[axis].abs()).max((two * third.table[axis]).abs());
        }
        for i in 0..N {
            most = most.max(first.balls[i].speed.abs()).max(second.balls[i].speed.abs());
        }
        most.simd_le(Lanes::splat(simd, STILL)).to_bitmask() & self.sliding
    }

    fn component(&self, room: &Room<S, N>, lane: usize, component: usize, start: f64) -> Powers {
        room.series.component(lane, component, start)
    }

    fn coordinates(&self, contact: usize) -> (usize, Option<usize>) {
        (4 + contact, Some(4 + N + contact))
    }

    fn vibration(&self) -> Option<[usize; 2]> {
        Some([0, 1])
    }

    #[inline(always)]
    fn vibration_of(&self, flow: &Flow<S, N>) -> [Lanes<S>; 2] {
        [flow.table[0], flow.table[1]]
    }

    #[inline(always)]
    fn vibration_at(&self, room: &Room<S, N>, times: [Lanes<S>; 3]) -> [[Lanes<S>; 2]; 3] {
        room.series.table_at(times)
    }

    #[inline(always)]
    fn relative_travel(
        &self,
        room: &Room<S, N>,
        [one, other]: [usize; 2],
        length: Lanes<S>,
    ) -> Lanes<S> {
        let mut bound = Lanes::splat(length.simd, 0.0);
        for (k, term) in room.series.terms[..=ORDER].iter().enumerate().rev() {
            let relative = (term.balls[one].speed - term.balls[other].speed).abs();
            bound = bound.fused(length, relative * Lanes::splat(length.simd, RECIPROCALS[k + 1]));
        }
        bound * length
    }

    fn evaluator(&self, lane: usize) -> Option<&Evaluator> {
        self.evaluators[lane].as_ref()
    }

    fn in_state<R>(
        &self,
        lane: usize,
        own: &Lane,
        state: &[f64],
        with: impl FnOnce(&dyn InState) -> R,
    ) -> R {
        let is_recorded = self.drive.is_some() || any_closed(&own.phases);
        if let Some(evaluator) = self.evaluator(lane).filter(|_| is_recorded) {
            // Not inlined a second time.
            return called(with, &Evaluated::new(evaluator, state));
        }
        let balancer = self.balancers[lane].as_ref();
        let balancer = balancer.expect("only lanes with a run are decided");
        let state =
            State::<N>::of_components(state).expect("the components are those of the lanes");
        let simd = self.equations.speed.simd;
        let turned = simd.vectorize(
            #[inline(always)]
            || {
                // A vector of the angles of one lane, not of lanes.
                const { assert!(N <= LANES) };
                let mut angles = Lanes::splat(simd, 0.0);
                for (place, angle) in state.beta.into_iter().enumerate() {
                    angles[place] = angle;
                }
                let (sines, cosines) = sin_cos(angles);
                std::array::from_fn(|place| (sines[place], cosines[place]))
            },
        );
        with(&InPlace::new(balancer, own.surely_one_solution, (state, turned)))
    }
}

#[cold]
#[inline(never)]
fn called<R>(with: impl FnOnce(&dyn InState) -> R, at: &dyn InState) -> R {
    with(at)
}

/// Returns the components of a balancer that are angles.
pub(super) fn angles(balls: usize) -> std::ops::Range<usize> {
    4..4 + balls
}

/// Returns the balancer that a system is while no balls touch.
fn while_apart<const N: usize>(system: &Arc<dyn System>) -> Option<&Balancer<N>> {
    system.while_apart().downcast_ref()
}

/// Calls `with` with a balancer at constant speed in one state; `None` for another system.
pub(super) fn in_state<R>(
    system: &Arc<dyn System>,
    surely_one_solution: bool,
    state: &[f64],
    with: impl FnOnce(&dyn InState) -> R,
) -> Option<R> {
    if system.speed_terms().is_some() {
        return None;
    }
    macro_rules! of_balls {
        ($($balls:literal)*) => {
            $(
                if let Some(balancer) = while_apart::<$balls>(system) {
                    let state = State::<$balls>::of_components(state)?;
                    let turned = state.beta.map(libm::sincos);
                    return Some(with(&InPlace::new(
                        balancer,
                        surely_one_solution,
                        (state, turned),
                    )));
                }
            )*
        };
    }
    of_balls!(1 2 3 4 5 6 7 8);
    None
}

/// Returns the square of the distance from rest below which no ball can break loose, apart from the
/// residual speeds of sticking balls in the switch model; negative if there is no such distance.
fn rest_radius_squared<const N: usize>(balancer: &Balancer<N>, rest: &RestPoint<N>) -> f64 {
    let mut least = f64::INFINITY;
    for (i, ball) in balancer.balls.iter().enumerate() {
        let limit = ball.friction.limit;
        least = least.min((limit * rest.normal[i] - rest.friction[i].abs()) / (1.0 + limit));
    }
    if least < 0.0 || least.is_nan() {
        return -1.0;
    }
    // Slightly larger, so that rounding leaves the decision to the certificate itself.
    let radius = least / balancer.acceleration_bound(1.0) * (1.0 + 1e-9);
    radius * radius
}
