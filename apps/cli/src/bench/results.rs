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

/// Times of each stage in several frames, milliseconds.
#[derive(Debug, Default)]
pub struct StageSamples(Vec<(&'static str, Vec<f64>)>);

impl StageSamples {
    /// Adds the times of a frame. Returns their sum.
    pub fn add(&mut self, times: impl IntoIterator<Item = (&'static str, f64)>) -> f64 {
        let mut sum = 0.0;
        for (name, ms) in times {
            sum += ms;
            match self.0.iter_mut().find(|(known, _)| *known == name) {
                Some((_, values)) => values.push(ms),
                None => self.0.push((name, vec![ms])),
            }
        }
        sum
    }

    /// Summarizes the sum of the named stages per frame.
    pub fn sum(&self, names: &[&str]) -> Summary {
        let rows: Vec<_> = self.0.iter().filter(|(name, _)| names.contains(name)).collect();
        let frames = rows.iter().map(|(_, times)| times.len()).min().unwrap_or(0);
        Summary::of((0..frames).map(|i| rows.iter().map(|(_, times)| times[i]).sum()).collect())
    }

    /// Summarizes each stage.
    pub fn summarize(self) -> Vec<StageTime> {
        let row = |(name, times): (&str, _)| StageTime { name: name.into(), time: Summary::of(times) };
        self.0.into_iter().map(row).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_of_frames_are_collected_by_name() {
        let mut samples = StageSamples::default();
        let frames = [vec![("simulate", 1.0), ("draw", 2.0)], vec![("simulate", 3.0), ("draw", 4.0)]];
        assert_eq!(frames.map(|frame| samples.add(frame)), [3.0, 7.0]);
        assert_eq!(samples.sum(&["draw", "other"]), Summary::of(vec![2.0, 4.0]));
        let stages = samples.summarize();
        assert_eq!(stages.iter().map(|stage| stage.name.as_str()).collect::<Vec<_>>(), ["simulate", "draw"]);
        assert_eq!(stages[0].time, Summary::of(vec![1.0, 3.0]));
    }
}
