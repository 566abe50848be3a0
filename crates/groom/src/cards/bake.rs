//! The bake, stage after stage.

use super::{
    accuracy::{CardAccuracy, SIZES, shrunk},
    atlas::{self, Rect},
    chains::{CardBind, CardChains},
    cluster::{cluster, merge},
    helmet,
    lines::Lines,
    lock_classes::{Likeness, alike},
    mesh::{self, CardMesh},
    options::CardOptions,
    order::{self, Blending},
    picture::{Opacity, Pyramid, Studio},
    ribbon::Ribbon,
    scalp::CardScalp,
    texture::{self, CardTextures},
    tile::{Lock, Tile},
    volume::{BLUR, HairVolume},
};
use crate::{
    Error, Progress, Result, SdfGrid, Strands, TriMesh,
    lint::repair_kept,
    mesh::sdf::{self, SdfOptions},
    progress::{at_once, in_parallel},
};
use glam::Vec3;

/// Name of the task for progress reports.
const TASK: &str = "baking cards";
/// Edge of the textures and pictures with which the widths of strands are found.
const DRAFT: u32 = 512;
const DRAFT_PICTURE: [usize; 2] = [128, 2];
/// Edge of the pictures by which a helmet is formed, pixels, and samples along the edge of a pixel.
const HELMET_PICTURE: [usize; 2] = [16, 8];
/// Share of the hair's area that must be solid for a helmet.
const SOLID: f32 = 0.5;
/// Range of the factor on the widths of strands.
const WIDENING: [f32; 2] = [0.5, 4.0];
/// How much coarser texels may be along straight strands than across.
const SQUASH: f32 = 4.0;

/// A groom as cards.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cards {
    /// Levels, from the finest.
    pub levels: Vec<CardLevel>,
    /// Textures of all levels.
    pub textures: CardTextures,
    /// Chains of bones that carry the cards.
    pub chains: CardChains,
    /// Hair on the skin of the head, empty without a head.
    pub scalp: CardScalp,
    /// Texels per meter across the cards.
    pub density: f32,
    /// Fraction of the textures that pictures fill.
    pub filled: f32,
    /// Remarks about the result.
    pub notes: Vec<String>,
}

/// One level of detail.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CardLevel {
    /// Number of the level, 0 for the finest.
    pub index: u32,
    /// Number of cards, 0 for a helmet.
    pub cards: u32,
    /// Whether the level is a helmet, an opaque shell.
    pub helmet: bool,
    /// Number of pictures that the cards share.
    pub pictures: u32,
    /// Factor on the widths of strands in the pictures.
    pub widening: f32,
    /// Triangles of all cards.
    pub mesh: CardMesh,
    /// Bones of the chains that each vertex follows; none without chains.
    pub binds: Vec<CardBind>,
    /// Strands of each card, as indices of the input; none for a helmet.
    pub locks: Vec<Vec<u32>>,
    /// Coverage against the strands.
    pub accuracy: CardAccuracy,
    /// Mean difference of the opacity to the level before, or for the first level to the strands, at the size where
    /// this level takes over ([`CardAccuracy::switch`]).
    pub pop: f32,
    /// Mean number of triangles over each pixel that has any, in 14 pictures from all sides.
    pub overdraw: f32,
    /// Mean difference of the brightness between cards blended in the order of the mesh and cards sorted by depth, as a
    /// fraction of white, in these pictures.
    pub order_error: f32,
}

impl CardLevel {
    /// Returns the name of the level for people, such as `400 cards`.
    #[must_use]
    pub fn name(&self) -> String {
        if self.helmet { "helmet".into() } else { format!("{} cards", self.cards) }
    }
}

/// A level before it has triangles.
struct Draft {
    /// Number of the level among those of the options.
    level: usize,
    locks: Vec<Lock>,
    likenesses: Vec<Likeness>,
    /// Locks that have a tile, ascending.
    drawn: Vec<u32>,
}

/// Bakes cards from `strands` (meters, Y up). `head` hides hair behind it, and cards stay outside of it.
///
/// # Errors
/// [`Error::Parameter`] for an option out of range, [`Error::Unusable`] for hair without length and for pictures that
/// do not fit into the textures, and the errors of [`sdf::build`].
pub fn bake(strands: &Strands, head: Option<&TriMesh>, options: &CardOptions) -> Result<Cards> {
    at_once(bake_with(strands, head, options, &()))
}

/// [`bake`] that reports to `progress`.
///
/// # Errors
/// As [`bake`].
pub async fn bake_with(
    strands: &Strands,
    head: Option<&TriMesh>,
    options: &CardOptions,
    progress: &impl Progress,
) -> Result<Cards> {
    options.check()?;
    progress.step(TASK, 0.0).await;
    let mut clean = strands.clone();
    let (_, kept) = repair_kept(&mut clean);
    let lost = strands.len() - kept.len();
    let strands = &clean;
    let Some(bounds) = strands.bounds().filter(|_| !strands.is_empty()) else {
        return Err(Error::Unusable("the hair has no strands with a length, so it has no cards".into()));
    };
    let field = match head {
        Some(head) => Some(sdf::build(head, &SdfOptions { resolution: 64, ..Default::default() })?),
        None => None,
    };
    let mut lines = Lines::new(strands);
    progress.step(TASK, 0.1).await;
    let studio = Studio::new(bounds, [SIZES[0] as usize, 4], head);
    let (pictures, visible_samples) = studio.strands(strands, &lines.radii);
    lines.weigh(&visible_samples);
    progress.step(TASK, 0.25).await;
    let volume = HairVolume::new(strands, &lines.radii, field.as_ref(), BLUR);
    let scene = Stage { lines, volume, field: field.as_ref(), options };
    let drafts = scene.drafts();
    progress.step(TASK, 0.5).await;
    let small = Studio::new(bounds, DRAFT_PICTURE, head);
    let (target, _) = small.strands(strands, &scene.lines.radii);
    let mut widenings = Vec::new();
    for (level, draft) in drafts.iter().enumerate() {
        widenings.push(scene.widening(draft, &small, &target)?);
        progress.step(TASK, 0.5 + 0.3 * (level + 1) as f32 / drafts.len() as f32).await;
    }
    let mut notes = Vec::new();
    let shell = options.has_helmet.then(|| scene.shell(bounds, head, &pictures, &mut notes)).flatten();
    let size = options.texture_size as usize;
    let (rects, density) = scene.pack_tiles(&drafts, size, shell.is_some())?;
    let mut tiles = scene.tiles(&drafts, &rects, &widenings);
    if shell.is_some() {
        tiles.push(scene.helmet_tile(&drafts[0], *rects.last().unwrap(), widenings[0]));
    }
    progress.step(TASK, 0.9).await;
    tiles.iter_mut().for_each(Tile::spread);
    let alpha = Pyramid::new(size, texture::coverage(size, &rects, &tiles));
    let tones = texture::tones(size, &rects, &tiles);
    let chains = CardChains::new(&scene.lines, &kept, options.chain_count as usize, options.seed);
    // Pictures of the level before, at first of the strands.
    let mut before = pictures.clone();
    let mut measure = |mesh: &CardMesh, alpha: &Pyramid| {
        let found = studio.cards(&mesh.surface(), alpha);
        let accuracy = CardAccuracy::new(&pictures, &found);
        let pop = CardAccuracy::new(&before, &found).difference_at(accuracy.switch);
        before = found;
        (accuracy, pop)
    };
    let mut levels = Vec::new();
    let mut first = 0;
    for (level, (draft, widening)) in drafts.iter().zip(&widenings).enumerate() {
        let mesh = scene.mesh(draft, &rects[first..], size);
        first += draft.drawn.len();
        let order = order::ordered(&small, &mesh, &alpha, &tones);
        let mesh = mesh.reordered(&order);
        let blending = Blending::new(&small, &mesh, &alpha, &tones);
        let (accuracy, pop) = measure(&mesh, &alpha);
        levels.push(CardLevel {
            overdraw: blending.overdraw,
            order_error: blending.error,
            index: level as u32,
            cards: draft.locks.len() as u32,
            helmet: false,
            pictures: draft.drawn.len() as u32,
            widening: *widening,
            locks: order
                .iter()
                .map(|card| &draft.locks[*card as usize].members)
                .map(|members| members.iter().map(|i| kept[*i as usize]).collect())
                .collect(),
            binds: chains.binds(&mesh),
            accuracy,
            pop,
            mesh,
        });
    }
    if let Some(shell) = &shell {
        let mesh = helmet::textured(shell, &scene.lines, &scene.volume, (rects[first], size));
        let (accuracy, pop) = measure(&mesh, &Pyramid::new(1, vec![1.0]));
        levels.push(CardLevel {
            index: levels.len() as u32,
            helmet: true,
            pictures: 1,
            widening: widenings[0],
            binds: chains.binds(&mesh),
            accuracy,
            pop,
            overdraw: 1.0,
            mesh,
            ..Default::default()
        });
    }
    let area: usize = rects.iter().map(|rect| rect.width * rect.height).sum();
    let textures = CardTextures::new(size, &rects, &tiles, !strands.colors.is_empty());
    progress.step(TASK, 1.0).await;
    notes.splice(0..0, scene.notes(&levels, lost, density));
    let scalp = head.map(|head| CardScalp::new(head, &scene.lines)).unwrap_or_default();
    Ok(Cards { levels, textures, chains, scalp, density, filled: area as f32 / (size * size) as f32, notes })
}

impl Cards {
    /// Returns one of the levels alone, with all textures.
    ///
    /// # Panics
    /// If there is no such level.
    #[must_use]
    pub fn only(&self, level: usize) -> Self {
        Self { levels: vec![self.levels[level].clone()], ..self.clone() }
    }
}

/// Inputs of all stages.
struct Stage<'a> {
    lines: Lines<'a>,
    volume: HairVolume<'a>,
    field: Option<&'a SdfGrid>,
    options: &'a CardOptions,
}

impl Stage<'_> {
    /// Forms the locks of all levels and chooses the pictures that they share.
    fn drafts(&self) -> Vec<Draft> {
        let (points, weights) = (self.lines.points(), &self.lines.weights);
        let mut of: Vec<u32> = Vec::new();
        let pictures = self.options.pictures();
        let mut drafts = Vec::new();
        for (level, count) in self.options.levels.iter().enumerate() {
            of = match level {
                0 => cluster(&points, weights, *count as usize, self.options.seed),
                _ => merge(&points, weights, &of, *count as usize),
            };
            let mut members = vec![Vec::new(); of.iter().max().map_or(0, |last| *last as usize + 1)];
            if drafts.last().is_some_and(|last: &Draft| last.locks.len() == members.len()) {
                continue;
            }
            of.iter().zip(0..).for_each(|(of, strand)| members[*of as usize].push(strand));
            let mut locks = in_parallel(&members, |members| Lock {
                ribbon: Ribbon::fit(&self.lines, members, &self.volume),
                members: members.clone(),
            });
            self.sort(&mut locks);
            let likenesses = alike(&self.lines, &locks, pictures[level], self.options.seed);
            let mut drawn: Vec<u32> = likenesses.iter().map(|like| like.lock).collect();
            drawn.sort_unstable();
            drawn.dedup();
            drafts.push(Draft { level, locks, likenesses, drawn });
        }
        drafts
    }

    /// Sorts locks from the inside out, so that blended cards mostly draw over those behind them.
    fn sort(&self, locks: &mut [Lock]) {
        let depth = |lock: &Lock| {
            let center = lock.ribbon.row(0.6).point(0.0);
            match self.field {
                Some(head) => head.sample(center),
                None => -self.volume.density(center),
            }
        };
        locks.sort_by_cached_key(|lock| (depth(lock) * 1e6) as i64);
    }

    /// Returns the locks that are drawn and their levels, in the order of their tiles.
    fn drawn<'a>(&self, drafts: &'a [Draft]) -> Vec<(usize, &'a Lock)> {
        let of = |(level, draft): (usize, &'a Draft)| {
            draft.drawn.iter().map(move |lock| (level, &draft.locks[*lock as usize]))
        };
        drafts.iter().enumerate().flat_map(of).collect()
    }

    /// Returns the shell of the hair for a helmet. Explains in `notes` why there is none.
    fn shell(
        &self,
        bounds: (Vec3, Vec3),
        head: Option<&TriMesh>,
        pictures: &[Opacity],
        notes: &mut Vec<String>,
    ) -> Option<TriMesh> {
        let solid = helmet::solid(pictures);
        if solid < SOLID {
            notes.push(format!(
                "helmet: left out, because only {:.0} % of the hair's area is opaque, and {:.0} % must be",
                100.0 * solid,
                100.0 * SOLID
            ));
            return None;
        }
        let studio = Studio::new(bounds, HELMET_PICTURE, head);
        let target = shrunk(pictures, HELMET_PICTURE[0]);
        let triangles = self.options.max_triangles(self.options.levels.len());
        let shell = helmet::shell(&self.lines, self.field, (&studio, &target), triangles);
        if shell.is_none() {
            notes.push("helmet: left out, because the hair has no surface outside of the head".into());
        }
        shell
    }

    /// Draws the picture of a helmet: the lock that covers most of the finest level.
    fn helmet_tile(&self, finest: &Draft, rect: Rect, widening: f32) -> Tile {
        let area = |lock: u32| -> f32 {
            let uses = finest.locks.iter().zip(&finest.likenesses).filter(|(_, like)| like.lock == lock);
            uses.map(|(lock, _)| lock.ribbon.half() * lock.ribbon.length).sum()
        };
        let largest = finest.drawn.iter().copied().max_by(|a, b| area(*a).total_cmp(&area(*b)));
        let lock = &finest.locks[largest.unwrap_or(0) as usize];
        helmet::tile(rect.width, rect.height, |size| lock.draw(&self.lines, size, widening))
    }

    /// Returns the places of all tiles in textures of `size` texels, that of a helmet last, and the texels per meter.
    fn pack_tiles(&self, drafts: &[Draft], size: usize, helmet: bool) -> Result<(Vec<Rect>, f32)> {
        let mut extents = in_parallel(&self.drawn(drafts), |(_, lock)| {
            let squash = (0.5 / lock.slope(&self.lines).max(1e-3)).clamp(1.0, SQUASH);
            [2.0 * lock.ribbon.half(), lock.ribbon.length / squash]
        });
        extents.extend(helmet.then_some(helmet::EXTENT));
        atlas::pack(&extents, size).ok_or_else(|| {
            Error::Unusable(format!(
                "{} pictures do not fit into a texture of {size} texels: use fewer pictures or a larger texture",
                extents.len()
            ))
        })
    }

    /// Draws all tiles.
    fn tiles(&self, drafts: &[Draft], rects: &[Rect], widenings: &[f32]) -> Vec<Tile> {
        let work: Vec<_> = self.drawn(drafts).into_iter().zip(rects).collect();
        in_parallel(&work, |((level, lock), rect)| {
            lock.draw(&self.lines, [rect.width, rect.height], widenings[*level])
        })
    }

    /// Returns the triangles of a level whose tiles are at `rects`.
    fn mesh(&self, draft: &Draft, rects: &[Rect], size: usize) -> CardMesh {
        let ribbons = draft.locks.iter().map(|lock| &lock.ribbon);
        let plans = mesh::plan(ribbons, self.options.max_triangles(draft.level));
        let mut mesh = CardMesh::default();
        for (plan, like) in plans.iter().zip(&draft.likenesses) {
            let tile = draft.drawn.partition_point(|lock| *lock < like.lock);
            mesh.push(plan, (rects[tile], like.mirrored), size, &self.volume, self.field);
        }
        mesh
    }

    /// Returns the factor on the widths of strands with which the level covers as much as the strands in `target`.
    fn widening(&self, draft: &Draft, studio: &Studio, target: &[Opacity]) -> Result<f32> {
        let size = self.options.texture_size.min(DRAFT) as usize;
        let single_draft = std::slice::from_ref(draft);
        let (rects, _) = self.pack_tiles(single_draft, size, false)?;
        let mesh = self.mesh(draft, &rects, size);
        let goal: f32 = target.iter().flatten().sum();
        Ok(root(WIDENING, |widening| {
            let tiles = self.tiles(single_draft, &rects, &[widening]);
            let alpha = Pyramid::new(size, texture::coverage(size, &rects, &tiles));
            let found = studio.cards(&mesh.surface(), &alpha);
            found.iter().flatten().sum::<f32>() / goal.max(1e-6) - 1.0
        }))
    }

    /// Says what the user should know about the result.
    fn notes(&self, levels: &[CardLevel], lost: usize, density: f32) -> Vec<String> {
        let mut notes = Vec::new();
        if lost > 0 {
            notes.push(format!("strands without length, which have no cards: {lost}"));
        }
        let strands = self.lines.strands.len();
        if levels.first().is_some_and(|level| level.cards < self.options.levels[0]) {
            notes.push(format!(
                "cards: {} instead of {}, because only {strands} strands are there; fill the hair first",
                levels[0].cards, self.options.levels[0]
            ));
        }
        let card_levels = levels.iter().filter(|level| !level.helmet).count();
        if card_levels < self.options.levels.len() {
            notes.push(format!(
                "levels: {card_levels} instead of {}; equal ones are one",
                self.options.levels.len()
            ));
        }
        for level in levels.iter().filter(|level| !level.helmet) {
            let percent = 100.0 * level.accuracy.coverage;
            if percent < 97.0 {
                notes.push(format!(
                    "cards: {} with {} triangles cover only {percent:.0} % of what the strands cover; more cards or triangles cover more",
                    level.cards,
                    level.mesh.triangles.len()
                ));
            }
        }
        let mean = self.lines.radii.iter().sum::<f32>() / self.lines.radii.len().max(1) as f32;
        let texels = 2.0 * mean * density * levels.first().map_or(1.0, |level| level.widening);
        if texels < 0.7 {
            let size = (self.options.texture_size as f32 * 0.7 / texels) as u32;
            notes.push(format!(
                "a strand is {texels:.1} texels wide: textures of {} texels would show single strands",
                size.next_power_of_two()
            ));
        }
        notes
    }
}

/// Returns the place in `range` where the increasing function `excess` is 0, or the end of the range nearest to it.
fn root([mut low, mut high]: [f32; 2], excess: impl Fn(f32) -> f32) -> f32 {
    let (mut below, mut above) = (excess(low), excess(high));
    if below >= 0.0 {
        return low;
    }
    if above <= 0.0 {
        return high;
    }
    // False position; the end that stays counts less, so that it moves as well (Illinois).
    for _ in 0..8 {
        let estimate = low + (high - low) * (-below / (above - below)).clamp(0.05, 0.95);
        let found = excess(estimate);
        if found.abs() < 0.003 {
            return estimate;
        }
        if found < 0.0 {
            (low, below) = (estimate, found);
            above *= 0.5;
        } else {
            (high, above) = (estimate, found);
            below *= 0.5;
        }
    }
    0.5 * (low + high)
}
