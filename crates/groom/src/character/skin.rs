//! Color of the skin at the roots, and coordinates of maps.

use super::{CharacterSource, HairInput, Styling};
use crate::{
    Error, Groom, Result, TriMesh,
    bound::strand::pack_color,
    grow::ScalpPaint,
    skin::{SkinColors, TextureCoordinates},
};

/// Coordinates in the maps of a [`Styling`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MapCoordinates {
    /// The view from the center of the braincase ([`scalp_uv`](crate::scalp::scalp_uv)).
    #[default]
    Scalp,
    /// Root UVs of the groom, else texture coordinates of the skin. Built-in styles use [`Scalp`](Self::Scalp).
    Uv,
}

impl Styling {
    /// Whether any map depends on [`coordinates`](Self::coordinates).
    fn has_maps(&self) -> bool {
        let curls = self.restyle.as_ref().is_some_and(|restyle| restyle.curl_map.is_some());
        curls || self.stiffness.is_some() || self.paint != ScalpPaint::default()
    }
}

impl CharacterSource {
    /// Returns the texture coordinates that `styling` asks for, if it has maps and the hair is not a built-in style.
    pub(super) fn texture_coordinates(&self, styling: &Styling) -> Result<Option<TextureCoordinates>> {
        let of_roots = match &self.hair {
            _ if styling.coordinates == MapCoordinates::Scalp || !styling.has_maps() => return Ok(None),
            HairInput::BuiltIn { .. } => return Ok(None),
            HairInput::Imported { strands, .. } => TextureCoordinates::of_roots(strands),
            #[cfg(feature = "edit")]
            HairInput::Edited { .. } => None,
        };
        let found = of_roots.or_else(|| self.head.as_ref().and_then(TextureCoordinates::of_skin));
        let none = || Error::Unusable("maps by UV need root UVs in the groom or textures on its body".into());
        found.ok_or_else(none).map(Some)
    }

    /// Returns a note if the maps of a built-in style are meant to be by UV.
    pub(super) fn scalp_note(&self, styling: &Styling) -> Option<String> {
        let ignored =
            styling.coordinates == MapCoordinates::Uv && styling.has_maps() && self.style().is_some();
        ignored.then(|| "style.maps: no effect on a built-in style, whose maps cover the scalp".into())
    }
}

/// Gives the strands of `groom` the color of the skin of `head` at their roots. Strands on parts without color keep
/// theirs.
pub(super) fn color_by_skin(groom: &mut Groom, head: Option<&TriMesh>) -> Result<()> {
    let none = || Error::Unusable("the color of the skin needs a body with textures or colors".into());
    let skin = head.and_then(SkinColors::new).ok_or_else(none)?;
    for i in 0..groom.strands.len() {
        let Some(color) = groom.strands.rest_positions(i).next().and_then(|root| skin.at(root)) else {
            continue;
        };
        let strand = &mut groom.strands.strands[i];
        strand.root_color = pack_color(color);
        strand.tip_color = strand.root_color;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Strands, mesh::shapes, progress::at_once, scalp::ScalpMap};
    use glam::{Vec2, Vec3};

    /// A ball of 10 cm, red on its left half and blue on the right, with hair on its upper half.
    fn base(with_uvs: bool) -> CharacterSource {
        let mut head = shapes::sphere(0.1, 24);
        head.colors = head.positions.iter().map(|p| if p.x > 0.0 { Vec3::X } else { Vec3::Z }).collect();
        let mut strands = Strands::default();
        for i in 0..200 {
            let turn = 0.1 * i as f32;
            let up = 0.3 + 0.003 * i as f32;
            let across = (1.0 - up * up).sqrt();
            let normal = Vec3::new(across * turn.cos(), up, across * turn.sin());
            strands.push(&[1, 2, 3, 4].map(|k| normal * (0.1 + 0.01 * (k - 1) as f32)));
            if with_uvs {
                strands.root_uvs.push(Vec2::new(i as f32 / 200.0, 0.5));
            }
        }
        at_once(CharacterSource::given(strands, Some(head), None, &())).unwrap()
    }

    #[test]
    fn strands_have_color_of_skin_at_root() {
        let styling = Styling { uses_skin_color: true, ..Styling::default() };
        let groom = at_once(base(false).parts(&styling, &())).unwrap().groom;
        let mut seen = [0; 2];
        for (i, strand) in groom.strands.strands.iter().enumerate() {
            let root = groom.strands.rest_positions(i).next().unwrap();
            if root.x.abs() > 0.01 {
                let color = if root.x > 0.0 { Vec3::X } else { Vec3::Z };
                assert_eq!([strand.root_color, strand.tip_color], [pack_color(color); 2], "{root}");
                seen[usize::from(root.x > 0.0)] += 1;
            }
        }
        assert!(seen.iter().all(|count| *count > 50), "{seen:?}");
        let mut bare = base(false);
        bare.head.as_mut().unwrap().colors.clear();
        let refused = at_once(bare.parts(&styling, &())).unwrap_err().to_string();
        assert!(refused.contains("textures or colors"), "{refused}");
    }

    #[test]
    fn maps_follow_root_uvs() {
        // Half of the map keeps all, half nothing.
        let density = ScalpMap::from_fn(64, |uv| if uv.x > 0.5 { 1.0 } else { 0.0 });
        let paint = ScalpPaint { density: Some(density), ..ScalpPaint::default() };
        let styling = Styling { paint, coordinates: MapCoordinates::Uv, ..Styling::default() };
        let character = at_once(base(true).parts(&styling, &())).unwrap();
        let count = character.groom.strands.len();
        assert!((80..120).contains(&count), "{count}");
        // Strands are stored from low to high; the upper half stays.
        let lowest = (0..count).map(|i| character.groom.strands.rest_positions(i).next().unwrap().y);
        let lowest = lowest.fold(f32::INFINITY, f32::min);
        assert!(lowest > 0.05, "{lowest}");
        let refused = at_once(base(false).parts(&styling, &())).unwrap_err().to_string();
        assert!(refused.contains("root UVs"), "{refused}");
    }
}
