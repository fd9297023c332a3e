//! Numbering of the points and runs of a study.

use crate::study::error::{StudyError, describe_number};
use crate::study::file::values::MAX_COUNT;
use crate::study::plan::base::Base;
use crate::study::plan::precision::{Precision, Sampling};
use crate::study::plan::sweep::{Block, PointSampling, RunNumbers, product};
use crate::study::resolve::sampling::ResolvedDesign;
use crate::study::resolve::sweep::ResolvedBlock;
use crate::study::resolve::uncertain_sampling::UncertainSampling;
use crate::study::sampling::initial_box::InitialBox;
use crate::study::sampling::sampling_design::Design;

/// What determines the sampling of a point besides its design.
pub(in crate::study) struct PointSettings<'a> {
    /// The model.
    pub base: &'a Base,
    /// The ranges of all coordinates.
    pub start_box: &'a InitialBox,
    /// The seed of the study.
    pub seed: u64,
    /// The requested precision.
    pub precision: Option<&'a Precision>,
    /// The sampling of the uncertain parameters.
    pub uncertain: &'a UncertainSampling<'a>,
}

/// Numbers the points and runs of all blocks.
///
/// # Errors
/// Returns an error if there are too many runs, if a precision requires a design that cannot be
/// enlarged, or if the design of the uncertain parameters is impossible.
pub(in crate::study) fn number_runs(
    resolved: Vec<ResolvedBlock>,
    designs: &[ResolvedDesign<'_>],
    settings: &PointSettings<'_>,
) -> Result<Vec<Block>, StudyError> {
    let mut blocks = Vec::with_capacity(resolved.len());
    let (mut first_point, mut first_run) = (0_u64, 0_u64);
    for (block, written) in resolved.into_iter().zip(designs) {
        let points = product(&block.listing.factors(&block.columns), MAX_COUNT);
        let (pattern, repeats) = block.numbers_of_balls(points.unwrap_or(1), settings.base.balls());
        let mut balls: Vec<usize> = pattern.iter().map(|(_, balls)| *balls).collect();
        balls.sort_unstable();
        balls.dedup();
        let mut samplings = Vec::with_capacity(balls.len());
        let mut too_many = None;
        for number in &balls {
            match settings.sampling(written, *number)? {
                Ok(sampling) => samplings.push(sampling),
                Err(large) => too_many = Some(f64::max(large, too_many.unwrap_or(0.0))),
            }
        }
        let runs_of: Vec<u64> = samplings.iter().map(|point| point.sampling.most).collect();
        let most = too_many.unwrap_or(runs_of.iter().copied().max().unwrap_or(0) as f64);
        let kind = |balls_of_point: usize| balls.partition_point(|other| *other < balls_of_point);
        let pattern: Vec<(u64, usize)> =
            pattern.into_iter().map(|(points, balls)| (points, kind(balls))).collect();
        let numbers = match (points, too_many) {
            (Ok(_), None) => RunNumbers::new(&pattern, repeats, &runs_of, MAX_COUNT - first_run),
            _ => Err(to_float(points) * most),
        };
        let numbers = numbers.map_err(|all| {
            let samples = if balls.len() > 1 { "at most " } else { "" };
            let found = format!(
                "{:e} runs (points: {}, samples at each: {samples}{})",
                first_run as f64 + all,
                describe_number(to_float(points)),
                describe_number(most),
            );
            written.path.wrong_value("too many runs", found, "at most 1e15 runs")
        })?;
        let ResolvedBlock { listing, columns, .. } = block;
        let block = Block { listing, columns, samplings, numbers, first_point, first_run };
        (first_point, first_run) = (block.end_point(), block.end_run());
        blocks.push(block);
    }
    Ok(blocks)
}

impl PointSettings<'_> {
    /// Returns the sampling of a point with this number of balls, or the approximate number of samples if there are too
    /// many.
    fn sampling(
        &self,
        written: &ResolvedDesign<'_>,
        balls: usize,
    ) -> Result<Result<PointSampling, f64>, StudyError> {
        let start_box = self.start_box.of(&self.base.with_balls([balls; 2]).model);
        let layout = written.layout_of(&start_box.axes);
        let design = Design::new(layout, &start_box, self.seed);
        let samples = match product(&design.factors(), MAX_COUNT) {
            Ok(samples) => samples,
            Err(large) => return Ok(Err(large)),
        };
        let sampling = Sampling::new(&design, samples, self.precision, self.uncertain.longest())
            .map_err(|fault| written.path.key(design.layout.kind()).refuse_key(fault))?;
        let uncertain_design = self.uncertain.of_block(&design, sampling, self.precision)?;
        Ok(Ok(PointSampling { design, uncertain_design, sampling }))
    }
}

fn to_float(count: Result<u64, f64>) -> f64 {
    count.map_or_else(|large| large, |count| count as f64)
}
