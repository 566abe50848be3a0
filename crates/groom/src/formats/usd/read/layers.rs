//! Sources of layers: the file itself and the files that it refers to.

use std::{
    cell::Cell,
    io::{self, Cursor},
    path::{Component, Path, PathBuf},
    rc::Rc,
    sync::Arc,
    time::SystemTime,
};

use openusd::{
    ar::{self, Asset, AssetBuffer, ResolvedPath, Resolver, SharedBuffer},
    usdz::Archive,
};

use super::{Files, Source};

/// Maximum depth of nested brackets. The parser recurses for each of them and must not overflow the stack.
const DEEPEST: usize = 96;
/// Start of a text layer.
const TEXT: &[u8] = b"#usda ";

/// The files of a scene.
pub(super) struct Layers {
    root: PathBuf,
    /// The root layer and all files given in memory, copied because the crate keeps them beyond this call.
    given: Vec<(PathBuf, Arc<[u8]>)>,
    /// Whether other files may be read from disk.
    disk: bool,
    bytes: Rc<Cell<u64>>,
}

impl Layers {
    pub fn new(source: &Source) -> Self {
        let root = tidied(source.path);
        let mut given = vec![(root.clone(), Arc::from(source.bytes))];
        if let Files::Given(all) = source.files {
            let layers = all.iter().filter(|(name, _)| is_layer(name) && name != source.path);
            given.extend(layers.map(|(name, bytes)| (name.clone(), Arc::from(&**bytes))));
        }
        Self { root, given, disk: matches!(source.files, Files::Disk), bytes: Rc::default() }
    }

    /// Returns the name of the root layer.
    pub fn root(&self) -> String {
        self.root.to_string_lossy().into_owned()
    }

    /// Returns the counter of the bytes read so far.
    pub fn bytes(&self) -> Rc<Cell<u64>> {
        self.bytes.clone()
    }

    fn find(&self, path: &Path) -> Option<&Arc<[u8]>> {
        let exact = self.given.iter().find(|(name, _)| name == path);
        // A file that the user dropped or picked has lost its folder.
        let loose = || self.given.iter().find(|(name, _)| !self.disk && name.file_name() == path.file_name());
        exact.or_else(loose).map(|(_, bytes)| bytes)
    }

    fn load(&self, path: &Path) -> io::Result<Arc<[u8]>> {
        match self.find(path) {
            Some(bytes) => Ok(bytes.clone()),
            None if self.disk => std::fs::read(path).map(Arc::from),
            None => Err(io::Error::new(io::ErrorKind::NotFound, "the file was not provided")),
        }
    }
}

/// Returns whether a file name has the extension of a layer or package.
fn is_layer(name: &Path) -> bool {
    crate::formats::extension(name).starts_with("usd")
}

/// Normalizes a path, so that each file has one name.
fn tidied(path: &Path) -> PathBuf {
    let mut tidy = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if tidy.file_name().is_some() => {
                tidy.pop();
            }
            part => tidy.push(part),
        }
    }
    tidy
}

impl Resolver for Layers {
    fn create_identifier(&self, asset: &str, anchor: Option<&ResolvedPath>) -> String {
        if let Some((package, inner)) = ar::split_package_relative_path_outer(asset) {
            let package = self.create_identifier(&package, anchor);
            return ar::join_package_relative_path(&package, &inner);
        }
        let anchor = anchor.map(|anchor| anchor.to_string_lossy()).unwrap_or_default();
        // References inside a package are relative to it.
        if let Some((package, inner)) = ar::split_package_relative_path_outer(&anchor) {
            let asset_path = Path::new(&inner).parent().unwrap_or(Path::new("")).join(asset);
            return ar::join_package_relative_path(&package, &tidied(&asset_path).to_string_lossy());
        }
        let asset_path = Path::new(&*anchor).parent().unwrap_or(Path::new("")).join(asset);
        tidied(&asset_path).to_string_lossy().into_owned()
    }

    fn resolve(&self, asset: &str) -> Option<ResolvedPath> {
        let outer = ar::split_package_relative_path_outer(asset).map(|(package, _)| package);
        let file = Path::new(outer.as_deref().unwrap_or(asset));
        (self.find(file).is_some() || (self.disk && is_layer(file) && file.is_file()))
            .then(|| ResolvedPath::new(asset))
    }

    fn resolve_for_new_asset(&self, _: &str) -> Option<ResolvedPath> {
        None
    }

    fn open_asset(&self, path: &ResolvedPath) -> io::Result<Box<dyn Asset>> {
        let name = path.to_string_lossy();
        let buffer = match ar::split_package_relative_path_outer(&name) {
            Some((package, inner)) => {
                let package = SharedBuffer::new(self.load(Path::new(&package))?);
                let mut archive =
                    Archive::from_bytes(AssetBuffer::Shared(package)).map_err(io::Error::other)?;
                archive.entry(&inner).map_err(io::Error::other)?
            }
            None => AssetBuffer::Shared(SharedBuffer::new(self.load(path)?)),
        };
        self.bytes.set(self.bytes.get().saturating_add(buffer.len() as u64));
        let text = buffer.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(0);
        if buffer[text..].starts_with(TEXT) && depth(&buffer[text..]) > DEEPEST {
            let problem = format!("brackets are nested more than {DEEPEST} levels deep");
            return Err(io::Error::new(io::ErrorKind::InvalidData, problem));
        }
        Ok(Box::new(Cursor::new(buffer)))
    }

    // Browsers have no modification times.
    fn get_modification_timestamp(&self, _: &str, _: &ResolvedPath) -> Option<SystemTime> {
        None
    }
}

/// Returns the depth of nested brackets in a text layer, outside comments and strings.
fn depth(text: &[u8]) -> usize {
    let (mut depth, mut max_depth, mut i) = (0usize, 0, 0);
    while i < text.len() {
        let quote = text[i];
        match quote {
            b'{' | b'[' | b'(' => {
                depth += 1;
                max_depth = max_depth.max(depth);
            }
            b'}' | b']' | b')' => depth = depth.saturating_sub(1),
            b'#' => i += text[i..].iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(text.len() - i),
            b'"' | b'\'' | b'@' => {
                let long = text[i..].starts_with(&[quote; 3]);
                i += if long { 3 } else { 1 };
                let ends = |rest: &[u8]| if long { rest.starts_with(&[quote; 3]) } else { rest[0] == quote };
                while i < text.len() && !ends(&text[i..]) {
                    // The end of the line terminates an unclosed string.
                    if !long && text[i] == b'\n' {
                        break;
                    }
                    i += if text[i] == b'\\' && quote != b'@' { 2 } else { 1 };
                }
                i += if long { 2 } else { 0 };
            }
            _ => {}
        }
        i += 1;
    }
    max_depth
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_ignores_comments_and_strings() {
        assert_eq!(depth(b"def \"a\" ( x = [1, (2)] ) { def \"b\" {} }"), 3);
        assert_eq!(depth(b"# {{{{\n\"((\\\"((\" '''[[ ' [[''' @((@ @@@[[[@@@ {}"), 1);
        assert_eq!(depth(b"\"open\n{{{"), 3);
        assert_eq!(depth(&b"{".repeat(1000)), 1000);
    }

    #[test]
    fn each_file_has_one_name() {
        let all = [(PathBuf::from("in/b.usda"), std::borrow::Cow::Borrowed(&b"x"[..]))];
        let source = Source {
            path: Path::new("a/./x/../r.usda"),
            bytes: b"r",
            files: Files::Given(&all),
            lenient: false,
        };
        let layers = Layers::new(&source);
        let named = |asset: &str, anchor: &str| {
            layers.create_identifier(asset, Some(&ResolvedPath::new(PathBuf::from(anchor))))
        };
        assert_eq!(layers.root(), "a/r.usda");
        assert_eq!(named("./b.usda", "a/r.usda"), "a/b.usda");
        assert_eq!(named("../b.usdz[c.usda]", "a/r.usda"), "b.usdz[c.usda]");
        assert_eq!(named("./c.usda", "p.usdz[in/a.usda]"), "p.usdz[in/c.usda]");
        // Found by the name alone, since the folder is lost. Files that were not given are not found.
        assert!(layers.resolve("a/b.usda").is_some() && layers.resolve("a/c.usda").is_none());
        assert!(layers.open_asset(&ResolvedPath::new(PathBuf::from("a/c.usda"))).is_err());
    }
}
