//! Irregular motion: neighbouring motions separate exponentially.
//!
//! A small displacement is carried along the motion by the linearised flow, through stick and slip,
//! and rescaled whenever it has grown (G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn,
//! Meccanica 15 (1980) 9, doi:10.1007/BF02128236; with saltation: P. C. Müller, Chaos Solitons
//! Fractals 5 (1995) 1671, doi:10.1016/0960-0779(94)00170-U). The mean rate of growth over a window
//! at the end of the run is the largest finite-time Lyapunov exponent.
//! Its confidence interval comes from the scatter of the rates in [`BATCHES`] equal parts of the
//! window.
//!
//! A motion counts as irregular if the interval is positive, and if in the second half of the
//! window
//!
//! - neighbours have separated by at least [`SEPARATED`]. This excludes growth by a power of time:
//!   a displacement along a family of motions (a ball that rests elsewhere, which changes the speed
//!   of another) grows in proportion to time; in the second half of a window that is a factor of 2,
//!   and for the third power of time a factor of 8;
//! - the motion has recurred often: at least [`COURSES`] turns of balls and switches. This excludes
//!   a slow passage by an unstable equilibrium, where neighbours separate only once.

use super::lane_step::LaneStep;
use super::outcome::LyapunovExponent;
use super::system_view::SystemView;
use crate::model::Components;

/// The part of the time at the end of a run over which separation is measured.
pub(super) const SEPARATION_WINDOW: f64 = 0.75;
/// Number of equal parts of the window.
const BATCHES: usize = 10;
/// Number of parts after which the measurement stops if neighbours have only converged: most
/// motions are regular, and a displacement costs as much as the motion itself.
const PILOT: usize = 4;
/// The two-sided 95 % points of Student's distribution for 4 to 10 parts (3 to 9 degrees of freedom).
const STUDENT: [f64; BATCHES - PILOT + 1] = [
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

/// Minimum number of turns of balls and switches in the second half of the window.
const COURSES: f64 = 20.0;

/// Measures how fast neighbours of a motion separate between two times.
#[derive(Clone, Debug)]
pub(super) struct Separation {
    start: f64,
    end: f64,
    /// Logarithm of the growth so far.
    growth: f64,
    /// The growth at the start and at the end of each batch.
    marks: Vec<Mark>,
    given_up: bool,
    /// Whether a switch was met by grazing, so that the displacement is undefined.
    grazed: bool,
}

#[derive(Clone, Copy, Debug)]
struct Mark {
    time: f64,
    growth: f64,
    /// Turns of balls and switches since the start of the run.
    courses: f64,
}

impl Separation {
    /// Creates a measurement from `start` to `end`.
    pub(super) fn new(start: f64, end: f64) -> Self {
        Separation { start, end, growth: 0.0, marks: Vec::new(), given_up: false, grazed: false }
    }

    /// Returns the start of the window.
    pub(super) fn start(&self) -> f64 {
        self.start
    }

    /// Returns whether displacements are measured at a time: the window has begun and the
    /// measurement has not stopped.
    pub(super) fn follows(&self, time: f64) -> bool {
        time > self.start && !self.given_up
    }

    /// Returns whether the measurement has begun.
    pub(super) fn has_begun(&self) -> bool {
        !self.marks.is_empty()
    }

    /// Begins at the end of the first step that extends into the window, where the displacement has
    /// the size 1. `courses` counts turns of balls and switches since the start.
    pub(super) fn begin(&mut self, time: f64, courses: f64) {
        self.mark(time, courses);
    }

    /// Adds the growth of the displacement since the last call.
    pub(super) fn grow(&mut self, time: f64, factor: f64, grazed: bool, courses: f64) {
        self.growth += factor.ln();
        self.grazed |= grazed;
        self.mark_if_due(time, courses);
        self.given_up |= !self.growth.is_finite();
    }

    /// Returns when the growth is due next.
    pub(super) fn next_mark(&self) -> f64 {
        (self.start + self.batch() * self.marks.len() as f64).min(self.end)
    }

    fn batch(&self) -> f64 {
        (self.end - self.start) / BATCHES as f64
    }

    fn mark_if_due(&mut self, time: f64, courses: f64) {
        if time >= self.start + self.batch() * self.marks.len() as f64 || time >= self.end {
            self.mark(time, courses);
            self.given_up = self.marks.len() == PILOT + 1 && self.growth < 0.0;
        }
    }

    fn mark(&mut self, time: f64, courses: f64) {
        self.marks.push(Mark { time, growth: self.growth, courses });
    }

    /// Returns the exponent, here per unit of non-dimensional time, with its interval and the
    /// length of the window, which is shorter if the measurement stopped early. `None` if it could
    /// not be measured, because a switch was met by grazing or there were too few steps.
    pub(super) fn exponent(&self) -> Option<LyapunovExponent> {
        let (first, last) = (self.marks.first()?, self.marks.last()?);
        if self.grazed || !last.growth.is_finite() || self.marks.len() <= PILOT {
            return None;
        }
        let rates: Vec<f64> = self
            .marks
            .windows(2)
            .map(|pair| (pair[1].growth - pair[0].growth) / (pair[1].time - pair[0].time))
            .collect();
        let window = last.time - first.time;
        let exponent = last.growth / window;
        let count = rates.len() as f64;
        let variance = rates.iter().map(|rate| (rate - exponent) * (rate - exponent)).sum::<f64>()
            / (count - 1.0);
        let doubt = STUDENT.get(rates.len() - PILOT)? * (variance / count).sqrt();
        Some(LyapunovExponent {
            exponent_1_s: exponent,
            interval_1_s: [exponent - doubt, exponent + doubt],
            window_s: window,
        })
    }

    /// Returns whether neighbours separate exponentially, according to the interval and the
    /// criteria above.
    pub(super) fn is_irregular(&self) -> bool {
        let Some(exponent) = self.exponent() else { return false };
        let (half, last) = (self.marks[self.marks.len() / 2], self.marks[self.marks.len() - 1]);
        !self.given_up
            && exponent.interval_1_s[0] > 0.0
            && last.growth - half.growth >= SEPARATED.ln()
            && last.courses - half.courses >= COURSES
    }
}

/// Returns the initial displacement, of size 1. All contacts are displaced equally: exchanging two of
/// them exchanges only the displacements. Balls that are exactly side by side stay so; the instability
/// of their orbit shows in the multipliers. (Displaced speeds would separate contacts in proportion to
/// time for a long period.)
pub(super) fn displacement(view: &SystemView) -> Components {
    let mut displaced = Components::from_elem(0.0, view.dimension());
    for contact in &view.contacts {
        displaced[contact.position] = 1.0 / (view.contacts.len() as f64).sqrt();
    }
    displaced
}

/// Returns the size of a displacement.
pub(super) fn size(view: &SystemView, displacement: &[f64]) -> f64 {
    let square = |components: &mut dyn Iterator<Item = usize>| {
        components.map(|place| displacement[place] * displacement[place]).sum::<f64>()
    };
    let (positions, velocities) = view.free.split_at(view.free.len() / 2);
    let contacts = &view.contacts;
    (square(&mut positions.iter().copied())
        + square(&mut velocities.iter().copied())
        + square(&mut contacts.iter().map(|contact| contact.position))
        + square(&mut contacts.iter().filter_map(|contact| contact.speed)))
    .sqrt()
}

/// Returns the number of turns of balls, in both directions, and switches since the start of a run.
pub(super) fn courses(step: &LaneStep) -> f64 {
    let LaneStep { group, lane, view } = *step;
    let (state, turns) = (group.state(lane), group.turns(lane));
    let balls = view.contacts.iter().zip(&turns).filter(|(contact, _)| contact.angular);
    let turned = balls
        .map(|(contact, turns)| (turns + state[contact.position] / std::f64::consts::TAU).abs());
    turned.sum::<f64>() + step.effort().switches as f64
}
