//! Links every entry-point shader of `src/**/*.wesl` into one plain WGSL file of `OUT_DIR`, or into one for each
//! value of a constant (`constants::VARIANTS`), and writes the table `shaders.rs` that `src/shaders.rs` includes.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

#[path = "src/constants.rs"]
mod constants;

fn main() {
    println!("cargo:rerun-if-changed=src");
    println!("cargo:rerun-if-changed=build.rs");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let mut compiler = wesl::Compiler::default();
    for (name, value) in constants::SHARED {
        compiler.options.constants.set(*name, *value);
    }
    let mut table = String::from("pub(crate) const ALL: &[(&str, &str)] = &[\n");
    for file in shaders(Path::new("src")) {
        let text = fs::read_to_string(&file).expect("a shader is readable");
        if !["@compute", "@vertex", "@fragment"].iter().any(|e| text.contains(e)) {
            continue;
        }
        let module = file
            .strip_prefix("src")
            .expect("found below src")
            .with_extension("")
            .iter()
            .map(|part| part.to_str().expect("shader paths are ASCII"))
            .collect::<Vec<_>>()
            .join("::");
        let path = format!("package::{module}").parse().expect("a module path");
        let mut link = |name: String, compiler: &wesl::Compiler| {
            let linked = compiler.compile_module("src", &path).unwrap_or_else(|error| panic!("{error}"));
            let file = out.join(format!("{}.wgsl", name.replace("::", "_")));
            fs::write(&file, linked.syntax.to_string()).expect("OUT_DIR is writable");
            table += &format!("    ({name:?}, include_str!({file:?})),\n");
        };
        match constants::VARIANTS.iter().find(|(of, ..)| *of == module) {
            None => link(module, &compiler),
            Some((_, constant, values)) => {
                for value in *values {
                    compiler.options.constants.set(*constant, *value);
                    link(format!("{module}::{value}"), &compiler);
                }
            }
        }
    }
    fs::write(out.join("shaders.rs"), table + "];\n").expect("OUT_DIR is writable");
}

fn shaders(dir: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(dir)
        .expect("the source tree is readable")
        .flat_map(|entry| {
            let path = entry.expect("a directory entry").path();
            if path.is_dir() {
                shaders(&path)
            } else if path.extension().is_some_and(|extension| extension == "wesl") {
                vec![path]
            } else {
                vec![]
            }
        })
        .collect();
    files.sort();
    files
}
