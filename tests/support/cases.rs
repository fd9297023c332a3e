//! Tables of cases as text, with a case on each line.

/// Returns the cases of a table. ` ¦ ` separates the fields of a case, `\n` stands for a new line in a field, and lines that
/// begin with `# ` are headings.
pub fn rows(table: &str) -> impl Iterator<Item = Vec<String>> {
    let field = |(place, field): (usize, &str)| {
        // The blank after the separator is missing where a line ends with an empty field.
        let field = if place == 0 { field } else { field.strip_prefix(' ').unwrap_or(field) };
        field.replace("\\n", "\n")
    };
    let lines = table.lines().filter(|line| !line.starts_with("# "));
    lines.map(move |line| line.split(" ¦").enumerate().map(field).collect())
}

/// Returns the cases of a table in which each has `N` fields.
pub fn cases<const N: usize>(table: &str) -> impl Iterator<Item = [String; N]> {
    rows(table).map(|row| {
        row.try_into().unwrap_or_else(|row: Vec<String>| panic!("not {N} fields: {row:?}"))
    })
}
