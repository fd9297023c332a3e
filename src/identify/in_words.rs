//! The result of an inference, as JSON and in words, with warnings of a posterior that leans on an end of its prior and of too
//! few simulated runs.

use serde_json::{Value, json};

use super::fit_test::{SiteFit, TESTED};
use super::inference::{Inference, Inferred};
use super::posterior::{Marginal, Posterior};
use crate::numbers::four_digits;
use crate::printed_table::{PrintedTable, as_text};
use crate::study::DesignValue;

/// The model does not explain the measured runs if the smallest probability over all sites, corrected for their number, is
/// below this level.
const LEVEL: f64 = 0.05;
/// Correlations above this are shown.
const CORRELATED: f64 = 0.5;

/// Returns the contents of `identification.json`; `measured` is the hash of the measured runs.
pub fn identification_json(inference: &Inference, inferred: &Inferred, measured: &str) -> Value {
    let study = inference.study;
    let Posterior { marginals, correlations, .. } = &inferred.posterior;
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
        "parameters": marginals,
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
    table.add("95 % interval", |marginal| range([marginal.low, marginal.high]));
    table.add("prior", |marginal| range(marginal.prior));
    table.add("width/prior", |marginal| format!("{:.2}", marginal.width_over_prior));
    let mut text = as_text(&table.columns);
    let mut line = |words: String| text.push_str(&(words + "\n"));
    for marginal in marginals.iter().filter(|marginal| !marginal.identified) {
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

/// Errors from the number of simulated runs above this give a warning, over the standard deviation of the posterior.
const INACCURATE: f64 = 0.5;
/// The fewest parameter sets from which this error is estimated, for each coefficient of the local quadratic regression.
const SETS_PER_COEFFICIENT: usize = 10;
/// A wider prior is proposed: wider by the first of these parts of its width that gives a possible machine.
const WIDER: [f64; 3] = [0.5, 0.2, 0.1];

/// Returns the warnings, each with the key, what was found, and a remedy.
pub fn warnings(inference: &Inference, inferred: &Inferred) -> Vec<String> {
    let Inference { study, identification, .. } = *inference;
    let marginals = &inferred.posterior.marginals;
    let medians: Vec<f64> = marginals.iter().map(|marginal| marginal.median).collect();
    let leaning = |(index, marginal): (usize, &Marginal)| {
        let (key, name) = (marginal.leans_on?, &marginal.name);
        let (end, side) =
            if key == "from" { (marginal.prior[0], -1.0) } else { (marginal.prior[1], 1.0) };
        // Beyond an end that is a limit of the physics, such as a friction of 0, nothing can be true.
        let wider = WIDER.iter().find_map(|part| {
            let mut place = identification.place_of(&medians);
            place[index] = 0.5 + side * (0.5 + part);
            let values = identification.values_at(&place);
            let numbers: Vec<DesignValue> =
                values.iter().map(|value| DesignValue::Number(*value)).collect();
            study.set(&numbers).is_ok().then(|| four_digits(values[index]))
        })?;
        let [end, low, high] = [end, marginal.low, marginal.high].map(four_digits);
        Some(format!(
            "identify.parameters.{name}.{key}: the posterior leans on this end of the prior, and the true value may be \
             beyond it\n  found:  {end}, and a 95 % interval from {low} to {high}\n  remedy: a wider prior, such as {key}: \
             {wider}"
        ))
    };
    let inaccurate = |marginal: &Marginal| {
        let (sets, runs) = (inferred.sets.len(), study.run_count());
        let few = match fewest_sets(inferred) {
            fewest if sets < fewest => format!(" (an estimate that needs at least {fewest} sets)"),
            _ => String::new(),
        };
        format!(
            "identify.designs: too few simulated runs for an accurate posterior of {}\n  found:  {sets} parameter sets with \
             {runs} runs each, which give an error of about {:.1} standard deviations{few}; the interval may be too narrow or \
             misplaced by that much or more, and all inferences from these runs share the error\n  remedy: more parameter sets \
             (start_designs and designs), or more runs in each, before the interval is used",
            marginal.name, marginal.simulation_error
        )
    };
    let leaning = marginals.iter().enumerate().filter_map(leaning);
    leaning
        .chain(marginals.iter().filter(|marginal| !is_accurate(inferred, marginal)).map(inaccurate))
        .collect()
}

/// Returns whether enough runs are simulated for the posterior of a parameter.
pub(super) fn is_accurate(inferred: &Inferred, marginal: &Marginal) -> bool {
    marginal.simulation_error <= INACCURATE && inferred.sets.len() >= fewest_sets(inferred)
}

fn fewest_sets(inferred: &Inferred) -> usize {
    let parameters = inferred.posterior.marginals.len();
    SETS_PER_COEFFICIENT * (parameters + 1) * (parameters + 2) / 2
}
