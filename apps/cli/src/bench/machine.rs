//! The machine, the system and the version of the measurements.

use serde::Serialize;
use std::{
    fs::read_to_string,
    path::Path,
    process::Command,
    time::{SystemTime, UNIX_EPOCH},
};

/// The machine, the system and the version of the measurements.
#[derive(Debug, Default, Serialize)]
pub struct Machine {
    /// Name and version of the operating system.
    pub system: String,
    /// Model of the processor; empty if unknown.
    pub processor: String,
    /// Number of cores.
    pub cores: usize,
    /// Build profile of this program.
    pub build: String,
    /// The commit; empty outside of a repository.
    pub commit: String,
    /// Whether the measured sources differ from the commit.
    pub is_changed: bool,
    /// The day, as year, month and day (UTC).
    pub date: String,
}

impl Machine {
    /// Describes this machine.
    pub fn this() -> Self {
        let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs());
        let commit = git(&["rev-parse", "--short=8", "HEAD"]).unwrap_or_default();
        let sources = ["diff", "--quiet", "HEAD", "--", "apps", "crates", "Cargo.lock", "Cargo.toml"];
        Self {
            system: system(),
            processor: field("/proc/cpuinfo", "model name", ':').unwrap_or_default(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            build: if cfg!(debug_assertions) { "development" } else { "release" }.into(),
            is_changed: !commit.is_empty() && git(&sources).is_none(),
            commit,
            date: date(seconds / 86_400),
        }
    }
}

/// Runs git; `None` if it fails, or outside of the repository.
fn git(args: &[&str]) -> Option<String> {
    if !Path::new("crates/tresses").is_dir() {
        return None;
    }
    let output = Command::new("git").args(args).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// Returns the value of the first line `name separator value` of a file.
fn field(path: &str, name: &str, separator: char) -> Option<String> {
    let text = read_to_string(path).ok()?;
    let mut lines = text.lines().filter_map(|line| line.split_once(separator));
    let (_, value) = lines.find(|(key, _)| key.trim() == name)?;
    Some(value.trim().trim_matches('"').to_owned())
}

fn system() -> String {
    let name = field("/etc/os-release", "PRETTY_NAME", '=').unwrap_or_else(|| std::env::consts::OS.into());
    let kernel = read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
    // Only the version, without the name of the build.
    let kernel = kernel.trim().split('-').next().unwrap_or_default();
    let kernel = if kernel.is_empty() { String::new() } else { format!(", kernel {kernel}") };
    format!("{name}{kernel}, {}", std::env::consts::ARCH)
}

/// Returns the date of a day after 1970-01-01, in the Gregorian calendar.
fn date(days: u64) -> String {
    // Years begin in March here, so that a leap day is the last of its year.
    let day = days + 719_468;
    let (era, day) = (day / 146_097, day % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (year, month) = (year + 400 * era, if month < 10 { month + 3 } else { month - 9 });
    format!("{:04}-{month:02}-{day:02}", year + u64::from(month < 3))
}

#[cfg(test)]
mod tests {
    use super::date;

    #[test]
    fn dates_follow_the_calendar() {
        let days = [(0, "1970-01-01"), (59, "1970-03-01"), (11_016, "2000-02-29"), (20_784, "2026-11-27")];
        for (day, name) in days {
            assert_eq!(date(day), name);
        }
    }
}
