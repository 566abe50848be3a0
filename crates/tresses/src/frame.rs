//! The frame: the only place that writes the order of the stages.
//!
//! ```text
//! each groom   roots; per fixed step: volume ─► wind ─► simulate; then tessellate ─► interpolate ─► avoid
//! each view    light: shadow maps, light from all sides, shading ─► draw: bodies, hair ─► present
//! ```
//!
//! Any number of grooms and views go into one submission. What a groom is goes with [`Hair`], what a view has with
//! [`View`]: neither knows what else is recorded, as long as each is recorded once, but for grooms that
//! [meet](Hair::meet). The grooms of a view lie in the same shadow maps and the same grid of light, and each pass that
//! draws hair draws all of them, so that their order means nothing.

use crate::{
    Error, Hair, Pipelines, Pose, Result,
    body::Body,
    collide::ColliderPoses,
    draw::{Embed, Surroundings, record::Canvas},
    gpu::{Timings, kernel},
    light::{self, HairSet, Part, SceneShadow, Seen, Shaded, ShadingRate},
    simulate::SimulationParams,
    skinning::Skinning,
    space::{Map, Space},
    stage::Stage,
    view::{Picture, View},
    views::{DebugViews, Shown},
};
use std::sync::{Arc, LazyLock};

/// What the motion of a groom depends on besides the hair itself.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Time since the last frame, seconds.
    pub dt: f32,
    /// Where the head is now. Roots follow it rigidly.
    pub head: Pose,
    /// Where the colliders are now.
    pub colliders: &'a ColliderPoses,
    /// The physics. Gravity and wind have the axes of the world.
    pub simulation: &'a SimulationParams,
    /// Where in the world the space is in which `head`, `colliders` and [roots](crate::roots::Roots::pose) are given, and
    /// how it moves ([`crate::space`]).
    pub space: Space,
    /// The space in which hair is drawn, that of cameras, lights and bodies; `None` for `space`. All hair of one view is
    /// drawn in the same.
    pub drawn_in: Option<Space>,
}

impl Default for Frame<'_> {
    /// A head at rest at the world's origin, without obstacles but its own, with the usual physics; no time passes.
    fn default() -> Self {
        static COLLIDERS: ColliderPoses = ColliderPoses { head: None, colliders: Vec::new() };
        static PHYSICS: LazyLock<SimulationParams> = LazyLock::new(SimulationParams::default);
        Self {
            dt: 0.0,
            head: Pose::IDENTITY,
            colliders: &COLLIDERS,
            simulation: &PHYSICS,
            space: Space::WORLD,
            drawn_in: None,
        }
    }
}

impl Frame<'_> {
    /// The space in which it is drawn.
    pub(crate) fn seen(&self) -> Space {
        self.drawn_in.unwrap_or(self.space).normalized()
    }

    /// From the space of its poses to the one in which it is drawn.
    pub(crate) fn way_to_view(&self) -> Map {
        self.seen().from(&self.space.normalized())
    }
}

/// What is drawn into a view.
#[derive(Debug)]
pub struct Sight<'a> {
    /// The view.
    pub view: &'a View,
    /// Who looks, in which light.
    pub picture: &'a Picture,
    /// Where the finished picture goes; `None` for [`Targets::picture`](crate::draw::Targets::picture). It has the
    /// view's size and the format of its options.
    pub output: Option<&'a wgpu::TextureView>,
    /// What is shown.
    pub shows: Shows<'a>,
    /// Whether the targets are asked where hair is and which strand each pixel shows, of bodies and hair
    /// ([`Shows::Hair`]) or once more ([`Shows::Again`]): [`Targets::geometry`](crate::draw::Targets::geometry),
    /// [`Targets::labels`](crate::draw::Targets::labels). Only hair by [`Coverage::Tiles`](crate::draw::Coverage::Tiles)
    /// knows.
    pub asks: bool,
}

/// What a view shows.
#[derive(Debug, Default)]
pub enum Shows<'a> {
    /// Bodies and hair.
    #[default]
    Hair,
    /// The same as in the view's last picture, which is drawn but not lit anew: after
    /// [`View::resize`], a picture that stands still becomes finer. Hair, bodies and lights must be the same.
    Again,
    /// Hair over a scene that is drawn already, hidden by what is in front of it ([`crate::draw::embed`]). Bodies are
    /// not drawn, but their shadows fall on hair; background and tone play no part.
    Over(&'a Embed, Surroundings<'a>),
    /// What is asked for instead of hair as it looks ([`crate::views`]). Nothing is read back.
    Inside(&'a mut DebugViews, &'a Shown),
}

impl<'a> Sight<'a> {
    /// Bodies and hair into the view's own picture.
    pub fn new(view: &'a View, picture: &'a Picture) -> Self {
        Self { view, picture, output: None, shows: Shows::Hair, asks: false }
    }
}

/// What a frame is recorded with.
#[derive(Debug)]
pub struct Recorder<'a> {
    /// The pipelines.
    pub pipelines: &'a Pipelines,
    /// The device of the pipelines and of everything that is recorded.
    pub device: &'a wgpu::Device,
    /// Its queue.
    pub queue: &'a wgpu::Queue,
    /// Takes the commands. After an error they are not to be submitted.
    pub encoder: &'a mut wgpu::CommandEncoder,
    /// Takes the stages' times, where the device has timestamps. [By a clock](Timings::by), each part is
    /// submitted and waited for.
    pub timings: Option<&'a mut Timings>,
}

impl Recorder<'_> {
    /// A whole frame: each groom moves, then each view is drawn.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] when a parameter of the physics is out of its range,
    /// [`crate::Error::Colliders`] when there are not as many poses as colliders, [`crate::Error::Limit`] when the
    /// device cannot hold what a view needs, [`crate::Error::Groom`] when the hair of a view is drawn in several spaces,
    /// [`crate::Error::Gpu`] when a pipeline cannot be compiled.
    pub fn record(
        &mut self,
        hair: &mut [(&mut Hair, Frame<'_>)],
        bodies: &[&Body],
        views: Vec<Sight<'_>>,
    ) -> Result<()> {
        for (hair, frame) in &mut *hair {
            self.advance(hair, frame)?;
        }
        let hair: Vec<&Hair> = hair.iter().map(|(hair, _)| &**hair).collect();
        views.into_iter().try_for_each(|sight| self.draw(&hair, bodies, sight))
    }

    /// Bends bodies: into the poses that they were [given](crate::skinning::Skinning::pose), before the hair on them
    /// moves.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the pipeline cannot be compiled.
    pub fn bend(&mut self, bodies: &[&Skinning]) -> Result<()> {
        let pipelines = self.pipelines;
        self.stage(Stage::Skinning, |pass| {
            bodies.iter().for_each(|body| body.record(&pipelines.skinning, pass))
        });
        kernel::refused()
    }

    /// Moves the hair by a frame.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn advance(&mut self, hair: &mut Hair, frame: &Frame<'_>) -> Result<()> {
        self.simulate(hair, frame)?;
        self.follow(hair, frame)
    }

    /// Only the guides: they move by as many fixed steps as have become due.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn simulate(&mut self, hair: &mut Hair, frame: &Frame<'_>) -> Result<()> {
        let (pipelines, device) = (self.pipelines, self.device);
        hair.make_room(device, self.queue, pipelines)?;
        let steps = hair.begin(device, self.queue, pipelines, frame)?;
        if hair.is_shifted() {
            self.stage(Stage::Simulate, |pass| hair.record_shift(pass, &pipelines.simulate));
        }
        if hair.is_on_skin() && hair.is_seen() {
            self.stage(Stage::Roots, |pass| hair.record_roots(pass, pipelines));
        }
        for step in 0..steps {
            if hair.uses_volume() {
                self.start();
                hair.volume.clear(self.encoder);
                self.stage(Stage::Volume, |pass| hair.record_volume(pass, &pipelines.volume, step));
            }
            if hair.uses_wind() {
                self.stage(Stage::Wind, |pass| hair.record_wind(pass, &pipelines.wind, step));
            }
            self.stage(Stage::Simulate, |pass| hair.record_simulate(pass, &pipelines.simulate, step));
        }
        kernel::refused()
    }

    /// Only the drawn strands: they follow the guides, which do not move.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn follow(&mut self, hair: &mut Hair, frame: &Frame<'_>) -> Result<()> {
        let pipelines = self.pipelines;
        hair.make_room(self.device, self.queue, pipelines)?;
        if hair.is_drawn() {
            return Ok(());
        }
        hair.prepare(self.queue, frame);
        self.stage(Stage::Tessellate, |pass| hair.record_tessellate(pass, &pipelines.tessellate));
        self.stage(Stage::Interpolate, |pass| {
            hair.record_interpolate(pass, &pipelines.interpolate, &pipelines.widths)
        });
        self.stage(Stage::Avoid, |pass| hair.record_avoid(pass, &pipelines.avoid));
        kernel::refused()
    }

    /// Draws hair and bodies as they are now into a view.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn draw(&mut self, hair: &[&Hair], bodies: &[&Body], sight: Sight<'_>) -> Result<()> {
        let seen = |hair: &Hair| hair.drawn_in;
        if hair.windows(2).any(|pair| !seen(pair[0]).is_where(&seen(pair[1]))) {
            let why =
                "the hair of one view must be drawn in one space: give all of it the same Frame::drawn_in";
            return Err(Error::unusable(why));
        }
        let sets: Vec<_> = hair.iter().map(|hair| &hair.set).collect();
        self.picture(&sets, hair, bodies, sight)
    }

    /// [`draw`](Self::draw) for strands that nothing moves. Of [`Shows::Inside`], what is not in the strands
    /// themselves is not seen.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn draw_strands(&mut self, strands: &[&HairSet], bodies: &[&Body], sight: Sight<'_>) -> Result<()> {
        self.picture(strands, &[], bodies, sight)
    }

    /// Only the light of a picture, for those who ask it: the shadow maps, with those of a `scene`, and light from all
    /// sides.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn light(
        &mut self,
        strands: &[&HairSet],
        bodies: &[&Body],
        view: &View,
        picture: &Picture,
        scene: &[SceneShadow<'_>],
    ) -> Result<()> {
        let parts = view.parts(picture.focus, [strands.len(), bodies.len()], true);
        let shares = self.shares(view, strands, &parts, picture.shading)?;
        let seen = seen(strands, &shares, &parts);
        bodies.iter().for_each(|body| body.prepare(self.queue));
        let lit = view.prepare(self.queue, picture, &seen, &parts);
        view.made(&parts);
        self.cast(&parts, &lit, &seen, bodies, (&picture.lights, scene))
    }

    /// The order of the stages that make a picture.
    fn picture(
        &mut self,
        sets: &[&HairSet],
        hair: &[&Hair],
        bodies: &[&Body],
        sight: Sight<'_>,
    ) -> Result<()> {
        let Sight { view, picture, output, mut shows, asks } = sight;
        let again = matches!(shows, Shows::Again | Shows::Over(_, Surroundings { lit: true, .. }));
        let over = match &shows {
            Shows::Over(embed, into) => Some((*embed, *into)),
            _ => None,
        };
        let inside = match &mut shows {
            Shows::Inside(views, shown) => Some((&mut **views, *shown)),
            _ => None,
        };
        let picture = &inside.as_ref().map_or(*picture, |(_, shown)| shown.picture(picture));
        let parts = view.parts(picture.focus, [sets.len(), bodies.len()], inside.is_none());
        let shares = self.shares(view, sets, &parts, picture.shading)?;
        let seen = seen(sets, &shares, &parts);
        // A view may leave hair out, which would hide what is to be seen.
        let hides = inside.as_ref().is_some_and(|(_, shown)| shown.view.hides_hair());
        let visible = if hides { &[][..] } else { &seen[..] };

        self.start();
        bodies.iter().for_each(|body| body.prepare(self.queue));
        let lit = view.prepare(self.queue, picture, &seen, &parts);
        if !again {
            view.made(&parts);
            let shadows = over.map_or(&[][..], |(_, into)| into.shadows);
            self.cast(&parts, &lit, visible, bodies, (&picture.lights, shadows))?;
        }
        let output = output.unwrap_or_else(|| view.targets().picture());
        let draw = &self.pipelines.draw;
        let canvas = &mut Canvas {
            device: self.device,
            queue: self.queue,
            encoder: self.encoder,
            timings: self.timings.as_deref_mut(),
            targets: view.targets(),
            frame: &view.light.frame,
            eye: view.eye(),
            light: (&self.pipelines.light, &view.light),
            parts: &parts,
            camera: &picture.camera,
            lights: &picture.lights,
            focus: &picture.focus,
            coverage: view.options().coverage,
            rate: picture.shading,
            geometry: Embed::known(view.options().coverage, asks)?,
            labels: asks,
            space: hair.first().map(|hair| hair.drawn_in).unwrap_or_default(),
        };
        if let Some((_, into)) = over {
            canvas.geometry = Embed::asked(canvas.coverage, picture.camera.projection, &into)?;
        }
        let body_first = draw.body_first(canvas.coverage);
        if let Some((embed, into)) = over {
            embed.record_depth(canvas, picture.camera.projection, &into);
        } else if body_first {
            draw.record_bodies(canvas, bodies)?;
            canvas.lap("body");
        }
        draw.record_seen(canvas, visible)?;
        let replaced = match &mut shows {
            Shows::Inside(views, shown) => {
                views.shade(self.device, canvas.encoder, shown, picture, hair, &seen)
            }
            // What was seen of the last picture is shaded; a finer one of tiles sees other vertices.
            Shows::Again => !canvas.coverage.is_tiled(),
            _ => false,
        };
        // Views of the inside look at all of it.
        let of_seen = !replaced && !matches!(shows, Shows::Inside(..)) && draw.shade_seen(canvas, visible)?;
        if !replaced && !of_seen {
            let timings = canvas.timings.as_deref_mut();
            view.light.shade(&self.pipelines.light, canvas.encoder, timings, &seen, picture.shading);
        }
        canvas.lap("shade");
        draw.record_hair(canvas, visible, over.is_none())?;
        canvas.lap("hair");
        if let Some((embed, into)) = over {
            embed.record_shade(canvas, &self.pipelines.light, &into)?;
            embed.record(canvas, &into);
            canvas.lap("embed");
            return kernel::refused();
        }
        if !body_first {
            draw.record_bodies(canvas, bodies)?;
            canvas.lap("body");
        }
        let timings = self.timings.as_deref_mut();
        let present = &self.pipelines.present;
        view.present().record(present, self.encoder, timings, view.targets(), output)?;
        self.lap("present");
        if let Shows::Inside(views, shown) = shows {
            let timings = self.timings.as_deref_mut();
            views.over(
                self.device,
                self.encoder,
                timings,
                shown,
                picture,
                view,
                hair,
                &seen,
                bodies,
                output,
            )?;
            self.lap("debug");
        }
        kernel::refused()
    }

    /// Shadow maps, with those of a scene in the light of a picture, then light from all sides.
    fn cast(
        &mut self,
        parts: &[Part<'_>],
        lit: &[crate::light::Lit],
        hair: &[Seen<'_>],
        bodies: &[&Body],
        (lights, scene): (&light::Lights, &[SceneShadow<'_>]),
    ) -> Result<()> {
        let pipelines = &self.pipelines.light;
        for (part, lit) in parts.iter().zip(lit) {
            let (hair, bodies) = (Part::of(&part.hair, hair), Part::of(&part.bodies, bodies));
            let scene = part.light.bring(pipelines, lights, lit, scene)?;
            let timings = self.timings.as_deref_mut();
            part.light.record_shadows(pipelines, self.encoder, timings, lit, &hair, (&bodies, &scene))?;
        }
        self.lap("shadow");
        if lit.iter().any(|lit| lit.ambient) {
            for (part, lit) in parts.iter().zip(lit).filter(|(_, lit)| lit.ambient) {
                let (hair, bodies) = (Part::of(&part.hair, hair), Part::of(&part.bodies, bodies));
                let timings = self.timings.as_deref_mut();
                part.light.record_ambient(pipelines, self.encoder, timings, &hair, (&bodies, lit.every));
            }
            self.lap("ambient");
        }
        kernel::refused()
    }

    /// What `view` has of each of `sets`, in the light of its part.
    fn shares(
        &self,
        view: &View,
        sets: &[&HairSet],
        parts: &[Part<'_>],
        rate: ShadingRate,
    ) -> Result<Vec<Arc<Shaded>>> {
        let lights: Vec<_> = (0..sets.len()).map(|i| light_of(i, parts).0).collect();
        view.shares(self.device, self.pipelines, sets, &lights, rate)
    }

    /// A compute pass under the name of a stage.
    fn stage(&mut self, stage: Stage, record: impl FnOnce(&mut crate::gpu::ComputePass<'_>)) {
        self.start();
        let mut pass = crate::gpu::compute_pass(
            self.encoder,
            &wgpu::ComputePassDescriptor {
                label: Some(stage.name()),
                timestamp_writes: self
                    .timings
                    .as_deref_mut()
                    .and_then(|timings| timings.compute(stage.name())),
            },
        );
        record(&mut pass);
        drop(pass);
        self.lap(stage.name());
    }

    fn start(&mut self) {
        if let Some(timings) = &mut self.timings {
            timings.start();
        }
    }

    /// A part of the frame ends: whoever measures by the clock waits for it.
    fn lap(&mut self, name: &'static str) {
        if let Some(timings) = &mut self.timings {
            timings.lap(self.device, self.queue, self.encoder, name);
        }
    }
}

/// The light of groom `i`, and whether it is a zone's: each is in one part.
fn light_of<'a>(i: usize, parts: &[Part<'a>]) -> (&'a light::State, bool) {
    let part = parts.iter().find(|part| part.hair.contains(&i)).unwrap_or(&parts[0]);
    (part.light, part.number > 0)
}

/// Each of `sets` as a view sees it.
fn seen<'a>(sets: &[&'a HairSet], shares: &'a [Arc<Shaded>], parts: &[Part<'a>]) -> Vec<Seen<'a>> {
    let seen = |(i, (hair, shaded)): (usize, (&&'a HairSet, &'a Arc<Shaded>))| {
        let (light, zoned) = light_of(i, parts);
        Seen { hair, shaded, light, zoned }
    };
    sets.iter().zip(shares).enumerate().map(seen).collect()
}
