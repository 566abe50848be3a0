//! Links each shader of `src/**/*.wesl` with an entry point into one plain WGSL file in `OUT_DIR`. Writes the tables
//! `shaders.rs`, which `src/shaders.rs` includes: plain shaders, and shaders with a variant for each value of a
//! constant (`constants::VARIANTS`). Variants differ in one line and are stored once. Shaders import shared structs
//! from the module `structs`, which `build/structs.rs` generates. `build/kernels.rs` generates a Rust struct for the
//! bindings of each compute shader.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

use wesl::{
    resolver::{Router, StandardResolver, VirtualResolver},
    syntax::ModulePath,
};

#[path = "src/constants.rs"]
mod constants;
#[path = "build/kernels.rs"]
mod kernels;
#[path = "build/structs.rs"]
mod structs;

/// Files of `tresses-groom` with shared structs.
const GROOM: [&str; 3] = ["bound/binding.rs", "bound/strand.rs", "mesh/bvh/flat.rs"];

fn main() {
    println!("cargo:rerun-if-changed=src");
    println!("cargo:rerun-if-changed=build");
    println!("cargo:rerun-if-changed=build.rs");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let structs = shared_structs();
    fs::write(out.join("structs.wesl"), &structs).expect("OUT_DIR is writable");
    let mut options = wesl::CompileOptions::default();
    let mut table = String::from("const PLAIN: &[(&str, &str)] = &[\n");
    let mut varied = String::from("const VARIED: &[(&str, &str, &str, &[u32])] = &[\n");
    let (mut sources, mut shaders) = (Vec::new(), Vec::new());
    for file in files(Path::new("src"), "wesl") {
        if file.starts_with("src/views") && env::var_os("CARGO_FEATURE_DEBUG_VIEWS").is_none() {
            continue;
        }
        let text = fs::read_to_string(&file).expect("a shader is readable");
        let module = file
            .strip_prefix("src")
            .expect("found below src")
            .with_extension("")
            .iter()
            .map(|part| part.to_str().expect("shader paths are ASCII"))
            .collect::<Vec<_>>()
            .join("::");
        sources.push((module.clone(), text.clone()));
        // A library module for a host's shaders, without an entry point.
        let outside = file.ends_with("outside.wesl");
        if !outside && !["@compute", "@vertex", "@fragment"].iter().any(|e| text.contains(e)) {
            continue;
        }
        options.keep_main = outside;
        let variants = constants::VARIANTS.iter().find(|(of, ..)| *of == module);
        let in_workgroup = constants::IN_WORKGROUP.iter().find(|(of, _)| *of == module);
        let bytes = in_workgroup.map(|(_, bytes)| ("STRAND_BYTES", *bytes));
        let variant = variants.map(|(_, constant, values)| (*constant, values[0]));
        for workgroup in [false, true].into_iter().filter(|workgroup| !workgroup || bytes.is_some()) {
            let name = if workgroup { format!("{module}::workgroup") } else { module.clone() };
            options.features.set("workgroup", workgroup);
            let mut own = StandardResolver::new("src");
            let tiered = constants::TIERED.iter().map(|(name, software, _)| (*name, *software));
            for (name, value) in constants::SHARED.iter().copied().chain(tiered).chain(variant).chain(bytes) {
                own.add_constant(name, value);
            }
            let mut resolver = Router::new();
            let mut generated = VirtualResolver::new();
            generated.add_module(module_path("package"), structs.clone().into());
            resolver.mount_resolver(module_path("structs"), generated);
            resolver.mount_fallback_resolver(own);
            let main = module_path(&format!("package::{module}"));
            let linked =
                wesl::compile(&main, &options, &resolver).unwrap_or_else(|error| panic!("{name}: {error}"));
            let text = linked.syntax.to_string();
            let file = out.join(format!("{}.wgsl", name.replace("::", "_")));
            fs::write(&file, &text).expect("OUT_DIR is writable");
            if !workgroup {
                shaders.push((module.clone(), text.clone()));
            }
            let Some((_, constant, values)) = variants else {
                table += &format!("    ({name:?}, include_str!({file:?})),\n");
                continue;
            };
            let ends = format!("{constant} = {}u;", values[0]);
            let mut lines = text.lines().filter(|line| line.starts_with("const ") && line.ends_with(&ends));
            let line = lines.next().unwrap_or_else(|| panic!("{name} does not use {constant}"));
            assert!(lines.next().is_none(), "{name} has {constant} twice");
            varied += &format!("    ({name:?}, include_str!({file:?}), {line:?}, &{values:?}),\n");
        }
    }
    fs::write(out.join("shaders.rs"), table + "];\n" + &varied + "];\n").expect("OUT_DIR is writable");
    let tables = kernels::Tables {
        families: constants::FAMILIES,
        dynamic: constants::DYNAMIC,
        elements: constants::ELEMENTS,
    };
    fs::write(out.join("kernels.rs"), kernels::generate(&sources, &shaders, &tables))
        .expect("OUT_DIR is writable");
}

fn module_path(path: &str) -> ModulePath {
    path.parse().expect("a module path")
}

/// Generates the WGSL of all shared structs.
fn shared_structs() -> String {
    let groom = PathBuf::from(
        env::var_os("DEP_TRESSES_GROOM_SRC").expect("the build script of tresses-groom sets it"),
    );
    let groom = GROOM.map(|file| groom.join(file));
    let read = |file: &PathBuf| {
        println!("cargo:rerun-if-changed={}", file.display());
        let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        (file.display().to_string(), text)
    };
    let sources: Vec<_> = files(Path::new("src"), "rs").iter().chain(&groom).map(read).collect();
    structs::generate(&sources, constants::SHARED).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the files below `dir` with an extension, sorted.
fn files(dir: &Path, extension: &str) -> Vec<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(dir)
        .expect("the source tree is readable")
        .flat_map(|entry| {
            let path = entry.expect("a directory entry").path();
            if path.is_dir() {
                files(&path, extension)
            } else if path.extension().is_some_and(|found| found == extension) {
                vec![path]
            } else {
                vec![]
            }
        })
        .collect();
    files.sort();
    files
}
