//! States of a lane inside its latest step, from the step's series.

use std::f64::consts::TAU;

use fearless_simd::prelude::*;
use smallvec::SmallVec;

use super::kernel::Kernel;
use super::kernel_lanes::KernelLanes;
use super::root_isolation::{PolynomialPoint, guess};
use super::vector::{Powers, TERMS};
use crate::model::Components;
use crate::motion::PerContact;
use crate::motion::lockstep::vector::{Fused, Vector, vectorized};
use crate::motion::lockstep::{LANES, Lanes};
use crate::motion::root::fall_of_smooth;

/// The motion inside the latest step of each lane. Times are those after the start of the step.
pub(crate) trait StepStates {
    /// Returns the state at a time after the start of the latest step, with angles not yet reduced to one turn.
    fn state_within(&self, lane: usize, after: f64) -> Components;
    /// Returns the states at eight times after the start of the latest step, like [`StepStates::state_within`].
    fn states_within(&self, lane: usize, after: [f64; LANES]) -> [Components; LANES];
    /// Returns the series of a component in the latest step.
    fn series(&self, lane: usize, component: usize) -> Powers;
    /// Returns the value of a series at a time after the start of the step.
    fn value(&self, series: &Powers, after: f64) -> f64;
    /// Returns the rate of change of a component at a time after the start of the latest step.
    fn rate_within(&self, lane: usize, component: usize, after: f64) -> f64;
    /// Returns the positions of the contacts at a time after the start of the latest step, with the whole turns made
    /// since the start of the run.
    fn unwrapped_within(&self, lane: usize, after: f64) -> PerContact;
    /// Returns the angle of the whole turns that each contact had made before the latest step; 0 for a contact without a
    /// ring.
    fn turned_before(&self, lane: usize) -> PerContact;
    /// Returns the squares of the displacement of `StateLayout::vibration` at times after the start of the latest step; 0
    /// without such a displacement.
    fn squares_within(&self, lane: usize, after: [f64; 5]) -> [f64; 5];
    /// Returns some parts of the latest step with the squares of the displacement there. They contain each maximum whose
    /// neighbours exceed the part `near` of `known`. The caller passes the largest square so far as `known`.
    fn largest_squares_within(
        &self,
        lane: usize,
        known: f64,
        near: f64,
    ) -> SmallVec<[(f64, f64); 8]>;
    /// Returns time and state at which a contact's angle completed a turn, through the angle 0, in the latest step;
    /// `None` if it did not.
    fn passage(&self, lane: usize, contact: usize) -> Option<(f64, Components)>;
}

/// Parts of a step between which a displacement has one maximum at most.
const PARTS: [f64; LANES] = {
    let mut all = [0.0; LANES];
    let mut place = 0;
    while place < LANES {
        all[place] = place as f64 / (LANES - 1) as f64;
        place += 1;
    }
    all
};

/// Returns the value of a series and its rate at a time.
#[inline(always)]
fn value_and_rate(powers: &Powers, time: f64) -> (f64, f64) {
    let (mut value, mut rate) = (0.0_f64, 0.0_f64);
    for coefficient in powers.iter().rev() {
        rate = rate.mul_add(time, value);
        value = value.mul_add(time, *coefficient);
    }
    (value, rate)
}

/// Returns how far an angle is from a mark at a part of the step, and the slope of that.
#[inline(always)]
fn ahead(powers: &Powers, part: f64, length: f64, (mark, sign): (f64, f64)) -> (f64, f64) {
    let (angle, rate) = value_and_rate(powers, part * length);
    (sign * (mark - angle), -sign * rate * length)
}

/// Returns half of the rate of change of the square of a displacement, and its slope over a part of a step.
#[inline(always)]
fn rise([x, y]: &[Powers; 2], time: f64, length: f64) -> (f64, f64) {
    let (mut sum, mut slope) = (0.0, 0.0);
    for powers in [x, y] {
        let (mut value, mut rate, mut half_curvature) = (0.0_f64, 0.0_f64, 0.0_f64);
        for coefficient in powers.iter().rev() {
            half_curvature = half_curvature.mul_add(time, rate);
            rate = rate.mul_add(time, value);
            value = value.mul_add(time, *coefficient);
        }
        sum += value * rate;
        slope += rate * rate + 2.0 * value * half_curvature;
    }
    (sum, slope * length)
}

/// Returns the value of a series of one lane at some times: a vector of times, not of lanes.
#[inline(always)]
fn along<S: Vector, const P: usize>(simd: S, after: [f64; P], powers: &Powers) -> Lanes<S> {
    let mut times = Lanes::splat(simd, 0.0);
    for (place, after) in after.into_iter().enumerate() {
        times[place] = after;
    }
    let zero = Lanes::splat(simd, 0.0);
    powers.iter().rev().fold(zero, |sum, power| sum.fused(times, Lanes::splat(simd, *power)))
}

#[inline(always)]
fn value(powers: &Powers, time: f64) -> f64 {
    powers.iter().rev().fold(0.0_f64, |sum, coefficient| sum.mul_add(time, *coefficient))
}

impl<S: Vector, K: Kernel<S>> KernelLanes<S, K> {
    /// Returns the state at a time after the start of the latest step.
    #[inline(never)]
    fn state_at(&self, lane: usize, after: f64) -> Components {
        let time = Lanes::splat(self.simd, after);
        let mut state = self.kernel.lane_states(self.simd);
        vectorized!(self.simd, self.kernel.at(&self.workspace, &self.before, time, &mut state));
        self.kernel.lane(&state, lane)
    }
}

impl<S: Vector, K: Kernel<S>> StepStates for KernelLanes<S, K> {
    fn state_within(&self, lane: usize, after: f64) -> Components {
        if after == 0.0 {
            return self.kernel.lane(&self.before, lane);
        }
        self.state_at(lane, after)
    }

    #[inline(never)]
    fn states_within(&self, lane: usize, after: [f64; LANES]) -> [Components; LANES] {
        let start = self.kernel.lane(&self.before, lane);
        let simd = self.simd;
        let mut states = std::array::from_fn(|_| start.clone());
        for component in 0..start.len() {
            let powers = self.kernel.component(&self.workspace, lane, component, start[component]);
            let values = vectorized!(simd, along(simd, after, &powers));
            for (place, state) in states.iter_mut().enumerate() {
                state[component] = values[place];
            }
        }
        states
    }

    fn series(&self, lane: usize, component: usize) -> Powers {
        let start = self.kernel.lane_component(&self.before, lane, component);
        self.kernel.component(&self.workspace, lane, component, start)
    }

    fn value(&self, series: &Powers, after: f64) -> f64 {
        vectorized!(self.simd, value(series, after))
    }

    fn rate_within(&self, lane: usize, component: usize, after: f64) -> f64 {
        let powers = self.kernel.component(&self.workspace, lane, component, 0.0);
        vectorized!(self.simd, value_and_rate(&powers, after).1)
    }

    fn unwrapped_within(&self, lane: usize, after: f64) -> PerContact {
        let position = |(contact, turned): (usize, f64)| {
            let (component, _) = self.kernel.coordinates(contact);
            self.value(&self.series(lane, component), after) + turned
        };
        self.turned_before(lane).into_iter().enumerate().map(position).collect()
    }

    fn turned_before(&self, lane: usize) -> PerContact {
        let contact = |contact: usize| {
            if !self.kernel.is_angular(contact) {
                return 0.0;
            }
            // Turns are counted at the step's end.
            let end = self.kernel.position(&self.end, contact)[lane];
            let reduced = self.kernel.position(&self.state, contact)[lane];
            let counted = ((end - reduced) / TAU).round();
            (self.turns[contact][lane] - counted) * TAU
        };
        (0..self.kernel.contacts()).map(contact).collect()
    }

    #[inline(never)]
    fn squares_within(&self, lane: usize, after: [f64; 5]) -> [f64; 5] {
        let Some([x, y]) = self.kernel.vibration() else { return [0.0; 5] };
        // Not a map over both, which would copy the series.
        let x = self.kernel.component(&self.workspace, lane, x, 0.0);
        let y = self.kernel.component(&self.workspace, lane, y, 0.0);
        let simd = self.simd;
        let squares = vectorized!(simd, {
            let [x, y] = [along(simd, after, &x), along(simd, after, &y)];
            x * x + y * y
        });
        std::array::from_fn(|place| squares[place])
    }

    #[inline(never)]
    fn largest_squares_within(
        &self,
        lane: usize,
        known: f64,
        near: f64,
    ) -> SmallVec<[(f64, f64); 8]> {
        let mut largest = SmallVec::new();
        let Some([x, y]) = self.kernel.vibration() else { return largest };
        let powers = [
            self.kernel.component(&self.workspace, lane, x, 0.0),
            self.kernel.component(&self.workspace, lane, y, 0.0),
        ];
        let length = self.length[lane];
        let simd = self.simd;
        vectorized!(simd, {
            // Vectors of places in the step of one lane, not of lanes.
            let mut times = Lanes::splat(simd, 0.0);
            for (place, node) in PARTS.into_iter().enumerate() {
                times[place] = node * length;
            }
            let zero = Lanes::splat(simd, 0.0);
            let (mut places, mut rates) = ([zero; 2], [zero; 2]);
            for k in (0..TERMS).rev() {
                for axis in 0..2 {
                    rates[axis] = rates[axis].fused(times, places[axis]);
                    places[axis] = places[axis].fused(times, Lanes::splat(simd, powers[axis][k]));
                }
            }
            let squares = places[0] * places[0] + places[1] * places[1];
            let outward = places[0] * rates[0] + places[1] * rates[1];
            largest.push((PARTS[0], squares[0]));
            for high in 1..LANES {
                largest.push((PARTS[high], squares[high]));
                let low = high - 1;
                let rises_and_falls = outward[low] > 0.0 && outward[high] <= 0.0;
                if !rises_and_falls || squares[low].max(squares[high]) < near * known {
                    continue;
                }
                let [from, to] = [low, high].map(
                    #[inline(always)]
                    |place| outward[place],
                );
                let span = PARTS[high] - PARTS[low];
                let guess = PARTS[low] + span * from / (from - to);
                let part = fall_of_smooth(
                    #[inline(always)]
                    |part| rise(&powers, part * length, length),
                    (PARTS[low], PARTS[high]),
                    guess,
                    1e-13,
                );
                let (x, y) = (value(&powers[0], part * length), value(&powers[1], part * length));
                largest.push((part, x * x + y * y));
            }
        });
        largest
    }

    #[inline(never)]
    fn passage(&self, lane: usize, contact: usize) -> Option<(f64, Components)> {
        if !self.kernel.is_angular(contact) {
            return None;
        }
        let (component, _) = self.kernel.coordinates(contact);
        let start = self.kernel.position(&self.before, contact)[lane];
        let end = self.kernel.position(&self.end, contact)[lane];
        let (mark, sign) = if start < TAU && end >= TAU {
            (TAU, 1.0)
        } else if start > 0.0 && end <= 0.0 {
            (0.0, -1.0)
        } else {
            return None;
        };
        let length = self.length[lane];
        let powers = self.kernel.component(&self.workspace, lane, component, start);
        let part = vectorized!(self.simd, {
            // Not a map over both ends: the fused multiply-add must be inlined.
            let (value, slope) = ahead(&powers, 0.0, length, (mark, sign));
            let low = PolynomialPoint { at: 0.0, value, slope };
            let (value, slope) = ahead(&powers, 1.0, length, (mark, sign));
            let high = PolynomialPoint { at: 1.0, value, slope };
            fall_of_smooth(
                #[inline(always)]
                |part| ahead(&powers, part, length, (mark, sign)),
                (0.0, 1.0),
                guess(low, high),
                1e-13,
            )
        });
        let after = part * length;
        Some((self.time_before[lane] + after, self.state_at(lane, after)))
    }
}
