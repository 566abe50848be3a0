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
    Context, Error, Hair, Result,
    body::Body,
    draw::{Embed, Surroundings, record::Canvas},
    gpu::{Commands, Timings},
    hair::HairFrame,
    light::{self, HairSet, Part, SceneShadow, Seen, Shaded, ShadingRate},
    skinning::Skinning,
    stage::Stage,
    view::{Picture, View},
    views::{DebugViews, Shown},
};
use std::sync::Arc;

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

impl Shows<'_> {
    /// Whether the light has been made already.
    fn is_lit(&self) -> bool {
        matches!(self, Self::Again | Self::Over(_, Surroundings { lit: true, .. }))
    }

    /// The shadow maps of a host's scene.
    fn shadows(&self) -> &[SceneShadow<'_>] {
        match self {
            Self::Over(_, into) => into.shadows,
            _ => &[],
        }
    }
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
    commands: Commands<'a>,
}

impl Context {
    /// Records a frame into `encoder`. After an error the encoder must not be submitted.
    pub fn recorder<'a>(&self, encoder: &'a mut wgpu::CommandEncoder) -> Recorder<'a> {
        Recorder { commands: self.commands(encoder) }
    }
}

impl<'a> Recorder<'a> {
    /// Measures the stages with `timings`. [By a clock](Timings::by), each part is submitted and waited for.
    pub fn with_timings(self, timings: impl Into<Option<&'a mut Timings>>) -> Self {
        Self { commands: self.commands.with_timings(timings) }
    }

    /// The context that records.
    pub fn context(&self) -> &Context {
        self.commands.context()
    }

    /// The encoder, for commands of the caller between those of the frame.
    pub fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        self.commands.encoder()
    }
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
        hair: &mut [(&mut Hair, HairFrame<'_>)],
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
        self.stage(Stage::Skinning, |pass| bodies.iter().for_each(|body| body.record(pass)))
    }

    /// Moves the hair by a frame.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn advance(&mut self, hair: &mut Hair, frame: &HairFrame<'_>) -> Result<()> {
        self.simulate(hair, frame)?;
        self.follow(hair, frame)
    }

    /// Only the guides: they move by as many fixed steps as have become due.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn simulate(&mut self, hair: &mut Hair, frame: &HairFrame<'_>) -> Result<()> {
        hair.make_room()?;
        let steps = hair.begin(frame)?;
        if hair.is_shifted() {
            self.stage(Stage::Simulate, |pass| hair.record_shift(pass))?;
        }
        if hair.is_on_skin() && hair.is_seen() {
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

    /// Only the drawn strands: they follow the guides, which do not move.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn follow(&mut self, hair: &mut Hair, frame: &HairFrame<'_>) -> Result<()> {
        hair.make_room()?;
        if hair.is_drawn() {
            return Ok(());
        }
        hair.prepare(frame);
        self.stage(Stage::Tessellate, |pass| hair.record_tessellate(pass))?;
        self.stage(Stage::Interpolate, |pass| hair.record_interpolate(pass))?;
        self.stage(Stage::Avoid, |pass| hair.record_avoid(pass))
    }

    /// Draws hair and bodies as they are now into a view.
    ///
    /// # Errors
    /// As [`record`](Self::record).
    pub fn draw(&mut self, hair: &[&Hair], bodies: &[&Body], sight: Sight<'_>) -> Result<()> {
        let seen = |hair: &Hair| hair.motion.drawn_in;
        if hair.windows(2).any(|pair| !seen(pair[0]).is_where(&seen(pair[1]))) {
            let why = "the hair of one view must be drawn in one space: give all of it the same HairFrame::drawn_in";
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
        let shares = shares(view, strands, &parts, picture.shading)?;
        let seen = seen(strands, &shares, &parts);
        bodies.iter().for_each(|body| body.prepare());
        let lit = view.prepare(picture, &seen, &parts);
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
        let Sight { view, picture, output, shows, asks } = sight;
        let inside = match &shows {
            Shows::Inside(_, shown) => Some(*shown),
            _ => None,
        };
        let picture = &inside.map_or(*picture, |shown| shown.picture(picture));
        let parts = view.parts(picture.focus, [sets.len(), bodies.len()], inside.is_none());
        let shares = shares(view, sets, &parts, picture.shading)?;
        let seen = seen(sets, &shares, &parts);
        // A debug view may leave hair out, which would hide what it shows.
        let hides = inside.is_some_and(|shown| shown.view.hides_hair());
        let visible = if hides { &[][..] } else { &seen[..] };

        self.commands.start();
        bodies.iter().for_each(|body| body.prepare());
        let lit = view.prepare(picture, &seen, &parts);
        if !shows.is_lit() {
            view.made(&parts);
            self.cast(&parts, &lit, visible, bodies, (&picture.lights, shows.shadows()))?;
        }
        let canvas = &mut Canvas {
            commands: &mut self.commands,
            targets: view.targets(),
            frame: &view.light.frame,
            eye: view.eye(),
            light: &view.light,
            parts: &parts,
            camera: &picture.camera,
            lights: &picture.lights,
            focus: &picture.focus,
            coverage: view.options().coverage,
            rate: picture.shading,
            geometry: Embed::known(view.options().coverage, asks)?,
            labels: asks,
            space: hair.first().map(|hair| hair.motion.drawn_in).unwrap_or_default(),
        };
        let output = output.unwrap_or_else(|| view.targets().picture());
        match shows {
            Shows::Over(embed, into) => return composite(canvas, view, (embed, &into), &seen),
            Shows::Hair => paint(canvas, view, bodies, visible, |canvas| shade(canvas, view, &seen))?,
            // The segments that the last picture showed are shaded; finer tiles show others.
            Shows::Again => {
                paint(canvas, view, bodies, visible, |canvas| match canvas.coverage.is_tiled() {
                    true => shade(canvas, view, &seen),
                    false => Ok(()),
                })?
            }
            Shows::Inside(views, shown) => {
                paint(canvas, view, bodies, visible, |canvas| {
                    // Debug views show all segments.
                    match views.shade(canvas.commands, shown, picture, hair, &seen)? {
                        true => Ok(()),
                        false => view.light.shade(canvas.commands, &seen, canvas.rate),
                    }
                })?;
                view.present().record(&mut self.commands, view.targets(), output)?;
                self.commands.lap(Stage::Present);
                views.over(&mut self.commands, shown, picture, (view, output), (hair, &seen), bodies)?;
                self.commands.lap(Stage::Debug);
                return Ok(());
            }
        }
        view.present().record(&mut self.commands, view.targets(), output)?;
        self.commands.lap(Stage::Present);
        Ok(())
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
        for (part, lit) in parts.iter().zip(lit) {
            let (hair, bodies) = (Part::of(&part.hair, hair), Part::of(&part.bodies, bodies));
            let scene = part.light.bring(lights, lit, scene)?;
            part.light.record_shadows(&mut self.commands, lit, &hair, (&bodies, &scene))?;
        }
        self.commands.lap(Stage::Shadow);
        if lit.iter().any(|lit| lit.ambient) {
            for (part, lit) in parts.iter().zip(lit).filter(|(_, lit)| lit.ambient) {
                let (hair, bodies) = (Part::of(&part.hair, hair), Part::of(&part.bodies, bodies));
                part.light.record_ambient(&mut self.commands, &hair, (&bodies, lit.every))?;
            }
            self.commands.lap(Stage::Ambient);
        }
        Ok(())
    }

    /// A compute pass under the name of a stage.
    fn stage(&mut self, stage: Stage, record: impl FnOnce(&mut crate::gpu::ComputePass<'_>)) -> Result<()> {
        self.commands.start();
        let mut pass = self.commands.compute(stage.name());
        record(&mut pass);
        pass.end()?;
        self.commands.lap(stage);
        Ok(())
    }
}

/// Bodies and `hair` into the targets, shaded by `shade` once it is known which segments are visible.
fn paint<'a, 'c>(
    canvas: &mut Canvas<'a, 'c>,
    view: &View,
    bodies: &[&Body],
    hair: &[Seen<'_>],
    shade: impl FnOnce(&mut Canvas<'a, 'c>) -> Result<()>,
) -> Result<()> {
    let draw = &view.draw;
    let body_first = draw.body_first(canvas.coverage);
    if body_first {
        draw.record_bodies(canvas, bodies)?;
        canvas.commands.lap(Stage::Body);
    }
    draw.record_seen(canvas, hair)?;
    shade(canvas)?;
    canvas.commands.lap(Stage::Shade);
    draw.record_hair(canvas, hair, true)?;
    canvas.commands.lap(Stage::Hair);
    if !body_first {
        draw.record_bodies(canvas, bodies)?;
        canvas.commands.lap(Stage::Body);
    }
    Ok(())
}

/// `hair` over the scene of a host.
fn composite(
    canvas: &mut Canvas<'_, '_>,
    view: &View,
    (embed, into): (&Embed, &Surroundings<'_>),
    hair: &[Seen<'_>],
) -> Result<()> {
    canvas.geometry = Embed::asked(canvas.coverage, canvas.camera.projection, into)?;
    embed.record_depth(canvas, canvas.camera.projection, into);
    view.draw.record_seen(canvas, hair)?;
    shade(canvas, view, hair)?;
    canvas.commands.lap(Stage::Shade);
    view.draw.record_hair(canvas, hair, false)?;
    canvas.commands.lap(Stage::Hair);
    embed.record_shade(canvas, into)?;
    embed.record(canvas, into);
    canvas.commands.lap(Stage::Embed);
    Ok(())
}

/// Shades the visible segments of `hair` where these are known, or all of them.
fn shade(canvas: &mut Canvas<'_, '_>, view: &View, hair: &[Seen<'_>]) -> Result<()> {
    if view.draw.shade_seen(canvas, hair)? {
        return Ok(());
    }
    view.light.shade(canvas.commands, hair, canvas.rate)
}

/// What `view` has of each of `sets`, in the light of its part.
fn shares(view: &View, sets: &[&HairSet], parts: &[Part<'_>], rate: ShadingRate) -> Result<Vec<Arc<Shaded>>> {
    let lights: Vec<_> = (0..sets.len()).map(|i| light_of(i, parts).0).collect();
    view.shares(sets, &lights, rate)
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
