//! A groom of the reference on the GPU, and renders of it.

use super::Shading;
use super::{
    metrics::Linear,
    scenes::{Folders, GroomDescription as Description, Radius, ReferenceView, Scenes},
};
use crate::{flags::RowFlags, picture::Image, settings_args::apply_rows};
use anyhow::{Context as _, Error, Result, ensure};
use half::f16;
use tresses::{
    Background, Body, BodyMaterial, Camera, Context, Gpu, Picture as Shot, Pose, SimulationParams, ToneMap,
    View, ViewOptions,
    collide::ColliderPoses,
    glam::{Affine3A, Mat4, Vec3},
    groom::{
        BindOptions, MAX_STRAND_VERTICES, Strands, TriMesh, bind,
        import::{self, ImportOptions},
        orient::{Axis, LengthUnit, OrientationOverride},
        srgb::linear,
    },
    light::{Lights, Shadows, Sky, Sphere},
    low_level::{
        DebugDisplay, DebugView, DebugViews, Drawing, Hair, HairAsset, HairDescriptor, HairFrame,
        ViewContent, Zone, readback::blocking as readback,
    },
    renderer::Renderer,
};
use tresses_scene::{EnvironmentMap, Settings, Shelf, knobs};

/// Format of the output texture.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Exposure at which no highlight reaches the shoulder of the tone curve.
const DIM: f32 = 1.0 / 64.0;
/// Filter radius of shadows on bodies, meters. The reference has lights without extent.
const POINT: f32 = 0.0005;
/// Curve segments per segment of the control polygon.
const FINER: usize = 2;

/// A groom of the reference, at rest: one head, or several copies of it.
pub struct ReferenceScene {
    name: String,
    context: Context,
    /// The copies, each with its body at the same index.
    heads: Vec<Hair>,
    bodies: Vec<Body>,
    view: View,
    /// Created on first use.
    debug: Option<DebugViews>,
    output: wgpu::Texture,
    /// Meters per unit of the description.
    unit: f32,
    /// Region of the shadow maps of each head.
    foci: Vec<Sphere>,
}

impl ReferenceScene {
    /// Uploads the groom of `view`.
    pub fn new(view: &ReferenceView<'_>, folders: &Folders<'_>, samples: Option<u32>) -> Result<Self> {
        let gpu = pollster::block_on(Gpu::open())?;
        let context = gpu.context;
        let max_samples = context.tier().max_samples;
        let samples = samples.unwrap_or(max_samples.min(8));
        ensure!(
            samples <= max_samples,
            "--samples is {samples}, but {} supports at most {max_samples} per pixel",
            gpu.info.name
        );
        let unit = view.groom.unit()?;
        let orient = OrientationOverride {
            unit: Some(LengthUnit(unit)),
            up: Some(Axis::Y),
            front: Some(Axis::Z),
            is_mirrored: Some(false),
        };
        let options = ImportOptions { orient, orient_head: orient, skips_repair: true, ..Default::default() };
        let (strands, _) = import::read(&[view.groom.strands(folders)?], &options)?;
        let strands = curves(&strands, view.groom, unit);
        let vertices = strands.range(0).len() as u32;
        let groom =
            bind(&strands, &BindOptions { strand_vertex_count: Some(vertices), ..Default::default() })?;
        let head = head(view.groom, folders, &options, unit)?;
        let hair_bounds = groom.bounds().context("the groom is empty")?;
        let asset = HairAsset::new(&context, groom, &HairDescriptor::default())?;
        ensure!(
            !view.groom.copies.is_empty(),
            "{}: the groom has no copies; leave them out for one",
            view.name
        );
        let copies: Vec<_> = view.groom.copies.iter().map(|copy| Vec3::from(*copy) * unit).collect();
        let heads = copies.iter().map(|_| Hair::new(&asset)).collect::<tresses::Result<_>>()?;
        let mut body = Body::new(&context, &head);
        body.material = BodyMaterial { gloss: 0.0, wrap: 0.0, ..Default::default() };
        let mut bodies: Vec<_> = copies.iter().skip(1).map(|_| body.instance(false)).collect();
        bodies.insert(0, body);
        bodies.iter_mut().zip(&copies).for_each(|(body, copy)| body.pose = moved(*copy));
        let subject = tresses::low_level::subject(hair_bounds, head.bounds());
        let [width, height] = view.groom.camera.resolution;
        let renderer = Renderer::tiles(samples);
        let options = ViewOptions { renderer, output: FORMAT, ..Default::default() };
        let eye = View::new(&context, &options, [width, height], 1)?;
        let output = context.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("compared"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let name = view.groom_name.to_owned();
        let around = |copy: &Vec3| Sphere::around(subject.0 + *copy, subject.1 + *copy);
        let foci = copies.iter().map(around).collect();
        Ok(Self { name, context, heads, bodies, view: eye, debug: None, output, unit, foci })
    }

    /// Returns the name of the groom.
    pub fn groom(&self) -> &str {
        &self.name
    }

    /// Renders an image like the reference's PNG files.
    pub fn draw(
        &mut self,
        view: &ReferenceView<'_>,
        scenes: &Scenes,
        shading: &RowFlags<Shading>,
    ) -> Result<Image> {
        let scene = self.scene(view, scenes, shading)?;
        let shown = self.shown(&scene, None)?;
        let [width, height] = self.view.targets().size;
        let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        let rgba = shown.iter().flat_map(|[r, g, b]| [byte(*r), byte(*g), byte(*b), 255]).collect();
        Ok(Image { width, height, rgba })
    }

    /// Renders linear radiance in front of black: all light of `view`, or light scattered once.
    pub fn radiance(
        &mut self,
        view: &ReferenceView<'_>,
        scenes: &Scenes,
        shading: &RowFlags<Shading>,
    ) -> Result<Linear> {
        let scene = dim(self.scene(view, scenes, shading)?);
        if view.once {
            return self.once(scene);
        }
        Ok(radiance(self.view.targets().size[0], &self.shown(&scene, None)?))
    }

    /// Renders single-scattered radiance, with and without shadows.
    pub fn draw_once(
        &mut self,
        view: &ReferenceView<'_>,
        scenes: &Scenes,
        shading: &RowFlags<Shading>,
    ) -> Result<[Linear; 2]> {
        let scene = dim(self.scene(view, scenes, shading)?);
        let off = Shadows { is_enabled: false, ..scene.shadows };
        Ok([self.once(scene.clone())?, self.once(Shot { shadows: off, ..scene })?])
    }

    /// Renders the single-scattered radiance of `scene`.
    fn once(&mut self, scene: Shot) -> Result<Linear> {
        // Ambient light includes light reflected by bodies, which is scattered twice.
        let scene = Shot { shadows: Shadows { has_ambient: false, ..scene.shadows }, ..scene };
        let width = self.view.targets().size[0];
        let mut views = self.debug.take().map_or_else(|| DebugViews::new(&self.context, FORMAT), Ok)?;
        // Direct light minus multiple scattering. The subtraction also removes the body, so add it back: the sky is
        // black here, so the `Sky` view shows only the body.
        let [all, many, none] = [DebugView::Direct, DebugView::Multiple, DebugView::Sky]
            .map(|view| self.shown(&scene, Some((&mut views, view))));
        self.debug = Some(views);
        let [all, many, none] = [all?, many?, none?].map(|pixels| radiance(width, &pixels));
        let add = |i: usize, c: usize| all.pixels[i][c] - many.pixels[i][c] + none.pixels[i][c];
        let pixels = (0..all.pixels.len()).map(|i| [0, 1, 2].map(|c| add(i, c))).collect();
        Ok(Linear { width, pixels })
    }

    /// Returns the scene of `view`, and sets the material of the hair.
    fn scene(
        &mut self,
        view: &ReferenceView<'_>,
        scenes: &Scenes,
        shading: &RowFlags<Shading>,
    ) -> Result<Shot> {
        let mut settings = material(view)?;
        apply_rows(shading, &mut settings)?;
        let options = ViewOptions {
            ambient_resolution: settings.view.ambient_resolution,
            strand_map_resolution: settings.view.strand_map_resolution,
            renderer: self.view.options().renderer.with_shading(settings.renderer.model),
            ..*self.view.options()
        };
        self.view.set_options(&options)?;
        let camera = &view.groom.camera;
        let in_meters = |p: [f32; 3]| Vec3::from(p) * self.unit;
        let (eye, target) = (in_meters(camera.origin), in_meters(camera.target));
        let camera =
            Camera::look_at(eye, target, camera.vertical_fov_degrees.to_radians(), camera.resolution);
        let material = settings.material();
        self.heads.iter_mut().for_each(|hair| hair.set.material = material);
        if self.heads.len() > 1 {
            let zone = |(i, focus): (usize, &Sphere)| Zone {
                pose: self.bodies[i].pose,
                ..Zone::for_camera(*focus, &camera, 0.0, vec![i], vec![i])
            };
            self.view.set_zones(&self.foci.iter().enumerate().map(zone).collect::<Vec<_>>());
        }
        Ok(Shot {
            camera,
            lights: lights(view, scenes, self.unit)?,
            focus: self.foci[0],
            shadows: Shadows { body_radius: POINT, ..settings.shadows },
            background: Background::flat(Vec3::splat(scenes.background_linear)),
            ..Default::default()
        })
    }

    /// Renders `scene`, or a debug view of it. Returns sRGB values from 0 to 1.
    fn shown(
        &mut self,
        scene: &Shot,
        mut shown: Option<(&mut DebugViews, DebugView)>,
    ) -> Result<Vec<[f32; 3]>> {
        self.record(scene, shown.as_mut().map(|(views, which)| (&mut **views, *which)))?;
        // If bins overflowed, the view has enlarged them by now, so render again.
        if !pollster::block_on(self.view.is_complete())? {
            self.record(scene, shown)?;
        }
        let bytes = readback::texture(&self.context, &self.output)?;
        let halves: Vec<f16> = bytemuck::pod_collect_to_vec(&bytes);
        Ok(halves
            .as_chunks::<4>()
            .0
            .iter()
            .map(|[r, g, b, _]| [r.to_f32(), g.to_f32(), b.to_f32()])
            .collect())
    }

    /// Records and submits a frame.
    fn record(&mut self, scene: &Shot, shown: Option<(&mut DebugViews, DebugView)>) -> Result<()> {
        let context = self.context.clone();
        let mut encoder = context.device().create_command_encoder(&Default::default());
        let mut recorder = context.recorder(&mut encoder);
        for (hair, body) in self.heads.iter_mut().zip(&self.bodies) {
            let frame = HairFrame {
                dt: 0.0,
                head: body.pose,
                colliders: &ColliderPoses::default(),
                simulation: &SimulationParams::default(),
                ..Default::default()
            };
            recorder.advance(hair, &frame)?;
        }
        let output = self.output.create_view(&Default::default());
        let shown = shown.map(|(views, which)| (views, DebugDisplay::new(which)));
        let shows = match shown {
            None => ViewContent::Hair,
            Some((views, ref shown)) => ViewContent::Inside(views, shown),
        };
        let drawing = Drawing { output: Some(&output), shows, ..Drawing::new(scene) };
        let (heads, bodies): (Vec<_>, Vec<_>) = (self.heads.iter().collect(), self.bodies.iter().collect());
        recorder.draw(&heads, &bodies, &self.view, drawing)?;
        context.queue().submit([encoder.finish()]);
        Ok(())
    }
}

/// Returns the pose of a copy at `position`, meters.
fn moved(position: Vec3) -> Pose {
    Pose { translation: position, ..Pose::IDENTITY }
}

/// Returns `scene` in front of black, at the exposure [`DIM`].
fn dim(scene: Shot) -> Shot {
    let tone = ToneMap { exposure: DIM, shoulder: 0.99, desaturation: 0.0 };
    Shot { background: Background::flat(Vec3::ZERO), tone, ..scene }
}

/// Recovers the radiance of an image rendered at [`DIM`].
fn radiance(width: u32, dim: &[[f32; 3]]) -> Linear {
    Linear { width, pixels: dim.iter().map(|rgb| rgb.map(|v| linear(v) / DIM)).collect() }
}

/// Settings that make all strands alike from root to tip, as in the reference.
const UNIFORM: [(&str, &str); 5] = [
    ("shading.root_pigment", "1"),
    ("shading.tip_pigment", "1"),
    ("shading.lightness_spread", "0"),
    ("shading.warmth_spread", "0"),
    ("shading.highlight_spread", "0"),
];

/// Returns the settings that come closest to the material of `view`.
fn material(view: &ReferenceView<'_>) -> Result<Settings> {
    let mut settings = Settings::default();
    let mut set = |name: &str, value: &str| -> Result<()> {
        let knob = knobs::named(name).map_err(Error::msg)?;
        Ok(knob.set(&mut settings, knob.parse(value)?)?)
    };
    match (view.material, view.pigments) {
        ("brunette", None) => set("shading.color", "brown")?,
        (name, None) => {
            set("shading.color", name).with_context(|| format!("there is no material {name}"))?;
        }
        (_, Some([eumelanin, pheomelanin])) => {
            set("shading.color", "melanin")?;
            set("shading.eumelanin", &eumelanin.to_string())?;
            set("shading.pheomelanin", &pheomelanin.to_string())?;
        }
    }
    if let Some([along, around]) = view.roughness {
        set("shading.roughness_along", &along.to_string())?;
        set("shading.roughness_around", &around.to_string())?;
    }
    for (name, value) in UNIFORM {
        set(name, value)?;
    }
    Ok(settings)
}

/// Returns the lights of `view`, whose unit is `unit` meters.
fn lights(view: &ReferenceView<'_>, scenes: &Scenes, unit: f32) -> Result<Lights> {
    if let Some(map) = view.environment_map {
        ensure!(view.lights.is_empty(), "{}: an environment map cannot be combined with lights", view.name);
        return Ok(EnvironmentMap::read(map, &Shelf::default())?.lights(&Settings::default().lights));
    }
    let light = |name: &String| {
        let light = view.groom.lights.get(name).with_context(|| format!("there is no light {name}"))?;
        anyhow::Ok(light.light(unit))
    };
    let list = view.lights.iter().map(light).collect::<Result<_>>()?;
    let sky = if view.environment { scenes.environment_radiance_rgb.into() } else { Vec3::ZERO };
    let sky = Sky { zenith: sky, horizon: sky, ground: sky };
    Ok(Lights { list, sky, ..Default::default() })
}

/// Returns the strands as the reference draws them: uniform cubic B-splines from the first to the last vertex, with
/// mirrored end points and linearly decreasing radii. Meters.
fn curves(strands: &Strands, groom: &Description, unit: f32) -> Strands {
    let mut curves = Strands::default();
    let max_vertices = strands.iter().map(<[Vec3]>::len).max().unwrap_or(0);
    // Strands that already have the maximum number of vertices are fine enough.
    let finer = if (max_vertices.max(1) - 1) * FINER < MAX_STRAND_VERTICES as usize { FINER } else { 1 };
    for strand in strands.iter() {
        let last = strand.len() - 1;
        let at = |i: isize| match usize::try_from(i) {
            Err(_) => 2.0 * strand[0] - strand[1],
            Ok(i) if i > last => 2.0 * strand[last] - strand[last - 1],
            Ok(i) => strand[i],
        };
        let points: Vec<Vec3> = (0..=last * finer)
            .map(|k| {
                let (i, t) = ((k / finer) as isize, (k % finer) as f32 / finer as f32);
                let s = 1.0 - t;
                let weights = [
                    s * s * s,
                    3.0 * t * t * t - 6.0 * t * t + 4.0,
                    3.0 * s * s * s - 6.0 * s * s + 4.0,
                    t * t * t,
                ];
                (0..4).map(|j| at(i + j - 1) * weights[j as usize]).sum::<Vec3>() / 6.0
            })
            .collect();
        let count = points.len() as f32 - 1.0;
        curves.push(&points);
        let Radius { root, tip } = groom.radius;
        curves.radii.extend((0..points.len()).map(|i| unit * (root + (tip - root) * i as f32 / count)));
    }
    curves
}

/// Returns the head of the reference, each part in its color.
fn head(groom: &Description, folders: &Folders<'_>, options: &ImportOptions, unit: f32) -> Result<TriMesh> {
    let parts = groom.head_parts.iter().map(|part| {
        let (mut mesh, _) = import::read_head(&[folders.resolve(&part.file)], options)?;
        mesh.colors = vec![part.reflectance_rgb.into(); mesh.positions.len()];
        let mut to_world = Mat4::from_cols_array_2d(&part.to_world_row_major).transpose();
        to_world.w_axis = (to_world.w_axis.truncate() * unit).extend(1.0);
        mesh.transform_affine(Affine3A::from_mat4(to_world));
        anyhow::Ok(mesh)
    });
    Ok(TriMesh::merge(&parts.collect::<Result<Vec<_>>>()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_interpolate_the_strand_ends() {
        let mut strands = Strands::default();
        strands.push(&[Vec3::ZERO, Vec3::X, Vec3::new(2.0, 1.0, 0.0), Vec3::new(2.0, 2.0, 0.0)]);
        let groom: Description = serde_json::from_value(serde_json::json!({
            "scale_note": "1 unit = 1 m", "strand_file": "", "lights": {}, "head_parts": [],
            "radius": { "root": 2.0, "tip": 1.0 },
            "camera": { "origin": [0, 0, 0], "target": [0, 0, 1], "vertical_fov_degrees": 30, "resolution": [1, 1] },
        }))
        .unwrap();
        let curves = curves(&strands, &groom, 0.5);
        let line = curves.strand(0);
        assert_eq!(line.len(), 7);
        assert!(line[0].length() < 1e-6 && line[6].distance(strands.positions[3]) < 1e-6);
        // At a knot, the weights of a cubic B-spline are 1/6, 2/3 and 1/6.
        let knot = (strands.positions[0] + 4.0 * strands.positions[1] + strands.positions[2]) / 6.0;
        assert!(line[2].distance(knot) < 1e-6);
        assert_eq!((curves.radii[0], curves.radii[6]), (1.0, 0.5));
    }
}
