//! Draws hair into a camera.
//!
//! Hair is drawn after Bevy's main pass, when the scene's depth is complete, and before bloom and tone mapping, which
//! thus apply to hair. Hair is blended over the resolved color of the main pass, and occluded per depth sample
//! ([`HostFrame`]).

use super::{
    HairContext, Wardrobe,
    overlays::{OverlayTargets, Overlays},
    shadows::LightShadows,
    simulate::camera,
    skies::Skies,
};
use crate::{
    error_log::ErrorLog,
    extract::{Scene, SceneCamera},
    lights,
};
use bevy::{
    camera::MainPassResolutionOverride,
    core_pipeline::prepass::ViewPrepassTextures,
    ecs::entity::EntityHashMap,
    prelude::*,
    render::{
        camera::ExtractedCamera,
        renderer::{RenderContext, ViewQuery},
        sync_world::MainEntity,
        view::{ExtractedView, ViewDepthStencilTexture, ViewTarget},
    },
};
use tresses::{
    Camera, Character, Compositor, Context, HostFrame, Picture, Result, View, ViewOptions,
    renderer::Renderer,
    wgpu::{self, TextureFormat, TextureUsages},
};

/// Rendering options of cameras without a [`HairView`](crate::HairView).
#[derive(Resource, Clone, Copy, Debug)]
pub(crate) struct DefaultView {
    pub options: ViewOptions,
    /// Strength of the shadows that hair casts on meshes.
    pub casts: f32,
}

/// Views of all cameras, by entity in the main world.
#[derive(Resource, Debug, Default)]
pub(crate) struct CameraViews(EntityHashMap<CameraView>);

#[derive(Debug)]
struct CameraView {
    view: View,
    embed: Compositor,
    format: TextureFormat,
    /// Created when the camera first needs them.
    overlays: Option<Overlays>,
}

impl CameraViews {
    /// Returns the view of a camera for these options, size and format, recreated or resized if they have changed.
    fn get(
        &mut self,
        camera: Entity,
        context: &Context,
        options: &ViewOptions,
        (size, format): ([u32; 2], TextureFormat),
    ) -> Result<&mut CameraView> {
        let fits = |kept: &CameraView| (kept.view.options(), kept.format) == (options, format);
        if !self.0.get(&camera).is_some_and(fits) {
            let view = View::new(context, options, size, 1)?;
            let embed = Compositor::new(context, options.renderer, format)?;
            self.0.insert(camera, CameraView { view, embed, format, overlays: None });
        }
        let kept = self.0.get_mut(&camera).expect("it has just been put there");
        if kept.view.targets().size != size {
            kept.view.resize(size, 1)?;
        }
        Ok(kept)
    }
}

/// Makes depth textures readable for cameras that see hair, and drops the views of removed cameras.
pub(crate) fn read_depth(
    scene: Res<Scene>,
    mut views: ResMut<CameraViews>,
    mut cameras: Query<(MainEntity, &mut Camera3d)>,
) {
    views.0.retain(|camera, _| scene.cameras.contains_key(camera));
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

type CameraQuery<'a> = (
    &'a ExtractedView,
    &'a ExtractedCamera,
    &'a ViewTarget,
    &'a ViewDepthStencilTexture,
    Option<&'a ViewPrepassTextures>,
    Has<MainPassResolutionOverride>,
);

/// Draws the hair that this camera sees.
pub(crate) fn draw(
    query: ViewQuery<CameraQuery<'static>>,
    scene: Res<Scene>,
    wardrobe: Res<Wardrobe>,
    mut views: ResMut<CameraViews>,
    default: Res<DefaultView>,
    (shadows, skies): (LightShadows<'_, '_>, Res<Skies>),
    tresses: Res<HairContext>,
    mut errors: Local<ErrorLog>,
    mut context: RenderContext,
) {
    let (extracted, bevy_camera, target, depth, prepass, is_scaled) = query.into_inner();
    let entity = extracted.retained_view_entity.main_entity.entity();
    let Some(scene_camera) = scene.cameras.get(&entity) else { return };
    // A new camera becomes HDR in the next frame.
    if !bevy_camera.hdr {
        return;
    }
    let characters: Vec<_> = wardrobe.visible(&scene, &scene_camera.layers).collect();
    if characters.is_empty() || extracted.viewport.z.min(extracted.viewport.w) == 0 {
        return;
    }
    if is_scaled {
        errors.report(format!("camera {entity} has MainPassResolutionOverride, which hair does not support"));
        return;
    }
    let options = scene_camera.options.unwrap_or(default.options);
    // Only tiles provide depth, motion and opacity of hair.
    let is_tiled = matches!(options.renderer, Renderer::Tiles(_));
    if scene_camera.depth && !is_tiled {
        errors.report(format!("camera {entity} has HairDepth, which needs tiled hair (Renderer::Tiles)"));
    }
    if scene_camera.fog.is_some() && !is_tiled {
        errors.report(format!("the fog of camera {entity} needs tiled hair (Renderer::Tiles)"));
    }
    let (color, format) = (target.main_texture_view(), target.main_texture_format());
    let depth_view = &*depth.attachment.texture.default_view;
    let (depth_format, samples) = (depth.texture().format(), depth.texture().sample_count());
    let motion = prepass.and_then(|prepass| prepass.motion_vectors.as_ref()).map(|motion| &motion.texture);
    // No effect of Bevy reads multisampled motion vectors.
    let motion = motion.filter(|motion| motion.texture.sample_count() == 1 && is_tiled);
    let drawing = Drawing {
        characters,
        scene: &scene,
        scene_camera,
        camera: camera(extracted),
        exposure: bevy_camera.exposure,
        casts: default.casts,
        shadows: &shadows,
        skies: &skies,
        entity,
        overlays: OverlayTargets {
            motion: motion.map(|motion| (&*motion.default_view, motion.texture.format(), 1)),
            depth: (scene_camera.depth && is_tiled).then_some((depth_view, depth_format, samples)),
            fog: scene_camera.fog.filter(|_| is_tiled).map(|fog| ((&**color, format, 1), fog)),
        },
    };
    let into = HostFrame {
        origin: [extracted.viewport.x, extracted.viewport.y],
        ..HostFrame::new(color, depth_view, drawing.camera.projection)
    };
    let label = Some("hair");
    let mut encoder = tresses.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
    let view = views.get(entity, &tresses, &options, (drawing.camera.size, format));
    match view.and_then(|view| drawing.record(view, &tresses, &mut encoder, into)) {
        Ok(()) => context.add_command_buffer(encoder.finish()),
        Err(error) => errors.report(format!("cannot draw hair for camera {entity}: {error}")),
    }
}

/// Input of drawing hair into a camera.
struct Drawing<'a> {
    characters: Vec<&'a Character>,
    scene: &'a Scene,
    scene_camera: &'a SceneCamera,
    camera: Camera,
    exposure: f32,
    /// Strength of the shadows that hair casts on meshes.
    casts: f32,
    shadows: &'a LightShadows<'a, 'a>,
    skies: &'a Skies,
    /// Entity of the camera.
    entity: Entity,
    overlays: OverlayTargets<'a>,
}

impl Drawing<'_> {
    /// Draws the hair over the scene, then its overlays.
    fn record(
        &self,
        CameraView { view, embed, overlays, .. }: &mut CameraView,
        context: &Context,
        encoder: &mut wgpu::CommandEncoder,
        into: HostFrame<'_>,
    ) -> Result<()> {
        let Self { characters, scene, scene_camera, camera, exposure, .. } = self;
        let foci = Character::foci(characters, camera);
        let mut lights =
            lights::visible(&scene.lights, &scene_camera.layers, scene_camera.ambient, *exposure);
        // There is one environment per image, so evaluate probes at the nearest head.
        let around = self.skies.at(foci.nearest.center, scene_camera, &scene.probes);
        lights.environment = lights.environment.blended(1.0, &around, *exposure);
        let casts = lights.list.iter().any(|light| light.casts_shadows);
        let shadows = self.shadows.of(&lights.list, self.entity, &foci.all);
        let picture = Picture { camera: *camera, lights, ..Default::default() };
        overlays.take_if(|kept| kept.size != camera.size);
        let overlays = self
            .overlays
            .any()
            .then(|| overlays.get_or_insert_with(|| Overlays::new(context.device(), camera.size)));
        let surroundings = HostFrame {
            shadows: &shadows,
            geometry: overlays.as_ref().map(|overlays| &overlays.geometry),
            shade: if casts { self.casts } else { 0.0 },
            ..into
        };
        context.frame(encoder).composite(view, characters, &picture, embed, surroundings)?;
        if let Some(overlays) = overlays {
            overlays.record(context, encoder, &self.overlays, (into.origin, camera.projection));
        }
        Ok(())
    }
}
