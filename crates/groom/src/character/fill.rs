//! Filling: grows hair between the strands of files, up to a requested number or as the file's follower settings say.

use super::{CharacterSource, HairInput, SKULL_ABOVE_NECK, Styling};
use crate::{
    Fill, FilledStrands, Head, Progress, Result, Strands,
    fill::{fill_with, follow_with},
    grow::ScalpPaint,
    skin::MapProjection,
};

/// How hair is filled in between the strands of files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FillOptions {
    /// Number of strands to fill up to. 0 keeps only the file's strands. `None` grows the followers that the file asks
    /// for. [`Styling::max_strands`] limits the number in any case.
    pub strand_count: Option<u32>,
    /// Angle between neighboring strands above which new hair follows one of them instead of blending, radians.
    pub parting: f32,
    /// Seed of all random choices.
    pub seed: u32,
}

impl Default for FillOptions {
    fn default() -> Self {
        let Fill { parting, seed, .. } = Fill::default();
        Self { strand_count: None, parting, seed }
    }
}

impl FillOptions {
    /// Returns a note on the strands that grew.
    pub(super) fn growth_note(&self, filled: &FilledStrands) -> String {
        let (given, new) = (filled.given, filled.strands.len() - filled.given);
        match self.strand_count {
            None => format!(
                "the file requests child strands: {new} are grown around its {given} strands (--grow 0 for none, --grow N for N strands in total)"
            ),
            Some(_) => format!("{new} strands are grown between the {given} of the file"),
        }
    }

    /// Returns a note when filling is requested for built-in hair.
    pub(super) fn unused(&self) -> Option<String> {
        let is_requested = self.strand_count.is_some_and(|strands| strands > 0);
        is_requested.then(|| "--grow applies to groom files; use --strands for built-in styles".into())
    }
}

impl CharacterSource {
    /// Returns `strands` of files with the filled-in strands that `styling` requests, painted; `None` if it requests
    /// none.
    pub(super) async fn filled(
        &self,
        strands: &Strands,
        styling: &Styling,
        on: MapProjection<'_>,
        progress: &impl Progress,
    ) -> Result<Option<FilledStrands>> {
        let HairInput::Imported { field, .. } = &self.hair else { return Ok(None) };
        let head = Head { mesh: self.head.as_ref(), field: field.as_ref() };
        let skull = self.neck + SKULL_ABOVE_NECK;
        let FillOptions { strand_count: requested, parting, seed } = styling.fill;
        let max_strands = styling.max_strands.unwrap_or(u32::MAX);
        let followers = self.report.as_ref().map_or(&[][..], |report| &report.followers);
        // Nothing to fill when strands are thinned out or the requested number is already reached.
        let more = match requested {
            Some(requested) => requested.min(max_strands) as usize > strands.len(),
            None => followers.len() == strands.len() && max_strands as usize > strands.len(),
        };
        if !more {
            return Ok(None);
        }
        let filled = match requested {
            Some(requested) => {
                // New strands follow a map over the scalp; by UV, they are thinned out afterwards.
                let density = match on {
                    MapProjection::Scalp(_) => styling.paint.density.clone(),
                    MapProjection::Texture(_) => None,
                };
                let fill = Fill {
                    strand_count: requested.min(max_strands),
                    density,
                    skull,
                    parting,
                    seed,
                    ..Fill::default()
                };
                fill_with(strands, head, &fill, progress).await?
            }
            None => follow_with(strands, head, followers, max_strands, seed, progress).await?,
        };
        Ok(Some(match styling.paint != ScalpPaint::default() {
            true => filled.painted(&styling.paint, on, 1)?,
            false => filled,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::{super::CharacterFiles, *};
    use crate::{
        import::ImportOptions,
        orient::{LengthUnit, OrientationOverride},
        progress::at_once,
        scalp::ScalpMap,
    };
    use glam::Vec3;
    use std::{borrow::Cow, path::PathBuf};

    /// Sixty strands on a slope, as a `.tfx` file with `header`.
    fn base(header: &str) -> CharacterSource {
        let mut text = format!("version 2.0\nscale 1.0\n{header}numStrands 60\n");
        for i in 0..60 {
            let root = Vec3::new(0.012 * (i % 10) as f32 - 0.054, 1.7, 0.012 * (i / 10) as f32);
            text += &format!("strand {i} numVerts 8 texcoord 0 0\n");
            for k in 0..8 {
                let p = root + Vec3::new(0.0, 0.02, -0.01) * k as f32;
                text += &format!("{} {} {}\n", p.x, p.y, p.z);
            }
        }
        let given = [(PathBuf::from("a.tfx"), Cow::Owned(text.into_bytes()))];
        let unit = Some(LengthUnit(1.0));
        let options = ImportOptions {
            orient: OrientationOverride { unit, ..Default::default() },
            ..Default::default()
        };
        at_once(CharacterSource::imported(&CharacterFiles::Given(&given), &options, &())).unwrap()
    }

    const ASKING: &str = "numFollowHairsPerGuideHair 4\nmaxRadiusAroundGuideHair 0.002\n";

    /// Returns the number of strands and the last note.
    fn dressed(header: &str, grow: Option<u32>, styling: Styling) -> (usize, String) {
        let growing = FillOptions { strand_count: grow, ..FillOptions::default() };
        let character = at_once(base(header).parts(&Styling { fill: growing, ..styling }, &())).unwrap();
        (character.groom.strands.len(), character.notes.last().cloned().unwrap_or_default())
    }

    #[test]
    fn strand_count_follows_option_then_file() {
        let count = |header, grow| dressed(header, grow, Styling::default()).0;
        assert_eq!(
            [count("", None), count("", Some(0)), count("", Some(60)), count("", Some(900))],
            [60, 60, 60, 900]
        );
        assert_eq!([count(ASKING, None), count(ASKING, Some(0)), count(ASKING, Some(900))], [300, 60, 900]);
        let said = |grow| dressed(ASKING, grow, Styling::default()).1;
        assert!(said(None).contains("240 are grown around its 60 strands"), "{}", said(None));
        assert!(said(Some(900)).contains("840 strands are grown between the 60"), "{}", said(Some(900)));
        assert!(!said(Some(0)).contains("grown"), "{}", said(Some(0)));
        // Never more than the limit.
        let at_most =
            |most, grow| dressed(ASKING, grow, Styling { max_strands: Some(most), ..Styling::default() }).0;
        assert_eq!([at_most(200, None), at_most(30, None), at_most(200, Some(900))], [200, 30, 200]);
        assert!(FillOptions::default().unused().is_none());
        assert!(FillOptions { strand_count: Some(9), ..FillOptions::default() }.unused().is_some());
    }

    #[test]
    fn density_map_thins_filled_strands() {
        for (header, grow) in [(ASKING, None), ("", Some(900))] {
            let count = |density: f32| {
                let density = Some(ScalpMap::from_fn(4, |_| density));
                let paint = ScalpPaint { density, ..ScalpPaint::default() };
                dressed(header, grow, Styling { paint, ..Styling::default() }).0 as f32
            };
            let half = count(0.5) / count(1.0);
            assert!((half - 0.5).abs() < 0.1, "{grow:?}: {half}");
        }
    }
}
