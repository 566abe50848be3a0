//! A frame of characters: all of them advance, then they are drawn into views.

use super::{Character, light::Lighting};
use crate::{
    Camera, Context, Result,
    body::Body,
    budget::{Budget, CostModel, CrowdDetail, ViewBytes},
    draw::{Compositor, HostFrame},
    frame::{Drawing, Recorder, ViewContent},
    gpu::Timings,
    hair::Hair,
    light::{SceneShadow, Zone},
    skinning::Skinning,
    view::{Picture, View},
};

/// Records a frame of characters: [`advance`](Self::advance), then [`draw`](Self::draw) or
/// [`composite`](Self::composite) for each view. [`Context::frame`] creates it.
///
/// After an error the encoder must not be submitted.
#[derive(Debug)]
pub struct Frame<'a> {
    recorder: Recorder<'a>,
    cameras: &'a [Camera],
    budget: Option<&'a mut CrowdBudget>,
}

/// The budget of a crowd, and the levels of detail that it has chosen.
///
/// ```no_run
/// use tresses::{
///     Character, CharacterAsset, CharacterOptions, Context, CrowdBudget, HairOptions, LodOptions, Picture, Pose,
///     Result, Styling, View, drape,
/// };
///
/// /// Once: creates characters that share everything that does not move.
/// async fn crowd(tresses: &Context, count: usize) -> Result<Vec<Character>> {
///     let source = drape::style(tresses, &"long".parse()?, &()).await?;
///     let parts = source.parts(&Styling::default(), &()).await?;
///     let hair = HairOptions { lod: LodOptions::CROWD, ..Default::default() };
///     let options = CharacterOptions::default().with_hair(hair);
///     let asset = CharacterAsset::new(tresses, parts, &options, &()).await?;
///     (0..count).map(|_| Character::new(&asset)).collect()
/// }
///
/// /// Each frame. `milliseconds` is the time of the last frame.
/// fn frame(
///     tresses: &Context,
///     encoder: &mut wgpu::CommandEncoder,
///     crowd: &mut [Character],
///     poses: &[Pose],
///     budget: &mut CrowdBudget,
///     view: &mut View,
///     target: &wgpu::TextureView,
///     milliseconds: f64,
/// ) -> Result<()> {
///     let picture = &Picture::default();
///     budget.costs.fit(&budget.detail.work, milliseconds);
///     for (character, pose) in crowd.iter_mut().zip(poses) {
///         character.set_pose(*pose);
///     }
///     let cameras = [picture.camera];
///     let mut frame = tresses.frame(encoder).with_cameras(&cameras).within(budget);
///     frame.advance(&mut crowd.iter_mut().collect::<Vec<_>>(), 1.0 / 60.0)?;
///     frame.draw(view, &crowd.iter().collect::<Vec<_>>(), picture, target)
/// }
/// ```
#[derive(Clone, Debug, Default)]
pub struct CrowdBudget {
    /// Limits for all characters of a frame.
    pub budget: Budget,
    /// Cost of work, fitted to timed frames ([`CostModel::fit`](crate::low_level::CostModel::fit)).
    pub costs: CostModel,
    /// Levels of the last frame: the hair of each character, followed by its face grooms if they are drawn.
    pub detail: CrowdDetail,
}

impl Context {
    /// Begins a frame whose commands are recorded into `encoder`.
    pub fn frame<'a>(&'a self, encoder: &'a mut wgpu::CommandEncoder) -> Frame<'a> {
        Frame { recorder: self.recorder(encoder), cameras: &[], budget: None }
    }
}

impl<'a> Frame<'a> {
    /// Chooses the level of detail of each character for the camera in which it is largest. Without cameras the levels
    /// do not change.
    pub fn with_cameras(mut self, cameras: &'a [Camera]) -> Self {
        self.cameras = cameras;
        self
    }

    /// Chooses the levels of all characters together, for the first camera, so that they stay within a budget.
    pub fn within(mut self, budget: &'a mut CrowdBudget) -> Self {
        self.budget = Some(budget);
        self
    }

    /// Measures the stages.
    pub fn timed(self, timings: Option<&'a mut Timings>) -> Self {
        Self { recorder: self.recorder.with_timings(timings), ..self }
    }

    /// Records the motion of `dt` seconds: poses skins, deforms fields, moves roots, chooses levels of detail, steps
    /// the guides and updates the strands.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for physics out of range, [`crate::Error::Limit`] when the adapter cannot hold the
    /// buffers of a level, [`crate::Error::Gpu`] when a pipeline cannot be compiled.
    pub fn advance(&mut self, characters: &mut [&mut Character], dt: f32) -> Result<()> {
        for character in &mut *characters {
            character.find_pose(dt)?;
        }
        self.select_detail(characters);
        self.recorder.merged(|recorder| {
            let bodies: Vec<&Skinning> = characters
                .iter()
                .filter_map(|character| Some(character.rigged.as_ref()?.skinning()))
                .collect();
            if !bodies.is_empty() {
                recorder.bend(&bodies)?;
            }
            characters.iter_mut().try_for_each(|character| character.advance(recorder, dt))
        })
    }

    fn select_detail(&mut self, characters: &mut [&mut Character]) {
        let Some(camera) = self.cameras.first() else { return };
        if let Some(crowd) = &mut self.budget {
            return crowd.select(camera, characters);
        }
        for character in characters {
            let head = character.head_drawn();
            let size = |camera: &Camera| character.hair.lod.detail_for_camera(camera, &head).size;
            let largest = self.cameras.iter().max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(camera);
            character.grooms_mut().for_each(|hair| hair.look_from(largest, &head));
            character.bias = 0.0;
        }
    }

    /// Draws characters into `output`, a target of the view's size and the format of its options.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the device cannot hold the buffers of the view, [`crate::Error::Groom`] when the
    /// characters are drawn in several spaces, [`crate::Error::Gpu`] when a pipeline cannot be compiled.
    pub fn draw(
        &mut self,
        view: &mut View,
        characters: &[&Character],
        picture: &Picture,
        output: &wgpu::TextureView,
    ) -> Result<()> {
        self.draw_as(view, characters, Drawing { output: Some(output), ..Drawing::new(picture) })
    }

    /// Composites hair into a scene that the host has drawn and that hides hair behind it.
    /// Bodies are not drawn, but shade the hair.
    ///
    /// # Errors
    /// As [`draw`](Self::draw).
    pub fn composite(
        &mut self,
        view: &mut View,
        characters: &[&Character],
        picture: &Picture,
        embed: &Compositor,
        into: HostFrame<'_>,
    ) -> Result<()> {
        let shows = ViewContent::Over(embed, into);
        self.draw_as(view, characters, Drawing { shows, ..Drawing::new(picture) })
    }

    /// Records only the lighting of an image, for a host whose shaders sample the shadow of the hair before it is
    /// composited with [`HostFrame::is_lit`]. `scene` are the host's shadow maps.
    ///
    /// # Errors
    /// As [`draw`](Self::draw).
    pub fn light(
        &mut self,
        view: &mut View,
        characters: &[&Character],
        picture: &Picture,
        scene: &[SceneShadow<'_>],
    ) -> Result<()> {
        let (bodies, numbers) = bodies(characters);
        let lighting = Lighting::new(characters, &numbers, &picture.camera);
        let picture = lighting.set(view, characters, bodies.len(), picture);
        let sets: Vec<_> = characters.iter().flat_map(|it| it.grooms()).map(|hair| &hair.set).collect();
        self.recorder.light(&sets, &bodies, view, &picture, scene)
    }

    /// Draws characters as specified by `drawing`.
    ///
    /// # Errors
    /// As [`draw`](Self::draw).
    pub fn draw_as(
        &mut self,
        view: &mut View,
        characters: &[&Character],
        drawing: Drawing<'_>,
    ) -> Result<()> {
        let Drawing { picture, output, shows, writes_labels, hides_bodies } = drawing;
        let (bodies, numbers) = match hides_bodies {
            true => (Vec::new(), vec![Vec::new(); characters.len()]),
            false => bodies(characters),
        };
        let lighting = Lighting::new(characters, &numbers, &picture.camera);
        let picture = match shows.is_lit() {
            true => Picture { focus: lighting.focus, ..picture.clone() },
            false => lighting.set(view, characters, bodies.len(), picture),
        };
        let hair: Vec<&Hair> = characters.iter().flat_map(|character| character.grooms()).collect();
        let drawing = Drawing { output, shows, writes_labels, ..Drawing::new(&picture) };
        self.recorder.draw(&hair, &bodies, view, drawing)
    }
}

/// Returns the bodies of an image, and for each character the indices of its own. A mesh shared by several characters,
/// for example when a host keeps hair and brows apart, is listed once.
fn bodies<'a>(characters: &[&'a Character]) -> (Vec<&'a Body>, Vec<Vec<usize>>) {
    let (mut all, mut ids): (Vec<&Body>, Vec<Option<u64>>) = (Vec::new(), Vec::new());
    let numbers = characters.iter().map(|character| {
        let known = character.body_id.and_then(|id| ids.iter().position(|other| *other == Some(id)));
        let own = character.body.iter().map(|body| {
            known.unwrap_or_else(|| {
                all.push(body);
                ids.push(character.body_id);
                all.len() - 1
            })
        });
        let mut numbers: Vec<_> = own.collect();
        for prop in &character.props {
            all.push(prop);
            ids.push(None);
            numbers.push(all.len() - 1);
        }
        numbers
    });
    let numbers = numbers.collect();
    (all, numbers)
}

/// Size of a head, in pixels, below which a crowd omits brows, lashes and beard.
const FACE: f32 = 24.0;

impl CrowdBudget {
    /// Makes the next choice ignore the levels of the last frame.
    pub fn reset_detail(&mut self) {
        self.detail = CrowdDetail::default();
    }

    fn select(&mut self, camera: &Camera, characters: &mut [&mut Character]) {
        let foci: Vec<_> = characters.iter().map(|character| character.focus_drawn()).collect();
        let mut all = Vec::new();
        let mut owners = Vec::new();
        for (i, character) in characters.iter_mut().enumerate() {
            let head = character.head_drawn();
            all.push((&mut character.hair, head));
            owners.push(Some(i));
            let is_small = all[all.len() - 1].0.lod.detail_for_camera(camera, &head).size < FACE;
            for face in &mut character.face {
                match is_small {
                    true => face.hair.hide(),
                    false => {
                        all.push((&mut face.hair, head));
                        owners.push(None);
                    }
                }
            }
        }
        // The lighting of a zone is counted once per character.
        let light = |groom: usize, bias: f32| {
            owners[groom]
                .map_or(0, |i| Zone::for_camera(foci[i], camera, bias, Vec::new(), Vec::new()).bytes())
        };
        let held = ViewBytes { vertex: ViewBytes::BY_TILES, head: &light };
        let before = (!self.detail.heads.is_empty()).then_some(self.detail.bias);
        self.detail = self.budget.look_from(&self.costs, camera, &mut all, before, &held);
        for character in characters {
            character.bias = self.detail.bias;
        }
    }
}
