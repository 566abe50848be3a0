//! A glTF file with its buffers, validated.

use std::{borrow::Cow, cell::Cell};

use gltf::json::{
    self,
    validation::{Error as Invalid, Validate},
};

use crate::{
    error::{At, Error, Result},
    formats::{
        gltf::{HAIR, MESHOPT_COMPRESSION},
        source::Source,
    },
};

/// Bytes that any file may expand to, in addition to a multiple of its size.
const FREE: u64 = 64 << 20;
/// Bytes that a file may expand to per byte of its size: a scene may contain a mesh more than once.
const UNFOLDS: u64 = 64;

/// A file with valid indices and complete buffers.
pub(super) struct File<'a> {
    source: &'a Source<'a>,
    pub document: gltf::Document,
    pub buffers: Vec<Cow<'a, [u8]>>,
    /// Bytes that the file has expanded to so far.
    spent: Cell<u64>,
}

impl<'a> File<'a> {
    /// Opens a file. Compressed views are still empty.
    pub fn open(source: &'a Source<'a>) -> Result<Self> {
        let unreadable = |problem: &dyn std::fmt::Display| {
            source.problem(At::File, format!("the file is not a valid glTF file ({})", one_line(problem)))
        };
        if has_invalid_length(source.bytes) {
            return Err(unreadable(&"its stated length is shorter than its header"));
        }
        let file = gltf::Gltf::from_slice_without_validation(source.bytes).map_err(|e| unreadable(&e))?;
        let root = file.document.into_json();
        check_indices(source, &root)?;
        if let Some(problem) = invalid(&root) {
            return Err(unreadable(&problem));
        }
        let document = gltf::Document::from_json_without_validation(root);
        let mut blob = file.blob;
        let mut buffers = Vec::new();
        for buffer in document.buffers() {
            if is_fallback(buffer.extensions()) {
                // Compressed views provide its contents.
                buffers.push(Cow::Borrowed(&[][..]));
                continue;
            }
            let missing = |why: String| source.problem(At::File, format!("a buffer is missing ({why})"));
            let data = match buffer.source() {
                gltf::buffer::Source::Uri(uri) if !uri.contains(':') => source.resource(&unescape(uri))?,
                gltf::buffer::Source::Uri(uri) => Cow::Owned(embedded(uri).map_err(missing)?),
                gltf::buffer::Source::Bin => {
                    Cow::Owned(blob.take().ok_or_else(|| missing("the file has no binary chunk".into()))?)
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

    /// Reads a file that this one refers to.
    #[cfg(feature = "textures")]
    pub fn resource(&self, name: &str) -> Result<Cow<'a, [u8]>> {
        self.source.resource(name)
    }

    /// Adds `items` of `size` bytes to the count of expanded bytes. Without this limit, a small file that refers to its
    /// data repeatedly could fill the memory.
    pub fn spend(&self, items: usize, size: usize) -> Result<()> {
        let have = self.source.bytes.len() as u64 + self.buffers.iter().map(|b| b.len() as u64).sum::<u64>();
        let spent = self.spent.get().saturating_add((items as u64).saturating_mul(size as u64));
        self.spent.set(spent);
        if spent <= have.saturating_mul(UNFOLDS).saturating_add(FREE) {
            return Ok(());
        }
        Err(self.problem(format!("its {have} bytes would expand to more than {UNFOLDS} times as many")))
    }
}

/// Returns whether a buffer is only a placeholder for data that another buffer holds compressed.
fn is_fallback(extensions: Option<&serde_json::Map<String, serde_json::Value>>) -> bool {
    extensions.and_then(|all| all.get(MESHOPT_COMPRESSION)?.get("fallback")?.as_bool()).unwrap_or(false)
}

/// Decodes a data URI; an error says why it has no data.
pub(super) fn embedded(uri: &str) -> std::result::Result<Vec<u8>, String> {
    use base64::{Engine, engine::general_purpose::STANDARD};
    let text = uri.strip_prefix("data:").and_then(|rest| rest.split_once(";base64,"));
    let (_, text) = text.ok_or("its URI is neither a file name nor base64 data")?;
    STANDARD.decode(text).map_err(|error| error.to_string())
}

/// Returns whether the header of a GLB states a length shorter than the header. The `gltf` crate subtracts the two
/// unchecked.
fn has_invalid_length(bytes: &[u8]) -> bool {
    matches!(bytes.first_chunk::<12>(), Some([b'g', b'l', b'T', b'F', _, _, _, _, length @ ..])
        if u32::from_le_bytes(*length) < 12)
}

/// Extensions that this reader supports and the `gltf` crate does not know.
const EXTENSIONS: [&str; 3] = [MESHOPT_COMPRESSION, "KHR_mesh_quantization", HAIR];

/// Rejects files that would make the `gltf` crate panic before or after its own validation.
fn check_indices(source: &Source, root: &json::Root) -> Result<()> {
    // It uses the accessor of positions before it validates the index.
    let accessors = root.accessors.len();
    let primitives = root.meshes.iter().flat_map(|m| &m.primitives);
    if let Some(bad) = primitives.flat_map(|p| p.attributes.values()).find(|i| i.value() >= accessors) {
        let problem = format!("accessor {} does not exist; there are {accessors}", bad.value());
        return Err(source.problem(At::File, problem));
    }
    // It does not validate the nodes of channels.
    let nodes = root.nodes.len();
    for (i, animation) in root.animations.iter().enumerate() {
        if let Some(bad) = animation.channels.iter().map(|c| c.target.node.value()).find(|n| *n >= nodes) {
            let problem = format!("animation {i} moves node {bad}, which does not exist; there are {nodes}");
            return Err(source.problem(At::File, problem));
        }
    }
    Ok(())
}

/// Returns the first error of the crate's validation, except for [`EXTENSIONS`], lights, and accessors without data,
/// which are zeros.
fn invalid(root: &json::Root) -> Option<String> {
    let mut first = None;
    root.validate(root, json::Path::new, &mut |path: &dyn Fn() -> json::Path, error: Invalid| {
        if first.is_none() {
            let path = path();
            let empty = path.as_str().starts_with("accessors[") && path.as_str().ends_with("].bufferView");
            let known = EXTENSIONS.iter().any(|name| path.as_str().ends_with(&format!("= \"{name}\"")));
            let of_light = path.as_str().contains(super::lights::PATH);
            let is_allowed =
                empty && error == Invalid::Missing || known && error == Invalid::Unsupported || of_light;
            if !is_allowed {
                first = Some(format!("{path}: {error}"));
            }
        }
    });
    first
}

/// Decodes percent-encoded characters of a URI.
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

/// Returns another crate's message as a single line.
fn one_line(error: &dyn std::fmt::Display) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}
