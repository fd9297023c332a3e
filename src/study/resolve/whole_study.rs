//! Resolution of a study file: validates everything, fills in the defaults, and counts points and
//! runs.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use indexmap::IndexMap;
use serde_json::Value;

use crate::study::error::{Fault, StudyError};
use crate::study::file::balls::Balls;
use crate::study::file::decode::decode;
use crate::study::file::distribution_file::DistributionFile;
use crate::study::file::key_path::KeyPath;
use crate::study::file::ranges::expand_ranges;
use crate::study::file::read_file::read_text;
use crate::study::file::resolved_yaml::{ResolvedFile, block_text};
use crate::study::file::schema_place::SchemaPlace;
use crate::study::file::study_file::{BlockFile, DesignFile, InitialConditionsFile, StudyFile};
use crate::study::file::table_folders::MAX_VALUES;
use crate::study::file::table_folders::TableFolders;
use crate::study::file::unit_keys::{Names, add_restitution};
use crate::study::file::values::Range;
use crate::study::file::yaml_tree::{Content, Source};
use crate::study::plan::base::Base;
use crate::study::plan::parameter::{Parameter, VariedParameter};
use crate::study::plan::planned_study::Study;
use crate::study::plan::sweep::Listing;
use crate::study::plan::variable::Variable;
use crate::study::resolve::determined::determined;
use crate::study::resolve::expectations::resolve_expectations;
use crate::study::resolve::further_errors::{Found, leave_out, with_further_errors};
use crate::study::resolve::identification::resolve_identification;
use crate::study::resolve::model::check_parameters;
use crate::study::resolve::names::check_study_name;
use crate::study::resolve::numbers_of_balls::{base_of_all_points, model_of_common_design};
use crate::study::resolve::optimization::resolve_optimization;
use crate::study::resolve::points::check_points;
use crate::study::resolve::responses::resolve_responses;
use crate::study::resolve::runs::{Setting, number_runs};
use crate::study::resolve::sampling::{ResolvedDesign, resolve_design};
use crate::study::resolve::simulation::resolve_simulation;
use crate::study::resolve::stages::check_kicks;
use crate::study::resolve::sweep::{ResolvedBlock, resolve_block};
use crate::study::resolve::system::read_system;
use crate::study::resolve::uncertain::resolve_uncertain;
use crate::study::resolve::uncertain_sampling::UncertainSampling;
use crate::study::resolve::units::{resolve_units, units_to_file};
use crate::study::resolve::variables::resolve_variables;
use crate::study::sampling::initial_box::InitialBox;

/// The version of the study file's format that this program reads.
const SCHEMA: u64 = 1;

impl Study {
    /// Reads and validates a study file and the tables that it names. Tables are in the directory
    /// of the study file or below it.
    pub fn load(path: &Path) -> Result<Study, StudyError> {
        Study::load_with_tables(path, &[])
    }

    /// Reads a study file like [`Study::load`], and grants access to tables in further directories
    /// and below them. The paths of tables stay relative to the study file, so that the directories
    /// never change the meaning of a study.
    pub fn load_with_tables(path: &Path, directories: &[PathBuf]) -> Result<Study, StudyError> {
        let text = read_text(path).map_err(|fault| StudyError::about_file(path, fault))?;
        Study::parse_with_tables(path, text, directories)
    }

    /// Parses a study from the text of a file of this name. The paths of tables are relative to
    /// this file.
    pub fn parse(file: &Path, text: String) -> Result<Study, StudyError> {
        Study::parse_with_tables(file, text, &[])
    }

    /// Parses a study from the keys and values of a study file. Messages show them in the notation of a file of this name,
    /// to which the paths of tables are relative, with access to tables in further directories.
    pub fn from_value(
        file: &Path,
        value: &Value,
        directories: &[PathBuf],
    ) -> Result<Study, StudyError> {
        Study::parse_with_tables(file, block_text(value), directories)
    }

    /// Parses a study like [`Study::parse`], and grants access to tables in further directories.
    pub fn parse_with_tables(
        file: &Path,
        text: String,
        directories: &[PathBuf],
    ) -> Result<Study, StudyError> {
        let is_short = text.len() <= MOST_REREAD;
        let copy = if is_short { text.clone() } else { String::new() };
        read(file, text, directories, &[]).map_err(|(_, error)| match is_short {
            true => with_further_errors(error, |without| {
                read(file, copy.clone(), directories, without).map(|_| ())
            }),
            false => error,
        })
    }
}

/// The longest study that is read again for further errors, in bytes.
const MOST_REREAD: usize = 100_000;

/// Reads a study without some of its keys.
fn read(
    file: &Path,
    text: String,
    directories: &[PathBuf],
    without: &[KeyPath],
) -> Result<Study, (Found, StudyError)> {
    let in_key = |error| (Found::InKey, error);
    let folders = TableFolders::new(file, directories).map_err(in_key)?;
    let mut source = Source::new(file, text).map_err(in_key)?;
    without.iter().for_each(|path| leave_out(&mut source.root, path));
    check_schema(&source).map_err(in_key)?;
    read_system(&mut source, &folders).map_err(in_key)?;
    expand_ranges(&mut source).map_err(in_key)?;
    add_restitution(&mut source.root);
    let names = Names::of(&source.root);
    check_parameters(&source, &names).map_err(in_key)?;
    let written: StudyFile =
        decode(&source, &names, Some(SchemaPlace::declared())).map_err(in_key)?;
    source.units = names.into_units();
    let between = |error| (Found::BetweenKeys, error);
    resolve(&source, &Arc::new(source.outline()), &written, &folders).map_err(between)
}

/// Checks the version first, because the keys of another version may be unknown.
fn check_schema(source: &Source) -> Result<(), StudyError> {
    let Some(node) = source.root.get("schema") else { return Ok(()) };
    match node.content {
        Content::Natural(SCHEMA) => Ok(()),
        _ => {
            let allowed = format!("{SCHEMA}, the version that this program reads");
            let fault = Fault::new("unknown version of the format", node.describe(), allowed);
            Err(source.path("schema").refuse_value(fault))
        }
    }
}

/// `outline` contains the keys of the source.
fn resolve(
    source: &Source,
    outline: &Arc<Source>,
    written: &StudyFile,
    folders: &TableFolders,
) -> Result<Study, StudyError> {
    check_study_name(&written.name).map_err(|fault| source.path("name").refuse_value(fault))?;
    let base = Base::resolve(source, folders, &written.model)?;
    let ends_s = base.model.end_time_s();
    let simulation = resolve_simulation(source, written.simulation, ends_s)?;
    check_kicks(source, &base.model, &simulation)?;
    written.precision.map_or(Ok(()), |precision| precision.check(source))?;
    let mut blocks = resolve_blocks(source, written, folders, &base)?;
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
            Some(resolve_design(folders, &path, design, &model)?)
        }
    };
    let designs = designs(source, written, folders, &base, &mut blocks, common.as_ref())?;
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
        uncertain_parameters.iter().map(|one| column(&one.parameter)).collect();
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
    let setting = Setting {
        base: &base,
        start_box: &start_box,
        seed: written.seed,
        precision: written.precision.as_ref(),
        uncertain: &sampling,
    };
    let blocks = number_runs(blocks, &designs, &setting)?;
    let mut study = Study {
        base,
        simulation,
        blocks,
        swept: swept_parameters.iter().map(column).collect(),
        swept_parameters,
        shown_digits: OnceLock::new(),
        uncertain,
        uncertain_parameters,
        copula: sampling.copula,
        expectations: Vec::new(),
        variables: Vec::new(),
        responses: Vec::new(),
        optimization: None,
        identification: None,
        by_balls: Vec::new(),
        determined,
        units: units.clone(),
        resolved: ResolvedFile::new(resolved),
        source: Arc::clone(outline),
    };
    check_points(source, written, &study)?;
    let expected = written.expect.as_deref().unwrap_or_default();
    study.expectations = resolve_expectations(source, &study, &study.swept_parameters, expected)?;
    study.responses = resolve_responses(source, &study, written.responses.as_ref())?;
    study.variables = resolve_variables(&source.path("design"), &study, written.design.as_ref())?;
    study.by_balls = by_balls(source, written, folders, &study)?;
    study.optimization = resolve_optimization(source, &study, written.optimize.as_ref())?;
    study.identification = resolve_identification(source, &study, written.identify.as_ref())?;
    Ok(study)
}

/// Returns a copy of the study for each number of balls that a design may have, in ascending order.
/// The list is empty if designs do not vary the number of balls.
fn by_balls(
    source: &Source,
    written: &StudyFile,
    folders: &TableFolders,
    study: &Study,
) -> Result<Vec<Study>, StudyError> {
    let Some(numbers) = study.variables.iter().find_map(Variable::ball_numbers) else {
        return Ok(Vec::new());
    };
    let with = |balls: u64| {
        let mut other = StudyFile {
            expect: None,
            design: None,
            responses: None,
            optimize: None,
            identify: None,
            ..written.clone()
        };
        other.model.parameters.get_or_insert_default().balls = Some(Balls::Number(balls));
        // These ranges belong to balls that the design does not have.
        if let Some(ranges) = &mut other.initial_conditions.start_box {
            ranges.retain(|name, _| ball_of(name).is_none_or(|ball| ball <= balls));
        }
        resolve(source, &study.source, &other, folders).map_err(|error| {
            let problem = format!("with {balls} balls: `{}`: {}", error.key(), error.problem());
            let found = error.found().map(str::to_owned);
            let fault = Fault { problem, found, allowed: error.allowed().map(str::to_owned) };
            source.path("design.balls").refuse_value(fault)
        })
    };
    numbers.map(with).collect()
}

/// Returns the number of the ball of a coordinate such as `beta_dot_2`.
fn ball_of(axis: &str) -> Option<u64> {
    let ball = axis.strip_prefix("beta_dot_").or_else(|| axis.strip_prefix("beta_"))?;
    ball.parse().ok()
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
    folders: &TableFolders,
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
            .map(|(index, block)| resolve_block(folders, &path.item(index), block, base))
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
    let own = blocks.iter().filter_map(|block| block.file.design.as_ref());
    let designs = own.chain(common.map(|design| &design.file));
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
    folders: &TableFolders,
    base: &Base,
    blocks: &mut [ResolvedBlock],
    common: Option<&ResolvedDesign<'a>>,
) -> Result<Vec<ResolvedDesign<'a>>, StudyError> {
    let own = written.sweep.as_deref().unwrap_or_default();
    let resolve = |(index, block): (usize, &mut ResolvedBlock)| {
        if let Some(design) = own.get(index).and_then(|block| block.design.as_ref()) {
            let path = source.path("sweep").item(index).key("design");
            let model = base.with_balls(block.range_of_balls(base.balls())).model;
            let design = resolve_design(folders, &path, design, &model)?;
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
