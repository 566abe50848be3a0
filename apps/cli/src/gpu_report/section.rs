//! One part of the report: findings, tables and images. A part runs in a process of its own, which prints its section
//! after each result, so that a crash of the driver loses nothing that was printed.

use crate::picture::Image;
use anyhow::Result;
use base64::{Engine, engine::general_purpose::STANDARD};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::io::Write;

/// Progress of a part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PartState {
    /// Not finished, or ended by a crash.
    #[default]
    Running,
    /// Finished.
    Complete,
    /// Ended by an error, a crash or the time limit.
    Failed,
}

/// Results of one part.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReportSection {
    /// Name of the part.
    pub name: String,
    /// Description of the part.
    pub about: String,
    /// Progress of the part.
    pub state: PartState,
    /// Elapsed time, seconds.
    pub seconds: f64,
    /// Results that a maintainer should look at.
    pub findings: Vec<String>,
    /// Other remarks.
    pub notes: Vec<String>,
    /// Results as tables.
    pub tables: Vec<Table>,
    /// Results as images.
    pub figures: Vec<ReportFigure>,
    /// Messages that the driver and the program wrote to standard error.
    pub messages: String,
}

/// A table. Cells are text, numbers, booleans or null.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Heading.
    pub title: String,
    /// Headings of the columns.
    pub columns: Vec<String>,
    /// Rows of cells.
    pub rows: Vec<Vec<Value>>,
}

/// Images side by side.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReportFigure {
    /// Caption of all.
    pub caption: String,
    /// Labels, and PNG files in base64.
    pub images: Vec<(String, String)>,
}

/// Writer of a section.
#[derive(Debug, Default)]
pub struct Draft {
    /// The section so far.
    pub section: ReportSection,
}

/// Creates the cells of a row.
macro_rules! cells {
    ($($cell:expr),* $(,)?) => { vec![$(serde_json::json!($cell)),*] };
}
pub(super) use cells;

impl Draft {
    /// Adds a result that a maintainer should look at.
    pub fn find(&mut self, finding: impl Into<String>) {
        self.section.findings.push(finding.into());
    }

    /// Adds a remark.
    pub fn note(&mut self, note: impl Into<String>) {
        self.section.notes.push(note.into());
    }

    /// Appends a row to the table `title`, which is created if it does not exist.
    pub fn row(&mut self, title: &str, columns: &[&str], cells: Vec<Value>) {
        let tables = &mut self.section.tables;
        let index = tables.iter().position(|table| table.title == title).unwrap_or_else(|| {
            let columns = columns.iter().map(|column| (*column).to_owned()).collect();
            tables.push(Table { title: title.into(), columns, rows: Vec::new() });
            tables.len() - 1
        });
        tables[index].rows.push(cells);
    }

    /// Appends images.
    pub fn figure(&mut self, caption: &str, images: &[(&str, &Image)]) -> Result<()> {
        let encode =
            |(label, image): &(&str, &Image)| Ok(((*label).to_owned(), STANDARD.encode(image.png()?)));
        let images = images.iter().map(encode).collect::<Result<_>>()?;
        self.section.figures.push(ReportFigure { caption: caption.into(), images });
        Ok(())
    }

    /// Prints the section so far for the parent process. Ignores a closed pipe.
    pub fn keep(&self) {
        if let Ok(text) = serde_json::to_string(&self.section) {
            let mut output = std::io::stdout().lock();
            let _ = writeln!(output, "{text}").and_then(|()| output.flush());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_with_one_title_form_a_table() {
        let mut draft = Draft::default();
        for ms in [1.5, 2.5] {
            draft.row("times", &["name", "ms"], cells!["a", ms]);
        }
        draft.row("others", &["name"], cells![()]);
        let [times, others] = &draft.section.tables[..] else { panic!("{:?}", draft.section.tables) };
        assert_eq!((times.rows.len(), others.rows.len()), (2, 1));
        let text = serde_json::to_string(&draft.section).unwrap();
        assert_eq!(serde_json::from_str::<ReportSection>(&text).unwrap(), draft.section);
    }
}
