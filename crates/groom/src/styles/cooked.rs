//! Stored guides of the built-in styles, draped in advance.
//!
//! Draping a style takes the simulation of `tresses`, and so a GPU. For the default styles on the mannequin, the result
//! is stored: the same guides on every machine, in a few milliseconds. `cargo run -p tresses --example cook` writes the
//! file; a test there compares it with the result of the simulation.

use super::{GUIDE_VERTICES, Lines, Recipe, Style, StyledGuides};
use crate::{
    Strands,
    columns::{Reader, Writer},
    mannequin::STEP,
    scalp::Scalp,
};
use glam::{IVec3, Vec3};
use std::sync::OnceLock;

static FILE: &[u8] = include_bytes!("../../cooked/guides.bin");

const OUT_OF_DATE: &str = "the cooked guides are out of date: run the example `cook`";

/// Returns the stored recipes, in the file's order.
fn recipes() -> impl Iterator<Item = Recipe> {
    Style::NAMES.iter().filter_map(|name| name.parse::<Style>().ok()).map(|style| style.recipe())
}

/// Returns the draped guides of `recipe` on the mannequin, whose scalp is `mannequin`. Returns `None` for a recipe that
/// is not the default of one of [`Style::NAMES`].
pub fn settled(recipe: &Recipe, mannequin: &dyn Scalp) -> Option<StyledGuides> {
    static GUIDES: OnceLock<Vec<Strands>> = OnceLock::new();
    let at = recipes().position(|stored| stored == *recipe)?;
    let guides = GUIDES.get_or_init(|| read(FILE))[at].clone();
    Some(Lines::new(recipe, mannequin).styled(recipe, mannequin, guides))
}

/// Returns the contents of the file for the settled guides of all styles, in the order of [`Style::NAMES`].
pub fn cook(styles: &[StyledGuides]) -> Vec<u8> {
    let mut out = Writer::<COLUMNS>::default();
    for styled in styles {
        for guide in styled.guides.iter() {
            let mut line = Vec::with_capacity(GUIDE_VERTICES);
            for p in guide {
                let at = (p / STEP).round().as_ivec3();
                let (first, off) = (column(&line), at - predict(&line));
                (0..3).for_each(|a| out.put(first + a, off[a]));
                line.push(at);
            }
        }
    }
    out.finish()
}

fn read(bytes: &[u8]) -> Vec<Strands> {
    let mut columns = Reader::<COLUMNS>::new(bytes);
    let mut next = |column| columns.get(column).expect(OUT_OF_DATE);
    let styles = recipes().map(|recipe| {
        let mut strands = Strands::default();
        for _ in 0..recipe.guides {
            let mut line = Vec::with_capacity(GUIDE_VERTICES);
            for _ in 0..GUIDE_VERTICES {
                let first = column(&line);
                let off = [0, 1, 2].map(|a| next(first + a));
                line.push(predict(&line) + IVec3::from_array(off));
            }
            let line: Vec<Vec3> = line.iter().map(|p| p.as_vec3() * STEP).collect();
            strands.push(&line);
        }
        strands
    });
    let styles = styles.collect();
    assert!(columns.is_done(), "{OUT_OF_DATE}");
    styles
}

/// Number of columns: residuals of roots, first steps and all other vertices, along each axis.
const COLUMNS: usize = 9;

/// Returns the column of the x coordinate of the vertex after `line`.
fn column(line: &[IVec3]) -> usize {
    3 * line.len().min(2)
}

/// Predicts the next vertex by continuing straight on.
fn predict(line: &[IVec3]) -> IVec3 {
    match line {
        [] => IVec3::ZERO,
        [root] => *root,
        [.., before, last] => 2 * last - before,
    }
}
