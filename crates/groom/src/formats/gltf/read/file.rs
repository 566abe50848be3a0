//! A glTF file with its buffers, checked as a whole.

use std::{borrow::Cow, cell::Cell};

use gltf::json::{
    self,
    validation::{Error as Invalid, Validate},
};

use crate::{
    error::{At, Error, Result},
    formats::{
        gltf::{HAIR, PACKED},
        source::Source,
    },
};

/// What a file may unfold to beyond a multiple of its size, bytes.
const FREE: u64 = 64 << 20;
/// What a file may unfold to, times its size: meshes may stand in a scene more than once.
const UNFOLDS: u64 = 64;

/// A file whose indices all exist and whose buffers are whole.
pub(super) struct File<'a> {
    source: &'a Source<'a>,
    pub document: gltf::Document,
    pub buffers: Vec<Cow<'a, [u8]>>,
    /// What was made of it so far, bytes.
    spent: Cell<u64>,
}

impl<'a> File<'a> {
    /// Opens it; compressed views are still empty.
    pub fn open(source: &'a Source<'a>) -> Result<Self> {
        let unreadable = |problem: &dyn std::fmt::Display| {
            source.problem(At::File, format!("not a readable glTF file ({})", one_line(problem)))
        };
        if is_shorter_than_its_header(source.bytes) {
            return Err(unreadable(&"its length does not hold its header"));
        }
        let file = gltf::Gltf::from_slice_without_validation(source.bytes).map_err(|e| unreadable(&e))?;
        let root = file.document.into_json();
        check_what_the_crate_forgets(source, &root)?;
        if let Some(problem) = invalid(&root) {
            return Err(unreadable(&problem));
        }
        let document = gltf::Document::from_json_without_validation(root);
        let mut blob = file.blob;
        let mut buffers = Vec::new();
        for buffer in document.buffers() {
            if is_fallback(buffer.extensions()) {
                // What lies in it comes out of compressed views.
                buffers.push(Cow::Borrowed(&[][..]));
                continue;
            }
            let missing = |why: String| source.problem(At::File, format!("a buffer is missing ({why})"));
            let data = match buffer.source() {
                gltf::buffer::Source::Uri(uri) if !uri.contains(':') => source.companion(&unescape(uri))?,
                gltf::buffer::Source::Uri(uri) => Cow::Owned(embedded(uri).map_err(missing)?),
                gltf::buffer::Source::Bin => {
                    Cow::Owned(blob.take().ok_or_else(|| missing("the file has none of its own".into()))?)
                }
            };
            if data.len() < buffer.length() {
                let (have, need) = (data.len(), buffer.length());
                let problem = format!("buffer {} has {have} bytes, but should have {need}", buffer.index());
                return Err(source.problem(At::File, problem));
            }
            buffers.push(data);
        }
        Ok(Self { source, document, buffers, spent: Cell::new(0) })
    }

    pub fn problem(&self, problem: String) -> Error {
        self.source.problem(At::File, problem)
    }

    /// A file beside it.
    #[cfg(feature = "textures")]
    pub fn companion(&self, name: &str) -> Result<Cow<'a, [u8]>> {
        self.source.companion(name)
    }

    /// Counts `items` of `size` bytes that are about to be made of the file. A small file that names its
    /// data over and over would fill any memory.
    pub fn spend(&self, items: usize, size: usize) -> Result<()> {
        let have = self.source.bytes.len() as u64 + self.buffers.iter().map(|b| b.len() as u64).sum::<u64>();
        let spent = self.spent.get().saturating_add((items as u64).saturating_mul(size as u64));
        self.spent.set(spent);
        if spent <= have.saturating_mul(UNFOLDS).saturating_add(FREE) {
            return Ok(());
        }
        Err(self.problem(format!("its {have} bytes would unfold to more than {UNFOLDS} times as many")))
    }
}

/// Whether a buffer only stands for what lies compressed in another.
fn is_fallback(extensions: Option<&serde_json::Map<String, serde_json::Value>>) -> bool {
    extensions.and_then(|all| all.get(PACKED)?.get("fallback")?.as_bool()).unwrap_or(false)
}

/// The bytes of an address that holds them, or why there are none.
pub(super) fn embedded(uri: &str) -> std::result::Result<Vec<u8>, String> {
    use base64::{Engine, engine::general_purpose::STANDARD};
    let text = uri.strip_prefix("data:").and_then(|rest| rest.split_once(";base64,"));
    let (_, text) = text.ok_or("its address is neither a file beside it nor data in base64")?;
    STANDARD.decode(text).map_err(|error| error.to_string())
}

/// Of a GLB: the crate takes the header's length off the file's without a look, which overflows.
fn is_shorter_than_its_header(bytes: &[u8]) -> bool {
    matches!(bytes.first_chunk::<12>(), Some([b'g', b'l', b'T', b'F', _, _, _, _, length @ ..])
        if u32::from_le_bytes(*length) < 12)
}

/// Extensions that the crate does not know, but we do.
const EXTENSIONS: [&str; 3] = [PACKED, "KHR_mesh_quantization", HAIR];

/// What would make the crate panic before or after its own validation.
fn check_what_the_crate_forgets(source: &Source, root: &json::Root) -> Result<()> {
    // It looks an accessor of positions up before it checks its index.
    let accessors = root.accessors.len();
    let primitives = root.meshes.iter().flat_map(|m| &m.primitives);
    if let Some(bad) = primitives.flat_map(|p| p.attributes.values()).find(|i| i.value() >= accessors) {
        let problem = format!("accessor {} does not exist, there are {accessors}", bad.value());
        return Err(source.problem(At::File, problem));
    }
    // It does not look at what channels aim at.
    let nodes = root.nodes.len();
    for (i, animation) in root.animations.iter().enumerate() {
        if let Some(bad) = animation.channels.iter().map(|c| c.target.node.value()).find(|n| *n >= nodes) {
            let problem = format!("animation {i} moves node {bad}, which does not exist, there are {nodes}");
            return Err(source.problem(At::File, problem));
        }
    }
    Ok(())
}

/// The first thing that the crate's validation refuses, except accessors without data: those are zeros.
fn invalid(root: &json::Root) -> Option<String> {
    let mut first = None;
    root.validate(root, json::Path::new, &mut |path: &dyn Fn() -> json::Path, error: Invalid| {
        if first.is_none() {
            let path = path();
            let empty = path.as_str().starts_with("accessors[") && path.as_str().ends_with("].bufferView");
            let known = EXTENSIONS.iter().any(|name| path.as_str().ends_with(&format!("= \"{name}\"")));
            if !(empty && error == Invalid::Missing || known && error == Invalid::Unsupported) {
                first = Some(format!("{path}: {error}"));
            }
        }
    });
    first
}

/// An URI's `%20` and the like.
pub(super) fn unescape(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        let code = bytes.get(i + 1..i + 3).filter(|_| bytes[i] == b'%');
        let code =
            code.and_then(|c| std::str::from_utf8(c).ok()).and_then(|c| u8::from_str_radix(c, 16).ok());
        out.push(code.unwrap_or(bytes[i]));
        i += if code.is_some() { 3 } else { 1 };
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// Another crate's message without its line ends.
fn one_line(error: &dyn std::fmt::Display) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}
