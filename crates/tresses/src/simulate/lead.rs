//! Guides that are not simulated: others lead them.
//!
//! At a level of detail fewer guides are simulated ([`crate::lod`]), the first of an order in which any prefix is spread
//! evenly. Each of the others goes with a near one: where it is relative to that guide, in the frame that is carried
//! along it from edge to edge, it stays from step to step, with edges as long as they are at rest, and by and by returns to where it rests relative to it, within
//! a quarter of a second. So nothing jumps when a guide is no longer simulated, whatever its own motion had been; and
//! when it is simulated again, it goes on from where it is, at the speed that it has. Everything downstream reads all
//! guides as before.
//!
//! **Why are not strands bound to fewer guides?** Bindings of each level would have to be made, kept and blended: twice
//! the samples per vertex of every strand, to save a sixtieth of a solve. **Known limits.** A guide that is led knows of
//! no obstacles; strands that enter one are moved out of it all the same ([`crate::avoid`]).

use crate::{
    Context,
    constants::GUIDE_WORKGROUP,
    gpu::{Binding, Kernel},
    strands::{GuideBuffers, buffers::storage},
};

/// Bindings of the kernel, in order.
const BINDINGS: [Binding; 6] = [
    Binding::StorageDynamic,
    Binding::Storage,
    Binding::Storage,
    Binding::StorageMut,
    Binding::StorageMut,
    Binding::Storage,
];

/// The kernel.
pub(super) fn kernel(context: &Context) -> Kernel {
    Kernel::new(&context.device, "simulate::lead", &BINDINGS)
}

/// The order of guides on the GPU; heads with the same groom share it.
#[derive(Clone, Debug)]
pub(crate) struct Tree(wgpu::Buffer);

impl Tree {
    /// For each place in the order the guide, and the place of the one that it goes with; and in the flags of each guide
    /// which one has its place.
    ///
    /// # Errors
    /// [`crate::Error::Limit`].
    pub fn new(context: &Context, tree: &[[u32; 2]]) -> crate::Result<Self> {
        let Context { device, queue, .. } = context;
        let buffer = storage::<[u32; 2]>(device, "order of guides", tree.len() as u64)?;
        queue.write_buffer(&buffer, 0, bytemuck::cast_slice(tree));
        Ok(Self(buffer))
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.0.size()
    }
}

/// What leads the guides of one head.
#[derive(Debug)]
pub(super) struct Lead(wgpu::BindGroup);

impl Lead {
    pub fn new(kernel: &Kernel, step: wgpu::BindingResource<'_>, guides: &GuideBuffers, tree: &Tree) -> Self {
        let buffers = [&guides.info, &guides.rest, &guides.current, &guides.velocity, &tree.0];
        let mut all = vec![step];
        all.extend(buffers.map(|buffer| buffer.as_entire_binding()));
        Self(kernel.bind(&all))
    }

    /// Records those from `simulated` on of `count`.
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
