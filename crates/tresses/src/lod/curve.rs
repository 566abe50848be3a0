//! Error of drawing strands with fewer segments: how far they deviate, and by what factor they become shorter.

use crate::groom::BoundStrands;
use glam::Vec3;

/// Maximum number of strands that are measured, approximately.
const SAMPLES: usize = 256;

/// Error of drawing a groom's strands with fewer segments.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CurveTable {
    /// `error[s - 1]`: 90th percentile of the strands' maximum deviation with `s` segments, meters. Falls with `s`; 0
    /// with all segments.
    error: Vec<f32>,
    /// `length[s - 1]`: remaining share of the strands' length.
    length: Vec<f32>,
}

impl CurveTable {
    /// Measures evenly picked `strands` at rest.
    pub fn new(strands: &BoundStrands) -> Self {
        let segments = strands.vertex_count.saturating_sub(1).max(1) as usize;
        let step = (strands.len() / SAMPLES).max(1);
        let lines: Vec<Vec<Vec3>> =
            (0..strands.len()).step_by(step).map(|i| strands.rest_positions(i).collect()).collect();
        let total: f32 = lines.iter().map(|line| length(line)).sum();
        let mut table = Self { error: Vec::new(), length: Vec::new() };
        for s in 1..=segments {
            let coarse: Vec<Vec<Vec3>> = lines.iter().map(|line| resample(line, s as f32)).collect();
            let mut errors: Vec<f32> = lines.iter().zip(&coarse).map(|(a, b)| stray(a, b)).collect();
            errors.sort_by(f32::total_cmp);
            let high = errors.get(errors.len() * 9 / 10).copied().unwrap_or(0.0);
            table.error.push(if s == segments { 0.0 } else { high });
            let left = coarse.iter().map(|line| length(line)).sum::<f32>() / total.max(1e-12);
            table.length.push(if s == segments { 1.0 } else { left.clamp(0.1, 1.0) });
        }
        // More segments are never worse.
        for s in (1..segments).rev() {
            table.error[s - 1] = table.error[s - 1].max(table.error[s]);
        }
        table
    }

    /// Returns the number of segments, possibly fractional, with which strands deviate by at most `error` meters. Falls
    /// continuously as the error grows.
    pub fn segments(&self, error: f32) -> f32 {
        let Some(enough) = self.error.iter().position(|e| *e <= error) else { return 1.0 };
        if enough == 0 {
            return 1.0;
        }
        let (above, below) = (self.error[enough - 1], self.error[enough]);
        enough as f32 + (above - error.max(0.0)) / (above - below)
    }

    /// Returns the remaining share of the strands' length with `segments` segments.
    pub fn length(&self, segments: f32) -> f32 {
        let at = (segments - 1.0).clamp(0.0, (self.length.len() - 1) as f32);
        let i = (at as usize).min(self.length.len().saturating_sub(2));
        let next = (i + 1).min(self.length.len() - 1);
        self.length[i] + (self.length[next] - self.length[i]) * (at - i as f32)
    }
}

/// Returns the length of a polyline.
fn length(line: &[Vec3]) -> f32 {
    line.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// Resamples `line` to `segments` segments as drawn: vertices at equal steps of its parameter, the last one at its end.
pub fn resample(line: &[Vec3], segments: f32) -> Vec<Vec3> {
    let last = line.len() - 1;
    let step = last as f32 / segments;
    (0..=segments.ceil() as usize)
        .map(|j| {
            let x = (j as f32 * step).min(last as f32);
            let k = (x as usize).min(last - 1);
            line[k].lerp(line[k + 1], x - k as f32)
        })
        .collect()
}

/// Returns the largest distance of a vertex of `line` from `coarse`.
fn stray(line: &[Vec3], coarse: &[Vec3]) -> f32 {
    let nearest = |p: &Vec3| {
        coarse
            .windows(2)
            .map(|w| {
                let edge = w[1] - w[0];
                let t = ((*p - w[0]).dot(edge) / edge.length_squared().max(1e-20)).clamp(0.0, 1.0);
                p.distance(w[0] + edge * t)
            })
            .fold(f32::INFINITY, f32::min)
    };
    line.iter().map(nearest).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{groom::Influence, strands::Strand};

    /// A strand along a quarter of a circle with a radius of 10 cm, or a helix of radius `curl` around it.
    fn bent(curl: f32) -> BoundStrands {
        let mut strands = BoundStrands::new(33);
        let line: Vec<_> = (0..33)
            .map(|j| {
                let a = j as f32 / 32.0 * std::f32::consts::FRAC_PI_2;
                let out = Vec3::new(a.cos(), a.sin(), 0.0);
                out * (0.1 + curl * (20.0 * a).cos()) + Vec3::Z * curl * (20.0 * a).sin()
            })
            .collect();
        let influence = Influence { guide: 0, weight: 1.0, scale: 1.0 };
        strands.push(Strand::default(), &line, &[1.0; 33], &[influence]);
        strands
    }

    #[test]
    fn arc_error_equals_sagitta() {
        let table = CurveTable::new(&bent(0.0));
        for s in [2u32, 4, 8] {
            // The sagitta of a chord of the circle.
            let sagitta = 0.1 * (1.0 - (std::f32::consts::FRAC_PI_4 / s as f32).cos());
            let error = table.error[s as usize - 1];
            assert!((error / sagitta - 1.0).abs() < 0.05, "{s}: {error} {sagitta}");
        }
        assert!((table.length(1.0) - 0.9003).abs() < 0.001, "{}", table.length(1.0));
        assert_eq!((table.segments(0.0), table.length(32.0)), (32.0, 1.0));
        assert_eq!(table.segments(1.0), 1.0);
        let mut last = 33.0;
        for i in 0..2000 {
            let s = table.segments(i as f32 * 2e-5);
            assert!(s <= last && (i == 0 || s >= 1.0), "{i}: {s} {last}");
            last = s;
        }
    }

    #[test]
    fn curls_need_more_segments_than_arcs() {
        let (arc, curls) = (CurveTable::new(&bent(0.0)), CurveTable::new(&bent(0.005)));
        assert!(arc.segments(1e-3) < 8.0 && curls.segments(1e-3) > 16.0);
        // Two chords: of the arc, and of the helix from its outside to its inside and back.
        let chord = |a: f32, b: f32| (a * a + b * b - 2.0 * a * b * std::f32::consts::FRAC_PI_4.cos()).sqrt();
        let left = |curl: f32| {
            let full = length(&bent(curl).rest_positions(0).collect::<Vec<_>>());
            2.0 * chord(0.1 + curl, 0.1 - curl) / full
        };
        assert!((arc.length(2.0) - left(0.0)).abs() < 2e-3, "{} {}", arc.length(2.0), left(0.0));
        assert!((curls.length(2.0) - left(0.005)).abs() < 2e-3, "{} {}", curls.length(2.0), left(0.005));
    }
}
