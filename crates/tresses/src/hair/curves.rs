//! The stages from guides to drawn strands.

use crate::{
    Context,
    gpu::kernel::Job,
    interpolate::Interpolation,
    strands::{GuideBuffers, StrandBuffers},
    tessellate::Tessellation,
};

/// Declares [`Curves`] from one row per stage: its field, its folder and state type, and the expression that creates
/// the state.
macro_rules! curves {
    (|$context:ident, $guides:ident, $strands:ident| $($field:ident: $folder:ident::$state:ident = $new:expr;)*) => {
        /// The stages between the simulation and the drawn strands.
        #[derive(Debug)]
        pub(crate) struct Curves { $(pub $field: crate::$folder::$state,)* }

        impl Curves {
            /// Creates the stages for `strands` that follow `guides`.
            pub fn new($context: &Context, $guides: &GuideBuffers, $strands: &StrandBuffers) -> Self {
                $(let $field = $new;)*
                Self { $($field),* }
            }

            /// Returns jobs that compile the kernels of these stages.
            pub fn jobs(context: &Context) -> Vec<Job<'static>> {
                [$(context.jobs::<crate::$folder::Pipelines>()),*].into_iter().flatten().collect()
            }
        }
    };
}

curves! { |context, guides, strands|
    tessellation: tessellate::Tessellation = Tessellation::new(context, guides);
    interpolation: interpolate::Interpolation = interpolation(context, guides, strands, &tessellation);
}

/// Creates the stage for strands that follow guide samples. Without samples, each strand follows its own guide.
fn interpolation(
    context: &Context,
    guides: &GuideBuffers,
    strands: &StrandBuffers,
    tessellation: &Tessellation,
) -> Interpolation {
    match guides.sample_count {
        0 => Interpolation::following(context, guides, strands, tessellation),
        _ => Interpolation::new(context, guides, strands),
    }
}
