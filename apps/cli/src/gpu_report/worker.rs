//! Runs a part as another process, so that a crash or a hang of the driver ends only this part.

use super::{
    args::{GpuArgs, Part},
    section::{PartState, ReportSection},
};
use anyhow::{Context, Result};
use std::{
    io::{BufRead, BufReader, Read},
    process::{Child, Command, ExitStatus, Stdio},
    thread,
    time::{Duration, Instant},
};

/// Maximum bytes of messages that are kept.
const MAX_MESSAGES: usize = 8000;

/// Runs `part` and returns its section. A part that fails has the results before the failure.
pub fn run(part: Part, args: &GpuArgs) -> ReportSection {
    let start = Instant::now();
    let mut section = spawned(part, args).unwrap_or_else(|error| ReportSection {
        state: PartState::Failed,
        findings: vec![format!("did not start: {error:#}")],
        ..ReportSection::default()
    });
    section.name = part.name().into();
    section.about = part.about().into();
    section.seconds = start.elapsed().as_secs_f64();
    section
}

fn spawned(part: Part, args: &GpuArgs) -> Result<ReportSection> {
    let program = std::env::current_exe().context("the path of this program")?;
    let mut command = Command::new(program);
    command.args(["gpu", "--part", part.name()]).args(args.quick.then_some("--quick"));
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn()?;
    let output = child.stdout.take().context("no standard output")?;
    let errors = child.stderr.take().context("no standard error")?;
    let sections = thread::spawn(move || last_section(BufReader::new(output)));
    let messages = thread::spawn(move || tail(errors));
    let ended = wait(&mut child, part.limit())?;
    let mut section = sections.join().ok().flatten().unwrap_or_default();
    section.messages = messages.join().unwrap_or_default();
    finish(&mut section, ended, part.limit());
    Ok(section)
}

/// Waits for `child`, and stops it after `limit`. Returns its exit status, or `None` if it was stopped.
fn wait(child: &mut Child, limit: Duration) -> Result<Option<ExitStatus>> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if start.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            return Ok(None);
        }
        thread::sleep(Duration::from_millis(20));
    }
}

/// Adds a finding if the process ended before its part was complete.
fn finish(section: &mut ReportSection, ended: Option<ExitStatus>, limit: Duration) {
    let problem = match ended {
        None => format!("stopped after {} s", limit.as_secs()),
        Some(status) if status.success() && section.state != PartState::Running => return,
        Some(status) => format!("the process ended with {status}"),
    };
    if section.state == PartState::Complete {
        section.notes.push(format!("{problem}, after the part was complete"));
    } else {
        section.findings.push(problem);
        section.state = PartState::Failed;
    }
}

/// Returns the last section of `lines` that is valid. Drivers may print lines of their own.
fn last_section(lines: impl BufRead) -> Option<ReportSection> {
    let mut last = None;
    for line in lines.split(b'\n').map_while(Result::ok) {
        if line.starts_with(b"{") {
            last = serde_json::from_slice(&line).ok().or(last);
        }
    }
    last
}

/// Returns the end of `reader` as text.
fn tail(mut reader: impl Read) -> String {
    let mut bytes = Vec::new();
    // Keep the messages before an error.
    let _ = reader.read_to_end(&mut bytes);
    String::from_utf8_lossy(&bytes[bytes.len().saturating_sub(MAX_MESSAGES)..]).trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_valid_section_is_kept() {
        let line =
            |seconds| serde_json::to_string(&ReportSection { seconds, ..ReportSection::default() }).unwrap();
        let text = format!("driver: hello\n{}\n{}\n{{\"name\": \"cut", line(1.0), line(2.0));
        assert_eq!(last_section(text.as_bytes()).unwrap().seconds, 2.0);
        assert_eq!(last_section("hello".as_bytes()), None);
    }

    #[test]
    fn stopped_part_is_a_finding() {
        let mut section = ReportSection::default();
        finish(&mut section, None, Duration::from_secs(5));
        assert_eq!((section.state, section.findings.len()), (PartState::Failed, 1));
        let mut section = ReportSection { state: PartState::Complete, ..ReportSection::default() };
        finish(&mut section, None, Duration::from_secs(5));
        assert_eq!((section.state, section.findings.len(), section.notes.len()), (PartState::Complete, 0, 1));
    }
}
