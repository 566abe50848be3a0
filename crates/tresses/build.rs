//! Links every entry-point shader of `src/**/*.wesl` into one plain WGSL file of `OUT_DIR` and writes the tables
//! `shaders.rs` that `src/shaders.rs` includes: those that are there as they are, and those that are there for each value
//! of a constant (`constants::VARIANTS`), which differ by one line and are kept once.

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
    let mut table = String::from("const PLAIN: &[(&str, &str)] = &[\n");
    let mut varied = String::from("const VARIED: &[(&str, &str, &str, &[u32])] = &[\n");
    for file in shaders(Path::new("src")) {
        let text = fs::read_to_string(&file).expect("a shader is readable");
        // Others' shaders call what is in this one.
        let outside = file.ends_with("outside.wesl");
        if !outside && !["@compute", "@vertex", "@fragment"].iter().any(|e| text.contains(e)) {
            continue;
        }
        compiler.options.keep_main = outside;
        let module = file
            .strip_prefix("src")
            .expect("found below src")
            .with_extension("")
            .iter()
            .map(|part| part.to_str().expect("shader paths are ASCII"))
            .collect::<Vec<_>>()
            .join("::");
        let path = format!("package::{module}").parse().expect("a module path");
        let variants = constants::VARIANTS.iter().find(|(of, ..)| *of == module);
        if let Some((_, constant, values)) = variants {
            compiler.options.constants.set(*constant, values[0]);
        }
        let linked = compiler.compile_module("src", &path).unwrap_or_else(|error| panic!("{error}"));
        let text = linked.syntax.to_string();
        let file = out.join(format!("{}.wgsl", module.replace("::", "_")));
        fs::write(&file, &text).expect("OUT_DIR is writable");
        match variants {
            None => table += &format!("    ({module:?}, include_str!({file:?})),\n"),
            Some((_, constant, values)) => {
                let ends = format!("{constant} = {}u;", values[0]);
                let mut lines =
                    text.lines().filter(|line| line.starts_with("const ") && line.ends_with(&ends));
                let line = lines.next().unwrap_or_else(|| panic!("{module} does not use {constant}"));
                assert!(lines.next().is_none(), "{module} has {constant} twice");
                varied += &format!("    ({module:?}, include_str!({file:?}), {line:?}, &{values:?}),\n");
            }
        }
    }
    fs::write(out.join("shaders.rs"), table + "];\n" + &varied + "];\n").expect("OUT_DIR is writable");
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
