//! Vertices of given strands, carried by the strands that are drawn.

use anyhow::ensure;
use tresses::{
    Pose,
    glam::{Quat, Vec3},
    groom::{Strands, lint},
};

/// The place of a given vertex on a drawn strand.
#[derive(Clone, Copy, Debug)]
struct VertexAttachment {
    /// First vertex of the segment among all drawn vertices.
    vertex: u32,
    /// Position along the segment, 0 to 1.
    along: f32,
    /// From that position to the given vertex, at rest, meters.
    offset: Vec3,
    /// Direction of the segment at rest.
    direction: Vec3,
}

/// Places of all vertices of the given strands on the drawn ones.
#[derive(Debug)]
pub struct StrandAttachments {
    offsets: Vec<u32>,
    positions: Vec<Vec3>,
    /// First place of each strand; `None` for strands that the repair has dropped.
    strands: Vec<Option<usize>>,
    attachments: Vec<VertexAttachment>,
    /// Number of drawn vertices.
    drawn: usize,
}

impl StrandAttachments {
    /// Finds the places of `given` on `drawn`, the strands at rest. `order` has the index among repaired strands of
    /// each drawn strand.
    ///
    /// # Errors
    /// Fails if a given strand is not among the drawn ones.
    pub fn new(given: &Strands, drawn: &Strands, order: &[u32]) -> anyhow::Result<Self> {
        let (_, kept) = lint::repair_kept(&mut given.clone());
        let mut at = vec![None; kept.len()];
        for (i, source) in order.iter().enumerate() {
            if let Some(drawn_index) = at.get_mut(*source as usize) {
                *drawn_index = Some(i);
            }
        }
        let missing = at.iter().filter(|drawn_index| drawn_index.is_none()).count();
        ensure!(
            missing == 0,
            "the groom draws {} of {} strands, but given() needs all: set style.strands higher",
            kept.len() - missing,
            kept.len()
        );
        let mut all = Self {
            offsets: given.offsets.clone(),
            positions: given.positions.clone(),
            strands: vec![None; given.len()],
            attachments: Vec::with_capacity(given.positions.len()),
            drawn: drawn.positions.len(),
        };
        for (source, drawn_index) in kept.iter().zip(at) {
            let (i, Some(drawn_index)) = (*source as usize, drawn_index) else { continue };
            all.strands[i] = Some(all.attachments.len());
            attach(
                given.strand(i),
                drawn.strand(drawn_index),
                drawn.offsets[drawn_index],
                &mut all.attachments,
            );
        }
        Ok(all)
    }

    /// Returns the given vertices while the drawn vertices are at `drawn`, and the head at `head`.
    ///
    /// # Errors
    /// Fails if fewer vertices are drawn than at rest.
    pub fn deformed_positions(&self, drawn: &[Vec3], head: &Pose) -> anyhow::Result<Vec<Vec3>> {
        ensure!(drawn.len() == self.drawn, "given() needs every strand in full detail: set lod.mode to off");
        let mut out: Vec<Vec3> = Vec::with_capacity(self.positions.len());
        for (i, first) in self.strands.iter().enumerate() {
            let range = self.offsets[i] as usize..self.offsets[i + 1] as usize;
            let Some(first) = first else {
                out.extend(self.positions[range].iter().map(|p| head.point(*p)));
                continue;
            };
            for attachment in &self.attachments[*first..first + range.len()] {
                let [a, b] = [0, 1].map(|next| drawn[attachment.vertex as usize + next]);
                let now = (b - a).normalize_or(attachment.direction);
                let rotation = Quat::from_rotation_arc(attachment.direction, now);
                out.push(a.lerp(b, attachment.along) + rotation * attachment.offset);
            }
        }
        Ok(out)
    }
}

/// Appends the places of the vertices of `given` on the strand `drawn`, which begins at vertex `first`. Both have the
/// same course; a vertex is at the same share of the length.
fn attach(given: &[Vec3], drawn: &[Vec3], first: u32, attachments: &mut Vec<VertexAttachment>) {
    let fractions = |line: &[Vec3]| -> Vec<f32> {
        let mut sum = 0.0;
        let edges = line.windows(2).map(|edge| {
            // Vertices that are not finite have no length.
            sum += edge[0].distance(edge[1]).max(0.0);
            sum
        });
        let sums: Vec<f32> = std::iter::once(0.0).chain(edges).collect();
        let total = sums.last().copied().unwrap_or(0.0).max(1e-12);
        sums.into_iter().map(|sum| sum / total).collect()
    };
    let (of_given, of_drawn) = (fractions(given), fractions(drawn));
    let last = drawn.len().saturating_sub(2);
    let mut segment = 0;
    for (p, fraction) in given.iter().zip(of_given) {
        while segment < last && of_drawn[segment + 1] < fraction {
            segment += 1;
        }
        let (low, high) = (of_drawn[segment], of_drawn[segment + 1]);
        let along = ((fraction - low) / (high - low).max(1e-12)).clamp(0.0, 1.0);
        let [a, b] = [drawn[segment], drawn[segment + 1]];
        let direction = (b - a).normalize_or(Vec3::Y);
        attachments.push(VertexAttachment {
            vertex: first + segment as u32,
            along,
            offset: *p - a.lerp(b, along),
            direction,
        });
    }
}
