//! Text of a page, escaped.

use crate::foreign::is_acted_on;

/// A page that grows line by line.
#[derive(Debug, Default)]
pub struct Html(String);

impl Html {
    /// Adds a line of markup as it is.
    pub fn line(&mut self, markup: &str) {
        self.0 += markup;
        self.0.push('\n');
    }

    /// Adds an element that holds text; `attributes` as ` class="x"`, or nothing.
    pub fn element(&mut self, tag: &str, attributes: &str, text: &str) {
        self.line(&format!("<{tag}{attributes}>{}</{tag}>", escaped(text)));
    }

    /// Adds rows of a table; the cells are markup, `text` says which columns are aligned to the left.
    pub fn table(&mut self, head: &[&str], rows: &[Vec<String>], text: &[usize]) {
        let class = |column: usize| if text.contains(&column) { " class=\"text\"" } else { "" };
        self.line("<div class=\"wide\" tabindex=\"0\"><table><thead><tr>");
        for (column, name) in head.iter().enumerate() {
            // Long names may go on in the next line behind what joins their words.
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

    /// What has been added.
    pub fn text(self) -> String {
        self.0
    }
}

/// Text as it stands in a page and in attributes.
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
