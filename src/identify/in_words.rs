//! The result of an inference, as JSON and in words.

use serde_json::{Value, json};

use super::fit_test::{SiteFit, TESTED};
use super::inference::{Inference, Inferred};
use super::posterior::{Marginal, Posterior};
use super::warnings::{is_accurate, warnings};
use crate::numbers::four_digits;
use crate::printed_table::{PrintedTable, as_text};

/// The model does not explain the measured runs if the smallest probability over all sites, corrected for their number, is
/// below this level.
const LEVEL: f64 = 0.05;
/// Correlations above this are shown.
const CORRELATED: f64 = 0.5;

/// Returns the contents of `identification.json`; `measured` is the hash of the measured runs.
pub fn identification_json(inference: &Inference, inferred: &Inferred, measured: &str) -> Value {
    let study = inference.study;
    let Posterior { marginals, correlations, .. } = &inferred.posterior;
    let marginal = |(parameter, width): (&Marginal, &f64)| {
        json!({
            "parameter": parameter.name,
            "unit": parameter.unit,
            "prior": parameter.prior,
            "mean": parameter.mean,
            "std_dev": parameter.std_dev,
            "median": parameter.median,
            "low": parameter.interval[0],
            "high": parameter.interval[1],
            "width_over_prior": parameter.width_over_prior,
            "identified": parameter.is_identified(),
            "simulation_error": parameter.simulation_error,
            "leans_on": parameter.leans_on,
            "regression_width": width,
        })
    };
    let fit = |site: &SiteFit| {
        json!({
            "point_id": site.point.point_id,
            "stage": site.stage,
            "measured_rests": site.measured[0],
            "measured_moving": site.measured[1],
            "tested_runs": site.tested,
            "predicted_rest_fraction": site.predicted_rest_fraction,
            "p_positions": site.p_positions,
            "p_neighbours": site.p_neighbours,
            "p_value": site.p_value(),
        })
    };
    json!({
        "study": study.name(),
        "study_hash": study.hash(),
        "measured_sha256": measured,
        "parameter_sets": inferred.sets.len(),
        "runs": inferred.runs[0],
        "failed": inferred.runs[1],
        "parameters": marginals.iter().zip(&inferred.widths).map(marginal).collect::<Vec<_>>(),
        "correlations": correlations,
        "fit": {
            "sites": inferred.fits.iter().map(fit).collect::<Vec<_>>(),
            "p_value": p_value(&inferred.fits),
            "rejected": p_value(&inferred.fits) < LEVEL,
        },
        "warnings": warnings(inference, inferred),
    })
}

/// Returns the smallest probability over all sites, corrected for their number (Bonferroni).
fn p_value(fits: &[SiteFit]) -> f64 {
    let smallest = fits.iter().map(SiteFit::p_value).fold(1.0, f64::min);
    (smallest * fits.len() as f64).min(1.0)
}

/// Returns the result in words.
pub fn result_in_words(inference: &Inference, inferred: &Inferred) -> String {
    let Posterior { marginals, correlations, .. } = &inferred.posterior;
    let range = |[low, high]: [f64; 2]| format!("{} to {}", four_digits(low), four_digits(high));
    let mut table = PrintedTable::new(marginals, "");
    table.add("parameter", |marginal| marginal.name.clone()).left();
    table.add("unit", |marginal| marginal.unit.to_owned()).left();
    table.add("median", |marginal| four_digits(marginal.median));
    table.add("95 % interval", |marginal| range(marginal.interval));
    table.add("prior", |marginal| range(marginal.prior));
    table.add("width/prior", |marginal| format!("{:.2}", marginal.width_over_prior));
    let mut text = as_text(&table.columns);
    let mut line = |words: String| text.push_str(&(words + "\n"));
    for marginal in marginals.iter().filter(|marginal| !marginal.is_identified()) {
        line(format!(
            "{} is not identified: its interval has {:.0} % of the width of the prior's",
            marginal.name,
            100.0 * marginal.width_over_prior
        ));
    }
    for (marginal, row) in marginals.iter().zip(correlations) {
        let later =
            marginals.iter().zip(row).skip_while(|(other, _)| other.name != marginal.name).skip(1);
        for (other, correlation) in later.filter(|(_, value)| value.abs() > CORRELATED) {
            line(format!("correlation of {} and {}: {correlation:.2}", marginal.name, other.name));
        }
    }
    text.push('\n');
    text.push_str(&fit_in_words(inference, inferred));
    text
}

fn fit_in_words(inference: &Inference, inferred: &Inferred) -> String {
    let Inference { study, sites, .. } = *inference;
    let mut table = PrintedTable::new(&inferred.fits, "");
    let shown: Vec<_> = inferred.fits.iter().map(|fit| study.shown(&fit.point.swept)).collect();
    table.add_point(|fit| fit.point.point_id, study.swept(), &shown);
    if study.has_stages() {
        table.add("stage", |fit| fit.stage.to_string());
    }
    table.add("rests", |fit| fit.measured[0].to_string());
    table.add("moving", |fit| fit.measured[1].to_string());
    table.add("predicted rests [%]", |fit| format!("{:.0}", 100.0 * fit.predicted_rest_fraction));
    table.add("p", |fit| format!("{:.3}", fit.p_value()));
    let mut text = as_text(&table.columns);
    let probability = p_value(&inferred.fits);
    let runs: u64 = sites.iter().map(super::site::Site::runs).sum();
    let verdict = match probability < LEVEL {
        true => "The model does not explain",
        false => "The model explains",
    };
    text.push_str(&format!(
        "{verdict} the {runs} measured runs (p = {probability:.3} over all rows; level {LEVEL}).\n"
    ));
    let is_accurate = |marginal| is_accurate(inferred, marginal);
    if probability < LEVEL && !inferred.posterior.marginals.iter().all(is_accurate) {
        text.push_str("The simulated runs are too few for this verdict, too; see the warning.\n");
    }
    if inferred.fits.iter().any(|fit| fit.tested < fit.measured.iter().sum::<u64>()) {
        text.push_str(&format!(
            "In rows with more than {TESTED} measured runs, the test compares {TESTED} of them, drawn at random.\n"
        ));
    }
    text
}
