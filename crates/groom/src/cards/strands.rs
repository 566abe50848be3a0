//! Cards as render strands, so that they follow simulated guides.

use super::{CardMesh, Cards};
use crate::{
    BoundStrands, Error, Groom, Influence, Result,
    bound::Strand,
    card_sheet::{CardSheet, CardStrip},
    curve,
    hash::pcg,
};
use glam::{Vec2, Vec3};

/// Vertices of a column.
const ROWS: u32 = 17;
/// Guides that a strand may follow.
const INFLUENCES: usize = 3;

/// The cards of a level as render strands: each column of a card's vertices is a strand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CardStrands {
    /// The guides of the groom, and the columns of all cards.
    pub groom: Groom,
    /// How the columns are drawn.
    pub sheet: CardSheet,
}

impl Cards {
    /// Returns the cards of a level as strands that follow the guides of `groom`. The cards must be baked from the
    /// strands of this groom at rest ([`BoundStrands::unbound`]). All columns of a card follow the same guides, those
    /// that most of its hair follows, so the card does not tear. A column casts the shadow of its share of the hair.
    ///
    /// # Errors
    /// [`Error::Unusable`] for a helmet, a level that does not exist, and another groom.
    pub fn strands(&self, level: usize, groom: &Groom) -> Result<CardStrands> {
        let unusable = |why: &str| Err(Error::Unusable(why.into()));
        let Some(level) = self.levels.get(level) else { return unusable("the cards have no such level") };
        if level.helmet {
            return unusable("a helmet has no cards that could follow guides");
        }
        let lengths: Vec<f32> =
            (0..groom.guides.len()).map(|i| curve::length(groom.guides.guide(i))).collect();
        let (texture, mean) = self.textures.tones();
        let mut cards = CardStrands {
            groom: Groom { guides: groom.guides.clone(), strands: BoundStrands::new(ROWS) },
            sheet: CardSheet {
                strips: Vec::new(),
                strands: groom.strands.len() as u32,
                texture,
                gain: 1.0 / mean.max(0.05),
            },
        };
        for (card, members) in level.locks.iter().enumerate() {
            if members.iter().any(|i| *i as usize >= groom.strands.len()) {
                return unusable("the cards were baked from another groom");
            }
            let columns = columns(&level.mesh, card);
            let length = columns[0].0.windows(2).map(|ends| ends[0].distance(ends[1])).sum::<f32>();
            let mut influences = influences(&groom.strands, members);
            for influence in &mut influences {
                influence.scale = length / lengths[influence.guide as usize].max(1e-9);
            }
            let (strand, radii) = fibers(&groom.strands, members, columns.len());
            let first = cards.groom.strands.len() as u32;
            for (column, (positions, _)) in (0..).zip(&columns) {
                let strand = Strand { seed: pcg(first + column), ..strand };
                cards.groom.strands.push(strand, positions, &radii, &influences);
            }
            for (left, pair) in (first..).zip(columns.windows(2)) {
                cards.sheet.strips.push(CardStrip {
                    columns: [left, left + 1],
                    roots: [pair[0].1[0], pair[1].1[0]],
                    tips: [pair[0].1[1], pair[1].1[1]],
                });
            }
        }
        Ok(cards)
    }
}

/// Positions of a column at equal distances along the card, and the texture coordinates of its ends.
type Column = (Vec<Vec3>, [Vec2; 2]);

/// Returns the columns of a card.
fn columns(mesh: &CardMesh, card: usize) -> Vec<Column> {
    let range = mesh.range(card);
    let (first, along) = (range.start, &mesh.along[range.clone()]);
    let wide = along.iter().take_while(|distance| **distance == along[0]).count();
    let rows: Vec<f32> = along.iter().copied().step_by(wide).collect();
    let last = rows.len() - 1;
    let column = |c: usize| {
        let at = |row: usize| mesh.positions[first + row * wide + c];
        let positions = (0..ROWS).map(|k| {
            let distance = rows[0] + (rows[last] - rows[0]) * k as f32 / (ROWS - 1) as f32;
            let next = rows.partition_point(|row| *row <= distance).clamp(1, last);
            let t = (distance - rows[next - 1]) / (rows[next] - rows[next - 1]).max(1e-9);
            at(next - 1).lerp(at(next), t.min(1.0))
        });
        (positions.collect(), [mesh.uvs[first + c], mesh.uvs[first + last * wide + c]])
    };
    (0..wide).map(column).collect()
}

/// Returns the guides that most of the hair of a card follows, without scales.
fn influences(strands: &BoundStrands, members: &[u32]) -> Vec<Influence> {
    let mut totals = std::collections::BTreeMap::new();
    for i in members {
        let binding = &strands.bindings[*i as usize];
        let weights = [1.0 - binding.weight_b - binding.weight_c, binding.weight_b, binding.weight_c];
        for (guide, weight) in binding.guides.into_iter().zip(weights) {
            *totals.entry(guide).or_insert(0.0) += weight;
        }
    }
    let mut ranked: Vec<(u32, f32)> = totals.into_iter().filter(|(_, weight)| *weight > 0.0).collect();
    ranked.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    ranked.truncate(INFLUENCES);
    let sum: f32 = ranked.iter().map(|(_, weight)| weight).sum();
    ranked.into_iter().map(|(guide, weight)| Influence { guide, weight: weight / sum, scale: 1.0 }).collect()
}

/// Returns a strand as wide as the share of one of `columns` in the hair of a card, with its color, and the fraction of
/// this radius at each vertex: hair that ends before the tip of the card narrows it.
fn fibers(strands: &BoundStrands, members: &[u32], columns: usize) -> (Strand, Vec<f32>) {
    let length = |i: u32| {
        let positions: Vec<Vec3> = strands.rest_positions(i as usize).collect();
        curve::length(&positions)
    };
    let lengths: Vec<f32> = members.iter().map(|i| length(*i)).collect();
    let longest = lengths.iter().copied().fold(1e-9, f32::max);
    let strand = |i: u32| &strands.strands[i as usize];
    let sum: f32 = members.iter().map(|i| strand(*i).radius).sum();
    let radii = (0..ROWS).map(|k| {
        let reached = longest * k as f32 / (ROWS - 1) as f32;
        let reaching = members.iter().zip(&lengths).filter(|(_, length)| **length >= reached);
        reaching.map(|(i, _)| strand(*i).radius).sum::<f32>() / sum.max(1e-12)
    });
    let representative = members[members.len() / 2];
    (Strand { radius: sum / columns as f32, ..*strand(representative) }, radii.collect())
}
