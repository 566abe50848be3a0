//! The layer below characters: single grooms, the stages' data on the GPU, debug views and measurements.
//!
//! Most hosts need none of it. It is for tools that measure or export, for hosts that hold grooms without a
//! [`Character`](crate::Character), and for the tests. [`Hair`] is one groom on one head, [`Recorder`] records its
//! stages into an encoder, and [`Character::hair`](crate::Character::hair) leads from a character to its groom. These
//! types change more often than types of the host layer.
//!
//! - **Grooms:** [`HairAsset`], [`Hair`], [`HairFrame`], [`HairSet`] for strands that are not simulated, [`GuideState`]
//!   for snapshots, [`Detail`] for the level of detail, [`Skin`] for hair on skinned meshes.
//! - **Recording:** [`Recorder`], [`Drawing`], [`ViewContent`], [`Targets`], [`Zone`].
//! - **Hands:** [`GrabTarget`] for grabs, [`MotionBrush`] for brushes that push moving hair.
//! - **Data on the GPU:** [`GuideBuffers`], [`StrandBuffers`], [`StrandVertex`] and their packing; [`readback`] and
//!   [`bindings`].
//! - **Crowds:** [`CostModel`], [`CrowdDetail`] and [`Work`], which a [`CrowdBudget`](crate::CrowdBudget) fits and
//!   reports.
//! - **Debug views** (feature `debug-views`): `DebugViews` draws a `DebugDisplay`; `Peak` measures a `GridView`.
//! - **Probes:** [`AmbientProbe`], [`ShadowProbe`], [`CubeProbe`].
//! - **Measurement:** [`Timings`](crate::Timings) by a [`Clock`], [`Counts`], `probe`, [`shaders`], [`Tier`].

pub use crate::{
    avoid::{NO_HIT, StrandState},
    body::{Skin, Words},
    budget::{CostModel, CrowdDetail, HeadDetail, MAX_BIAS_CHANGE, MAX_BUDGET_BIAS, ViewBytes, Work},
    camera::{framing_distance, subject},
    character::Foci,
    clock::{MAX_STEPS, MAX_SUBSTEPS},
    collide::{
        build::FieldBuilder,
        deform::{DeformTarget, DeformingField},
    },
    draw::{Targets, targets::PICTURE_FORMAT, tiles::Label},
    frame::{Drawing, Recorder, ViewContent},
    gpu::{
        Binding, Buffer, Clock, ComputePass, Counts, Tier, readback::Pending, timings::PendingTimings, wall,
    },
    hair::{GuideState, Hair, HairAsset, HairDescriptor, HairFrame},
    light::{
        ambient_probe::{AmbientProbe, IncidentLight},
        cube::{CubeLight, CubeMap, CubeProbe},
        fiber::{
            FiberShape,
            bsdf::{color_of, melanin},
        },
        hair::HairSet,
        material::srgb,
        probe::{Shadow, ShadowProbe},
        radiance::unpack_radiance,
        scene::MAX_SCENE_SHADOWS,
        zone::Zone,
    },
    lod::{Detail, Lod},
    math::Ray,
    roots::RootReport,
    simulate::{BrushEffect, GrabTarget, MotionBrush, TieReport, grab::GrabState},
    strands::{
        GuideBuffers, StrandBuffers, StrandVertex,
        guide::unpack_velocity,
        vertex::{pack_tangent, unpack_tangent},
    },
    volume::VolumeOptions,
    wind::MAX_CELLS,
};

#[cfg(feature = "debug-views")]
pub use crate::views::{ColorScale, DebugDisplay, DebugView, DebugViews, GridView, Peak, Term, panels, ramp};

/// Bind groups and their layouts by position.
pub mod bindings {
    pub use crate::gpu::bindings::{group, layout, uniform_buffer};
}

/// Constants that Rust and the shaders share.
pub mod constants {
    pub use crate::constants::*;
}

/// Order of strands, and their curves at a level of detail.
pub mod lod {
    pub use crate::lod::{arrange, order, resample};
}

/// The hook of tools that measure shaders.
#[cfg(feature = "probe")]
pub mod probe {
    pub use crate::gpu::probe::{GROUP, Probe};
}

/// Reads buffers and textures back to the CPU.
pub mod readback {
    #[cfg(not(target_arch = "wasm32"))]
    pub use crate::gpu::readback::blocking;
    pub use crate::gpu::readback::{buffer, texture};
}

/// The shadow of hair on a host's scene, for the host's shaders.
pub mod shade {
    pub use crate::draw::embed::shade::wgsl;
}

/// All shaders, as linked WGSL.
pub mod shaders {
    pub use crate::shaders::{all, for_gpu};
}
