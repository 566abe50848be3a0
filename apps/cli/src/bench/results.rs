//! Times of scenes, stage by stage.

use super::{
    recorded::{self, Recorded},
    statistics::Summary,
    table::{ms, table},
};
use serde::Serialize;
use std::fmt::Write;
use tresses_scene::words::grouped;

/// One scene in one or several states.
#[derive(Debug, Default, Serialize)]
pub struct Group {
    /// What it is.
    pub name: String,
    /// What others have measured on it.
    pub others: String,
    /// Pixels.
    pub size: [u32; 2],
    /// Per pixel of the target.
    pub samples: u32,
    /// Pixels of the target per pixel of the picture, along each axis.
    pub ssaa: u32,
    /// Simulated.
    pub guides: u32,
    /// Drawn.
    pub strands: u32,
    /// Of each drawn strand.
    pub vertices_per_strand: u32,
    /// Of the hair.
    pub triangles: u64,
    /// GPU memory of the groom.
    pub bytes: u64,
    /// That divided by the drawn vertices.
    pub bytes_per_vertex: f64,
    /// At rest, in motion.
    pub runs: Vec<Run>,
}

/// One scene in one state.
#[derive(Debug, Default, Serialize)]
pub struct Run {
    /// At rest, or in motion.
    pub state: String,
    /// How many were measured.
    pub frames: u32,
    /// In order; from GPU timestamps.
    pub stages: Vec<StageTime>,
    /// What one of them records.
    pub recorded: Vec<Recorded>,
    /// The sum of the stages in each frame.
    pub gpu: Summary,
    /// From recording to the GPU's last answer.
    pub frame: Summary,
}

/// One stage's time.
#[derive(Debug, Serialize)]
pub struct StageTime {
    /// The pass or passes of that name.
    pub name: String,
    #[serde(flatten)]
    pub time: Summary,
}

impl StageTime {
    /// Of times stage by stage.
    pub fn all(stages: Vec<(&'static str, Vec<f64>)>) -> Vec<Self> {
        let row = |(name, times): (&str, _)| Self { name: name.into(), time: Summary::of(times) };
        stages.into_iter().map(row).collect()
    }
}

/// One point of the line of strand counts.
#[derive(Debug, Serialize)]
pub struct Point {
    /// Drawn.
    pub strands: u32,
    /// Milliseconds, the sum of the stages.
    pub gpu: Summary,
    /// Milliseconds, whole frame.
    pub frame: Summary,
}

/// So many frames were measured in each of `runs`.
pub fn measured(runs: impl Iterator<Item = u32> + Clone) -> String {
    let (fewest, most) = (runs.clone().min().unwrap_or(0), runs.max().unwrap_or(0));
    if fewest == most { format!("{most} frames") } else { format!("{fewest} to {most} frames") }
}

impl Group {
    /// As a table.
    pub fn text(&self) -> String {
        let [width, height] = self.size;
        let mut text = format!(
            "\n{}: {width} × {height}, {}{}, {}\n{} guides, {} strands × {} vertices, {} triangles, \
             {:.1} MB on the GPU, {:.1} bytes per drawn vertex\n",
            self.name,
            if self.samples == 1 { "1 sample".into() } else { format!("{}×MSAA", self.samples) },
            if self.ssaa > 1 { format!(", {0}×{0} SSAA", self.ssaa) } else { String::new() },
            measured(self.runs.iter().map(|run| run.frames)),
            grouped(self.guides.into()),
            grouped(self.strands.into()),
            self.vertices_per_strand,
            grouped(self.triangles),
            self.bytes as f64 * 1e-6,
            self.bytes_per_vertex,
        );
        if !self.others.is_empty() {
            let _ = writeln!(text, "{}", self.others);
        }
        let Some(first) = self.runs.first() else { return text };
        let mut rows = vec![vec![String::new()]];
        for run in &self.runs {
            rows[0].extend([run.state.clone(), "p95".into()]);
        }
        let mut row = |name: &str, time: &dyn Fn(&Run) -> Summary| {
            let mut row = vec![name.to_owned()];
            for run in &self.runs {
                let time = time(run);
                row.extend([ms(time.median), ms(time.p95)]);
            }
            rows.push(row);
        };
        for stage in &first.stages {
            row(&stage.name, &|run| {
                run.stages.iter().find(|s| s.name == stage.name).map_or(Summary::default(), |s| s.time)
            });
        }
        if !first.stages.is_empty() {
            row("all stages", &|run| run.gpu);
        }
        row("whole frame", &|run| run.frame);
        // A frame at rest records what one in motion does.
        text + &table(&rows) + &self.runs.last().map_or(String::new(), |run| recorded::text(&run.recorded))
    }
}
