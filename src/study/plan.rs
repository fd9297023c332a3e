//! A resolved study and its plan: every point and every run as a function of its number.

use std::ops::Range;

use super::audit::Audit;
use super::design::SampleId;
use super::draw::DrawKey;
use super::expectation::{Expectation, same};
use super::optimization::Optimization;
use super::parameter::{Parameter, ParameterValue, VariedParameter};
use super::precision::{Precision, Sampling};
use super::resolve_model::Base;
use super::resolve_uncertain::Uncertain;
use super::resolved_file::ResolvedFile;
use super::response::Response;
use super::sweep::{Block, Listing};
use super::variable::Variable;
use crate::model::{Case, InvalidParameter, Model, Simulation, Start};

/// A study with everything checked and every default filled in; it never changes.
///
/// Its runs are numbered from zero, point by point in the order of the sweep. Each is a pure
/// function of the study and its number, computed when it is asked for.
#[derive(Clone, Debug)]
pub struct Study {
    pub(super) name: String,
    pub(super) seed: u64,
    pub(super) base: Base,
    pub(super) simulation: Simulation,
    pub(super) audit: Option<Audit>,
    pub(super) precision: Option<Precision>,
    pub(super) blocks: Vec<Block>,
    pub(super) swept_parameters: Vec<Parameter>,
    pub(super) swept: Vec<VariedParameter>,
    pub(super) uncertain_parameters: Vec<Uncertain>,
    pub(super) uncertain: Vec<VariedParameter>,
    pub(super) expectations: Vec<Expectation>,
    pub(super) variables: Vec<Variable>,
    pub(super) responses: Vec<Response>,
    pub(super) optimization: Option<Optimization>,
    /// This study with each number of balls that a design may have, in their order.
    pub(super) by_balls: Vec<Study>,
    pub(super) resolved: ResolvedFile,
}

/// One point of the sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Number of the point, counted from zero in the order of the sweep.
    pub point_id: u64,
    /// One value per column of [`Study::swept`]; the base value where the point's block does not
    /// sweep the column.
    pub swept: Vec<ParameterValue>,
    /// Number of the point's first run.
    pub first_run: u64,
    /// Number of the point's runs; those that are computed follow one another.
    pub sampling: Sampling,
    /// Number of the cells of equal size from which its start states are drawn; none where the design
    /// is not stratified.
    pub cells: Option<u64>,
    model: Model,
}

impl Point {
    /// The model at this point, without uncertain draws.
    pub fn model(&self) -> &Model {
        &self.model
    }
}

/// One run as planned.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedRun {
    /// Number of the run, counted from zero over the whole study.
    pub run_id: u64,
    /// Number of its point.
    pub point_id: u64,
    /// Cell of a stratified design, point of a grid, row of a table of starts; otherwise zero.
    pub cell: u64,
    /// Number of the sample within its cell, counted from zero.
    pub replicate: u64,
    /// One value per column of [`Study::swept`].
    pub swept: Vec<ParameterValue>,
    /// One drawn value per column of [`Study::uncertain`].
    pub uncertain: Vec<f64>,
    /// Where the run starts.
    pub start: Start,
    /// What is to be computed, or the drawn parameter that makes no physical sense: such a run is
    /// a failed one.
    pub case: Result<Case, InvalidParameter>,
    /// Whether it is computed a second time, see [`Audit`].
    pub audited: bool,
}

impl Study {
    /// Name of the study.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Master seed of every draw.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// A seed that follows from the master seed: for a purpose, and by number.
    pub fn derived_seed(&self, purpose: &str, number: u64) -> u64 {
        DrawKey::new(self.seed, purpose, "").bits(0, number)
    }

    /// Whether another master seed gives other runs: not where start states are given and no parameter is
    /// uncertain.
    pub fn is_random(&self) -> bool {
        !self.uncertain.is_empty() || self.blocks.iter().any(|block| block.design.is_random())
    }

    /// The most runs that a design has, at all points together.
    pub fn most_runs_of_a_design(&self) -> u64 {
        let all = self.by_balls.iter().map(Study::run_count);
        all.max().unwrap_or(self.run_count())
    }

    /// The model before anything is swept or drawn; its kind and its number of balls are the same
    /// in every case.
    pub fn model(&self) -> &Model {
        &self.base.model
    }

    /// How every run is integrated.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Which runs are computed a second time, if any.
    pub fn audit(&self) -> Option<Audit> {
        self.audit
    }

    /// How precisely the fraction of equilibria is wanted at each point, if that decides how many runs
    /// it has.
    pub fn precision(&self) -> Option<Precision> {
        self.precision
    }

    /// Number of planned runs; with a precision the most, for which numbers are reserved.
    pub fn run_count(&self) -> u64 {
        self.blocks.last().map_or(0, |block| block.first_run + block.points * block.sampling.most)
    }

    /// Number of runs before the first decision at each point; without a precision, of all runs.
    pub fn least_run_count(&self) -> u64 {
        self.blocks.iter().map(|block| block.points * block.sampling.first).sum()
    }

    /// Stretches of points that have equally many runs: their numbers, and the most runs of each.
    pub fn stretches(&self) -> impl Iterator<Item = (Range<u64>, u64)> {
        let points = |block: &Block| block.first_point..block.first_point + block.points;
        self.blocks.iter().map(move |block| (points(block), block.sampling.most))
    }

    /// Number of points of the sweep; one where nothing is swept.
    pub fn point_count(&self) -> u64 {
        self.blocks.last().map_or(0, |block| block.first_point + block.points)
    }

    /// Columns for swept parameters: those of all blocks in order of first appearance.
    pub fn swept(&self) -> &[VariedParameter] {
        &self.swept
    }

    /// Columns for uncertain parameters, in the order of the model's parameters.
    pub fn uncertain(&self) -> &[VariedParameter] {
        &self.uncertain
    }

    /// What the study expects of its results.
    pub fn expectations(&self) -> &[Expectation] {
        &self.expectations
    }

    /// What designs vary.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// What designs are asked for.
    pub fn responses(&self) -> &[Response] {
        &self.responses
    }

    /// What is looked for, if anything is.
    pub fn optimization(&self) -> Option<&Optimization> {
        self.optimization.as_ref()
    }

    /// A point of the sweep by its number.
    ///
    /// # Panics
    /// If `point_id` is not below [`Study::point_count`].
    pub fn point(&self, point_id: u64) -> Point {
        assert!(point_id < self.point_count(), "there is no point {point_id}");
        let index = self.blocks.partition_point(|block| block.first_point <= point_id);
        let block = &self.blocks[index - 1];
        let local = point_id - block.first_point;
        let values = block.values(local);
        let model = self.model_with(&values);
        let column = |parameter: &Parameter| {
            let swept = values.iter().find(|(other, _)| other == parameter);
            swept.map_or_else(|| parameter.get(&model, &self.base.general), |(_, value)| *value)
        };
        Point {
            point_id,
            swept: self.swept_parameters.iter().map(column).collect(),
            first_run: block.first_run + local * block.sampling.most,
            sampling: block.sampling,
            cells: block.design.cells(),
            model,
        }
    }

    /// A run by its number: the same for the same study, whatever else is computed.
    ///
    /// # Panics
    /// If `run_id` is not below [`Study::run_count`].
    pub fn planned_run(&self, run_id: u64) -> PlannedRun {
        assert!(run_id < self.run_count(), "there is no run {run_id}");
        let index = self.blocks.partition_point(|block| block.first_run <= run_id);
        let block = &self.blocks[index - 1];
        let local = run_id - block.first_run;
        let local_point = local / block.sampling.most;
        let point = self.point(block.first_point + local_point);
        let id = block.design.identify(local % block.sampling.most);
        let start = Start(block.design.coordinates(id));
        let mut values = block.values(local_point);
        let uncertain = self.draw(id, &values);
        let audited = self.audit.is_some_and(|audit| audit.chooses(self.seed, &values, id));
        let model = if uncertain.is_empty() {
            point.model
        } else {
            let drawn = self.uncertain_parameters.iter().zip(&uncertain);
            let drawn = drawn.map(|(one, value)| (one.parameter, ParameterValue::Number(*value)));
            values.extend(drawn);
            self.model_with(&values)
        };
        let case = model.validate().map(|()| Case {
            model,
            start: start.clone(),
            simulation: self.simulation,
        });
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

    fn draw(&self, id: SampleId, set: &[(Parameter, ParameterValue)]) -> Vec<f64> {
        let draw = |one: &Uncertain| {
            let drawn = one.distribution.quantile(one.key.uniform(id.cell, id.replicate));
            if !one.factor {
                return drawn;
            }
            let own = set.iter().find(|(parameter, _)| *parameter == one.parameter);
            let own = own.map_or_else(
                || one.parameter.get(&self.base.model, &self.base.general),
                |(_, value)| *value,
            );
            match own {
                ParameterValue::Number(own) => own * drawn,
                ParameterValue::Text(_) => drawn,
            }
        };
        self.uncertain_parameters.iter().map(draw).collect()
    }

    /// The base model with these values: first those of all balls, then those of one ball.
    fn model_with(&self, values: &[(Parameter, ParameterValue)]) -> Model {
        let mut model = self.base.model.clone();
        for of_one_ball in [false, true] {
            for (parameter, value) in values {
                if parameter.general().is_some() == of_one_ball {
                    parameter.set(&mut model, *value);
                }
            }
        }
        model
    }

    /// Whether an expectation selects at least one point; does not go through all points of a
    /// grid.
    pub(super) fn has_point(&self, expectation: &Expectation) -> bool {
        self.blocks.iter().any(|block| match block.listing {
            Listing::Rows => (block.first_point..block.first_point + block.points)
                .any(|point| expectation.selects(self, &self.point(point).swept)),
            Listing::Grid => {
                let first = self.point(block.first_point);
                let columns = self.swept_parameters.iter().zip(&self.swept).zip(&first.swept);
                expectation.point.iter().all(|(name, wanted)| {
                    columns.clone().filter(|((_, column), _)| column.name == *name).any(
                        |((parameter, _), base)| {
                            let swept = block.columns.iter().find(|(other, _)| other == parameter);
                            match swept {
                                Some((_, values)) => values.iter().any(|value| same(value, wanted)),
                                None => self.follows(block, *parameter, wanted, base),
                            }
                        },
                    )
                })
            }
        })
    }

    /// Whether a column that a grid does not sweep itself takes a value in it: one ball's value
    /// follows that of all balls.
    fn follows(
        &self,
        block: &Block,
        parameter: Parameter,
        wanted: &ParameterValue,
        base: &ParameterValue,
    ) -> bool {
        let general = block.columns.iter().find(|(other, _)| Some(*other) == parameter.general());
        match general {
            Some((_, values)) => values.iter().any(|value| same(value, wanted)),
            None => same(base, wanted),
        }
    }
}
