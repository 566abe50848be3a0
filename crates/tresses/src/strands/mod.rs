//! GPU data shared by stages. Most buffers have a pair of files: the Rust struct of an element, and WESL that packs
//! and unpacks it. The table lists the buffers of [`GuideBuffers`] and [`StrandBuffers`].
//!
//! ```text
//! guides     rest, info                   written once           read by simulate, tessellate
//!            current, velocity            written by simulate    read by volume, tessellate
//!            forces                       written and read by simulate
//!            roots                        written by roots, simulate; read by simulate, tessellate
//! samples    position + rotation          written by tessellate  read by interpolate, avoid; empty if each strand
//!                                                                is itself a guide
//! strands    bindings, rest               written once           read by interpolate
//!            strands                      written once           read by light, draw
//!            vertices                     written by interpolate read by light, draw
//! ```
//!
//! Guide vertices are stored vertex-major (`index = vertex * guide_count + guide`), so that neighboring threads, one
//! per guide, read neighboring addresses. Samples and strand vertices are stored strand-major
//! (`index = strand * vertex_count + vertex`).

pub mod buffers;
pub mod force;
pub mod guide;
pub(crate) mod indices;
pub mod rest;
pub mod root;
pub mod vertex;

pub use crate::groom::bound::{
    binding::{PackedRest, StrandBinding},
    strand::{self, Strand},
};
pub use buffers::{DrawCount, GuideBuffers, StrandBuffers, StrandCapacity};
pub(crate) use buffers::{GuideAsset, StrandAsset};
#[cfg(test)]
pub(crate) use force::Force;
pub use force::GuideForce;
pub(crate) use guide::{Guide, GuideRest, GuideSample, GuideShape, PackedGuide};
pub(crate) use rest::RestGuides;
pub(crate) use root::RootMotion;
pub use vertex::StrandVertex;

// The limits on the CPU equal the array sizes of the shaders.
const _: () = assert!(
    crate::constants::MAX_GUIDE_VERTICES == crate::groom::MAX_GUIDE_VERTICES
        && crate::constants::MAX_STRAND_VERTICES == crate::groom::MAX_STRAND_VERTICES
);
