//! Computes the runs of designs and their responses, of single designs or of all designs of a table, and flags abrupt changes of
//! label fractions between these.

use std::borrow::Cow;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use super::discontinuity::discontinuous;
use crate::analysis::{Estimate, LabelCounts};
use crate::classification::Label;
use crate::engine::WorkerPool;
use crate::study::{DesignValue, ParameterValue, Plan, Response, Study};
use crate::table::{ResponseSamples, RunRecord};

/// The responses of a design at one point of the sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Number of the design, from zero in the order of requests.
    pub design: u64,
    /// One value per variable of the study.
    pub values: Vec<DesignValue>,
    /// Number of the point.
    pub point_id: u64,
    /// One value per swept parameter.
    pub swept: Vec<ParameterValue>,
    /// One estimate per response of the study.
    pub estimates: Vec<Estimate>,
    /// Runs per label.
    pub counts: LabelCounts,
    /// Whether label fractions differ abruptly from those of a nearest other design; `None` if the designs were not
    /// compared.
    pub discontinuous: Option<bool>,
}

/// A design to evaluate.
pub struct DesignToEvaluate<'a> {
    /// Number of the design.
    pub number: u64,
    /// One value per variable of the study.
    pub values: &'a [DesignValue],
    /// The plan with the variables set to `values`, or several such plans with different master seeds, whose runs are
    /// pooled.
    pub plans: Vec<Cow<'a, Plan>>,
}

impl DesignToEvaluate<'_> {
    fn run_count(&self) -> u64 {
        self.plans.iter().map(|plan| plan.run_count()).sum()
    }
}

/// The number of runs in one queue, unless a single point has more; it bounds the memory.
const RUNS_PER_QUEUE: u64 = 4096;

/// Computes designs at all points of the sweep, and calls `each` with a design and its answers in the order of the
/// designs. Calls `finished` for each run. Several designs are in one queue if one has few runs. Returns false if
/// `stop` became true before all designs were computed.
///
/// # Errors
/// Returns the first error of `designs` or of `each`; no further design is begun after it.
pub fn respond_in_order<'a, E>(
    workers: &WorkerPool,
    responses: &[Response],
    designs: impl IntoIterator<Item = Result<DesignToEvaluate<'a>, E>>,
    stop: &AtomicBool,
    finished: &(dyn Fn(Label) + Sync),
    mut each: impl FnMut(&DesignToEvaluate, Vec<Answer>) -> Result<(), E>,
) -> Result<bool, E> {
    let mut designs = designs.into_iter().peekable();
    let (mut group, mut runs) = (Vec::new(), 0);
    while let Some(design) = designs.next() {
        let design = design?;
        runs += design.run_count();
        group.push(design);
        if runs < RUNS_PER_QUEUE && designs.peek().is_some() {
            continue;
        }
        let Some(answers) = answers(workers, responses, &group, stop, finished) else {
            return Ok(false);
        };
        for (design, answers) in group.drain(..).zip(answers) {
            each(&design, answers)?;
        }
        runs = 0;
    }
    Ok(true)
}

/// Computes a design at all points of the sweep. Calls `finished` for each run. Returns `None` if `stop` became true.
pub fn respond(
    workers: &WorkerPool,
    responses: &[Response],
    design: DesignToEvaluate,
    stop: &AtomicBool,
    finished: &(dyn Fn(Label) + Sync),
) -> Option<Vec<Answer>> {
    answers(workers, responses, &[design], stop, finished)?.pop()
}

/// The runs of a design at one point in one of its plans.
struct PointOfDesign<'a> {
    design: usize,
    plan: &'a Plan,
    point_id: u64,
    /// Whether the design has no further runs at this point.
    last: bool,
}

/// Returns the answers of each design, one per point; `None` if `stop` became true.
fn answers(
    workers: &WorkerPool,
    responses: &[Response],
    designs: &[DesignToEvaluate],
    stop: &AtomicBool,
    finished: &(dyn Fn(Label) + Sync),
) -> Option<Vec<Vec<Answer>>> {
    let mut all: Vec<PointOfDesign> = Vec::new();
    for (index, design) in designs.iter().enumerate() {
        for point_id in 0..design.plans.first().map_or(0, |plan| plan.point_count()) {
            let of_point = |plan| PointOfDesign { design: index, plan, point_id, last: false };
            all.extend(design.plans.iter().map(|plan| of_point(plan)));
            all.last_mut()?.last = true;
        }
    }
    let mut answers = vec![Vec::new(); designs.len()];
    let mut pooled: Vec<RunRecord> = Vec::new();
    let mut rest = all.as_slice();
    while !rest.is_empty() {
        let (queue, later) = rest.split_at(queue_length(rest));
        rest = later;
        let points: Vec<(&Plan, u64)> = queue.iter().map(|job| (job.plan, job.point_id)).collect();
        for (job, runs) in queue.iter().zip(workers.sample(&points, stop, finished)?) {
            pooled.extend(runs);
            if job.last {
                let design = designs.get(job.design)?;
                let answer = answer(design, responses, job, &pooled);
                answers.get_mut(job.design)?.push(answer);
                pooled.clear();
            }
        }
    }
    Some(answers)
}

/// Returns how many of these points are in one queue; at least one.
fn queue_length(points: &[PointOfDesign]) -> usize {
    let mut runs = 0;
    let fits = |job: &&PointOfDesign| {
        runs += job.plan.point(job.point_id).sampling.first;
        runs <= RUNS_PER_QUEUE
    };
    points.iter().take_while(fits).count().max(1)
}

/// Returns the answer of a design at a point from its runs there.
fn answer(
    design: &DesignToEvaluate,
    responses: &[Response],
    at: &PointOfDesign,
    runs: &[RunRecord],
) -> Answer {
    let point = at.plan.point(at.point_id);
    let mut samples = ResponseSamples::new(responses, point.cells);
    let mut counts = LabelCounts::default();
    for run in runs {
        samples.add(run);
        counts.add(run.outcome.label());
    }
    Answer {
        design: design.number,
        values: design.values.to_vec(),
        point_id: at.point_id,
        swept: point.swept.clone(),
        estimates: samples.estimates(),
        counts,
        discontinuous: None,
    }
}

/// Checks that a study has `design` and `responses`; `file` is its name in messages.
///
/// # Errors
/// Returns what the study lacks, or what it may not have.
pub fn check_answerable(study: &Study, file: &Path) -> Result<(), String> {
    let file = file.display();
    if study.responses().is_empty() {
        let allowed = "a response in the study, such as responses: {vibration: {amplitude_mean: {relative: true}}}";
        return Err(format!("{file}: `responses` is missing\n  allowed: {allowed}"));
    }
    if study.variables().is_empty() {
        let allowed =
            "a variable in the study, such as design: {speed_rad_s: {from: -260, to: -180}}";
        return Err(format!("{file}: `design` is missing\n  allowed: {allowed}"));
    }
    if study.precision().is_some() {
        let allowed = "a study without `precision`, so that all designs have the same runs";
        return Err(format!(
            "{file}: designs would have different numbers of runs\n  found:   `precision`\n  allowed: {allowed}"
        ));
    }
    Ok(())
}

/// Returns the number of runs of all these designs together.
///
/// # Errors
/// Returns the first design whose values are inconsistent.
pub fn run_count(study: &Study, designs: &[Vec<DesignValue>]) -> Result<u64, String> {
    designs.iter().map(|values| Ok(study.set(values)?.run_count())).sum()
}

/// Returns the answers for all designs, in order, compared with their neighbours; `None` if `stop` became true. Calls
/// `finished` for each run.
///
/// # Errors
/// Returns the first design whose values are inconsistent.
pub fn respond_to_all(
    workers: &WorkerPool,
    study: &Study,
    designs: &[Vec<DesignValue>],
    stop: &AtomicBool,
    finished: &(dyn Fn(Label) + Sync),
) -> Result<Option<Vec<Answer>>, String> {
    let mut answers: Vec<Answer> = Vec::new();
    let all = (0..).zip(designs).map(|(number, values)| {
        let plans = vec![Cow::Owned(study.set(values)?)];
        Ok::<_, String>(DesignToEvaluate { number, values, plans })
    });
    let complete = respond_in_order(workers, study.responses(), all, stop, finished, |_, more| {
        answers.extend(more);
        Ok(())
    })?;
    if !complete {
        return Ok(None);
    }
    flag(study, designs, &mut answers);
    Ok(Some(answers))
}

/// Compares designs with their neighbours, point by point.
fn flag(study: &Study, designs: &[Vec<DesignValue>], answers: &mut [Answer]) {
    let scaled: Vec<Vec<f64>> = designs.iter().map(|values| study.scaled(values)).collect();
    for point_id in 0..study.point_count() {
        let at_point = |answer: &&mut Answer| answer.point_id == point_id;
        let counts: Vec<LabelCounts> =
            answers.iter_mut().filter(at_point).map(|answer| answer.counts).collect();
        let flags = discontinuous(&scaled, &counts);
        for (answer, flag) in answers.iter_mut().filter(at_point).zip(flags) {
            answer.discontinuous = flag;
        }
    }
}
