//! Tables as text for a terminal.

use unicode_width::UnicodeWidthStr;

/// Returns rows of cells as lines of text. Each column is as wide as its widest cell. Cells are aligned to the right,
/// except in the columns `left`.
pub(crate) fn text_table(rows: &[Vec<String>], left: &[usize]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| rows.iter().filter_map(|row| Some(row.get(column)?.width())).max();
    let widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, width))| {
            let space = " ".repeat(width - cell.width());
            if left.contains(&column) { format!("{cell}{space}") } else { format!("{space}{cell}") }
        });
        let line = cells.collect::<Vec<_>>().join("  ");
        format!("{}\n", line.trim_end())
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::text_table;

    #[test]
    fn columns_are_as_wide_as_terminals_show_them() {
        let rows = [["angle", "β̇"], ["日本", "1.5"]].map(|row| row.map(String::from).to_vec());
        assert_eq!(text_table(&rows, &[]), "angle    β̇\n 日本  1.5\n");
        assert_eq!(text_table(&rows, &[0, 1]), "angle  β̇\n日本   1.5\n");
        assert_eq!(text_table(&[], &[]), "");
    }
}
