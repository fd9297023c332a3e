//! Convergence of errors with tolerance and band, against the closed forms of blocks on springs.
//!
//! Theory: the error estimate of DOP853 is proportional to the eighth power of the step, so that
//! steps are proportional to the eighth root of the tolerance, and the error of a method of order 8
//! to the tolerance itself (Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I,
//! sections II.4 and II.5). This holds only if no step crosses a switch. In the switch model the
//! half width of the band is an error in speed: the error of the time at which a block stops is
//! proportional to it, and that of the position to its square; on a belt, the residual speed of a
//! sticking block at break-away makes the errors of period and amplitude proportional to the band.

use crate::support::Block;
use stickslip::classification::simulate;
use stickslip::model::{Case, FrictionLaw, Method, Simulation, Start, Tolerance};

/// The relative errors of one computation.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Of the position at which a block on rigid ground stops, over `μ F_n / k`.
    pub rest_position: f64,
    /// Of the time at which it stops, over `1 / ω_n`.
    pub rest_time: f64,
    /// Of the period of a block on a belt.
    pub period: f64,
    /// Of its amplitude.
    pub amplitude: f64,
}

/// Returns the errors with this method, relative tolerance per step and band.
pub fn errors(method: Method, tolerance: f64, band: f64) -> Errors {
    let simulation = Simulation {
        method,
        band,
        end_time_s: 100.0,
        tolerance: Tolerance { relative: tolerance, absolute: 1e-2 * tolerance },
        ..Simulation::default()
    };
    let run = |block: &Block, start: [f64; 2]| {
        simulate(&Case { model: block.clone().into(), start: Start(start.to_vec()), simulation })
    };
    let block = Block::on_spring();
    let start = [0.0874, 0.31];
    let exact = block.stopping(start[0], start[1]).expect("dry friction");
    let outcome = run(&block, start);
    assert_eq!(outcome.evidence.name(), "rest_certified");
    let exact_position = exact.turning_points_m.last().expect("a stop");
    let rest_position =
        (outcome.position.as_ref().expect("known")[0] - exact_position).abs() / 0.01;
    let rest_time = (outcome.time_to_rest_s().expect("at rest") - exact.time_s).abs() * 10.0;
    let block = Block { friction: FrictionLaw::stribeck(0.2, 0.0), ..Block::on_belt() };
    let exact = block.stick_slip_cycle().expect("static above kinetic friction");
    let outcome = run(&block, [0.04, 0.0]);
    assert_eq!(outcome.evidence.name(), "closed_orbit");
    let relative = |found: Option<f64>, exact: f64| (found.expect("known") / exact - 1.0).abs();
    Errors {
        rest_position,
        rest_time,
        period: relative(outcome.evidence.period_s(), exact.period_s),
        amplitude: relative(outcome.amplitude_m, exact.amplitude_m),
    }
}

/// Returns the slope of a straight line through points in a plot with two logarithmic axes.
fn order(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let points: Vec<(f64, f64)> = points.map(|(x, y)| (x.log10(), y.log10())).collect();
    let count = points.len() as f64;
    let mean_x = points.iter().map(|point| point.0).sum::<f64>() / count;
    let mean_y = points.iter().map(|point| point.1).sum::<f64>() / count;
    let products = points.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum::<f64>();
    products / points.iter().map(|(x, _)| (x - mean_x).powi(2)).sum::<f64>()
}

fn powers_of_ten(range: std::ops::RangeInclusive<i32>) -> impl Iterator<Item = f64> {
    range.map(|power| 10.0_f64.powi(-power))
}

/// In the exact motion, errors are below a tenth of the tolerance, down to the width within which events are located.
/// That width is proportional to the tolerance between 1e-6 and 1e-9, and so are the errors.
#[test]
fn event_method_converges_with_the_tolerance() {
    let largest = |tolerance: f64| {
        let all = errors(Method::Event, tolerance, 1e-8);
        all.rest_position.max(all.rest_time).max(all.period).max(all.amplitude)
    };
    let all: Vec<(f64, f64)> =
        powers_of_ten(5..=11).map(|tolerance| (tolerance, largest(tolerance))).collect();
    for (tolerance, largest) in &all {
        assert!(*largest < 0.1 * tolerance + 3e-11, "{tolerance:e}: {largest:e}");
    }
    let order = order(all[1..=4].iter().copied());
    assert!((0.8..1.2).contains(&order), "{order} {all:?}");
}

/// In the switch model, errors of time, period and amplitude are proportional to the band, and
/// errors of the rest position to the square of the band, down to the slack of the conditions.
#[test]
fn switch_model_converges_with_the_band() {
    let all: Vec<(f64, Errors)> =
        powers_of_ten(3..=6).map(|band| (band, errors(Method::Switch, 1e-12, band))).collect();
    let order_of =
        |pick: fn(&Errors) -> f64| order(all.iter().map(|(band, all)| (*band, pick(all))));
    let orders =
        [order_of(|all| all.rest_time), order_of(|all| all.period), order_of(|all| all.amplitude)];
    assert!(orders.iter().all(|order| (order - 1.0).abs() < 0.05), "{orders:?}");
    let place = order(all[..3].iter().map(|(band, all)| (*band, all.rest_position)));
    assert!((place - 2.0).abs() < 0.05, "{place}");
    let finest = errors(Method::Switch, 1e-12, 1e-10);
    let floor = finest.period.max(finest.amplitude);
    assert!(floor < 10.0 * stickslip::motion::SLACK, "{finest:?}");
}
