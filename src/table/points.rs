//! `points.parquet`: one row per point of the sweep.

use super::column::{Column, Columns, read_into};
use super::estimate::add_estimate;
use super::row::Row;
use super::run_record::ResponseSamples;
use super::runs::add_swept;
use crate::analysis::{
    Estimate, HalfWidths, IntervalMethod, PointSummary, ResidualVibration, set_fraction,
    touching_set_fraction,
};
use crate::classification::Label;
use crate::model::{ExistenceVerdict, Machine};
use crate::study::{ParameterValue, Point, Precision, Study};

impl From<Precision> for HalfWidths {
    fn from(precision: Precision) -> HalfWidths {
        let amplitude_m = precision.amplitudes_m();
        HalfWidths { equilibrium_fraction: precision.equilibrium_fraction, amplitude_m }
    }
}

/// The largest number of runs that is read; the sum over all labels is a number.
const MOST_RUNS: u64 = 1 << 56;

/// Adds a column of numbers that are written from a place in a row, and read into it.
macro_rules! number {
    ($list:expr, $name:expr, $unit:literal, $row:ident => $place:expr) => {
        $list
            .number($name, $unit, move |$row: &PointRow| $place)
            .reads(move |$row: &mut PointRow, read, name| $place = read.number(name))
    };
}

/// One point of the sweep with the results of its runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointRow {
    /// Number of the point, from 0.
    pub point_id: u64,
    /// Values of the swept parameters, in the order of [`crate::study::Plan::swept`].
    pub swept: Vec<ParameterValue>,
    /// Summary of its runs.
    pub summary: PointSummary,
    /// One estimate per response, in the order of [`Study::responses`].
    pub responses: Vec<Estimate>,
    /// The value of each response for the machines without balls, if they have one.
    pub responses_without_balls: Vec<Option<f64>>,
    /// Fraction of all ball positions that are equilibria.
    pub set_fraction: Option<f64>,
    /// Fraction of the positions in which two balls touch that are equilibria.
    pub touching_set_fraction: Option<f64>,
    /// Whether stick and slip always have exactly one solution.
    pub existence: Option<ExistenceVerdict>,
}

impl PointRow {
    /// Creates the row of a point.
    pub fn new(point: &Point, summary: PointSummary, samples: &ResponseSamples<'_>) -> Self {
        PointRow {
            point_id: point.point_id,
            swept: point.swept.clone(),
            summary,
            responses: samples.estimates(),
            responses_without_balls: samples.values_without_balls(),
            set_fraction: point.model().ball_balancer().and_then(set_fraction),
            touching_set_fraction: point.model().ball_balancer().and_then(touching_set_fraction),
            // Nothing is proven for balls that touch.
            existence: point
                .model()
                .ball_balancer()
                .filter(|machine| machine.contact.is_none())
                .map(Machine::existence),
        }
    }

    /// Reads a row of `points.parquet` with the columns of its study; `None` if its number is missing. Values of swept
    /// parameters are taken from the study, and the verdict on uniqueness is not read.
    pub fn read(study: &Study, columns: &[Column<PointRow>], row: &Row<'_>) -> Option<PointRow> {
        let mut point = PointRow::default();
        let balls = study.model().kind().offers.vibration;
        for response in study.responses() {
            point.responses.push(row.estimate(&response.column()));
            let has_value = balls && response.has_value_without_balls();
            let value = || row.number(&response.column_without_balls());
            point.responses_without_balls.push(if has_value { value() } else { None });
        }
        read_into(columns, row, &mut point);
        point.point_id = row.count("point_id")?;
        if point.point_id < study.point_count() {
            point.swept = study.point(point.point_id).swept;
        }
        Some(point)
    }
}

/// Returns the columns of `points.parquet`.
pub fn point_columns(study: &Study) -> Vec<Column<PointRow>> {
    let mut list = Columns::<PointRow>::new();
    list.point_id(|row| row.point_id);
    add_swept(&mut list, study, |row: &PointRow| &row.swept);
    list.count("runs", |row| row.summary.counts.total())
        .meaning("finished runs, including failed runs");
    for label in Label::ALL {
        list.count(format!("{}_runs", label.name()), move |row| row.summary.counts.of(label))
            .reads(move |row, read, name| {
                let runs = read.count(name).unwrap_or(0).min(MOST_RUNS);
                row.summary.counts.add_many(label, runs);
            })
            .meaning(format!("runs with the label {}", label.name()));
    }
    add_fractions(&mut list);
    for (index, fraction) in PointSummary::TIME_FRACTIONS.into_iter().enumerate() {
        let percent = (100.0 * fraction).round();
        let name = format!("time_to_rest_p{percent:02}_s");
        number!(list, name, "s", row => row.summary.time_to_rest_s[index]).meaning(format!(
            "time by which {percent} % of the runs are at rest (Kaplan-Meier); null if not reached"
        ));
    }
    add_median_and_escape(&mut list);
    for (index, fraction) in PointSummary::AMPLITUDE_FRACTIONS.into_iter().enumerate() {
        let percent = (100.0 * fraction).round();
        let name = format!("amplitude_p{percent:02}_m");
        number!(list, name, "m", row => row.summary.amplitude_m[index]).meaning(format!(
            "quantile {percent} % of the amplitude over all runs except failed runs"
        ));
    }
    for (index, fraction) in PointSummary::AMPLITUDE_FRACTIONS.into_iter().enumerate() {
        let percent = (100.0 * fraction).round();
        for (end, (name, words)) in [("low", "lower"), ("high", "upper")].into_iter().enumerate() {
            let name = format!("amplitude_p{percent:02}_{name}_m");
            number!(list, name, "m", row => row.summary.amplitude_interval_m[index][end])
            .meaning(format!(
                "{words} end of the 95 % confidence interval of amplitude_p{percent:02}_m, between \
                 two runs; null if too few runs bound it"
            ));
        }
    }
    list.number("basin_entropy", "1", |row| row.summary.basin_entropy).meaning(
        "basin entropy (Daza and others 2016): mean over the cells of a stratified design of the \
         entropy -sum p ln p of the outcomes of the runs in the cell (Zhang's estimate); outcomes \
         are rest, each class of limit cycles, quasi-periodic, irregular and undecided; null without cells with \
         at least two runs that did not fail",
    );
    let half_widths = study.precision().map(HalfWidths::from);
    list.boolean("precision_reached", move |row| Some(half_widths?.reached(&row.summary))).meaning(
        "whether the half widths of the 95 % confidence intervals are at most those of the \
             study's precision; null without a precision",
    );
    add_audit(&mut list, study);
    if study.model().kind().offers.vibration {
        let touches =
            study.model().ball_balancer().is_some_and(|machine| machine.contact.is_some());
        add_machine(&mut list, touches);
        add_residual_vibration(&mut list);
    }
    let balls = study.model().kind().offers.vibration;
    for (index, response) in study.responses().iter().enumerate() {
        let (name, unit, meaning) = (response.column(), response.unit(), response.meaning());
        add_estimate(&mut list, &name, unit, &meaning, move |row| row.responses.get(index));
        if balls && response.has_value_without_balls() {
            list.number(response.column_without_balls(), unit, move |row| {
                row.responses_without_balls.get(index).copied().flatten()
            })
            .meaning(format!("value of {name} for the machines of the runs without balls"));
        }
    }
    list.finish()
}

/// Adds the fraction of equilibria, and the simultaneous confidence intervals of the fractions of
/// all labels.
fn add_fractions(list: &mut Columns<PointRow>) {
    let nan = f64::NAN;
    list.number("equilibrium_fraction", "1", |row| row.summary.equilibrium_fraction)
        .reads(move |row, read, name| {
            row.summary.equilibrium_fraction = read.number(name).unwrap_or(nan);
        })
        .meaning(
        "fraction of runs that ended in equilibrium by the end time (extended runs: by the later \
         end time); if ci_method is stratified, every cell has the same weight",
    );
    list.number("ci_low", "1", |row| row.summary.interval.low)
        .reads(move |row, read, name| row.summary.interval.low = read.number(name).unwrap_or(nan))
        .meaning("lower end of its 95 % confidence interval (counts no failed run as equilibrium)");
    list.number("ci_high", "1", |row| row.summary.interval.high)
        .reads(move |row, read, name| row.summary.interval.high = read.number(name).unwrap_or(nan))
        .meaning(
            "upper end of its 95 % confidence interval (counts all failed runs as equilibrium)",
        );
    list.word("ci_method", |row| row.summary.interval.method.name())
        .reads(|row, read, name| {
            let method = read.text(name);
            let found = IntervalMethod::ALL.iter().find(|known| Some(known.name()) == method.as_deref());
            row.summary.interval.method = found.copied().unwrap_or_default();
        })
        .meaning(
        "method of the confidence interval: wilson; or stratified, from the variation within the \
         cells of the design (Yan and Su, with bounds), for at least two runs per cell and at most \
         65,536 cells",
    );
    for (index, label) in Label::ALL.into_iter().enumerate() {
        let name = label.name();
        list.number(format!("{name}_low"), "1", move |row| {
            row.summary.counts.intervals()[index].0
        })
        .meaning(format!(
            "lower end of the confidence interval of the fraction of {name} runs; the intervals of \
             all labels hold simultaneously with 95 % (Goodman, with Bonferroni's points)"
        ));
        let failures = match label {
            Label::Failed => "",
            _ => "; counts all failed runs as this label",
        };
        list.number(format!("{name}_high"), "1", move |row| {
            row.summary.counts.intervals()[index].1
        })
        .meaning(format!("upper end of that interval{failures}"));
    }
}

/// Adds the confidence interval of the median time to rest, and the rate at which late runs come to
/// rest.
fn add_median_and_escape(list: &mut Columns<PointRow>) {
    list.number("time_to_rest_p50_low_s", "s", |row| row.summary.median_interval_s[0]).meaning(
        "lower end of the 95 % confidence interval of the median time to rest (Brookmeyer and \
         Crowley, log(-log) curve)",
    );
    list.number("time_to_rest_p50_high_s", "s", |row| row.summary.median_interval_s[1])
        .meaning("upper end of that interval; null if not reached");
    list.number("escape_rate_per_s", "1/s", |row| Some(row.summary.escape?.rate_per_s)).meaning(
        "constant rate at which runs that still move after escape_from_s come to rest; null if no \
         tail with at least 10 rests and a tenth of all rests is exponential",
    );
    list.number("escape_rate_low_per_s", "1/s", |row| Some(row.summary.escape?.interval_per_s.0))
        .meaning("lower end of its 95 % confidence interval (Garwood)");
    list.number("escape_rate_high_per_s", "1/s", |row| Some(row.summary.escape?.interval_per_s.1))
        .meaning("upper end of its 95 % confidence interval (Garwood)");
    list.number("escape_from_s", "s", |row| Some(row.summary.escape?.from_s)).meaning(
        "earliest time after which a constant rate is not rejected (Kolmogorov, level 0.1)",
    );
}

/// Adds how often the label of an audited run changes; null in a study without an audit.
fn add_audit(list: &mut Columns<PointRow>, study: &Study) {
    let is_audited = study.audit().is_some();
    let audit = move |row: &PointRow| is_audited.then_some(row.summary.audit);
    list.count("audited_runs", move |row| audit(row).map(|audit| audit.runs))
        .reads(|row, read, name| row.summary.audit.runs = read.count(name).unwrap_or(0))
        .meaning(
            "runs recomputed by the other method with a tenth of both tolerances; null without an \
         audit",
        );
    list.count("audit_flips", move |row| audit(row).map(|audit| audit.flips))
        .reads(|row, read, name| row.summary.audit.flips = read.count(name).unwrap_or(0))
        .meaning("audited runs whose label changed");
    list.count("audit_rest_flips", move |row| audit(row).map(|audit| audit.rest_flips))
        .reads(|row, read, name| row.summary.audit.rest_flips = read.count(name).unwrap_or(0))
        .meaning("audited runs that were an equilibrium in only one of the two computations");
    list.number("audit_flip_rate", "1", move |row| audit(row)?.flip_rate())
        .meaning("fraction of audited runs whose label changed");
    list.number("audit_flip_low", "1", move |row| audit(row).map(|audit| audit.interval().0))
        .meaning("lower end of its 95 % confidence interval (Wilson)");
    list.number("audit_flip_high", "1", move |row| audit(row).map(|audit| audit.interval().1))
        .meaning("upper end of its 95 % confidence interval (Wilson)");
}

/// Adds the properties of the ball balancer at the point.
fn add_machine(list: &mut Columns<PointRow>, touches: bool) {
    number!(list, "amplitude_without_balls_m", "m", row => row.summary.residual.amplitude_without_balls_m)
    .meaning(
        "median over the runs that did not fail of the amplitude of each run's own machine without \
         balls, whose mass is also removed",
    );
    number!(list, "set_fraction", "1", row => row.set_fraction).meaning(
        "fraction of all ball positions that are equilibria: exact for one ball, to about 0.001 \
         for two and 0.005 for three or more balls; uncertain parameters at their medians",
    );
    if touches {
        list.number("touching_set_fraction", "1", |row| row.touching_set_fraction).meaning(
            "fraction of the positions in which two balls touch that are equilibria, with the force between the \
             balls",
        );
    }
    list.word("uniqueness", |row| row.existence.as_ref().map_or("", ExistenceVerdict::word)).meaning(
        "unique: stick and slip provably have exactly one solution at all positions and for all \
         forces; not_unique: some runs may end in no_solution; uncertain parameters at their medians",
    );
    list.number("min_principal_minor", "1", |row| {
        row.existence.as_ref().map(ExistenceVerdict::least_minor)
    })
    .meaning(
        "criterion of uniqueness: the smallest principal minor of the contact matrix over all \
         positions, divided by the product of its diagonal entries; 1 if the balls are not \
         coupled, 0 or less if the solution is not unique",
    );
}

/// Adds the vibration that the balls leave, against the machine without balls.
fn add_residual_vibration(list: &mut Columns<PointRow>) {
    let worse = |end: usize| {
        move |row: &PointRow| Some(row.summary.residual.worse_than_without_balls?[end])
    };
    // The fraction and its interval are known together.
    let read_worse = |end: usize| {
        move |row: &mut PointRow, read: &Row<'_>, name: &str| {
            let worse = &mut row.summary.residual.worse_than_without_balls;
            let before = if end == 0 { Some([f64::NAN; 3]) } else { *worse };
            *worse = before.zip(read.number(name)).map(|(mut all, number)| {
                all[end] = number;
                all
            });
        }
    };
    list.number("worse_than_without_balls_fraction", "1", worse(0))
        .reads(read_worse(0))
        .meaning(
        "fraction of the runs that vibrate more than their own machine without balls, which has the \
         parameters drawn for the run, of all runs that did not fail",
    );
    list.number("worse_than_without_balls_low", "1", worse(1)).reads(read_worse(1)).meaning(
        "lower end of its 95 % confidence interval (Wilson; counts no failed run as vibrating more)",
    );
    list.number("worse_than_without_balls_high", "1", worse(2)).reads(read_worse(2)).meaning(
        "upper end of its 95 % confidence interval (counts all failed runs as vibrating more)",
    );
    for (index, fraction) in PointSummary::AMPLITUDE_FRACTIONS.into_iter().enumerate() {
        let percent = (100.0 * fraction).round();
        let name = format!("relative_amplitude_p{percent:02}");
        number!(list, name, "1", row => row.summary.residual.relative_amplitude[index]).meaning(
            format!("quantile {percent} % of relative_amplitude over the runs that did not fail"),
        );
    }
    for (index, fraction) in ResidualVibration::GRADE_FRACTIONS.into_iter().enumerate() {
        let percent = (100.0 * fraction).round();
        let name = format!("balance_quality_grade_p{percent:02}_mm_s");
        number!(list, name, "mm/s", row => row.summary.residual.balance_quality_grade_mm_s[index])
        .meaning(format!(
            "quantile {percent} % over the equilibria of the balance quality grade G that is left \
             (ISO 21940-11, with the whole vibrating mass)"
        ));
    }
    number!(list, "overlapping_rest_fraction", "1", row => row.summary.residual.overlapping_rest_fraction)
    .meaning(
        "fraction of the equilibria at which two balls are nearer to each other than their \
         diameters allow; 0 with model.contact",
    );
}
