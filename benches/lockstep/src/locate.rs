//! Where in a step a condition fails, found by the length of the step: a lane in which one has failed
//! takes the same step again, shorter, until it ends where the condition has just failed. No dense
//! output is needed, and the state at the event has the full order of the method.

use crate::step::INNER;

/// Values and slopes in time of the four conditions (two of each ball) at a point of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    pub values: [f64; 4],
    pub slopes: [f64; 4],
}

/// An event is located when its condition is below zero by no more than this.
pub const WIDTH: f64 = 1e-9;
/// Aim for the middle of that.
const AIM: f64 = 0.5 * WIDTH;
const MOST_TRIALS: u32 = 60;

/// A search in progress: `low` and `high` are lengths of steps.
#[derive(Clone, Copy, Debug)]
pub enum Search {
    /// A look at where a condition may have dipped below zero.
    Dip,
    /// All conditions hold at `low`, one fails at `high`.
    Bracket { low: (f64, Conditions), high: (f64, Conditions), trials: u32 },
}

/// What to do with a step that has been tried.
#[derive(Clone, Copy, Debug)]
pub enum Verdict {
    /// It stands.
    Commit,
    /// It ends at an event.
    Event,
    /// Try another length.
    Retry(f64, Search),
    /// Not to be decided here.
    GiveUp,
}

/// Judges a step of `length` from `start` to `end`.
/// `inner` has what is known of the conditions at `INNER`, NaN where nothing is.
pub fn judge(
    search: Option<Search>,
    start: &Conditions,
    length: f64,
    end: &Conditions,
    inner: impl FnOnce() -> [Conditions; 3],
) -> Verdict {
    let fails = end.values.iter().any(|value| *value < 0.0);
    let first = !matches!(search, Some(Search::Bracket { .. }));
    let mut inner = Some(inner);
    let (low, high, trials) = match search {
        None | Some(Search::Dip) => {
            if !fails {
                let dip = if search.is_none() {
                    inner.take().and_then(|inner| first_dip(start, length, end, &inner()))
                } else {
                    None
                };
                return match dip {
                    Some(theta) => Verdict::Retry(theta * length, Search::Dip),
                    None => Verdict::Commit,
                };
            }
            ((0.0, *start), (length, *end), 0)
        }
        Some(Search::Bracket { low, trials, .. }) if fails => (low, (length, *end), trials),
        Some(Search::Bracket { high, trials, .. }) => ((length, *end), high, trials),
    };
    if fails && end.values.iter().all(|value| *value >= -WIDTH) {
        return Verdict::Event;
    }
    if trials > MOST_TRIALS || high.0 <= 1e-14 {
        return Verdict::GiveUp;
    }
    if high.0 - low.0 <= 1e-15 {
        // Nothing between: the failing end is taken, if that is where this trial was.
        return if fails { Verdict::Event } else { Verdict::GiveUp };
    }
    let span = high.0 - low.0;
    let mut theta: f64 = 1.0;
    let inner = if first { inner.map(|inner| inner()) } else { None };
    for i in 0..4 {
        if let Some(fall) =
            inner.as_ref().and_then(|inner| fall_inside(i, start, length, end, inner))
        {
            theta = theta.min(fall);
            continue;
        }
        let [from, to] = [low.1.values[i] + AIM, high.1.values[i] + AIM];
        if to < 0.0 {
            let cubic = Cubic::new([from, to], [low.1.slopes[i], high.1.slopes[i]], span);
            match cubic.fall() {
                Some(fall) => theta = theta.min(fall),
                None => return Verdict::GiveUp,
            }
        }
    }
    if trials > 8 || theta >= 1.0 {
        theta = 0.5;
    }
    let trial = low.0 + theta * span;
    Verdict::Retry(trial, Search::Bracket { low, high, trials: trials + 1 })
}

/// Where a condition falls through zero by the piece between two stages in which it does.
fn fall_inside(
    i: usize,
    start: &Conditions,
    length: f64,
    end: &Conditions,
    inner: &[Conditions; 3],
) -> Option<f64> {
    if inner[0].values[i].is_nan() || end.values[i] >= 0.0 {
        return None;
    }
    let points = [
        (0.0, start),
        (INNER[0], &inner[0]),
        (INNER[1], &inner[1]),
        (INNER[2], &inner[2]),
        (1.0, end),
    ];
    let pair = points.windows(2).find(|pair| pair[1].1.values[i] < 0.0)?;
    let ((t, from), (u, to)) = (pair[0], pair[1]);
    let span = (u - t) * length;
    let fall = Cubic::new(
        [from.values[i] + AIM, to.values[i] + AIM],
        [from.slopes[i], to.slopes[i]],
        span,
    )
    .fall()?;
    Some(t + fall * (u - t))
}

/// The least place of the first condition that seems to dip below zero in a step.
fn first_dip(
    start: &Conditions,
    length: f64,
    end: &Conditions,
    inner: &[Conditions; 3],
) -> Option<f64> {
    let piece = |i: usize, (t, from): (f64, &Conditions), (u, to): (f64, &Conditions)| {
        let span = (u - t) * length;
        let change = span * from.slopes[i].abs().max(to.slopes[i].abs());
        if from.values[i].min(to.values[i]) >= 0.5 * change {
            return None;
        }
        let dip =
            Cubic::new([from.values[i], to.values[i]], [from.slopes[i], to.slopes[i]], span).dip();
        dip.map(|theta| t + theta * (u - t))
    };
    let dip = |i: usize| {
        if inner[0].values[i].is_nan() {
            return piece(i, (0.0, start), (1.0, end));
        }
        let points = [
            (0.0, start),
            (INNER[0], &inner[0]),
            (INNER[1], &inner[1]),
            (INNER[2], &inner[2]),
            (1.0, end),
        ];
        points.windows(2).find_map(|pair| {
            piece(i, pair[0], pair[1]).or_else(|| (pair[1].1.values[i] < 0.0).then_some(pair[1].0))
        })
    };
    (0..4).filter_map(dip).min_by(f64::total_cmp)
}

/// A cubic polynomial on [0, 1] by its values and slopes at the ends.
struct Cubic([f64; 4]);

impl Cubic {
    fn new([a, b]: [f64; 2], slopes: [f64; 2], length: f64) -> Self {
        let [p, q] = slopes.map(|slope| slope * length);
        Cubic([a, p, 3.0 * (b - a) - 2.0 * p - q, 2.0 * (a - b) + p + q])
    }

    fn at(&self, t: f64) -> f64 {
        let [a, b, c, d] = self.0;
        ((d * t + c) * t + b) * t + a
    }

    fn slope(&self, t: f64) -> f64 {
        let [_, b, c, d] = self.0;
        (3.0 * d * t + 2.0 * c) * t + b
    }

    /// Where it is least in the inside, if it is below zero there.
    fn dip(&self) -> Option<f64> {
        let [_, b, c, d] = self.0;
        let discriminant = c * c - 3.0 * b * d;
        if discriminant <= 0.0 {
            return None;
        }
        let root = discriminant.sqrt();
        // The minimum is where the curvature 2c + 6dt = 2 root.
        let t = if c > 0.0 { -b / (c + root) } else { (root - c) / (3.0 * d) };
        (t > 1e-6 && t < 1.0 - 1e-6 && self.at(t) < 0.0).then_some(t)
    }

    /// Where it first falls through zero, its end being below.
    fn fall(&self) -> Option<f64> {
        let mut low = 0.0;
        let mut high = 1.0;
        if self.0[0] <= AIM {
            // It starts at zero and rises: the fall comes after.
            let mut t = 0.5;
            while self.at(t) <= 0.0 {
                high = t;
                t *= 0.5;
                if t < 1e-9 {
                    return None;
                }
            }
            low = t;
        }
        let mut t = self.0[0] / (self.0[0] - self.at(1.0));
        if !(t > low && t < high) {
            t = 0.5 * (low + high);
        }
        for _ in 0..40 {
            let value = self.at(t);
            if value > 0.0 {
                low = t;
            } else {
                high = t;
            }
            let newton = t - value / self.slope(t);
            if (newton - t).abs() < 1e-9 * t && newton > 0.0 && newton < 1.0 {
                return Some(newton);
            }
            t = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        }
        Some(t)
    }
}
