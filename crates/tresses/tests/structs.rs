//! Structs that host and shaders share: the code that the build script generates, and the errors it reports. Needs no
//! GPU.

use wgpu::naga::{AddressSpace, Module, Type, TypeInner, front::wgsl::parse_str, proc::Layouter};

#[path = "../build/structs.rs"]
mod structs;

fn generate(files: &[&str]) -> Result<String, String> {
    let name = |(i, text): (usize, &&str)| (format!("src/{i}.rs"), text.to_string());
    structs::generate(&files.iter().enumerate().map(name).collect::<Vec<_>>(), &[("COUNT", 5)])
}

#[test]
fn rust_types_become_wgsl_types() {
    let rust = "
        /// A node.
        #[repr(C)]
        #[derive(Clone, bytemuck::Pod)]
        #[allow(missing_docs)] // Names say it.
        pub struct Node {
            /// Position, meters.
            pub position: glam::Vec3,
            pub(crate) hits: crate::gpu::Atomic,
            pub turn: Quat,
            corners: [[u32; 4]; COUNT as usize],
            children: [super::Child; 2],
            first: [i32; 2],
            _pad: [u32; 2],
        }
        #[derive(Clone, NoUninit)]
        struct Vertex { position: Vec3, normal: Vec3 }";
    let child = "mod inner { #[derive(Pod)] struct Child { pose: Mat4, _pad: f32, size: f32, at: UVec2 } }";
    let wgsl = "
        public struct Child {
            pose: mat4x4<f32>,
            _pad_0: u32,
            size: f32,
            at: vec2<u32>,
        }
        public struct Node {
            position: vec3<f32>,
            hits: atomic<u32>,
            turn: vec4<f32>,
            corners: array<vec4<u32>, 5>,
            children: array<Child, 2>,
            first: vec2<i32>,
            _pad_0: u32,
            _pad_1: u32,
        }";
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(words(&generate(&[rust, child]).unwrap()), words(wgsl));
}

#[test]
fn layout_mismatches_are_errors() {
    for (rust, error) in [
        (
            "struct A { center: Vec3, edge: Vec3, falloff: f32, _pad: u32 }",
            "src/0.rs: A.edge is at byte 12 in Rust but at byte 16 in WGSL; move it or put padding before it",
        ),
        (
            "struct A { rows: [Vec3; 4], next: f32 }",
            "src/0.rs: A.next is at byte 48 in Rust but at byte 64 in WGSL; move it or put padding before it",
        ),
        (
            "struct A { center: Vec3, radius: f32, count: u32 }",
            "src/0.rs: A has 20 bytes in Rust but 32 bytes in WGSL; put padding at its end",
        ),
        ("struct A { on: bool }", "src/0.rs: A.on: bool is neither a type of WGSL nor a shared struct"),
        ("struct A { on: [u32; MOST] }", "src/0.rs: A.on: MOST is not in constants::SHARED"),
        (
            "struct A { on: [u32; COUNT + 1] }",
            "src/0.rs: A.on: the length of an array is a number or a constant",
        ),
        ("struct A { on: (u32, u32) }", "src/0.rs: A.on: WGSL has no such type"),
        ("struct A(u32);", "src/0.rs: A derives Pod but has no named fields, or is generic"),
    ] {
        assert_eq!(generate(&[&format!("#[derive(Pod)] {rust}")]), Err(error.to_owned()), "{rust}");
    }
    let twice = "#[derive(Pod)] struct A { a: u32 }";
    let error = "src/1.rs: A is also a shared struct in src/0.rs; rename one";
    assert_eq!(generate(&[twice, twice]), Err(error.to_owned()));
}

/// Checks with another implementation: naga's layout has no gaps, as in Rust.
#[test]
fn naga_finds_no_gap_in_shared_structs() {
    let wgsl = include_str!(concat!(env!("OUT_DIR"), "/structs.wesl")).replace("public ", "");
    let module = parse_str(&wgsl).unwrap();
    let mut sizes = Layouter::default();
    sizes.update(module.to_ctx()).unwrap();
    let mut count = 0;
    for (_, ty) in module.types.iter() {
        let TypeInner::Struct { members, span } = &ty.inner else { continue };
        let end = members.iter().fold(0, |end, member| {
            assert_eq!(member.offset, end, "{:?}.{:?}", ty.name, member.name);
            end + sizes[member.ty].size
        });
        assert_eq!(*span, end, "{:?}", ty.name);
        count += 1;
    }
    assert!(count > 60, "{count}");
}

/// Structs in buffers that the host neither writes nor reads.
const SHADERS_ONLY: [&str; 3] = [
    "package_draw_soft_point_SoftPoint",
    "package_draw_tiles_grid_OccupiedTile",
    "package_light_ambient_grid_Cell",
];

/// Returns the structs in the buffers of a shader that are not shared structs and do not begin with one.
fn unshared(wgsl: &str) -> Vec<String> {
    let module: Module = parse_str(wgsl).unwrap_or_else(|error| panic!("{}", error.emit_to_string(wgsl)));
    let is_buffer = |space| matches!(space, AddressSpace::Uniform | AddressSpace::Storage { .. });
    let mut found = Vec::new();
    for (_, buffer) in module.global_variables.iter().filter(|(_, it)| is_buffer(it.space)) {
        let mut ty = &module.types[buffer.ty];
        if let TypeInner::Array { base, .. } = ty.inner {
            ty = &module.types[base];
        }
        let name = |ty: &Type| ty.name.clone().unwrap_or_default();
        let TypeInner::Struct { members, .. } = &ty.inner else { continue };
        let names = [name(ty), name(&module.types[members[0].ty])];
        if !names.iter().any(|name| name.starts_with("structs_")) && !SHADERS_ONLY.contains(&&*names[0]) {
            found.push(name(ty));
        }
    }
    found
}

#[test]
fn structs_in_buffers_are_shared() {
    for (shader, wgsl) in tresses::low_level::shaders::all() {
        assert_eq!(unshared(wgsl), [""; 0], "{shader}");
    }
    let own = "struct Own { a: vec4<u32> } @group(0) @binding(0)";
    assert_eq!(unshared(&format!("{own} var<uniform> own: Own;")), ["Own"]);
    assert_eq!(unshared(&format!("{own} var<storage, read> own: array<Own>;")), ["Own"]);
}
