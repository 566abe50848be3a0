//! The kernels of one fixed step, for each size of guides.

use crate::{
    collide,
    constants::{GUIDE_CAPACITIES, GUIDE_WORKGROUP, WORKGROUP_BYTES},
    gpu::{ComputePass, Context, Kernel},
    shaders::{self, kernels::simulate as kernels},
};

/// One kernel per entry of [`GUIDE_CAPACITIES`]: WGSL sizes arrays by constants.
///
/// On a GPU, the arrays of a strand do not fit into registers: a driver would spill them to memory, 342 kB per wave
/// for 32 vertices on RDNA 3. There, threads keep them in workgroup memory, and a workgroup has as many threads as its
/// memory has room for strands. A software driver holds private memory in the processor's cache and uses that.
#[derive(Debug)]
pub(crate) struct StepKernels {
    kernels: [Kernel; GUIDE_CAPACITIES.len()],
    /// Threads per workgroup of each kernel.
    threads: [u32; GUIDE_CAPACITIES.len()],
}

impl StepKernels {
    /// Creates the kernels of the shader `module`, whose strands take `bytes` of workgroup memory per vertex.
    pub fn new(context: &Context, module: &str, bytes: u32) -> Self {
        let colliders = collide::layout(&context.device);
        let private = context.tier().software;
        let memory = if private { "" } else { "::workgroup" };
        Self {
            kernels: GUIDE_CAPACITIES.map(|capacity| {
                let name = shaders::named(&format!("{module}{memory}::{capacity}"));
                Kernel::named::<kernels::Step>(&context.device, name, &[&colliders])
            }),
            threads: GUIDE_CAPACITIES
                .map(|capacity| if private { GUIDE_WORKGROUP } else { WORKGROUP_BYTES / (bytes * capacity) }),
        }
    }

    /// Returns the kernel for guides of `vertex_count` vertices.
    pub fn of(&self, vertex_count: u32) -> &Kernel {
        &self.kernels[capacity(vertex_count)]
    }

    /// Records a step of `guides` guides of `vertex_count` vertices.
    pub fn record(
        &self,
        pass: &mut ComputePass<'_>,
        group: &wgpu::BindGroup,
        offset: u32,
        [guides, vertex_count]: [u32; 2],
    ) {
        let workgroups = guides.div_ceil(self.threads[capacity(vertex_count)]);
        self.of(vertex_count).record(pass, group, &[offset], workgroups);
    }
}

/// Returns the index of the smallest of [`GUIDE_CAPACITIES`] that holds `vertex_count`.
fn capacity(vertex_count: u32) -> usize {
    GUIDE_CAPACITIES.iter().position(|c| *c >= vertex_count).unwrap_or(GUIDE_CAPACITIES.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constants::IN_WORKGROUP;

    #[test]
    fn each_capacity_has_its_own_shader() {
        for (module, _) in IN_WORKGROUP {
            let sources =
                GUIDE_CAPACITIES.map(|n| shaders::source(shaders::named(&format!("{module}::{n}"))));
            assert!((1..sources.len()).all(|i| !sources[..i].contains(&sources[i])));
        }
        assert_eq!([2, 8, 9, 64].map(capacity), [0, 0, 1, 5]);
    }

    #[test]
    fn strands_fill_workgroup_memory() {
        for (module, bytes) in IN_WORKGROUP {
            for capacity in GUIDE_CAPACITIES {
                let name = format!("{module}::workgroup::{capacity}");
                let source = shaders::source(shaders::named(&name));
                let module = wgpu::naga::front::wgsl::parse_str(source).expect("linked shaders are valid");
                let used: u32 = module
                    .global_variables
                    .iter()
                    .filter(|(_, variable)| variable.space == wgpu::naga::AddressSpace::WorkGroup)
                    .map(|(_, variable)| module.types[variable.ty].inner.size(module.to_ctx()))
                    .sum();
                let threads = WORKGROUP_BYTES / (bytes * capacity);
                assert_eq!(used, threads * bytes * capacity, "{name}");
                assert!(used <= WORKGROUP_BYTES, "{name}");
                assert_eq!(module.entry_points[0].workgroup_size, [threads, 1, 1], "{name}");
            }
        }
    }
}
