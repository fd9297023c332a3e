//! Resolution of sampling designs, including their tables.

use std::sync::Arc;

use crate::model::Model;
use crate::study::error::{Fault, StudyError, describe_number};
use crate::study::file::source::SourcePath;
use crate::study::file::study_file::DesignFile;
use crate::study::file::table_input::Rows;
use crate::study::file::values::TableKey;
use crate::study::sampling::apart::first_overlap;
use crate::study::sampling::initial_box::{BoxAxis, axis_names};
use crate::study::sampling::sampling_design::{Layout, SOBOL_DIMENSIONS};

/// A validated layout, and the design in the form of a self-contained study file.
#[derive(Clone)]
pub(crate) struct ResolvedDesign<'a> {
    /// The layout.
    pub layout: Layout,
    /// The design with inline tables.
    pub file: DesignFile,
    /// Key path of the design.
    pub path: SourcePath<'a>,
    /// The coordinates of given start states, in their order.
    given: Vec<String>,
}

impl ResolvedDesign<'_> {
    /// Returns the layout for start states with these coordinates. Given start states may have further coordinates,
    /// which belong to balls that other points have.
    pub fn layout_of(&self, axes: &[BoxAxis]) -> Layout {
        let Layout::Table { rows } = &self.layout else { return self.layout.clone() };
        if self.given.len() == axes.len() {
            return self.layout.clone();
        }
        let has_axis = |name: &String| axes.iter().any(|axis| axis.name == *name);
        let row = |row: &Vec<f64>| {
            let named = self.given.iter().zip(row).filter(|(name, _)| has_axis(name));
            named.map(|(_, number)| *number).collect()
        };
        Layout::Table { rows: Arc::new(rows.iter().map(row).collect()) }
    }
}

/// Validates a sampling design for points with at most as many balls as this model.
///
/// # Errors
/// Returns an error if a Sobol' sequence has too many dimensions, or if a table of start states is
/// invalid.
pub(crate) fn resolve_design<'a>(
    path: &SourcePath<'a>,
    written: &DesignFile,
    model: &Model,
) -> Result<ResolvedDesign<'a>, StudyError> {
    let layout = match written {
        DesignFile::Stratified { parts_per_axis, samples_per_cell } => {
            Layout::Stratified { parts: parts_per_axis.0, samples_per_cell: samples_per_cell.0 }
        }
        DesignFile::LatinHypercube { samples } => Layout::LatinHypercube { samples: samples.0 },
        DesignFile::Sobol { samples } => {
            check_dimensions(model.coordinates().len())
                .map_err(|fault| path.key("sobol").refuse_key(fault))?;
            Layout::Sobol { samples: samples.0 }
        }
        DesignFile::MonteCarlo { samples } => Layout::MonteCarlo { samples: samples.0 },
        DesignFile::Grid { points_per_axis } => Layout::Grid { points: points_per_axis.0 },
        DesignFile::Table(table) => {
            return resolve_starts(path, table, model);
        }
    };
    Ok(ResolvedDesign { layout, file: written.clone(), path: path.clone(), given: Vec::new() })
}

/// Checks the number of dimensions of a Sobol' sequence.
pub(crate) fn check_dimensions(dimensions: usize) -> Result<(), Fault> {
    if dimensions <= SOBOL_DIMENSIONS as usize {
        return Ok(());
    }
    let found = format!("{dimensions} dimensions");
    let allowed = format!("at most {SOBOL_DIMENSIONS}, or the design latin_hypercube");
    Err(Fault::new("too many dimensions for a Sobol' sequence", found, allowed))
}

fn resolve_starts<'a>(
    path: &SourcePath<'a>,
    table: &TableKey,
    model: &Model,
) -> Result<ResolvedDesign<'a>, StudyError> {
    let names = axis_names(model);
    let read = Rows::read(&path.key("table"), table, &names)?;
    let rows = read.numbers(&names)?;
    if let Some(machine) = model.ball_balancer().filter(|machine| machine.contact.is_some()) {
        for (row, values) in rows.iter().enumerate() {
            if let Some(overlap) = first_overlap(machine, &values[2..2 + machine.balls.len()]) {
                let [behind, ahead] = overlap.balls;
                let found = format!(
                    "{} rad between balls {behind} and {ahead}",
                    describe_number(overlap.angle)
                );
                let allowed = format!("{} rad or more", describe_number(overlap.touching));
                return Err(read.refuse(
                    Some(row),
                    None,
                    Fault::new("balls overlap", found, allowed),
                ));
            }
        }
    }
    let file = TableKey::of_numbers(names.clone(), rows.iter().map(Vec::as_slice));
    Ok(ResolvedDesign {
        layout: Layout::Table { rows: Arc::new(rows) },
        file: DesignFile::Table(file),
        path: path.clone(),
        given: names,
    })
}

impl DesignFile {
    /// Returns the number of values that the design lists.
    pub(crate) fn values(&self) -> usize {
        match self {
            DesignFile::Table(TableKey::Inline(table)) => table.columns.len() * table.rows.len(),
            _ => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::check_dimensions;

    /// More dimensions than the library has would end the program with a panic.
    #[test]
    fn a_sequence_has_256_dimensions() {
        assert_eq!(check_dimensions(256), Ok(()));
        let fault = check_dimensions(257).expect_err("too many");
        assert_eq!(fault.found.as_deref(), Some("257 dimensions"));
        assert_eq!(fault.allowed.as_deref(), Some("at most 256, or the design latin_hypercube"));
        assert!(sobol_burley::sample(0, 255, 1) < 1.0);
    }
}
