//! Motion of guides that are not simulated: they follow simulated guides.
//!
//! A level of detail simulates only a prefix of the guides, in an order in which any prefix is evenly spread
//! ([`crate::lod`]). Each other guide follows a nearby simulated guide, its leader. It keeps its offset from the leader
//! from step to step, in the frame carried along the leader from edge to edge, with edges of their rest length. Within
//! a quarter of a second the offset returns to the one at rest. So nothing jumps when a guide stops being simulated,
//! whatever its own motion was; when it is simulated again, it continues with its current position and velocity. Later
//! stages read all guides as before.
//!
//! **Why not bind strands to fewer guides?** The bindings of each level would have to be built, stored and blended:
//! twice the samples per vertex of every strand, to save a sixtieth of a solve. **Known limits.** A following guide
//! ignores obstacles; strands that enter one are still moved out of it ([`crate::avoid`]).

use crate::{
    Context,
    constants::GUIDE_WORKGROUP,
    gpu::{Buffer, BufferBinding, Kernel, Opaque},
    shaders::kernels::simulate as kernels,
    strands::{GuideBuffers, buffers::buffer},
};

/// Creates the kernel.
pub(super) fn kernel(context: &Context) -> Kernel {
    Kernel::new::<kernels::FollowLeader>(&context.device)
}

/// The order of guides on the GPU, shared by heads with the same groom.
#[derive(Clone, Debug)]
pub(crate) struct Tree(Buffer<[u32; 2]>);

impl Tree {
    /// Uploads `tree`: for each rank in the order, the guide and the rank of its leader. The flags of guide `i` hold
    /// the guide of rank `i`.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn new(context: &Context, tree: &[[u32; 2]]) -> crate::Result<Self> {
        let Context { device, queue, .. } = context;
        let buffer = buffer(device, "order of guides", tree.len() as u64)?;
        queue.write_buffer(&buffer, 0, bytemuck::cast_slice(tree));
        Ok(Self(buffer))
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.0.size()
    }
}

/// Bind group of one head.
#[derive(Debug)]
pub(super) struct Lead(wgpu::BindGroup);

impl Lead {
    pub fn new(kernel: &Kernel, u: BufferBinding<'_, Opaque>, guides: &GuideBuffers, tree: &Tree) -> Self {
        Self(kernel.bind(&kernels::FollowLeader {
            u,
            info: guides.info.entire(),
            rest: guides.rest.entire(),
            current: guides.current.entire(),
            velocity: guides.velocity.entire(),
            tree: tree.0.entire(),
        }))
    }

    /// Records the guides with ranks from `simulated` to `count`.
    pub fn record(
        &self,
        kernel: &Kernel,
        pass: &mut crate::gpu::ComputePass<'_>,
        offset: u32,
        [simulated, count]: [u32; 2],
    ) {
        kernel.record(pass, &self.0, &[offset], (count - simulated).div_ceil(GUIDE_WORKGROUP));
    }
}
