//! Records frames: the only module that defines the order of the stages.
//!
//! ```text
//! each groom   roots; per fixed step: volume ─► wind ─► simulate; then tessellate ─► interpolate ─► avoid
//! each view    light: shadow maps, ambient light, shading ─► draw: bodies, hair ─► present
//! ```
//!
//! One submission takes any number of grooms and views. A [`Hair`] holds the state of a groom, a [`View`] the state of
//! a camera. They are independent of each other as long as each is recorded once per submission, except for grooms that
//! [meet](Hair::meet). The grooms of a view share its shadow maps and its grid of ambient light. Each pass that draws
//! hair draws all of them, so their order does not matter.

use crate::{
    Context, Error, Result,
    body::Body,
    constants::LIGHT_GROUP,
    draw::{Compositor, HostFrame, canvas::Canvas},
    gpu::{Commands, Timings},
    hair::{Hair, HairFrame},
    light::{self, Casters, HairSet, HairShading, HairView, Part, SceneShadow},
    renderer::ShadingRate,
    skinning::Skinning,
    stage::Stage,
    view::{Picture, View},
    views::{DebugDisplay, DebugViews},
};
use std::sync::Arc;

/// How hair and bodies are drawn into a view.
#[derive(Debug)]
pub struct Drawing<'a> {
    /// Camera, lights, background, tone mapping. [`Frame`](crate::character::Frame) derives the focus from its
    /// characters.
    pub picture: &'a Picture,
    /// Target of the finished image, with the view's size and the format of its options; `None` for
    /// [`Targets::picture`](crate::draw::Targets::picture).
    pub output: Option<&'a wgpu::TextureView>,
    /// Content of the image.
    pub shows: ViewContent<'a>,
    /// Whether to write hair geometry and strand labels as well: [`Targets::geometry`](crate::draw::Targets::geometry),
    /// [`Targets::labels`](crate::draw::Targets::labels). Applies to [`ViewContent::Hair`] and [`ViewContent::Again`],
    /// and requires [`Renderer::Tiles`](crate::renderer::Renderer::Tiles).
    pub writes_labels: bool,
    /// Whether the hair is drawn alone, without bodies and their shadows.
    pub hides_bodies: bool,
}

impl<'a> Drawing<'a> {
    /// Draws bodies and hair into the view's own target.
    pub fn new(picture: &'a Picture) -> Self {
        Self { picture, output: None, shows: ViewContent::Hair, writes_labels: false, hides_bodies: false }
    }
}

/// Content of a view's image.
#[derive(Debug, Default)]
#[non_exhaustive]
pub enum ViewContent<'a> {
    /// Bodies and hair.
    #[default]
    Hair,
    /// Bodies and hair again, with the lighting of the view's last image. Refines a still image after [`View::resize`].
    /// Hair, bodies and lights must be unchanged.
    Again,
    /// Hair composited into a scene that is already drawn and hides hair behind it. Bodies are
    /// not drawn, but cast shadows on hair. Background and tone mapping are not used.
    Over(&'a Compositor, HostFrame<'a>),
    /// A debug view (feature `debug-views`). Nothing is read back.
    Inside(&'a mut DebugViews, &'a DebugDisplay),
}

impl ViewContent<'_> {
    /// Whether the lighting is already recorded.
    pub(crate) fn is_lit(&self) -> bool {
        matches!(self, Self::Again | Self::Over(_, HostFrame { is_lit: true, .. }))
    }

    /// Returns the shadow maps of the host's scene.
    fn shadows(&self) -> &[SceneShadow<'_>] {
        match self {
            Self::Over(_, into) => into.shadows,
            _ => &[],
        }
    }
}

/// Records a frame.
#[derive(Debug)]
pub struct Recorder<'a> {
    commands: Commands<'a>,
}

impl Context {
    /// Starts recording a frame into `encoder`. After an error the encoder must not be submitted.
    pub fn recorder<'a>(&self, encoder: &'a mut wgpu::CommandEncoder) -> Recorder<'a> {
        Recorder { commands: self.commands(encoder) }
    }
}

impl<'a> Recorder<'a> {
    /// Measures the stages with `timings`. With a [host clock](Timings::by), each part is submitted and waited for
    /// separately.
    pub fn with_timings(self, timings: impl Into<Option<&'a mut Timings>>) -> Self {
        Self { commands: self.commands.with_timings(timings) }
    }

    /// Returns the context.
    pub fn context(&self) -> &Context {
        self.commands.context()
    }

    /// Returns the encoder, so that the caller can add commands between those of the frame.
    pub fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        self.commands.encoder()
    }
}

impl Recorder<'_> {
    /// Records a whole frame: advances each groom, then draws each view.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] when a parameter of the physics is out of range, [`crate::Error::Colliders`] when
    /// the number of poses differs from the number of colliders, [`crate::Error::Limit`] when the device cannot hold
    /// the buffers of a view, [`crate::Error::Groom`] when the hair of a view is drawn in several spaces,
    /// [`crate::Error::Gpu`] when a pipeline cannot be compiled.
    pub fn record(
        &mut self,
        hair: &mut [(&mut Hair, HairFrame<'_>)],
        bodies: &[&Body],
        views: Vec<(&View, Drawing<'_>)>,
    ) -> Result<()> {
        self.merged(|recorder| {
            for (hair, frame) in &mut *hair {
                recorder.advance(hair, frame)?;
            }
            let hair: Vec<&Hair> = hair.iter().map(|(hair, _)| &**hair).collect();
            views.into_iter().try_for_each(|(view, drawing)| recorder.draw(&hair, bodies, view, drawing))
        })
    }

    /// Records `work` with as few compute passes as possible. The encoder is locked until it ends.
    pub(crate) fn merged(&mut self, work: impl FnOnce(&mut Self) -> Result<()>) -> Result<()> {
        let outer = self.commands.set_merging(true);
        let result = work(self);
        self.commands.set_merging(outer);
        result
    }

    /// Skins bodies into the poses set by [`Skinning::pose`](crate::skinning::Skinning::pose). Call it before the hair
    /// on them advances.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the pipeline cannot be compiled.
    pub(crate) fn bend(&mut self, bodies: &[&Skinning]) -> Result<()> {
        self.stage(Stage::Skinning, |pass| bodies.iter().for_each(|body| body.record(pass)))
    }

    /// Advances the hair by one frame.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn advance(&mut self, hair: &mut Hair, frame: &HairFrame<'_>) -> Result<()> {
        self.merged(|recorder| {
            recorder.simulate(hair, frame)?;
            recorder.follow(hair, frame)
        })
    }

    /// Advances only the guides, by the fixed steps that are due.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn simulate(&mut self, hair: &mut Hair, frame: &HairFrame<'_>) -> Result<()> {
        hair.resize_buffers()?;
        let steps = hair.begin(frame)?;
        if hair.is_shifted() {
            self.stage(Stage::Simulate, |pass| hair.record_shift(pass))?;
        }
        if hair.is_on_skin() && hair.is_visible() {
            self.stage(Stage::Roots, |pass| hair.record_roots(pass))?;
        }
        for step in 0..steps {
            if hair.uses_volume() {
                self.commands.start();
                hair.volume.clear(&mut self.commands);
                self.stage(Stage::Volume, |pass| hair.record_volume(pass, step))?;
            }
            if hair.uses_wind() {
                self.stage(Stage::Wind, |pass| hair.record_wind(pass, step))?;
            }
            self.stage(Stage::Simulate, |pass| hair.record_simulate(pass, step))?;
        }
        Ok(())
    }

    /// Updates only the drawn strands from the guides, which do not move.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn follow(&mut self, hair: &mut Hair, frame: &HairFrame<'_>) -> Result<()> {
        hair.resize_buffers()?;
        if hair.is_drawn() {
            return Ok(());
        }
        hair.set.write_count = Some(hair.set.write_count.unwrap_or_default() + 1);
        hair.prepare(frame);
        self.stage(Stage::Tessellate, |pass| hair.record_tessellate(pass))?;
        self.stage(Stage::Interpolate, |pass| hair.record_interpolate(pass))?;
        self.stage(Stage::Avoid, |pass| hair.record_avoid(pass))
    }

    /// Draws hair and bodies in their current state into a view.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn draw(
        &mut self,
        hair: &[&Hair],
        bodies: &[&Body],
        view: &View,
        drawing: Drawing<'_>,
    ) -> Result<()> {
        let space = |hair: &Hair| hair.motion.drawn_in;
        if hair.windows(2).any(|pair| !space(pair[0]).is_where(&space(pair[1]))) {
            let why = "all hair of a view must be drawn in the same space; set the same HairFrame::drawn_in for all";
            return Err(Error::unusable(why));
        }
        let sets: Vec<_> = hair.iter().map(|hair| &hair.set).collect();
        self.merged(|recorder| recorder.picture(&sets, hair, bodies, view, drawing))
    }

    /// [`draw`](Self::draw) for strands without simulation. Debug views ([`ViewContent::Inside`]) then show only data
    /// of the strands themselves.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn draw_strands(
        &mut self,
        strands: &[&HairSet],
        bodies: &[&Body],
        view: &View,
        drawing: Drawing<'_>,
    ) -> Result<()> {
        self.merged(|recorder| recorder.picture(strands, &[], bodies, view, drawing))
    }

    /// Records only the lighting of an image: shadow maps, including those of a `scene`, and ambient light. For hosts
    /// whose shaders sample it.
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
        let shadings = hair_shadings(view, strands, &parts, view.options().renderer.rate())?;
        let hair_views = hair_views(strands, &shadings, &parts);
        bodies.iter().for_each(|body| body.prepare());
        let lit = view.prepare(picture, &hair_views, &parts, view.options().renderer.max_shadow_maps())?;
        view.mark_light_recorded(&parts);
        self.merged(|recorder| recorder.cast(&parts, &lit, &hair_views, bodies, scene))
    }

    /// Records the stages of an image in order.
    fn picture(
        &mut self,
        sets: &[&HairSet],
        hair: &[&Hair],
        bodies: &[&Body],
        view: &View,
        drawing: Drawing<'_>,
    ) -> Result<()> {
        let Drawing { picture, output, shows, writes_labels, hides_bodies } = drawing;
        let bodies = if hides_bodies { &[][..] } else { bodies };
        let inside = match &shows {
            ViewContent::Inside(_, shown) => Some(*shown),
            _ => None,
        };
        let shown = inside.map(|shown| shown.picture(picture));
        let picture = shown.as_ref().unwrap_or(picture);
        let parts = view.parts(picture.focus, [sets.len(), bodies.len()], inside.is_none());
        // Debug views write a color per vertex.
        let renderer = view.options().renderer;
        let renderer = if inside.is_some() { renderer.per_vertex() } else { renderer };
        let shadings = hair_shadings(view, sets, &parts, renderer.rate())?;
        let hair_views = hair_views(sets, &shadings, &parts);
        // Hides the hair where it would cover what a debug view shows.
        let hides = inside.is_some_and(|shown| shown.hides_hair());
        let visible = if hides { &[][..] } else { &hair_views[..] };
        let (cards, strands): (Vec<_>, Vec<_>) =
            hair_views.iter().partition(|groom| groom.hair.cards().is_some());
        let grooms = [&strands, &cards].map(|grooms| if hides { &[][..] } else { &grooms[..] });

        self.commands.start();
        bodies.iter().for_each(|body| body.prepare());
        // Debug views shade with one group of lights.
        let max_maps = if inside.is_some() { LIGHT_GROUP } else { renderer.max_shadow_maps() };
        let lit = view.prepare(picture, &hair_views, &parts, max_maps)?;
        if !shows.is_lit() {
            view.mark_light_recorded(&parts);
            self.cast(&parts, &lit, visible, bodies, shows.shadows())?;
        }
        let canvas = &mut Canvas {
            commands: &mut self.commands,
            target: &view.targets().hdr,
            frame: &view.light.frame,
            eye: view.eye(),
            light: &view.light,
            parts: &parts,
            camera: &picture.camera,
            focus: &picture.focus,
            renderer,
            geometry: Compositor::identity_depth_map(renderer, writes_labels)?,
            writes_labels,
            space: hair.first().map(|hair| hair.motion.drawn_in).unwrap_or_default(),
        };
        let output = output.unwrap_or_else(|| view.targets().picture());
        match shows {
            ViewContent::Over(embed, into) => return composite(canvas, view, (embed, &into), grooms),
            ViewContent::Hair => paint(canvas, view, bodies, grooms, |canvas| shade(canvas, view, &strands))?,
            // Shades the segments that the last image found visible. With tiles, a finer image shows other segments.
            ViewContent::Again => {
                paint(canvas, view, bodies, grooms, |canvas| match canvas.renderer.is_tiles() {
                    true => shade(canvas, view, &strands),
                    false => Ok(()),
                })?
            }
            ViewContent::Inside(views, shown) => {
                paint(canvas, view, bodies, grooms, |canvas| {
                    // Debug views show all segments.
                    match views.shade(canvas.commands, shown, picture, hair, &hair_views)? {
                        true => Ok(()),
                        false => view.light.shade(canvas.commands, &strands, canvas.renderer.rate()),
                    }
                })?;
                view.present().record(&mut self.commands, view.targets(), output)?;
                self.commands.lap(Stage::Present);
                views.over(
                    &mut self.commands,
                    shown,
                    picture,
                    (view, output),
                    (hair, &hair_views),
                    bodies,
                )?;
                self.commands.lap(Stage::Debug);
                return Ok(());
            }
        }
        view.present().record(&mut self.commands, view.targets(), output)?;
        self.commands.lap(Stage::Present);
        Ok(())
    }

    /// Records shadow maps, including those of a scene, then ambient light.
    fn cast(
        &mut self,
        parts: &[Part<'_>],
        lit: &[crate::light::FrameLight],
        hair: &[HairView<'_>],
        bodies: &[&Body],
        scene: &[SceneShadow<'_>],
    ) -> Result<()> {
        for (i, (part, lit)) in parts.iter().zip(lit).enumerate() {
            let scene = part.light.import_shadows(lit, scene)?;
            let others = parts.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, other)| other);
            let others: Vec<_> = others.filter(|other| lit.is_shadowed_by(&other.focus)).collect();
            let other_hair: Vec<_> =
                others.iter().flat_map(|other| Part::select(&other.hair, hair)).collect();
            let groups: Vec<_> = other_hair.iter().map(|hair| part.light.bind_caster(hair)).collect();
            let own = Part::select(&part.hair, hair);
            let casters = Casters {
                hair: own.iter().map(HairView::caster).collect(),
                bodies: Part::select(&part.bodies, bodies),
                other_hair: other_hair
                    .iter()
                    .zip(&groups)
                    .map(|(hair, group)| hair.caster_bound(group))
                    .collect(),
                other_bodies: others.iter().flat_map(|other| Part::select(&other.bodies, bodies)).collect(),
            };
            part.light.record_shadows(&mut self.commands, lit, &casters, &scene)?;
        }
        self.commands.lap(Stage::Shadow);
        if lit.iter().any(|lit| lit.ambient) {
            for (part, lit) in parts.iter().zip(lit).filter(|(_, lit)| lit.ambient) {
                let (hair, bodies) = (Part::select(&part.hair, hair), Part::select(&part.bodies, bodies));
                part.light.record_ambient(
                    &mut self.commands,
                    &hair,
                    (&bodies, lit.every),
                    lit.has_unmapped,
                )?;
            }
            self.commands.lap(Stage::Ambient);
        }
        Ok(())
    }

    /// Records a compute pass named after a stage.
    fn stage(&mut self, stage: Stage, record: impl FnOnce(&mut crate::gpu::ComputePass<'_>)) -> Result<()> {
        self.commands.start();
        let mut pass = self.commands.compute(stage.name());
        record(&mut pass);
        pass.end()?;
        self.commands.lap(stage);
        Ok(())
    }
}

/// Draws bodies, strands and cards into the targets. Calls `shade` once the visible segments of strands are known.
fn paint<'a, 'c>(
    canvas: &mut Canvas<'a, 'c>,
    view: &View,
    bodies: &[&Body],
    [strands, cards]: [&[HairView<'_>]; 2],
    shade: impl FnOnce(&mut Canvas<'a, 'c>) -> Result<()>,
) -> Result<()> {
    let (draw, targets) = (&view.draw, view.targets());
    let body_first = canvas.renderer.draws_bodies_first();
    if body_first {
        draw.record_bodies(targets, canvas, bodies)?;
        canvas.commands.lap(Stage::Body);
        draw.cards.record(canvas, cards)?;
    }
    draw.record_visibility(targets, canvas, strands)?;
    shade(canvas)?;
    canvas.commands.lap(Stage::Shade);
    draw.record_hair(targets, canvas, strands, true)?;
    canvas.commands.lap(Stage::Hair);
    if !body_first {
        draw.record_bodies(targets, canvas, bodies)?;
        canvas.commands.lap(Stage::Body);
        draw.cards.record(canvas, cards)?;
    }
    Ok(())
}

/// Composites strands and cards into the scene of a host.
fn composite(
    canvas: &mut Canvas<'_, '_>,
    view: &View,
    (embed, into): (&Compositor, &HostFrame<'_>),
    [strands, cards]: [&[HairView<'_>]; 2],
) -> Result<()> {
    canvas.geometry = Compositor::geometry_depth_map(canvas.renderer, canvas.camera.projection, into)?;
    embed.record_depth(canvas, canvas.camera.projection, into);
    view.draw.cards.record(canvas, cards)?;
    view.draw.record_visibility(view.targets(), canvas, strands)?;
    shade(canvas, view, strands)?;
    canvas.commands.lap(Stage::Shade);
    view.draw.record_hair(view.targets(), canvas, strands, false)?;
    canvas.commands.lap(Stage::Hair);
    embed.record_shade(canvas, into)?;
    embed.record(view.targets().tiles().ok(), canvas, into, !cards.is_empty());
    canvas.commands.lap(Stage::Embed);
    Ok(())
}

/// Shades the visible segments of `hair` if they are known, otherwise all segments.
fn shade(canvas: &mut Canvas<'_, '_>, view: &View, hair: &[HairView<'_>]) -> Result<()> {
    if view.draw.shade_visible(view.targets(), canvas, hair)? {
        return Ok(());
    }
    view.light.shade(canvas.commands, hair, canvas.renderer.rate())
}

/// Returns the buffers of `view` for each of `sets`, lit by the light of its part.
fn hair_shadings(
    view: &View,
    sets: &[&HairSet],
    parts: &[Part<'_>],
    rate: ShadingRate,
) -> Result<Vec<Arc<HairShading>>> {
    let lights: Vec<_> = (0..sets.len()).map(|i| light_of(i, parts).0).collect();
    view.hair_shadings(sets, &lights, rate)
}

/// Returns the light of groom `i`, and whether it is a zone's. Each groom belongs to one part.
fn light_of<'a>(i: usize, parts: &[Part<'a>]) -> (&'a light::LightState, bool) {
    let part = parts.iter().find(|part| part.hair.contains(&i)).unwrap_or(&parts[0]);
    (part.light, part.number > 0)
}

/// Pairs each of `sets` with its buffers and light in a view.
fn hair_views<'a>(
    sets: &[&'a HairSet],
    shadings: &'a [Arc<HairShading>],
    parts: &[Part<'a>],
) -> Vec<HairView<'a>> {
    let view = |(i, (hair, shaded)): (usize, (&&'a HairSet, &'a Arc<HairShading>))| {
        let (light, zoned) = light_of(i, parts);
        HairView { hair, shaded, light, zoned }
    };
    sets.iter().zip(shadings).enumerate().map(view).collect()
}
