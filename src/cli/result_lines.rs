//! Lines of text about results: a point of the sweep, the values of its swept parameters, and failed runs by kind.

use std::collections::BTreeMap;

use crate::classification::{Evidence, Label};
use crate::report::{Fraction, PointFacts, percent, three_digits};
use crate::study::{ParameterValue, Study};
use crate::table::Manifest;

/// Returns a point as one line of text. With `own_machines` the amplitude without balls is a median over the runs.
pub fn point_line(study: &Study, point: &PointFacts, own_machines: bool) -> String {
    let words = point_words(study, point.point_id, &point.swept);
    let mut line = format!("{words}: {} runs", point.runs);
    let unit = study.units().vibration();
    let (vibration, unit) = (|metres: f64| three_digits(unit.of(metres)), &unit.symbol);
    if let Some([worse, ..]) = point.residual.worse_than_without_balls {
        let [_, median, p95] = point.amplitude_m.map(|metres| metres.map(vibration));
        if let (Some(median), Some(p95)) = (median, p95) {
            line += &format!(", vibration {median} {unit} (95 % of the runs: {p95} {unit})");
        }
        if let Some(without) = point.residual.amplitude_without_balls_m {
            let median = if own_machines { " (median)" } else { "" };
            line += &format!(", without balls {} {unit}{median}", vibration(without));
        }
        line += &format!("; {} % of the runs vibrate more than without balls", percent(worse));
    }
    let Fraction { fraction, low, high, .. } = point.equilibrium;
    let [fraction, low, high] = [fraction, low, high].map(percent);
    line += &format!("; {fraction} % at rest ({low} .. {high} %)");
    match point.label(Label::Failed).runs {
        0 => line,
        failed => format!("{line}, {failed} failed"),
    }
}

/// Returns a point and the values of its swept parameters for a message, as `point 3 speed_rad_s=-160` or, with a unit that
/// the study chooses, `point 3 speed=-1528 rpm`.
pub fn point_words(study: &Study, point_id: u64, swept: &[ParameterValue]) -> String {
    let shown = study.shown(swept);
    let each = study.swept().iter().zip(shown).map(|(column, value)| match &column.shown {
        Some(unit) => format!(" {}={value} {}", column.short_name(), unit.symbol),
        None => format!(" {}={value}", column.name),
    });
    format!("point {point_id}{}", each.collect::<String>())
}

/// Returns the number of failed runs of each kind, the most frequent first, as
/// `2 step_limit, 1 contact_lost`; empty if no kind is known.
pub fn kinds_of_failure(failures: &BTreeMap<String, u64>) -> String {
    // A manifest from elsewhere may name anything; only known kinds are shown.
    let known = |kind: &str| Evidence::NAMES.contains(&kind);
    let mut kinds: Vec<(&String, &u64)> =
        failures.iter().filter(|(kind, runs)| known(kind) && **runs > 0).collect();
    kinds.sort_by_key(|(_, runs)| std::cmp::Reverse(**runs));
    let kinds: Vec<String> = kinds.iter().map(|(kind, runs)| format!("{runs} {kind}")).collect();
    kinds.join(", ")
}

/// Returns the number of failed runs of a directory of results.
pub fn failed_runs(manifest: &Manifest) -> u64 {
    manifest.labels.get(Label::Failed.name()).copied().unwrap_or(0)
}

/// Returns a line on the failed runs of a study, or `None` if no run failed.
pub fn failure_line(failures: &BTreeMap<String, u64>, failed: u64, runs: u64) -> Option<String> {
    let kinds = match kinds_of_failure(failures) {
        kinds if kinds.is_empty() => String::new(),
        kinds => format!(": {kinds}"),
    };
    let line = format!(
        "{failed} of {runs} runs failed{kinds} (see the columns evidence and error of runs.parquet)"
    );
    (failed > 0).then_some(line)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::{failure_line, kinds_of_failure};

    #[test]
    fn the_most_frequent_kind_comes_first() {
        let kinds = [("contact_lost", 1), ("no_solution", 0), ("step_limit", 2), ("unheard_of", 9)];
        let failures: BTreeMap<String, u64> =
            kinds.map(|(kind, runs)| (kind.to_owned(), runs)).into();
        assert_eq!(kinds_of_failure(&failures), "2 step_limit, 1 contact_lost");
        let line = failure_line(&failures, 3, 768).unwrap_or_default();
        assert!(
            line.starts_with("3 of 768 runs failed: 2 step_limit, 1 contact_lost (see "),
            "{line}"
        );
        // Results of an earlier version have no kinds.
        let line = failure_line(&BTreeMap::new(), 3, 768).unwrap_or_default();
        assert!(line.starts_with("3 of 768 runs failed (see "), "{line}");
        assert_eq!(failure_line(&failures, 0, 768), None);
    }
}
