//! OBJ polylines: `v x y z` and `l a b c …`.
//!
//! Some programs write a strand as one element, others one element per edge; elements that share an
//! end are therefore chained, as long as no vertex has more than two neighbours.

use glam::Vec3;

use super::{Raw, declared, source::Source};
use crate::error::{At, Result};

/// Reads the whole file.
pub(super) fn read(source: &Source) -> Result<Raw> {
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
                    return Err(source.problem(At::Line(line), "a line element without vertices"));
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
            format!("a mesh of {faces} faces without line elements; it can be the head of one")
        } else {
            "no line elements, hence no strands".into()
        };
        return Err(source.problem(At::File, problem));
    }
    for (line, element) in &elements {
        if let Some(bad) = element.iter().find(|i| **i >= vertices.len()) {
            return Err(source.problem(
                At::Line(*line),
                format!("vertex {} does not exist, there are {}", bad + 1, vertices.len()),
            ));
        }
    }
    for strand in chain(elements.into_iter().map(|(_, e)| e).collect(), vertices.len()) {
        raw.strands.push(&strand.iter().map(|i| vertices[*i]).collect::<Vec<_>>());
    }
    Ok(raw)
}

/// One index of an element, counted from 0: `7`, `7/3`, or `-1` for the vertex before this line.
fn index(source: &Source, line: u64, word: &str, so_far: usize) -> Result<usize> {
    let number = word.split('/').next().and_then(|w| w.parse::<i64>().ok());
    let index = match number {
        Some(i) if i > 0 => Some(i as usize - 1),
        Some(i) if i < 0 => so_far.checked_sub(i.unsigned_abs() as usize),
        _ => None,
    };
    index.ok_or_else(|| {
        let problem = format!("“{}” is no vertex of this file", super::source::excerpt(word));
        source.problem(At::Line(line), problem)
    })
}

/// Joins elements end to end. An element of more than two vertices keeps its direction; where all
/// have two, a strand starts at its end with the lower index.
pub(super) fn chain(elements: Vec<Vec<usize>>, vertices: usize) -> Vec<Vec<usize>> {
    let mut ends: Vec<Vec<usize>> = vec![Vec::new(); vertices];
    for (i, e) in elements.iter().enumerate() {
        for end in [e[0], e[e.len() - 1]] {
            ends[end].push(i);
        }
    }
    let joinable = elements.iter().all(|e| e.len() == 2 && e[0] != e[1]) && ends.iter().all(|e| e.len() <= 2);
    if !joinable {
        return elements;
    }
    let mut used = vec![false; elements.len()];
    let mut strands = Vec::new();
    // Free ends first; what is left after them are closed rings, cut at their lowest vertex.
    for free in [true, false] {
        for start in 0..vertices {
            if free != (ends[start].len() == 1) {
                continue;
            }
            let (mut strand, mut at) = (vec![start], start);
            while let Some(e) = ends[at].iter().copied().find(|e| !used[*e]) {
                used[e] = true;
                at = if elements[e][0] == at { elements[e][1] } else { elements[e][0] };
                strand.push(at);
            }
            if strand.len() == 2 {
                // An element of its own keeps its direction too.
                strand.clone_from(&elements[ends[start][0]]);
            }
            if strand.len() > 1 {
                strands.push(strand);
            }
        }
    }
    strands
}

#[cfg(test)]
mod tests {
    use super::chain;

    #[test]
    fn edges_become_strands_whatever_their_order() {
        let edges = vec![vec![2, 1], vec![4, 3], vec![0, 1]];
        assert_eq!(chain(edges, 5), vec![vec![0, 1, 2], vec![4, 3]]);
    }

    #[test]
    fn whole_strands_and_forks_stay_as_they_are() {
        let whole = vec![vec![3, 2, 1], vec![0, 4, 5]];
        assert_eq!(chain(whole.clone(), 6), whole);
        let fork = vec![vec![0, 1], vec![0, 2], vec![0, 3]];
        assert_eq!(chain(fork.clone(), 4), fork);
    }
}
