//! Reads the tables of a results directory batch by batch.
//!
//! The manifest, or `files.json` in a directory without one, lists the files of a table. When a table is opened, each file is
//! checked against this list: its size, its hash, its number of rows, and the layout and the study in its metadata under the
//! key `stickslip`. No file makes the program panic or allocate unbounded memory, and only one batch is in memory.

use std::cell::RefCell;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::slice::Iter;
use std::sync::Arc;

use arrow_array::RecordBatch;
use arrow_schema::Schema;
use serde_json::Value;

use super::file_entry::short_hash;
use super::file_list::{FILES, FileList};
use super::manifest::{MANIFEST, Manifest};
use super::provenance::FORMAT;
use super::row::{Batch, Row};
use super::table_error::TableError;
use super::writer::{Destination, MemoryRows, MemoryTable, WriteError};
use crate::sanitize::shorten;
use crate::study::list_names;
use crate::tabular::{self, ColumnValues, Fault, Kind, ParquetFile};

/// A table of a results directory, which is one file or a directory of part files, or a table in memory.
#[derive(Clone, Debug)]
pub struct Table {
    name: String,
    study_hash: String,
    /// The files and their numbers of rows.
    pub(super) parts: Vec<(PathBuf, u64)>,
    /// The rows in memory, which follow those of the files.
    held: Vec<RecordBatch>,
    /// The names and kinds of the columns in order. The kind is `None` for a type that tables of results do not have.
    pub columns: Vec<(String, Option<Kind>)>,
}

impl Table {
    /// Opens a table by its name without `.parquet`, such as `points`.
    ///
    /// # Errors
    /// Returns an error if the manifest lists no such table, if a file is missing or differs from the one that was written, or
    /// if the first file has another layout or belongs to another study.
    pub fn open(directory: &Path, manifest: &Manifest, name: &str) -> Result<Self, TableError> {
        let file = format!("{name}.parquet");
        let parts = manifest.in_directory(directory).check_table(name)?;
        let mut table = Table {
            name: name.to_owned(),
            study_hash: manifest.study_hash.clone(),
            parts,
            held: Vec::new(),
            columns: Vec::new(),
        };
        let Some((path, rows)) = table.parts.first() else {
            let names: Vec<&str> = manifest.files.keys().map(String::as_str).collect();
            let found = match names.is_empty() {
                true => "no tables".to_owned(),
                false => shorten(&names.join(", ")),
            };
            let fault = Fault::new(
                format!("there is no table {file}"),
                found,
                "the results of a finished study; `stickslip resume` finishes it",
            );
            return Err(TableError::new(directory, None, fault));
        };
        table.columns = columns(table.open_part(path, *rows)?.schema());
        Ok(table)
    }

    /// Returns a table in memory as a table to read.
    ///
    /// # Errors
    /// Returns an error if there is no table.
    pub fn of_memory(name: &str, table: Option<MemoryTable>) -> Result<Self, TableError> {
        let Some(MemoryTable { schema, batches }) = table else {
            let fault = Fault::new("there is no such table", "no table", "the tables of a study");
            return Err(TableError::new(Path::new(name), None, fault));
        };
        Ok(Table {
            name: name.to_owned(),
            study_hash: String::new(),
            parts: Vec::new(),
            held: batches,
            columns: columns(&schema),
        })
    }

    /// Opens a table of a directory without a manifest, such as `stickslip equilibria`, `optimize` and `replay` write.
    /// Returns the table and its provenance.
    ///
    /// # Errors
    /// Returns an error if the directory has no list of files or the list has no such table, or if a file differs from the one
    /// that was written or was not written by this program.
    pub fn of_itself(directory: &Path, name: &str) -> Result<(Self, Value), TableError> {
        let path = directory.join(format!("{name}.parquet"));
        let refuse = |problem: &str, found: String, allowed: &str| {
            TableError::new(&path, None, Fault::new(problem, found, allowed))
        };
        let Some(list) = FileList::read(directory)? else {
            let found = format!("no {FILES} in its directory");
            let allowed = "a complete directory written by this program";
            return Err(refuse("this file cannot be verified", found, allowed));
        };
        let parts = list.in_directory(directory).check_table(name)?;
        let Some((first, rows)) = parts.first().cloned() else {
            let found = format!("a file that is not listed in {FILES}");
            return Err(refuse("this file cannot be verified", found, "a listed table"));
        };
        let Some(about) = open_file(&first)?.1 else {
            let found = "no key `stickslip` in the metadata".to_owned();
            let allowed = "a table written by this program";
            return Err(refuse("this table was not written by this program", found, allowed));
        };
        let study_hash = about["study_hash"].as_str().unwrap_or_default().to_owned();
        let (name, held) = (name.to_owned(), Vec::new());
        let mut table = Table { name, study_hash, parts, held, columns: Vec::new() };
        table.columns = columns(table.open_part(&first, rows)?.schema());
        Ok((table, about))
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> u64 {
        let held = self.held.iter().map(|batch| batch.num_rows() as u64);
        self.parts.iter().map(|(_, rows)| *rows).chain(held).fold(0, u64::saturating_add)
    }

    /// Reads some columns from the first row on.
    ///
    /// # Errors
    /// Returns an error if a column is missing or has another kind.
    pub fn read(&self, wanted: &[(&str, Kind)]) -> Result<TableBatches<'_>, TableError> {
        let wanted: Vec<(String, Kind)> =
            wanted.iter().map(|(name, kind)| ((*name).to_owned(), *kind)).collect();
        let path = self.parts.first().map_or(Path::new(""), |(path, _)| path);
        find(path, &self.columns, &wanted)?;
        let (parts, held) = (self.parts.iter(), self.held.iter());
        Ok(TableBatches { table: self, wanted, parts, part: None, held, next_row: 0 })
    }

    /// Reads each row.
    ///
    /// # Errors
    /// Returns an error if a column is missing or has another kind, and as an item if a file cannot be read.
    pub fn read_rows<'a, T: 'a>(
        &'a self,
        read: impl Fn(&Row<'_>) -> T + 'a,
    ) -> Result<impl Iterator<Item = Result<T, TableError>> + 'a, TableError> {
        let batches = self.read_for(&read)?;
        Ok(batches.flat_map(move |batch| match batch {
            Ok(batch) => (0..batch.rows).map(|row| Ok(read(&batch.row(row)))).collect(),
            Err(error) => vec![Err(error)],
        }))
    }

    /// Passes each row to `take`, which does nothing if all values are missing.
    ///
    /// # Errors
    /// Returns an error if a column is missing or has another kind, or if a file cannot be read.
    pub fn for_each(&self, mut take: impl FnMut(&Row<'_>)) -> Result<(), TableError> {
        for batch in self.read_for(&mut take)? {
            let batch = batch?;
            (0..batch.rows).for_each(|row| take(&batch.row(row)));
        }
        Ok(())
    }

    /// Reads the columns that a reader asks for.
    fn read_for<T>(
        &self,
        mut read: impl FnMut(&Row<'_>) -> T,
    ) -> Result<TableBatches<'_>, TableError> {
        let asked = RefCell::default();
        read(&Row::asked(&self.columns, &asked));
        let asked = asked.into_inner();
        self.read(&asked.iter().map(|(name, kind)| (&**name, *kind)).collect::<Vec<_>>())
    }

    /// The table in memory, in full, as it was when it was written.
    pub fn in_memory(&self) -> Result<MemoryTable, TableError> {
        let mut table = None;
        for (path, rows) in &self.parts {
            let refuse = |fault| TableError::new(path, None, fault);
            let part = self.open_part(path, *rows)?;
            let schema = part.written_schema().map_err(refuse)?;
            let all: Vec<usize> = (0..schema.fields().len()).collect();
            let batches = part.batches(&all, &schema).map_err(refuse)?;
            let table = table.get_or_insert_with(|| MemoryRows::of_schema(schema));
            for batch in batches {
                table.write(Ok(batch.map_err(refuse)?)).map_err(|error| differing(path, &error))?;
            }
        }
        // An open table has at least one part.
        let table = table.unwrap_or_else(|| MemoryRows::of_schema(Arc::new(Schema::empty())));
        let first = self.parts.first().map_or(Path::new(""), |(path, _)| path);
        table.finish().map_err(|error| differing(first, &error))
    }

    /// Opens a file of the table and checks its number of rows and its metadata.
    pub(super) fn open_part(&self, path: &Path, rows: u64) -> Result<ParquetFile, TableError> {
        let refuse = |fault| TableError::new(path, None, fault);
        let (file, provenance) = open_file(path)?;
        let facts = |value: &Value| {
            let text = |key: &str| shorten(value[key].as_str().unwrap_or("none"));
            format!(
                "layout {}, table {}, study {}, hash {}",
                value["format"].as_u64().map_or("none".to_owned(), |format| format.to_string()),
                text("table"),
                text("study"),
                short_hash(&text("study_hash")),
            )
        };
        let belongs = provenance.as_ref().is_some_and(|value| {
            value["format"] == FORMAT
                && value["table"] == *self.name
                && value["study_hash"] == *self.study_hash
        });
        if !belongs {
            let found = provenance.as_ref().map_or("no key `stickslip`".to_owned(), facts);
            let allowed = format!(
                "layout {FORMAT}, table {}, hash {}",
                self.name,
                short_hash(&self.study_hash)
            );
            let problem = "this is not a table of these results";
            return Err(refuse(Fault::new(problem, found, allowed)));
        }
        if file.rows() != rows {
            return Err(refuse(Fault::new(
                "wrong number of rows",
                format!("{} rows", file.rows()),
                format!("{rows}, as listed in {MANIFEST}"),
            )));
        }
        Ok(file)
    }
}

fn differing(file: &Path, error: &WriteError) -> TableError {
    let problem = "the parts of this table have different columns";
    let allowed = "the files that were written";
    TableError::new(file, None, Fault::new(problem, error.cause.to_string(), allowed))
}

/// Returns the names and kinds of the columns.
fn columns(schema: &Schema) -> Vec<(String, Option<Kind>)> {
    let fields = schema.fields().iter();
    fields.map(|field| (field.name().clone(), Kind::of(field.data_type()))).collect()
}

/// Opens a file and reads its provenance, or `None` if it has none.
fn open_file(path: &Path) -> Result<(ParquetFile, Option<Value>), TableError> {
    let file = open(path)?;
    let provenance = file.metadata("stickslip").and_then(|text| serde_json::from_str(text).ok());
    Ok((file, provenance))
}

/// Opens a file.
pub(super) fn open(path: &Path) -> Result<ParquetFile, TableError> {
    let file = File::open(path).map_err(|error| {
        Fault::new("this file cannot be read", error.to_string(), "a readable file")
    });
    let file = file.and_then(ParquetFile::on_disk);
    file.map_err(|fault| TableError::new(path, None, fault))
}

/// Returns the indices of the wanted columns.
fn find(
    path: &Path,
    columns: &[(String, Option<Kind>)],
    wanted: &[(String, Kind)],
) -> Result<Vec<usize>, TableError> {
    let place = |(name, kind): &(String, Kind)| {
        let Some(index) = columns.iter().position(|(column, _)| column == name) else {
            let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
            let fault = Fault::new(
                "there is no such column",
                format!("columns {}", list_names(name, &names)),
                format!("a column {name} of {}", kind.name()),
            );
            return Err(TableError::new(path, Some(name), fault));
        };
        let found = columns.get(index).and_then(|(_, kind)| *kind);
        if found == Some(*kind) {
            return Ok(index);
        }
        let found = found.map_or("another type", Kind::name);
        let fault = Fault::new("wrong type", format!("a column of {found}"), kind.name());
        Err(TableError::new(path, Some(name), fault))
    };
    wanted.iter().map(place).collect()
}

/// The rows of some columns, in order.
pub struct TableBatches<'a> {
    table: &'a Table,
    wanted: Vec<(String, Kind)>,
    parts: Iter<'a, (PathBuf, u64)>,
    part: Option<(&'a Path, tabular::ParquetBatches)>,
    held: Iter<'a, RecordBatch>,
    next_row: u64,
}

impl TableBatches<'_> {
    fn advance(&mut self) -> Result<Option<Batch>, TableError> {
        loop {
            if let Some((path, batches)) = &mut self.part {
                let refuse = |fault| TableError::new(path, None, fault);
                if let Some(batch) = batches.next().transpose().map_err(refuse)? {
                    return self.wanted_of(&batch).map(Some).map_err(refuse);
                }
                self.part = None;
            }
            let Some((path, rows)) = self.parts.next() else {
                let held = self.held.next().map(|batch| self.wanted_of(batch)).transpose();
                return held.map_err(|fault| TableError::new(Path::new(""), None, fault));
            };
            let part = self.table.open_part(path, *rows)?;
            let places = find(path, &columns(part.schema()), &self.wanted)?;
            let batches = part.batches(&places, part.schema());
            self.part = Some((path, batches.map_err(|fault| TableError::new(path, None, fault))?));
        }
    }

    /// Returns the wanted columns of the next rows.
    fn wanted_of(&mut self, batch: &RecordBatch) -> Result<Batch, Fault> {
        let (first_row, rows) = (self.next_row, batch.num_rows());
        self.next_row += rows as u64;
        let columns = self.wanted.iter().map(|(name, kind)| {
            let values = batch.column_by_name(name).and_then(ColumnValues::of);
            // `find` has compared the kinds of the columns.
            Ok((name.clone(), values.ok_or_else(|| Fault::damaged(kind.name()))?))
        });
        let columns = columns.collect::<Result<_, Fault>>()?;
        Ok(Batch { first_row, rows, columns })
    }
}

impl Iterator for TableBatches<'_> {
    type Item = Result<Batch, TableError>;

    fn next(&mut self) -> Option<Self::Item> {
        let batch = self.advance();
        if batch.is_err() {
            // The iteration ends after an error.
            self.part = None;
            (self.parts, self.held) = ([].iter(), [].iter());
        }
        batch.transpose()
    }
}
