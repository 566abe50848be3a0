//! A view: one camera's eye on hair and bodies. What it has on the GPU ([`View`]), how that is made
//! ([`ViewOptions`]), and what a frame shows in it ([`Picture`]).

use crate::{
    Context, Result,
    camera::{Camera, CameraUniform, ToneMap},
    draw::{self, Coverage, Targets, targets::PICTURE_FORMAT},
    gpu::bindings,
    light::{
        self, Chosen, HairSet, Lights, Lit, Part, Seen, Shaded, ShadingRate, Shadows, Sphere, Zone, Zones,
    },
    present::{self, Background},
};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What a frame shows in a view; plain values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Picture {
    /// Who looks.
    pub camera: Camera,
    /// The lights.
    pub lights: Lights,
    /// How shadows are made.
    pub shadows: Shadows,
    /// What the shadow maps cover.
    pub focus: Sphere,
    /// Where hair is shaded.
    pub shading: ShadingRate,
    /// What is behind everything.
    pub background: Background,
    /// From linear radiance to the picture.
    pub tone: ToneMap,
}

/// How a [`View`] is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ViewOptions {
    /// Samples per pixel: 1, 4, 8 or 16, as the adapter offers and [`Coverage::check`] allows.
    pub samples: u32,
    /// How strands cover pixels.
    pub coverage: Coverage,
    /// Texels along each edge of a shadow map, brought into 4 to 2048; of a deep opacity map a third,
    /// or fewer where shadows are to be soft. Five maps take 43 bytes per texel ([`View::shadow_bytes`]).
    pub shadow_resolution: u32,
    /// Texels along each edge of a map of each light that knows the strand nearest it, brought into 256 to 2048; 0 for
    /// none. An option of quality: strands are then in each other's light or shade as they lie, not by chance
    /// ([`Shadows::strand_by_strand`]), where deep opacity maps are used, each strand is drawn and a head is not far
    /// away. A texel takes 16 bytes.
    pub strand_map: u32,
    /// Cells along each edge of the grid of ambient light, brought into 4 to 64
    /// ([`crate::light::ambient`]); each takes 300 bytes.
    pub ambient_cells: u32,
    /// Format of what `present` writes to.
    pub output: wgpu::TextureFormat,
}

impl Default for ViewOptions {
    /// Strands by [tiles](Coverage::Tiles), meshes with four samples per pixel.
    fn default() -> Self {
        Self {
            samples: 4,
            coverage: Coverage::default(),
            shadow_resolution: 1024,
            strand_map: 0,
            ambient_cells: 24,
            output: PICTURE_FORMAT,
        }
    }
}

impl ViewOptions {
    /// The default options for a view that is presented into textures of `format`, such as a window's.
    pub fn for_target(format: wgpu::TextureFormat) -> Self {
        Self { output: format, ..Self::default() }
    }
}

/// What one view has on the GPU: its camera, its light, its targets, and the colours of each groom that it sees.
/// Record it once per submission.
#[derive(Debug)]
pub struct View {
    context: Context,
    pub(crate) draw: Arc<draw::Pipelines>,
    options: ViewOptions,
    camera: wgpu::Buffer,
    /// Its light.
    pub light: light::State,
    targets: Targets,
    present: present::State,
    zones: Zones,
    /// By the strands that they are of and the light that they are in.
    shaded: Mutex<Vec<([wgpu::Buffer; 2], Arc<Shaded>)>>,
}

impl View {
    /// A view with a picture of `size` (width and height, pixels), supersampled by `ssaa` (1, 2 or 4) along each
    /// axis.
    ///
    /// # Errors
    /// As [`Targets::new`].
    pub fn new(context: &Context, options: &ViewOptions, size: [u32; 2], ssaa: u32) -> Result<Self> {
        let targets = Targets::new(context, size, (options.samples, options.coverage), ssaa)?;
        let camera = bindings::uniform(&context.device, "camera", size_of::<CameraUniform>());
        Ok(Self {
            light: light(context, options, &camera),
            present: present::State::new(context, &targets, options.coverage, options.output),
            draw: context.pipelines(),
            context: context.clone(),
            options: *options,
            shaded: Mutex::default(),
            zones: Zones::default(),
            camera,
            targets,
        })
    }

    /// How it was made.
    pub fn options(&self) -> &ViewOptions {
        &self.options
    }

    /// Becomes as if made with `options`; what they do not concern stays as it is, pipelines in any case.
    ///
    /// # Errors
    /// As [`new`](Self::new); then nothing has changed.
    pub fn set_options(&mut self, options: &ViewOptions) -> Result<()> {
        let lit =
            |options: &ViewOptions| (options.shadow_resolution, options.strand_map, options.ambient_cells);
        let light = (lit(options) != lit(&self.options)).then(|| light(&self.context, options, &self.camera));
        let before = std::mem::replace(&mut self.options, *options);
        let Targets { size, ssaa, .. } = self.targets;
        let drawn = |options: &ViewOptions| (options.samples, options.coverage, options.output);
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

    /// Pictures of another size, or of as many more pixels along each axis, from here on; the light stays.
    ///
    /// # Errors
    /// As [`new`](Self::new); then nothing has changed.
    pub fn resize(&mut self, size: [u32; 2], ssaa: u32) -> Result<()> {
        let ViewOptions { samples, coverage, output, .. } = self.options;
        self.targets = Targets::new(&self.context, size, (samples, coverage), ssaa)?;
        self.present = present::State::new(&self.context, &self.targets, coverage, output);
        Ok(())
    }

    /// Records what the targets hold of the last picture into another output of the same size, of any `format`, before
    /// `background` and with `tone`: the same radiance, shown otherwise.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the pipeline for it cannot be made.
    pub fn present_into(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        (output, format): (&wgpu::TextureView, wgpu::TextureFormat),
        (background, tone): (&Background, &ToneMap),
    ) -> Result<()> {
        let present = present::State::new(&self.context, &self.targets, self.options.coverage, format);
        present.prepare(&self.context, background, tone, &self.targets);
        present.record(&mut self.context.commands(encoder), &self.targets, output)
    }

    /// Whether the last picture, which has been submitted, holds all of the hair. Where hair is
    /// [drawn by tiles](Coverage::Tiles), a close-up may need lists so much longer than those before it that some
    /// tiles of the first picture stay without hair; then the lists have grown, and it is to be drawn again. True
    /// of all other coverage. A view that is drawn frame by frame learns by itself, a few frames later.
    ///
    /// # Errors
    /// [`crate::Error::Gpu`] when the device is lost.
    pub async fn is_complete(&self) -> Result<bool> {
        match &self.targets.tiles {
            Some(tiles) => tiles.is_complete(&self.context).await,
            None => Ok(true),
        }
    }

    /// What it draws into.
    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// The shaded colours of `hair` in the last picture: what `light::shade` wrote, a word per strand vertex
    /// ([`light::unpack_radiance`]), or, when pixels are shaded, eight bytes of what arrives of the light.
    pub fn shaded(&self, hair: &HairSet) -> Option<wgpu::Buffer> {
        let shaded = self.lock();
        shaded.iter().find(|(of, _)| of[0] == hair.strands.vertices).map(|(_, shaded)| shaded.colors.clone())
    }

    /// What shades only what the segments of `hair` need whose bits in `seen` are set, each by the number of the vertex that it
    /// begins at ([`light::State::shade_chosen`]); for as long as the view's options stay as they are.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn chosen(&self, hair: &HairSet, seen: &wgpu::Buffer) -> Result<Chosen> {
        let of = [&hair.strands.vertices, &self.light.lights];
        let shaded = self.lock().iter().find(|(known, _)| known.each_ref() == of).map(|(_, s)| s.clone());
        let shaded = match shaded {
            Some(shaded) => shaded,
            None => self.shares(&[hair], &[&self.light], ShadingRate::PerVertex)?.remove(0),
        };
        Chosen::new(&self.context, (&self.light, &self.camera), hair, &shaded, seen.as_entire_binding())
    }

    /// From the next picture on the grooms and bodies of each zone are in its light, all others in that around
    /// [`Picture::focus`]; none takes zones away. Pictures of [the inside](crate::frame::Shows::Inside) know of no zones.
    pub fn set_zones(&mut self, zones: &[Zone]) {
        self.zones.set(&self.context, &self.camera, zones);
    }

    /// From the next picture on its light is as fine as `picture` shows it, for all of `counts` grooms and bodies: as it was
    /// made, or coarser where they are few pixels across, of pictures `coarser` octaves coarser. In place of zones of
    /// one's own; before each picture.
    pub fn fit_light(&mut self, (picture, coarser): (&Picture, f32), counts: [usize; 2]) {
        let finest = [self.options.shadow_resolution, self.options.ambient_cells];
        let Picture { focus, camera, .. } = picture;
        let zone = Zone::far(*focus, (camera, coarser), finest, self.zones.first(), counts);
        self.set_zones(zone.as_slice());
    }

    /// Bytes of GPU memory of the light of its zones.
    pub fn zone_bytes(&self) -> u64 {
        self.zones.bytes()
    }

    /// What shaders that ask for its light bind, with [`light_layout`](Self::light_layout): those of a scene that asks hair for its
    /// shadow ([`draw::embed::shade::wgsl`](crate::draw::embed::shade::wgsl)). It is the view's own
    /// light: hair that lies in a zone ([`set_zones`](Self::set_zones), [`fit_light`](Self::fit_light)) is not in it. It
    /// is another one after [`set_options`](Self::set_options).
    pub fn light_group(&self) -> &wgpu::BindGroup {
        &self.light.frame
    }

    /// The layout of [`light_group`](Self::light_group), for pipelines of the caller.
    pub fn light_layout(context: &Context) -> wgpu::BindGroupLayout {
        context.pipelines::<light::Pipelines>().frame.clone()
    }

    /// Bytes of GPU memory of the shadow maps.
    pub fn shadow_bytes(&self) -> u64 {
        self.light.shadow_bytes()
    }

    /// Bytes of GPU memory of ambient light.
    pub fn ambient_bytes(&self) -> u64 {
        self.light.ambient_bytes()
    }

    /// Bytes of GPU memory of the shaded colours of all grooms.
    pub fn shaded_bytes(&self) -> u64 {
        self.lock().iter().map(|(_, shaded)| shaded.bytes()).sum()
    }

    fn lock(&self) -> MutexGuard<'_, Vec<([wgpu::Buffer; 2], Arc<Shaded>)>> {
        // What a panic leaves behind is whole.
        self.shaded.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The light of these parts is recorded.
    pub(crate) fn made(&self, parts: &[Part<'_>]) {
        self.zones.made(parts);
    }

    /// What a picture of so many grooms and bodies is lit by.
    pub(crate) fn parts(&self, focus: Sphere, counts: [usize; 2], zoned: bool) -> Vec<Part<'_>> {
        Zones::parts(zoned.then_some(&self.zones), (&self.light, focus), counts)
    }

    /// Its share of `hair`, each in the light of `lights`, made for those that it has not seen so, and let go of those that
    /// are not among them.
    pub(crate) fn shares(
        &self,
        hair: &[&HairSet],
        lights: &[&light::State],
        rate: ShadingRate,
    ) -> Result<Vec<Arc<Shaded>>> {
        let mut known = self.lock();
        let mut before = std::mem::take(&mut *known);
        let shares = hair.iter().zip(lights).map(|(set, light)| {
            let of = [set.strands.vertices.clone(), light.lights.clone()];
            // Hair may be drawn twice.
            let again = || known.iter().find(|(known, _)| *known == of).map(|(_, shaded)| shaded.clone());
            let kept = before.iter().position(|(other, _)| *other == of).map(|i| before.swap_remove(i).1);
            let shaded = match kept.or_else(again).filter(|shaded| shaded.holds(set, rate)) {
                Some(shaded) => shaded,
                None => Arc::new(Shaded::new(&self.context, light, &self.camera, set, rate)?),
            };
            known.push((of, shaded.clone()));
            Ok(shaded)
        });
        shares.collect()
    }

    /// Writes the values of a frame: what of each part's light is to be recorded.
    pub(crate) fn prepare(&self, picture: &Picture, hair: &[Seen<'_>], parts: &[Part<'_>]) -> Vec<Lit> {
        let camera = picture.camera.uniform(self.targets.samples, self.targets.ssaa);
        self.context.queue.write_buffer(&self.camera, 0, bytemuck::bytes_of(&camera));
        self.present.prepare(&self.context, &picture.background, &picture.tone, &self.targets);
        let mut first = 0;
        for seen in hair {
            seen.shaded.prepare(&self.context, seen.hair, first);
            first += seen.hair.strands.count;
        }
        let lit = |part: &Part<'_>| {
            let lights = (&picture.lights, &picture.shadows, &part.focus);
            let mut lit = part.light.prepare(&self.context, lights, &Part::of(&part.hair, hair), part.number);
            lit.ambient &= part.fresh;
            lit
        };
        parts.iter().map(lit).collect()
    }

    /// The uniform of its camera.
    pub(crate) fn eye(&self) -> &wgpu::Buffer {
        &self.camera
    }

    /// What finishes its pictures.
    pub(crate) fn present(&self) -> &present::State {
        &self.present
    }
}

fn light(context: &Context, options: &ViewOptions, camera: &wgpu::Buffer) -> light::State {
    let sizes = [options.shadow_resolution, options.ambient_cells];
    light::State::new(context, sizes, options.strand_map, camera)
}
