//! A new table in a file that the user names: CSV if the name ends in `.csv`, otherwise Parquet; the endings of other formats
//! are refused.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::output::{CliError, csv_header, csv_rows};
use crate::table::column::Column;
use crate::table::{TableFiles, TableWriter, WriteError, temporary_file};

/// Endings of names whose files are expected to have a format that this program does not write.
const OTHER_FORMATS: [&str; 4] = ["tsv", "json", "xlsx", "xls"];

/// The number of rows of CSV that are written together.
const BLOCK: usize = 1024;

/// A table that gets its name when it is complete.
pub enum NewTable<R> {
    /// A Parquet file.
    Parquet(Box<TableWriter<R, TableFiles>>),
    /// A CSV file.
    Csv(CsvTable<R>),
}

/// A CSV file under a temporary name.
pub struct CsvTable<R> {
    path: PathBuf,
    columns: Vec<Column<R>>,
    rows: Vec<R>,
    file: NamedTempFile,
}

impl<R> NewTable<R> {
    /// Starts a table.
    pub fn create(
        path: &Path,
        columns: Vec<Column<R>>,
        provenance: &str,
    ) -> Result<NewTable<R>, CliError> {
        let refused =
            |problem: String, allowed| CliError::Usage(format!("{problem}\n  allowed: {allowed}"));
        if path.exists() {
            let problem = format!("{}: exists already", path.display());
            return Err(refused(problem, "the name of a new file"));
        }
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        if OTHER_FORMATS.iter().any(|other| ending.eq_ignore_ascii_case(other)) {
            let problem =
                format!("{}: stickslip writes tables as Parquet or CSV only", path.display());
            let found = format!("a name that ends in .{ending}");
            let [parquet, csv] = ["parquet", "csv"].map(|ending| path.with_extension(ending));
            let allowed = format!(
                "a name that ends in .parquet or .csv, such as {} or {}",
                parquet.display(),
                csv.display()
            );
            return Err(CliError::refusal(problem, found, allowed));
        }
        let allowed = "the name of a new file in a directory that can be written to";
        if ending.eq_ignore_ascii_case("csv") {
            return CsvTable::create(path, columns)
                .map(NewTable::Csv)
                .map_err(|error| refused(unwritten(path, error).to_string(), allowed));
        }
        TableWriter::create(path, columns, provenance)
            .map(|table| NewTable::Parquet(Box::new(table)))
            .map_err(|error| refused(error.to_string(), allowed))
    }

    /// Adds a row.
    pub fn push(&mut self, row: R) -> Result<(), CliError> {
        match self {
            NewTable::Parquet(table) => Ok(table.push(row)?),
            NewTable::Csv(table) => {
                table.rows.push(row);
                match table.rows.len() {
                    BLOCK => table.flush(),
                    _ => Ok(()),
                }
            }
        }
    }

    /// Gives the complete table its name.
    pub fn finish(self) -> Result<(), CliError> {
        match self {
            NewTable::Parquet(table) => {
                table.finish()?;
                Ok(())
            }
            NewTable::Csv(mut table) => {
                table.flush()?;
                let CsvTable { path, file, .. } = table;
                let synced = file.as_file().sync_all();
                let named = synced.and_then(|()| {
                    file.persist_noclobber(&path).map_err(|error| error.error)?;
                    Ok(())
                });
                Ok(named.map_err(|error| unwritten(&path, error))?)
            }
        }
    }

    /// Removes the incomplete table.
    pub fn abandon(self) -> Result<(), CliError> {
        match self {
            NewTable::Parquet(table) => Ok(table.abandon()?),
            NewTable::Csv(table) => Ok(table.file.close()?),
        }
    }
}

impl<R> CsvTable<R> {
    fn create(path: &Path, columns: Vec<Column<R>>) -> io::Result<Self> {
        let mut file = temporary_file(path)?;
        file.write_all(csv_header(&columns)?.as_bytes())?;
        Ok(CsvTable { path: path.to_owned(), columns, rows: Vec::new(), file })
    }

    fn flush(&mut self) -> Result<(), CliError> {
        let written = csv_rows(&self.columns, &self.rows)
            .and_then(|lines| self.file.write_all(lines.as_bytes()));
        self.rows.clear();
        Ok(written.map_err(|error| unwritten(&self.path, error))?)
    }
}

fn unwritten(path: &Path, cause: io::Error) -> WriteError {
    WriteError { path: path.to_owned(), cause }
}
