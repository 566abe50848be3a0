//! Films of recorded strokes: the brush at work on the hair, seen from where each stroke was drawn.

use crate::{
    args::Size,
    photographer::Photographer,
    picture::{FrameWriter, Image, OutputFrame},
    progress,
};
use anyhow::{Context, Result};
use std::path::Path;
use tresses::{
    Camera, CharacterSource, Gesture, Gpu,
    glam::{Vec2, Vec3},
    groom::edit::{GroomDocument, GroomEditor, ScriptStep, StrokeSample, StrokeScript},
};
use tresses_scene::{CompanionFiles, Preset, Scene, Shelf, Viewpoint, camera::VERTICAL_FOV};

/// Frames per second.
const FPS: f64 = 10.0;
/// Frames of a stroke, of the camera's way to the next, after a stroke, and of the turn at the end.
const STROKE: u32 = 4;
const TRANSITION: u32 = 4;
const REST: u32 = 1;
const ORBIT: u32 = 24;
/// Angle between two views from which the camera takes a way, radians.
const SAME: f32 = 0.05;
/// Highest and lowest elevation of the camera, radians.
const ELEVATION: std::ops::RangeInclusive<f32> = -0.4..=1.0;
/// Points of the ring, and its color.
const RING: u32 = 400;
const WHITE: [u8; 3] = [255; 3];

/// Direction of a camera: azimuth towards the head's left, and elevation, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
struct View(Vec2);

impl View {
    /// Returns the direction from which `samples` were drawn; without a camera, the direction of their middle from
    /// `center`.
    fn of(samples: &[StrokeSample], center: Vec3) -> Self {
        let back: Vec3 = samples.iter().map(|sample| -sample.direction).sum();
        let mean_origin =
            samples.iter().map(|sample| sample.origin).sum::<Vec3>() / samples.len().max(1) as f32;
        let back = back.try_normalize().unwrap_or_else(|| (mean_origin - center).normalize_or(Vec3::Z));
        let elevation = back.y.asin().clamp(*ELEVATION.start(), *ELEVATION.end());
        Self(Vec2::new(back.x.atan2(back.z), elevation))
    }

    fn back(self) -> Vec3 {
        let (azimuth, elevation) = (self.0.x, self.0.y);
        Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos())
    }

    /// Returns the view between this one and `other`, by the shorter way around the head.
    fn towards(self, other: Self, fraction: f32) -> Self {
        let full_circle = std::f32::consts::TAU;
        let mut delta = other.0 - self.0;
        delta.x -= full_circle * (delta.x / full_circle).round();
        Self(self.0 + delta * (fraction * fraction * (3.0 - 2.0 * fraction)))
    }

    fn is_near(self, other: Self) -> bool {
        self.back().dot(other.back()) > SAME.cos()
    }
}

/// A film of strokes.
pub struct Timelapse<'a> {
    gpu: Gpu,
    preset: &'a Preset,
    source: &'a CharacterSource,
    size: Size,
    camera: Viewpoint,
    view: View,
    output: FrameWriter,
}

impl<'a> Timelapse<'a> {
    /// Begins a film of the character `source` into the file `path`.
    pub fn new(
        gpu: Gpu,
        preset: &'a Preset,
        source: &'a CharacterSource,
        path: &Path,
        size: Size,
    ) -> Result<Self> {
        let output = FrameWriter::create(path, (size.width, size.height), 0, FPS)?;
        let camera = Viewpoint { eye: Vec3::Z, target: Vec3::ZERO };
        Ok(Self { gpu, preset, source, size, camera, view: View(Vec2::new(0.55, 0.1)), output })
    }

    /// Films `script` while applying it to the groom of `editor`. Returns the number of versions after the first, and a
    /// description of the file.
    pub fn film(mut self, editor: &mut GroomEditor, script: &StrokeScript) -> Result<(usize, String)> {
        let bar = progress::frames("drawing strokes", script.steps.len() as u64);
        let first = self.view;
        let mut scene = self.scene(editor.document())?;
        let subject = scene.subject();
        let target = 0.5 * (subject.0 + subject.1);
        let aspect = self.size.aspect();
        let distance = tresses::low_level::framing_distance(subject, first.back(), VERTICAL_FOV, aspect);
        self.camera = Viewpoint { eye: target + first.back() * distance, target };
        let mut versions = vec![editor.document().clone()];
        for step in &script.steps {
            if let ScriptStep::Stroke { brush, samples } = step {
                let view = View::of(samples, target);
                if !self.view.is_near(view) {
                    self.move_camera(&mut scene, view, TRANSITION)?;
                }
                let Some((begin, others)) = samples.split_first() else { continue };
                if editor.press(brush, begin)? {
                    let length = (others.len() / STROKE as usize).max(1);
                    for part in others.chunks(length) {
                        part.iter().try_for_each(|sample| editor.drag(sample))?;
                        self.pose(&mut scene, editor)?;
                    }
                    versions.extend(editor.release());
                }
            } else if *step == ScriptStep::Undo {
                versions.pop();
                let version = versions.last().context("there is no stroke to undo")?;
                editor.go_to(version.clone())?;
            } else {
                versions.extend(StrokeScript { steps: vec![step.clone()] }.apply(editor)?);
            }
            scene = self.scene(editor.document())?;
            (0..REST).try_for_each(|_| self.frame(&mut scene, None))?;
            bar.inc(1);
        }
        for k in 1..=ORBIT {
            let around = std::f32::consts::TAU * k as f32 / ORBIT as f32;
            let view = View(Vec2::new(self.view.0.x + around, first.0.y));
            let shown_view =
                if k < TRANSITION { self.view.towards(view, k as f32 / TRANSITION as f32) } else { view };
            self.look(shown_view);
            self.frame(&mut scene, None)?;
        }
        bar.finish_and_clear();
        Ok((versions.len() - 1, self.output.finish()?))
    }

    /// Returns a scene with a version of the hair.
    fn scene(&self, document: &GroomDocument) -> Result<Photographer> {
        let settings = self.preset.settings.without_style();
        let source = self.source.with_document(document.clone());
        let companion_files = CompanionFiles::of(&self.preset.source, Shelf::default());
        let parts =
            pollster::block_on(source.parts(&settings.styling(None, &companion_files.maps()?)?, &()))?;
        let max_samples = self.gpu.context.tier().max_samples;
        let mut quality = settings.quality([self.size.width, self.size.height], max_samples)?;
        quality.view.renderer = quality.view.renderer.with_max_samples(max_samples);
        let scene =
            Scene::new(self.gpu.clone(), parts, companion_files.colliders()?, &settings, &quality, &());
        let mut scene = pollster::block_on(scene)?;
        scene.apply(&settings)?;
        scene.set_surroundings(companion_files.surroundings()?.map(Into::into));
        scene.reset(&Gesture::default())?;
        Ok(Photographer::of(scene))
    }

    fn look(&mut self, view: View) {
        let distance = self.camera.distance();
        self.camera = Viewpoint { eye: self.camera.target + view.back() * distance, ..self.camera };
    }

    /// Moves the camera.
    fn move_camera(&mut self, scene: &mut Photographer, to: View, frames: u32) -> Result<()> {
        let from = self.view;
        for k in 1..=frames {
            self.look(from.towards(to, k as f32 / frames as f32));
            self.frame(scene, None)?;
        }
        self.view = to;
        Ok(())
    }

    /// Shows the hair with the current positions of the guides.
    fn pose(&mut self, scene: &mut Photographer, editor: &GroomEditor) -> Result<()> {
        scene.character.hair_mut().pose_guides(editor.positions())?;
        scene.advance(&Gesture::default(), 0.0)?;
        self.frame(scene, editor.brush_at())
    }

    fn frame(&mut self, scene: &mut Photographer, brush: Option<(Vec3, f32)>) -> Result<()> {
        let mut picture = scene.picture(&self.camera)?;
        if let Some((center, radius)) = brush {
            self.ring(&mut picture, scene.character.head().point(center), radius);
        }
        self.output.add(OutputFrame::Shown(picture))
    }

    /// Draws a ring across the line of sight.
    fn ring(&self, picture: &mut Image, center: Vec3, radius: f32) {
        let size = [picture.width, picture.height];
        let camera = Camera::look_at(self.camera.eye, self.camera.target, VERTICAL_FOV, size);
        let view_direction = (center - self.camera.eye).normalize_or(Vec3::NEG_Z);
        let right = view_direction.cross(Vec3::Y).normalize_or(Vec3::X);
        let up = right.cross(view_direction);
        for i in 0..RING {
            let (sin, cos) = (std::f32::consts::TAU * i as f32 / RING as f32).sin_cos();
            let clip =
                camera.projection * camera.view * (center + (right * cos + up * sin) * radius).extend(1.0);
            if clip.w <= 0.0 {
                continue;
            }
            let uv = Vec2::new(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
            let pixel = (uv * Vec2::new(size[0] as f32, size[1] as f32)).floor();
            let inside =
                pixel.cmpge(Vec2::ZERO).all() && pixel.x < size[0] as f32 && pixel.y < size[1] as f32;
            if inside {
                let at = 4 * (pixel.y as usize * size[0] as usize + pixel.x as usize);
                picture.rgba[at..at + 3].copy_from_slice(&WHITE);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn camera_looks_along_the_stroke_and_takes_the_short_way() {
        let sample = StrokeSample::ray(Vec3::new(-2.0, 0.0, -0.1), Vec3::X);
        let right = View::of(&[sample], Vec3::ZERO);
        assert!(right.back().distance(Vec3::NEG_X) < 1e-5);
        let left = View::of(&[StrokeSample::point(Vec3::new(0.1, 0.0, -0.01))], Vec3::ZERO);
        assert!(left.back().x > 0.99 && !left.is_near(right));
        // Over the back, not over the face.
        let (a, b) = (View(Vec2::new(3.0, 0.0)), View(Vec2::new(-3.0, 0.0)));
        assert!(a.towards(b, 0.5).back().z < -0.99 && a.towards(b, 1.0).is_near(b));
        let above = View::of(&[StrokeSample::ray(Vec3::Y, Vec3::NEG_Y)], Vec3::ZERO);
        assert_eq!(above.0.y, *ELEVATION.end());
    }
}
