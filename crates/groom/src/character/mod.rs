//! Characters on the CPU: the groom and the body from files, or a built-in style; then the strands, styled.
//!
//! ```text
//! files ──────► CharacterSource ── parts(Styling) ──► CharacterParts
//! Style ─drape─►   (slow)             (fast)
//! ```
//!
//! The guides of a style that is not stored fall onto the head by the simulation of `tresses::drape`.

#[cfg(feature = "cooked")]
mod cooked;
#[cfg(feature = "edit")]
mod edited;
mod face;
mod fill;
mod own_head;
mod parts;
mod skin;

pub use face::{FaceGroom, FaceHair};
pub use fill::FillOptions;
pub use parts::{CharacterParts, LodLevel};
pub use skin::MapCoordinates;

#[cfg(feature = "edit")]
use crate::edit::{GroomDocument, HeadFiles};
use crate::{
    BindOptions, Error, Groom, GuideCount, MAX_STRAND_VERTICES, Progress, Restyle, Result, Rig, SdfGrid,
    Strands, TriMesh, bind, bind_filled, curve,
    grow::{self, Curls, Growth, ScalpPaint},
    import::{self, FileBytes, ImportOptions, ImportReport},
    light::PunctualLight,
    lint, mannequin,
    mesh::{
        MeshLevel,
        sdf::{self, SdfOptions},
    },
    orient::Placement,
    rig::anatomy::{Anatomy, DistanceFieldSource},
    scalp::{GridScalp, ScalpMap},
    skin::MapProjection,
    styles::{Style, StyledGuides},
    tie::Tie,
};
use glam::Vec3;
use own_head::OwnHead;
use parts::{SKULL_ABOVE_NECK, neck, rigid};
use skin::color_by_skin;
use std::{borrow::Cow, path::PathBuf};

/// Vertices per turn below which curls look angular.
const SMOOTH: f32 = 6.0;

/// How the strands of a [`CharacterSource`] are grown, filled, bound and restyled.
#[derive(Clone, Debug, Default)]
pub struct Styling {
    /// Growth of strands on a built-in style; `None` for the style's own. Ignored for files, which have strands.
    pub growth: Option<Growth>,
    /// Maximum number of strands drawn from a file; `None` for all.
    pub max_strands: Option<u32>,
    /// Filling between the strands of a file.
    pub fill: FillOptions,
    /// Number of simulated guides; `None` for the default.
    pub guides: Option<GuideCount>,
    /// Maps applied to a file's strands before they are bound.
    pub paint: ScalpPaint,
    /// Coordinates in all maps except [`levels`](Self::levels).
    pub coordinates: MapCoordinates,
    /// Whether strands have the color of the skin at their roots.
    pub uses_skin_color: bool,
    /// Changes to a file's strands after they are bound.
    pub restyle: Option<Restyle>,
    /// Factors on stiffness over the scalp.
    pub stiffness: Option<ScalpMap>,
    /// Painted levels of detail.
    pub levels: Vec<LodLevel>,
    /// Bands, braids and pins.
    pub ties: Vec<Tie>,
    /// Face grooms of a built-in character.
    pub face: FaceHair,
}

impl Styling {
    /// Whether a file's strands are bound unchanged by [`BindOptions::default`], apart from filling.
    fn leaves_strands_unchanged(&self) -> bool {
        self.max_strands.is_none()
            && self.guides.is_none()
            && self.restyle.is_none()
            && self.paint == ScalpPaint::default()
    }
}

/// Locations of the files of a groom and its head.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum CharacterFiles<'a> {
    /// Files on disk.
    Disk {
        /// Files joined into one groom.
        grooms: &'a [PathBuf],
        /// Files joined into one head; may be empty.
        heads: &'a [PathBuf],
    },
    /// Files in memory, sorted by content: [`import::read_given`].
    Given(&'a [FileBytes<'a>]),
}

impl CharacterFiles<'_> {
    fn head_name(&self) -> String {
        match self {
            Self::Disk { heads, .. } => heads.first().map(|name| name.display().to_string()),
            Self::Given(files) => first(files, |kind| kind == import::FileKind::Mesh),
        }
        .unwrap_or_default()
    }

    fn groom_name(&self) -> String {
        match self {
            Self::Disk { grooms, .. } => grooms.first().map(|name| name.display().to_string()),
            Self::Given(files) => first(files, |kind| kind != import::FileKind::Mesh),
        }
        .unwrap_or_default()
    }
}

/// Returns the name of the first of `files` of a kind.
fn first(files: &[FileBytes<'_>], is: impl Fn(import::FileKind) -> bool) -> Option<String> {
    let found = files.iter().find(|(name, bytes)| import::kind(name, bytes).is_some_and(&is));
    found.map(|(name, _)| name.display().to_string())
}

/// Everything about a character that does not depend on the styling of its strands.
#[derive(Debug)]
pub struct CharacterSource {
    head: Option<TriMesh>,
    neck: Vec3,
    anatomy: Option<Anatomy>,
    hair: HairInput,
    lights: Vec<PunctualLight>,
    notes: Vec<String>,
    /// Report on the files and their orientation; `None` for built-in styles.
    pub report: Option<ImportReport>,
}

#[derive(Debug)]
#[allow(clippy::large_enum_variant)] // One instance per source.
enum HairInput {
    /// Draped guides, on a head of a file if it is given.
    BuiltIn { style: Style, styled: StyledGuides, scalp: GridScalp, own: Option<OwnHead> },
    /// A version of an edited groom.
    #[cfg(feature = "edit")]
    Edited { document: GroomDocument, field: Option<SdfGrid> },
    /// The strands of files.
    Imported { strands: Strands, field: Option<SdfGrid>, known: Option<CookedParts> },
}

/// Precomputed data of a cooked file besides strands and head.
#[derive(Debug)]
struct CookedParts {
    /// The strands bound by [`BindOptions::default`].
    groom: Groom,
    levels_of_head: Vec<MeshLevel>,
}

impl CharacterSource {
    /// Creates the mannequin with `styled`, the draped guides of `style` on `scalp`, its scalp.
    pub async fn built_in(
        style: &Style,
        styled: StyledGuides,
        scalp: GridScalp,
        progress: &impl Progress,
    ) -> Self {
        let head = mannequin::mesh_with(mannequin::RESOLUTION, progress).await;
        Self {
            anatomy: Some(Anatomy::built_in(&head, &scalp.field)),
            head: Some(head),
            neck: mannequin::NECK_JOINT,
            hair: HairInput::BuiltIn { style: *style, styled, scalp, own: None },
            lights: Vec::new(),
            notes: Vec::new(),
            report: None,
        }
    }

    /// Reads the groom of `files`, on their head if they have one.
    ///
    /// # Errors
    /// An error that names the file when one cannot be read or is invalid.
    pub async fn imported(
        files: &CharacterFiles<'_>,
        options: &ImportOptions,
        progress: &impl Progress,
    ) -> Result<Self> {
        progress.step("reading the groom", 0.0).await;
        #[cfg(feature = "cooked")]
        if let Some((path, cooked)) = files.cooked(options)? {
            return Self::cooked(&path, cooked);
        }
        #[cfg(feature = "edit")]
        if let Some((path, document)) = files.edited(options)? {
            return Self::edited(&path, document, progress).await;
        }
        let (strands, head, mut report) = match files {
            CharacterFiles::Disk { grooms, heads } => import::read_complete(grooms, heads, options)?,
            CharacterFiles::Given(files) => import::read_given(files, options)?,
        };
        let mut base = Self::of(strands, head, report.rig.take(), &files.head_name(), progress).await?;
        base.tell(report, &files.groom_name(), &files.head_name());
        Ok(base)
    }

    /// Keeps the import report and its lights, and collects notes on uncertain guesses.
    fn tell(&mut self, report: ImportReport, groom: &str, head: &str) {
        // Groom and head may have the same doubts.
        let doubts = |what: String, placement: &Placement| -> Vec<String> {
            placement.doubts.iter().map(|doubt| format!("{what}: {doubt}")).collect()
        };
        self.notes = doubts(format!("groom {groom}"), &report.placement);
        if let Some(placement) = &report.head_placement {
            self.notes.extend(doubts(format!("head {head}"), placement));
        }
        self.lights.clone_from(&report.lights);
        self.report = Some(report);
    }

    /// Creates a source from `strands` in meters, Y up, face towards +Z, on `head` if given, which `rig` deforms.
    /// Repairs the strands first.
    ///
    /// # Errors
    /// [`Error::Unusable`] when the strands or the head are invalid.
    pub async fn given(
        mut strands: Strands,
        head: Option<TriMesh>,
        rig: Option<Rig>,
        progress: &impl Progress,
    ) -> Result<Self> {
        lint::repair(&mut strands);
        if strands.is_empty() {
            let why = "no strand is usable: each has zero length or a single vertex";
            return Err(Error::Unusable(why.into()));
        }
        Self::of(strands, head, rig, "the head", progress).await
    }

    /// Creates a source from valid strands. `name` names the head in errors.
    async fn of(
        strands: Strands,
        head: Option<TriMesh>,
        rig: Option<Rig>,
        name: &str,
        progress: &impl Progress,
    ) -> Result<Self> {
        let anatomy = anatomy(rig, head.as_ref(), strands.iter())?;
        let field = field_of(anatomy.as_ref(), head.as_ref(), name, progress).await?;
        let neck = neck(strands.iter().filter_map(|strand| strand.first().copied()), head.as_ref());
        Ok(Self {
            head,
            neck,
            anatomy,
            hair: HairInput::Imported { strands, field, known: None },
            lights: Vec::new(),
            notes: Vec::new(),
            report: None,
        })
    }

    /// Returns notes on uncertain guesses of the import, one sentence each.
    pub fn notes(&self) -> impl Iterator<Item = &str> {
        self.notes.iter().map(String::as_str)
    }

    /// Returns the lights that the files brought, in groom space.
    pub fn lights(&self) -> &[PunctualLight] {
        &self.lights
    }

    /// Returns the built-in style, if the source is one.
    pub fn style(&self) -> Option<&Style> {
        match &self.hair {
            HairInput::BuiltIn { style, .. } => Some(style),
            _ => None,
        }
    }

    /// Whether the body is the built-in one, under a built-in style.
    pub fn is_mannequin(&self) -> bool {
        matches!(self.hair, HairInput::BuiltIn { own: None, .. })
    }

    /// Creates the character with strands styled by `styling`.
    ///
    /// # Errors
    /// An error when the styling is invalid.
    pub async fn parts(&self, styling: &Styling, progress: &impl Progress) -> Result<CharacterParts> {
        let skull = self.neck + SKULL_ABOVE_NECK;
        let mut notes = self.notes.clone();
        let texture = self.texture_coordinates(styling)?;
        let on = texture.as_ref().map_or(MapProjection::Scalp(skull), MapProjection::Texture);
        notes.extend(self.scalp_note(styling));
        let mut face = Vec::new();
        let (mut groom, field) = match &self.hair {
            HairInput::BuiltIn { style, styled, scalp, own } => {
                let growth = styling.growth.clone().unwrap_or_else(|| Growth::for_style(style));
                let grown = grow::grow_with(styled, &growth, scalp, progress).await?;
                let groom = grown.bind(styled);
                let mut groom = match styling.guides {
                    None => groom,
                    Some(guides) => rebound(&groom, guides)?,
                };
                notes.extend(note(&growth.curls, &groom));
                notes.extend(styling.fill.unused());
                match own {
                    None => {
                        if let Some(head) = &self.head {
                            face = styling.face.grow(head)?;
                        }
                        (groom, Some(scalp.field.clone()))
                    }
                    Some(OwnHead { fit, field, .. }) => {
                        fit.transform_groom(&mut groom);
                        (groom, field.clone())
                    }
                }
            }
            #[cfg(feature = "edit")]
            HairInput::Edited { document, field } => {
                let mut groom = document.groom();
                if let Some(restyle) = &styling.restyle {
                    restyle.apply(&mut groom, skull, on)?;
                }
                if let Some(head) = self.head.as_ref().filter(|_| *document.head() == HeadFiles::BuiltIn) {
                    face = styling.face.grow(head)?;
                }
                notes.extend(styling.ignored_by_edited());
                (groom, field.clone())
            }
            HairInput::Imported { strands, field, known } => {
                let mut strands = Cow::Borrowed(strands);
                if let Some(count) = styling.max_strands {
                    strands = Cow::Owned(thinned(&strands, count as usize));
                }
                let filled = self.filled(&strands, styling, on, progress).await?;
                if filled.is_none() && styling.paint != ScalpPaint::default() {
                    strands = Cow::Owned(styling.paint.apply(&strands, on, 1)?);
                }
                let guides = styling.guides.unwrap_or(BindOptions::default().guides);
                let restyle = styling.restyle.as_ref();
                // Curls need the maximum number of vertices.
                let strand_vertices = restyle.and_then(|r| r.curls.any().then_some(MAX_STRAND_VERTICES));
                let options =
                    BindOptions { guides, strand_vertex_count: strand_vertices, ..Default::default() };
                let known = known.as_ref().filter(|_| styling.leaves_strands_unchanged());
                let mut groom = match (&filled, known) {
                    (Some(filled), _) => bind_filled(filled, &options)?,
                    (None, Some(known)) => known.groom.clone(),
                    (None, None) => bind(&strands, &options)?,
                };
                notes.extend(filled.map(|filled| styling.fill.growth_note(&filled)));
                if let Some(restyle) = restyle {
                    restyle.apply(&mut groom, skull, on)?;
                    notes.extend(note(&restyle.curls, &groom));
                }
                (groom, field.clone())
            }
        };
        if let Some(map) = &styling.stiffness {
            groom.guides.stiffen(map, on);
        }
        if styling.uses_skin_color {
            color_by_skin(&mut groom, self.head.as_ref())?;
        }
        let (head, levels, anatomy) = (self.head.clone(), styling.levels.clone(), self.anatomy.clone());
        let ties = styling.ties.clone();
        let part = anatomy.as_ref().and_then(|anatomy| match &anatomy.head.field {
            DistanceFieldSource::Grid(part) => Some(part.clone()),
            DistanceFieldSource::Mesh(..) => None,
        });
        let (field, rest) = match part {
            Some(part) => (Some(part), field),
            None => (field, None),
        };
        let levels_of_head = match &self.hair {
            HairInput::Imported { known: Some(known), .. } => Some(known.levels_of_head.clone()),
            _ => None,
        };
        let neck = self.neck;
        let look = self.report.as_ref().and_then(|report| report.look);
        Ok(CharacterParts {
            groom,
            cards: None,
            face,
            head,
            levels_of_head,
            field,
            rest,
            neck,
            anatomy,
            levels,
            ties,
            look,
            lights: self.lights.clone(),
            notes,
        })
    }
}

/// Returns the anatomy of a rigged head, if there is a rig. Roots are the first points of `lines`.
fn anatomy<'a>(
    rig: Option<Rig>,
    head: Option<&TriMesh>,
    lines: impl Iterator<Item = &'a [Vec3]>,
) -> Result<Option<Anatomy>> {
    let Some((rig, head)) = rig.zip(head) else { return Ok(None) };
    Ok(Some(Anatomy::new(rig, head, lines)?))
}

/// Returns the distance field of the part of `head` that hair grows on. `name` names the head in errors.
async fn field_of(
    anatomy: Option<&Anatomy>,
    head: Option<&TriMesh>,
    name: &str,
    progress: &impl Progress,
) -> Result<Option<SdfGrid>> {
    let Some(head) = rigid(anatomy, head) else { return Ok(None) };
    let built = sdf::build_with(head, &SdfOptions::default(), progress).await;
    let named = |error| Error::Unusable(format!("{name} ({} high as read): {error}", high(head)));
    Ok(Some(built.map_err(named)?))
}

/// Formats the height of a mesh in a readable unit, so that a wrong unit stands out.
fn high(mesh: &TriMesh) -> String {
    let (low, high) = mesh
        .positions
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), p| (low.min(p.y), high.max(p.y)));
    match high - low {
        meters if meters >= 1.0 => format!("{meters:.3} m"),
        meters if meters >= 0.01 => format!("{:.3} cm", 100.0 * meters),
        meters => format!("{:.3} mm", 1000.0 * meters),
    }
}

/// Returns a warning when curls on `groom` have too few vertices.
fn note(curls: &Curls, groom: &Groom) -> Option<String> {
    let mut lengths: Vec<f32> =
        (0..groom.guides.len()).map(|i| curve::length(groom.guides.guide(i))).collect();
    lengths.sort_by(f32::total_cmp);
    let length = *lengths.get(lengths.len() / 2)?;
    let vertices = curls.vertices_per_turn(length, groom.strands.vertex_count);
    (curls.any() && vertices < SMOOTH).then(|| {
        format!(
            "curls of {:.0} mm on strands of {:.0} cm have {vertices:.1} vertices per turn and look angular",
            curls.wavelength * 1e3,
            length * 1e2
        )
    })
}

/// Binds the same strands to other guides, chosen among the strands.
fn rebound(groom: &Groom, guides: GuideCount) -> Result<Groom> {
    let mut strands = Strands::default();
    for i in 0..groom.strands.len() {
        let line: Vec<_> = groom.strands.rest_positions(i).collect();
        strands.push(&line);
    }
    let options = BindOptions {
        guides,
        guide_vertex_count: Some(groom.strands.vertex_count),
        strand_vertex_count: Some(groom.strands.vertex_count),
        ..Default::default()
    };
    let mut rebound = bind(&strands, &options)?;
    // Keep the appearance: widths, and the seeds of per-strand variation.
    rebound.strands.strands.clone_from(&groom.strands.strands);
    Ok(rebound)
}

/// Returns about `count` evenly picked strands.
fn thinned(strands: &Strands, count: usize) -> Strands {
    let all = strands.len();
    if count >= all {
        return strands.clone();
    }
    strands.subset((0..count).map(|k| k * all / count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::at_once;

    #[test]
    fn notes_name_the_uncertain_file() {
        use std::fmt::Write;
        // A head in an unusual unit with hair on it.
        let at = |j: u32, i: u32| {
            let (t, p) = (j as f32 / 12.0, std::f32::consts::TAU * i as f32 / 16.0);
            let t = std::f32::consts::PI * t;
            Vec3::new(t.sin() * p.cos(), t.cos(), 1.2 * t.sin() * p.sin())
        };
        let (mut groom, mut head) = (String::new(), String::new());
        for (n, (j, i)) in (0..13).flat_map(|j| (0..16).map(move |i| (j, i))).enumerate() {
            let p = 1.7 * at(j, i);
            writeln!(head, "v {} {} {}", p.x, p.y, p.z).unwrap();
            if (1..6).contains(&j) {
                for k in 0..4 {
                    let p = (1.7 + 0.1 * k as f32) * at(j, i);
                    writeln!(groom, "v {} {} {}", p.x, p.y, p.z).unwrap();
                }
                groom += "l -4 -3 -2 -1\n";
            }
            if j < 12 {
                let (a, b) = (n + 1, n + 1 - i as usize + (i as usize + 1) % 16);
                writeln!(head, "f {a} {b} {} {}", b + 16, a + 16).unwrap();
            }
        }
        let file = |name: &str, text: String| (PathBuf::from(name), Cow::Owned(text.into_bytes()));
        let files = [file("odd.obj", groom), file("head.obj", head)];
        let (files, options) = (CharacterFiles::Given(&files), ImportOptions::default());
        let base = at_once(CharacterSource::imported(&files, &options, &())).unwrap();
        for name in ["groom odd.obj: the size is a guess", "head head.obj: the size is a guess"] {
            assert!(base.notes.iter().any(|note| note.starts_with(name)), "{name}: {:?}", base.notes);
        }
    }

    #[test]
    fn thinning_keeps_strands_whole() {
        let mut strands = Strands::default();
        for i in 0..10 {
            let x = Vec3::X * i as f32;
            strands.push(&[x, x + Vec3::Y, x + Vec3::Y * 2.0]);
            strands.root_uvs.push(glam::Vec2::splat(i as f32));
        }
        strands.radii = vec![1.0; 30];
        let few = thinned(&strands, 5);
        assert_eq!((few.len(), few.positions.len(), few.radii.len(), few.root_uvs.len()), (5, 15, 15, 5));
        assert_eq!(few.strand(2), strands.strand(4));
        assert!(few.colors.is_empty());
        assert_eq!(thinned(&strands, 20), strands);
    }
}
