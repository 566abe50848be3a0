//! Reads OBJ polylines: `v x y z` and `l a b c …`.
//!
//! Some programs write one element per strand, others one per edge. Elements that share an end are therefore joined,
//! unless a vertex has more than two neighbors.

use glam::Vec3;

use crate::{
    error::{At, Result},
    formats::{
        chain::chain,
        raw::{Raw, declared},
        source::{Source, excerpt},
    },
};

/// Reads the whole file.
pub(crate) fn read(source: &Source) -> Result<Raw> {
    let mut raw = Raw::new("obj polylines");
    let mut vertices: Vec<Vec3> = Vec::new();
    let mut elements: Vec<(u64, Vec<usize>)> = Vec::new();
    let mut faces = 0u64;
    for entry in source.lines() {
        let (line, text) = entry?;
        let mut words = text.split_ascii_whitespace();
        match words.next() {
            Some("v") => vertices.push(source.vec3(line, &mut words, "a vertex's")?),
            Some("l") => {
                let element: Vec<usize> =
                    words.map(|w| index(source, line, w, vertices.len())).collect::<Result<_>>()?;
                if element.is_empty() {
                    return Err(source.problem(At::Line(line), "a line element has no vertices"));
                }
                elements.push((line, element));
            }
            Some("f") => faces += 1,
            Some("#") => raw.declared = raw.declared.or(declared(text)),
            _ => {}
        }
    }
    if elements.is_empty() {
        let problem = if faces > 0 {
            format!(
                "the file is a mesh of {faces} faces without line elements; use it as the head of a groom"
            )
        } else {
            "the file has no line elements, so it has no strands".into()
        };
        return Err(source.problem(At::File, problem));
    }
    for (line, element) in &elements {
        if let Some(bad) = element.iter().find(|i| **i >= vertices.len()) {
            return Err(source.problem(
                At::Line(*line),
                format!("vertex {} does not exist; there are {}", bad + 1, vertices.len()),
            ));
        }
    }
    for strand in chain(elements.into_iter().map(|(_, e)| e).collect(), vertices.len()) {
        raw.strands.push(&strand.iter().map(|i| vertices[*i]).collect::<Vec<_>>());
    }
    Ok(raw)
}

/// Parses an index of an element: `7`, `7/3`, or `-1` for the last vertex before this line. The result counts from 0.
fn index(source: &Source, line: u64, word: &str, so_far: usize) -> Result<usize> {
    let number = word.split('/').next().and_then(|w| w.parse::<i64>().ok());
    let index = match number {
        Some(i) if i > 0 => Some(i as usize - 1),
        Some(i) if i < 0 => so_far.checked_sub(i.unsigned_abs() as usize),
        _ => None,
    };
    index.ok_or_else(|| {
        let problem = format!("“{}” is not a vertex of this file", excerpt(word));
        source.problem(At::Line(line), problem)
    })
}
