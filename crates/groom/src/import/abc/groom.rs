//! Values beside the shape of curves: one for all, one per curve or one per point, and where files keep them.

use super::{Archive, property::Compound, tree::Object};
use crate::error::{At, Result};

/// Values of one name.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Param {
    /// In one row.
    flat: Vec<f32>,
    /// How many make one value, as the file has it; `arrayExtent` tells of values that were flattened.
    width: usize,
    scope: Option<String>,
    at: At,
}

/// What values belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Per {
    All,
    Curve,
    Point,
}

impl Param {
    /// The first of `names` that one of the object's compounds has.
    pub fn find<'a>(
        archive: &Archive<'_, 'a>,
        places: &[Compound<'a>],
        names: &[&str],
        time: f64,
    ) -> Result<Option<Self>> {
        for place in places {
            for name in names {
                if let Some(param) = Self::read(archive, place, name, time)?.filter(|p| !p.flat.is_empty()) {
                    return Ok(Some(param));
                }
            }
        }
        Ok(None)
    }

    /// Values, or values with indices.
    fn read<'a>(
        archive: &Archive<'_, 'a>,
        place: &Compound<'a>,
        name: &str,
        time: f64,
    ) -> Result<Option<Self>> {
        let indexed = place.compound(archive, name)?;
        let values = match &indexed {
            Some(both) => both.property(archive, ".vals")?,
            None => place.property(archive, name)?,
        };
        let Some(values) = values.filter(|values| !values.is_text()) else { return Ok(None) };
        let extent = values.extent();
        let flattened = values.meta("arrayExtent").and_then(|text| text.parse::<usize>().ok()).unwrap_or(1);
        let mut flat = values.floats(archive, time)?;
        let indices = match &indexed {
            Some(both) => both.property(archive, ".indices")?,
            None => None,
        };
        if let Some(indices) = indices {
            let known = flat;
            flat = Vec::new();
            for index in indices.integers(archive, time)? {
                let at = usize::try_from(index).ok().and_then(|i| i.checked_mul(extent));
                match at.and_then(|at| known.get(at..)?.get(..extent)) {
                    Some(value) => flat.extend_from_slice(value),
                    None => {
                        let problem =
                            format!("{name} has no value {index}, there are {}", known.len() / extent);
                        return Err(archive.source.problem(indices.at(), problem));
                    }
                }
            }
        }
        let scope = values.meta("geoScope").map(str::to_owned);
        Ok(Some(Self { flat, width: extent.saturating_mul(flattened.max(1)), scope, at: values.at() }))
    }

    /// What they belong to, if `width` numbers make one value and the curves have so many points.
    pub fn per(&self, width: usize, curves: usize, points: usize) -> Option<Per> {
        let count = self.flat.len() / width.max(1);
        let fits = |per| match per {
            Per::All => count == 1,
            Per::Curve => count == curves,
            Per::Point => count == points,
        };
        let said = match self.scope.as_deref() {
            Some("con") => Some(Per::All),
            Some("uni") => Some(Per::Curve),
            Some("vtx" | "var" | "fvr") => Some(Per::Point),
            _ => None,
        };
        // Scopes are missing or wrong more often than counts.
        let any = [Per::Point, Per::Curve, Per::All];
        said.into_iter().chain(any).find(|per| self.flat.len().is_multiple_of(width.max(1)) && fits(*per))
    }

    /// The value of `index`, 0 where it has fewer numbers.
    pub fn value<const N: usize>(&self, width: usize, index: usize) -> [f32; N] {
        std::array::from_fn(|k| {
            if k < width { self.flat.get(index * width + k).copied().unwrap_or(0.0) } else { 0.0 }
        })
    }

    /// One value per curve, of `N` numbers; of points, the first of each curve. `None` where the counts fit
    /// nothing.
    pub fn per_curve<const N: usize>(&self, width: usize, starts: &[u32]) -> Option<Vec<[f32; N]>> {
        let (curves, points) = (starts.len() - 1, starts.last().map_or(0, |end| *end as usize));
        let per = self.per(width, curves, points)?;
        let at = |i: usize| match per {
            Per::All => 0,
            Per::Curve => i,
            Per::Point => starts[i] as usize,
        };
        Some((0..curves).map(|i| self.value(width, at(i))).collect())
    }

    /// One number per control point, where the file has one for each end of each piece of Bézier curves (`varying`).
    pub fn at_knots(&self, starts: &[u32]) -> Option<Vec<f32>> {
        let pieces =
            |w: &[u32]| ((w[1] - w[0]) as usize).checked_sub(1).filter(|n| *n > 0 && n.is_multiple_of(3));
        let ends: Option<usize> = starts.windows(2).map(|w| pieces(w).map(|n| n / 3 + 1)).sum();
        if ends != Some(self.flat.len()) {
            return None;
        }
        let mut first = 0;
        let mut all = Vec::with_capacity(starts.last().map_or(0, |end| *end as usize));
        for w in starts.windows(2) {
            let points = (w[1] - w[0]) as usize;
            let at = |k: usize| self.flat[first + k.min((points - 1) / 3)];
            all.extend((0..points).map(|k| at(k / 3) + (at(k / 3 + 1) - at(k / 3)) * (k % 3) as f32 / 3.0));
            first += (points - 1) / 3 + 1;
        }
        Some(all)
    }

    /// How many numbers make one value, if there is one per curve; else as the file has it.
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

/// Where an object's values may be: beside its shape, and on the transform above it.
pub(super) fn places<'a>(
    archive: &Archive<'_, 'a>,
    object: &Object<'a>,
    above: Option<&Compound<'a>>,
) -> Result<Vec<Compound<'a>>> {
    let mut all = Vec::new();
    for holder in std::iter::once(&object.shape).chain(above) {
        for name in [".arbGeomParams", ".userProperties"] {
            all.extend(holder.compound(archive, name)?);
        }
    }
    Ok(all)
}

/// The first text of this name.
pub(super) fn text<'a>(
    archive: &Archive<'_, 'a>,
    places: &[Compound<'a>],
    name: &str,
    time: f64,
) -> Result<Vec<String>> {
    for place in places {
        if let Some(property) = place.property(archive, name)?.filter(|property| property.is_text()) {
            return property.texts(archive, time);
        }
    }
    Ok(Vec::new())
}

impl std::fmt::Display for Param {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} numbers{}", self.flat.len(), self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn param(flat: &[f32], scope: Option<&str>) -> Param {
        Param { flat: flat.to_vec(), width: 1, scope: scope.map(str::to_owned), at: At::File }
    }

    #[test]
    fn values_belong_to_what_they_are_as_many_as() {
        // Two curves of four and seven points.
        let starts = [0, 4, 11];
        let per = |count: usize, scope| param(&vec![1.0; count], scope).per(1, 2, 11);
        assert_eq!(
            [1, 2, 11, 3].map(|n| per(n, None)),
            [Some(Per::All), Some(Per::Curve), Some(Per::Point), None]
        );
        // A scope that does not fit counts for nothing.
        assert_eq!((per(11, Some("uni")), per(2, Some("uni"))), (Some(Per::Point), Some(Per::Curve)));
        let knots = param(&[0.0, 3.0, 6.0, 9.0, 0.0], None).at_knots(&starts).unwrap();
        assert_eq!(knots, [0.0, 1.0, 2.0, 3.0, 6.0, 7.0, 8.0, 9.0, 6.0, 3.0, 0.0]);
        assert_eq!(param(&[0.0; 4], None).at_knots(&starts), None);
        assert_eq!(param(&[0.0; 5], None).at_knots(&[0, 4, 10]), None);
        let firsts = param(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0], None);
        assert_eq!(firsts.per_curve::<1>(1, &starts), Some(vec![[0.0], [4.0]]));
        assert_eq!(
            param(&[1.0, 2.0, 3.0, 4.0], None).per_curve::<2>(2, &starts),
            Some(vec![[1.0, 2.0], [3.0, 4.0]])
        );
    }
}
