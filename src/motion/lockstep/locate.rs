//! Where in a step a condition fails, found by the length of the step: a lane in which one has failed
//! takes the same step again, shorter, until it ends where the condition has just failed. No dense
//! output is needed, and the state at the event has the full order of the method.

/// Values and slopes in time of the conditions of all balls at a point of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Conditions<const N: usize> {
    pub(super) values: [[f64; 3]; N],
    pub(super) slopes: [[f64; 3]; N],
}

/// An event is located when its condition is below zero by no more than the width: a part of the relative
/// tolerance, within these bounds. It also keeps an event that is met to rounding only from being met
/// twice. The search aims for the middle of it.
const WIDTH_OVER_TOLERANCE: f64 = 1e-3;
const WIDTHS: (f64, f64) = (1e-12, 1e-9);

/// The width within which events are located.
pub(super) fn width(relative_tolerance: f64) -> f64 {
    (WIDTH_OVER_TOLERANCE * relative_tolerance).clamp(WIDTHS.0, WIDTHS.1)
}

const MOST_TRIALS: u32 = 80;
/// Trials that follow the curve; the others halve.
const CURVED_TRIALS: u32 = 10;

/// A search in progress: `low` and `high` are lengths of steps.
#[derive(Clone, Copy, Debug)]
pub(super) enum Search<const N: usize> {
    /// A look at where a condition may have dipped below zero.
    Dip,
    /// All conditions hold at `low`, one fails at `high`.
    Bracket { low: (f64, Conditions<N>), high: (f64, Conditions<N>), trials: u32 },
}

/// What to do with a step that has been tried.
#[derive(Clone, Copy, Debug)]
pub(super) enum Verdict<const N: usize> {
    /// It stands.
    Commit,
    /// It ends at an event: this ball's condition with this number has failed.
    Event(usize, usize),
    /// Try another length.
    Retry(f64, Search<N>),
    /// Not to be decided here.
    GiveUp,
}

/// Judges a step of `length` from `start` to `end`.
pub(super) fn judge<const N: usize>(
    search: Option<&Search<N>>,
    width: f64,
    start: &Conditions<N>,
    length: f64,
    end: &Conditions<N>,
) -> Verdict<N> {
    let aim = 0.5 * width;
    let fails = end.values.iter().flatten().any(|value| *value < 0.0);
    let (low, high, trials) = match search {
        None | Some(Search::Dip) => {
            if !fails {
                let dip = if search.is_none() { first_dip(start, length, end) } else { None };
                return match dip {
                    Some(theta) => Verdict::Retry(theta * length, Search::Dip),
                    None => Verdict::Commit,
                };
            }
            ((0.0, *start), (length, *end), 0)
        }
        Some(Search::Bracket { low, trials, .. }) if fails => (*low, (length, *end), *trials),
        Some(Search::Bracket { high, trials, .. }) => ((length, *end), *high, *trials),
    };
    if fails && end.values.iter().flatten().all(|value| *value >= -width) {
        return lowest(end);
    }
    if trials > MOST_TRIALS {
        return Verdict::GiveUp;
    }
    let span = high.0 - low.0;
    if span <= 1e-15 {
        // Nothing between: the failing end is taken, if that is where this trial was.
        return if fails { lowest(end) } else { Verdict::GiveUp };
    }
    let mut theta: f64 = 1.0;
    for ball in 0..N {
        for which in 0..3 {
            let [from, to] = [low.1, high.1].map(|at| at.values[ball][which] + aim);
            if to < 0.0 {
                let slopes = [low.1, high.1].map(|at| at.slopes[ball][which]);
                match Cubic::new([from, to], slopes, span).fall(aim) {
                    Some(fall) => theta = theta.min(fall),
                    None => return Verdict::GiveUp,
                }
            }
        }
    }
    if trials > CURVED_TRIALS || theta >= 1.0 {
        theta = 0.5;
    }
    let trial = low.0 + theta * span;
    Verdict::Retry(trial, Search::Bracket { low, high, trials: trials + 1 })
}

/// The condition that has failed most.
fn lowest<const N: usize>(end: &Conditions<N>) -> Verdict<N> {
    let (mut ball, mut which) = (0, 0);
    for i in 0..N {
        for j in 0..3 {
            if end.values[i][j] < end.values[ball][which] {
                (ball, which) = (i, j);
            }
        }
    }
    Verdict::Event(ball, which)
}

/// The least place of the first condition that seems to dip below zero in a step.
fn first_dip<const N: usize>(
    start: &Conditions<N>,
    length: f64,
    end: &Conditions<N>,
) -> Option<f64> {
    let mut first: Option<f64> = None;
    for ball in 0..N {
        for which in 0..3 {
            let values = [start, end].map(|at| at.values[ball][which]);
            let slopes = [start, end].map(|at| at.slopes[ball][which]);
            let change = length * slopes[0].abs().max(slopes[1].abs());
            if values[0].min(values[1]) >= 0.5 * change {
                continue;
            }
            if let Some(dip) = Cubic::new(values, slopes, length).dip()
                && first.is_none_or(|first| dip < first)
            {
                first = Some(dip);
            }
        }
    }
    first
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

    /// Where it first falls through zero, its end being below; a start up to `aim` counts as on it.
    fn fall(&self, aim: f64) -> Option<f64> {
        const MOST_HALVINGS: u32 = 30;
        let (mut low, mut high) = (0.0, 1.0);
        if self.0[0] <= aim {
            // It starts on the boundary. If it rises, the fall comes after; if not, at once.
            let rise = (1..MOST_HALVINGS)
                .map(|halvings| 0.5_f64.powi(halvings as i32))
                .find(|t| self.at(*t) > aim.max(2.0 * self.0[0]));
            match rise {
                Some(t) => (low, high) = (t, (2.0 * t).min(1.0)),
                None if self.0[0] > 0.0 && self.0[1] < 0.0 => {
                    return Some((-self.0[0] / self.0[1]).min(1.0));
                }
                None if self.0[0] <= 0.0 => return None,
                None => {}
            }
            while high < 1.0 && self.at(high) > 0.0 {
                (low, high) = (high, (2.0 * high).min(1.0));
            }
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

#[cfg(test)]
mod tests {
    use super::{Conditions, Search, Verdict, judge, width};

    /// Locates the fall of a function of time in a step of length 1 as the lanes do, in how many
    /// trials; `None` where the step stands.
    fn locate(f: impl Fn(f64) -> (f64, f64)) -> Option<(f64, u32)> {
        let at = |time: f64| {
            let (value, slope) = f(time);
            Conditions { values: [[value, 1.0, 1.0]], slopes: [[slope, 0.0, 0.0]] }
        };
        let (mut search, mut length, mut tried): (Option<Search<1>>, f64, u32) = (None, 1.0, 0);
        loop {
            tried += 1;
            match judge(search.as_ref(), width(1e-8), &at(0.0), length, &at(length)) {
                Verdict::Commit if length == 1.0 => return None,
                // A look at a dip showed nothing: the step goes on from there.
                Verdict::Commit => return None,
                Verdict::Event(ball, which) => {
                    assert_eq!((ball, which), (0, 0));
                    return Some((length, tried));
                }
                Verdict::Retry(trial, next) => (length, search) = (trial, Some(next)),
                Verdict::GiveUp => panic!("given up after {tried}"),
            }
        }
    }

    #[test]
    fn falls_are_located() {
        let fall = |t: f64| (0.3 - t, -1.0);
        let (time, tried) = locate(fall).unwrap();
        assert!((time - 0.3).abs() < 1e-11 && tried <= 2, "{time} {tried}");

        // A sine that starts at zero, rises and falls.
        let hump = |t: f64| ((4.0 * t).sin(), 4.0 * (4.0 * t).cos());
        let (time, tried) = locate(hump).unwrap();
        let expected = std::f64::consts::PI / 4.0;
        assert!((time - expected).abs() < 1e-11 && tried <= 6, "{time} {tried}");

        // A dip between two places at which all is well.
        let dip = |t: f64| ((t - 0.4) * (t - 0.4) - 1e-4, 2.0 * (t - 0.4));
        let (time, tried) = locate(dip).unwrap();
        assert!((time - 0.39).abs() < 1e-9 && tried <= 8, "{time} {tried}");
        let no_dip = |t: f64| ((t - 0.4) * (t - 0.4) + 1e-4, 2.0 * (t - 0.4));
        assert_eq!(locate(no_dip), None);

        // On the boundary and on the way out: at once, but by more than rounding.
        let out = |t: f64| (-1e-15 - 0.1 * t, -0.1);
        let (time, _) = locate(out).unwrap();
        assert!(time > 1e-12 && time < 1e-9, "{time}");
        // Beyond it by rounding only, for ever: at the step's end.
        let hovering = |t: f64| (-1e-14 * t, -1e-14);
        assert_eq!(locate(hovering).unwrap().0, 1.0);
    }
}
