//! The files of three.js that `<tresses-viewer>` loads to draw cards.

use anyhow::{Context, Result, bail};
use std::path::Path;

/// Folder of the copied files.
const FOLDER: &str = "three";
/// Modules, as paths in the npm package. Their copies have no folders in between.
const MODULES: [&str; 5] = [
    "build/three.core.min.js",
    "build/three.module.min.js",
    "examples/jsm/loaders/GLTFLoader.js",
    "examples/jsm/controls/OrbitControls.js",
    "examples/jsm/utils/BufferGeometryUtils.js",
];

/// Copies the modules and the license from the npm package `package` into `out`, with imports that need no bundler and
/// no import map. Returns the names of the modules.
///
/// # Errors
/// Fails if a file cannot be copied, or imports a module that is not copied.
pub fn copy(package: &Path, out: &Path) -> Result<Vec<String>> {
    if !package.is_dir() {
        bail!("{}: three.js is missing; run scripts/setup --viewer", package.display());
    }
    let read = |path: &str| {
        let path = package.join(path);
        std::fs::read_to_string(&path).with_context(|| path.display().to_string())
    };
    let write = |name: &str, text: &str| {
        let path = out.join(name);
        std::fs::write(&path, text).with_context(|| path.display().to_string())
    };
    let folder = out.join(FOLDER);
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    write(&format!("{FOLDER}/LICENSE"), &read("LICENSE")?)?;
    let copied = |module: &&str| -> Result<String> {
        let name = format!("{FOLDER}/{}", file_name(module));
        write(&name, &relative(&read(module)?).with_context(|| (*module).to_owned())?)?;
        Ok(name)
    };
    MODULES.iter().map(copied).collect()
}

fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

/// Replaces the specifiers of imports by paths of files in the same folder.
///
/// # Errors
/// Fails if `text` imports a module that is not copied.
pub fn relative(text: &str) -> Result<String> {
    let mut lines = Vec::new();
    for line in text.split('\n') {
        // Minified modules, in which lines contain more than an import, import each other from the same folder.
        let import = line.strip_suffix("';").and_then(|line| line.rsplit_once(" from '"));
        let Some((names, from)) = import.filter(|_| line.starts_with(['i', '}'])) else {
            lines.push(line.to_owned());
            continue;
        };
        let name = if from == "three" { "three.module.min.js" } else { file_name(from) };
        if !MODULES.iter().any(|module| file_name(module) == name) {
            bail!("the imported module {from} is not copied");
        }
        lines.push(format!("{names} from './{name}';"));
    }
    Ok(lines.join("\n"))
}
