//! Hair is drawn into a camera.
//!
//! After Bevy's main pass, so that the scene's depth is complete, and before what Bevy does to the finished picture: bloom
//! and tone mapping see hair as everything else. Hair goes over the colour of one sample per pixel that the main pass has
//! left, hidden by all the depths that it has left of each pixel ([`Surroundings`]).

use super::{
    Complaints, Wardrobe,
    known::{Known, Targets},
    living::Living,
    prepare::{Worn, seen},
    shadows::LightShadows,
    simulate::camera,
    skies::Skies,
};
use crate::{
    extract::{Eye, Scene, SceneHair},
    lights,
};
use bevy::{
    camera::MainPassResolutionOverride,
    core_pipeline::prepass::ViewPrepassTextures,
    ecs::entity::EntityHashMap,
    prelude::*,
    render::{
        camera::ExtractedCamera,
        renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery},
        sync_world::MainEntity,
        view::{ExtractedView, ViewDepthStencilTexture, ViewTarget},
    },
};
use tresses::{
    Camera, Hair, Pipelines, Result, View,
    body::Body,
    draw::{Coverage, Embed, Shade, Surroundings},
    frame::{Recorder, Shows, Sight},
    light::{Sphere, Zone},
    view::{Picture, ViewOptions},
    wgpu::{self, TextureFormat, TextureUsages},
};

/// How cameras draw hair that do not say it.
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct DefaultView {
    pub options: ViewOptions,
    /// How much of its shadow hair casts.
    pub casts: f32,
}

/// What cameras have on the GPU, by their entities in the main world.
#[derive(Resource, Debug, Default)]
pub(crate) struct Eyes(EntityHashMap<Sees>);

#[derive(Debug)]
struct Sees {
    view: View,
    embed: Embed,
    format: TextureFormat,
    /// Where the scene wants to know where it is.
    known: Option<Known>,
}

impl Sees {
    fn new(
        device: &wgpu::Device,
        pipelines: &Pipelines,
        options: &ViewOptions,
        (size, format): ([u32; 2], TextureFormat),
    ) -> Result<Self> {
        let view = View::new(device, pipelines, options, size, 1)?;
        let embed = Embed::new(device, (options.samples, options.coverage), format)?;
        Ok(Self { view, embed, format, known: None })
    }
}

/// Lets hair read the depth of the cameras that see it, and forgets cameras that are gone.
pub(crate) fn read_depth(
    scene: Res<Scene>,
    mut eyes: ResMut<Eyes>,
    mut cameras: Query<(MainEntity, &mut Camera3d)>,
) {
    eyes.0.retain(|camera, _| scene.cameras.contains_key(camera));
    if scene.hair.is_empty() {
        return;
    }
    for (entity, mut camera) in &mut cameras {
        if scene.cameras.contains_key(&entity.entity()) {
            let usages = TextureUsages::from(camera.depth_texture_usages);
            camera.depth_texture_usages = (usages | TextureUsages::TEXTURE_BINDING).into();
        }
    }
}

type Seeing<'a> = (
    &'a ExtractedView,
    &'a ExtractedCamera,
    &'a ViewTarget,
    &'a ViewDepthStencilTexture,
    Option<&'a ViewPrepassTextures>,
    Has<MainPassResolutionOverride>,
);

/// Draws the hair that this camera sees.
pub(crate) fn draw(
    seeing: ViewQuery<Seeing<'static>>,
    scene: Res<Scene>,
    wardrobe: Res<Wardrobe>,
    mut eyes: ResMut<Eyes>,
    usual: Res<DefaultView>,
    shadows: LightShadows<'_, '_>,
    skies: Res<Skies>,
    (device, queue): (Res<RenderDevice>, Res<RenderQueue>),
    mut complaints: Local<Complaints>,
    mut context: RenderContext,
) {
    let (extracted, bevy_camera, target, depth, prepass, scaled) = seeing.into_inner();
    let entity = extracted.retained_view_entity.main_entity.entity();
    let (Some(eye), Some(pipelines)) = (scene.cameras.get(&entity), wardrobe.pipelines()) else { return };
    // A camera that has just come gets its wide range for the next frame.
    if !bevy_camera.hdr {
        return;
    }
    let seen: Vec<_> = seen(&scene, &wardrobe, &eye.layers).collect();
    if seen.is_empty() || extracted.viewport.z.min(extracted.viewport.w) == 0 {
        return;
    }
    if scaled {
        complaints
            .say(format!("camera {entity} draws at another resolution than it shows, which hair cannot"));
        return;
    }
    let camera = camera(extracted);
    let options = eye.options.unwrap_or(usual.options);
    let device = device.wgpu_device();
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("hair") });
    let into = Surroundings {
        origin: [extracted.viewport.x, extracted.viewport.y],
        ..Surroundings::new(
            target.main_texture_view(),
            &depth.attachment.texture.default_view,
            camera.projection,
        )
    };
    let recorder =
        Recorder { pipelines: &pipelines, device, queue: &queue, encoder: &mut encoder, timings: None };
    let exposure = bevy_camera.exposure;
    // Tiles alone know where hair is. Motion of several samples in each pixel, which nothing that needs it has, is not told.
    let tiled = options.coverage == Coverage::Tiles;
    if eye.depth && !tiled {
        complaints.say(format!("camera {entity} has HairDepth, which only hair drawn by tiles can give"));
    }
    let vectors = prepass.and_then(|prepass| prepass.motion_vectors.as_ref()).map(|of| &of.texture);
    let vectors = vectors.filter(|of| of.texture.sample_count() == 1 && tiled);
    let own_depth = (eye.depth && tiled).then(|| depth.texture());
    if eye.fog.is_some() && !tiled {
        complaints.say(format!("the fog of camera {entity} reaches only hair that is drawn by tiles"));
    }
    let picture = (target.main_texture_view(), target.main_texture_format());
    let targets = Targets {
        fog: eye.fog.filter(|_| tiled).map(|fog| (&**picture.0, picture.1, fog)),
        motion: vectors.map(|of| (&*of.default_view, of.texture.format())),
        depth: own_depth
            .map(|of| (&*depth.attachment.texture.default_view, (of.format(), of.sample_count()))),
    };
    let drawing = Drawing {
        scene: &scene,
        eye,
        seen: &seen,
        camera,
        exposure,
        casts: usual.casts,
        shadows: &shadows,
        skies: &skies,
        entity,
    };
    let made = eyes.sees(entity, device, &pipelines, &options, (camera.size, target.main_texture_format()));
    match made.and_then(|sees| drawing.record(sees, recorder, into, targets)) {
        Ok(()) => context.add_command_buffer(encoder.finish()),
        Err(error) => complaints.say(format!("camera {entity} cannot show hair: {error}")),
    }
}

impl Eyes {
    /// What a camera has, made or brought to this size where it is not so.
    fn sees(
        &mut self,
        camera: Entity,
        device: &wgpu::Device,
        pipelines: &Pipelines,
        options: &ViewOptions,
        of: ([u32; 2], TextureFormat),
    ) -> Result<&mut Sees> {
        let fits = |sees: &Sees| (sees.view.options(), sees.format) == (options, of.1);
        if !self.0.get(&camera).is_some_and(fits) {
            self.0.insert(camera, Sees::new(device, pipelines, options, of)?);
        }
        let sees = self.0.get_mut(&camera).expect("it has just been put there");
        if sees.view.targets().size != of.0 {
            sees.view.resize(device, of.0, 1)?;
        }
        Ok(sees)
    }
}

/// What a camera draws.
struct Drawing<'a> {
    scene: &'a Scene,
    eye: &'a Eye,
    seen: &'a [(&'a SceneHair, &'a Worn)],
    camera: Camera,
    exposure: f32,
    shadows: &'a LightShadows<'a, 'a>,
    skies: &'a Skies,
    /// How much of its shadow hair casts.
    casts: f32,
    /// The camera.
    entity: Entity,
}

impl Drawing<'_> {
    /// Draws the hair into a scene, and where it is into what `targets` the scene has for that.
    fn record(
        &self,
        sees: &mut Sees,
        mut recorder: Recorder<'_>,
        into: Surroundings<'_>,
        targets: Targets<'_>,
    ) -> Result<()> {
        let (zones, focus) = self.zones();
        sees.view.set_zones(recorder.device, recorder.pipelines, &zones);
        let Self { scene, eye, .. } = self;
        let (mut lights, of, casts) =
            lights::at(focus.center, &scene.lights, &eye.layers, eye.ambient, self.exposure);
        let around = self.skies.at(focus.center, eye, &scene.probes);
        lights.environment = lights.environment.blended(1.0, &around, self.exposure);
        let picture = Picture { camera: self.camera, lights, focus, ..Default::default() };
        let hair: Vec<&Hair> = self.seen.iter().map(|(_, worn)| &worn.hair).collect();
        let (bodies, _) = self.bodies();
        let heads: Vec<_> =
            if zones.is_empty() { vec![focus] } else { zones.iter().map(|zone| zone.focus).collect() };
        let shadows = self.shadows.of(&of, self.entity, &heads);
        let (device, size) = (recorder.device, self.camera.size);
        let known = targets.any().then(|| Known::of(&mut sees.known, device, size, &targets));
        let geometry = known.map(|known| &known.view);
        let shade = Shade { strength: self.casts, lights: casts, ..Default::default() };
        let shade = casts.contains(&true).then_some(shade);
        let into = Surroundings { shadows: &shadows, geometry, shade, ..into };
        let sight = Sight { shows: Shows::Over(&sees.embed, into), ..Sight::new(&sees.view, &picture) };
        recorder.draw(&hair, &bodies, sight)?;
        if let Some(known) = known {
            let place = (into.origin, self.camera.projection);
            known.record((recorder.queue, recorder.encoder), &targets, place);
        }
        Ok(())
    }

    /// What the hair that is seen grows on, and which of it each has: of one skin, that hair and brows are on, once.
    fn bodies(&self) -> (Vec<&Body>, Vec<Option<usize>>) {
        let (mut bodies, mut skins) = (Vec::new(), Vec::new());
        let mut numbers = Vec::with_capacity(self.seen.len());
        for (_, worn) in self.seen {
            let skin = worn.living.as_ref().map(Living::entity);
            numbers.push(worn.body.as_ref().map(|body| {
                let known = skins.iter().position(|other| skin.is_some() && *other == skin);
                known.unwrap_or_else(|| {
                    bodies.push(body);
                    skins.push(skin);
                    bodies.len() - 1
                })
            }));
        }
        (bodies, numbers)
    }

    /// A zone of light for each head, where there are several, and what the nearest one covers.
    fn zones(&self) -> (Vec<Zone>, Sphere) {
        let spheres: Vec<_> = self.seen.iter().map(|(hair, worn)| reach(hair, worn)).collect();
        let heads = heads(&spheres);
        let eye = self.camera.eye();
        let away = |head: &&Head| head.focus.center.distance(eye);
        let nearest = heads.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        let focus = nearest.map_or(Sphere::default(), |head| head.focus);
        if heads.len() < 2 {
            return (Vec::new(), focus);
        }
        let (_, bodies) = self.bodies();
        let zone = |Head { focus, hair }: Head| {
            let mut on: Vec<usize> = hair.iter().filter_map(|i| bodies[*i]).collect();
            on.dedup();
            let pose = self.seen[hair[0]].0.pose;
            Zone { pose, ..Zone::seen(focus, &self.camera, 0.0, hair, on) }
        };
        (heads.into_iter().map(zone).collect(), focus)
    }
}

/// What the shadow maps of hair cover: the hair at rest, and some way that it swings. The same size in each frame.
fn reach(hair: &SceneHair, worn: &Worn) -> Sphere {
    const SWING: f32 = 1.3;
    let (middle, radius) = worn.hair.lod.sphere;
    Sphere { center: hair.pose.point(middle), radius: SWING * radius }
}

/// Grooms that are on one head.
struct Head {
    focus: Sphere,
    /// By their places in the list.
    hair: Vec<usize>,
}

/// Sorts grooms into heads: what is well inside the reach of another is on the same one, as brows and a beard are.
fn heads(spheres: &[Sphere]) -> Vec<Head> {
    let mut order: Vec<_> = (0..spheres.len()).collect();
    order.sort_by(|a, b| spheres[*b].radius.total_cmp(&spheres[*a].radius));
    let mut heads: Vec<Head> = Vec::new();
    for i in order {
        let sphere = spheres[i];
        let on = heads
            .iter_mut()
            .find(|head| head.focus.center.distance(sphere.center) < 0.75 * head.focus.radius);
        match on {
            Some(head) => {
                let reach = head.focus.center.distance(sphere.center) + sphere.radius;
                head.focus.radius = head.focus.radius.max(reach);
                head.hair.push(i);
            }
            None => heads.push(Head { focus: sphere, hair: vec![i] }),
        }
    }
    // In the order of the list, which does not change from frame to frame.
    heads.iter_mut().for_each(|head| head.hair.sort());
    heads.sort_by_key(|head| head.hair[0]);
    heads
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beard_is_on_the_head_that_has_the_hair() {
        let at = |x: f32, y: f32, radius| Sphere { center: Vec3::new(x, y, 0.0), radius };
        // A beard, hair, a second head with hair and brows.
        let spheres = [at(0.0, -0.1, 0.08), at(0.0, 0.0, 0.25), at(0.6, 0.0, 0.2), at(0.6, 0.05, 0.03)];
        let found = heads(&spheres);
        let hair: Vec<_> = found.iter().map(|head| head.hair.as_slice()).collect();
        assert_eq!(hair, [&[0, 1][..], &[2, 3]]);
        assert_eq!((found[0].focus, found[1].focus), (spheres[1], spheres[2]));
        let apart = [at(0.0, 0.0, 0.25), at(0.2, 0.0, 0.25)];
        assert_eq!(heads(&apart).len(), 2);
    }
}
