//! Resolution of the plan of a study: model, sweep, start states, uncertain parameters, and the numbers of its runs.

use std::sync::{Arc, OnceLock};

use indexmap::IndexMap;

use crate::model::Simulation;
use crate::study::error::{Fault, StudyError, describe_number};
use crate::study::file::source::Source;
use crate::study::file::study_file::{BlockFile, DesignFile, InitialConditionsFile, StudyFile};
use crate::study::file::table_folders::MAX_VALUES;
use crate::study::file::uncertain_file::DistributionFile;
use crate::study::file::values::Range;
use crate::study::plan::base::Base;
use crate::study::plan::parameter::{Parameter, VariedParameter};
use crate::study::plan::planned_runs::Plan;
use crate::study::plan::sweep::Listing;
use crate::study::resolve::determined::determined;
use crate::study::resolve::names::check_study_name;
use crate::study::resolve::points::{base_of_all_points, check_points, model_of_common_design};
use crate::study::resolve::runs::{PointSettings, number_runs};
use crate::study::resolve::sampling::{ResolvedDesign, resolve_design};
use crate::study::resolve::stages::check_kicks;
use crate::study::resolve::sweep::{ResolvedBlock, resolve_block};
use crate::study::resolve::uncertain::resolve_uncertain;
use crate::study::resolve::uncertain_sampling::UncertainSampling;
use crate::study::resolve::units::{resolve_units, units_to_file};
use crate::study::sampling::initial_box::InitialBox;

/// Validates the parts of a study that determine its runs.
pub(in crate::study) fn resolve_plan(
    source: &Source,
    written: &StudyFile,
) -> Result<Plan, StudyError> {
    check_study_name(&written.name).map_err(|fault| source.path("name").refuse_value(fault))?;
    let base = Base::resolve(source, &written.model)?;
    let ends_s = base.model.end_time_s();
    let simulation = resolve_simulation(source, written.simulation, ends_s)?;
    check_kicks(source, &base.model, &simulation)?;
    written.precision.map_or(Ok(()), |precision| precision.check(source))?;
    let mut blocks = resolve_blocks(source, written, &base)?;
    let base = base_of_all_points(source, &blocks, base)?;
    let conditions = source.path("initial_conditions");
    let start_box = InitialBox::resolve(
        &conditions.key("box"),
        written.initial_conditions.start_box.as_ref(),
        &base.model,
    )?;
    let common = match &written.initial_conditions.design {
        None => None,
        Some(design) => {
            let path = conditions.key("design");
            let model = model_of_common_design(written, &blocks, &base);
            Some(resolve_design(&path, design, &model)?)
        }
    };
    let designs = designs(source, written, &base, &mut blocks, common.as_ref())?;
    check_values(source, &blocks, common.as_ref())?;
    let mut swept_parameters: Vec<Parameter> = Vec::new();
    for (parameter, _) in blocks.iter().flat_map(|block| &block.columns) {
        if !swept_parameters.contains(parameter) {
            swept_parameters.push(*parameter);
        }
    }
    let uncertain_parameters = resolve_uncertain(
        source,
        written.uncertain.as_ref(),
        &base,
        &swept_parameters,
        written.seed,
    )?;
    let sampling = UncertainSampling::resolve(
        source,
        written.uncertain_sampling.as_ref(),
        &uncertain_parameters,
        written.seed,
    )?;
    let units = resolve_units(source, written.units.as_ref(), base.model.kind())?;
    let column = |parameter: &Parameter| parameter.column().shown_in(&units);
    let uncertain: Vec<VariedParameter> =
        uncertain_parameters.iter().map(|uncertain| column(&uncertain.parameter)).collect();
    let kind = base.model.kind();
    let determined = determined(source, kind, written, &swept_parameters)?;
    let resolved = StudyFile {
        model: base.to_file(&determined),
        sweep: written
            .sweep
            .is_some()
            .then(|| blocks.iter().map(|block| block.file.clone()).collect()),
        uncertain: uncertain_to_file(written, &uncertain),
        uncertain_sampling: sampling.file.clone(),
        initial_conditions: InitialConditionsFile {
            start_box: Some(box_to_file(&start_box, written)),
            design: common.map(|design| design.file),
        },
        simulation: Some(simulation),
        units: units_to_file(&units),
        ..written.clone()
    };
    let settings = PointSettings {
        base: &base,
        start_box: &start_box,
        seed: written.seed,
        precision: written.precision.as_ref(),
        uncertain: &sampling,
    };
    let blocks = number_runs(blocks, &designs, &settings)?;
    let plan = Plan {
        base,
        simulation,
        blocks,
        swept: swept_parameters.iter().map(column).collect(),
        swept_parameters,
        shown_digits: OnceLock::new(),
        uncertain,
        uncertain_parameters,
        copula: sampling.copula,
        determined,
        units: units.clone(),
        resolved,
        resolved_yaml: OnceLock::new(),
        hash: OnceLock::new(),
        source: Arc::new(source.outline()),
    };
    check_points(source, &plan)?;
    Ok(plan)
}

/// Returns the box with all axes. If designs vary the number of balls, it also contains the ranges
/// of all balls.
fn box_to_file(start_box: &InitialBox, written: &StudyFile) -> IndexMap<String, Range> {
    let mut file = start_box.to_file();
    let chosen = written.design.as_ref().is_some_and(|design| design.get("balls").is_some());
    if let (true, Some(ranges)) = (chosen, &written.initial_conditions.start_box) {
        let is_axis = |name: &str| start_box.axes.iter().any(|axis| axis.name == name);
        let general = ranges.iter().filter(|(name, _)| !is_axis(name));
        file.extend(general.map(|(name, range)| (name.clone(), *range)));
    }
    file
}

fn resolve_blocks(
    source: &Source,
    written: &StudyFile,
    base: &Base,
) -> Result<Vec<ResolvedBlock>, StudyError> {
    let path = source.path("sweep");
    match written.sweep.as_deref() {
        None => Ok(vec![ResolvedBlock {
            listing: Listing::Grid,
            columns: Vec::new(),
            file: BlockFile::default(),
        }]),
        Some([]) => {
            let allowed = "at least one block, or no `sweep` for a single point";
            Err(path.wrong_value("an empty sweep", "an empty list", allowed))
        }
        Some(blocks) => blocks
            .iter()
            .enumerate()
            .map(|(index, block)| resolve_block(&path.item(index), block, base))
            .collect(),
    }
}

fn check_values(
    source: &Source,
    blocks: &[ResolvedBlock],
    common: Option<&ResolvedDesign<'_>>,
) -> Result<(), StudyError> {
    let swept: usize =
        blocks.iter().flat_map(|block| &block.columns).map(|(_, values)| values.len()).sum();
    let of_blocks = blocks.iter().filter_map(|block| block.file.design.as_ref());
    let designs = of_blocks.chain(common.map(|design| &design.file));
    let starts: usize = designs.map(DesignFile::values).sum();
    if swept + starts <= MAX_VALUES {
        return Ok(());
    }
    let found = format!("{swept} swept values and {starts} coordinates of given starts");
    let fault = Fault::new("too many values", found, format!("at most {MAX_VALUES} together"));
    Err(source.path("sweep").refuse_value(fault))
}

/// Returns the design of every block: its own, which is added to the block's file, or the common
/// design.
fn designs<'a>(
    source: &'a Source,
    written: &StudyFile,
    base: &Base,
    blocks: &mut [ResolvedBlock],
    common: Option<&ResolvedDesign<'a>>,
) -> Result<Vec<ResolvedDesign<'a>>, StudyError> {
    let sweep = written.sweep.as_deref().unwrap_or_default();
    let resolve = |(index, block): (usize, &mut ResolvedBlock)| {
        if let Some(design) = sweep.get(index).and_then(|block| block.design.as_ref()) {
            let path = source.path("sweep").item(index).key("design");
            let model = base.with_balls(block.range_of_balls(base.balls())).model;
            let design = resolve_design(&path, design, &model)?;
            block.file.design = Some(design.file.clone());
            return Ok(design);
        }
        common.cloned().ok_or_else(|| {
            let path = source.path("initial_conditions.design");
            let allowed = "stratified, latin_hypercube, sobol, monte_carlo, grid or table";
            path.wrong_value("missing key", "no such key", allowed)
        })
    };
    blocks.iter_mut().enumerate().map(resolve).collect()
}

fn uncertain_to_file(
    written: &StudyFile,
    columns: &[VariedParameter],
) -> Option<IndexMap<String, DistributionFile>> {
    let written = written.uncertain.as_ref()?;
    let entries: IndexMap<_, _> = columns
        .iter()
        .filter_map(|column| Some((column.name.clone(), written.get(&column.name)?.clone())))
        .collect();
    (!entries.is_empty()).then_some(entries)
}

/// Returns the simulation settings of a study; `ends_s` is the end of the speed profile, if the profile has one.
///
/// # Errors
/// Returns an error if the end time is not that of the speed profile, or if the extension gives no later end time.
fn resolve_simulation(
    source: &Source,
    written: Option<Simulation>,
    ends_s: Option<f64>,
) -> Result<Simulation, StudyError> {
    let mut simulation = written.unwrap_or_default();
    let path = source.path("simulation.end_time_s");
    if let Some(ends_s) = ends_s {
        let end_time_s = std::mem::replace(&mut simulation.end_time_s, ends_s);
        if path.node().is_some() && end_time_s != ends_s {
            let allowed = format!(
                "{}, no such key, or no `hold_s` at the end of the speed profile",
                describe_number(ends_s)
            );
            let found = describe_number(end_time_s);
            return Err(path.wrong_value("not the end of the speed profile", found, allowed));
        }
    }
    let [end_s, later_s] = simulation.end_times_s();
    // Rounding may lose a factor slightly above 1, and a long end time may overflow.
    match simulation.extend {
        Some(extend) if !(later_s > end_s && later_s.is_finite()) => {
            let allowed = "a factor whose later end time is a larger, finite number";
            let fault = Fault::new("no later end time", describe_number(extend.factor), allowed);
            Err(source.path("simulation.extend.factor").refuse_value(fault))
        }
        _ => Ok(simulation),
    }
}
