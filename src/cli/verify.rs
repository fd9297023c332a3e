//! `stickslip verify`: computes a study and checks its expectations.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::arguments::{EngineArguments, StudyArgument};
use super::exit::{CliError, End};
use super::output::print;
use super::run_on_engine::run_on_engine;
use crate::classification::Label;
use crate::engine::{OutputDir, Ready, Shard, say};
use crate::study::Study;
use crate::table::PointRow;

const EXAMPLES: &str = "\
Examples:
  stickslip verify studies/smoke.yaml
  stickslip verify studies/smoke.yaml --threads 2 --out results/smoke

Computes the study and prints one line per entry under `expect`, met or NOT MET; with --json, one entry of the \
list `expectations`. The exit code is 4 if an expectation is not met. With --out the tables are written as by \
`stickslip run`; `stickslip replay` then shows single runs.";

/// Compute a study and check its expectations
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct VerifyArguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Also write the tables to this directory
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    engine: EngineArguments,
}

/// Computes the study and checks its expectations.
///
/// # Errors
/// Returns the errors of `run`, and an error if the study has no `expect`.
pub fn verify(arguments: &VerifyArguments) -> Result<End, CliError> {
    let study = arguments.study.load()?;
    if study.expectations().is_empty() {
        return Err(CliError::Usage(format!(
            "{}: `expect`: missing key\n  found:   a study without expectations\n  allowed: a list \
             such as expect: [{{point: {{speed_rad_s: -160.0}}, equilibrium_fraction: [0.9, 1.0]}}]",
            arguments.study.study.display()
        )));
    }
    let options = arguments.engine.options(Shard::WHOLE);
    let mut ready = match &arguments.out {
        Some(directory) => {
            let output_dir = OutputDir {
                directory,
                shard: options.shard,
                retry_failed: options.retry_failed,
                recompute: false,
                shards: &[],
                quiet: arguments.engine.quiet,
            };
            match output_dir.prepare(&study)? {
                Ready::Complete(_) => {
                    let message = format!(
                        "{}: holds results of this study already\n  allowed: another directory, or \
                         no --out, to verify without tables",
                        directory.display()
                    );
                    return Err(CliError::Usage(message));
                }
                Ready::Open(store, results) => Some((store, results)),
            }
        }
        None => None,
    };
    let (store, mut results) = match &mut ready {
        Some((store, results)) => (Some(&mut **store), Some(results)),
        None => (None, None),
    };
    let mut findings = Findings::default();
    let ran = run_on_engine(&study, options, &arguments.engine, store, |record, point| {
        if let Some((point, _)) = &point {
            findings.check(&study, point);
        }
        match (&mut results, record, point) {
            (Some(results), Some(record), _) => results.push_run(record),
            (Some(results), _, Some((point, detail))) => results.push_point(point.clone(), detail),
            _ => Ok(()),
        }
    })?;
    if let Some((store, results)) = ready {
        store.check()?;
        results.finish(&study, ran.circumstances.clone())?;
    }
    let expectations = (!ran.totals.interrupted()).then(|| Value::from(findings.json));
    ran.report(&study, &arguments.engine, arguments.out.as_deref(), expectations)?;
    if ran.totals.interrupted() {
        return Ok(ran.end());
    }
    if !arguments.engine.json && !arguments.engine.quiet {
        print(&findings.lines)?;
    }
    Ok(if findings.not_met > 0 {
        if !arguments.engine.quiet {
            let plural = if findings.not_met == 1 { "" } else { "s" };
            say(&format!("{} expectation{plural} not met", findings.not_met));
        }
        End::ExpectationNotMet
    } else if ran.totals.counts.of(Label::Failed) > 0 {
        End::RunsFailed
    } else {
        End::Well
    })
}

/// The checks so far.
#[derive(Default)]
struct Findings {
    lines: String,
    json: Vec<Value>,
    not_met: u64,
}

impl Findings {
    fn check(&mut self, study: &Study, point: &PointRow) {
        for expectation in study.expectations() {
            if !expectation.selects(study.swept(), &point.swept) {
                continue;
            }
            for (name, range) in &expectation.fractions {
                let Some(label) = Label::ALL.into_iter().find(|label| label.name() == *name) else {
                    continue;
                };
                let fraction = point.summary.counts.fraction(label);
                let keys = [("label", json!(name)), ("fraction", json!(fraction))];
                self.add(study, point, &format!("{name} fraction"), Some(fraction), *range, &keys);
            }
            if let Some(range) = expectation.audit_flip_rate {
                let rate = point.summary.audit.flip_rate();
                let keys = [("audit_flip_rate", json!(rate))];
                self.add(study, point, "audit flip rate", rate, range, &keys);
            }
        }
    }

    /// Adds one fraction and its expected range; `None`, the fraction of no runs, does not meet it. `keys` go into the
    /// JSON.
    fn add(
        &mut self,
        study: &Study,
        point: &PointRow,
        what: &str,
        fraction: Option<f64>,
        [low, high]: [f64; 2],
        keys: &[(&str, Value)],
    ) {
        let met = fraction.is_some_and(|fraction| (low..=high).contains(&fraction));
        self.not_met += u64::from(!met);
        let mut entry = json!({"point_id": point.point_id});
        for (key, value) in keys {
            entry[*key] = value.clone();
        }
        entry["expected"] = json!([low, high]);
        entry["met"] = met.into();
        self.json.push(entry);
        let columns = study.swept().iter().zip(&point.swept);
        let place: Vec<String> =
            columns.map(|(column, value)| format!("{}={value}", column.name)).collect();
        self.lines += &format!(
            "{}  point {} {}: {what} {}, expected {low} to {high}\n",
            if met { "met    " } else { "NOT MET" },
            point.point_id,
            place.join(" "),
            fraction.map_or_else(|| "of no run".to_owned(), |fraction| format!("{fraction:.4}")),
        );
    }
}
