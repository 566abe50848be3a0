//! Numbers that host and shaders share. `build.rs` includes this file and hands the table to
//! WESL, where a shader writes `import constants::STRAND_WORKGROUP;`.

/// The table `build.rs` reads.
#[allow(dead_code)]
pub const SHARED: &[(&str, u32)] = &[
    ("GUIDE_WORKGROUP", GUIDE_WORKGROUP),
    ("STRAND_WORKGROUP", STRAND_WORKGROUP),
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
    ("SHADOW_MAPS", SHADOW_MAPS),
    ("MAX_GUSTS", MAX_GUSTS),
    ("SHADOW_BLOCK", SHADOW_BLOCK),
    ("DEEP_LAYERS", DEEP_LAYERS),
    ("COVER_STRANDS", COVER_STRANDS),
    ("COVER_STRIDE", COVER_STRIDE),
    ("AMBIENT_STRANDS", AMBIENT_STRANDS),
    ("TILE", TILE),
    ("TILE_BINS", TILE_BINS),
    ("TILE_BLOCK", TILE_BLOCK),
    ("TILE_FEW", TILE_FEW),
    ("TILE_POINTS", TILE_POINTS),
    ("TILE_ROUNDS", TILE_ROUNDS),
    ("TILE_SCAN", TILE_SCAN),
    ("TILE_SLOTS", TILE_SLOTS),
    ("TILE_STRATA", TILE_STRATA),
];

/// Shaders that are linked once for each value of a constant: module, constant, values. Each has the value as
/// a last part of its path.
#[allow(dead_code)]
pub const VARIANTS: &[(&str, &str, &[u32])] = &[
    ("simulate::step", "GUIDE_CAPACITY", &GUIDE_CAPACITIES),
    ("simulate::twist", "GUIDE_CAPACITY", &GUIDE_CAPACITIES),
    ("light::shade", "STRAND_MAPS", &[0, 1]),
    ("draw::tiles::see", "SURFACES", &[1, 2]),
    ("draw::tiles::geometry", "SURFACES", &[1, 2]),
    ("draw::tiles::label", "SURFACES", &[1, 2]),
    ("draw::tiles::blend", "SURFACES", &[1, 2]),
];

/// Threads of one workgroup of the passes that run once per guide.
pub const GUIDE_WORKGROUP: u32 = 32;
/// Threads of one workgroup of the passes that run once per strand vertex.
pub const STRAND_WORKGROUP: u32 = 64;
/// Vertices of a strand that the search for obstacles looks at together.
pub const HIT_RUN: u32 = 8;
/// The most cells along a line that the blur of the hair's grid reads for four.
pub const MAX_TAPS: u32 = 96;

/// Threads that hold one ring of a [tie](crate::simulate::ties) together.
pub const TIE_WORKGROUP: u32 = 64;
/// The most [links](crate::simulate::links) of a guide vertex.
pub const LINKS: u32 = 4;
/// The most samples that make a pixel.
pub const MAX_FOOTPRINT: u32 = 32;
/// Threads of one workgroup of the passes that run once per cell or guide vertex.
pub const VOLUME_WORKGROUP: u32 = 64;
/// The vertex counts that the step of the guides is linked for: WGSL sizes private arrays by constants, and
/// short guides shall not pay for the private memory of long ones.
pub const GUIDE_CAPACITIES: [u32; 6] = [8, 16, 24, 32, 48, MAX_GUIDE_VERTICES];
/// The most vertices a guide may have.
pub const MAX_GUIDE_VERTICES: u32 = 64;
/// The most vertices a drawn strand may have.
pub const MAX_STRAND_VERTICES: u32 = 64;
/// The most colliders of one groom, the head's field included.
pub const MAX_COLLIDERS: u32 = 128;
/// Threads of one workgroup of the kernels that make distance fields.
pub const BUILD_WORKGROUP: u32 = 64;
/// Nodes along each edge of the grid that says how a distance field deforms with skin.
pub const DEFORM_NODES: u32 = 20;
/// The most directional lights of a scene.
pub const MAX_LIGHTS: u32 = 4;
/// The most shadow maps: one per light, and one from above for the sky.
pub const SHADOW_MAPS: u32 = MAX_LIGHTS + 1;
/// The most gust modes of a step's uniforms.
pub const MAX_GUSTS: u32 = 24;
/// Edge of a block of shadow map texels, which hold how much hair there is and how high.
pub const SHADOW_BLOCK: u32 = 4;
/// Layers of a deep opacity map.
pub const DEEP_LAYERS: u32 = 8;
/// The most strands that are counted in deep opacity maps: of more, these represent all.
pub const COVER_STRANDS: u32 = 8192;
/// The most segments of a strand that lie in those maps as one.
pub const COVER_STRIDE: u32 = 2;
/// About how many strands represent all of them in the grid of ambient light.
pub const AMBIENT_STRANDS: u32 = 4096;
/// Edge of a tile of the compute rasteriser, pixels: a row of them is one thread's.
pub const TILE: u32 = 8;
/// Bins of depth in a tile; also the threads of the workgroup that puts them in order.
pub const TILE_BINS: u32 = 64;
/// Edge of a block of tiles that share the range of depth that bins divide, tiles.
pub const TILE_BLOCK: u32 = 2;
/// Up to so many entries of a bin are compared with each other; with more, a workgroup sorts them.
pub const TILE_FEW: u32 = 512;
/// Points in a row of the textures that hold them.
pub const TILE_POINTS: u32 = 4096;
/// The most rounds that the lists of tiles are made in.
pub const TILE_ROUNDS: u32 = 4;
/// Threads of the one workgroup that adds up tiles.
pub const TILE_SCAN: u32 = 256;
/// Tiles of a workgroup.
pub const TILE_SLOTS: u32 = 4;
/// Tiles are dealt to workgroups from so many places at once.
pub const TILE_STRATA: u32 = 16;
