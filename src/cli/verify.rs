//! `stickslip verify`: computes a study and checks its expectations.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::arguments::{EngineArguments, StudyArgument};
use super::output::{CliError, End, print};
use super::result_lines::point_words;
use super::run_on_engine::run_on_engine;
use crate::analysis::PointDetail;
use crate::classification::Label;
use crate::engine::{OutputDir, PreparedDirectory, Shard, Sink, say};
use crate::numbers::counted;
use crate::responses::merged;
use crate::study::Study;
use crate::table::{PointRow, RunRecord, WriteError};

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
pub struct Arguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Also write the tables to this directory
    #[arg(long, short, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    engine: EngineArguments,
}

/// Computes the study and checks its expectations.
pub fn verify(arguments: &Arguments) -> Result<End, CliError> {
    let study = arguments.study.load_and_warn(arguments.engine.quiet)?;
    if study.expectations().is_empty() {
        let what = format!("{}: `expect`: missing key", arguments.study.study.display());
        let allowed = "a list such as expect: [{point: {speed_rad_s: -160.0}, equilibrium_fraction: [0.9, 1.0]}]";
        return Err(CliError::refusal(what, "a study without expectations", allowed));
    }
    let options = arguments.engine.options(Shard::WHOLE);
    let mut ready = None;
    if let Some(directory) = &arguments.out {
        let output_dir = OutputDir::new(directory, &options, arguments.engine.quiet);
        let PreparedDirectory::Open(store, results) = output_dir.prepare(&study)? else {
            return Err(CliError::Usage(format!(
                "{}: holds results of this study already\n  allowed: another directory, or \
                 no --out, to verify without tables",
                directory.display()
            )));
        };
        ready = Some((store, results));
    }
    let both = ready.as_mut();
    let both = both.map(|(store, results)| (&mut **store, &mut results.tables as &mut dyn Sink));
    let (store, tables) = both.unzip();
    let (lines, json) = (String::new(), Vec::new());
    let mut findings = Findings { study: &study, tables, lines, json, not_met: 0 };
    let ran = run_on_engine(&study, options, &arguments.engine, store, &mut findings)?;
    let Findings { lines, json, not_met, .. } = findings;
    if let Some((store, results)) = ready {
        store.check()?;
        results.finish(ran.manifest.clone())?;
    }
    let expectations = (!ran.totals.interrupted()).then(|| Value::from(json));
    ran.report(&study, &arguments.engine, arguments.out.as_deref(), expectations)?;
    if ran.totals.interrupted() {
        return Ok(ran.end());
    }
    if !arguments.engine.json && !arguments.engine.quiet {
        print(&lines)?;
    }
    if not_met == 0 {
        return Ok(ran.end());
    }
    if !arguments.engine.quiet {
        say(&format!("{} not met", counted(not_met, "expectation")));
    }
    Ok(End::ExpectationNotMet)
}

/// Checks each point, and passes runs and points to the tables, if any.
struct Findings<'a> {
    study: &'a Study,
    tables: Option<&'a mut dyn Sink>,
    lines: String,
    json: Vec<Value>,
    not_met: u64,
}

impl Sink for Findings<'_> {
    fn run(&mut self, record: RunRecord) -> Result<(), WriteError> {
        self.tables.as_mut().map_or(Ok(()), |tables| tables.run(record))
    }

    fn point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), WriteError> {
        for expectation in self.study.expectations() {
            if !expectation.selects(self.study.swept(), &point.swept) {
                continue;
            }
            for (name, range) in &expectation.fractions {
                let Some(label) = Label::ALL.into_iter().find(|label| label.name() == *name) else {
                    continue;
                };
                let fraction = point.summary.counts.fraction(label);
                let facts = json!({"label": name, "fraction": fraction});
                self.add(&point, &format!("{name} fraction"), Some(fraction), *range, facts);
            }
            if let Some(range) = expectation.audit_flip_rate {
                let rate = point.summary.audit.flip_rate();
                self.add(&point, "audit flip rate", rate, range, json!({"audit_flip_rate": rate}));
            }
        }
        self.tables.as_mut().map_or(Ok(()), |tables| tables.point(point, detail))
    }
}

impl Findings<'_> {
    /// Adds one fraction and its expected range; `None`, the fraction of no runs, does not meet it. `facts` go into the
    /// JSON.
    fn add(
        &mut self,
        point: &PointRow,
        what: &str,
        fraction: Option<f64>,
        [low, high]: [f64; 2],
        facts: Value,
    ) {
        let met = fraction.is_some_and(|fraction| (low..=high).contains(&fraction));
        self.not_met += u64::from(!met);
        let entry = merged(json!({"point_id": point.point_id}), facts);
        self.json.push(merged(entry, json!({"expected": [low, high], "met": met})));
        self.lines += &format!(
            "{}  {}: {what} {}, expected {low} to {high}\n",
            if met { "met    " } else { "NOT MET" },
            point_words(self.study, point.point_id, &point.swept),
            fraction.map_or_else(|| "of no run".to_owned(), |fraction| format!("{fraction:.4}")),
        );
    }
}
