//! Load by other programs during a measurement. Linux only.

use std::{fs::read_to_string, thread::available_parallelism, time::Instant};

/// Ticks of `/proc` per second.
const TICKS: f64 = 100.0;

/// Processor time at the start of a measurement.
pub struct Load {
    start: Instant,
    all: f64,
    own: f64,
}

impl Load {
    /// Starts to count; `None` if the system does not report processor times.
    pub fn start() -> Option<Self> {
        Some(Self { start: Instant::now(), all: all()?, own: own()? })
    }

    /// Returns the share of the cores that other programs have used since the start.
    pub fn others(&self) -> Option<f64> {
        let cores = available_parallelism().map_or(1, usize::from) as f64;
        let others = (all()? - self.all) - (own()? - self.own);
        Some((others / (self.start.elapsed().as_secs_f64() * cores)).clamp(0.0, 1.0))
    }
}

/// Processor time of the machine, seconds: user, nice, system, interrupts and steal.
fn all() -> Option<f64> {
    let text = read_to_string("/proc/stat").ok()?;
    let fields: Vec<f64> = text.lines().next()?.split_whitespace().filter_map(|v| v.parse().ok()).collect();
    let ticks = [0, 1, 2, 5, 6, 7].iter().map(|i| fields.get(*i)).sum::<Option<f64>>()?;
    Some(ticks / TICKS)
}

/// Processor time of this process and its finished children, seconds, in steps of 10 ms.
fn own() -> Option<f64> {
    let text = read_to_string("/proc/self/stat").ok()?;
    // The name of the program, in parentheses, may contain spaces.
    let (_, rest) = text.rsplit_once(')')?;
    let fields: Vec<&str> = rest.split_whitespace().collect();
    let ticks = fields.get(11..15)?.iter().map(|v| v.parse::<f64>().ok()).sum::<Option<f64>>()?;
    Some(ticks / TICKS)
}
