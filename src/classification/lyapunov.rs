//! Irregular motion: neighbouring motions separate exponentially.
//!
//! A small perturbation is carried along the motion by the linearised flow, through stick and slip,
//! and rescaled whenever it has grown (G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn,
//! Meccanica 15 (1980) 9, doi:10.1007/BF02128236; with saltation: P. C. Müller, Chaos Solitons
//! Fractals 5 (1995) 1671, doi:10.1016/0960-0779(94)00170-U). The mean rate of growth over a window
//! at the end of the run is the largest finite-time Lyapunov exponent.
//!
//! The confidence interval of the exponent comes from the scatter of the rates in successive blocks
//! of the window (batch means: B. Schmeiser, Operations Research 30 (1982) 556,
//! doi:10.1287/opre.30.3.556). A block consists of one or more of [`PARTS`] equal parts of the window
//! and contains at least [`LEAST_TURNS_AND_SWITCHES`] turns, switches and impacts per contact, so that the rates of successive
//! blocks are not positively correlated and the interval is not too narrow. A window with fewer turns
//! and switches has fewer blocks and a wider interval; one block has no interval.
//!
//! A motion counts as irregular if
//!
//! - the window has at least [`BLOCKS`] blocks. At least one of them lies in the second half of the
//!   window, so that a slow passage by an unstable equilibrium, where neighbours separate only once,
//!   does not count;
//! - the interval is positive;
//! - in the second half of the window, neighbours have separated by at least [`SEPARATED`]. This
//!   excludes growth by a power of time: a perturbation along a family of motions (a ball that rests
//!   elsewhere, which changes the speed of another) grows in proportion to time; in the second half
//!   of a window that is a factor of 2, and for the third power of time a factor of 8;
//! - the motion itself does not grow: from the first to the second half of the window, the size of the velocity grows neither by
//!   the factor `e` to the power [`GROWS`] nor by a quarter of the logarithm by which neighbours separate.

use super::lane_step::LaneStep;
use super::outcome::LyapunovExponent;
use super::system_view::SystemView;
use crate::model::Components;

/// The part of the time at the end of a run over which separation is measured.
pub(super) const SEPARATION_WINDOW: f64 = 0.75;
/// Number of equal parts of the window.
const PARTS: usize = 10;
/// Number of parts after which the measurement stops if neighbours have only converged: most
/// motions are regular, and a perturbation costs as much as the motion itself.
const PILOT: usize = 4;
/// Minimum number of turns and switches in a block, in the mean over the contacts.
const LEAST_TURNS_AND_SWITCHES: f64 = 7.0;
/// Minimum number of blocks of an irregular motion.
const BLOCKS: u8 = 6;
/// The two-sided 95 % points of Student's distribution for 2 to 10 blocks (1 to 9 degrees of freedom).
const STUDENT: [f64; PARTS - 1] = [
    12.706_204_736_174_698,
    4.302_652_729_749_464,
    3.182_446_305_284_263,
    2.776_445_105_197_793,
    2.570_581_835_636_314,
    2.446_911_851_144_969,
    2.364_624_251_592_784,
    2.306_004_135_204_166,
    2.262_157_162_798_205,
];
/// Minimum separation of neighbours in the second half of the window.
const SEPARATED: f64 = 10.0;

/// Logarithm of the growth of the velocity, from one half of the window to the other, of a motion without bounds.
const GROWS: f64 = 2.0;

/// Measures how fast neighbours of a motion separate between two times.
#[derive(Clone, Debug)]
pub(super) struct Separation {
    /// The start of the window.
    pub(super) start: f64,
    end: f64,
    /// Logarithm of the growth so far.
    growth: f64,
    /// The growth at the start and at the end of each part.
    marks: Vec<GrowthMark>,
    given_up: bool,
    /// Whether a switch was met by grazing, so that the perturbation is undefined.
    grazed: bool,
}

#[derive(Clone, Copy, Debug)]
struct GrowthMark {
    time: f64,
    growth: f64,
    progress: RunProgress,
}

/// How far a run has come.
#[derive(Clone, Copy, Debug)]
pub(super) struct RunProgress {
    /// Turns, switches and impacts of contacts that open since the start of the run, per contact.
    pub(super) turns_and_switches: f64,
    /// The size of the velocity.
    pub(super) speed: f64,
}

impl Separation {
    /// Creates a measurement from `start` to `end`.
    pub(super) fn new(start: f64, end: f64) -> Self {
        Separation { start, end, growth: 0.0, marks: Vec::new(), given_up: false, grazed: false }
    }

    /// Returns whether perturbations are measured at a time: the window has begun and the
    /// measurement has not stopped.
    pub(super) fn follows(&self, time: f64) -> bool {
        time > self.start && !self.given_up
    }

    /// Returns whether the measurement has begun.
    pub(super) fn has_begun(&self) -> bool {
        !self.marks.is_empty()
    }

    /// Adds the growth of the perturbation since the last call.
    pub(super) fn grow(&mut self, time: f64, factor: f64, grazed: bool, progress: RunProgress) {
        self.growth += factor.ln();
        self.grazed |= grazed;
        self.mark_if_due(time, progress);
        self.given_up |= !self.growth.is_finite();
    }

    /// Returns when the growth is due next.
    pub(super) fn next_mark(&self) -> f64 {
        (self.start + self.part() * self.marks.len() as f64).min(self.end)
    }

    fn part(&self) -> f64 {
        (self.end - self.start) / PARTS as f64
    }

    fn mark_if_due(&mut self, time: f64, progress: RunProgress) {
        if time >= self.start + self.part() * self.marks.len() as f64 || time >= self.end {
            self.mark(time, progress);
            self.given_up = self.marks.len() == PILOT + 1 && self.growth < 0.0;
        }
    }

    /// Marks a time: first the end of the first step that extends into the window, where the perturbation has the size 1.
    pub(super) fn mark(&mut self, time: f64, progress: RunProgress) {
        self.marks.push(GrowthMark { time, growth: self.growth, progress });
    }

    /// Returns the start of the first block and the end of each block. What remains after the last
    /// full block belongs to it.
    fn blocks(&self) -> Vec<GrowthMark> {
        let mut ends: Vec<GrowthMark> = Vec::new();
        for mark in &self.marks {
            if ends.last().is_none_or(|end| {
                mark.progress.turns_and_switches - end.progress.turns_and_switches
                    >= LEAST_TURNS_AND_SWITCHES
            }) {
                ends.push(*mark);
            }
        }
        if ends.len() > 1 {
            ends.pop();
        }
        ends.extend(self.marks.last());
        ends
    }

    /// Returns the exponent, here per unit of non-dimensional time, with its interval, the number of
    /// blocks and the length of the window, which is shorter if the measurement stopped early.
    /// `None` if it could not be measured, because a switch was met by grazing or there were too few
    /// steps.
    pub(super) fn exponent(&self) -> Option<LyapunovExponent> {
        let ends = self.blocks();
        let (first, last) = (ends.first()?, ends.last()?);
        let window = last.time - first.time;
        let exponent = (last.growth - first.growth) / window;
        if self.grazed || !exponent.is_finite() {
            return None;
        }
        let excess = |pair: &[GrowthMark]| {
            pair[1].growth - pair[0].growth - exponent * (pair[1].time - pair[0].time)
        };
        let squares: f64 = ends.windows(2).map(|pair| excess(pair).powi(2)).sum();
        let blocks = ends.len() - 1;
        let student = blocks.checked_sub(2).and_then(|degrees| STUDENT.get(degrees));
        let doubt = student.map(|student| {
            student * (squares * blocks as f64 / (blocks - 1) as f64).sqrt() / window
        });
        Some(LyapunovExponent {
            exponent_1_s: exponent,
            interval_1_s: doubt.map(|doubt| [exponent - doubt, exponent + doubt]),
            blocks: blocks as u8,
            window_s: window,
        })
    }

    /// Returns whether neighbours separate exponentially, according to the criteria above.
    pub(super) fn is_irregular(&self) -> bool {
        let Some(LyapunovExponent { interval_1_s: Some([low, _]), blocks, .. }) = self.exponent()
        else {
            return false;
        };
        let (half, last) = (self.marks[self.marks.len() / 2], self.marks[self.marks.len() - 1]);
        !self.given_up
            && !self.grows()
            && blocks >= BLOCKS
            && low > 0.0
            && last.growth - half.growth >= SEPARATED.ln()
    }

    /// Returns whether the motion itself grows without bound: neighbours of such a motion separate at the rate of its growth.
    fn grows(&self) -> bool {
        let (early, late) = self.marks.split_at(self.marks.len() / 2);
        let [early, late] = [early, late].map(|marks| {
            marks.iter().map(|mark| mark.progress.speed).fold(f64::MIN_POSITIVE, f64::max)
        });
        let growth = self.marks.last().map_or(0.0, |last| last.growth);
        (late / early).ln() > GROWS.max(0.25 * growth)
    }
}

/// Returns the initial perturbation, of size 1. All contacts are perturbed equally: exchanging two of
/// them exchanges only the perturbations. Balls that are exactly side by side stay so; the instability
/// of their orbit shows in the multipliers. (Perturbed speeds would separate contacts in proportion to
/// time for a long period.) The table of a balancer follows its balls; in any other system, coordinates without
/// contact are perturbed, too.
pub(super) fn perturbation(view: &SystemView) -> Components {
    let graph = view.evaluator.graph();
    // The time is no part of the motion.
    let is_time = |place: usize| graph.is_clock(place);
    let is_velocity =
        |place: usize| graph.layout.velocities.iter().flatten().any(|of| *of == place);
    let free = view
        .free
        .iter()
        .copied()
        .filter(|place| view.vibration.is_none() && !is_time(*place) && !is_velocity(*place));
    let contacts = view.contacts.iter().map(|contact| contact.position);
    let positions: Vec<_> = contacts.chain(free).collect();
    let mut perturbed = Components::from_elem(0.0, view.dimension());
    for place in &positions {
        perturbed[*place] = 1.0 / (positions.len() as f64).sqrt();
    }
    perturbed
}

/// Returns the size of a perturbation.
pub(super) fn size(view: &SystemView, perturbation: &[f64]) -> f64 {
    let square = |components: &mut dyn Iterator<Item = usize>| {
        components.map(|place| perturbation[place] * perturbation[place]).sum::<f64>()
    };
    let (positions, velocities) = view.free.split_at(view.free.len() / 2);
    let contacts = &view.contacts;
    (square(&mut positions.iter().copied())
        + square(&mut velocities.iter().copied())
        + square(&mut contacts.iter().map(|contact| contact.position))
        + square(&mut contacts.iter().filter_map(|contact| contact.speed)))
    .sqrt()
}

/// Returns the size of the velocity, and the number of turns of balls, in both directions, switches, and impacts of contacts that open
/// since the start of a run, in the mean over the contacts.
pub(super) fn progress(step: &LaneStep) -> RunProgress {
    let LaneStep { group, lane, view } = *step;
    let (state, turns) = (group.state(lane), group.turns(lane));
    let balls = view.contacts.iter().zip(&turns).filter(|(contact, _)| contact.angular);
    let turned = balls
        .map(|(contact, turns)| (turns + state[contact.position] / std::f64::consts::TAU).abs());
    let opens = !view.evaluator.graph().openings.is_empty();
    let impacts = if opens { group.impacts(lane) } else { 0 };
    let turns_and_switches = turned.sum::<f64>() + (step.effort().switches + impacts) as f64;
    let velocities = view.evaluator.graph().layout.velocities.iter().flatten();
    let speed = velocities.map(|index| state[*index] * state[*index]).sum::<f64>().sqrt();
    RunProgress { turns_and_switches: turns_and_switches / view.contacts.len() as f64, speed }
}

#[cfg(test)]
mod tests {
    use super::{LEAST_TURNS_AND_SWITCHES, PARTS, RunProgress, STUDENT, Separation};

    /// Returns a measurement with rates of 1 and 3 in turn and as many turns and switches per part.
    fn in_turn(turns_and_switches: f64) -> Separation {
        let mut separation = Separation::new(0.0, PARTS as f64);
        let progress = |turns_and_switches: f64| RunProgress { turns_and_switches, speed: 1.0 };
        separation.mark(0.0, progress(0.0));
        for part in 1..=PARTS {
            let rate: f64 = if part % 2 == 1 { 1.0 } else { 3.0 };
            separation.grow(
                part as f64,
                rate.exp(),
                false,
                progress(part as f64 * turns_and_switches),
            );
        }
        separation
    }

    /// The interval of ten blocks is that of the mean of ten numbers. With half of the turns, two
    /// parts are one block; the blocks have equal rates, but they are too few for a label. Without
    /// turns there is no interval.
    #[test]
    fn blocks_are_as_long_as_some_turns() {
        let many = in_turn(LEAST_TURNS_AND_SWITCHES).exponent().expect("measured");
        let doubt = STUDENT[8] * (10.0_f64 / 9.0 / 10.0).sqrt();
        let [low, high] = many.interval_1_s.expect("ten blocks");
        assert!((low - 2.0 + doubt).abs() < 1e-12 && (high - 2.0 - doubt).abs() < 1e-12);
        assert_eq!(many.blocks, 10);
        assert!(in_turn(LEAST_TURNS_AND_SWITCHES).is_irregular());

        let few = in_turn(LEAST_TURNS_AND_SWITCHES / 2.0).exponent().expect("measured");
        let [low, high] = few.interval_1_s.expect("five blocks");
        assert!((low - 2.0).abs() < 1e-12 && (high - 2.0).abs() < 1e-12);
        assert_eq!(few.blocks, 5);
        assert!(!in_turn(LEAST_TURNS_AND_SWITCHES / 2.0).is_irregular());

        let none = in_turn(0.0).exponent().expect("measured");
        assert_eq!((none.exponent_1_s, none.interval_1_s, none.blocks), (2.0, None, 1));
    }
}
