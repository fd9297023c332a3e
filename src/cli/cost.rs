//! The cost of a study: an estimate for runs that do not end early, and an upper bound.

use serde::Serialize;

use crate::classification::{
    has_tuned_kernel, most_steps_of_a_run, most_steps_of_any_run, seconds_per_step,
};
use crate::model::{Model, Simulation};
use crate::study::{Plan, Study};

/// The largest number of points that are evaluated; larger sweeps are sampled.
const MOST_POINTS: u64 = 10_000;

/// The cost of all runs of a study; audited runs count twice.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Cost {
    /// Estimated number of steps if no run ended before its latest end time.
    pub(super) steps: f64,
    /// Seconds on one core for `steps`.
    pub(super) core_seconds: f64,
    /// Upper bound of the number of steps, from the step limit of each run.
    pub(super) most_steps: f64,
    /// Seconds on one core for `most_steps`.
    pub(super) most_core_seconds: f64,
}

impl Cost {
    /// Estimates the cost of a study.
    pub(super) fn of(study: &Study) -> Cost {
        Cost::with(study, false)
    }

    /// Estimates the cost of one design, as `evaluate` and `optimize` compute it: the first sample at each point,
    /// without an audit. The estimate is the mean over the possible numbers of balls, and the bound is the largest of
    /// their bounds.
    pub(super) fn of_a_design(study: &Study) -> Cost {
        let plans = study.by_number_of_balls();
        let all: Vec<Cost> = plans.iter().map(|plan| Cost::with(plan, true)).collect();
        let count = all.len() as f64;
        let total = all.into_iter().fold(Cost::default(), |sum, cost| Cost {
            steps: sum.steps + cost.steps / count,
            core_seconds: sum.core_seconds + cost.core_seconds / count,
            most_steps: sum.most_steps.max(cost.most_steps),
            most_core_seconds: sum.most_core_seconds.max(cost.most_core_seconds),
        });
        // An estimate of few balls never exceeds a bound of many.
        Cost { core_seconds: total.core_seconds.min(total.most_core_seconds), ..total }
    }

    /// Returns the cost of several times as many runs.
    pub(super) fn times(self, factor: f64) -> Cost {
        Cost {
            steps: factor * self.steps,
            core_seconds: factor * self.core_seconds,
            most_steps: factor * self.most_steps,
            most_core_seconds: factor * self.most_core_seconds,
        }
    }

    /// Returns the estimate and the upper bound in words.
    pub(super) fn in_words(&self) -> String {
        let estimate = match duration(self.core_seconds) {
            Some(duration) => format!("about {duration}"),
            None => "more than 100 years".to_owned(),
        };
        let bound = match duration(self.most_core_seconds) {
            Some(duration) => format!("at most {duration}, if every run reaches its step limit"),
            None => "no bound below 100 years".to_owned(),
        };
        format!(
            "{estimate} on one core, if every run lasts to its end (usually much less); {bound}"
        )
    }

    /// `of_a_design` says that the runs are those of a design, without an audit and with other parameters than the study.
    fn with(plan: &Plan, of_a_design: bool) -> Cost {
        let points = plan.point_count();
        let stride = points.div_ceil(MOST_POINTS).max(1);
        // Uncertain parameters and points outside the sample are unknown.
        let all_known = plan.uncertain().is_empty() && stride == 1 && !of_a_design;
        let (mut cost, mut runs) = (Cost::default(), 0.0);
        for number in (0..points).step_by(usize::try_from(stride).unwrap_or(usize::MAX)) {
            let point = plan.point(number);
            let of_point = if of_a_design { point.sampling.first } else { point.sampling.most };
            runs += of_point as f64;
            let audit = plan.audit().filter(|_| !of_a_design).map(|audit| audit.fraction);
            cost.add(plan.simulation(), audit, point.model(), of_point, all_known);
        }
        let of_study = if of_a_design { plan.least_run_count() } else { plan.run_count() };
        let all = of_study as f64 / f64::max(runs, 1.0);
        cost.times(all)
    }

    /// Adds `runs` runs of a model; `known` says that all of them have exactly its parameters.
    fn add(
        &mut self,
        simulation: &Simulation,
        audit_fraction: Option<f64>,
        model: &Model,
        runs: u64,
        known: bool,
    ) {
        // A run that is continued to a later end time restarts before the first end time.
        let times = if simulation.extend.is_some() { 2.0 } else { 1.0 };
        let of_a_run = |simulation: &Simulation| {
            let bound = if known { most_steps_of_a_run(model, simulation) } else { None };
            let most = bound.unwrap_or_else(|| most_steps_of_any_run(model));
            let most = times * most as f64;
            let corners = corners(model, simulation).min(most);
            [steps_to_the_end(model, simulation).min(most - corners), corners, most]
        };
        let [mut steps, mut corners, mut most_steps] = of_a_run(simulation);
        if let Some(fraction) = audit_fraction {
            let [again, corners_again, most_again] = of_a_run(&simulation.counter_check());
            // In the worst case all runs are audited.
            steps += fraction * again;
            corners += fraction * corners_again;
            most_steps += most_again;
        }
        let [steps, corners, most_steps] =
            [steps, corners, most_steps].map(|number| number * runs as f64);
        let most_core_seconds = most_steps * seconds_per_step(model);
        // To end a step and to begin another stage.
        let per_corner = times_longer(model) * (6e-6 + 1.5e-6 * model.contacts() as f64);
        let core_seconds = steps * usual_seconds_per_step(model) + corners * per_corner;
        self.steps += steps + corners;
        self.core_seconds += core_seconds.min(most_core_seconds);
        self.most_steps += most_steps;
        self.most_core_seconds += most_core_seconds;
    }
}

/// Estimates the steps of a run that lasts until its latest end time. The estimate assumes that every ball sticks
/// twice and slips twice per turn, as balls do where the damping is weak.
///
/// The constants hold at a relative tolerance of 1e-8. At a stricter tolerance, the number of steps grows by the
/// sixteenth root of the ratio of the tolerances, because the power series have the order 16.
fn steps_to_the_end(model: &Model, simulation: &Simulation) -> f64 {
    let natural = model.natural_frequency_rad_s();
    let [_, latest_end_time_s] = simulation.end_times_s();
    let strictness = 1e-8 / simulation.tolerance.relative;
    let tuned = match model.ball_balancer() {
        Some(machine) => {
            let speed = machine.speed_rad_s.abs() / natural;
            0.6 * (1.0 + speed) + 0.5 * model.contacts() as f64 * speed
        }
        None => 0.6 * model.system().map_or(0.0, |system| system.fastest_rate()),
    };
    // The general kernel takes shorter steps, and friction that depends on speed bends the motion at every switch.
    let steps = if has_tuned_kernel(model) { tuned } else { 1.5 * tuned };
    let steps = steps * strictness.max(1.0).powf(1.0 / 16.0);
    latest_end_time_s * natural * steps.max(model.damping_rate() / STABLE)
}

/// Returns the number of stages after the first one: each ends a step.
fn corners(model: &Model, simulation: &Simulation) -> f64 {
    let [_, end_time_s] = simulation.end_times_s();
    model.stage_begins_s(end_time_s).len() as f64 - 1.0
}

/// Returns the time of a step of balls that may touch, over that of balls that may not, if they touch half of the time.
fn times_longer(model: &Model) -> f64 {
    let touch = model.ball_balancer().is_some_and(|machine| machine.contact.is_some());
    if touch { 1.5 } else { 1.0 }
}

/// Returns the seconds per step on a core of the year 2024 with vectors of four numbers if all lanes are in use.
fn usual_seconds_per_step(model: &Model) -> f64 {
    let contacts = model.contacts() as f64;
    let tuned = 0.25e-6 * contacts * (1.0 + contacts / 20.0);
    let step = if has_tuned_kernel(model) { tuned } else { 3.4 * tuned };
    times_longer(model) * step
}

/// The largest product of step and damping rate at which the integrator is stable: about the length of the
/// stability region of Taylor's method of order 16 on the negative real axis.
const STABLE: f64 = 6.0;

const HUNDRED_YEARS_S: f64 = 100.0 * 365.25 * 86_400.0;

/// Returns a duration in words; `None` above a hundred years.
fn duration(seconds: f64) -> Option<String> {
    Some(match seconds {
        s if s < 1.0 => "a second".to_owned(),
        s if s < 120.0 => format!("{s:.0} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.0} h", s / 3600.0),
        s if s < 2.0 * 365.25 * 86_400.0 => format!("{:.0} days", s / 86_400.0),
        s if s < HUNDRED_YEARS_S => format!("{:.0} years", s / (365.25 * 86_400.0)),
        _ => return None,
    })
}
