//! Self-checks: read-back, finite images and strands, partial coverage.

use super::{
    device,
    section::{Draft, cells},
};
use crate::{args::Size, photographer::Photographer};
use anyhow::{Context, Result};
use pollster::block_on;
use tresses::{Background, Gpu, low_level::readback::blocking as readback};
use tresses_scene::{Motion, Preset, Value, Viewpoint, camera::Angle, scene::OutputRequest};

/// Size of the images.
const SIZE: Size = Size { width: 200, height: 150 };
/// Simulated frames before the hair is checked.
const FRAMES: u32 = 12;
/// Largest distance of a strand from the origin, meters.
const MAX_DISTANCE: f32 = 5.0;

/// Minimum alpha of pixels that hair covers fully.
const OPAQUE: u8 = 250;

/// Result of a check: whether it passed, and details.
type Verdict = Result<(bool, String)>;

/// Runs all checks on the default adapter.
pub fn measure(draft: &mut Draft) -> Result<()> {
    let gpu = device::open()?;
    add(draft, "buffer is read back as written", read_back(&gpu));
    let (mut tiles, camera) = animated(&gpu, "tiles")?;
    add(draft, "image has only finite values", finite_image(&mut tiles, &camera));
    add(draft, "guides are finite", finite_guides(&tiles));
    add(draft, "strands are finite", finite_strands(&tiles));
    drop(tiles);
    let (mut masks, camera) = animated(&gpu, "masks")?;
    add(draft, "masks cover pixels partly", partial_coverage(&mut masks, &camera));
    Ok(())
}

fn add(draft: &mut Draft, name: &str, verdict: Verdict) {
    let (passed, detail) = verdict.unwrap_or_else(|error| (false, format!("{error:#}")));
    if !passed {
        draft.find(format!("{name}: {detail}"));
    }
    draft.row("Checks", &["check", "passed", "detail"], cells![name, passed, detail]);
    draft.keep();
}

/// Returns a scene after [`FRAMES`] frames of a turning head, and its camera.
fn animated(gpu: &Gpu, renderer: &'static str) -> Result<(Photographer, Viewpoint)> {
    let mut preset = Preset::default();
    preset.settings.set("style.strands", 2000)?;
    preset.settings.set("renderer.kind", Value::Choice(renderer))?;
    let mut scene = Photographer::on(gpu.clone(), &preset, SIZE)?;
    let motion = Motion::named("turn").context("a built-in motion")?;
    let camera = Viewpoint::portrait(Angle::ThreeQuarter, scene.subject(), SIZE.aspect(), 1.0);
    let pivot = scene.character.neck();
    scene.watch(&camera);
    scene.reset(&motion.gesture(0.0, pivot))?;
    for frame in 1..=FRAMES {
        scene.advance(&motion.gesture(f64::from(frame) / 24.0, pivot), 1.0 / 24.0)?;
    }
    Ok((scene, camera))
}

fn read_back(gpu: &Gpu) -> Verdict {
    let written: Vec<u32> = (0..4096u32).map(|i| i.wrapping_mul(2_654_435_761)).collect();
    let (device, queue) = (gpu.context.device(), gpu.context.queue());
    let buffer = || {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read-back"),
            size: 4 * written.len() as u64,
            usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    };
    let (source, target) = (buffer(), buffer());
    queue.write_buffer(&source, 0, bytemuck::cast_slice(&written));
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(&source, 0, &target, 0, source.size());
    queue.submit([encoder.finish()]);
    let read: Vec<u32> = readback::buffer(&gpu.context, &target)?;
    let wrong = written.iter().zip(&read).filter(|(a, b)| a != b).count();
    Ok((wrong == 0 && read.len() == written.len(), format!("{wrong} of {} words differ", written.len())))
}

fn finite_image(scene: &mut Photographer, camera: &Viewpoint) -> Verdict {
    let request = OutputRequest { linear: true, hair: true, ..OutputRequest::default() };
    let captured = block_on(scene.capture(*camera, request))?;
    let values = captured.linear.iter().chain(&captured.geometry).flatten();
    let bad = values.filter(|value| !value.is_finite()).count();
    let brightest = captured.linear.iter().map(|texel| texel[1]).fold(0.0, f32::max);
    let covered = captured.coverages().into_iter().filter(|coverage| *coverage > 0.5).count();
    let detail =
        format!("{bad} values are not finite; brightest {brightest:.3}; hair covers {covered} pixels");
    Ok((bad == 0 && brightest > 0.0 && covered > 0, detail))
}

fn finite_guides(scene: &Photographer) -> Verdict {
    Ok(positions(&block_on(scene.guides())?))
}

fn finite_strands(scene: &Photographer) -> Verdict {
    let strands = block_on(scene.drawn([&scene.character.hair().strands]))?;
    Ok(positions(&strands.positions))
}

/// Checks that positions are finite and near the head.
fn positions(positions: &[tresses::glam::Vec3]) -> (bool, String) {
    let bad = positions.iter().filter(|position| !position.is_finite()).count();
    let max_distance = positions.iter().map(|position| position.length()).fold(0.0, f32::max);
    let detail =
        format!("{bad} of {} vertices are not finite; farthest {max_distance:.2} m", positions.len());
    (bad == 0 && !positions.is_empty() && max_distance < MAX_DISTANCE, detail)
}

fn partial_coverage(scene: &mut Photographer, camera: &Viewpoint) -> Verdict {
    scene.picture.background = Background::transparent();
    let request = OutputRequest { hair_only: true, ..OutputRequest::default() };
    let captured = block_on(scene.capture(*camera, request))?;
    let count = |from: u8, to: u8| {
        captured.color.as_chunks::<4>().0.iter().filter(|[.., alpha]| (from..=to).contains(alpha)).count()
    };
    let (none, partial, all) = (count(0, 0), count(1, OPAQUE - 1), count(OPAQUE, u8::MAX));
    let detail = format!("{partial} pixels partly, {all} fully, {none} not covered");
    Ok((partial > 0 && all > 0 && none > 0, detail))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tresses::glam::Vec3;

    #[test]
    fn positions_that_are_not_finite_fail() {
        assert!(positions(&[Vec3::ONE]).0);
        for bad in [&[][..], &[Vec3::NAN], &[Vec3::ONE, Vec3::INFINITY], &[Vec3::splat(100.0)]] {
            assert!(!positions(bad).0, "{bad:?}");
        }
    }
}
