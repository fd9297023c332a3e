//! How the results of two studies differ: points with equal swept values, and for each quantity both estimates and their
//! difference with its interval.
//!
//! If both studies have the same start states at a point, their runs are pairs (common random numbers), and the interval of a
//! difference accounts for the correlation of each pair.

use std::collections::{BTreeSet, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};

use serde::Serialize;

use super::data::heading;
use crate::analysis::{Estimate, Measure, RunResult, estimate_difference};
use crate::classification::Label;
use crate::study::{AmplitudeKind, ParameterValue, Response, Study, Unit, changed_keys};
use crate::table::{Table, TableError};

/// The study and the tables of a directory of results.
pub struct ComparedResults<'a> {
    /// The study.
    pub study: &'a Study,
    /// `points.parquet`.
    pub points: &'a Table,
    /// `runs.parquet`.
    pub runs: &'a Table,
}

/// The differences of two studies; a difference is that of the second study from the first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The keys that differ, with both values.
    pub changed_keys: Vec<String>,
    /// The points that both studies have.
    pub points: Vec<ComparedPoint>,
    /// The number of points of each study without a counterpart.
    pub points_without_counterpart: [u64; 2],
}

/// A point that both studies have.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparedPoint {
    /// Its numbers in both studies.
    pub point_ids: [u64; 2],
    /// The swept values in words, in the units of the first study; empty without a common swept parameter.
    pub title: String,
    /// Whether the runs of both studies have the same start states.
    pub same_start_states: bool,
    /// The quantities.
    pub quantities: Vec<ComparedQuantity>,
}

/// A quantity of a point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparedQuantity {
    /// The name of a response, or the words of a quantity, such as `median vibration`.
    pub name: String,
    /// The unit in which people read it.
    #[serde(skip)]
    pub unit: Unit,
    /// The estimate of the first study.
    pub first: Estimate,
    /// The estimate of the second study.
    pub second: Estimate,
    /// The second estimate minus the first.
    pub difference: Estimate,
}

/// A quantity of both studies.
struct ComparableQuantity {
    name: String,
    unit: Unit,
    /// The columns of the value, of both ends of its interval and, for a response, of its standard error.
    columns: Vec<String>,
    /// What is estimated from which amplitude; `None` for the fraction at rest.
    measured: Option<(Measure, AmplitudeKind)>,
}

/// A run as comparisons see it.
#[derive(Clone, Copy, Debug)]
struct ComparedRun {
    /// Hash of the start state.
    start: u64,
    /// Number of its cell.
    cell: u64,
    label: Option<Label>,
    /// Residual, relative and peak amplitude.
    amplitudes: [Option<f64>; 3],
    time_to_rest_s: Option<f64>,
}

/// A point with its estimates and runs.
struct ResultPoint {
    point_id: u64,
    swept: Vec<ParameterValue>,
    estimates: Vec<Estimate>,
    runs: Vec<ComparedRun>,
}

/// Compares the results of two studies.
///
/// # Errors
/// Returns an error if a table lacks a column or cannot be read.
pub fn compare(results: [&ComparedResults<'_>; 2]) -> Result<Comparison, TableError> {
    let studies = results.map(|result| result.study);
    let [first, second] = studies;
    let quantities = quantities(studies);
    let [first_points, second_points] = results.map(|result| points(result, &quantities));
    let (first_points, second_points) = (first_points?, second_points?);
    let swept = first.swept().iter().chain(second.swept());
    let names: BTreeSet<&str> = swept.map(|column| column.name.as_str()).collect();
    let keys = second_points.iter().enumerate();
    let keys: HashMap<String, usize> =
        keys.filter_map(|(place, point)| Some((key(second, point, &names)?, place))).collect();
    let mut compared = Vec::new();
    let mut has_counterpart = vec![false; second_points.len()];
    for point in &first_points {
        let place = key(first, point, &names).and_then(|key| keys.get(&key).copied());
        let Some(place) = place.filter(|place| !has_counterpart[*place]) else { continue };
        has_counterpart[place] = true;
        compared.push(compared_point(first, second, &quantities, [point, &second_points[place]]));
    }
    let missing = has_counterpart.iter().filter(|has| !**has).count();
    Ok(Comparison {
        changed_keys: changed_keys(first, second),
        points_without_counterpart: [(first_points.len() - compared.len()) as u64, missing as u64],
        points: compared,
    })
}

fn quantities([first, second]: [&Study; 2]) -> Vec<ComparableQuantity> {
    let percent = || Unit { symbol: "%".to_owned(), si: 0.01 };
    let quantity = |name: &str, unit, columns: [&str; 3], measured| ComparableQuantity {
        name: name.to_owned(),
        unit,
        columns: columns.map(str::to_owned).into(),
        measured,
    };
    let rest = ["equilibrium_fraction", "ci_low", "ci_high"];
    let mut list = vec![quantity("at rest", percent(), rest, None)];
    let quantile = |fraction| Some((Measure::Quantile(fraction), AmplitudeKind::Residual));
    if [first, second].iter().all(|study| study.model().kind().offers.vibration) {
        let unit = || first.units().vibration();
        let median = ["amplitude_p50_m", "amplitude_p50_low_m", "amplitude_p50_high_m"];
        let most = ["amplitude_p95_m", "amplitude_p95_low_m", "amplitude_p95_high_m"];
        let worse = [
            "worse_than_without_balls_fraction",
            "worse_than_without_balls_low",
            "worse_than_without_balls_high",
        ];
        let above = Some((Measure::Above(1.0), AmplitudeKind::RelativeResidual));
        list.push(quantity("median vibration", unit(), median, quantile(0.5)));
        list.push(quantity("95 % of the runs", unit(), most, quantile(0.95)));
        list.push(quantity("worse than without balls", percent(), worse, above));
    }
    let common = first.responses().iter().filter(|response| second.responses().contains(response));
    list.extend(common.map(|response: &Response| ComparableQuantity {
        name: response.name.clone(),
        unit: response.shown_unit(first.units()),
        columns: ["", "_low", "_high", "_standard_error"].map(|end| response.column() + end).into(),
        measured: Some((response.measure, response.amplitude)),
    }));
    list
}

/// Reads the points and their runs.
fn points(
    results: &ComparedResults<'_>,
    list: &[ComparableQuantity],
) -> Result<Vec<ResultPoint>, TableError> {
    let ComparedResults { study, points, runs } = results;
    let mut all: Vec<ResultPoint> = Vec::new();
    points.for_each(|row| {
        let estimate = |quantity: &ComparableQuantity| {
            let number = |place: usize| row.number(quantity.columns.get(place)?);
            let [value, low, high, standard_error] = [0, 1, 2, 3].map(number);
            Estimate { value, low, high, standard_error, reason: None }
        };
        let estimates = list.iter().map(estimate).collect();
        let known = row.count("point_id").filter(|point_id| *point_id < study.point_count());
        all.extend(known.map(|point_id| {
            let swept = study.point(point_id).swept;
            ResultPoint { point_id, swept, estimates, runs: Vec::new() }
        }));
    })?;
    let names = runs.columns.iter().map(|(name, _)| name.as_str());
    let starts: Vec<&str> = names.filter(|name| name.starts_with("initial_")).collect();
    let mut place = 0;
    runs.for_each(|row| {
        let (point_id, label) = (row.count("point_id"), row.label());
        let mut start = DefaultHasher::new();
        for name in &starts {
            row.number(name).unwrap_or(f64::NAN).to_bits().hash(&mut start);
        }
        let run = ComparedRun {
            start: start.finish(),
            cell: row.count("cell").unwrap_or_default(),
            label,
            amplitudes: ["amplitude_m", "relative_amplitude", "peak_amplitude_m"]
                .map(|name| row.number_if_there(name)),
            time_to_rest_s: row.number("time_to_rest_s"),
        };
        let Some(point_id) = point_id else { return };
        // Runs are in the order of the points.
        while all.get(place).is_some_and(|point| point.point_id < point_id) {
            place += 1;
        }
        if let Some(point) = all.get_mut(place).filter(|point| point.point_id == point_id) {
            point.runs.push(run);
        }
    })?;
    Ok(all)
}

/// Returns the values of these parameters at a point, rounded, as a key; `None` if the study lacks one of them.
fn key(study: &Study, point: &ResultPoint, names: &BTreeSet<&str>) -> Option<String> {
    let at = study.point(point.point_id);
    let value = |name: &&str| match study.value_at(&at, name)? {
        ParameterValue::Number(number) => Some(format!("{number:.9e};")),
        ParameterValue::Text(text) => Some(format!("{text};")),
    };
    names.iter().map(value).collect()
}

fn compared_point(
    first: &Study,
    second: &Study,
    list: &[ComparableQuantity],
    [left, right]: [&ResultPoint; 2],
) -> ComparedPoint {
    let starts = |point: &ResultPoint| point.runs.iter().map(|run| run.start).collect::<Vec<_>>();
    let paired = !left.runs.is_empty() && starts(left) == starts(right);
    let quantity = |(place, quantity): (usize, &ComparableQuantity)| {
        let [before, after] = [left, right].map(|point| &point.estimates[place]);
        let correlation = if paired {
            let [a, b] = [(left, before), (right, after)]
                .map(|(point, estimate)| contributions(quantity.measured, &point.runs, estimate));
            let is_stratified = first.point(left.point_id).cells.is_some();
            let cell = |run: &ComparedRun| if is_stratified { run.cell } else { 0 };
            let cells: Vec<u64> = left.runs.iter().map(cell).collect();
            correlation(&cells, &a, &b)
        } else {
            0.0
        };
        ComparedQuantity {
            name: quantity.name.clone(),
            unit: quantity.unit.clone(),
            difference: estimate_difference(after, before, correlation),
            first: before.clone(),
            second: after.clone(),
        }
    };
    let is_common = |column: usize| {
        let name = first.swept().get(column).map(|parameter| &parameter.name);
        second.swept().iter().any(|parameter| Some(&parameter.name) == name)
    };
    ComparedPoint {
        point_ids: [left.point_id, right.point_id],
        title: heading(first, &left.swept, is_common),
        same_start_states: paired,
        quantities: list.iter().enumerate().map(quantity).collect(),
    }
}

/// Returns what each run contributes to an estimate; a run without a result contributes no number.
fn contributions(
    measured: Option<(Measure, AmplitudeKind)>,
    runs: &[ComparedRun],
    estimate: &Estimate,
) -> Vec<f64> {
    let Some((measure, kind)) = measured else {
        let rests = |run: &ComparedRun| match run.label {
            Some(Label::Failed) => f64::NAN,
            label => f64::from(u8::from(label == Some(Label::Equilibrium))),
        };
        return runs.iter().map(rests).collect();
    };
    let result = |run: &ComparedRun| RunResult {
        cell: run.cell,
        label: run.label.unwrap_or(Label::Undecided),
        amplitude: match kind {
            AmplitudeKind::Residual => run.amplitudes[0],
            AmplitudeKind::RelativeResidual => run.amplitudes[1],
            AmplitudeKind::Peak => run.amplitudes[2],
            // The runs of both studies count as independent.
            AmplitudeKind::Output(..) => None,
        },
        time_to_rest_s: run.time_to_rest_s,
        end_time_s: None,
    };
    let results: Vec<RunResult> = runs.iter().map(result).collect();
    measure.contributions(&results, estimate.value.unwrap_or(f64::NAN))
}

/// Returns the correlation of the pairs of finite numbers within their cells; 0 if one of them does not vary.
fn correlation(cells: &[u64], left: &[f64], right: &[f64]) -> f64 {
    let pairs = || {
        let pairs = cells.iter().zip(left.iter().zip(right));
        pairs.filter(|(_, (a, b))| a.is_finite() && b.is_finite())
    };
    let mut sums: HashMap<u64, [f64; 3]> = HashMap::new();
    for (cell, (a, b)) in pairs() {
        let [count, sum, other] = sums.entry(*cell).or_default();
        (*count, *sum, *other) = (*count + 1.0, *sum + a, *other + b);
    }
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for (cell, (a, b)) in pairs() {
        let [count, sum, other] = sums[cell];
        let (x, y) = (a - sum / count, b - other / count);
        (aa, bb, ab) = (aa + x * x, bb + y * y, ab + x * y);
    }
    let scale = (aa * bb).sqrt();
    if scale > 0.0 { (ab / scale).clamp(-1.0, 1.0) } else { 0.0 }
}
