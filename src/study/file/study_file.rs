//! The study file as written: types for reading, writing and the JSON Schema.
//!
//! These types check the form only; `resolve` validates the content and fills in the defaults.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::model::{NormalForce, Simulation};
use crate::study::file::friction_file::FrictionFile;
use crate::study::file::model_parts::{
    ContactFile, DisturbanceFile, ProfilePartFile, ProtocolFile,
};
use crate::study::file::parameters_file::{KindFile, ParametersFile};
use crate::study::file::schema_parts as schema;
use crate::study::file::searches_file::{IdentifyFile, OptimizeFile};
use crate::study::file::uncertain_file::{DistributionFile, UncertainSamplingFile};
use crate::study::file::values::{Count, Entry, Range, TableKey};
use crate::study::plan::precision::{Audit, Precision};
use crate::study::plan::response::ResponseFile;
use crate::study::plan::variable::VariableFile;
use crate::study::sampling::sampling_design::MAX_SOBOL_SAMPLES;

/// A stickslip study: a model, the points of a sweep, and the sampling of start states.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(title = "stickslip study")]
pub struct StudyFile {
    /// Version of the format; must be 1.
    #[schemars(extend("const" = 1))]
    pub schema: u64,
    /// Name of the study: 1 to 100 letters, digits, `-`, `_` and `.`, not beginning with `.`; the
    /// default output directory is `results/NAME`.
    #[schemars(length(min = 1, max = 100), regex(pattern = r"^[A-Za-z0-9_-][A-Za-z0-9._-]*$"))]
    pub name: String,
    /// Seed of all random numbers: an integer from 0 to 2^64 - 1.
    pub seed: u64,
    /// The model and its parameters.
    pub model: ModelFile,
    /// Blocks of points, one block after another; without a sweep, the study has one point.
    #[schemars(extend("minItems" = 1))]
    pub sweep: Option<Vec<BlockFile>>,
    /// Distribution of each uncertain parameter; the value is drawn for each run.
    #[serde(default)]
    #[schemars(schema_with = "schema::by_parameter::<DistributionFile>")]
    pub uncertain: Option<IndexMap<String, DistributionFile>>,
    /// How the uncertain parameters are sampled together: design and rank correlations; by default, draws are
    /// independent.
    pub uncertain_sampling: Option<UncertainSamplingFile>,
    /// Start states and how they are sampled.
    pub initial_conditions: InitialConditionsFile,
    /// Integration method, end time, tolerances and the endings to detect.
    pub simulation: Option<Simulation>,
    /// Sequential sampling: adds runs at each point until the 95 % confidence intervals of the
    /// fraction of equilibria or of amplitudes are narrow enough; by default, each point has the runs of its design.
    pub precision: Option<Precision>,
    /// Recomputation of a fraction of the runs by the other method; by default, none.
    pub audit: Option<Audit>,
    /// Expected results, which `stickslip verify` checks.
    pub expect: Option<Vec<ExpectationFile>>,
    /// Variables of `stickslip evaluate` and `stickslip optimize`, by name: a numeric parameter or
    /// `balls` with `from` and `to`, or another name with `choices`.
    #[serde(default)]
    #[schemars(schema_with = "schema::by_name::<VariableFile>")]
    pub design: Option<IndexMap<String, VariableFile>>,
    /// Responses of each point and of each design, by name: statistics of amplitudes or times to rest.
    pub responses: Option<IndexMap<String, ResponseFile>>,
    /// Objectives, limits and effort of `stickslip optimize`.
    pub optimize: Option<OptimizeFile>,
    /// Parameters that `stickslip identify` infers from measured positions of rest.
    pub identify: Option<IdentifyFile>,
    /// Units in which terminals, reports, notebooks and figures show values, by quantity or by parameter without its unit; by
    /// default the units that the study writes (vibration: µm). Files of results and JSON are in SI units.
    #[serde(default)]
    #[schemars(schema_with = "schema::units")]
    pub units: Option<IndexMap<String, String>>,
}

/// The model with its parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    /// Kind of model; required without `system`.
    #[serde(skip_serializing_if = "KindFile::is_of_file")]
    pub kind: KindFile,
    /// A system file with the equations of a machine, or its keys, in place of a kind.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "schema::system")]
    pub system: Option<Value>,
    /// Parameters in SI units; the defaults are those of the machine of the thesis, of a block of 1 kg on a
    /// spring of 100 N/m, or of the rotor.
    pub parameters: Option<ParametersFile>,
    /// Friction law; the default is `coulomb`.
    pub friction: Option<FrictionFile>,
    /// Derivation of the normal force between ball and ring; the default is `lagrange`; only for a
    /// ball balancer.
    pub normal_force: Option<NormalForce>,
    /// Contact between balls, or `none` for balls that pass through each other; the default is `none`; only for a ball
    /// balancer.
    pub contact: Option<ContactFile>,
    /// How the speed of the disc changes until it is `speed_rad_s`: ramps, plateaus and tables, one after another; by
    /// default, the speed is constant; only for a model with a part that turns: `ball_balancer`, `rotor_balancer`, or a
    /// system file with `turning`.
    #[schemars(extend("minItems" = 1))]
    pub speed_profile: Option<Vec<ProfilePartFile>>,
    /// Kicks of the table; by default, none; only for a ball balancer.
    #[schemars(extend("minItems" = 1))]
    pub disturbances: Option<Vec<DisturbanceFile>>,
    /// A measurement protocol, short for `speed_profile` and `disturbances`; by default, none: `startup`, for a model with a part
    /// that turns, or `startup_and_hammer` with hits of the table, only for a ball balancer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub protocol: Option<ProtocolFile>,
}

/// A block of points: exactly one of `grid`, `zip` and `table`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BlockFile {
    /// Lists of values by parameter; the points are all combinations, and the last parameter
    /// changes fastest.
    #[serde(default)]
    #[schemars(schema_with = "schema::swept")]
    pub grid: Option<IndexMap<String, Vec<Entry>>>,
    /// Lists of equal length by parameter; the first point has the first value of each list, and so
    /// on.
    #[serde(default)]
    #[schemars(schema_with = "schema::swept")]
    pub zip: Option<IndexMap<String, Vec<Entry>>>,
    /// A table with one point per row; the columns are parameters.
    pub table: Option<TableKey>,
    /// Sampling design of this block; the default is `initial_conditions.design`.
    pub design: Option<DesignFile>,
}

/// Start states: a box of coordinates and how it is sampled.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct InitialConditionsFile {
    /// Ranges `[low, high]` by coordinate; other coordinates have their default range. Ball
    /// balancer: lengths over the ring radius, and time multiplied by the natural frequency; `beta`
    /// and `beta_dot` hold for every ball, `beta_1` and so on for one ball; with a speed profile, the default range of all
    /// coordinates but the angles is `[0, 0]`. Block: `position_m` and `velocity_m_s`. Rotor and system file: the coordinates
    /// of the model.
    #[serde(rename = "box", default)]
    #[schemars(schema_with = "schema::start_box")]
    pub start_box: Option<IndexMap<String, Range>>,
    /// Sampling design of the start states; required unless every block of the sweep has its own.
    pub design: Option<DesignFile>,
}

/// A sampling design for start states.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DesignFile {
    /// Stratified sampling: uniform samples in each cell of a regular partition of the box.
    Stratified {
        /// Number of equal parts of each axis.
        parts_per_axis: Count,
        /// Number of samples in each cell.
        samples_per_cell: Count,
    },
    /// Latin hypercube: one sample in each of `samples` strata of every axis.
    LatinHypercube {
        /// Number of samples; another number is another design.
        samples: Count,
    },
    /// Scrambled Sobol' sequence of at most 65,536 samples; a power of two is best.
    Sobol {
        /// Number of samples, at most 65,536.
        #[schemars(extend("maximum" = MAX_SOBOL_SAMPLES))]
        samples: Count,
    },
    /// Independent uniform samples.
    MonteCarlo {
        /// Number of samples.
        samples: Count,
    },
    /// Midpoints of a regular partition of the box.
    Grid {
        /// Number of equal parts of each axis.
        points_per_axis: Count,
    },
    /// Given start states, with one column per coordinate: `x`, `y`, `beta_1` ..., `x_dot`,
    /// `y_dot`, `beta_dot_1` ... of a ball balancer; `position_m`, `velocity_m_s` of a block; the
    /// coordinates of the model for a rotor or a system file.
    Table(TableKey),
}

/// Expected fractions of runs per label at some points; at least one fraction is required.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ExpectationFile {
    /// Values of swept parameters that select points; by default, all points.
    #[serde(default)]
    #[schemars(schema_with = "schema::selector")]
    pub point: Option<IndexMap<String, Entry>>,
    /// Range of the fraction of runs that come to rest, `[low, high]` within 0 and 1.
    pub equilibrium_fraction: Option<Range>,
    /// Range of the fraction of runs that end in a limit cycle, `[low, high]` within 0 and 1.
    pub limit_cycle_fraction: Option<Range>,
    /// Range of the fraction of runs that repeat without an attraction, as without damping, `[low, high]` within 0 and 1.
    pub periodic_fraction: Option<Range>,
    /// Range of the fraction of runs whose contacts creep under a periodic force, `[low, high]` within 0 and 1.
    pub creep_fraction: Option<Range>,
    /// Range of the fraction of runs that move quasi-periodically, `[low, high]` within 0 and 1.
    pub quasi_periodic_fraction: Option<Range>,
    /// Range of the fraction of runs that move irregularly, `[low, high]` within 0 and 1.
    pub irregular_fraction: Option<Range>,
    /// Range of the fraction of runs without sufficient evidence for any other label, `[low, high]`
    /// within 0 and 1.
    pub undecided_fraction: Option<Range>,
    /// Range of the fraction of failed runs, `[low, high]` within 0 and 1.
    pub failed_fraction: Option<Range>,
    /// Range of the fraction of audited runs whose label changes, `[low, high]` within 0 and 1.
    pub audit_flip_rate: Option<Range>,
}
