//! Grown strands in the form that the GPU needs.

use super::{GUIDE_VERTICES, StyledGuides};
use crate::{
    Groom, Guides,
    bound::{BoundStrands, Influence, Strand},
    grow::GrownStrands,
};

/// Grown strands on their guides, packed.
pub fn bound(styled: &StyledGuides, grown: &GrownStrands) -> Groom {
    let mut guides = Guides::new(GUIDE_VERTICES as u32);
    for (guide, stiffness) in styled.guides.iter().zip(&styled.stiffness) {
        guides.push(guide, *stiffness, false);
    }
    let mut strands = BoundStrands::new(grown.vertex_count as u32);
    let mut load = vec![0.0; guides.len()];
    for (i, strand) in grown.strands.iter().enumerate() {
        let influences: [Influence; 3] = std::array::from_fn(|k| Influence {
            guide: strand.guides[k],
            weight: strand.weights[k],
            scale: strand.scale[k],
        });
        for influence in &influences {
            load[influence.guide as usize] += influence.weight;
        }
        let radii = &grown.radii[i * grown.vertex_count..(i + 1) * grown.vertex_count];
        let [root_color, tip_color] = strand.colors;
        let header = Strand { radius: strand.radius, seed: strand.seed, root_color, tip_color };
        strands.push(header, grown.strand(i), radii, &influences);
    }
    guides.strands = load;
    Groom { guides, strands }
}
