//! Zones: parts of a view that have their own shadow maps and their own grid of ambient light.
//!
//! One set of maps around one [focus](crate::view::Picture::focus) suits a head, or a few side by side. In maps that
//! cover a crowd of 40 m, a head is two texels wide, and a cell of the grid is as large as ten heads. So each head has
//! a zone: a sphere around it, whose maps are as fine as its size on screen requires ([`Zone::for_camera`]).
//!
//! Coarse maps are too dark, because their texels smooth the first depth layer of the hair: by 1.6 % with 256² texels
//! around a head, 5 % with 128², 13 % with 64². Coarse grids are not, in a photographer's lights: 12³ and 8³ cells have
//! the same mean brightness as 24³. In sky light alone, a head is up to 3.5 % brighter with 12³. Where zones overlap,
//! the zone that lists a groom or mesh lights it.
//!
//! ```text
//! zones ─► for each: shadow maps, ambient light (the same kernels, other buffers)
//! hair ──► shaded in the light of its zone      meshes ─► light sampled (draw::soft) and drawn in the light of theirs
//! ```
//!
//! **Updates in turn.** Ambient light of a distant zone is recomputed every second or third frame, each zone in another
//! frame, and kept in between ([`Zone::ambient_interval`]) as long as the head has turned by less than a cell
//! ([`Zone::pose`]). The grid moves with the focus. Shadow maps are redrawn in every frame, because they resolve
//! strands: after a move by a few texels, hair lies behind the hair that was in front of it before, and is up to 28 %
//! too dark.
//!
//! **Distance.** A small image of one head, or of a few side by side, is lit as one zone with a quarter of the texels
//! and three fifths of the cells ([`View::fit_light`](crate::View::fit_light)), since the cost of maps and grid does
//! not fall with the number of pixels. Its light is computed in every frame, so that a frame does not depend on earlier
//! ones.
//!
//! Hair and meshes of a zone cast shadows on another if a light is behind them (`FrameLight::is_shadowed_by`).
//!
//! Rejected: cascades share near regions and blur distant ones, along the view direction. Heads in a crowd are small
//! and far apart, so most of a cascade would be empty. Also rejected: one atlas. Every lookup of every kernel would
//! clamp to its tile; separate buffers cost a few bind groups.

use super::{LightState, Sphere};
use crate::{Camera, Context, Pose, constants::LIGHT_GROUP, gpu::Uniform};
use std::sync::{
    Arc, Mutex, MutexGuard, PoisonError,
    atomic::{AtomicU32, Ordering},
};

/// A part of a view with its own light.
#[derive(Clone, Debug, PartialEq)]
pub struct Zone {
    /// Region that the shadow maps and the grid cover.
    pub focus: Sphere,
    /// Texels along each edge of a shadow map, clamped to 4 to 2048.
    pub resolution: u32,
    /// Cells along each edge of the ambient light grid, clamped to 4 to 64.
    pub cells: u32,
    /// Grooms in the zone, as indices of the recorded grooms.
    pub hair: Vec<usize>,
    /// Meshes in the zone, as indices of the recorded meshes.
    pub bodies: Vec<usize>,
    /// Pose of the contents. Move the focus with it.
    pub pose: Pose,
    /// Interval in frames between updates of ambient light; 0 and 1 for every frame. Ambient light is also updated when
    /// the contents change, or move by a cell relative to the focus.
    pub ambient_interval: u32,
}

/// Coarsest and finest maps of [`Zone::for_camera`], texels along each edge.
const RESOLUTIONS: [u32; 2] = [256, 1024];
/// Sizes of its grids, cells along each edge.
const CELLS: [u32; 3] = [12, 16, 24];
/// Target size of a cell, pixels.
const CELL_PIXELS: f32 = 8.0;
/// Movement of the contents relative to the focus after which ambient light is recomputed, cells.
const MAX_DRIFT_CELLS: f32 = 1.0;
/// Zones of at least this diameter in pixels update ambient light in each frame. With at least half of it they do every
/// second frame, smaller ones every third.
const EVERY_FRAME_PIXELS: f32 = 320.0;

/// Texels and cells of a distant zone, the only one in its view. As with [`Zone::for_camera`], texels of the hair maps
/// are smaller than two pixels. With 16 cells, hair without a mesh would be 3.3 % brighter in sky light alone.
const FAR_SIZES: [u32; 2] = [512, 20];
/// Diameter in pixels below which a zone is distant.
const FAR_PIXELS: f32 = 100.0;
/// A distant zone gets finer light again from `FAR_PIXELS` times this factor.
const FAR_HYSTERESIS: f32 = 1.1;

impl Zone {
    /// Creates a zone around `focus`, as fine as `camera` requires: texels of the hair maps are at most two pixels
    /// wide, as long as the finest maps suffice for that, and cells about eight pixels. `coarser` reduces the image
    /// resolution by this number of octaves. Sizes change in steps, so that a moving head seldom changes them.
    pub fn for_camera(
        focus: Sphere,
        camera: &Camera,
        coarser: f32,
        hair: Vec<usize>,
        bodies: Vec<usize>,
    ) -> Self {
        let pixels = focus.pixels(camera) * (-coarser).exp2();
        // A texel of the hair maps is three texels of a depth map wide, and is smoothed over three.
        let octaves = (1.5 * pixels / RESOLUTIONS[0] as f32).max(1.0).log2().ceil();
        let resolution = (RESOLUTIONS[0] << (octaves as u32).min(16)).min(RESOLUTIONS[1]);
        let cells =
            CELLS.into_iter().rev().find(|cells| *cells as f32 * CELL_PIXELS <= pixels).unwrap_or(CELLS[0]);
        let ambient_interval = if pixels >= EVERY_FRAME_PIXELS {
            1
        } else if pixels >= 0.5 * EVERY_FRAME_PIXELS {
            2
        } else {
            3
        };
        Self { focus, resolution, cells, hair, bodies, ambient_interval, pose: Pose::IDENTITY }
    }

    /// Returns a zone around `focus` for `counts` grooms and meshes, if they are so far from `camera` that fewer texels
    /// and cells than `finest` suffice. `coarser` reduces the image resolution by this number of octaves. `previous` is
    /// the zone of the previous frame, for hysteresis.
    pub(crate) fn far(
        focus: Sphere,
        (camera, coarser): (&Camera, f32),
        finest: [u32; 2],
        previous: Option<&Self>,
        counts: [usize; 2],
    ) -> Option<Self> {
        let sizes @ [resolution, cells] = [0, 1].map(|i| FAR_SIZES[i].min(finest[i]));
        let was_far = previous.is_some_and(|zone| [zone.resolution, zone.cells] == sizes);
        let threshold = if was_far { FAR_HYSTERESIS * FAR_PIXELS } else { FAR_PIXELS };
        let is_far = focus.pixels(camera) * (-coarser).exp2() < threshold;
        let [hair, bodies] = counts.map(|count| (0..count).collect());
        let zone = Self { focus, resolution, cells, hair, bodies, ambient_interval: 1, pose: Pose::IDENTITY };
        (is_far && sizes != finest).then_some(zone)
    }

    /// Whether ambient light computed for `earlier`, an earlier state of the zone, is still valid.
    fn can_reuse_ambient(&self, earlier: &Self) -> bool {
        if (self.focus.radius, &self.hair, &self.bodies)
            != (earlier.focus.radius, &earlier.hair, &earlier.bodies)
        {
            return false;
        }
        let rotation = self.pose.rotation * earlier.pose.rotation.conjugate();
        // Length of the chord for an axis through the focus: twice the sine of half the angle, times the radius.
        let swing = 2.0 * self.focus.radius * rotation.xyz().length();
        let local_center =
            |zone: &Self| zone.pose.rotation.conjugate() * (zone.focus.center - zone.pose.translation);
        let cell = 2.0 * self.focus.radius / self.cells.max(1) as f32;
        swing + local_center(self).distance(local_center(earlier)) <= MAX_DRIFT_CELLS * cell
    }

    /// Bytes of GPU memory of the zone's light, with four shadow maps.
    pub fn bytes(&self) -> u64 {
        LightState::bytes_of([self.resolution, self.cells], LIGHT_GROUP)
    }
}

/// A zone with its light.
#[derive(Debug)]
struct CachedZone {
    zone: Zone,
    light: Arc<LightState>,
    /// Zone for which ambient light was computed; `None` if it must be recomputed.
    ambient_zone: Mutex<Option<Zone>>,
}

impl CachedZone {
    fn ambient_zone(&self) -> MutexGuard<'_, Option<Zone>> {
        // The value is valid even if another thread has panicked.
        self.ambient_zone.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The zones of a view, each with its light.
#[derive(Debug, Default)]
pub(crate) struct Zones {
    list: Vec<CachedZone>,
    /// Number of frames for which light was computed.
    frame_count: AtomicU32,
}

impl Zones {
    /// Replaces the zones, each with shadow maps for `max_lights` lights. `camera` is the uniform of the camera. A zone keeps the light of the old zone with
    /// the same index if its resolution fits.
    pub fn set(&mut self, context: &Context, camera: &Uniform, max_lights: u32, zones: &[Zone]) {
        let mut old_zones: Vec<_> = std::mem::take(&mut self.list).into_iter().map(Some).collect();
        let mut cached = |(i, zone): (usize, &Zone)| {
            let sizes = [zone.resolution, zone.cells];
            let kept =
                old_zones.get_mut(i).and_then(|old| old.take_if(|old| old.light.fits(sizes, max_lights)));
            let Some(kept) = kept else {
                let light = Arc::new(LightState::new(context, sizes, [max_lights, 0], camera));
                return CachedZone { zone: zone.clone(), light, ambient_zone: Mutex::default() };
            };
            // The zone may have changed since its ambient light was computed.
            let ambient_zone = kept.ambient_zone().take().filter(|earlier| zone.can_reuse_ambient(earlier));
            CachedZone { zone: zone.clone(), light: kept.light, ambient_zone: ambient_zone.into() }
        };
        self.list = zones.iter().enumerate().map(&mut cached).collect();
    }

    /// Returns the first zone.
    pub fn first(&self) -> Option<&Zone> {
        self.list.first().map(|kept| &kept.zone)
    }

    /// Marks the ambient light that these parts update as computed. Call it once per frame.
    pub fn mark_recorded(&self, parts: &[Part<'_>]) {
        for part in parts.iter().filter(|part| part.updates_ambient) {
            if let Some(kept) = (part.number as usize).checked_sub(1).and_then(|i| self.list.get(i)) {
                *kept.ambient_zone() = Some(kept.zone.clone());
            }
        }
        self.frame_count.fetch_add(1, Ordering::Relaxed);
    }

    /// Returns the parts that light a frame of `hair` grooms and `bodies` meshes: one for each zone, and the view's own
    /// `light` around `focus` for all that is in no zone. Without zones, this is the only part.
    pub fn parts<'a>(
        zones: Option<&'a Self>,
        (light, focus): (&'a LightState, Sphere),
        [hair, bodies]: [usize; 2],
    ) -> Vec<Part<'a>> {
        let (all_hair, all_bodies) = ((0..hair).collect(), (0..bodies).collect());
        let all = Part { number: 0, light, focus, hair: all_hair, bodies: all_bodies, updates_ambient: true };
        let Some(zones) = zones.filter(|zones| !zones.list.is_empty()) else { return vec![all] };
        let frame = zones.frame_count.load(Ordering::Relaxed);
        let zones = &zones.list;
        // Grooms and meshes that no zone has claimed yet.
        let mut free = [vec![true; hair], vec![true; bodies]];
        let mut parts = Vec::with_capacity(zones.len() + 1);
        for kept in zones {
            let CachedZone { zone, light, .. } = kept;
            // An earlier zone owns items that both list. Skip them, and indices that do not exist.
            let [zone_hair, zone_bodies] = [&zone.hair, &zone.bodies].map(|list| list.iter().copied());
            let claim = |list: &mut dyn Iterator<Item = usize>, free: &mut Vec<bool>| -> Vec<usize> {
                list.filter(|i| free.get_mut(*i).is_some_and(std::mem::take)).collect()
            };
            let [free_hair, free_bodies] = &mut free;
            let number = parts.len() as u32 + 1;
            // The zones update in turn.
            let due = frame.wrapping_add(number).is_multiple_of(zone.ambient_interval.max(1));
            parts.push(Part {
                number,
                updates_ambient: due || kept.ambient_zone().is_none(),
                light,
                focus: zone.focus,
                hair: claim(&mut { zone_hair }, free_hair),
                bodies: claim(&mut { zone_bodies }, free_bodies),
            });
        }
        let [hair, bodies] = free.map(|free| {
            free.iter().enumerate().filter(|(_, is_free)| **is_free).map(|(i, _)| i).collect::<Vec<_>>()
        });
        if !hair.is_empty() || !bodies.is_empty() {
            parts.push(Part { number: parts.len() as u32 + 1, hair, bodies, ..all });
        }
        parts
    }

    /// Bytes of GPU memory.
    pub fn bytes(&self) -> u64 {
        self.list.iter().map(|CachedZone { light, .. }| light.shadow_bytes() + light.ambient_bytes()).sum()
    }
}

/// Grooms and meshes that the same maps light in a frame.
#[derive(Clone, Debug)]
pub(crate) struct Part<'a> {
    /// Number of the zone, from 1; 0 without zones.
    pub number: u32,
    pub light: &'a LightState,
    pub focus: Sphere,
    pub hair: Vec<usize>,
    pub bodies: Vec<usize>,
    /// Whether the frame recomputes the ambient light.
    pub updates_ambient: bool,
}

impl Part<'_> {
    /// Returns the items of `all`, grooms or meshes, at the indices in `list`.
    pub fn select<T: Copy>(list: &[usize], all: &[T]) -> Vec<T> {
        list.iter().filter_map(|i| all.get(*i).copied()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn zone_resolution_follows_screen_size() {
        let focus = Sphere { center: Vec3::ZERO, radius: 0.35 };
        let zone = |away: f32| {
            let camera =
                Camera::look_at(Vec3::Z * away, Vec3::ZERO, std::f32::consts::FRAC_PI_6, [1280, 720]);
            Zone::for_camera(focus, &camera, 0.0, vec![0], vec![])
        };
        let sizes = [1.0, 2.0, 5.0, 12.0, 20.0, 40.0].map(|away| [zone(away).resolution, zone(away).cells]);
        assert_eq!(sizes, [[1024, 24], [1024, 24], [512, 24], [256, 12], [256, 12], [256, 12]]);
        assert_eq!([1.0, 2.0, 5.0, 12.0].map(|away| zone(away).ambient_interval), [1, 1, 2, 3]);
    }

    #[test]
    fn only_distant_heads_get_coarser_light() {
        let focus = Sphere { center: Vec3::ZERO, radius: 0.35 };
        let far = |away: f32, coarser: f32, finest: [u32; 2], previous: Option<&Zone>| {
            let camera =
                Camera::look_at(Vec3::Z * away, Vec3::ZERO, std::f32::consts::FRAC_PI_6, [1280, 720]);
            Zone::far(focus, (&camera, coarser), finest, previous, [2, 1])
        };
        let finest = [1024, 24];
        assert_eq!([0.6, 2.0, 9.2].map(|away| far(away, 0.0, finest, None)), [const { None }; 3]);
        let zone = far(15.0, 0.0, finest, None).unwrap();
        assert_eq!([zone.resolution, zone.cells, zone.ambient_interval], [512, 20, 1]);
        assert_eq!((&zone.hair[..], &zone.bodies[..]), (&[0, 1][..], &[0][..]));
        // The threshold is 9.4 m. A head that approaches crosses it at 8.5 m.
        assert_eq!(far(9.2, 0.0, finest, Some(&zone)).as_ref(), Some(&zone));
        assert_eq!(far(8.4, 0.0, finest, Some(&zone)), None);
        // Images of half the resolution, and light that is no finer.
        assert!(far(5.4, 1.0, finest, None).is_some());
        assert_eq!(far(15.0, 0.0, [512, 12], None).map(|zone| [zone.resolution, zone.cells]), None);
        assert_eq!(
            far(15.0, 0.0, [256, 24], None).map(|zone| [zone.resolution, zone.cells]),
            Some([256, 20])
        );
    }
}
