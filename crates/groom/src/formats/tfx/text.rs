//! `.tfx` version 2, text.
//!
//! Header lines `name value…` precede the strands. Each strand is a line `strand I numVerts N texcoord U V` and `N`
//! lines of three numbers. `bothEndsImmovable 1` pins every tip of the file; `numFollowHairsPerGuideHair` and
//! `maxRadiusAroundGuideHair` request child strands around each strand.

use glam::{EulerRot, Quat, Vec2, Vec3};

use crate::{
    error::{At, Result},
    formats::{raw::Raw, source::Source},
};

/// Reads the whole file.
pub(super) fn read(source: &Source) -> Result<Raw> {
    let mut raw = Raw::new("tfx 2, text");
    let strands = &mut raw.strands;
    let (mut scale, mut rotation, mut translation) = (1.0, Vec3::ZERO, Vec3::ZERO);
    let (mut followers, mut radius) = (0, None);
    let (mut both_ends, mut promised, mut remaining) = (false, None, 0u64);
    let mut last = 1;
    strands.offsets.push(0);
    for entry in source.lines() {
        let (line, text) = entry?;
        let mut words = text.split_ascii_whitespace();
        let Some(first) = words.next().filter(|w| !w.starts_with('#')) else { continue };
        last = line;
        if remaining > 0 {
            let mut words = std::iter::once(first).chain(words);
            strands.positions.push(source.vec3(line, &mut words, "a vertex's")?);
            remaining -= 1;
            if remaining == 0 {
                strands.offsets.push(strands.positions.len() as u32);
            }
            continue;
        }
        match first {
            "scale" => scale = source.number(line, words.next(), "the scale")?,
            "rotation" => rotation = source.vec3(line, &mut words, "the rotation's")?,
            "translation" => translation = source.vec3(line, &mut words, "the translation's")?,
            "bothEndsImmovable" => both_ends = words.next().is_some_and(|w| w != "0"),
            "numStrands" => promised = Some(source.count(line, words.next(), "numStrands")?),
            "numFollowHairsPerGuideHair" => {
                followers = source.count(line, words.next(), "numFollowHairsPerGuideHair")?;
            }
            "maxRadiusAroundGuideHair" => {
                let value = source.number(line, words.next(), "maxRadiusAroundGuideHair")?;
                if value < 0.0 {
                    let problem = format!("maxRadiusAroundGuideHair is {value}, but must not be negative");
                    return Err(source.problem(At::Line(line), problem));
                }
                radius = Some(value).filter(|value| value.is_finite());
            }
            "strand" => {
                let rest: Vec<&str> = words.collect();
                let after = |key| rest.iter().position(|w| *w == key).map(|i| &rest[i + 1..]);
                remaining = source.count(
                    line,
                    after("numVerts").and_then(|w| w.first().copied()),
                    "the strand's numVerts",
                )?;
                if remaining == 0 {
                    return Err(source.problem(At::Line(line), "the strand has 0 vertices"));
                }
                if let Some(uv) = after("texcoord") {
                    let part = |i: usize| source.number(line, uv.get(i).copied(), "a texture coordinate");
                    strands.root_uvs.push(Vec2::new(part(0)?, part(1)?));
                }
            }
            // `version`, simulation parameters, `is sorted`: not geometry.
            _ if first.starts_with(|c: char| c.is_ascii_alphabetic()) => {}
            _ => {
                return Err(
                    source.problem(At::Line(line), "the line is invalid, or is a vertex outside a strand")
                );
            }
        }
    }
    let found = strands.len() as u64;
    if remaining > 0 {
        return Err(source.problem(
            At::Line(last),
            format!("the file ends here, {remaining} vertices before the end of strand {found}"),
        ));
    }
    if let Some(promised) = promised.filter(|n| *n != found) {
        return Err(source.problem(
            At::Line(last),
            format!("the file ends here with {found} strands, but numStrands says {promised}"),
        ));
    }
    if strands.root_uvs.len() != strands.len() || strands.root_uvs.iter().all(|uv| *uv == Vec2::ZERO) {
        strands.root_uvs.clear();
    }
    if both_ends {
        strands.tip_pinned = vec![true; strands.len()];
    }
    if scale != 1.0 || rotation != Vec3::ZERO || translation != Vec3::ZERO {
        let radians = rotation * (std::f32::consts::PI / 180.0);
        let quaternion = Quat::from_euler(EulerRot::XYZ, radians.x, radians.y, radians.z);
        for p in &mut strands.positions {
            *p = quaternion * (*p * scale) + translation;
        }
        raw.notes.push(
            "the header's scale, rotation (degrees, x then y then z) and translation are applied".into(),
        );
    }
    raw.follow(followers, radius.map(|radius| radius * scale.abs()));
    Ok(raw)
}
