//! Real tangles of hair: built-in styles as strands on the CPU and on the GPU.

use tresses::{
    Context,
    glam::Vec3,
    groom::{
        bound::Strand,
        grow::{self, Growth},
        hash::pcg,
        styles::{self, Style},
    },
    light::Sphere,
    low_level::{StrandBuffers, StrandVertex, pack_tangent},
};

/// Strands with a radius at every vertex, meters.
pub struct Tangle {
    pub vertex_count: usize,
    pub positions: Vec<Vec3>,
    pub radii: Vec<f32>,
}

impl Tangle {
    /// Creates a built-in style of `count` strands, as combed, before draping.
    pub fn style(name: &str, count: u32) -> Self {
        let style: Style = name.parse().expect("a style");
        let scalp = crate::common::scalp(48);
        let guides = styles::guides(&style, &*scalp);
        let growth = Growth::for_style(&style).with_strands(count);
        let grown = grow::grow(&guides, &growth, &*scalp).expect("a style grows");
        let n = grown.vertex_count;
        let radii = grown.radii.iter().enumerate().map(|(i, share)| share * grown.strands[i / n].radius);
        Self { vertex_count: n, radii: radii.collect(), positions: grown.positions }
    }

    /// Returns the number of strands.
    pub fn len(&self) -> usize {
        self.positions.len() / self.vertex_count
    }

    /// Returns a sphere around the strands, with room for a turning light.
    pub fn focus(&self) -> Sphere {
        let (lo, hi) = self
            .positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
        Sphere::around(lo, hi)
    }

    /// Uploads the strands in the layout that `light` reads.
    pub fn upload(&self, context: &Context) -> StrandBuffers {
        let n = self.vertex_count;
        let mut vertices = Vec::with_capacity(self.positions.len());
        let mut strands = Vec::with_capacity(self.len());
        for (i, (line, radii)) in self.positions.chunks(n).zip(self.radii.chunks(n)).enumerate() {
            let most = radii.iter().copied().fold(0.0, f32::max);
            for k in 0..n {
                let tangent = (line[(k + 1).min(n - 1)] - line[k.saturating_sub(1)]).normalize_or(Vec3::Y);
                let tangent = pack_tangent(tangent, radii[k] / most);
                vertices.push(StrandVertex { position: line[k], tangent });
            }
            strands.push(Strand { radius: most, seed: pcg(i as u32), root_color: 0, tip_color: 0 });
        }
        crate::common::upload(context, n, &vertices, &strands)
    }
}
