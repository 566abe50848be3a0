//! A frame of characters: all of them move, then they are drawn into views.

use super::{Character, light::Lighting};
use crate::{
    Camera, Context, Hair, Pose, Result,
    body::Body,
    budget::{Budget, Chosen, Costs, Held},
    draw::{Embed, Surroundings},
    frame::{Recorder, Shows, Sight},
    gpu::Timings,
    light::{SceneShadow, Zone},
    lod::LodMode,
    skinning::Skinning,
    view::{Picture, View},
};

/// Records the frame of a slice of characters: [`advance`](Self::advance), then [`draw`](Self::draw) or
/// [`composite`](Self::composite) for each view. Made by [`Context::frame`].
///
/// After an error the encoder's commands are not to be submitted.
#[derive(Debug)]
pub struct Frame<'a> {
    recorder: Recorder<'a>,
    cameras: &'a [Camera],
    budget: Option<&'a mut CrowdBudget>,
}

/// The budget of a crowd, and the levels of detail that it has led to.
#[derive(Clone, Debug, Default)]
pub struct CrowdBudget {
    /// The most that all characters of a frame may cost.
    pub budget: Budget,
    /// The cost of work, fitted to frames that were timed ([`Costs::fit`]).
    pub costs: Costs,
    /// The levels of the last frame: of each character's hair, then of its face grooms as far as they are drawn.
    pub chosen: Chosen,
}

/// How characters are drawn into a view.
#[derive(Debug)]
pub struct Drawing<'a> {
    /// Camera, lights, background, tone mapping. Its focus is derived from the characters.
    pub picture: &'a Picture,
    /// The target, of the view's size and the format of its options; `None` for
    /// [`Targets::picture`](crate::draw::Targets::picture).
    pub output: Option<&'a wgpu::TextureView>,
    /// What is drawn.
    pub shows: Shows<'a>,
    /// Whether the view's targets also receive motion, depth, opacity and labels of the hair ([`Sight::asks`]).
    pub asks: bool,
    /// Whether the hair is drawn alone, without bodies and their shadows.
    pub bare: bool,
}

impl<'a> Drawing<'a> {
    /// Bodies and hair into the view's own target.
    pub fn new(picture: &'a Picture) -> Self {
        Self { picture, output: None, shows: Shows::Hair, asks: false, bare: false }
    }
}

impl Context {
    /// Begins a frame, whose commands go into `encoder`.
    pub fn frame<'a>(&'a self, encoder: &'a mut wgpu::CommandEncoder) -> Frame<'a> {
        Frame { recorder: self.recorder(encoder), cameras: &[], budget: None }
    }
}

impl<'a> Frame<'a> {
    /// Chooses the level of detail of each character for the camera that sees it largest. Without cameras the levels stay
    /// as they are.
    pub fn seen_by(mut self, cameras: &'a [Camera]) -> Self {
        self.cameras = cameras;
        self
    }

    /// Chooses the levels of all characters together, for the first camera, so that they keep a budget.
    pub fn within(mut self, budget: &'a mut CrowdBudget) -> Self {
        self.budget = Some(budget);
        self
    }

    /// Measures the stages.
    pub fn timed(self, timings: Option<&'a mut Timings>) -> Self {
        Self { recorder: self.recorder.with_timings(timings), ..self }
    }

    /// Records the motion of `dt` seconds: skins are posed, fields deform, roots move, levels of detail are chosen, hair is
    /// stepped and its strands follow.
    ///
    /// # Errors
    /// [`crate::Error::Parameter`] for physics out of range, [`crate::Error::Limit`] when the adapter cannot hold what a
    /// level needs, [`crate::Error::Gpu`] when a pipeline cannot be compiled.
    pub fn advance(&mut self, characters: &mut [&mut Character], dt: f32) -> Result<()> {
        for character in &mut *characters {
            character.find_pose(dt)?;
        }
        self.choose_detail(characters);
        let bodies: Vec<&Skinning> =
            characters.iter().filter_map(|character| Some(character.rigged.as_ref()?.skinning())).collect();
        if !bodies.is_empty() {
            self.recorder.bend(&bodies)?;
        }
        characters.iter_mut().try_for_each(|character| character.advance(&mut self.recorder, dt))
    }

    fn choose_detail(&mut self, characters: &mut [&mut Character]) {
        let Some(camera) = self.cameras.first() else { return };
        if let Some(crowd) = &mut self.budget {
            return crowd.choose(camera, characters);
        }
        for character in characters {
            let head = character.head_drawn();
            let size = |camera: &Camera| character.hair.lod.seen(camera, &head).size;
            let largest = self.cameras.iter().max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(camera);
            character.grooms_mut().for_each(|hair| hair.look_from(largest, &head));
            character.bias = 0.0;
        }
    }

    /// Draws characters into `output`, a target of the view's size and the format of its options.
    ///
    /// # Errors
    /// [`crate::Error::Limit`] when the device cannot hold what the view needs, [`crate::Error::Groom`] when the characters
    /// are drawn in several spaces, [`crate::Error::Gpu`] when a pipeline cannot be compiled.
    pub fn draw(
        &mut self,
        view: &mut View,
        characters: &[&Character],
        picture: &Picture,
        output: &wgpu::TextureView,
    ) -> Result<()> {
        self.draw_as(view, characters, Drawing { output: Some(output), ..Drawing::new(picture) })
    }

    /// Draws hair over a scene that the host has drawn, hidden by what is before it ([`crate::draw::embed`]). Bodies are
    /// not drawn, but shade the hair.
    ///
    /// # Errors
    /// As [`draw`](Self::draw).
    pub fn composite(
        &mut self,
        view: &mut View,
        characters: &[&Character],
        picture: &Picture,
        embed: &Embed,
        into: Surroundings<'_>,
    ) -> Result<()> {
        let shows = Shows::Over(embed, into);
        self.draw_as(view, characters, Drawing { shows, ..Drawing::new(picture) })
    }

    /// Records the light of a picture alone, for a host whose shaders ask the hair for its shadow before hair is
    /// composited with [`Surroundings::lit`]. `scene` are the host's shadow maps.
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
        let picture = self.set_light(view, characters, picture);
        let sets: Vec<_> = characters.iter().flat_map(|it| it.grooms()).map(|hair| &hair.set).collect();
        let (bodies, _) = bodies(characters);
        self.recorder.light(&sets, &bodies, view, &picture, scene)
    }

    /// Draws characters as `drawing` says.
    ///
    /// # Errors
    /// As [`draw`](Self::draw).
    pub fn draw_as(
        &mut self,
        view: &mut View,
        characters: &[&Character],
        drawing: Drawing<'_>,
    ) -> Result<()> {
        let Drawing { picture, output, shows, asks, bare } = drawing;
        let is_lit = matches!(shows, Shows::Again | Shows::Over(_, Surroundings { lit: true, .. }));
        let picture = match is_lit {
            true => Picture { focus: lighting(characters, picture).focus, ..*picture },
            false => self.set_light(view, characters, picture),
        };
        let hair: Vec<&Hair> = characters.iter().flat_map(|character| character.grooms()).collect();
        let (bodies, _) = if bare { Default::default() } else { bodies(characters) };
        let sight = Sight { output, shows, asks, ..Sight::new(view, &picture) };
        self.recorder.draw(&hair, &bodies, sight)
    }

    /// Gives the view the zones of a picture of these characters. Returns the picture with its focus.
    fn set_light(&mut self, view: &mut View, characters: &[&Character], picture: &Picture) -> Picture {
        let Lighting { focus, zones } = lighting(characters, picture);
        let picture = Picture { focus, ..*picture };
        let lod = characters.first().map(|character| (&character.hair.lod.options, character.bias));
        match lod {
            Some((options, bias)) if zones.is_empty() && options.mode == LodMode::Auto => {
                let counts =
                    [characters.iter().flat_map(|it| it.grooms()).count(), bodies(characters).0.len()];
                view.fit_light((&picture, options.bias + bias), counts);
            }
            _ => view.set_zones(&zones),
        }
        picture
    }
}

fn lighting(characters: &[&Character], picture: &Picture) -> Lighting {
    Lighting::new(characters, &bodies(characters).1, &picture.camera)
}

/// The bodies of a picture, and the numbers of those of each character. A mesh that several characters are on, such as
/// hair and brows that a host keeps apart, counts once.
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

/// Brows, lashes and beard of heads that are fewer pixels across are left out of a crowd.
const FACE: f32 = 24.0;

impl CrowdBudget {
    /// Chooses the next frame's levels without regard to those of the last.
    pub fn choose_anew(&mut self) {
        self.chosen = Chosen::default();
    }

    fn choose(&mut self, camera: &Camera, characters: &mut [&mut Character]) {
        let foci: Vec<_> = characters.iter().map(|character| character.focus_drawn()).collect();
        let mut all = Vec::new();
        let mut owners = Vec::new();
        for (i, character) in characters.iter_mut().enumerate() {
            let head = character.head_drawn();
            all.push((&mut character.hair, head));
            owners.push(Some(i));
            let is_small = all[all.len() - 1].0.lod.seen(camera, &head).size < FACE;
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
        // The light of a zone is held once for each character.
        let light = |groom: usize, bias: f32| {
            owners[groom].map_or(0, |i| Zone::seen(foci[i], camera, bias, Vec::new(), Vec::new()).bytes())
        };
        let held = Held { vertex: Held::BY_TILES, head: &light };
        let before = (!self.chosen.heads.is_empty()).then_some(self.chosen.bias);
        self.chosen = self.budget.look_from(&self.costs, camera, &mut all, before, &held);
        for character in characters {
            character.bias = self.chosen.bias;
        }
    }
}

impl Character {
    /// The head's pose in the space that it is drawn in.
    pub(super) fn head_drawn(&self) -> Pose {
        self.drawn(&self.head)
    }

    /// [`focus`](Character::focus) in the space that the character is drawn in.
    pub(super) fn focus_drawn(&self) -> crate::light::Sphere {
        let focus = self.focus();
        let center = Pose { translation: focus.center, ..Pose::IDENTITY };
        crate::light::Sphere { center: self.drawn(&center).translation, ..focus }
    }
}
