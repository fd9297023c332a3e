//! Numbering of the points and runs of a study.

use crate::study::error::{Fault, StudyError};
use crate::study::file::values::MAX_COUNT;
use crate::study::file::yaml_tree::describe_number;
use crate::study::plan::precision::{Precision, Sampling};
use crate::study::plan::sweep::{Block, product};
use crate::study::resolve::sampling::ResolvedDesign;
use crate::study::resolve::sweep::ResolvedBlock;
use crate::study::resolve::uncertain_sampling::UncertainSampling;
use crate::study::sampling::initial_box::InitialBox;
use crate::study::sampling::sampling_design::Design;

/// Numbers the points and runs of all blocks.
///
/// # Errors
/// Returns an error if there are too many runs, if a precision requires a design that cannot be
/// enlarged, or if the design of the uncertain parameters is impossible.
pub(in crate::study) fn number_runs(
    resolved: Vec<ResolvedBlock>,
    designs: &[ResolvedDesign<'_>],
    start_box: &InitialBox,
    seed: u64,
    precision: Option<&Precision>,
    uncertain: &UncertainSampling<'_>,
) -> Result<Vec<Block>, StudyError> {
    let mut blocks = Vec::with_capacity(resolved.len());
    let (mut first_point, mut first_run) = (0_u64, 0_u64);
    for (block, written) in resolved.into_iter().zip(designs) {
        let design = Design::new(written.layout.clone(), start_box, seed);
        let points = product(&block.listing.factors(&block.columns), MAX_COUNT);
        let sampling = match product(&design.factors(), MAX_COUNT) {
            Err(large) => Err(large),
            Ok(samples) => Ok(Sampling::new(&design, samples, precision, uncertain.longest())
                .map_err(|fault| written.path.key(design.kind()).refuse_key(fault))?),
        };
        let runs = sampling.map(|sampling| sampling.most);
        let total = match (points, runs) {
            (Ok(points), Ok(runs)) => product(&[points, runs], MAX_COUNT),
            _ => Err(to_float(points) * to_float(runs)),
        };
        let total = total.and_then(|more| match first_run + more {
            total if total <= MAX_COUNT => Ok(total),
            total => Err(total as f64),
        });
        let (Ok(points), Ok(sampling), Ok(total)) = (points, sampling, total) else {
            let found = format!(
                "{:e} runs (points: {}, samples at each: {})",
                to_float(total),
                describe_number(to_float(points)),
                describe_number(to_float(runs)),
            );
            let fault = Fault::new("too many runs", found, "at most 1e15 runs");
            return Err(written.path.refuse_value(fault));
        };
        let uncertain_design = uncertain.of_block(&design, sampling, precision)?;
        blocks.push(Block {
            listing: block.listing,
            columns: block.columns,
            design,
            uncertain_design,
            first_point,
            points,
            first_run,
            sampling,
        });
        first_point += points;
        first_run = total;
    }
    Ok(blocks)
}

fn to_float(count: Result<u64, f64>) -> f64 {
    count.map_or_else(|large| large, |count| count as f64)
}
