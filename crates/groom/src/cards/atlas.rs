//! Places of tiles in a square texture.

/// A rectangle of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Rect {
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) width: usize,
    pub(super) height: usize,
}

/// Size of a tile: meters across and along, the latter divided by how much coarser its texels may be there.
pub(super) type Extent = [f32; 2];

/// Texels between tiles in a texture of `size` texels.
pub(super) fn gutter(size: usize) -> usize {
    (size / 256).max(2)
}

/// Returns the places of tiles in a texture of `size` × `size` texels and the texels per meter, as many as fit; `None`
/// if the tiles do not fit with the least number of texels.
pub(super) fn pack(tiles: &[Extent], size: usize) -> Option<(Vec<Rect>, f32)> {
    let mut best = shelves(tiles, size, 0.0)?;
    let widest = tiles.iter().flatten().copied().fold(1e-6, f32::max);
    let (mut low, mut high) = (0.0, size as f32 / widest * 2.0);
    for _ in 0..24 {
        let midpoint = 0.5 * (low + high);
        match shelves(tiles, size, midpoint) {
            Some(found) => (best, low) = (found, midpoint),
            None => high = midpoint,
        }
    }
    Some((best, low))
}

/// Places tiles in rows, highest first, at `density` texels per meter.
fn shelves(tiles: &[Extent], size: usize, density: f32) -> Option<Vec<Rect>> {
    let gap = gutter(size);
    let texels = |meters: f32| ((meters * density).min(1e6) as usize).max(4).next_multiple_of(4);
    let mut order: Vec<usize> = (0..tiles.len()).collect();
    order.sort_by_key(|i| (std::cmp::Reverse(texels(tiles[*i][1])), *i));
    let mut rects = vec![Rect::default(); tiles.len()];
    let (mut x, mut y, mut shelf) = (gap, gap, 0);
    for i in order {
        let [width, height] = tiles[i].map(texels);
        if x + width + gap > size {
            (x, y, shelf) = (gap, y + shelf + gap, 0);
        }
        if x + width + gap > size || y + height + gap > size {
            return None;
        }
        rects[i] = Rect { x, y, width, height };
        x += width + gap;
        shelf = shelf.max(height);
    }
    Some(rects)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_fill_the_texture_without_overlap() {
        let tiles: Vec<Extent> =
            (0..32).map(|i| [0.01 + 0.001 * (i % 7) as f32, 0.05 + 0.01 * (i % 5) as f32]).collect();
        let size = 1024;
        let (places, density) = pack(&tiles, size).unwrap();
        let mut used = vec![false; size * size];
        for (place, tile) in places.iter().zip(&tiles) {
            assert!((place.width as f32 - tile[0] * density).abs() <= 4.0, "{place:?}");
            for y in place.y..place.y + place.height {
                for x in place.x..place.x + place.width {
                    assert!(!std::mem::replace(&mut used[y * size + x], true), "overlap at {x}, {y}");
                }
            }
        }
        let filled = used.iter().filter(|used| **used).count() as f32 / used.len() as f32;
        assert!(filled > 0.6, "{filled}");
    }

    #[test]
    fn too_many_tiles_do_not_fit() {
        assert!(pack(&vec![[0.01, 0.01]; 2000], 128).is_none());
    }
}
