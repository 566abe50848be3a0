//! Cost of many heads with one groom at 2 to 40 m, compared with one head in a portrait.

use super::{
    results::{StageSamples, StageTime},
    sitting::Sitting,
    statistics::Summary,
    table::{ms, table},
    workload::{self, FPS, WARM_UP},
};
use crate::{args::Size, photographer::Photographer};
use anyhow::{Context, Result};
use serde::Serialize;
use tresses::{LodMode, LodOptions, low_level::HeadDetail};
use tresses_scene::words::grouped;
use tresses_scene::{Crowd, CrowdOptions, Motion, Viewpoint, camera::Angle, crowd::ROWS};

/// Image size, pixels.
const SIZE: Size = Size { width: 1280, height: 720 };
/// Strands per head in full detail.
const STRANDS: u32 = 10_000;
/// Number of heads, and their largest allowed cost in portraits.
const GOAL: (u32, f64) = (100, 6.0);
/// Frames measured stage by stage.
const STAGED: u32 = 2;

/// Cost of a crowd.
#[derive(Debug, Serialize)]
pub struct CrowdTimes {
    /// Number of heads.
    pub heads: u32,
    /// Milliseconds per frame of one head in a portrait.
    pub portrait: Summary,
    /// Milliseconds per frame of the crowd.
    pub crowd: Summary,
    /// Times per stage: of the portrait, then of the crowd.
    pub stages: [Vec<StageTime>; 2],
    /// Bytes of GPU memory of a single head, and of its view.
    #[serde(rename = "alone")]
    pub single_head_bytes: [u64; 2],
    /// Bytes shared by all heads, bytes of all heads, and bytes of their view.
    pub bytes: [u64; 3],
    /// Averages of heads at similar distances.
    pub rows: Vec<Row>,
}

/// Heads at similar distances.
#[derive(Debug, Default, Serialize)]
pub struct Row {
    /// Mean distance, meters.
    pub distance: f32,
    /// Number of heads.
    pub heads: u32,
    /// Means per head: pixels, strands, vertices per strand, guides, substeps.
    pub means: [f64; 5],
    /// Bytes per head that are not shared.
    pub bytes: u64,
}

/// Measures a crowd of `heads` heads with the long style in motion.
pub fn measure(heads: u32, sitting: Sitting<'_>) -> Result<CrowdTimes> {
    let Sitting { frames, bar, .. } = sitting;
    let mut preset = workload::style(Some(STRANDS), workload::TILES);
    // The crowd's options, except that the portrait has full detail and does not sleep.
    preset.settings.lod = LodOptions { mode: LodMode::Off, can_sleep: false, ..LodOptions::CROWD };
    let mut scene = Photographer::with_clamped_samples(&preset, SIZE, None).context("a crowd")?;
    scene.measure_by(sitting.clock);
    // Remove brows, lashes and beard: only the main groom is measured.
    scene.character.shave();
    let motion = Motion::named("turn").context("a built-in motion")?;
    let pivot = scene.character.neck();
    let camera = Viewpoint::portrait(Angle::ThreeQuarter, scene.subject(), SIZE.aspect(), 1.0);
    let dt = (1.0 / FPS) as f32;
    let gesture = |frame: u32| motion.gesture(f64::from(frame) / FPS, pivot);
    scene.watch(&camera);
    scene.reset(&gesture(0))?;
    let mut portrait = Vec::new();
    for frame in 1..=WARM_UP + frames {
        let wall = scene.measured_frame_time(&gesture(frame), dt, &camera)?;
        if frame > WARM_UP {
            portrait.push(wall);
            bar.inc(1);
        }
    }
    let single_head_bytes = [
        scene.character.hair().bytes(),
        scene.view.shadow_bytes()
            + scene.view.ambient_bytes()
            + scene.view.shaded_bytes()
            + scene.targets().bytes(),
    ];
    let mut stages = [(); 2].map(|()| StageSamples::default());
    for frame in 1..=STAGED {
        let measured = scene.measured_frame(&gesture(WARM_UP + frames + frame), dt, &camera)?;
        stages[0].add(measured.stages);
    }
    let options = CrowdOptions { heads, rows: ROWS, pigments: true };
    let mut crowd = Crowd::new(&mut scene, &options)?;
    crowd.set_lod(LodOptions::CROWD);
    let mut all = Vec::new();
    for frame in 0..=WARM_UP + frames + STAGED {
        let times = (f64::from(frame) / FPS, if frame == 0 { 0.0 } else { dt });
        let staged = frame > WARM_UP + frames;
        let measured = scene.measured_crowd(&mut crowd, &motion, times, staged)?;
        if staged {
            stages[1].add(measured.stages);
        } else if frame > WARM_UP {
            all.push(measured.wall);
            bar.inc(1);
        }
    }
    Ok(CrowdTimes {
        heads,
        portrait: Summary::of(portrait),
        crowd: Summary::of(all),
        stages: stages.map(StageSamples::summarize),
        single_head_bytes,
        bytes: crowd.bytes(&scene),
        rows: rows(&crowd.distances(), &crowd.detail().heads),
    })
}

/// Groups heads by distance, in steps of a factor of 1.5.
fn rows(distances: &[f32], heads: &[HeadDetail]) -> Vec<Row> {
    let mut rows: Vec<(i32, Row)> = Vec::new();
    for (distance, head) in distances.iter().zip(heads).filter(|(_, head)| head.is_visible) {
        let step = (distance.max(0.1).ln() / 1.5f32.ln()).floor() as i32;
        let at = rows.binary_search_by_key(&step, |(step, _)| *step).unwrap_or_else(|at| {
            rows.insert(at, (step, Row::default()));
            at
        });
        let row = &mut rows[at].1;
        row.heads += 1;
        row.distance += distance;
        row.bytes += head.bytes;
        let values = [
            head.size,
            head.strand_count as f32,
            head.vertex_count as f32,
            head.guide_count as f32,
            head.substep_count as f32,
        ];
        row.means.iter_mut().zip(values).for_each(|(mean, value)| *mean += f64::from(value));
    }
    for (_, row) in &mut rows {
        row.distance /= row.heads as f32;
        row.bytes /= u64::from(row.heads);
        row.means.iter_mut().for_each(|mean| *mean /= f64::from(row.heads));
    }
    rows.into_iter().map(|(_, row)| row).collect()
}

/// Formats the results as tables, with a verdict on the goal.
pub fn text(times: &CrowdTimes) -> String {
    let mb = |bytes: u64| format!("{:.1}", bytes as f64 * 1e-6);
    let head = ["meters", "heads", "pixels", "strands", "vertices each", "guides", "substeps", "MB each"];
    let mut lines = vec![head.map(String::from).to_vec()];
    for Row { distance, heads, means: [pixels, strands, vertices, guides, substeps], bytes } in &times.rows {
        lines.push(vec![
            format!("{distance:.1}"),
            heads.to_string(),
            format!("{pixels:.0}"),
            grouped(*strands as u64),
            format!("{vertices:.1}"),
            format!("{guides:.0}"),
            format!("{substeps:.1}"),
            mb(*bytes),
        ]);
    }
    let mut text = format!(
        "\nA crowd (style long in motion, {} heads of {} strands, {} × {})\n{}",
        times.heads,
        grouped(STRANDS.into()),
        SIZE.width,
        SIZE.height,
        table(&lines)
    );
    let [one, all] = &times.stages;
    let mut lines = vec![["stage", "one head in a portrait", "crowd"].map(String::from).to_vec()];
    let names = one.iter().chain(all).map(|stage| &stage.name);
    let mut unique_names: Vec<&String> = Vec::new();
    for name in names {
        if unique_names.contains(&name) {
            continue;
        }
        unique_names.push(name);
        let of = |list: &[StageTime]| {
            list.iter().find(|stage| stage.name == *name).map_or("-".into(), |stage| ms(stage.time.median))
        };
        lines.push(vec![name.clone(), of(one), of(all)]);
    }
    let (portrait, crowd) = (times.portrait.median, times.crowd.median);
    lines.push(vec!["whole frame".into(), ms(portrait), ms(crowd)]);
    text += &table(&lines);
    let [head_bytes, view] = times.single_head_bytes;
    let [shared, own, crowd_view] = times.bytes;
    text += &format!(
        "One head alone uses {} MB and its view {} MB; the crowd shares {} MB, its heads use {} MB, its view {} MB.\n",
        mb(head_bytes),
        mb(view),
        mb(shared),
        mb(own),
        mb(crowd_view)
    );
    let ratio = crowd / portrait.max(1e-9);
    text += &format!("{} heads cost as much as {ratio:.2} portraits", times.heads);
    if times.heads == GOAL.0 {
        let verdict =
            if ratio <= GOAL.1 { "within the goal of at most" } else { "above the goal of at most" };
        text += &format!("; {verdict} {:.0}", GOAL.1);
    }
    text + ".\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crowd_is_compared_with_a_portrait() {
        let head = |strands| {
            let mut head = HeadDetail::default();
            (head.is_visible, head.strand_count, head.vertex_count) = (true, strands, 10);
            head
        };
        let unseen = HeadDetail::default();
        let rows = rows(&[2.0, 2.1, 30.0, 5.0], &[head(3000), head(1000), head(800), unseen]);
        assert_eq!(rows.iter().map(|row| row.heads).collect::<Vec<_>>(), [2, 1]);
        assert_eq!(rows[0].means[1], 2000.0);
        let times = |ms: f64| CrowdTimes {
            heads: 100,
            portrait: Summary { median: 10.0, p95: 10.0 },
            crowd: Summary { median: ms, p95: ms },
            stages: [
                vec![StageTime { name: "shadow".into(), time: Summary::of(vec![1.0]) }],
                vec![StageTime { name: "shadow".into(), time: Summary::of(vec![3.0]) }],
            ],
            single_head_bytes: [1; 2],
            bytes: [1; 3],
            rows: Vec::new(),
        };
        assert!(
            text(&times(50.0))
                .ends_with("100 heads cost as much as 5.00 portraits; within the goal of at most 6.\n")
        );
        assert!(text(&times(70.0)).ends_with("7.00 portraits; above the goal of at most 6.\n"));
        assert!(
            text(&times(50.0)).lines().any(|line| line.split_whitespace().eq(["shadow", "1.00", "3.00"]))
        );
    }
}
