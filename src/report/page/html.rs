//! Builds HTML from escaped text.

use crate::printed_table::PrintedColumn;
use crate::sanitize::is_acted_on;

/// An HTML text that grows line by line.
#[derive(Debug, Default)]
pub struct Html(String);

impl Html {
    /// Adds a line of unescaped markup.
    pub fn line(&mut self, markup: &str) {
        self.0 += markup;
        self.0.push('\n');
    }

    /// Adds an element with escaped text; `attributes` is empty or begins with a space, as ` class="x"`.
    pub fn element(&mut self, tag: &str, attributes: &str, text: &str) {
        self.line(&format!("<{tag}{attributes}>{}</{tag}>", escaped(text)));
    }

    /// Adds a table. The cells are markup; `text` lists the columns that are aligned to the left.
    pub fn table(&mut self, head: &[&str], rows: &[Vec<String>], text: &[usize]) {
        let class = |column: usize| if text.contains(&column) { " class=\"text\"" } else { "" };
        self.line("<div class=\"wide\" tabindex=\"0\"><table><thead><tr>");
        for (column, name) in head.iter().enumerate() {
            // Allows line breaks in long names.
            let name = escaped(name).replace('_', "_<wbr>");
            self.line(&format!("<th scope=\"col\"{}>{name}</th>", class(column)));
        }
        self.line("</tr></thead><tbody>");
        for row in rows {
            let cells = row.iter().enumerate();
            let cells = cells.map(|(column, cell)| format!("<td{}>{cell}</td>", class(column)));
            self.line(&format!("<tr>{}</tr>", cells.collect::<String>()));
        }
        self.line("</tbody></table></div>");
    }

    /// Adds a table of printed columns; `text` lists those that are aligned to the left.
    pub fn columns(&mut self, columns: &[PrintedColumn], text: &[usize]) {
        let head: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        let rows = columns.first().map_or(0, |column| column.cells.len());
        let cell = |row: usize| move |column: &PrintedColumn| escaped(&range(&column.cells[row]));
        let rows: Vec<Vec<String>> =
            (0..rows).map(|row| columns.iter().map(cell(row)).collect()).collect();
        self.table(&head, &rows, text);
    }

    /// Returns the text.
    pub fn text(self) -> String {
        self.0
    }
}

/// Returns a cell with a dash between the ends of a range, such as `1.0–2.5`.
fn range(cell: &str) -> String {
    let is_hyphen =
        |(place, _): &(usize, &str)| cell[..*place].ends_with(|c: char| c.is_ascii_digit());
    match cell.match_indices('-').find(is_hyphen) {
        Some((place, _)) => format!("{}–{}", &cell[..place], &cell[place + 1..]),
        None => cell.to_owned(),
    }
}

/// Escapes text for elements and attributes.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\n' | '\t' => escaped.push(c),
            c if is_acted_on(c) => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}
