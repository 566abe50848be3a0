//! Times of grooming: a dab of each brush, a pick, undo, and the strands made anew after a stroke.

use super::{
    sitting::Sitting,
    statistics::Summary,
    table::{ms, table},
    workload,
};
use anyhow::{Context, Result};
use serde::Serialize;
use tresses::{
    Gpu,
    glam::{Quat, Vec3},
    groom::edit::{Brush, BrushTool, GroomEditor, StrokeSample},
};
use tresses_scene::{CompanionFiles, Preset, Shelf, words::grouped};

/// Strands that are all guides, for dabs.
const GUIDES: u32 = 5_000;
/// Strands that are made anew.
const STRANDS: u32 = 20_000;
/// Largest allowed median times, milliseconds.
const DAB: f64 = 10.0;
const PICK: f64 = 2.0;
const UNDO: f64 = 16.0;
const SETTLE: f64 = 500.0;
/// Strokes with each brush, around the head.
const STROKES: u32 = 6;
/// Distance of the eye, length of a stroke, and of its steps, meters.
const EYE: f32 = 0.8;
const LENGTH: f32 = 0.12;
const STEP: f32 = 2e-3;
/// Time between two samples, s.
const TICK: f32 = 1.0 / 120.0;

/// Times of grooming.
#[derive(Debug, Serialize)]
pub struct GroomTimes {
    /// Number of guides under the brushes, and their vertices.
    pub guides: [usize; 2],
    /// Number of strands made anew.
    pub strands: usize,
    /// Times of each operation.
    pub rows: Vec<OperationTime>,
}

/// Times of an operation.
#[derive(Debug, Serialize)]
pub struct OperationTime {
    /// Name of the brush or of the operation.
    pub name: String,
    /// Number of measurements.
    pub count: usize,
    /// Milliseconds.
    #[serde(flatten)]
    pub time: Summary,
    /// Largest allowed median, milliseconds.
    pub goal: f64,
}

impl OperationTime {
    fn of(name: &str, times: Vec<f64>, goal: f64) -> Self {
        Self { name: name.into(), count: times.len(), time: Summary::of(times), goal }
    }
}

/// Measures strokes on the built-in long style.
pub fn measure(sitting: Sitting<'_>) -> Result<GroomTimes> {
    let gpu = pollster::block_on(Gpu::open())?;
    let mut preset = workload::style(Some(GUIDES), workload::TILES);
    preset.settings.style.all_guides = true;
    let (_, mut editor) = pollster::block_on(preset.editor(&gpu.context, &()))?;
    let guides = [editor.document().guides().len(), editor.document().vertex_count()];
    let first = editor.document().clone();
    let mut rows = Vec::new();
    let (mut picks, mut undos) = (Vec::new(), Vec::new());
    let deforms_strands = |tool: BrushTool| !(tool.draws() || tool.acts_on_roots());
    for tool in BrushTool::ALL.map(|(tool, _)| tool).into_iter().filter(|tool| deforms_strands(*tool)) {
        let mut dabs = Vec::new();
        for stroke in path(&editor) {
            let (begin, others) = stroke.split_first().context("a stroke has samples")?;
            let clock = Stopwatch(sitting);
            picks.push(clock.ms(|| editor.hit(tool, begin)).1);
            editor.press(&Brush::of(tool), begin)?;
            for sample in others {
                let before = editor.dab_count();
                let (done, time) = clock.ms(|| editor.drag(sample));
                done?;
                let count = editor.dab_count() - before;
                if count > 0 {
                    dabs.push(time / count as f64);
                }
            }
            let before = editor.document().clone();
            if editor.release().is_some() {
                let (done, time) = clock.ms(|| editor.go_to(before));
                done?;
                undos.push(time);
            }
        }
        rows.push(OperationTime::of(&format!("a dab of {}", tool.name()), dabs, DAB));
        editor.go_to(first.clone())?;
    }
    rows.push(OperationTime::of("a pick", picks, PICK));
    rows.push(OperationTime::of("undo", undos, UNDO));
    let (strands, times) = settle(&gpu, &workload::style(Some(STRANDS), workload::TILES), sitting)?;
    rows.push(OperationTime::of("strands made anew", times, SETTLE));
    Ok(GroomTimes { guides, strands, rows })
}

/// Returns the number of strands of `preset`, and the times in which they are made anew after a stroke.
fn settle(gpu: &Gpu, preset: &Preset, sitting: Sitting<'_>) -> Result<(usize, Vec<f64>)> {
    let (source, mut editor) = pollster::block_on(preset.editor(&gpu.context, &()))?;
    let styling = preset
        .settings
        .without_style()
        .styling(None, &CompanionFiles::of(&preset.source, Shelf::default()).maps()?)?;
    let (mut strands, mut times) = (0, Vec::new());
    for stroke in path(&editor) {
        let (begin, others) = stroke.split_first().context("a stroke has samples")?;
        editor.press(&Brush::of(BrushTool::Comb), begin)?;
        others.iter().try_for_each(|sample| editor.drag(sample))?;
        let Some(after) = editor.release() else { continue };
        let (parts, time) = Stopwatch(sitting)
            .ms(|| pollster::block_on(source.with_document(after.clone()).dress(&styling, &())));
        parts?;
        strands = after.base().strands.len();
        times.push(time);
    }
    Ok((strands, times))
}

/// Returns strokes from top to bottom, seen from around the hair.
fn path(editor: &GroomEditor) -> Vec<Vec<StrokeSample>> {
    let positions = editor.positions();
    let center = positions.iter().sum::<Vec3>() / positions.len().max(1) as f32;
    let steps = (LENGTH / STEP) as usize;
    let stroke = |k: u32| {
        let rotation = Quat::from_rotation_y(std::f32::consts::TAU * k as f32 / STROKES as f32);
        let eye = center + rotation * Vec3::Z * EYE;
        let sample = |i: usize| {
            let target = center + Vec3::Y * (0.5 * LENGTH - i as f32 * STEP);
            StrokeSample { time: i as f32 * TICK, ..StrokeSample::ray(eye, target - eye) }
        };
        (0..=steps).map(sample).collect()
    };
    (0..STROKES).map(stroke).collect()
}

/// Measures with the clock of a sitting.
struct Stopwatch<'a>(Sitting<'a>);

impl Stopwatch<'_> {
    fn ms<T>(&self, work: impl FnOnce() -> T) -> (T, f64) {
        let begin = (self.0.clock)();
        let done = work();
        (done, 1e3 * ((self.0.clock)().saturating_sub(begin)).as_secs_f64())
    }
}

/// Formats the results as a table, with the goals.
pub fn text(times: &GroomTimes) -> String {
    let [guides, vertices] = times.guides;
    let mut rows = vec![["", "times", "median", "p95", "goal"].map(String::from).to_vec()];
    for OperationTime { name, count, time, goal } in &times.rows {
        let verdict = if time.median <= *goal { "" } else { " missed" };
        rows.push(vec![
            name.clone(),
            count.to_string(),
            ms(time.median),
            ms(time.p95),
            format!("{goal:.0}{verdict}"),
        ]);
    }
    format!(
        "\nGrooming (style long: {} guides of {vertices} vertices under brushes of their own size, {} strands made anew)\n{}",
        grouped(guides as u64),
        grouped(times.strands as u64),
        table(&rows)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_median_above_its_goal_is_marked() {
        let row = |name, time| OperationTime::of(name, vec![time], 10.0);
        let times = GroomTimes {
            guides: [5000, 32],
            strands: 20_000,
            rows: vec![row("fast", 1.0), row("slow", 11.0)],
        };
        let text = text(&times);
        let ends = |name: &str, end: &str| {
            text.lines().any(|line| line.trim().starts_with(name) && line.ends_with(end))
        };
        assert!(ends("fast", "10") && ends("slow", "10 missed"), "{text}");
    }
}
