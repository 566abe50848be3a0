//! A character on the GPU, ready to be moved and drawn: the only file that talks to the frame.

use crate::{
    args::{Color, Size, Source},
    avoid_args::Avoid,
    camera::{self, Bounds, Camera},
    colliders::Colliders,
    debug::{self, Debug},
    edge_args::EdgeArgs,
    load::{self, Character},
    picture::Picture,
    shading_args::material,
};
use anyhow::{Context, Result, ensure};
use std::time::Instant;
use tresses::{
    Hair, HairOptions, HairRenderer, Pose,
    collide::{ColliderDescriptor, FieldBuilder},
    draw::{self, Body, DrawOptions, Targets, View},
    frame::{Frame, Recorder},
    glam::Vec3,
    gpu::{Gpu, Timings},
    groom::{SdfGrid, TriMesh},
    light::{Directional, Lights, ShadingRate, Shadows, Sphere},
    lod::{Detail, LodMode, LodOptions},
    simulate::SimulationParams,
};

/// The size of a picture and how finely it is sampled.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    /// Pixels.
    pub size: Size,
    /// Samples and the rest of antialiasing.
    pub edges: EdgeArgs,
    /// Whether fewer samples will do where the adapter offers no more.
    pub at_most: bool,
    /// Texels along each edge of a shadow map.
    pub shadow_resolution: u32,
}

impl Quality {
    /// Exactly as many samples as asked for.
    pub fn new(size: Size, edges: EdgeArgs) -> Self {
        let shadow_resolution = DrawOptions::default().shadow_resolution;
        Self { size, edges, at_most: false, shadow_resolution }
    }
}

/// Sizes of what is drawn.
#[derive(Clone, Copy, Debug, Default)]
pub struct Facts {
    /// Simulated strands.
    pub guides: u32,
    /// Drawn strands.
    pub strands: u32,
    /// Vertices of each drawn strand.
    pub vertices_per_strand: u32,
    /// Triangles of the hair.
    pub triangles: u64,
    /// GPU memory of the groom, bytes.
    pub bytes: u64,
}

/// A character on the GPU.
pub struct Scene {
    gpu: Gpu,
    renderer: HairRenderer,
    hair: Hair,
    body: Option<Body>,
    targets: Targets,
    /// From timestamps where there are some that mean something, else by the clock.
    timings: Timings,
    scene: draw::Scene,
    /// Lights that stay where they are, instead of the photographer's.
    lights: Option<Lights>,
    physics: SimulationParams,
    colliders: Colliders,
    /// Seconds since the hair was put to rest.
    time: f64,
    head: Option<TriMesh>,
    subject: Bounds,
    neck: Vec3,
    field: Option<SdfGrid>,
    debug: Option<Debug>,
    more_lights: [Directional; 2],
    /// Who looks, for whom the level of detail is chosen.
    watcher: Option<Camera>,
}

impl Scene {
    /// Opens the GPU, reads or grows the character and brings it there.
    pub fn open(source: &Source, quality: Quality) -> Result<Self> {
        ensure!(
            source.color.is_none() || source.shape.color_map.is_none(),
            "--color gives all hair one colour and --color-map many; give one of them"
        );
        let gpu = pollster::block_on(Gpu::open())?;
        let device = &gpu.device;
        let most = gpu.tier.max_samples;
        let (samples, coverage) = quality.edges.choose(most)?;
        ensure!(
            samples <= most || quality.at_most,
            "--samples is {samples}, but {} offers at most {most} per pixel",
            gpu.info.name
        );
        let samples = samples.min(most);
        let shadow_resolution = quality.shadow_resolution;
        let options = DrawOptions { samples, coverage, shadow_resolution, ..Default::default() };
        let renderer = HairRenderer::new(device, &options);
        let character = load::load(source, &gpu, &renderer.simulate)?;
        for note in &character.notes {
            eprintln!("note: {note}");
        }
        let colliders = match &source.colliders {
            Some(path) => Colliders::read(path)?,
            None => Colliders::default(),
        };
        let mut scene = Self::new(character, colliders, source.color.as_ref(), gpu, renderer, quality)?;
        source.shape.apply_to_material(&mut scene.scene.hair);
        Ok(scene)
    }

    fn new(
        character: Character,
        colliders: Colliders,
        color: Option<&Color>,
        gpu: Gpu,
        renderer: HairRenderer,
        quality: Quality,
    ) -> Result<Self> {
        let hair_bounds = character.groom.bounds().context("the groom is empty")?;
        let head_bounds = character.head.as_ref().and_then(|head| head.bounds());
        let (device, queue) = (&gpu.device, &gpu.queue);
        let options = HairOptions::default();
        let builder = (!colliders.list.is_empty()).then(|| FieldBuilder::new(device));
        let fields = builder.as_ref().map(|builder| colliders.fields(builder)).unwrap_or_default();
        let (head, list) = (character.field.as_ref(), colliders.list.as_slice());
        let what = ColliderDescriptor { head, fields: &fields, colliders: list };
        let mut hair = Hair::with_colliders(device, queue, &renderer, &character.groom, &options, &what)?;
        // Full detail, unless somebody asks for less.
        hair.lod.options.mode = LodMode::Off;
        if !character.levels.is_empty() {
            hair.paint_levels(queue, &character.groom, &character.levels, character.skull())?;
        }
        let body = character.head.as_ref().map(|head| Body::new(device, &renderer.draw, head));
        let Size { width, height } = quality.size;
        let targets = renderer.draw.targets(device, width, height, quality.edges.ssaa)?;
        let timings = match gpu.tier.timestamps && !gpu.tier.software {
            true => Timings::new(device, queue),
            false => Timings::by_the_clock(),
        };
        let subject = camera::subject(hair_bounds, head_bounds);
        let mut focus = Sphere::around(subject.0, subject.1);
        // Hair that swings must not leave the shadow maps.
        focus.radius *= 1.15;
        let scene = draw::Scene { focus, hair: material(color), ..Default::default() };
        Ok(Self {
            renderer,
            hair,
            body,
            targets,
            timings,
            scene,
            lights: None,
            physics: options.simulation,
            colliders,
            time: 0.0,
            head: character.head,
            subject,
            neck: character.neck,
            field: character.field.clone(),
            debug: None,
            more_lights: [Directional::OFF; 2],
            watcher: None,
            gpu,
        })
    }

    /// From here on pictures show what `args` ask for.
    pub fn show(&mut self, args: &debug::DebugArgs) {
        self.debug = Debug::new(&self.gpu, &self.renderer.draw, args, self.field.as_ref());
    }

    /// The physics from here on.
    pub fn physics_mut(&mut self) -> &mut SimulationParams {
        &mut self.physics
    }

    /// Camera-independent looks of the next pictures; the lights go with the camera.
    pub fn look_mut(&mut self) -> &mut draw::Scene {
        &mut self.scene
    }

    /// Lights besides the two that go with the camera, from here on; these stay where they are.
    pub fn add_lights(&mut self, lights: [Directional; 2]) {
        self.more_lights = lights;
    }

    /// Lights that stay where they are; `None` for a photographer's, which go with the camera.
    pub fn set_lights(&mut self, lights: Option<Lights>) {
        self.lights = lights;
    }

    /// How much of the hair is drawn from here on.
    pub fn set_lod(&mut self, options: LodOptions) -> Result<()> {
        options.check()?;
        self.hair.lod.options = options;
        Ok(())
    }

    /// The level of detail of the last frame.
    pub fn detail(&self) -> &Detail {
        self.hair.lod.current()
    }

    /// From here on `camera` looks: frames are made for it.
    pub fn watch(&mut self, camera: &Camera) {
        self.watcher = Some(*camera);
    }

    /// What a portrait must show, metres.
    pub fn subject(&self) -> Bounds {
        self.subject
    }

    /// The joint that the head turns about, metres.
    pub fn pivot(&self) -> Vec3 {
        self.neck
    }

    /// Samples per pixel.
    pub fn samples(&self) -> u32 {
        self.targets.samples
    }

    /// On what the pictures are made.
    pub fn adapter_name(&self) -> &str {
        &self.gpu.info.name
    }

    /// Sizes of what is drawn.
    pub fn facts(&self) -> Facts {
        Facts {
            guides: self.hair.guides.count,
            strands: self.hair.strands.count,
            vertices_per_strand: self.hair.strands.vertex_count,
            triangles: self.hair.set.triangles(),
            bytes: self.hair.bytes(),
        }
    }

    /// Pictures of another size from here on.
    pub fn resize(&mut self, size: Size) -> Result<()> {
        let ssaa = self.targets.ssaa;
        self.targets = self.renderer.draw.targets(&self.gpu.device, size.width, size.height, ssaa)?;
        Ok(())
    }

    /// What drawn strands do where they would enter the head, from here on.
    pub fn set_avoid(&mut self, avoid: Avoid) {
        self.hair.avoidance.options.mode = avoid.into();
    }

    /// How shadows are made, from here on. Where they are looked up for every pixel, hair is shaded so.
    pub fn set_shadows(&mut self, shadows: Shadows) {
        self.scene.shadows = shadows;
        if shadows.per_pixel {
            self.scene.shading = ShadingRate::PerPixel;
        }
    }

    /// The hair at rest on a head at `pose`.
    pub fn reset(&mut self, pose: &Pose) -> Result<()> {
        self.hair.reset();
        self.time = 0.0;
        self.advance(pose, 0.0)
    }

    /// The head moves to `pose` in `seconds`, and the hair with it.
    pub fn advance(&mut self, pose: &Pose, seconds: f32) -> Result<()> {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, None, pose, seconds)?;
        self.submit(encoder)
    }

    /// The picture as it is now. Blocks.
    pub fn picture(&mut self, camera: &Camera) -> Result<Picture> {
        self.place_colliders();
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.record_draw(&mut encoder, None, camera)?;
        self.gpu.queue.submit([encoder.finish()]);
        let rgba = self.targets.read(&self.gpu.device, &self.gpu.queue)?;
        let [width, height] = self.targets.size;
        let mut picture = Picture { width, height, rgba };
        if let Some(debug) = &self.debug {
            debug.label(&mut picture);
        }
        Ok(picture)
    }

    /// How many pixels of the picture the hair covers, whatever is before it. Blocks.
    pub fn hair_pixels(&mut self, camera: &Camera) -> Result<f64> {
        let body = self.body.take();
        let background = std::mem::replace(&mut self.scene.background, draw::Background::transparent());
        let picture = self.picture(camera);
        (self.body, self.scene.background) = (body, background);
        Ok(picture?.rgba.as_chunks::<4>().0.iter().map(|[.., alpha]| f64::from(*alpha) / 255.0).sum())
    }

    /// Makes the body anew with the colliders where they are drawn.
    fn place_colliders(&mut self) {
        if self.colliders.list.is_empty() {
            return;
        }
        let to_head = self.scene.pose.inverse();
        let drawn = self.hair.colliders.drawn();
        // The first is the head's field, where there is one.
        let own = &drawn[drawn.len() - self.colliders.list.len()..];
        let poses: Vec<_> = own.iter().map(|pose| to_head.after(pose)).collect();
        let mesh = self.colliders.with_body(self.head.as_ref(), &poses);
        self.body = Some(Body::new(&self.gpu.device, &self.renderer.draw, &mesh));
    }

    /// A whole frame, waited for: its milliseconds from recording to completion, and those of its
    /// stages where the adapter can tell.
    pub fn measured_frame(
        &mut self,
        pose: &Pose,
        seconds: f32,
        camera: &Camera,
    ) -> Result<(f64, Vec<(&'static str, f64)>)> {
        self.watch(camera);
        if self.gpu.tier.software {
            let start = Instant::now();
            let stages = self.stage_by_stage(pose, seconds, camera)?;
            return Ok((start.elapsed().as_secs_f64() * 1e3, stages));
        }
        let start = Instant::now();
        let mut timings = std::mem::replace(&mut self.timings, Timings::by_the_clock());
        let mut timed = self.gpu.tier.timestamps.then_some(&mut timings);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, timed.as_deref_mut(), pose, seconds)?;
        self.record_draw(&mut encoder, timed, camera)?;
        timings.resolve(&mut encoder);
        self.submit(encoder)?;
        let wall = start.elapsed().as_secs_f64() * 1e3;
        self.timings = timings;
        Ok((wall, self.timings.read(&self.gpu.device, &self.gpu.queue)?))
    }

    /// The milliseconds of the stages that move the hair by a frame: by timestamps, or each stage
    /// submitted and waited for alone where there are none that compare.
    pub fn measured_advance(&mut self, pose: &Pose, seconds: f32) -> Result<Vec<(&'static str, f64)>> {
        let mut timings = std::mem::replace(&mut self.timings, Timings::by_the_clock());
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.record_advance(&mut encoder, Some(&mut timings), pose, seconds)?;
        timings.resolve(&mut encoder);
        self.submit(encoder)?;
        self.timings = timings;
        Ok(self.timings.read(&self.gpu.device, &self.gpu.queue)?)
    }

    /// The stages of a frame, each submitted and waited for alone, and its milliseconds by the clock.
    ///
    /// Mesa's software driver writes the timestamps of drawing when pixels are filled, those of
    /// compute when it is called, so that differences between them mean nothing.
    fn stage_by_stage(
        &mut self,
        pose: &Pose,
        seconds: f32,
        camera: &Camera,
    ) -> Result<Vec<(&'static str, f64)>> {
        self.scene.pose = *pose;
        self.time += f64::from(seconds);
        self.look_from(camera);
        let mut rows = self.measured_advance(pose, seconds)?;
        let Self { gpu: Gpu { device, queue, .. }, renderer, hair, body, targets, scene, .. } = self;
        let body = body.as_ref();
        let mut stage = |name, record: &mut dyn FnMut(&mut wgpu::CommandEncoder) -> Result<()>| {
            let start = Instant::now();
            let mut encoder = device.create_command_encoder(&Default::default());
            record(&mut encoder)?;
            queue.submit([encoder.finish()]);
            device.poll(wgpu::PollType::wait_indefinitely()).context("the GPU was lost")?;
            rows.push((name, start.elapsed().as_secs_f64() * 1e3));
            anyhow::Ok(())
        };
        let drawing = &renderer.draw;
        let set = Some(&hair.set);
        stage("shadow", &mut |encoder| {
            drawing.prepare(queue, scene, targets, set, body);
            drawing.shadow(encoder, None, scene, set, body);
            Ok(())
        })?;
        stage("shade", &mut |encoder| {
            drawing.shade(encoder, None, &hair.set);
            Ok(())
        })?;
        for is_body in [drawing.body_first(), !drawing.body_first()] {
            stage(if is_body { "draw body" } else { "draw hair" }, &mut |encoder| {
                if is_body {
                    drawing.draw_body(encoder, None, targets, body);
                } else {
                    drawing.draw_hair(encoder, None, scene, targets, set);
                }
                Ok(())
            })?;
        }
        stage("present", &mut |encoder| {
            drawing.present(device, encoder, None, targets, targets.picture());
            Ok(())
        })?;
        Ok(rows)
    }

    /// Camera and lights: these go with it, as a photographer's do, unless there are others.
    fn look_from(&mut self, camera: &Camera) {
        self.scene.view = View::look_at(camera.eye, camera.target, camera::VERTICAL_FOV, self.targets.size);
        let back = camera.eye - camera.target;
        self.scene.lights = self.lights.unwrap_or_else(|| Lights::around(back.x.atan2(back.z)));
        for (place, light) in self.scene.lights.directional[2..].iter_mut().zip(self.more_lights) {
            // The surroundings may have lit it already.
            if light.irradiance != Vec3::ZERO {
                *place = light;
            }
        }
    }

    fn record_advance(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        pose: &Pose,
        seconds: f32,
    ) -> Result<()> {
        self.scene.pose = *pose;
        self.time += f64::from(seconds);
        if let Some(camera) = &self.watcher {
            let view = View::look_at(camera.eye, camera.target, camera::VERTICAL_FOV, self.targets.size);
            self.hair.look_from(&self.gpu.device, &self.gpu.queue, &view, pose);
        }
        let poses = self.colliders.poses(self.time);
        let frame = Frame { dt: seconds, head: *pose, colliders: &poses, simulation: &self.physics };
        let Gpu { device, queue, .. } = &self.gpu;
        let mut recorder = Recorder { renderer: &self.renderer, device, queue, encoder, timings };
        Ok(recorder.advance(&mut self.hair, &frame)?)
    }

    fn record_draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        timings: Option<&mut Timings>,
        camera: &Camera,
    ) -> Result<()> {
        self.look_from(camera);
        if let Some(debug) = &mut self.debug {
            debug.prepare(&self.gpu, &self.scene, &self.hair, self.physics.wind.velocity)?;
        }
        let Gpu { device, queue, .. } = &self.gpu;
        let mut recorder = Recorder { renderer: &self.renderer, device, queue, encoder, timings };
        let (body, targets) = (self.body.as_ref(), &self.targets);
        let (hair, scene, output) = (&self.hair, &self.scene, targets.picture());
        match &mut self.debug {
            Some(Debug { shown, views, .. }) => {
                recorder.draw_view(views, shown, hair, body, scene, targets, output)?;
            }
            None => recorder.draw(hair, body, scene, targets, output),
        }
        Ok(())
    }

    fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<()> {
        self.gpu.queue.submit([encoder.finish()]);
        self.gpu.device.poll(wgpu::PollType::wait_indefinitely()).context("the GPU was lost")?;
        Ok(())
    }
}
