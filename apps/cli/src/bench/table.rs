//! Text tables.

use std::fmt::Write;

/// Formats milliseconds with about three significant digits.
pub fn ms(value: f64) -> String {
    let digits = if value < 1.0 {
        3
    } else if value < 10.0 {
        2
    } else {
        1
    };
    format!("{value:.digits$}")
}

/// Formats rows as columns, the first aligned left and the others right.
pub fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |c: usize| rows.iter().filter_map(|row| row.get(c)).map(|v| v.chars().count()).max();
    let widths: Vec<_> = (0..columns).map(|c| width(c).unwrap_or(0)).collect();
    let mut text = String::new();
    for row in rows {
        let mut cells = String::new();
        for (c, cell) in row.iter().enumerate() {
            let w = widths[c];
            let _ = if c == 0 { write!(cells, "  {cell:<w$}") } else { write!(cells, "  {cell:>w$}") };
        }
        text += cells.trim_end();
        text.push('\n');
    }
    text
}
