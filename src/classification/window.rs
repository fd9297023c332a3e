//! Means over the last part of a balancer's run, from its exact start within a step and with the
//! table's motion inside of steps.

use crate::model::Balancer;
use crate::motion::Motion;

/// The part of the time at the end of a run over which means are taken.
pub(super) const WINDOW: f64 = 0.1;

/// Nodes and weights of the Gauss-Legendre rule of order 10 for the table's displacement in a part
/// of a step. In the longest steps the square of the displacement oscillates by 5 rad at its
/// highest frequency; there the rule is accurate to 4e-6, and to 2e-8 in steps of 3 rad.
pub(super) const NODES: [f64; 5] = [
    0.046_910_077_030_668_004,
    0.230_765_344_947_158_45,
    0.5,
    0.769_234_655_052_841_5,
    0.953_089_922_969_332,
];
const WEIGHTS: [f64; 5] = [
    0.118_463_442_528_094_54,
    0.239_314_335_249_683_23,
    0.284_444_444_444_444_44,
    0.239_314_335_249_683_23,
    0.118_463_442_528_094_54,
];

/// Sums for the means.
#[derive(Clone, Debug)]
pub(super) struct Window<const N: usize> {
    start: f64,
    opened: Option<Opened<N>>,
}

#[derive(Clone, Debug)]
struct Opened<const N: usize> {
    time: f64,
    angles: [f64; N],
    square_time: f64,
}

/// Means from the window's start to now, non-dimensional.
pub(super) struct Means<const N: usize> {
    /// The angle that each ball has turned, rad.
    pub(super) turned: [f64; N],
    /// Mean speed of each ball.
    pub(super) speed: [f64; N],
    /// Root mean square of the table's displacement, over `L`.
    pub(super) amplitude: f64,
}

/// A step that has been taken, with access to its interior.
pub(super) trait Taken<const N: usize> {
    /// Returns the start and the end time of the step.
    fn ends(&self) -> [f64; 2];

    /// Returns the balls' angles at a time after its start, including whole turns.
    fn angles(&mut self, after: f64) -> [f64; N];

    /// Returns the squares of the table's displacement at several times after its start, over `L`.
    fn squares(&mut self, after: [f64; NODES.len()]) -> [f64; NODES.len()];
}

impl<const N: usize> Window<N> {
    /// Creates a window that starts at a time.
    pub(super) fn new(start: f64) -> Self {
        Window { start, opened: None }
    }

    /// Returns the start of the window.
    pub(super) fn start(&self) -> f64 {
        self.start
    }

    /// Adds the part of a step that lies in the window.
    pub(super) fn take_in(&mut self, mut step: impl Taken<N>) {
        let [began, ended] = step.ends();
        let from = self.start.max(began);
        if ended <= from {
            return;
        }
        let opened = self.opened.get_or_insert_with(|| {
            let angles = step.angles(from - began);
            Opened { time: from, angles, square_time: 0.0 }
        });
        let length = ended - from;
        let squares = step.squares(NODES.map(|node| from - began + node * length));
        let mean: f64 = squares.iter().zip(WEIGHTS).map(|(square, weight)| weight * square).sum();
        opened.square_time += length * mean;
    }

    /// Returns the means up to now; `None` before the start of the window.
    pub(super) fn means(&self, motion: &Motion<Balancer<N>, N>) -> Option<Means<N>> {
        let opened = self.opened.as_ref()?;
        let span = motion.time() - opened.time;
        let turned: [f64; N] =
            std::array::from_fn(|ball| motion.unwrapped_angle(ball) - opened.angles[ball]);
        (span > 0.0).then(|| Means {
            turned,
            speed: turned.map(|angle| angle / span),
            amplitude: (opened.square_time / span).sqrt(),
        })
    }
}

/// The latest step of a motion, which began at a time.
pub(super) struct LatestStep<'m, 'b, const N: usize> {
    pub(super) motion: &'m mut Motion<'b, Balancer<N>, N>,
    pub(super) began: f64,
}

impl<const N: usize> Taken<N> for LatestStep<'_, '_, N> {
    fn ends(&self) -> [f64; 2] {
        [self.began, self.motion.time()]
    }

    fn angles(&mut self, after: f64) -> [f64; N] {
        let inside = self.motion.unwrapped_in_last_step(self.began + after);
        inside.unwrap_or_else(|| std::array::from_fn(|ball| self.motion.unwrapped_angle(ball)))
    }

    fn squares(&mut self, after: [f64; NODES.len()]) -> [f64; NODES.len()] {
        after.map(|after| {
            let inside = self.motion.within_last_step(self.began + after);
            let [x, y] = inside.unwrap_or(*self.motion.state()).position;
            x * x + y * y
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{NODES, WEIGHTS};

    /// The rule is exact for polynomials of degree 9, and not for degree 10.
    #[test]
    fn the_rule_is_exact_up_to_degree_9() {
        for degree in 0..=10 {
            let sum: f64 =
                NODES.iter().zip(WEIGHTS).map(|(node, weight)| weight * node.powi(degree)).sum();
            let error = (sum - 1.0 / f64::from(degree + 1)).abs();
            assert_eq!(error < 1e-15, degree <= 9, "{degree}: {error:e}");
        }
    }
}
