//! Tables in CSV files: one header line, commas, comments after `#`.

use csv::{Position, ReaderBuilder, Trim};

use super::cells::{Cell, Cells, Limits, ragged, too_many_values};
use super::error::{Fault, Refusal};
use crate::sanitize::shorten;

/// Reads a CSV table from the bytes of its file.
///
/// # Errors
/// Returns an error if the bytes are not UTF-8, if the header is missing or contains an invalid name, if a row has more or
/// fewer values than there are columns, or if there are too many values.
pub(super) fn read(bytes: Vec<u8>, limits: &Limits<'_>) -> Result<Cells, Refusal> {
    let text = to_text(bytes)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let mut lines = Vec::new();
    let (mut columns, mut rows): (Vec<String>, Vec<Vec<Cell>>) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record
            .map_err(|error| Fault::new("not a table", shorten(&error.to_string()), "CSV"))?;
        let line = line_of(text, record.position());
        if columns.is_empty() {
            columns = record.iter().map(str::to_owned).collect();
            if let [header] = &columns[..]
                && header.contains([';', '\t'])
            {
                let problem = "the columns are not separated by commas";
                let fault = Fault::new(
                    problem,
                    shorten(header),
                    "a comma between two columns, and a point in decimal numbers",
                );
                return Err(Refusal { line: Some(1), ..fault.into() });
            }
            let refuse = |refusal| Refusal { line: Some(1), ..refusal };
            limits.check_columns(&columns).map_err(refuse)?;
            continue;
        }
        let refuse =
            |fault: Fault| Refusal { line: Some(line), row: Some(rows.len()), ..fault.into() };
        if record.len() != columns.len() {
            return Err(refuse(ragged(record.len(), columns.len())));
        }
        if (rows.len() + 1) * columns.len() > limits.values {
            let found = format!("more than {} values", rows.len() * columns.len());
            return Err(refuse(too_many_values(found, limits)));
        }
        lines.push(line);
        rows.push(record.iter().map(cell).collect());
    }
    if columns.is_empty() {
        let fault = Fault::new("the table is empty", "no header", "a line of column names");
        return Err(fault.into());
    }
    Ok(Cells { columns, rows, lines: Some(lines) })
}

/// Converts bytes to text.
pub(crate) fn to_text(bytes: Vec<u8>) -> Result<String, Fault> {
    String::from_utf8(bytes).map_err(|error| {
        let found = format!("an invalid byte at position {}", error.utf8_error().valid_up_to());
        Fault::new("the text is not UTF-8", found, "UTF-8")
    })
}

/// Returns the line, counted from one, where a record starts. The reader's position precedes the empty lines and comments
/// that it skipped.
fn line_of(text: &str, position: Option<&Position>) -> usize {
    let Some(position) = position else { return 1 };
    let byte = usize::try_from(position.byte()).unwrap_or(0);
    let skipped = text
        .get(byte..)
        .unwrap_or_default()
        .lines()
        .take_while(|line| line.is_empty() || line.starts_with('#'))
        .count();
    usize::try_from(position.line()).unwrap_or(1) + skipped
}

fn cell(text: &str) -> Cell {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Cell::Number(number),
        Ok(_) => Cell::NotFinite(shorten(text)),
        Err(_) if text.is_empty() => Cell::Empty,
        Err(_) => Cell::Text(text.to_owned()),
    }
}
