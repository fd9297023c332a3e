//! Resolution of sampling designs, including their tables.

use std::sync::Arc;

use crate::model::Model;
use crate::study::error::{Fault, Locate, StudyError, shorten};
use crate::study::file::key_path::KeyPath;
use crate::study::file::study_file::DesignFile;
use crate::study::file::table_folders::TableFolders;
use crate::study::file::table_input::Rows;
use crate::study::file::values::{Entry, InlineTable, TableSource};
use crate::study::sampling::initial_box::axis_names;
use crate::study::sampling::sampling_design::{Layout, MAX_SOBOL_SAMPLES};

/// A validated layout, and the design in the form of a self-contained study file.
#[derive(Clone)]
pub(crate) struct ResolvedDesign {
    /// The layout.
    pub layout: Layout,
    /// The design with inline tables.
    pub file: DesignFile,
    /// Key path of the design.
    pub path: KeyPath,
}

/// Validates a sampling design.
///
/// # Errors
/// Returns an error if a Sobol' sequence has too many samples, or if a table of start states is
/// invalid.
pub(crate) fn resolve_design(
    locate: &dyn Locate,
    folders: &TableFolders,
    path: &KeyPath,
    written: &DesignFile,
    model: &Model,
) -> Result<ResolvedDesign, StudyError> {
    let layout = match written {
        DesignFile::Stratified { parts_per_axis, samples_per_cell } => {
            Layout::Stratified { parts: parts_per_axis.0, samples_per_cell: samples_per_cell.0 }
        }
        DesignFile::LatinHypercube { samples } => Layout::LatinHypercube { samples: samples.0 },
        DesignFile::Sobol { samples } => {
            if samples.0 > MAX_SOBOL_SAMPLES {
                let allowed = format!("at most {MAX_SOBOL_SAMPLES}, or another design");
                let fault = Fault::new("too many samples", samples.0.to_string(), allowed);
                return Err(locate.refuse_value(&path.key("sobol").key("samples"), fault));
            }
            Layout::Sobol { samples: samples.0 }
        }
        DesignFile::MonteCarlo { samples } => Layout::MonteCarlo { samples: samples.0 },
        DesignFile::Grid { points_per_axis } => Layout::Grid { points: points_per_axis.0 },
        DesignFile::Table(table) => {
            return resolve_starts(locate, folders, path, table, model);
        }
    };
    Ok(ResolvedDesign { layout, file: written.clone(), path: path.clone() })
}

fn resolve_starts(
    locate: &dyn Locate,
    folders: &TableFolders,
    path: &KeyPath,
    table: &TableSource,
    model: &Model,
) -> Result<ResolvedDesign, StudyError> {
    let names = axis_names(model);
    let table_path = path.key("table");
    let read = Rows::read(locate, folders, &table_path, table, &names)?;
    let mut order = Vec::with_capacity(names.len());
    for name in &names {
        let Some(column) = read.columns.iter().position(|column| column == name) else {
            let found = read.columns.join(", ");
            let fault = Fault::new("a missing column", found, format!("a column `{name}`"));
            return Err(read.refuse(locate, None, None, fault));
        };
        order.push(column);
    }
    let mut rows = Vec::with_capacity(read.rows.len());
    for (row, values) in read.rows.iter().enumerate() {
        let mut coordinates = Vec::with_capacity(order.len());
        for &column in &order {
            match values.get(column) {
                Some(Entry::Number(number)) => coordinates.push(*number),
                Some(Entry::Text(text)) => {
                    let fault =
                        Fault::new("not a number", format!("text {:?}", shorten(text)), "a number");
                    return Err(read.refuse(locate, Some(row), Some(column), fault));
                }
                None => {}
            }
        }
        rows.push(coordinates);
    }
    let inline = InlineTable {
        columns: names,
        rows: rows
            .iter()
            .map(|row| row.iter().map(|number| Entry::Number(*number)).collect())
            .collect(),
    };
    Ok(ResolvedDesign {
        layout: Layout::Table { rows: Arc::new(rows) },
        file: DesignFile::Table(TableSource::Inline(inline)),
        path: path.clone(),
    })
}

impl DesignFile {
    /// Returns the number of values that the design lists.
    pub(crate) fn values(&self) -> usize {
        match self {
            DesignFile::Table(TableSource::Inline(table)) => table.columns.len() * table.rows.len(),
            _ => 0,
        }
    }
}
