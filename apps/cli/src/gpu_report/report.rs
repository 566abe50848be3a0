//! The report: the verdict, the machine and the sections.

use super::section::{PartState, ReportSection};
use crate::bench::Machine;
use serde::Serialize;

/// Maximum number of findings that the verdict quotes.
const MAX_QUOTED: usize = 6;
/// Maximum length of a quoted finding, characters.
const MAX_QUOTE: usize = 160;

/// The report.
#[derive(Debug, Serialize)]
pub struct Report {
    /// The first line: results that a maintainer should look at.
    pub verdict: String,
    /// The program and the machine.
    pub host: HostInfo,
    /// Results of the parts.
    pub sections: Vec<ReportSection>,
}

/// The program and the machine.
#[derive(Debug, Serialize)]
pub struct HostInfo {
    /// Version of the program.
    pub version: String,
    /// The machine, the build and the day.
    #[serde(flatten)]
    pub machine: Machine,
    /// Variables that select an adapter.
    pub environment: Vec<String>,
}

impl HostInfo {
    /// Describes this program and this machine.
    pub fn current() -> Self {
        let selection = |(name, value): (std::ffi::OsString, std::ffi::OsString)| {
            let name = name.into_string().ok().filter(|name| name.starts_with("WGPU_"))?;
            Some(format!("{name}={}", value.to_string_lossy()))
        };
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            machine: Machine::this(),
            environment: std::env::vars_os().filter_map(selection).collect(),
        }
    }
}

/// Returns the first line of the report.
pub fn verdict(sections: &[ReportSection]) -> String {
    let mut all: Vec<String> = Vec::new();
    for section in sections {
        all.extend(section.findings.iter().map(|finding| format!("{}: {}", section.name, quoted(finding))));
        if section.state == PartState::Running {
            all.push(format!("{}: did not finish", section.name));
        }
    }
    let count = all.len();
    match count {
        0 => "Nothing unusual.".into(),
        1 => format!("1 thing to look at: {}.", all[0]),
        2..=MAX_QUOTED => format!("{count} things to look at: {}.", all.join("; ")),
        _ => format!(
            "{count} things to look at: {}; and {} more.",
            all[..MAX_QUOTED].join("; "),
            count - MAX_QUOTED
        ),
    }
}

/// Returns the first line of `text`, shortened.
fn quoted(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default();
    let end = line.char_indices().nth(MAX_QUOTE).map(|(end, _)| end);
    end.map_or_else(|| line.trim_end_matches('.').to_owned(), |end| format!("{} …", &line[..end]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn section(name: &str, state: PartState, findings: &[&str]) -> ReportSection {
        let findings = findings.iter().map(|finding| (*finding).to_owned()).collect();
        ReportSection { name: name.into(), state, findings, ..ReportSection::default() }
    }

    #[test]
    fn verdict_counts_and_quotes_findings() {
        let good = section("rates", PartState::Complete, &[]);
        assert_eq!(verdict(std::slice::from_ref(&good)), "Nothing unusual.");
        let one = section("images", PartState::Complete, &["long differs"]);
        assert_eq!(verdict(&[good, one.clone()]), "1 thing to look at: images: long differs.");
        let unfinished = section("frames", PartState::Running, &[]);
        assert_eq!(
            verdict(&[one, unfinished]),
            "2 things to look at: images: long differs; frames: did not finish."
        );
        let many = section("shaders", PartState::Failed, &["a"; 9]);
        assert!(verdict(&[many]).ends_with("; and 3 more."));
    }

    #[test]
    fn quotes_are_one_short_line() {
        assert_eq!(quoted("first.\nsecond"), "first");
        assert_eq!(quoted(&"é".repeat(500)).chars().count(), MAX_QUOTE + 2);
    }
}
