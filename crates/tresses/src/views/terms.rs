//! Kernel that shades strand vertices with a single term of the shading, for debug views. It is separate from
//! `light::shade`, so that images with all terms neither change nor cost more.

use crate::{
    Context, Result,
    constants::STRAND_WORKGROUP,
    gpu::{
        Binding, Commands, Kernel,
        bindings::{constant, layout},
    },
    light::{HairView, fiber::FiberTables},
    shaders::kernels::light as kernels,
};

/// One part of the light on hair. The terms from [`Reflection`](Self::Reflection) to [`Multiple`](Self::Multiple) add
/// up to [`Direct`](Self::Direct). `Direct` and [`Sky`](Self::Sky) add up to all light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Term {
    /// Reflection by the surface (R); Kajiya and Kay: first highlight.
    Reflection = 0,
    /// Transmission through the fiber (TT); Kajiya and Kay: light from behind.
    Transmission = 1,
    /// Internal reflections (TRT and further ones); Kajiya and Kay: second highlight.
    Inner = 2,
    /// Scattering by other fibers, before or after (dual scattering); Kajiya and Kay: diffuse light.
    Multiple = 3,
    /// Light from the surroundings: sky, environment and meshes.
    Sky = 4,
    /// Light from the directional lights.
    Direct = 5,
    /// Fraction of the direct light that arrives, 0 to 1, as a color of [`super::ramp`]. Without lights, the
    /// fraction of the sky.
    Shadow = 6,
}

impl Term {
    /// All terms.
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

/// The kernel `views::terms`.
#[derive(Debug)]
pub(crate) struct Terms {
    kernel: Kernel,
    /// One group per term.
    groups: Vec<wgpu::BindGroup>,
}

impl Terms {
    /// Creates the kernel.
    pub(crate) fn new(context: &Context) -> Self {
        let Context { device, .. } = context;
        let which = layout(device, "term", wgpu::ShaderStages::COMPUTE, &[Binding::Uniform]);
        let groups = Term::ALL.map(|term| {
            let uniform = constant(device, "term", &[term as u32, 0, 0, 0]);
            device.group("term", &which, &[uniform.as_entire_binding()])
        });
        let shared = [&which, &FiberTables::layout(device)];
        let kernel = Kernel::named::<kernels::Shading>(&context.device, "views::terms", &shared);
        Self { kernel, groups: groups.into() }
    }

    /// Records the kernel for all vertices of `hair`, in place of
    /// [`LightState::shade`](crate::light::LightState::shade).
    pub(crate) fn record(
        &self,
        commands: &mut Commands<'_>,
        hair: &[HairView<'_>],
        term: Term,
    ) -> Result<()> {
        let mut pass = commands.compute("shade");
        pass.set_bind_group(1, &self.groups[term as usize], &[]);
        for HairView { hair, shaded, .. } in hair {
            let workgroups = (hair.drawn.count * hair.drawn.vertex_count).div_ceil(STRAND_WORKGROUP);
            pass.set_bind_group(2, &hair.fiber().group, &[]);
            self.kernel.record(&mut pass, &shaded.shade, &[], workgroups);
        }
        pass.end()
    }
}
