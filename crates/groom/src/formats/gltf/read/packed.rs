//! Compressed views (`EXT_meshopt_compression`), decoded into buffers of their own when a file is opened.

use std::borrow::Cow;

use gltf::json::{self, validation::USize64};
use meshoptimizer_rs::{
    Workspace,
    codec::{BufferView, Filter, Mode},
};
use serde_json::{Map, Value};

use super::file::File;
use crate::{
    error::Result,
    formats::{gltf::MESHOPT_COMPRESSION, source::Source},
};

/// Opens a file and decodes its compressed views.
pub(super) fn open<'a>(source: &'a Source<'a>) -> Result<File<'a>> {
    let mut file = File::open(source)?;
    unpack(&mut file)?;
    Ok(file)
}

/// Decodes all compressed views of a file. Afterwards the views refer to uncompressed buffers.
fn unpack(file: &mut File) -> Result<()> {
    let packed: Vec<(usize, Map<String, Value>)> = file
        .document
        .views()
        .filter_map(|view| {
            Some((view.index(), view.extension_value(MESHOPT_COMPRESSION)?.as_object()?.clone()))
        })
        .collect();
    if packed.is_empty() {
        return Ok(());
    }
    let mut plain = Vec::new();
    for (index, how) in &packed {
        plain.push(view(file, how).map_err(|problem| file.problem(format!("view {index}: {problem}")))?);
    }
    let mut root = std::mem::replace(
        &mut file.document,
        gltf::Document::from_json_without_validation(Default::default()),
    )
    .into_json();
    for ((index, _), bytes) in packed.iter().zip(plain) {
        let length = USize64::from(bytes.len());
        let view = &mut root.buffer_views[*index];
        (view.buffer, view.byte_offset, view.byte_length) =
            (json::Index::new(root.buffers.len() as u32), None, length);
        root.buffers.push(json::Buffer {
            byte_length: length,
            name: None,
            uri: None,
            extensions: None,
            extras: Default::default(),
        });
        file.buffers.push(Cow::Owned(bytes));
    }
    file.document = gltf::Document::from_json_without_validation(root);
    Ok(())
}

/// Decodes a view; an error states the problem.
fn view(file: &File, how: &Map<String, Value>) -> std::result::Result<Vec<u8>, String> {
    let number = |key: &str| how.get(key).and_then(Value::as_u64).map(|n| n as usize);
    let word = |key: &str| how.get(key).and_then(Value::as_str);
    let need = |key: &str| number(key).ok_or_else(|| format!("{MESHOPT_COMPRESSION} has no {key}"));
    let (length, stride, count) = (need("byteLength")?, need("byteStride")?, need("count")?);
    let offset = number("byteOffset").unwrap_or(0);
    let bytes = file.buffers.get(need("buffer")?).and_then(|b| b.get(offset..)?.get(..length));
    let bytes = bytes.ok_or("its compressed bytes lie outside their buffer")?;
    let unreadable = |problem: meshoptimizer_rs::Error| {
        format!("{MESHOPT_COMPRESSION} cannot be decompressed ({problem})")
    };
    let mode = Mode::parse(word("mode").unwrap_or_default()).map_err(unreadable)?;
    let filter = Filter::parse(word("filter").unwrap_or("NONE")).map_err(unreadable)?;
    let view = BufferView::new(mode, filter, count, stride).map_err(unreadable)?;
    file.spend(view.byte_length(), 1).map_err(|problem| problem.to_string())?;
    view.decode(bytes, &mut Workspace::default()).map_err(unreadable)
}
