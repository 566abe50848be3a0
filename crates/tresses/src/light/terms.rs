//! The kernel that shades strand vertices with one term of the shading alone. It stands beside
//! `light::shade`, so that pictures with all terms neither change nor pay for it.

use super::{Seen, fiber::FiberTables};
use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{Binding, Commands, Kernel, bindings::layout},
};
use wgpu::util::DeviceExt;

/// One part of the light on hair. Those from [`Reflection`](Self::Reflection) to
/// [`Multiple`](Self::Multiple) add up to [`Direct`](Self::Direct), and this with [`Sky`](Self::Sky) to
/// the whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// Mirrored by the surface: R; Kajiya and Kay's first highlight.
    Reflection = 0,
    /// Straight through the fibre: TT; of Kajiya and Kay's model what shines through from behind.
    Transmission = 1,
    /// Reflected inside: TRT, and what is reflected more often; Kajiya and Kay's second highlight.
    Inner = 2,
    /// By other fibres, before or after: dual scattering; Kajiya and Kay's matt light.
    Multiple = 3,
    /// From the surroundings.
    Sky = 4,
    /// From the lights.
    Direct = 5,
    /// The share of the direct light that arrives, 0 to 1, as a colour of [`crate::views::ramp`];
    /// without lights the zenith's.
    Shadow = 6,
}

impl Term {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Reflection,
        Self::Transmission,
        Self::Inner,
        Self::Multiple,
        Self::Sky,
        Self::Direct,
        Self::Shadow,
    ];
}

/// The kernel `light::terms`.
#[derive(Debug)]
pub struct Terms {
    kernel: Kernel,
    /// One per term.
    groups: Vec<wgpu::BindGroup>,
}

impl Terms {
    /// The kernel.
    pub(crate) fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        let which = layout(device, "term", wgpu::ShaderStages::COMPUTE, &[Binding::Uniform]);
        let groups = Term::ALL.map(|term| {
            let uniform = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("term"),
                contents: bytemuck::cast_slice(&[term as u32, 0, 0, 0]),
                usage: wgpu::BufferUsages::UNIFORM,
            });
            device.group("term", &which, &[uniform.as_entire_binding()])
        });
        let kernel = Kernel::beside(
            &context.device,
            "light::terms",
            &super::pipelines::shade_bindings(),
            &[&which, &FiberTables::layout(device)],
        );
        Self { kernel, groups: groups.into() }
    }

    /// Records the kernel for all vertices of `hair`, in the place of [`super::State::shade`].
    pub(crate) fn record(&self, commands: &mut Commands<'_>, hair: &[Seen<'_>], term: Term) -> Result<()> {
        let mut pass = commands.compute("shade");
        pass.set_bind_group(1, &self.groups[term as usize], &[]);
        for Seen { hair, shaded, .. } in hair {
            let workgroups = (hair.drawn.count * hair.drawn.vertex_count).div_ceil(STRAND_WORKGROUP);
            pass.set_bind_group(2, &hair.fiber().group, &[]);
            self.kernel.record(&mut pass, &shaded.shade, &[], workgroups);
        }
        pass.end()
    }
}
