//! Means over the last part of a balancer's run.

use crate::model::{Balancer, State};
use crate::motion::Motion;

/// What is gathered for the means. It opens with the end of the first step that begins at or after
/// its start.
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

/// Means from the window's opening to now, non-dimensional.
pub(super) struct Means<const N: usize> {
    /// How far each ball has turned, rad.
    pub(super) turned: [f64; N],
    /// Mean speed of each ball.
    pub(super) speed: [f64; N],
    /// Root mean square of the table's displacement, over `L`.
    pub(super) amplitude: f64,
}

/// A time, and the square of the table's displacement then.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    time: f64,
    square: f64,
}

impl Moment {
    /// Where a motion is now.
    pub(super) fn of<const N: usize>(motion: &Motion<Balancer<N>, N>) -> Self {
        Moment::at(motion.time(), motion.state())
    }

    /// A state at a time.
    pub(super) fn at<const N: usize>(time: f64, state: &State<N>) -> Self {
        let [x, y] = state.position;
        Moment { time, square: x * x + y * y }
    }
}

/// The angles of a motion's balls, whole turns included.
pub(super) fn angles<const N: usize>(motion: &Motion<Balancer<N>, N>) -> [f64; N] {
    std::array::from_fn(|ball| motion.unwrapped_angle(ball))
}

impl<const N: usize> Window<N> {
    /// A window that starts at a time.
    pub(super) fn new(start: f64) -> Self {
        Window { start, opened: None }
    }

    /// Whether a step that began at a time is to be taken in.
    pub(super) fn takes(&self, began: f64) -> bool {
        began >= self.start
    }

    /// When it starts.
    pub(super) fn start(&self) -> f64 {
        self.start
    }

    /// Takes in a step from `before` to `now`, where the balls are at these angles, whole turns
    /// included.
    pub(super) fn take_in(
        &mut self,
        before: Moment,
        now: Moment,
        angles: impl FnOnce() -> [f64; N],
    ) {
        if !self.takes(before.time) {
            return;
        }
        match &mut self.opened {
            Some(opened) => {
                opened.square_time += 0.5 * (now.time - before.time) * (before.square + now.square);
            }
            None => {
                self.opened = Some(Opened { time: now.time, angles: angles(), square_time: 0.0 });
            }
        }
    }

    /// The means up to now; none where no step lies in the window.
    pub(super) fn means(&self, motion: &Motion<Balancer<N>, N>) -> Option<Means<N>> {
        let opened = self.opened.as_ref()?;
        let span = motion.time() - opened.time;
        let now = angles(motion);
        let turned: [f64; N] = std::array::from_fn(|ball| now[ball] - opened.angles[ball]);
        (span > 0.0).then(|| Means {
            turned,
            speed: turned.map(|angle| angle / span),
            amplitude: (opened.square_time / span).sqrt(),
        })
    }
}
