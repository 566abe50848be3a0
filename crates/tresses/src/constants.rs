//! Constants that host and shaders share. `build.rs` includes this file and makes the constants available to WESL: a
//! shader writes `import constants::STRAND_WORKGROUP;`.

/// The table that `build.rs` reads.
#[allow(dead_code)]
pub const SHARED: &[(&str, u32)] = &[
    ("GUIDE_WORKGROUP", GUIDE_WORKGROUP),
    ("STRAND_WORKGROUP", STRAND_WORKGROUP),
    ("WORKGROUP_BYTES", WORKGROUP_BYTES),
    ("HIT_RUN", HIT_RUN),
    ("VOLUME_WORKGROUP", VOLUME_WORKGROUP),
    ("MAX_GUIDE_VERTICES", MAX_GUIDE_VERTICES),
    ("MAX_STRAND_VERTICES", MAX_STRAND_VERTICES),
    ("MAX_COLLIDERS", MAX_COLLIDERS),
    ("MAX_TAPS", MAX_TAPS),
    ("LINKS", LINKS),
    ("TIE_WORKGROUP", TIE_WORKGROUP),
    ("MAX_FOOTPRINT", MAX_FOOTPRINT),
    ("BUILD_WORKGROUP", BUILD_WORKGROUP),
    ("DEFORM_NODES", DEFORM_NODES),
    ("MAX_LIGHTS", MAX_LIGHTS),
    ("LIGHT_GROUP", LIGHT_GROUP),
    ("MAX_UNMAPPED_LIGHTS", MAX_UNMAPPED_LIGHTS),
    ("MAX_MAP_VIEWS", MAX_MAP_VIEWS),
    ("LIGHT_OPTIONS", LIGHT_OPTIONS),
    ("MAX_GUSTS", MAX_GUSTS),
    ("SHADOW_BLOCK", SHADOW_BLOCK),
    ("DEEP_LAYERS", DEEP_LAYERS),
    ("COVER_STRANDS", COVER_STRANDS),
    ("COVER_STRIDE", COVER_STRIDE),
    ("AMBIENT_STRANDS", AMBIENT_STRANDS),
    ("SWEEP_WORKGROUP", SWEEP_WORKGROUP),
    ("TILE", TILE),
    ("TILE_BINS", TILE_BINS),
    ("TILE_BLOCK", TILE_BLOCK),
    ("TILE_SMALL_BIN", TILE_SMALL_BIN),
    ("TILE_POINTS", TILE_POINTS),
    ("TILE_ROUNDS", TILE_ROUNDS),
    ("TILE_SLOTS", TILE_SLOTS),
    ("TILE_STRATA", TILE_STRATA),
];

/// Constants of shaders that depend on the driver: name, value for software drivers, value for GPUs. Shaders are linked
/// with the first; [`crate::shaders::for_gpu`] replaces it.
#[allow(dead_code)]
pub const TIERED: &[(&str, u32, u32)] =
    &[("TEXEL_SQUARE", 1, TEXEL_SQUARE), ("STAGED_VERTICES", 1, STAGED_VERTICES)];

/// Shaders that are linked once per value of a constant: module, constant, values. The value becomes the last component
/// of the module path.
#[allow(dead_code)]
pub const VARIANTS: &[(&str, &str, &[u32])] = &[
    ("simulate::step", "GUIDE_CAPACITY", &GUIDE_CAPACITIES),
    ("simulate::twist", "GUIDE_CAPACITY", &GUIDE_CAPACITIES),
    ("light::shade", "LIGHT_OPTIONS", &[0, 1, 2, 3]),
    ("light::shading_samples", "LIGHT_OPTIONS", &[0, 2]),
    ("light::splat", "LIGHT_OPTIONS", &[0, 2, 4, 6]),
    ("light::cover", "LIGHT_OPTIONS", &[0, 2, 4, 6]),
    ("light::strand_map", "LIGHT_OPTIONS", &[0, 2]),
    ("light::ambient::splat_radiance", "LIGHT_OPTIONS", &[0, 2]),
    ("draw::soft::evaluate", "LIGHT_OPTIONS", &[0, 2]),
    ("draw::body", "LIGHT_OPTIONS", &[0, 2]),
    ("draw::painted", "LIGHT_OPTIONS", &[0, 2]),
    ("draw::classic::alpha", "LIGHT_OPTIONS", &[0, 2]),
    ("draw::classic::arrive", "LIGHT_OPTIONS", &[0, 2]),
    ("draw::tiles::visibility", "SURFACES", &[1, 2]),
    ("draw::tiles::geometry", "SURFACES", &[1, 2]),
    ("draw::tiles::label", "SURFACES", &[1, 2]),
    ("draw::tiles::blend", "SURFACES", &[1, 2]),
];

/// Shaders that are linked a second time, with the feature `workgroup`, as `<module>::workgroup`: their threads keep a
/// strand in workgroup memory instead of private memory. The number is the memory per vertex of a strand, bytes.
#[allow(dead_code)]
pub const IN_WORKGROUP: &[(&str, u32)] = &[("simulate::step", STEP_BYTES), ("simulate::twist", TWIST_BYTES)];

/// Shaders that share a bind group: the struct of their bindings, and their modules.
#[allow(dead_code)]
pub(crate) const FAMILIES: &[(&str, &[&str])] = &[
    ("simulate::Step", &["simulate::step", "simulate::twist"]),
    ("volume::Blur", &["volume::blur_x", "volume::blur_y"]),
    ("light::Shading", &["light::shade", "light::shading_samples", "views::terms", "draw::classic::arrive"]),
    (
        "light::ShadowMaps",
        &[
            "light::splat",
            "light::strand_map",
            "light::blocks",
            "light::front",
            "light::cover",
            "light::stack",
        ],
    ),
    ("light::ambient::Sweep", &["light::ambient::sweep", "light::ambient::sweep_radiance"]),
    ("light::ambient::Gather", &["light::ambient::gather", "light::ambient::collect"]),
];

/// Bindings of kernels with a dynamic offset, by name or struct.
#[allow(dead_code)]
pub(crate) const DYNAMIC: &[&str] =
    &["StepUniforms", "VolumeUniforms", "WindUniforms", "AirUniforms", "GrabUniform", "round"];

/// Structs in typed buffers ([`crate::gpu::Buffer`]): the WGSL name, and the Rust type.
#[allow(dead_code)]
pub(crate) const ELEMENTS: &[(&str, &str)] = &[
    ("Guide", "strands::Guide"),
    ("PackedGuide", "strands::PackedGuide"),
    ("GuideForce", "strands::GuideForce"),
    ("GuideSample", "strands::GuideSample"),
    ("RootMotion", "strands::RootMotion"),
    ("Strand", "strands::Strand"),
    ("StrandBinding", "strands::StrandBinding"),
    ("PackedRest", "strands::PackedRest"),
    ("StrandVertex", "strands::StrandVertex"),
];

/// Workgroup memory per vertex of `simulate::step`, bytes: eight vectors.
pub const STEP_BYTES: u32 = 8 * 16;
/// Workgroup memory per vertex of `simulate::twist`, bytes: 13 vectors and a number.
pub const TWIST_BYTES: u32 = 13 * 16 + 4;
/// Workgroup memory that every WebGPU adapter has, bytes.
pub const WORKGROUP_BYTES: u32 = 16_384;
/// Workgroup size of passes with one thread per guide.
pub const GUIDE_WORKGROUP: u32 = 32;
/// Workgroup size of passes with one thread per strand vertex.
pub const STRAND_WORKGROUP: u32 = 64;
/// Consecutive vertices of a strand that one thread tests for obstacles.
pub const HIT_RUN: u32 = 8;
/// Maximum cells along a line that the blur of the density grid reads to produce four cells.
pub const MAX_TAPS: u32 = 96;

/// Workgroup size of the kernel for ties: one workgroup holds one ring.
pub const TIE_WORKGROUP: u32 = 64;
/// Maximum links per guide vertex.
pub const LINKS: u32 = 4;
/// Maximum samples that contribute to a resolved pixel.
pub const MAX_FOOTPRINT: u32 = 32;
/// Workgroup size of passes with one thread per grid cell or guide vertex.
pub const VOLUME_WORKGROUP: u32 = 64;
/// Vertex counts for which the guide step is linked. WGSL sizes private arrays by constants, and short guides should
/// not need the private memory of long ones.
pub const GUIDE_CAPACITIES: [u32; 6] = [8, 16, 24, 32, 48, MAX_GUIDE_VERTICES];
/// Maximum vertices per guide.
pub const MAX_GUIDE_VERTICES: u32 = 64;
/// Maximum vertices per drawn strand.
pub const MAX_STRAND_VERTICES: u32 = 64;
/// Maximum colliders per groom, including the head's field.
pub const MAX_COLLIDERS: u32 = 128;
/// Workgroup size of the kernels that build distance fields.
pub const BUILD_WORKGROUP: u32 = 64;
/// Nodes along each edge of the grid that stores how a distance field deforms with the skin.
pub const DEFORM_NODES: u32 = 20;
/// Lights whose shadows are packed together.
pub const LIGHT_GROUP: u32 = 4;
/// Maximum lights with shadow maps.
pub const MAX_LIGHTS: u32 = 8;
/// Maximum lights without shadow maps.
pub const MAX_UNMAPPED_LIGHTS: u32 = 256;
/// Maximum views into shadow maps: the six faces of a cube per light, and one from above for the sky.
pub const MAX_MAP_VIEWS: u32 = 6 * MAX_LIGHTS + 1;
/// What shaders can do that read light, in bits (`lights.wesl`). Shaders without variants can do everything.
pub const LIGHT_OPTIONS: u32 = 2;
/// Maximum gust modes in a step's uniforms.
pub const MAX_GUSTS: u32 = 24;
/// Edge of a block of shadow map texels. Each block stores the fraction of its texels with hair and their mean height.
pub const SHADOW_BLOCK: u32 = 4;
/// Layers per deep opacity map.
pub const DEEP_LAYERS: u32 = 8;
/// Maximum strands counted in deep opacity maps. Of more strands, an even subset represents all.
pub const COVER_STRANDS: u32 = 8192;
/// Maximum segments of a strand that deep opacity maps treat as one.
pub const COVER_STRIDE: u32 = 2;
/// Approximate number of strands that represent all of them in the grid of ambient light.
pub const AMBIENT_STRANDS: u32 = 4096;
/// Workgroup size of the kernels that propagate ambient light: one workgroup propagates one direction.
pub const SWEEP_WORKGROUP: u32 = 256;
/// Edge of a tile of the compute rasterizer, pixels. One thread processes one row of a tile.
pub const TILE: u32 = 8;
/// Depth bins per tile; also the size of the workgroup that sorts them.
pub const TILE_BINS: u32 = 64;
/// Edge of a block of tiles that share one depth range for their bins, tiles.
pub const TILE_BLOCK: u32 = 2;
/// Largest bin that is sorted by pairwise comparison; larger ones take a workgroup each.
pub const TILE_SMALL_BIN: u32 = 512;
/// Points per row of the textures that store them.
pub const TILE_POINTS: u32 = 4096;
/// Edge of the squares of texels that hold adjacent values on GPUs, which store textures in such squares.
pub const TEXEL_SQUARE: u32 = 8;
/// Vertices of each strand that a workgroup collects on GPUs, so that adjacent threads store adjacent vertices.
pub const STAGED_VERTICES: u32 = 8;
/// Maximum rounds in which tile lists are built.
pub const TILE_ROUNDS: u32 = 4;
/// Tiles per workgroup.
pub const TILE_SLOTS: u32 = 4;
/// Runs into which the tile list is divided. Adjacent workgroups take tiles from different runs, which balances load.
pub const TILE_STRATA: u32 = 16;
