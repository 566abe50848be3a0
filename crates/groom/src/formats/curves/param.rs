//! Parameters of curves: values for a whole object, per curve or per point.

use crate::error::At;

/// The values of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::formats) struct Param {
    /// All numbers, flattened.
    pub flat: Vec<f32>,
    /// Numbers per value, as the file states.
    pub width: usize,
    /// Scope, as the file states.
    pub scope: Option<AttributeScope>,
    /// Whether the file stores integers.
    pub is_integer: bool,
    /// Position in the file.
    pub at: At,
}

/// Scope of a parameter: what one value applies to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::formats) enum AttributeScope {
    All,
    Curve,
    Point,
}

impl Param {
    /// Returns the values at `indices`, `width` numbers each. Fails with the first invalid index.
    pub fn gather(values: &[f32], indices: &[i64], width: usize) -> Result<Vec<f32>, i64> {
        let mut flat = Vec::with_capacity(indices.len());
        for index in indices {
            let start = usize::try_from(*index).ok().and_then(|i| i.checked_mul(width));
            let value = start.and_then(|start| values.get(start..)?.get(..width));
            flat.extend_from_slice(value.ok_or(*index)?);
        }
        Ok(flat)
    }

    /// Returns the scope of values of `width` numbers each; `None` if their count fits no scope.
    pub fn find_scope(&self, width: usize, curves: usize, points: usize) -> Option<AttributeScope> {
        let count = self.flat.len() / width.max(1);
        let fits = |scope| match scope {
            AttributeScope::All => count == 1,
            AttributeScope::Curve => count == curves,
            AttributeScope::Point => count == points,
        };
        // The stated scope comes first, but the count must fit: scopes are missing or wrong more often than counts.
        let all = [AttributeScope::Point, AttributeScope::Curve, AttributeScope::All];
        self.scope
            .into_iter()
            .chain(all)
            .find(|scope| self.flat.len().is_multiple_of(width.max(1)) && fits(*scope))
    }

    /// Returns the value at `index`; numbers beyond `width` are 0.
    pub fn value<const N: usize>(&self, width: usize, index: usize) -> [f32; N] {
        std::array::from_fn(|k| {
            if k < width { self.flat.get(index * width + k).copied().unwrap_or(0.0) } else { 0.0 }
        })
    }

    /// Returns one value of `N` numbers per curve; of values per point, the one at each curve's first point. `None` if
    /// the count fits no scope. `starts` has the index of the first point of each curve, and the end of the last curve.
    pub fn per_curve<const N: usize>(&self, width: usize, starts: &[u32]) -> Option<Vec<[f32; N]>> {
        let (curves, points) = (starts.len() - 1, starts.last().map_or(0, |end| *end as usize));
        let scope = self.find_scope(width, curves, points)?;
        let index = |i: usize| match scope {
            AttributeScope::All => 0,
            AttributeScope::Curve => i,
            AttributeScope::Point => starts[i] as usize,
        };
        Some((0..curves).map(|i| self.value(width, index(i))).collect())
    }

    /// Converts one number per segment end (`varying`) to one per control point. The curves are Bézier curves or, with
    /// `inner`, cubic curves that end before their outermost points. Returns `None` if the count differs from the
    /// number of segment ends.
    pub fn varying_per_point(&self, starts: &[u32], inner: bool) -> Option<Vec<f32>> {
        if inner {
            return self.varying_per_inner_point(starts);
        }
        // A Bézier curve of n segments has n + 1 segment ends and 3 n + 1 points.
        let intervals =
            |w: &[u32]| ((w[1] - w[0]) as usize).checked_sub(1).filter(|n| *n > 0 && n.is_multiple_of(3));
        let end_count: Option<usize> = starts.windows(2).map(|w| intervals(w).map(|n| n / 3 + 1)).sum();
        if end_count != Some(self.flat.len()) {
            return None;
        }
        let mut first = 0;
        let mut all = Vec::with_capacity(starts.last().map_or(0, |end| *end as usize));
        for w in starts.windows(2) {
            let points = (w[1] - w[0]) as usize;
            let end = |k: usize| self.flat[first + k.min((points - 1) / 3)];
            all.extend(
                (0..points).map(|k| end(k / 3) + (end(k / 3 + 1) - end(k / 3)) * (k % 3) as f32 / 3.0),
            );
            first += (points - 1) / 3 + 1;
        }
        Some(all)
    }

    /// [`Self::varying_per_point`] for `inner` curves: their segments end at all points but the outermost, which take
    /// the number of the point next to them.
    fn varying_per_inner_point(&self, starts: &[u32]) -> Option<Vec<f32>> {
        let inner_count = |w: &[u32]| ((w[1] - w[0]) as usize).checked_sub(2).filter(|n| *n > 1);
        let end_count: Option<usize> = starts.windows(2).map(inner_count).sum();
        if end_count != Some(self.flat.len()) {
            return None;
        }
        let mut first = 0;
        let mut all = Vec::with_capacity(starts.last().map_or(0, |end| *end as usize));
        for count in starts.windows(2).filter_map(inner_count) {
            all.extend((0..count + 2).map(|k| self.flat[first + k.saturating_sub(1).min(count - 1)]));
            first += count;
        }
        Some(all)
    }

    /// Returns the numbers per value: the numbers per curve if they divide evenly and are at most 3, else the width
    /// that the file states.
    pub fn width(&self, curves: usize) -> usize {
        match curves {
            0 => self.width,
            _ if self.flat.len().is_multiple_of(curves) && self.flat.len() / curves <= 3 => {
                self.flat.len() / curves
            }
            _ => self.width,
        }
    }
}

impl std::fmt::Display for Param {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} numbers{}", self.flat.len(), self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn param(flat: &[f32], scope: Option<AttributeScope>) -> Param {
        Param { flat: flat.to_vec(), width: 1, scope, is_integer: false, at: At::File }
    }

    #[test]
    fn scope_follows_number_of_values() {
        // Two curves of four and seven points.
        let starts = [0, 4, 11];
        let find_scope = |count: usize, scope| param(&vec![1.0; count], scope).find_scope(1, 2, 11);
        assert_eq!(
            [1, 2, 11, 3].map(|n| find_scope(n, None)),
            [Some(AttributeScope::All), Some(AttributeScope::Curve), Some(AttributeScope::Point), None]
        );
        // A scope that does not fit is ignored.
        assert_eq!(
            (find_scope(11, Some(AttributeScope::Curve)), find_scope(2, Some(AttributeScope::Curve))),
            (Some(AttributeScope::Point), Some(AttributeScope::Curve))
        );
        let interpolated = param(&[0.0, 3.0, 6.0, 9.0, 0.0], None).varying_per_point(&starts, false).unwrap();
        assert_eq!(interpolated, [0.0, 1.0, 2.0, 3.0, 6.0, 7.0, 8.0, 9.0, 6.0, 3.0, 0.0]);
        assert_eq!(param(&[0.0; 4], None).varying_per_point(&starts, false), None);
        assert_eq!(param(&[0.0; 5], None).varying_per_point(&[0, 4, 10], false), None);
        // Two and five segment ends between the outermost points.
        let inner = param(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0], None);
        let expected = [1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 5.0, 6.0, 7.0, 7.0];
        assert_eq!(inner.varying_per_point(&starts, true).unwrap(), expected);
        assert_eq!(
            (inner.varying_per_point(&[0, 4, 10], true), inner.varying_per_point(&starts, false)),
            (None, None)
        );
        let firsts = param(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0], None);
        assert_eq!(firsts.per_curve::<1>(1, &starts), Some(vec![[0.0], [4.0]]));
        assert_eq!(
            param(&[1.0, 2.0, 3.0, 4.0], None).per_curve::<2>(2, &starts),
            Some(vec![[1.0, 2.0], [3.0, 4.0]])
        );
    }
}
