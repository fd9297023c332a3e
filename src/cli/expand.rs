//! `stickslip expand`: writes the cases of a study without computing them.

use std::path::PathBuf;

use clap::Args;

use super::arguments::StudyArgument;
use super::new_table::NewTable;
use super::output::{CliError, End, OutputReader, csv_header, csv_rows, print};
use crate::engine::Shard;
use crate::study::PlannedRun;
use crate::table::column::Columns;
use crate::table::{planned_columns, provenance};

const EXAMPLES: &str = "\
Examples:
  stickslip expand study.yaml | head
  stickslip expand study.yaml --out cases.parquet
  stickslip expand study.yaml --shard 1/1000        one case in a thousand";

/// Write the cases of a study (parameters and start states) without computing them
///
/// In a study with `precision`, the output contains all cases up to `max_runs` of each point. `stickslip run`
/// computes the runs.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    study: StudyArgument,

    /// Parquet or CSV file to write, such as cases.parquet (above 524,288 cases a directory of Parquet files); without
    /// --out the cases go to standard output as CSV
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,

    /// Only part K of N of the runs; in a study with `precision`, of the points
    #[arg(long, value_name = "K/N", default_value = "1/1")]
    shard: Shard,
}

/// Rows per batch of CSV output.
const PIECE: usize = 1024;

/// Writes the cases.
pub fn expand(arguments: &Arguments) -> Result<End, CliError> {
    let study = arguments.study.load()?;
    let mut list = Columns::<PlannedRun>::new();
    list.extend(planned_columns::<PlannedRun>(&study, |planned| planned));
    list.text("error", |row| row.case.as_ref().err().map(ToString::to_string))
        .meaning("why the case cannot be computed");
    let columns = list.finish();
    let mut cases = arguments.shard.run_ids(&study).map(|run_id| study.planned_run(run_id));
    if let Some(path) = &arguments.out {
        let mut table = NewTable::create(path, columns, &provenance(&study, "cases"))?;
        cases.try_for_each(|case| table.push(case))?;
        table.finish()?;
        return Ok(End::Well);
    }
    let mut reader = print(&csv_header(&columns)?)?;
    while reader != OutputReader::Gone {
        let rows: Vec<PlannedRun> = cases.by_ref().take(PIECE).collect();
        if rows.is_empty() {
            break;
        }
        reader = print(&csv_rows(&columns, &rows)?)?;
    }
    Ok(End::Well)
}
