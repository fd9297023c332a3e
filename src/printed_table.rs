//! Tables as people read them: columns with a header and one cell per row, as text for a terminal and in Markdown.

use unicode_width::UnicodeWidthStr;

use crate::study::VariedParameter;

/// Names above this length have two lines in the header.
const LONG_NAME: usize = 14;

/// A column of a printed table.
#[derive(Clone, Debug)]
pub struct PrintedColumn {
    /// The header in two lines.
    pub header: [String; 2],
    /// The header in one line.
    pub name: String,
    /// One cell per row.
    pub cells: Vec<String>,
    is_left: bool,
}

impl PrintedColumn {
    /// Returns a column that is aligned to the right.
    pub fn new(name: impl Into<String>, cells: Vec<String>) -> Self {
        let name = name.into();
        PrintedColumn { header: [String::new(), name.clone()], name, cells, is_left: false }
    }

    /// Divides the header into two lines.
    pub fn header<S: Into<String>>(&mut self, lines: [S; 2]) {
        self.header = lines.map(Into::into);
    }

    /// Aligns the column to the left.
    pub fn left(&mut self) {
        self.is_left = true;
    }
}

/// The columns of some rows.
pub struct PrintedTable<'a, R> {
    rows: &'a [R],
    /// The cell of a value that a row does not have.
    missing: &'static str,
    /// The columns so far.
    pub columns: Vec<PrintedColumn>,
}

impl<'a, R> PrintedTable<'a, R> {
    /// Starts a table, in which `missing` is the cell of a missing value.
    pub fn new(rows: &'a [R], missing: &'static str) -> Self {
        PrintedTable { rows, missing, columns: Vec::new() }
    }

    /// Returns the rows.
    pub fn rows(&self) -> &'a [R] {
        self.rows
    }

    /// Adds the number of the point of the sweep, and its swept parameters with their values in `shown`.
    pub fn add_point(
        &mut self,
        point_id: impl Fn(&R) -> u64,
        swept: &[VariedParameter],
        shown: &[Vec<String>],
    ) {
        self.add("point", |row| point_id(row).to_string());
        for (index, parameter) in swept.iter().enumerate() {
            let values = shown.iter().take(self.rows.len());
            let cells = values.map(|row| row.get(index).cloned().unwrap_or_default());
            self.columns.push(PrintedColumn::new(parameter.shown_name(), cells.collect()));
        }
    }

    /// Adds a column.
    pub fn add(
        &mut self,
        name: impl Into<String>,
        cell: impl Fn(&R) -> String,
    ) -> &mut PrintedColumn {
        self.columns.push(PrintedColumn::new(name, self.rows.iter().map(cell).collect()));
        let last = self.columns.len() - 1;
        &mut self.columns[last]
    }

    /// Adds a column whose values may be missing.
    pub fn add_known(
        &mut self,
        name: impl Into<String>,
        cell: impl Fn(&R) -> Option<String>,
    ) -> &mut PrintedColumn {
        let missing = self.missing;
        self.add(name, |row| cell(row).unwrap_or_else(|| missing.to_owned()))
    }

    /// Adds a column unless all its values are missing.
    pub fn add_if_any(
        &mut self,
        name: impl Into<String>,
        cell: impl Fn(&R) -> Option<String>,
    ) -> Option<&mut PrintedColumn> {
        self.rows.iter().any(|row| cell(row).is_some()).then(|| self.add_known(name, cell))
    }
}

/// Divides a long name after the underscore that is nearest to its middle.
pub(crate) fn in_two_lines(name: &str) -> [&str; 2] {
    let places = name.match_indices('_').map(|(place, _)| place + 1);
    let middle = name.len() / 2;
    match places.min_by_key(|place| place.abs_diff(middle)) {
        Some(place) if name.len() > LONG_NAME => {
            let (top, bottom) = name.split_at(place);
            [top, bottom]
        }
        _ => ["", name],
    }
}

/// Returns the cells of each row.
fn cells(columns: &[PrintedColumn]) -> impl Iterator<Item = Vec<String>> {
    let rows = columns.iter().map(|column| column.cells.len()).max().unwrap_or(0);
    let row = |row: usize| columns.iter().filter_map(move |column| column.cells.get(row).cloned());
    (0..rows).map(move |number| row(number).collect())
}

/// Returns columns as text, with the header in two lines, or in one if the first one is empty.
pub fn as_text(columns: &[PrintedColumn]) -> String {
    let header = |line: usize| columns.iter().map(|column| column.header[line].clone()).collect();
    let header: [Vec<String>; 2] = [0, 1].map(header);
    let header = header.into_iter().filter(|line| line.iter().any(|cell| !cell.is_empty()));
    let left = columns.iter().enumerate().filter(|(_, column)| column.is_left);
    let left: Vec<usize> = left.map(|(place, _)| place).collect();
    text_table(&header.chain(cells(columns)).collect::<Vec<_>>(), &left)
}

/// Returns columns in Markdown.
pub fn as_markdown(columns: &[PrintedColumn]) -> String {
    let line = |cells: Vec<String>| {
        let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let names = columns.iter().map(|column| column.name.clone()).collect();
    let rule = vec!["--:".to_owned(); columns.len()];
    [names, rule].into_iter().chain(cells(columns)).map(line).collect()
}

/// Returns rows of cells as lines of text. Each column is as wide as its widest cell. Cells are aligned to the right,
/// except in the columns `left`.
pub(crate) fn text_table(rows: &[impl AsRef<[String]>], left: &[usize]) -> String {
    let rows: Vec<&[String]> = rows.iter().map(AsRef::as_ref).collect();
    let columns = rows.iter().map(|row| row.len()).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| Some(row.get(column)?.width())).max();
    let widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    let line = |row: &&[String]| {
        let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, width))| {
            let space = " ".repeat(width - cell.width());
            if left.contains(&column) { format!("{cell}{space}") } else { format!("{space}{cell}") }
        });
        let line = cells.collect::<Vec<_>>().join("  ");
        format!("{}\n", line.trim_end())
    };
    rows.iter().map(line).collect()
}

/// Returns facts as lines of text, each with its name and its value in words.
pub(crate) fn fact_table<'a>(facts: impl IntoIterator<Item = (&'a str, String)>) -> String {
    let rows: Vec<_> = facts.into_iter().map(|(name, words)| [name.to_owned(), words]).collect();
    text_table(&rows, &[0, 1])
}

#[cfg(test)]
mod tests {
    use super::{in_two_lines, text_table};

    #[test]
    fn columns_are_as_wide_as_terminals_show_them() {
        let rows = [["angle", "β̇"], ["日本", "1.5"]].map(|row| row.map(String::from));
        assert_eq!(text_table(&rows, &[]), "angle    β̇\n 日本  1.5\n");
        assert_eq!(text_table(&rows, &[0, 1]), "angle  β̇\n日本   1.5\n");
        assert_eq!(text_table(&[[]; 0], &[]), "");
    }
    #[test]
    fn long_names_have_two_lines() {
        assert_eq!(in_two_lines("speed_rad_s"), ["", "speed_rad_s"]);
        assert_eq!(in_two_lines("friction_coefficient"), ["friction_", "coefficient"]);
        assert_eq!(in_two_lines("friction_coefficient_2"), ["friction_", "coefficient_2"]);
        assert_eq!(in_two_lines("withoutunderscore"), ["", "withoutunderscore"]);
    }
}
