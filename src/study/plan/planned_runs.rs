//! The plan of a study: every point and every run is a function of its number.

use std::ops::{Range, RangeInclusive};
use std::sync::{Arc, OnceLock};

use crate::model::{Case, InvalidParameter, Model, Simulation, Start};
use crate::study::file::source::Outline;
use crate::study::file::study_file::StudyFile;
use crate::study::plan::base::Base;
use crate::study::plan::expectation::{Expectation, same};
use crate::study::plan::parameter::{Parameter, ParameterValue, VariedParameter};
use crate::study::plan::precision::{Audit, Precision, Sampling};
use crate::study::plan::sweep::{Block, Listing, PointSampling};
use crate::study::plan::uncertain_parameter::UncertainParameter;
use crate::study::plan::units::ShownUnits;
use crate::study::sampling::apart::start_apart;
use crate::study::sampling::correlation::Copula;
use crate::study::sampling::draw::DrawKey;

/// What a study computes, with every default filled in; it is immutable.
///
/// Runs are numbered from zero, point by point in the order of the sweep. Each run is a pure
/// function of the plan and its number, and is computed on request.
#[derive(Clone, Debug)]
pub struct Plan {
    pub(in crate::study) base: Base,
    pub(in crate::study) simulation: Simulation,
    pub(in crate::study) blocks: Vec<Block>,
    pub(in crate::study) swept_parameters: Vec<Parameter>,
    pub(in crate::study) swept: Vec<VariedParameter>,
    /// The digits with which the values of each swept parameter are shown, once they are known.
    pub(in crate::study) shown_digits: OnceLock<Vec<usize>>,
    pub(in crate::study) uncertain_parameters: Vec<UncertainParameter>,
    pub(in crate::study) uncertain: Vec<VariedParameter>,
    /// The correlations of the uncertain parameters, if there are any.
    pub(in crate::study) copula: Option<Copula>,
    /// The parameters that others determine, such as the mass of a ball whose density is given.
    pub(in crate::study) determined: Vec<&'static str>,
    pub(in crate::study) units: ShownUnits,
    /// The study file with all defaults.
    pub(in crate::study) resolved: StudyFile,
    /// Its text and its hash, once they are known; every table needs them.
    pub(in crate::study) resolved_yaml: OnceLock<String>,
    pub(in crate::study) hash: OnceLock<String>,
    /// The keys of the study file as it is written, for messages about them.
    pub(in crate::study) source: Arc<Outline>,
}

/// One point of the sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Number of the point, counted from zero in the order of the sweep.
    pub point_id: u64,
    /// One value per column of [`Plan::swept`]: the base value if the point's block does not sweep
    /// the column.
    pub swept: Vec<ParameterValue>,
    /// Number of the point's first run.
    pub first_run: u64,
    /// Number of the point's runs; the computed runs have consecutive numbers.
    pub sampling: Sampling,
    /// Number of cells of equal size from which the start states are drawn; `None` if the design is
    /// not stratified.
    pub cells: Option<u64>,
    /// The range of each coordinate of the start states.
    pub start_ranges: Vec<[f64; 2]>,
    model: Model,
}

impl Point {
    /// Returns the model at this point, with each uncertain parameter at its median; without uncertain draws if these
    /// medians are impossible.
    pub fn model(&self) -> &Model {
        &self.model
    }
}

/// A planned run.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedRun {
    /// Number of the run, counted from zero over the whole study.
    pub run_id: u64,
    /// Number of its point.
    pub point_id: u64,
    /// Cell of a stratified design, point of a grid or row of a table of start states; otherwise
    /// zero.
    pub cell: u64,
    /// Number of the sample within its cell, counted from zero.
    pub replicate: u64,
    /// One value per column of [`Plan::swept`].
    pub swept: Vec<ParameterValue>,
    /// One drawn value per column of [`Plan::uncertain`].
    pub uncertain: Vec<f64>,
    /// Start state of the run.
    pub start: Start,
    /// The case to simulate, or the drawn parameter that is physically impossible; such a run
    /// fails.
    pub case: Result<Case, InvalidParameter>,
    /// Whether the audit recomputes the run, see [`Audit`].
    pub audited: bool,
}

impl Plan {
    /// Returns the name of the study.
    pub fn name(&self) -> &str {
        &self.resolved.name
    }

    /// Returns the seed of all random numbers.
    pub fn seed(&self) -> u64 {
        self.resolved.seed
    }

    /// Returns a seed that is derived from the master seed for a purpose and a number.
    pub fn derived_seed(&self, purpose: &str, number: u64) -> u64 {
        DrawKey::new(self.seed(), purpose, "").bits(0, number)
    }

    /// Returns whether another master seed gives other runs. It does not if all start states are
    /// given and no parameter is uncertain.
    pub fn is_random(&self) -> bool {
        !self.uncertain.is_empty() || self.samplings().any(|sampling| sampling.design.is_random())
    }

    /// Returns the model before any parameter is swept or drawn. All cases share its kind. It has the
    /// largest number of balls of all points.
    pub fn model(&self) -> &Model {
        &self.base.model
    }

    /// Returns whether the sweep sets the number of balls.
    pub fn sweeps_balls(&self) -> bool {
        self.swept_parameters.contains(&Parameter::BALLS)
    }

    /// Returns the numbers of balls from the smallest to the largest of all points; zero for a model without balls.
    pub fn numbers_of_balls(&self) -> RangeInclusive<usize> {
        self.base.fewest_balls..=self.base.model.balls()
    }

    /// Returns the sampling of the points, once for each kind of points.
    pub(in crate::study) fn samplings(&self) -> impl Iterator<Item = &PointSampling> {
        self.blocks.iter().flat_map(|block| &block.samplings)
    }

    /// Returns whether the runs have stages: the disc changes its speed, or the table is kicked.
    pub fn has_stages(&self) -> bool {
        self.base.model.has_stages()
    }

    /// Returns whether runs have a largest amplitude: they have stages, and the amplitude of the table is measured.
    pub fn has_peaks(&self) -> bool {
        self.has_stages() && self.base.model.kind().offers.vibration
    }

    /// Returns the settings of the simulation.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Returns the audit, if there is one.
    pub fn audit(&self) -> Option<Audit> {
        self.resolved.audit
    }

    /// Returns the requested precision of the fraction of equilibria, if the study has one.
    pub fn precision(&self) -> Option<Precision> {
        self.resolved.precision
    }

    /// Returns the number of planned runs. With a precision, this is the largest number, for which
    /// run numbers are reserved.
    pub fn run_count(&self) -> u64 {
        self.blocks.last().map_or(0, Block::end_run)
    }

    /// Returns the number of runs before the first decision at each point. Without a precision,
    /// this is the number of all runs.
    pub fn least_run_count(&self) -> u64 {
        self.blocks.iter().map(Block::least_runs).sum()
    }

    /// Returns ranges of points with equally many runs: the point numbers, and the largest number
    /// of runs per point.
    pub fn point_ranges(&self) -> impl Iterator<Item = (Range<u64>, u64)> {
        let of_block = |block: &Block, points: Range<u64>| {
            block.first_point + points.start..block.first_point + points.end
        };
        self.blocks.iter().flat_map(move |block| {
            block.numbers.ranges().map(move |(points, runs)| (of_block(block, points), runs))
        })
    }

    /// Returns the number of points of the sweep, which is one without a sweep.
    pub fn point_count(&self) -> u64 {
        self.blocks.last().map_or(0, Block::end_point)
    }

    /// Returns the columns of the swept parameters of all blocks, in order of first appearance.
    pub fn swept(&self) -> &[VariedParameter] {
        &self.swept
    }

    /// Returns the units in which people read results.
    pub fn units(&self) -> &ShownUnits {
        &self.units
    }

    /// Returns the columns of the uncertain parameters, in the order of the model's parameters.
    pub fn uncertain(&self) -> &[VariedParameter] {
        &self.uncertain
    }

    /// Returns a point of the sweep.
    ///
    /// # Panics
    /// If `point_id` is not below [`Plan::point_count`].
    pub fn point(&self, point_id: u64) -> Point {
        let mut point = self.nominal_point(point_id);
        if !self.uncertain.is_empty()
            && let Ok(model) = self.median_model(point_id)
        {
            point.model = model;
        }
        point
    }

    /// Returns a point whose model has no uncertain draws.
    fn nominal_point(&self, point_id: u64) -> Point {
        assert!(point_id < self.point_count(), "there is no point {point_id}");
        let index = self.blocks.partition_point(|block| block.first_point <= point_id);
        let block = &self.blocks[index - 1];
        let local = point_id - block.first_point;
        let values = block.values(local);
        let (PointSampling { design, sampling, .. }, first_run) = block.sampling_of(local);
        let model = self.model_with(&values);
        let column = |parameter: &Parameter| {
            let swept = values.iter().find(|(other, _)| other == parameter);
            swept.map_or_else(|| parameter.get(&model, &self.base.general), |(_, value)| *value)
        };
        Point {
            point_id,
            swept: self.swept_parameters.iter().map(column).collect(),
            first_run,
            sampling: *sampling,
            cells: design.cells(),
            start_ranges: design.ranges(),
            model,
        }
    }

    /// Returns a run. The same study gives the same run, independently of all other computations.
    ///
    /// # Panics
    /// If `run_id` is not below [`Plan::run_count`].
    pub fn planned_run(&self, run_id: u64) -> PlannedRun {
        assert!(run_id < self.run_count(), "there is no run {run_id}");
        let index = self.blocks.partition_point(|block| block.first_run <= run_id);
        let block = &self.blocks[index - 1];
        let local_point = block.numbers.point_of(run_id - block.first_run);
        let point = self.nominal_point(block.first_point + local_point);
        let (of_point, first_run) = block.sampling_of(local_point);
        let (design, sample) = (&of_point.design, run_id - first_run);
        let id = design.identify(sample);
        let mut values = block.values(local_point);
        let uncertain = self.drawn(&values, &self.drawn_fractions(of_point, sample));
        let audited = self.audit().is_some_and(|audit| audit.chooses(self.seed(), &values, id));
        let model = if uncertain.is_empty() {
            point.model
        } else {
            let drawn = self.uncertain_parameters.iter().zip(&uncertain);
            let drawn = drawn.map(|(draw, value)| (draw.parameter, ParameterValue::Number(*value)));
            values.extend(drawn);
            self.model_with(&values)
        };
        let touching = model.ball_balancer().filter(|machine| machine.contact.is_some());
        let start = match touching {
            None => Ok(design.coordinates(id)),
            Some(machine) => machine.validate().and_then(|()| start_apart(design, id, machine)),
        };
        let drawn = || design.coordinates(id);
        let end_time_s = model.end_time_s().unwrap_or(self.simulation.end_time_s);
        let simulation = Simulation { end_time_s, ..self.simulation };
        let sound = model.validate().and(start.clone().map(|_| ()));
        let sound = sound.and_then(|()| model.validate_kicks(end_time_s));
        let sound = sound.and_then(|()| model.validate_extension(&simulation));
        let start = Start(start.unwrap_or_else(|_| drawn()));
        let case = sound.map(|()| Case { model, start: start.clone(), simulation });
        PlannedRun {
            run_id,
            point_id: point.point_id,
            cell: id.cell,
            replicate: id.replicate,
            swept: point.swept,
            uncertain,
            start,
            case,
            audited,
        }
    }

    /// Returns the value of a parameter at a point, with uncertain parameters at their medians; `None` if the model does not
    /// have the parameter.
    pub fn value_at(&self, point: &Point, name: &str) -> Option<ParameterValue> {
        if let Some(place) = self.swept.iter().position(|column| column.name == name) {
            return point.swept.get(place).copied();
        }
        Some(Parameter::find(name, point.model())?.get(point.model(), &self.base.general))
    }

    /// Returns the base model with these values and, unless they set the number of balls, with that of the study file.
    /// Values of all balls are set before those of one ball.
    pub(in crate::study) fn model_with(&self, values: &[(Parameter, ParameterValue)]) -> Model {
        let mut model = self.base.model.clone();
        if values.iter().all(|(parameter, _)| *parameter != Parameter::BALLS) {
            Parameter::BALLS.set(&mut model, self.base.value(Parameter::BALLS));
        }
        for of_one_ball in [false, true] {
            for (parameter, value) in values {
                if parameter.general().is_some() == of_one_ball {
                    parameter.set(&mut model, *value);
                }
            }
        }
        model
    }

    /// Returns whether an expectation selects at least one point, without visiting all points of a
    /// grid.
    pub(in crate::study) fn has_point(&self, expectation: &Expectation) -> bool {
        self.blocks.iter().any(|block| match block.listing {
            Listing::Zip | Listing::Table => (block.first_point..block.end_point())
                .any(|point| expectation.selects(&self.swept, &self.point(point).swept)),
            Listing::Grid => {
                let first = self.point(block.first_point);
                let columns = self.swept_parameters.iter().zip(&self.swept).zip(&first.swept);
                expectation.point.iter().all(|(name, wanted)| {
                    let column = columns.clone().find(|((_, column), _)| column.name == *name);
                    let Some(((parameter, _), base)) = column else { return false };
                    // The value of one ball follows the value of all balls.
                    let general = || block.list(parameter.general()?);
                    match block.list(*parameter).or_else(general) {
                        Some(values) => values.iter().any(|value| same(value, wanted)),
                        None => same(base, wanted),
                    }
                })
            }
        })
    }
}
