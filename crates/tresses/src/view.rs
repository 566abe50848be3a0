//! A view: one camera with its GPU resources ([`View`]), its options ([`ViewOptions`]) and its per-frame inputs
//! ([`Picture`]).

use crate::{
    Context, Result,
    camera::{Camera, CameraUniform, ToneMap},
    constants::LIGHT_GROUP,
    draw::{self, Targets, targets::PICTURE_FORMAT},
    gpu::{BindBuffer, Uniform},
    light::{
        self, FrameLight, HairSet, HairShading, HairView, Lights, Part, ShadingSubset, Shadows, Sphere, Zone,
        Zones,
    },
    present::{self, Background},
    renderer::{Renderer, ShadingRate},
};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Per-frame inputs of a view: plain values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// The camera.
    pub camera: Camera,
    /// The lights.
    pub lights: Lights,
    /// Shadow settings.
    pub shadows: Shadows,
    /// The sphere that shadow maps cover.
    pub focus: Sphere,
    /// The background.
    pub background: Background,
    /// Tone mapping.
    pub tone: ToneMap,
}

/// Options of a [`View`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ViewOptions {
    /// How hair is drawn.
    pub renderer: Renderer,
    /// Maximum number of lights with shadow maps, clamped to 1 to 8. Those that give the hair the most light get them;
    /// the grid of ambient light propagates the others, at most 256. Renderers with [shading per
    /// pixel](crate::renderer::ShadingRate::PerPixel) use at most four.
    pub shadow_maps: u32,
    /// Texels along each edge of a shadow map, clamped to 4 to 2048. Deep opacity maps have a third of it, or less for
    /// soft shadows. A map takes 8.6 bytes per texel ([`View::shadow_bytes`]).
    pub shadow_resolution: u32,
    /// Texels along each edge of the strand maps, which store the strand nearest to each light; clamped to 256 to 2048,
    /// 0 for none. With them, shadows between strands follow their geometry instead of being stochastic
    /// ([`Shadows::strand_by_strand`]). Takes effect in [`ShadingModel::Fiber`](crate::renderer::ShadingModel::Fiber),
    /// when every strand is drawn and the head is near. Takes 16 bytes per texel.
    pub strand_map_resolution: u32,
    /// Cells along each edge of the grid of ambient light, clamped to 4 to 64. Takes 300
    /// bytes per cell.
    pub ambient_resolution: u32,
    /// Format of the output texture.
    pub output: wgpu::TextureFormat,
}

impl Default for ViewOptions {
    /// [Tiles](Renderer::Tiles) for strands, four samples per pixel for meshes.
    fn default() -> Self {
        Self {
            renderer: Renderer::default(),
            shadow_maps: LIGHT_GROUP,
            shadow_resolution: 1024,
            strand_map_resolution: 0,
            ambient_resolution: 24,
            output: PICTURE_FORMAT,
        }
    }
}

impl ViewOptions {
    /// Returns the default options for output textures of `format`, such as a window's.
    pub fn for_target(format: wgpu::TextureFormat) -> Self {
        Self { output: format, ..Self::default() }
    }
}

/// Vertices of a groom, and the light that shades it.
type ShadingKey = (wgpu::Buffer, Uniform);

/// GPU resources of one view: camera, lighting, render targets, and the shaded colors of each groom that it sees.
/// Record it once per submission.
#[derive(Debug)]
pub struct View {
    context: Context,
    pub(crate) draw: Arc<draw::Pipelines>,
    options: ViewOptions,
    camera: Uniform,
    /// Lighting of the view.
    pub light: light::LightState,
    targets: Targets,
    present: present::PresentState,
    zones: Zones,
    /// Shaded colors of each groom.
    shaded: Mutex<Vec<(ShadingKey, Arc<HairShading>)>>,
}

impl View {
    /// Creates a view with an image of `size` (width and height, pixels), supersampled by `ssaa` (1, 2 or 4) along each
    /// axis.
    ///
    /// # Errors
    /// As [`Targets::new`].
    pub fn new(context: &Context, options: &ViewOptions, size: [u32; 2], ssaa: u32) -> Result<Self> {
        let targets = Targets::new(context, size, options.renderer, ssaa)?;
        let camera = context.device.uniform(size_of::<CameraUniform>());
        Ok(Self {
            light: light(context, options, &camera),
            present: present::PresentState::new(context, &targets, options.renderer, options.output),
            draw: context.pipelines(),
            context: context.clone(),
            options: *options,
            shaded: Mutex::default(),
            zones: Zones::default(),
            camera,
            targets,
        })
    }

    /// Returns the options.
    pub fn options(&self) -> &ViewOptions {
        &self.options
    }

    /// Applies `options`. Recreates only the resources that they affect; pipelines stay.
    ///
    /// # Errors
    /// As [`new`](Self::new). The view is unchanged after an error.
    pub fn set_options(&mut self, options: &ViewOptions) -> Result<()> {
        let lit = |options: &ViewOptions| {
            let ViewOptions { shadow_maps, shadow_resolution, .. } = options;
            (*shadow_maps, *shadow_resolution, options.strand_map_resolution, options.ambient_resolution)
        };
        let light = (lit(options) != lit(&self.options)).then(|| light(&self.context, options, &self.camera));
        let before = std::mem::replace(&mut self.options, *options);
        let Targets { size, ssaa, .. } = self.targets;
        let drawn = |options: &ViewOptions| (options.renderer.targets(), options.output);
        if drawn(options) != drawn(&before)
            && let Err(error) = self.resize(size, ssaa)
        {
            self.options = before;
            return Err(error);
        }
        if let Some(light) = light {
            self.light = light;
            self.lock().clear();
        }
        Ok(())
    }

    /// Changes the size and supersampling of the image. The lighting stays.
    ///
    /// # Errors
    /// As [`new`](Self::new). The view is unchanged after an error.
    pub fn resize(&mut self, size: [u32; 2], ssaa: u32) -> Result<()> {
        let ViewOptions { renderer, output, .. } = self.options;
        self.targets = Targets::new(&self.context, size, renderer, ssaa)?;
        self.present = present::PresentState::new(&self.context, &self.targets, renderer, output);
        Ok(())
    }

    /// Presents the last image again into another output of the same size and any `format`, with another `background`
    /// and `tone`. The radiance in the targets is reused.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the pipeline cannot be compiled.
    pub fn present_into(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (output, format): (&wgpu::TextureView, wgpu::TextureFormat),
        (background, tone): (&Background, &ToneMap),
    ) -> Result<()> {
        let present = present::PresentState::new(&self.context, &self.targets, self.options.renderer, format);
        present.prepare(background, tone, &self.targets);
        present.record(&mut self.context.commands(encoder), &self.targets, output)
    }

    /// Whether the last image, which must have been submitted, contains all hair. With [`Renderer::Tiles`], a sudden
    /// close-up may exceed the tile lists, which leaves some tiles of its first image without hair. The lists then
    /// grow, and the image must be drawn again. Other renderers always return `true`. Views that are drawn continuously
    /// detect this on their own a few frames later.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn is_complete(&self) -> Result<bool> {
        match &self.targets.tiles {
            Some(tiles) => tiles.is_complete(&self.context).await,
            None => Ok(true),
        }
    }

    /// Returns the render targets.
    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// Returns the shaded colors of `hair` in the last image, as written by `light::shade`: one word per strand vertex
    /// ([`light::unpack_radiance`](crate::light::radiance::unpack_radiance)), or eight bytes of incident light with
    /// per-pixel shading.
    pub fn shaded(&self, hair: &HairSet) -> Option<wgpu::Buffer> {
        let shaded = self.lock();
        shaded.iter().find(|(of, _)| of.0 == *hair.strands.vertices).map(|(_, shaded)| shaded.colors.clone())
    }

    /// Returns a shader for selected segments of `hair`: those whose bit is set in `visible`, indexed by their first
    /// vertex (`light::LightState::shade_chosen`). Valid while the view's options stay the same.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn shading_subset(&self, hair: &HairSet, visible: &wgpu::Buffer) -> Result<ShadingSubset> {
        let of = (&*hair.strands.vertices, &self.light.lights);
        let shaded = self.lock().iter().find(|(known, _)| (&known.0, &known.1) == of).map(|(_, s)| s.clone());
        let shaded = match shaded {
            Some(shaded) => shaded,
            None => self.hair_shadings(&[hair], &[&self.light], ShadingRate::PerVertex)?.remove(0),
        };
        ShadingSubset::new(&self.context, (&self.light, &self.camera), hair, &shaded, visible.entire())
    }

    /// Sets the lighting zones from the next image on. Grooms and bodies in a zone are lit by it, all others by the
    /// lighting around [`Picture::focus`]. An empty slice removes all zones. [Debug
    /// views](crate::frame::ViewContent::Inside) ignore zones.
    pub fn set_zones(&mut self, zones: &[Zone]) {
        self.zones.set(&self.context, &self.camera, self.options.shadow_maps, zones);
    }

    /// Adapts the resolution of the lighting to the size of the grooms and bodies in `picture`: full resolution, or
    /// less if they cover few pixels. `coarser` is a bias in octaves: the lighting then suits an image of that much
    /// lower resolution. `counts` are the numbers of grooms and bodies. Call it before each image, as an alternative
    /// to [`set_zones`](Self::set_zones).
    pub fn fit_light(&mut self, (picture, coarser): (&Picture, f32), counts: [usize; 2]) {
        let finest = [self.options.shadow_resolution, self.options.ambient_resolution];
        let Picture { focus, camera, .. } = picture;
        let zone = Zone::far(*focus, (camera, coarser), finest, self.zones.first(), counts);
        self.set_zones(zone.as_slice());
    }

    /// Returns the GPU memory of the lighting of all zones, bytes.
    pub fn zone_bytes(&self) -> u64 {
        self.zones.bytes()
    }

    /// Returns the bind group of the view's lighting, with the layout [`light_layout`](Self::light_layout), for scene
    /// shaders that sample the shadow of the hair ([`wgsl`](crate::draw::embed::shade::wgsl)). It
    /// excludes hair in zones ([`set_zones`](Self::set_zones), [`fit_light`](Self::fit_light)).
    /// [`set_options`](Self::set_options) may replace it.
    pub fn light_group(&self) -> &wgpu::BindGroup {
        &self.light.frame
    }

    /// Returns the layout of [`light_group`](Self::light_group), for the caller's pipelines.
    pub fn light_layout(context: &Context) -> wgpu::BindGroupLayout {
        context.pipelines::<light::Pipelines>().frame.clone()
    }

    /// Returns the GPU memory of the shadow maps, bytes.
    pub fn shadow_bytes(&self) -> u64 {
        self.light.shadow_bytes()
    }

    /// Returns the GPU memory of ambient light, bytes.
    pub fn ambient_bytes(&self) -> u64 {
        self.light.ambient_bytes()
    }

    /// Returns the GPU memory of the shaded colors of all grooms, bytes.
    pub fn shaded_bytes(&self) -> u64 {
        self.lock().iter().map(|(_, shaded)| shaded.bytes()).sum()
    }

    fn lock(&self) -> MutexGuard<'_, Vec<(ShadingKey, Arc<HairShading>)>> {
        // The list stays consistent if a holder panics.
        self.shaded.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Marks the lighting of these parts as recorded.
    pub(crate) fn mark_light_recorded(&self, parts: &[Part<'_>]) {
        self.zones.mark_recorded(parts);
    }

    /// Divides the grooms and bodies of an image into parts with a common lighting.
    pub(crate) fn parts(&self, focus: Sphere, counts: [usize; 2], zoned: bool) -> Vec<Part<'_>> {
        Zones::parts(zoned.then_some(&self.zones), (&self.light, focus), counts)
    }

    /// Returns this view's buffers for each of `hair`, shaded by the respective one of `lights`. Reuses existing ones,
    /// creates the missing ones and drops those no longer needed.
    pub(crate) fn hair_shadings(
        &self,
        hair: &[&HairSet],
        lights: &[&light::LightState],
        rate: ShadingRate,
    ) -> Result<Vec<Arc<HairShading>>> {
        let mut known = self.lock();
        let mut before = std::mem::take(&mut *known);
        let shadings = hair.iter().zip(lights).map(|(set, light)| {
            let of = ((*set.strands.vertices).clone(), light.lights.clone());
            // The same hair may be listed twice.
            let again = || known.iter().find(|(known, _)| *known == of).map(|(_, shaded)| shaded.clone());
            let kept = before.iter().position(|(other, _)| *other == of).map(|i| before.swap_remove(i).1);
            let shaded = match kept.or_else(again).filter(|shaded| shaded.holds(set, rate)) {
                Some(shaded) => shaded,
                None => Arc::new(HairShading::new(&self.context, light, &self.camera, set, rate)?),
            };
            known.push((of, shaded.clone()));
            Ok(shaded)
        });
        shadings.collect()
    }

    /// Writes the uniforms of a frame, in which at most `max_maps` lights have shadow maps. Returns what to record of
    /// each part's lighting.
    ///
    /// # Errors
    /// As [`Lights::check`].
    pub(crate) fn prepare(
        &self,
        picture: &Picture,
        hair: &[HairView<'_>],
        parts: &[Part<'_>],
        max_maps: u32,
    ) -> Result<Vec<FrameLight>> {
        picture.lights.check()?;
        let camera = picture.camera.uniform(self.targets.samples, self.targets.ssaa);
        self.camera.write(0, bytemuck::bytes_of(&camera));
        self.present.prepare(&picture.background, &picture.tone, &self.targets);
        let renderer = self.options.renderer;
        let mut first = 0;
        for hair_view in hair {
            hair_view.shaded.prepare(hair_view.hair, renderer.shading(), first);
            first += hair_view.hair.strands.count;
        }
        let lit = |part: &Part<'_>| {
            let lights = (&picture.lights, &picture.shadows, &part.focus);
            let hair = Part::select(&part.hair, hair);
            let mut lit = part.light.prepare(lights, (renderer, max_maps), &hair, part.number);
            lit.ambient &= part.updates_ambient;
            lit
        };
        let lit = parts.iter().map(lit).collect();
        // Kernels over the hair of all zones are recorded with the view's own light.
        self.light.set_near_lights(parts.iter().any(|part| part.light.has_near_lights()));
        Ok(lit)
    }

    /// Returns the camera's uniform buffer.
    pub(crate) fn eye(&self) -> &Uniform {
        &self.camera
    }

    /// Returns the stage that resolves and tone-maps the image.
    pub(crate) fn present(&self) -> &present::PresentState {
        &self.present
    }
}

fn light(context: &Context, options: &ViewOptions, camera: &Uniform) -> light::LightState {
    let sizes = [options.shadow_resolution, options.ambient_resolution];
    light::LightState::new(context, sizes, [options.shadow_maps, options.strand_map_resolution], camera)
}
