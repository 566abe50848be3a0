//! The plugin.

use crate::{
    GlobalHairWind, Hair3d, HairGroom, HairGroomLoader, NoHair,
    extract::{Scene, extract_hair, extract_light},
    render,
};
use bevy::{
    camera::Hdr,
    core_pipeline::schedule::{Core3d, Core3dSystems},
    prelude::*,
    render::{
        ExtractSchedule, GpuResourceAppExt, Render, RenderApp, RenderSystems,
        renderer::{RenderGraph, RenderGraphSystems},
        view::prepare_view_targets,
    },
};
use tresses::view::ViewOptions;

/// Hair, for an app with Bevy's renderer: after [`DefaultPlugins`].
#[derive(Clone, Debug)]
pub struct TressesPlugin {
    /// How cameras draw hair that have no [`HairView`](crate::HairView) of their own. Its `output` is without effect. Hair
    /// cannot be [peeled](tresses::draw::Coverage::DepthPeeling) here.
    pub view: ViewOptions,
    /// How much of its shadow hair casts on meshes, 0 (none) to 1, in lights with `shadow_maps_enabled`: their colour is
    /// darkened by what hair keeps of the lights that light it, to 2.5 m behind it. What does not come of those, as
    /// emission, is darkened alike, and so is what is behind a floor.
    pub casts: f32,
}

impl Default for TressesPlugin {
    /// All strands in order, tile by tile, with all of their shadow.
    fn default() -> Self {
        // The samples of a view are those of meshes, which Bevy draws itself.
        Self { view: ViewOptions { samples: 1, ..ViewOptions::default() }, casts: 1.0 }
    }
}

impl Plugin for TressesPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<HairGroom>()
            .init_asset_loader::<HairGroomLoader>()
            .init_resource::<GlobalHairWind>()
            .add_systems(PostUpdate, widen_range);
        let Some(app) = app.get_sub_app_mut(RenderApp) else {
            warn!(
                "there is no renderer, so there is no hair to be seen: add TressesPlugin after DefaultPlugins"
            );
            return;
        };
        app.init_resource::<Scene>()
            .init_gpu_resource::<render::HairContext>()
            .init_gpu_resource::<render::Wardrobe>()
            .init_gpu_resource::<render::CameraViews>()
            .init_gpu_resource::<render::Skies>()
            .insert_resource(render::DefaultView { options: self.view, casts: self.casts })
            .add_systems(ExtractSchedule, (extract_hair, extract_light).chain())
            .add_systems(
                Render,
                (
                    render::read_depth.after(prepare_view_targets).in_set(RenderSystems::PrepareViews),
                    (render::prepare, render::measure_skies).in_set(RenderSystems::PrepareResources),
                ),
            )
            .add_systems(RenderGraph, render::simulate.in_set(RenderGraphSystems::Begin))
            .add_systems(
                Core3d,
                render::draw.after(Core3dSystems::MainPass).before(Core3dSystems::EarlyPostProcess),
            );
    }
}

/// Hair is drawn before tone mapping, which only cameras with [`Hdr`] do apart from the meshes.
fn widen_range(
    mut commands: Commands,
    hair: Query<(), With<Hair3d>>,
    cameras: Query<Entity, (With<Camera3d>, Without<Hdr>, Without<NoHair>)>,
) {
    if hair.is_empty() {
        return;
    }
    for camera in &cameras {
        info!("camera {camera} gets the component Hdr, as hair needs it; NoHair keeps it as it is");
        commands.entity(camera).insert(Hdr);
    }
}
