//! The data that all hair of one groom shares.

use super::HairOptions;
use crate::{
    Context, Error, Progress, Result, avoid,
    collide::{Collider, ColliderDescriptor, FieldAtlas},
    groom::{BoundStrands, Groom, Guides, TriMesh, card_sheet::CardSheet, character::LodLevel, tie::Tie},
    light::{
        cards::CardBuffers,
        hair::{SetAsset, sample_bytes},
    },
    lod::{self, GuideOrder, LodTables},
    math::hash::pcg,
    progress::at_once,
    roots::RootAsset,
    simulate::{GuideTraits, LinkAsset, RestOptions, SimulationParams, TieAsset, rest},
    strands::{
        GuideAsset, GuideForce, GuideSample, RestGuides, Strand, StrandAsset, StrandBinding, buffers::storage,
    },
    tessellate::rest_samples,
    volume::VolumeAsset,
};
use glam::Vec3;
use std::sync::{Arc, Mutex, PoisonError};

/// Contents of a [`HairAsset`] besides the groom.
#[derive(Clone, Copy, Debug, Default)]
pub struct HairDescriptor<'a> {
    /// Options.
    pub options: HairOptions,
    /// Distance fields, and the colliders that hair starts with.
    pub colliders: ColliderDescriptor<'a>,
    /// Draws the hair as cards, at any distance, if the strands of the groom are the columns of cards
    /// (`groom::cards::Cards::strands`, with the feature `cards`).
    pub cards: Option<&'a CardSheet>,
    /// Painted levels of detail: at most `lod::MAX_LEVELS`, with descending sizes.
    pub levels: &'a [LodLevel],
    /// Center of the braincase (groom space, meters), around which levels are painted
    /// ([`SKULL_CENTER`](crate::groom::mannequin::SKULL_CENTER) for the built-in head).
    pub skull: Vec3,
    /// Bands, braids and pins that hold the hair.
    pub ties: &'a [Tie],
}

/// A groom on the GPU: everything that hair of the same groom shares and that never moves.
///
/// | shared | per [`Hair`](super::Hair) |
/// |---|---|
/// | rest state of guides; bindings and rest curves of strands; measured tables of levels | state of guides; their samples |
/// | distance fields | poses of colliders |
/// | scratch memory: self-collision grids, forces on guides, shading samples | obstacles in the grids, density at rest |
/// | links, ties, bound roots | their uniforms |
/// | index lists; fiber tables, while the fibers are the same | material, level of detail, drawn vertices |
#[derive(Debug)]
pub struct HairAsset {
    pub(crate) context: Context,
    pub(super) options: HairOptions,
    pub(super) rest: Guides,
    /// Distances of the guide vertices from the surface that they rest on.
    distances: Vec<f32>,
    /// Roots of the strands in drawing order, groom space, meters.
    roots: Vec<Vec3>,
    pub(super) colliders: Vec<Collider>,
    pub(super) guides: GuideAsset,
    pub(super) strands: StrandAsset,
    pub(super) fields: FieldAtlas,
    pub(super) volume: VolumeAsset,
    pub(super) lod: Arc<LodTables>,
    pub(super) set: Arc<SetAsset>,
    pub(super) ties: Option<TieAsset>,
    links: Mutex<Option<LinkAsset>>,
    pub(super) order: GuideOrder,
    /// Bounding box of the hair at rest: center (groom space) and longest side, meters.
    pub(super) extent: (Vec3, f32),
}

impl HairAsset {
    /// Uploads `groom`. Strands are reordered by [`lod::arrange`].
    ///
    /// # Errors
    /// [`Error::Limit`] when the adapter cannot hold it; [`Error::Groom`], [`Error::Parameter`] and
    /// [`Error::Colliders`] when the groom or the descriptor is invalid.
    pub fn new(context: &Context, groom: Groom, what: &HairDescriptor<'_>) -> Result<Arc<Self>> {
        at_once(Self::with_progress(context, groom, what, &()))
    }

    /// [`new`](Self::new) that reports to `progress`.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub async fn with_progress(
        context: &Context,
        groom: Groom,
        what: &HairDescriptor<'_>,
        progress: &impl Progress,
    ) -> Result<Arc<Self>> {
        let Context { device, queue, .. } = context;
        let HairDescriptor { options, colliders, .. } = what;
        progress.step("preparing the strands", 0.0).await;
        let Groom { guides, mut strands, .. } = groom;
        if guides.is_empty() || strands.is_empty() {
            return Err(Error::unusable("the groom has no strands"));
        }
        let cards = what.cards.map(|sheet| {
            let strips = sheet.strips_in(&lod::order(&strands))?;
            CardBuffers::new(context, &strips, sheet)
        });
        let columns = what.cards.map(|sheet| strands.len() as f32 / sheet.strands.max(1) as f32);
        lod::arrange(&mut strands);
        let resting = colliders.rest.or(colliders.head);
        let clearance = options.rest.clearance;

        let (guide_count, count) = (count(guides.len())?, count(strands.len())?);
        let (n, vertex_count) = (guides.vertex_count, strands.vertex_count);
        // Strands that are their own guides need no samples.
        let single = |binding: &StrandBinding| binding.weight_b == 0.0 && binding.weight_c == 0.0;
        let follows = guides.len() >= strands.len() && strands.bindings.iter().all(single);
        let sample_count = if follows { 0 } else { n.max(vertex_count) };
        let distances = rest::distances(&guides.positions, resting);
        let rest = rested(&guides, &distances, &options.simulation, &options.rest)?;
        // A step uses the scratch memory for the cells of the density grid, then for the forces on guides; drawing uses
        // it for shading samples. None of these is read after another has been written, in any order of heads and
        // views.
        let forces = u64::from(guide_count) * u64::from(n) * size_of::<GuideForce>() as u64;
        let scratch = sample_bytes([count, vertex_count]).max(options.volume.cell_bytes()?).max(forces);
        let scratch = storage::<u8>(device, "scratch of a groom", scratch)?;
        let guide_asset = GuideAsset::new(context, [guide_count, n, sample_count], scratch.clone().into())?;
        rest.write(context, &guide_asset.info, &guide_asset.rest);

        let strand_asset = StrandAsset::new(context, count, vertex_count)?;
        queue.write_buffer(&strand_asset.bindings, 0, bytemuck::cast_slice(&strands.bindings));
        let rest_with_penetration = resting.map(|field| avoid::with_penetration(&strands, field, clearance));
        let curves = rest_with_penetration.as_ref().unwrap_or(&strands.rest);
        queue.write_buffer(&strand_asset.rest, 0, bytemuck::cast_slice(curves));

        let fields = FieldAtlas::new(context, colliders)?;
        let volume = VolumeAsset::new(context, &rest, &options.volume, Some(scratch.clone()))?;
        let order = lod::guide_order(&guides, rest.info, &strands);
        let (ties, set) =
            (TieAsset::new(context, &guides, what.ties)?, SetAsset::new(cards.transpose()?, scratch));
        let root = |i: usize| strands.rest_positions(i).next().unwrap_or_default();
        let roots = (0..strands.len()).map(root).collect();
        let infos = with_locks(&strands);
        let levels = (what.levels, what.skull);
        let lod = LodTables::new(context, strands, infos, &options.lod, levels, columns, progress).await?;
        Ok(Arc::new(Self {
            context: context.clone(),
            options: *options,
            extent: extent(&guides),
            rest: guides,
            distances,
            roots,
            colliders: colliders.colliders.to_vec(),
            guides: guide_asset,
            strands: strand_asset,
            fields,
            volume,
            lod: Arc::new(lod),
            set: Arc::new(set),
            ties,
            links: Mutex::default(),
            order,
        }))
    }

    /// Computes the rest shape of the guides again, for other physics or options, from the next frame on. All hair of
    /// the asset keeps its motion. The clearance stays.
    ///
    /// # Errors
    /// [`Error::Parameter`] for values out of range.
    pub fn set_rest(&self, physics: &SimulationParams, options: &RestOptions) -> Result<()> {
        let options = RestOptions { clearance: self.options.rest.clearance, ..*options };
        let rest = rested(&self.rest, &self.distances, physics, &options)?;
        rest.write(&self.context, &self.guides.info, &self.guides.rest);
        self.order.set_infos(&self.context, rest.info, &self.guides.info);
        Ok(())
    }

    /// Returns the links between guide vertices that are about `distance` meters apart.
    pub(super) fn links(&self, distance: f32) -> Result<LinkAsset> {
        let mut links = self.links.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = links.as_ref().filter(|known| known.distance == distance) {
            return Ok(known.clone());
        }
        // Positions do not depend on physics.
        let rest = rested(&self.rest, &self.distances, &self.options.simulation, &self.options.rest)?;
        Ok(links.insert(LinkAsset::new(&self.context, &rest, distance)?).clone())
    }

    /// Returns the guides' samples at rest; none where strands are their own guides.
    pub(super) fn samples(&self) -> Vec<GuideSample> {
        if self.guides.sample_count == 0 {
            return Vec::new();
        }
        let guides = (0..self.rest.len()).map(|i| self.rest.guide(i));
        guides
            .flat_map(|guide| rest_samples(guide, self.guides.sample_count))
            .map(GuideSample::at_rest)
            .collect()
    }

    /// Binds the roots to `mesh`, the skin at rest (groom space).
    pub(crate) fn bind_roots(&self, mesh: &TriMesh, max_distance: f32) -> Result<RootAsset> {
        let guides: Vec<_> = (0..self.rest.len()).map(|i| self.rest.guide(i)[0]).collect();
        RootAsset::new(
            &self.context,
            [&guides, &self.roots],
            self.guides.sample_count == 0,
            mesh,
            max_distance,
        )
    }

    /// Returns the GPU memory of the asset, bytes, without that of its hair.
    pub fn bytes(&self) -> u64 {
        let links = self.links.lock().unwrap_or_else(PoisonError::into_inner);
        self.guides.bytes()
            + self.strands.bytes()
            + self.fields.bytes()
            + self.volume.bytes()
            + self.lod.bytes()
            + self.set.bytes()
            + self.ties.as_ref().map_or(0, TieAsset::bytes)
            + links.as_ref().map_or(0, LinkAsset::bytes)
            + self.order.bytes()
    }
}

/// Returns the rest state of `guides`.
fn rested(
    guides: &Guides,
    distances: &[f32],
    physics: &SimulationParams,
    options: &RestOptions,
) -> Result<RestGuides> {
    let traits: Vec<_> = (0..guides.len())
        .map(|i| GuideTraits {
            stiffness: guides.stiffness[i],
            strands: guides.strands[i],
            is_tip_pinned: guides.tip_pinned[i],
        })
        .collect();
    rest::guides_at(&guides.positions, guides.vertex_count, &traits, physics, options, distances)
}

/// Returns the bounding box of the guides at rest: center and longest side, meters.
fn extent(guides: &Guides) -> (Vec3, f32) {
    let (lo, hi) = guides
        .positions
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(*p), hi.max(*p)));
    (0.5 * (lo + hi), (hi - lo).max_element().max(0.05))
}

/// Converts a number of strands or guides to the GPU's 32 bits.
fn count(n: usize) -> Result<u32> {
    u32::try_from(n).map_err(|_| Error::unusable(format!("{n} strands are more than 32 bits can count")))
}

/// Returns the strands with seeds whose upper half is shared by all strands of the same first guide.
fn with_locks(strands: &BoundStrands) -> Vec<Strand> {
    let strands = strands.strands.iter().zip(&strands.bindings);
    strands
        .map(|(strand, binding)| Strand {
            seed: (pcg(binding.guides[0]) & 0xffff_0000) | (strand.seed & 0xffff),
            ..*strand
        })
        .collect()
}
