//! The plugin.

use crate::{
    GlobalHairWind, Hair3d, HairGroom, HairGroomLoader, HairSupport, NoHair,
    extract::{Scene, extract_hair, extract_light},
    render,
};
use bevy::{
    camera::Hdr,
    core_pipeline::schedule::{Core3d, Core3dSystems},
    prelude::*,
    render::{
        ExtractSchedule, GpuResourceAppExt, Render, RenderApp, RenderSystems,
        renderer::{RenderDevice, RenderGraph, RenderGraphSystems},
        view::prepare_view_targets,
    },
};
use tresses::{ViewOptions, renderer::Renderer};

/// Adds hair to an app. Add it after [`DefaultPlugins`].
#[derive(Clone, Debug)]
pub struct TressesPlugin {
    /// Rendering options of cameras without a [`HairView`](crate::HairView). Their `output` is ignored. [Depth
    /// peeling](tresses::renderer::ClassicCoverage::DepthPeeling) is not supported.
    pub view: ViewOptions,
    /// Strength of the shadows that hair casts on meshes, 0 (none) to 1, in lights with `shadow_maps_enabled`. A
    /// screen-space pass darkens meshes up to 2.5 m behind the hair by the fraction of the light that hair blocks. It
    /// also darkens light from other sources, such as emission, and surfaces below the one that receives the shadow.
    pub casts: f32,
}

impl Default for TressesPlugin {
    /// Returns tiles for all strands, with full shadows.
    fn default() -> Self {
        // The sample count is for meshes that the view draws; here Bevy draws them.
        Self { view: ViewOptions { renderer: Renderer::tiles(1), ..ViewOptions::default() }, casts: 1.0 }
    }
}

impl Plugin for TressesPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<HairGroom>()
            .init_asset_loader::<HairGroomLoader>()
            .init_resource::<GlobalHairWind>()
            .add_systems(PostUpdate, widen_range);
    }

    fn finish(&self, app: &mut App) {
        let limits = app.world().get_resource::<RenderDevice>().map(RenderDevice::limits);
        let can = limits.as_ref().is_some_and(|limits| limits.max_compute_workgroups_per_dimension > 0);
        app.insert_resource(HairSupport(can));
        let Some(app) = app.get_sub_app_mut(RenderApp).filter(|_| can) else {
            match limits {
                None => warn!(
                    "TressesPlugin found no renderer, so hair is not drawn: add it after DefaultPlugins"
                ),
                Some(_) => {
                    warn!("the adapter has no compute shaders, so hair is not drawn: show cards instead")
                }
            }
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

/// Adds [`Hdr`] to cameras that see hair. Hair is drawn before tone mapping, which only HDR cameras do in a separate
/// pass.
fn widen_range(
    mut commands: Commands,
    hair: Query<(), With<Hair3d>>,
    cameras: Query<Entity, (With<Camera3d>, Without<Hdr>, Without<NoHair>)>,
) {
    if hair.is_empty() {
        return;
    }
    for camera in &cameras {
        info!("adding Hdr to camera {camera}, which hair needs; add NoHair to the camera to prevent this");
        commands.entity(camera).insert(Hdr);
    }
}
