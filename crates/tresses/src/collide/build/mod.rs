//! GPU builder of signed distance fields from triangle meshes.
//!
//! ```text
//! mesh ─► tree (CPU) ─► skin ──► measure ─────► flood ───────► close ──► texel ─► tile of the atlas
//!         boxes, area   per      per voxel:     per voxel:     signed    unit gradient
//!         vectors       triangle winding,       nearest cap    distance  and distance
//!                                distance
//! ```
//!
//! The method is described in [`crate::groom::mesh::sdf`]: a point is solid where the winding number exceeds one half,
//! and distances are to the boundary of the *solid*. The boundary consists of skin (triangles with air on one side and
//! solid on the other) and caps (where the winding number passes one half without a triangle). One thread per voxel
//! queries the same tree as on the CPU. The winding number needs no stack, but follows links that skip distant nodes,
//! which count as dipoles. The distance uses a small stack, nearer child first.
//!
//! The CPU builder settles most voxels by Harnack's inequality and starts each search from a neighbor's result, which a
//! GPU cannot do. A software driver is therefore much slower than the CPU. The built-in and imported heads need
//! distances on the CPU anyway (for growth, and for the clearance of guides at rest) and are built there. Tried: a
//! common traversal for all threads of a brick, with bounds for the whole brick. It reads less memory, but visits so
//! many more triangles that it takes twice as long.
//!
//! **Caps.** Each cap is the plane through the crossings on the grid edges next to it; jump flooding spreads these
//! planes. The distance to a cap is exact near it and off by less than a cell farther away, where the CPU solves the
//! eikonal equation.
//!
//! **Only in the CPU builder:** filling cavities that no air reaches, and removing solids too small for the grid (less
//! than eight nodes). Hair reaches neither.
//!
//! **Time.** A browser stops work that takes seconds. Voxels are therefore processed in parts, each in its own
//! submission. Nothing is read back, unless [`FieldBuilder::grid`] requests the result.

use super::SolidBounds;
use crate::{
    Context, Error, Result,
    constants::BUILD_WORKGROUP,
    gpu::{BindBuffer, Kernel, bindings::constant, readback},
    groom::{
        SdfGrid,
        mesh::{Bvh, SdfOptions, TriMesh, sdf},
    },
    shaders::kernels::collide::build as kernels,
    strands::buffers::storage,
};
use bytemuck::{Pod, Zeroable};
use glam::{UVec3, Vec3};
use wgpu::util::DeviceExt;

pub use crate::groom::mesh::TreeNode;

#[cfg(test)]
mod tests;

/// Uniforms of all kernels of the builder.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(crate) struct BuildParams {
    /// Position of the first voxel, meters.
    pub origin: Vec3,
    /// Distance between voxels, meters.
    pub cell: f32,
    /// Voxels along each axis.
    pub size: UVec3,
    /// The first triangle or voxel of this dispatch.
    pub begin: u32,
    /// First texel of the field's tile in the atlas.
    pub tile: UVec3,
    /// One past the last triangle or voxel of this dispatch.
    pub end: u32,
    /// -1 for an inside-out mesh, else 1.
    pub sign: f32,
    /// Number of tree nodes.
    pub node_count: u32,
    /// Jump of the cap search, voxels; 0 initializes it.
    pub jump: u32,
    /// Unused.
    pub _pad: u32,
}

/// Voxels per submission: some hundred milliseconds on two cores of a software driver.
const PART: u32 = 1 << 16;

/// The pipelines of the builder, created once per device.
#[derive(Debug)]
pub struct FieldBuilder {
    context: Context,
    skin: Kernel,
    measure: Kernel,
    flood: Kernel,
    close: Kernel,
    texel: Kernel,
}

/// A prepared mesh: its grid, and the input of the kernels.
pub(super) struct Plan {
    /// The grid, without distances.
    pub grid: SdfGrid,
    /// Bounds of the mesh.
    pub bounds: SolidBounds,
    nodes: Vec<TreeNode>,
    corners: Vec<[f32; 4]>,
    sign: f32,
}

impl Plan {
    /// Prepares `mesh` on the grid that `options` describe.
    ///
    /// # Errors
    /// The errors of [`sdf::build`] for the mesh and the options.
    pub fn new(mesh: &TriMesh, options: &SdfOptions) -> Result<Self> {
        let (mesh, grid, inverted) = sdf::prepare(mesh, options)?;
        let (nodes, corners) = Bvh::new(&mesh).flat();
        let points = corners.iter().map(|c| Vec3::from_slice(c));
        // Field and mesh differ by less than a cell.
        let bounds = SolidBounds::around(points, 2.0 * grid.cell).unwrap_or_default();
        Ok(Self { grid, bounds, nodes, corners, sign: if inverted { -1.0 } else { 1.0 } })
    }

    fn params(&self, tile: UVec3) -> BuildParams {
        BuildParams {
            origin: self.grid.origin,
            cell: self.grid.cell,
            size: self.grid.size,
            tile,
            sign: self.sign,
            node_count: self.nodes.len() as u32,
            ..BuildParams::zeroed()
        }
    }
}

impl FieldBuilder {
    /// Creates the pipelines.
    pub fn new(context: &Context) -> Self {
        let device = &context.device;
        Self {
            context: context.clone(),
            skin: Kernel::new::<kernels::Skin>(device),
            measure: Kernel::new::<kernels::Measure>(device),
            flood: Kernel::new::<kernels::Flood>(device),
            close: Kernel::new::<kernels::Close>(device),
            texel: Kernel::new::<kernels::Texel>(device),
        }
    }

    /// Builds the field of `mesh` and reads it back, for callers that need distances on the CPU.
    ///
    /// # Errors
    /// The errors of [`sdf::build`] for the mesh and the options, [`Error::Groom`] if the mesh encloses nothing,
    /// [`Error::Limit`] and [`Error::Gpu`].
    pub async fn grid(&self, mesh: &TriMesh, options: &SdfOptions) -> Result<SdfGrid> {
        let plan = Plan::new(mesh, options)?;
        let distances = self.distances(&plan)?;
        let distances: Vec<f32> = readback::buffer(&self.context, &distances).await?;
        if !distances.iter().any(|d| *d < 0.0) {
            return Err(Error::unusable(sdf::NOTHING));
        }
        Ok(SdfGrid { distances, ..plan.grid })
    }

    /// Writes the field of `plan` into the tile of `texture` that begins at `tile`.
    ///
    /// # Errors
    /// [`Error::Limit`].
    pub(super) fn write(&self, plan: &Plan, texture: &wgpu::Texture, tile: UVec3) -> Result<()> {
        let distances = self.distances(plan)?;
        let job = Job::new(&self.context, plan, tile);
        let view = texture.create_view(&Default::default());
        job.run(&self.texel, 0, job.voxels(), |tree| {
            self.texel.bind(&kernels::Texel { tree, distances: distances.entire(), texels: &view })
        })
    }

    /// Computes the signed distances of `plan`'s voxels, meters, x fastest.
    fn distances(&self, plan: &Plan) -> Result<wgpu::Buffer> {
        let job = Job::new(&self.context, plan, UVec3::ZERO);
        let (voxels, triangles) = (job.voxels(), plan.corners.len() as u32 / 3);
        let skin = storage::<u32>(&self.context.device, "skin of a mesh", triangles.into())?;
        let measured =
            storage::<[f32; 2]>(&self.context.device, "winding numbers and distances", voxels.into())?;
        let seeds = [0, 1].map(|_| storage::<u32>(&self.context.device, "lids", voxels.into()));
        let [seeds, next] = seeds;
        let (seeds, next) = (seeds?, next?);
        let distances = storage::<f32>(&self.context.device, "distances", voxels.into())?;
        let (is_skin, measured) = (skin.entire(), measured.entire());
        job.run(&self.skin, 0, triangles, |tree| self.skin.bind(&kernels::Skin { tree, is_skin }))?;
        // In bricks of 4 x 4 x 4 voxels.
        let bricks = plan.grid.size.map(|n| n.div_ceil(4)).element_product();
        job.run(&self.measure, 0, bricks * BUILD_WORKGROUP, |tree| {
            self.measure.bind(&kernels::Measure { tree, is_skin, measured })
        })?;
        let longest = plan.grid.size.max_element().next_power_of_two();
        // Halve the jump down to one, then repeat a jump of one for seeds that larger jumps missed.
        let jumps = std::iter::successors(Some(longest / 2), |j| (*j > 1).then_some(j / 2));
        let (mut seeds, mut next) = (seeds.entire(), next.entire());
        for jump in std::iter::once(0).chain(jumps).chain([1]) {
            job.run(&self.flood, jump, voxels, |tree| {
                self.flood.bind(&kernels::Flood { tree, measured, seeds, next })
            })?;
            std::mem::swap(&mut seeds, &mut next);
        }
        job.run(&self.close, 0, voxels, |tree| {
            self.close.bind(&kernels::Close { tree, measured, seeds, distances: distances.entire() })
        })?;
        Ok(distances)
    }
}

/// Resources shared by the dispatches of one field.
struct Job<'a> {
    context: &'a Context,
    params: BuildParams,
    nodes: wgpu::Buffer,
    corners: wgpu::Buffer,
}

impl<'a> Job<'a> {
    fn new(context: &'a Context, plan: &Plan, tile: UVec3) -> Self {
        let Context { device, .. } = context;
        let buffer = |label, contents| {
            let usage = wgpu::BufferUsages::STORAGE;
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some(label),
                contents,
                usage,
            })
        };
        Self {
            context,
            params: plan.params(tile),
            nodes: buffer("mesh tree", bytemuck::cast_slice(&plan.nodes)),
            corners: buffer("mesh triangles", bytemuck::cast_slice(&plan.corners)),
        }
    }

    fn voxels(&self) -> u32 {
        self.params.size.element_product()
    }

    /// Runs `kernel` on `count` threads, in parts of [`PART`]. `bind` creates its bind group.
    fn run(
        &self,
        kernel: &Kernel,
        jump: u32,
        count: u32,
        bind: impl Fn(kernels::Tree<'_>) -> wgpu::BindGroup,
    ) -> Result<()> {
        for begin in (0..count).step_by(PART as usize) {
            let end = count.min(begin + PART);
            let params = BuildParams { begin, end, jump, ..self.params };
            let params = constant(&self.context.device, "field builder", &params);
            let group = bind(kernels::Tree {
                params: params.entire(),
                nodes: self.nodes.entire(),
                corners: self.corners.entire(),
            });
            let mut encoder = self
                .context
                .device
                .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("field builder") });
            let mut commands = self.context.commands(&mut encoder);
            let mut pass = commands.compute("field builder");
            kernel.record(&mut pass, &group, &[], (end - begin).div_ceil(BUILD_WORKGROUP));
            pass.end()?;
            self.context.queue.submit([encoder.finish()]);
        }
        Ok(())
    }
}
