//! The study file exactly as written: types for reading, writing and the JSON Schema.
//!
//! Nothing here is checked beyond its form; `resolve` does that and fills in the defaults.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::evaluation_file::{ResponseFile, VariableFile};
use super::file_values::{Balls, Count, Entry, Listed, Named, Range, Table};
use super::optimize_file::OptimizeFile;
use super::schema;

/// A study for stickslip: one machine, the points of a sweep, and sampled start states at each.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(title = "stickslip study")]
pub struct StudyFile {
    /// Version of the study file's format; this program reads version 1.
    #[schemars(extend("const" = 1))]
    pub schema: u64,
    /// Name of the study: letters, digits, `-`, `_` and `.`, for example for its results' folder.
    #[schemars(length(min = 1, max = 100), regex(pattern = r"^[A-Za-z0-9_-][A-Za-z0-9._-]*$"))]
    pub name: String,
    /// Master seed of every random draw, from 0 to 2^64 - 1.
    pub seed: u64,
    /// What is simulated.
    pub model: ModelFile,
    /// Blocks of points, joined one after another; without it there is one point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sweep: Option<Vec<BlockFile>>,
    /// Parameters that are drawn anew for every run, each with its distribution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "schema::uncertain")]
    pub uncertain: Option<Named<DistributionFile>>,
    /// Where the runs start.
    pub initial_conditions: InitialConditionsFile,
    /// How runs are integrated and for how long.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub simulation: Option<SimulationFile>,
    /// How precisely the fraction of equilibria is wanted at each point; without it each point has the
    /// runs that its design names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub precision: Option<PrecisionFile>,
    /// A fraction of the runs that is computed a second time in another way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub audit: Option<AuditFile>,
    /// What `stickslip verify` holds the results against.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub expect: Option<Vec<ExpectationFile>>,
    /// What `stickslip evaluate` varies: variables by name. A parameter or `balls` takes `from` and
    /// `to`; any other name is a choice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub design: Option<Named<VariableFile>>,
    /// What `stickslip evaluate` answers with: responses by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub responses: Option<Named<ResponseFile>>,
    /// What `stickslip optimize` looks for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub optimize: Option<OptimizeFile>,
}

/// The model with its parameters.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    /// Kind of machine.
    pub kind: ModelKind,
    /// Parameters in SI units; what is not given has the value of the thesis's machine, or of a
    /// block of 1 kg on a spring of 100 N/m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parameters: Option<ParametersFile>,
    /// Law of friction; the default is `coulomb`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionFile>,
    /// How the normal force between ball and ring is derived; the default is `lagrange`. Only of a
    /// ball balancer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal_force: Option<NormalForceKind>,
}

/// Kinds of machine.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelKind {
    /// Table on springs, turning disc with an imbalance, balls in a ring.
    BallBalancer,
    /// A block on a spring, on rigid ground.
    BlockOnSpring,
    /// A block on a spring, on a moving belt.
    BlockOnBelt,
}

/// Laws of friction. Speeds are sliding speeds: of a ball relative to the ring in rad/s, of a block
/// in m/s.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FrictionFile {
    /// Dry friction: the friction force is at most the coefficient times the normal force.
    Coulomb,
    /// Dry friction whose coefficient falls with speed from a static to a kinetic value, the
    /// `friction_coefficient`: `μ + (μ_s - μ) exp(-|v| / v_s)`.
    Stribeck(StribeckFile),
    /// Friction that grows from zero at rest, as `μ f_n (2/π) atan(v / v_0)`: it never holds
    /// anything.
    Smooth(SmoothFile),
    /// A drag in proportion to speed; no dry friction.
    Viscous {
        /// Drag over sliding speed, N s/m.
        #[schemars(extend("minimum" = 0))]
        viscous_coefficient_n_s_m: f64,
    },
}

/// Settings of the Stribeck law; one of the two speeds.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct StribeckFile {
    /// Coefficient of friction at rest, not below `friction_coefficient`.
    #[schemars(extend("minimum" = 0))]
    pub static_friction_coefficient: f64,
    /// Speed of a ball over which friction falls to its kinetic value, rad/s; at 0 it drops at
    /// once.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub stribeck_speed_rad_s: Option<f64>,
    /// The same of a block, m/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub stribeck_speed_m_s: Option<f64>,
}

/// Settings of the smooth law; one of the two speeds.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SmoothFile {
    /// Speed of a ball at which friction reaches half of its limit, rad/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub smoothing_speed_rad_s: Option<f64>,
    /// The same of a block, m/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub smoothing_speed_m_s: Option<f64>,
}

/// Derivations of the normal force.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NormalForceKind {
    /// From Lagrange's equations with the rolling constraint put in first, as in the thesis.
    Lagrange,
    /// From Newton's second law for the ball's centre.
    Newton,
}

/// Parameters in SI units: of a ball balancer, or `mass_kg`, `stiffness_n_m`, `normal_force_n`,
/// `friction_coefficient` and (on a belt) `belt_speed_m_s` of a block.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ParametersFile {
    /// Mass of table, motor, ring and disc, without imbalance and balls, kg.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub table_mass_kg: Option<f64>,
    /// Stiffness of the suspension per direction, or of a block's spring, N/m.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub stiffness_n_m: Option<f64>,
    /// Viscous damping of the suspension per direction, N s/m.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub damping_n_s_m: Option<f64>,
    /// Distance from the ring's centre to the balls' centres, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub ring_radius_m: Option<f64>,
    /// Mass of the imbalance, kg.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub imbalance_mass_kg: Option<f64>,
    /// Distance of the imbalance from the ring's centre, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub imbalance_radius_m: Option<f64>,
    /// Number of balls, 1 to 8, or a list with one entry per ball where they differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub balls: Option<Balls>,
    /// Mass of each ball that has none of its own, kg.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub ball_mass_kg: Option<f64>,
    /// Diameter of each ball that has none of its own, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub ball_diameter_m: Option<f64>,
    /// Coefficient of friction, dimensionless: of each ball that has none of its own, or of a block;
    /// the kinetic one where the law has a static one, too.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub friction_coefficient: Option<f64>,
    /// Prescribed speed of the disc, rad/s; negative turns clockwise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed_rad_s: Option<f64>,
    /// Mass of a block, kg.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mass_kg: Option<f64>,
    /// Force that presses a block on the ground, N.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub normal_force_n: Option<f64>,
    /// Speed of the belt, m/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub belt_speed_m_s: Option<f64>,
}

/// One ball; what is not given is as for all balls.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BallFile {
    /// Mass, kg.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mass_kg: Option<f64>,
    /// Diameter, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub diameter_m: Option<f64>,
    /// Coefficient of friction between ball and ring, dimensionless.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0))]
    pub friction_coefficient: Option<f64>,
}

/// A block of points: exactly one of `grid`, `zip` and `table`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BlockFile {
    /// Every combination of the listed values; the last key changes fastest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "schema::swept")]
    pub grid: Option<Named<Listed>>,
    /// The first values together, then the second ones, and so on; lists of equal length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "schema::swept")]
    pub zip: Option<Named<Listed>>,
    /// One point per row of a table whose columns are named as parameters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table: Option<Table>,
    /// Sampling of the start states at this block's points, instead of
    /// `initial_conditions.design`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub design: Option<DesignFile>,
}

/// A distribution of a parameter, in the parameter's own unit.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DistributionFile {
    /// Normal. A draw that makes no physical sense, such as a negative mass, is a failed run.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation, positive.
        std_dev: f64,
    },
    /// Normal, cut off at both ends.
    TruncatedNormal {
        /// Mean before the cut.
        mean: f64,
        /// Standard deviation before the cut, positive.
        std_dev: f64,
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
    },
    /// Log-normal, given by mean and standard deviation of the parameter itself (not of its
    /// logarithm).
    Lognormal {
        /// Mean of the parameter, positive.
        mean: f64,
        /// Standard deviation of the parameter, positive.
        std_dev: f64,
    },
    /// Uniform.
    Uniform {
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
    },
    /// Triangular.
    Triangular {
        /// Smallest value.
        min: f64,
        /// Most likely value.
        mode: f64,
        /// Largest value.
        max: f64,
    },
    /// One of several values.
    Choice {
        /// The values.
        values: Vec<f64>,
        /// Their weights, zero or more, in any scale; without them all values are equally likely.
        #[serde(skip_serializing_if = "Option::is_none")]
        weights: Option<Vec<f64>>,
    },
    /// The parameter's own value, also one of a sweep or a design, times a number that is drawn from one
    /// of the other distributions.
    Times(Box<DistributionFile>),
}

/// Start states: a box of non-dimensional coordinates and how it is sampled.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct InitialConditionsFile {
    /// Ranges `[low, high]` per coordinate. Ball balancer: lengths over the ring radius, time times
    /// the natural frequency; `beta` and `beta_dot` for every ball, `beta_1` and so on for one.
    /// Block: `position_m` and `velocity_m_s`.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "schema::start_box")]
    pub start_box: Option<Named<Range>>,
    /// How the box is sampled; may be left out only where every block of the sweep has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub design: Option<DesignFile>,
}

/// A sampling design for start states.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DesignFile {
    /// Every axis cut into equal parts, uniform samples in each cell of the box.
    Stratified {
        /// Parts per axis.
        parts_per_axis: Count,
        /// Samples in each cell.
        samples_per_cell: Count,
    },
    /// One sample in each of `samples` equal parts of every axis.
    LatinHypercube {
        /// Number of samples; another number gives other samples.
        samples: Count,
    },
    /// A scrambled Sobol' sequence, best with a power of two.
    Sobol {
        /// Number of samples, at most 65536.
        samples: Count,
    },
    /// Independent uniform samples.
    MonteCarlo {
        /// Number of samples.
        samples: Count,
    },
    /// The midpoints of equal parts of every axis.
    Grid {
        /// Points per axis.
        points_per_axis: Count,
    },
    /// Given start states: columns `x`, `y`, `beta_1` ..., `x_dot`, `y_dot`, `beta_dot_1` ...; of a
    /// block `position_m` and `velocity_m_s`.
    Table(Table),
}

/// How runs are integrated and for how long.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SimulationFile {
    /// How stick and slip are computed; the default is `switch`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<MethodKind>,
    /// Half width of the band around zero sliding speed, over the natural frequency (of a block: over
    /// natural frequency times the length that the normal force stretches the spring by).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub band: Option<f64>,
    /// When a run that has not ended by itself is stopped, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub end_time_s: Option<f64>,
    /// Continues runs of which no ending is known at the end time; without it every run is stopped
    /// there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extend: Option<ExtendFile>,
    /// Which endings are looked for; the default is `all`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub endings: Option<EndingsKind>,
    /// Error allowed per integration step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<ToleranceFile>,
}

/// Which endings of runs are looked for.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EndingsKind {
    /// Rest, limit cycles and irregular motion.
    All,
    /// Rest only: what does not come to rest is `undecided`. Runs that come to rest are the same, and a
    /// study takes about two thirds of the time.
    Rest,
}

/// How far runs are continued past the end time, and which. What comes of a run that is continued is
/// what comes of it in a study with the later end time.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ExtendFile {
    /// The time to which they are continued, over `end_time_s`: more than 1, at most 1000.
    #[schemars(extend("exclusiveMinimum" = 1, "maximum" = 1000))]
    pub factor: f64,
    /// Labels at the end time with which runs are continued; both by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "schema::extended_labels")]
    pub labels: Option<Vec<String>>,
}

/// Methods for stick and slip.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MethodKind {
    /// The switch model with a band of finite width.
    Switch,
    /// Its limit as the band goes to zero, the exact motion; does not use `band`.
    Event,
}

/// Error allowed per integration step.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ToleranceFile {
    /// Relative error, dimensionless.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub relative: Option<f64>,
    /// Absolute error, non-dimensional.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub absolute: Option<f64>,
}

/// Sampling that goes on at each point, in whole replicates of its design (one sample in every cell of
/// a stratified one, `samples` more of `monte_carlo` and `sobol`; others cannot be enlarged), until
/// the 95 % interval of the fraction of equilibria is narrow enough.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PrecisionFile {
    /// Half the width of the interval from `ci_low` to `ci_high` at which sampling stops, above 0 and
    /// below 0.5.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 0.5))]
    pub equilibrium_fraction: f64,
    /// The most runs at each point (not of the study): no replicate is begun that would exceed it. The
    /// samples that the design names are always run. A Sobol' sequence ends after 65536.
    pub max_runs: Count,
}

/// A second computation of some runs, by the other method with a tenth of both tolerances, to see how
/// often the ending depends on how it was computed.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct AuditFile {
    /// Fraction of the runs, above 0 and at most 1; which ones is drawn for each run.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub fraction: f64,
}

/// Fractions of runs per label that are expected at some points; at least one fraction.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ExpectationFile {
    /// Values of swept parameters; every point that has them is meant, all points without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "schema::selector")]
    pub point: Option<Named<Entry>>,
    /// Fraction of runs that come to rest, `[low, high]` between 0 and 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub equilibrium_fraction: Option<Range>,
    /// Fraction of runs that end in a limit cycle, `[low, high]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_cycle_fraction: Option<Range>,
    /// Fraction of runs that move irregularly, `[low, high]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub irregular_fraction: Option<Range>,
    /// Fraction of runs without enough evidence for any end, `[low, high]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub undecided_fraction: Option<Range>,
    /// Fraction of runs that failed, `[low, high]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failed_fraction: Option<Range>,
    /// Fraction of audited runs whose label is another when they are computed again, `[low, high]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub audit_flip_rate: Option<Range>,
}
