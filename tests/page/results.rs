//! A folder with files that the program creates.

use std::fs::{self, File};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use arrow::util::display::{ArrayFormatter, FormatOptions};
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use tempfile::TempDir;

/// A directory that is removed at the end of the test.
pub struct Made(TempDir);

impl Made {
    pub fn new() -> Self {
        Made(TempDir::new().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, content: &str) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, content).unwrap();
        path
    }

    /// Runs the program with these arguments, separated by blanks, which must succeed.
    #[track_caller]
    pub fn well(&self, arguments: &str) -> String {
        self.ends(arguments, &[0])
    }

    /// Runs the program for a study in which runs may fail.
    #[track_caller]
    pub fn runs(&self, arguments: &str) -> String {
        self.ends(arguments, &[0, 3])
    }

    #[track_caller]
    fn ends(&self, arguments: &str, codes: &[i32]) -> String {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
        command.args(arguments.split_whitespace()).current_dir(self.0.path());
        let output = command.stdin(Stdio::null()).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(
            codes.iter().any(|code| output.status.code() == Some(*code)),
            "{arguments}\n{said}"
        );
        String::from_utf8(output.stdout).unwrap()
    }

    /// Returns a column of a table, as text.
    pub fn words(&self, table: &str, column: &str) -> Vec<String> {
        let file = File::open(self.path(table)).unwrap();
        let reader = ParquetRecordBatchReaderBuilder::try_new(file).unwrap().build().unwrap();
        let options = FormatOptions::default();
        let mut words = Vec::new();
        for batch in reader.map(Result::unwrap) {
            let cells =
                batch.column_by_name(column).unwrap_or_else(|| panic!("no column {column}"));
            let cells = ArrayFormatter::try_new(cells.as_ref(), &options).unwrap();
            words.extend((0..batch.num_rows()).map(|row| cells.value(row).to_string()));
        }
        words
    }

    /// Returns a column of numbers; missing ones are NaN.
    pub fn numbers(&self, table: &str, column: &str) -> Vec<f64> {
        self.words(table, column).iter().map(|word| word.parse().unwrap_or(f64::NAN)).collect()
    }
}
