//! Curve of a new strand.

use super::kin::Kin;
use super::skin::Skin;
use crate::random::{Rng, lerp, smoothstep};
use crate::{SdfGrid, bind::Parents};
use glam::{Quat, Vec3};

/// Length over which the offset from the triangulated roots to the skin fades out along the strand, meters.
const EASE: f32 = 0.03;

/// Clearance that strands keep from the skin if their parents do, meters.
const CLEARANCE: f32 = 0.001;

/// Share of one random parent in the length of a strand; the rest is the mean length of the parents.
const OWN: f32 = 0.6;

/// Rounds of pushing out of the head and restoring lengths.
const ROUNDS: usize = 3;

/// Builds the curves of new strands; holds no state between strands.
pub(super) struct Shaper<'a> {
    pub(super) kin: &'a Kin,
    pub(super) field: Option<&'a SdfGrid>,
    pub(super) skin: Option<&'a Skin>,
}

impl Shaper<'_> {
    /// Writes the vertices of a strand with these parents into `line`. `root` lies on the triangulated surface of the
    /// input roots. With `spreads`, the distance from the parents varies along the strand as the parents' distance from
    /// their neighbors does.
    pub(super) fn grow(
        &self,
        root: Vec3,
        parents: &Parents,
        spreads: bool,
        rng: &mut Rng,
        line: &mut Vec<Vec3>,
    ) {
        let curves = &self.kin.curves;
        let lead = parents.strands[0];
        let range = curves.range(lead);
        let from: Vec<(u32, f32)> = parents.iter().collect();
        let (mut length, mut own, mut base) = (0.0, 0.0, Vec3::ZERO);
        let mut chance = rng.unit();
        for &(strand, weight) in &from {
            let parent_length = curves.length[strand as usize];
            length += weight * parent_length;
            base += weight * curves.path_points(strand)[0];
            if chance >= 0.0 {
                own = parent_length;
            }
            chance -= weight;
        }
        let length = lerp(length, own, OWN);
        let offset = root - base;
        let skin = self.skin.and_then(|skin| skin.at(root, from.iter().map(|(strand, _)| *strand)));
        let lift = skin.map_or(Vec3::ZERO, |skin| skin - root);
        let ease = EASE.min(0.5 * length);

        // Build the path with the mean step length of the parents, because the mean of two directions is shorter.
        line.clear();
        let mut lateral_offsets = Vec::with_capacity(range.len());
        let mut cursors = [0usize; 3];
        let mut last: Option<(Vec3, [Vec3; 3])> = None;
        for k in range.clone() {
            let s = curves.along[k];
            let mut on = [Vec3::ZERO; 3];
            let (mut mean_point, mut spread) = (Vec3::ZERO, 0.0);
            for (j, &(strand, weight)) in from.iter().enumerate() {
                on[j] = curves.path_at(strand, s, &mut cursors[j]);
                mean_point += weight * on[j];
                spread += weight * if spreads { self.kin.spread(strand, s) } else { 1.0 };
            }
            let p = match last {
                Some((before, parts)) => {
                    let step: f32 =
                        from.iter().enumerate().map(|(j, (_, w))| w * on[j].distance(parts[j])).sum();
                    let was = line[line.len() - 1];
                    was + (mean_point - before).normalize_or_zero() * step
                }
                None => mean_point,
            };
            last = Some((mean_point, on));
            line.push(p);
            lateral_offsets.push(
                curves.rotation[k] * offset * spread + lift * (1.0 - smoothstep(0.0, ease, s * length)),
            );
        }
        line.iter_mut().zip(&lateral_offsets).for_each(|(p, lateral_offset)| *p += *lateral_offset);
        let n = line.len();

        // Add the detail of the lead, rotated from the lead's path to the new path.
        let path = &curves.path[range.clone()];
        let rotated_details: Vec<Vec3> = (0..n)
            .map(|k| {
                let (a, b) = (k.saturating_sub(1), (k + 1).min(n - 1));
                let (u, v) = (path[b] - path[a], line[b] - line[a]);
                let rotation = match (u.try_normalize(), v.try_normalize()) {
                    (Some(u), Some(v)) => Quat::from_rotation_arc(u, v),
                    _ => Quat::IDENTITY,
                };
                rotation * curves.detail[range.start + k]
            })
            .collect();
        line.iter_mut().zip(rotated_details).for_each(|(p, detail)| *p += detail);

        let current_length = crate::curve::length(line);
        let first = line[0];
        if current_length > 0.0 {
            line.iter_mut().for_each(|p| *p = first + (*p - first) * (length / current_length));
        }
    }

    /// Pushes vertices out of the head, unless the strand's parents are inside it, and restores the edge lengths.
    pub(super) fn clear(&self, line: &mut [Vec3], parents: &Parents) {
        let Some(field) = self.field else { return };
        let along = &self.kin.curves.along[self.kin.curves.range(parents.strands[0])];
        let lengths = lengths(line);
        for _ in 0..ROUNDS {
            let mut was_pushed = false;
            for (k, p) in line.iter_mut().enumerate().skip(1) {
                let d = field.sample(*p);
                if d >= CLEARANCE {
                    continue;
                }
                let parent_clearance: f32 =
                    parents.iter().map(|(i, w)| w * self.kin.clear(i, along[k])).sum();
                let min_clearance = parent_clearance.min(CLEARANCE);
                if d < min_clearance - 1e-4 {
                    *p += field.normal(*p) * (min_clearance - d);
                    was_pushed = true;
                }
            }
            if !was_pushed {
                return;
            }
            // Aim each edge at the current position of its end, so that later vertices stay in place.
            for k in 1..line.len() {
                let edge = (line[k] - line[k - 1]).normalize_or(Vec3::NEG_Y);
                line[k] = line[k - 1] + edge * lengths[k - 1];
            }
        }
    }
}

/// Returns the edge lengths of `line`.
pub(super) fn lengths(line: &[Vec3]) -> Vec<f32> {
    line.windows(2).map(|w| w[0].distance(w[1])).collect()
}

/// Restores the edge lengths of `line`; each vertex carries the later ones along.
pub(super) fn restore(line: &mut [Vec3], lengths: &[f32]) {
    let Some(mut was) = line.first().copied() else { return };
    for k in 1..line.len() {
        let edge = (line[k] - was).normalize_or(Vec3::NEG_Y);
        was = line[k];
        line[k] = line[k - 1] + edge * lengths[k - 1];
    }
}
