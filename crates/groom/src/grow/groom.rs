//! Conversion of grown strands to the form that the GPU needs.

use super::GrownStrands;
use crate::{
    Groom, Guides,
    bound::{BoundStrands, Influence, Strand},
    styles::{GUIDE_VERTICES, StyledGuides},
};

impl GrownStrands {
    /// Builds the groom of these strands and `styled`, the guides that they grew from.
    pub fn bind(&self, styled: &StyledGuides) -> Groom {
        let mut guides = Guides::new(GUIDE_VERTICES as u32);
        for (guide, stiffness) in styled.guides.iter().zip(&styled.stiffness) {
            guides.push(guide, *stiffness, false);
        }
        let mut strands = BoundStrands::new(self.vertex_count as u32);
        guides.strands = vec![0.0; guides.len()];
        for (i, strand) in self.strands.iter().enumerate() {
            let influences: [Influence; 3] = std::array::from_fn(|k| Influence {
                guide: strand.guides[k],
                weight: strand.weights[k],
                scale: strand.scale[k],
            });
            for influence in &influences {
                guides.strands[influence.guide as usize] += influence.weight;
            }
            let radii = &self.radii[i * self.vertex_count..(i + 1) * self.vertex_count];
            let [root_color, tip_color] = strand.colors;
            let header = Strand { radius: strand.radius, seed: strand.seed, root_color, tip_color };
            strands.push(header, self.strand(i), radii, &influences);
        }
        Groom { guides, strands }
    }
}
