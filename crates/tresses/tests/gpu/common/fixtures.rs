//! Test data that is slow to create and shared by many tests: built-in characters and grooms from files.

use super::device;
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, OnceLock, PoisonError},
};
use tresses::{
    Context, Styling, drape,
    glam::Vec3,
    groom::{
        Groom, SdfGrid, Strands, TriMesh, grow::Growth, import, mesh::sdf, scalp::GridScalp, styles::Style,
    },
};

/// A style on the mannequin, in meters.
pub struct DrapedCharacter {
    pub groom: Groom,
    pub mesh: TriMesh,
    pub field: SdfGrid,
    pub neck: Vec3,
}

impl DrapedCharacter {
    pub fn new(context: &Context, style: &Style, growth: Growth) -> Self {
        let styling = Styling { growth: Some(growth), ..Styling::default() };
        let source = pollster::block_on(drape::style(context, style, &())).expect("a source");
        let parts = pollster::block_on(source.parts(&styling, &())).expect("a character");
        let field = parts.body_field().expect("a field").clone();
        Self { groom: parts.groom, mesh: parts.head.expect("a mesh"), field, neck: parts.neck }
    }
}

/// Returns the built-in style `name` with `strands` strands, created once. `None` without a GPU.
pub fn character(name: &str, strands: u32) -> Option<Arc<DrapedCharacter>> {
    type BuiltHair = HashMap<(String, u32), Arc<OnceLock<Arc<DrapedCharacter>>>>;
    static MADE: Mutex<Option<BuiltHair>> = Mutex::new(None);
    let context = device::context()?;
    let place = {
        let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
        made.get_or_insert_default().entry((name.to_owned(), strands)).or_default().clone()
    };
    let made = place.get_or_init(|| {
        let style = name.parse::<Style>().expect("a style");
        let growth = Growth::for_style(&style).with_strands(strands);
        Arc::new(DrapedCharacter::new(context, &style, growth))
    });
    Some(made.clone())
}

/// Returns the mannequin's scalp, created once. Its distance field has `resolution` cells along the longest side.
pub fn scalp(resolution: u32) -> Arc<GridScalp> {
    static MADE: Mutex<Vec<(u32, Arc<GridScalp>)>> = Mutex::new(Vec::new());
    let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, scalp)) = made.iter().find(|(of, _)| *of == resolution) {
        return scalp.clone();
    }
    let scalp = Arc::new(GridScalp::mannequin(resolution));
    made.push((resolution, scalp.clone()));
    scalp
}

/// Returns `path` in the folder `TRESSES_ASSETS`. If it is missing, prints so and returns `None`, or panics if
/// `TRESSES_REQUIRE_ASSETS=1`.
pub fn asset(path: impl AsRef<Path>) -> Option<PathBuf> {
    let path = path.as_ref();
    let found = std::env::var_os("TRESSES_ASSETS").map(|folder| PathBuf::from(folder).join(path));
    if found.as_ref().is_some_and(|found| found.exists()) {
        return found;
    }
    let required = std::env::var_os("TRESSES_REQUIRE_ASSETS").is_some_and(|v| v == "1");
    assert!(!required, "TRESSES_ASSETS has no {}", path.display());
    println!("skipped: TRESSES_ASSETS has no {}", path.display());
    None
}

/// Sintel's hair with 16 points per strand, a path in the assets.
pub const SINTEL: &str = "sintel/SintelHairOriginal-sintel_hair.16points.tfx";

/// Returns Sintel's strands, head and distance field, read once. `None` if the files are missing.
pub fn sintel() -> Option<&'static (Strands, TriMesh, SdfGrid)> {
    static SINTEL_READ: OnceLock<(Strands, TriMesh, SdfGrid)> = OnceLock::new();
    let (groom, head) = (asset(SINTEL)?, asset("sintel/sintel.obj")?);
    Some(SINTEL_READ.get_or_init(|| {
        let (strands, head, _) =
            import::read_with_head(&[groom], &[head], &Default::default()).expect("Sintel's files");
        let field = sdf::build(&head, &Default::default()).expect("a field");
        (strands, head, field)
    }))
}
