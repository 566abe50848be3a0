//! Times of scenes, by stage.

use super::{
    recorded::{self, StageCommands},
    statistics::Summary,
    table::{ms, table},
};
use serde::Serialize;
use std::fmt::Write;
use tresses_scene::words::grouped;

/// One scene in one or several states.
#[derive(Debug, Default, Serialize)]
pub struct SceneResults {
    /// Name of the scene.
    pub name: String,
    /// Published measurements of the scene.
    pub others: String,
    /// Image size, pixels.
    pub size: [u32; 2],
    /// Samples per pixel of the target.
    pub samples: u32,
    /// Supersampling factor per axis.
    pub ssaa: u32,
    /// Number of guides.
    pub guides: u32,
    /// Number of drawn strands.
    pub strands: u32,
    /// Vertices per drawn strand.
    pub vertices_per_strand: u32,
    /// Triangles of the hair.
    pub triangles: u64,
    /// GPU memory of the groom, bytes.
    pub bytes: u64,
    /// GPU memory per drawn vertex, bytes.
    pub bytes_per_vertex: f64,
    /// Runs at rest and in motion.
    pub runs: Vec<Run>,
}

/// One scene in one state.
#[derive(Debug, Default, Serialize)]
pub struct Run {
    /// At rest, or in motion.
    pub state: String,
    /// Number of measured frames.
    pub frames: u32,
    /// Times per stage from GPU timestamps, in order.
    pub stages: Vec<StageTime>,
    /// Commands recorded by one frame.
    pub recorded: Vec<StageCommands>,
    /// Sum of the stages of a frame, milliseconds.
    pub gpu: Summary,
    /// Time from the start of recording until the GPU is done, milliseconds.
    pub frame: Summary,
}

/// Time of one stage.
#[derive(Debug, Serialize)]
pub struct StageTime {
    /// Name of the stage.
    pub name: String,
    /// Milliseconds.
    #[serde(flatten)]
    pub time: Summary,
}

impl StageTime {
    /// Summarizes the times of each stage.
    pub fn all(stages: Vec<(&'static str, Vec<f64>)>) -> Vec<Self> {
        let row = |(name, times): (&str, _)| Self { name: name.into(), time: Summary::of(times) };
        stages.into_iter().map(row).collect()
    }
}

/// Times with one strand count.
#[derive(Debug, Serialize)]
pub struct StrandPoint {
    /// Number of drawn strands.
    pub strands: u32,
    /// Sum of the stages, milliseconds.
    pub gpu: Summary,
    /// Whole frame, milliseconds.
    pub frame: Summary,
}

/// Formats the numbers of measured frames, one per run, as a range if they differ.
pub fn frame_range(counts: impl Iterator<Item = u32> + Clone) -> String {
    let (min, max) = (counts.clone().min().unwrap_or(0), counts.max().unwrap_or(0));
    if min == max { format!("{max} frames") } else { format!("{min} to {max} frames") }
}

impl SceneResults {
    /// Formats the results as a table.
    pub fn text(&self) -> String {
        let [width, height] = self.size;
        let mut text = format!(
            "\n{}: {width} × {height}, {}{}, {}\n{} guides, {} strands × {} vertices, {} triangles, \
             {:.1} MB on the GPU, {:.1} bytes per drawn vertex\n",
            self.name,
            if self.samples == 1 { "1 sample".into() } else { format!("{}×MSAA", self.samples) },
            if self.ssaa > 1 { format!(", {0}×{0} SSAA", self.ssaa) } else { String::new() },
            frame_range(self.runs.iter().map(|run| run.frames)),
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
        // Shows the commands of the last run only; runs at rest record the same commands.
        text + &table(&rows) + &self.runs.last().map_or(String::new(), |run| recorded::text(&run.recorded))
    }
}
