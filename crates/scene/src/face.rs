//! Grooms that a character has besides its hair: brows and lashes, and a beard.
//!
//! Each is hair of its own on the same body, with roots on the skin, so that it goes with jaw and brows. Its colour is the
//! hair's, a shade darker.

use anyhow::Result;
use tresses::{
    Hair, HairOptions, Pipelines, Pose, Progress,
    body::Body,
    collide::{ColliderDescriptor, ColliderPoses},
    frame::{Frame, Recorder},
    gpu::Gpu,
    groom::{
        BindOptions, Groom, GuideCount, Strands, TriMesh, bind,
        mannequin::facial::{self, Beard},
    },
    light::HairMaterial,
    lod::LodMode,
    roots::Skin,
    simulate::SimulationParams,
    volume::{HairHair, VolumeOptions},
    wind::Wind,
};

/// How much more pigment than the hair it has: most people's brows and beards are darker.
const DARKER: f32 = 1.5;
/// No root may be farther from the skin, metres.
const FARTHEST_ROOT: f32 = 0.01;

/// What there is of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FaceHair {
    /// Whether there are brows.
    pub brows: bool,
    /// Whether there are lashes.
    pub lashes: bool,
    /// What beard there is.
    pub beard: Beard,
}

impl Default for FaceHair {
    fn default() -> Self {
        Self { brows: true, lashes: true, beard: Beard::None }
    }
}

/// A groom of the face, not yet on the GPU.
#[derive(Clone, Debug)]
pub struct FaceGroom {
    /// Guides and strands.
    pub groom: Groom,
    /// Whether it is long enough to meet anything but the skin that it grows on.
    pub hangs: bool,
}

impl FaceHair {
    /// The grooms on `mesh`, a mesh of the built-in character.
    ///
    /// # Errors
    /// None, unless growth has an error.
    pub fn grow(&self, mesh: &TriMesh) -> Result<Vec<FaceGroom>> {
        let (mut fine, mut beard) = (Strands::default(), Strands::default());
        if self.brows {
            facial::brows(&mut fine);
        }
        if self.lashes {
            facial::lashes(&mut fine);
        }
        facial::beard(&mut beard, self.beard, mesh);
        let hangs = self.beard == Beard::Full;
        let all = [(fine, false, 12), (beard, hangs, if hangs { 24 } else { 60 })];
        let bound =
            all.into_iter().filter(|(strands, ..)| !strands.is_empty()).map(|(strands, hangs, of)| {
                let vertices = strands.range(0).len() as u32;
                let options = BindOptions {
                    guides: GuideCount::OneIn(of),
                    guide_vertices: Some(vertices.max(8)),
                    strand_vertices: Some(vertices),
                    ..Default::default()
                };
                Ok(FaceGroom { groom: bind(&strands, &options)?, hangs })
            });
        bound.collect()
    }
}

/// A groom of the face on the GPU.
#[derive(Debug)]
pub struct Fringe {
    /// The hair.
    pub hair: Hair,
    hangs: bool,
}

impl Fringe {
    /// On the skin of `body`, whose mesh at rest is `mesh`; what hangs collides as `what` says.
    pub(crate) async fn new(
        (gpu, pipelines): (&Gpu, &Pipelines),
        face: &FaceGroom,
        physics: &SimulationParams,
        what: &ColliderDescriptor<'_>,
        (body, mesh): (&Body, &TriMesh),
        progress: &impl Progress,
    ) -> Result<Self> {
        let (device, queue) = (&gpu.device, &gpu.queue);
        // Without wind nothing asks the grid of what lies on the skin.
        let volume = match face.hangs {
            true => VolumeOptions::default(),
            false => VolumeOptions { resolution: 8, ..Default::default() },
        };
        let options = HairOptions { simulation: own(physics, face.hangs), volume, ..Default::default() };
        let nothing = ColliderDescriptor::default();
        let what = if face.hangs { what } else { &nothing };
        let groom = &face.groom;
        let mut hair = Hair::with_progress(device, queue, pipelines, groom, &options, what, progress).await?;
        hair.lod.options.mode = LodMode::Off;
        hair.attach(device, queue, pipelines, groom, mesh, &Skin::from(body), FARTHEST_ROOT)?;
        Ok(Self { hair, hangs: face.hangs })
    }

    /// Moves it as `frame` has the character's hair move; the body is at `pose`.
    pub(crate) fn advance(
        &mut self,
        recorder: &mut Recorder<'_>,
        frame: &Frame<'_>,
        like: &Hair,
        pose: Pose,
    ) -> Result<()> {
        self.hair.lod.options = like.lod.options;
        self.hair.set.share_fibers(&like.set);
        if let Some(roots) = &mut self.hair.roots {
            roots.pose = pose;
        }
        let simulation = &own(frame.simulation, self.hangs);
        let nowhere = ColliderPoses::default();
        let colliders = if self.hangs { frame.colliders } else { &nowhere };
        Ok(recorder.advance(&mut self.hair, &Frame { simulation, colliders, ..*frame })?)
    }

    /// Whether it collides with what the hair collides with.
    pub(crate) fn hangs(&self) -> bool {
        self.hangs
    }

    /// Its colour, beside hair of `material`.
    pub(crate) fn dress(&mut self, material: &HairMaterial) {
        let mut own = *material;
        own.fiber.root_absorption *= DARKER;
        own.fiber.tip_absorption *= DARKER;
        own.root_color *= 1.0 / DARKER;
        own.tip_color *= 1.0 / DARKER;
        if self.hair.set.material != own {
            self.hair.set.material = own;
        }
    }
}

/// `hair`, and what hangs of the face: all that collides with the body.
pub(crate) fn colliding<'a>(
    hair: &'a mut Hair,
    face: &'a mut [Fringe],
) -> impl Iterator<Item = &'a mut Hair> {
    let hanging = face.iter_mut().filter(|face| face.hangs).map(|face| &mut face.hair);
    std::iter::once(hair).chain(hanging)
}

/// The physics of hair that is too thin for a grid; wind moves nothing that lies on the skin.
fn own(physics: &SimulationParams, hangs: bool) -> SimulationParams {
    let wind = if hangs { physics.wind } else { Wind::default() };
    SimulationParams { hair_hair: HairHair::OFF, wind, ..*physics }
}
