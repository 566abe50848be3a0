//! Times of grooming: a dab of each brush, a pick, undo, and rebuilding the strands after a stroke.

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

/// Number of guides under the brushes; every strand is a guide.
const GUIDES: u32 = 5_000;
/// Number of strands that are rebuilt after a stroke.
const STRANDS: u32 = 20_000;
/// Largest allowed median times, milliseconds.
const DAB_GOAL: f64 = 10.0;
const PICK_GOAL: f64 = 2.0;
const UNDO_GOAL: f64 = 16.0;
const REBUILD_GOAL: f64 = 500.0;
/// Number of strokes with each brush, around the head.
const STROKES: u32 = 6;
/// Distance of the eye from the center of the hair, meters.
const EYE_DISTANCE: f32 = 0.8;
/// Length of a stroke and distance between its samples, meters.
const STROKE_LENGTH: f32 = 0.12;
const SAMPLE_SPACING: f32 = 2e-3;
/// Time between two samples, s.
const SAMPLE_INTERVAL: f32 = 1.0 / 120.0;

/// Times of grooming.
#[derive(Debug, Serialize)]
pub struct GroomTimes {
    /// Number of guides under the brushes, and their vertices.
    pub guides: [usize; 2],
    /// Number of strands rebuilt after a stroke.
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
    let initial = editor.document().clone();
    let mut rows = Vec::new();
    let (mut picks, mut undos) = (Vec::new(), Vec::new());
    let deforms_strands = |tool: BrushTool| !(tool.draws() || tool.acts_on_roots());
    for tool in BrushTool::ALL.map(|(tool, _)| tool).into_iter().filter(|tool| deforms_strands(*tool)) {
        let mut dabs = Vec::new();
        for stroke in strokes(&editor) {
            let (first_sample, others) = stroke.split_first().context("a stroke has samples")?;
            let stopwatch = Stopwatch(sitting);
            picks.push(stopwatch.measure_ms(|| editor.hit(tool, first_sample)).1);
            editor.press(&Brush::of(tool), first_sample)?;
            for sample in others {
                let dabs_before = editor.dab_count();
                let (result, time) = stopwatch.measure_ms(|| editor.drag(sample));
                result?;
                let new_dabs = editor.dab_count() - dabs_before;
                if new_dabs > 0 {
                    dabs.push(time / new_dabs as f64);
                }
            }
            let before = editor.document().clone();
            if editor.release().is_some() {
                let (result, time) = stopwatch.measure_ms(|| editor.go_to(before));
                result?;
                undos.push(time);
            }
        }
        rows.push(OperationTime::of(&format!("a dab of {}", tool.name()), dabs, DAB_GOAL));
        editor.go_to(initial.clone())?;
    }
    rows.push(OperationTime::of("a pick", picks, PICK_GOAL));
    rows.push(OperationTime::of("undo", undos, UNDO_GOAL));
    let (strands, times) = rebuild_strands(&gpu, &workload::style(Some(STRANDS), workload::TILES), sitting)?;
    rows.push(OperationTime::of("strands made anew", times, REBUILD_GOAL));
    Ok(GroomTimes { guides, strands, rows })
}

/// Rebuilds the strands of `preset` after each stroke. Returns their number and the times, milliseconds.
fn rebuild_strands(gpu: &Gpu, preset: &Preset, sitting: Sitting<'_>) -> Result<(usize, Vec<f64>)> {
    let (source, mut editor) = pollster::block_on(preset.editor(&gpu.context, &()))?;
    let styling = preset
        .settings
        .without_style()
        .styling(None, &CompanionFiles::of(&preset.source, Shelf::default()).maps()?)?;
    let (mut strands, mut times) = (0, Vec::new());
    for stroke in strokes(&editor) {
        let (first_sample, others) = stroke.split_first().context("a stroke has samples")?;
        editor.press(&Brush::of(BrushTool::Comb), first_sample)?;
        others.iter().try_for_each(|sample| editor.drag(sample))?;
        let Some(after) = editor.release() else { continue };
        let (parts, time) = Stopwatch(sitting)
            .measure_ms(|| pollster::block_on(source.with_document(after.clone()).parts(&styling, &())));
        parts?;
        strands = after.base().strands.len();
        times.push(time);
    }
    Ok((strands, times))
}

/// Returns strokes from top to bottom, each from another view around the hair.
fn strokes(editor: &GroomEditor) -> Vec<Vec<StrokeSample>> {
    let positions = editor.positions();
    let center = positions.iter().sum::<Vec3>() / positions.len().max(1) as f32;
    let steps = (STROKE_LENGTH / SAMPLE_SPACING) as usize;
    let stroke = |k: u32| {
        let rotation = Quat::from_rotation_y(std::f32::consts::TAU * k as f32 / STROKES as f32);
        let eye = center + rotation * Vec3::Z * EYE_DISTANCE;
        let sample = |i: usize| {
            let target = center + Vec3::Y * (0.5 * STROKE_LENGTH - i as f32 * SAMPLE_SPACING);
            StrokeSample { time: i as f32 * SAMPLE_INTERVAL, ..StrokeSample::ray(eye, target - eye) }
        };
        (0..=steps).map(sample).collect()
    };
    (0..STROKES).map(stroke).collect()
}

/// Measures times with the clock of the benchmark.
struct Stopwatch<'a>(Sitting<'a>);

impl Stopwatch<'_> {
    /// Returns the result of `work` and the time that it took, milliseconds.
    fn measure_ms<T>(&self, work: impl FnOnce() -> T) -> (T, f64) {
        let start = (self.0.clock)();
        let result = work();
        (result, 1e3 * ((self.0.clock)().saturating_sub(start)).as_secs_f64())
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
